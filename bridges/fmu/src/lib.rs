//! The library inside an FMU: functions of FMI 3.0, of a case for co-simulation over a coordinator that is driven
//! (`coordinator drive`), of a surrogate for co-simulation and model exchange by evaluating it.
//!
//! | module | what |
//! |---|---|
//! | [`manifest`] | a case or a surrogate, which variables: `resources/fmu.json` |
//! | [`child`] | the coordinator that is driven: started from the resources, asked, ended |
//! | [`evaluator`] | the surrogate, and its figures at a point |
//! | [`instance`] | an instance: its variables, windows and states |
//! | [`fmi3`], [`exchange`], [`unsupported`] | the functions of FMI 3.0: those of all instances, those of model exchange, those of neither |
//! | [`host`] | what a host passes, and what it is told |
//!
//! The host keeps its signals, its standard output and its children: the coordinator is in a process group
//! of its own, what it prints is read here, and it is waited for by its own number alone. It is asked through
//! a socket, on which a write to a process that has ended raises no signal.

pub mod child;
pub mod evaluator;
pub mod exchange;
pub mod fmi3;
pub mod host;
pub mod instance;
pub mod manifest;
pub mod unsupported;
