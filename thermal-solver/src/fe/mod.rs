//! Finite elements of both bodies.
pub mod basis;
pub mod block;
pub mod body;
pub mod creep;
pub mod mesh;
pub mod modes;
pub mod scheme;
pub mod steady;
pub mod transient;
