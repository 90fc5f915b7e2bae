//! Library inside an FMU, with the functions of FMI 3.0. A case runs by co-simulation in a driven
//! coordinator (`coordinator drive`). A surrogate is evaluated directly, by co-simulation or model
//! exchange.
//!
//! | module | content |
//! |---|---|
//! | [`manifest`] | `resources/fmu.json`: kind of the FMU (case or surrogate), list of variables |
//! | [`child`] | driven coordinator: start from the resources, requests, end |
//! | [`evaluator`] | evaluation of the surrogate at a point |
//! | [`instance`] | instance: variables, windows and states |
//! | [`fmi3`], [`exchange`], [`unsupported`] | functions of FMI 3.0: common, for model exchange only, unsupported |
//! | [`host`] | data passed by the host, messages to the host |
//!
//! The library does not disturb the signals, the standard output and the children of the host. The
//! coordinator runs in a process group of its own, this library reads its output, and waits for its
//! process number only. Requests go through a socket, so that a write to an ended process raises no
//! signal.

pub mod child;
pub mod evaluator;
pub mod exchange;
pub mod fmi3;
pub mod host;
pub mod instance;
pub mod manifest;
pub mod unsupported;
