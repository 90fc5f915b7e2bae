//! The library inside a program.

pub mod c_interface;
pub mod cpp_abi;
pub mod error;
pub mod fortran;
mod mesh;
pub mod participant;
