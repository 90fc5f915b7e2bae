//! The library inside an FMU of a case: functions of FMI 3.0 for co-simulation over a coordinator that
//! is driven (`coordinator drive`).
//!
//! | module | what |
//! |---|---|
//! | [`manifest`] | which case, which variables: `resources/fmu.json` |
//! | [`child`] | the coordinator that is driven: started from the resources, asked, ended |
//! | [`instance`] | an instance: its variables, windows and states |
//! | [`fmi3`] | the functions of FMI 3.0 |
//!
//! The host keeps its signals, its standard output and its children: the coordinator is in a process group
//! of its own, what it prints is read here, and it is waited for by its own number alone. It is asked through
//! a socket, on which a write to a process that has ended raises no signal.

pub mod child;
pub mod fmi3;
pub mod instance;
pub mod manifest;
