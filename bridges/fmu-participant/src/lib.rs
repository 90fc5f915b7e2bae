//! An FMU of another program as a participant: FMI 2.0 and 3.0 for co-simulation.
//!
//! | module | what |
//! |---|---|
//! | [`archive`] | the archive that an FMU is: limited, whatever it claims |
//! | [`description`], [`depth`], [`variable`], [`unit`] | `modelDescription.xml` |
//! | [`wiring`] | which variables give fields, and which receive them |
//! | [`figures`], [`start`] | outputs as figures; parameters as keys of the case |
//! | [`placed`] | grids, and numbers of values |
//! | [`library`], [`instance`], [`logger`] | the library inside, what FMI 2.0 and 3.0 have alike, and what it says |
//! | [`slave`], [`fmi2`], [`fmi3`] | an instance, by the functions of either version |
//! | [`solver`], [`model`] | the participant |
//!
//! An FMU is code of somebody else: it runs in this process, which is the participant's own, and what it spoils is this
//! process alone. Of the file nothing is run before a run starts.

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
