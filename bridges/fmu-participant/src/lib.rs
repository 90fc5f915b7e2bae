//! FMU of another program as a participant: FMI 2.0 and 3.0 for co-simulation.
//!
//! | module | content |
//! |---|---|
//! | [`archive`] | FMU archive, unpacked within limits |
//! | [`description`], [`depth`], [`variable`], [`unit`] | `modelDescription.xml` |
//! | [`wiring`] | variables that give or receive fields |
//! | [`figures`], [`start`] | outputs as figures; parameters as keys of the case |
//! | [`placed`] | grids and numbers of values |
//! | [`library`], [`instance`], [`logger`] | library of the FMU, parts common to FMI 2.0 and 3.0, log messages |
//! | [`slave`], [`fmi2`], [`fmi3`] | instance, by the functions of either version |
//! | [`solver`], [`model`] | participant |
//!
//! The code of an FMU is foreign. It runs in this process, which serves one participant only, so
//! that a crash affects no other process. No code of the FMU runs before the run starts.

pub mod archive;
pub mod depth;
pub mod description;
pub mod figures;
pub mod fmi2;
pub mod fmi3;
pub mod instance;
pub mod library;
pub mod logger;
pub mod model;
pub mod placed;
pub mod slave;
pub mod solver;
pub mod start;
pub mod unit;
pub mod variable;
pub mod wiring;
