//! Instance of an FMU for co-simulation, independent of the FMI version.

use crate::logger::{DISCARD, FATAL, Logger, OK, Status, WARNING};
use crate::variable::Variable;
use std::ffi::c_void;

/// Error of a function of FMI.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct Fault(pub String);

/// State of the FMU, opaque to this program.
#[derive(Debug, PartialEq, Eq)]
pub struct Kept(pub *mut c_void);

/// Values for the initialisation, each of which may be unknown.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Experiment {
    /// Time beyond which no step leads \[s\].
    pub stop: Option<f64>,
    /// Relative tolerance of the solver in the FMU.
    pub tolerance: Option<f64>,
}

/// Operations on an instance, in the order of use.
pub trait Slave {
    /// Sets the values of a variable, in its own unit.
    ///
    /// # Errors
    /// Fails if the FMU returns an error.
    fn set(&mut self, variable: &Variable, values: &[f64]) -> Result<(), Fault>;

    /// Reads the values of a variable, in its own unit.
    ///
    /// # Errors
    /// Fails if the FMU returns an error.
    fn get(&mut self, variable: &Variable, values: &mut [f64]) -> Result<(), Fault>;

    /// Ends the initialisation, after the parameters are set. Time starts at 0.
    ///
    /// # Errors
    /// Fails if the FMU returns an error.
    fn start(&mut self, experiment: &Experiment) -> Result<(), Fault>;

    /// Takes a step from `start` [s] of length `length` [s].
    ///
    /// # Errors
    /// Fails if the FMU returns an error, requests the end of the simulation, or returns early.
    fn step(&mut self, start: f64, length: f64) -> Result<(), Fault>;

    /// Saves the present state, replacing an earlier one.
    ///
    /// # Errors
    /// Fails if the FMU returns an error.
    fn keep(&mut self, state: &mut Kept) -> Result<(), Fault>;

    /// Restores a saved state.
    ///
    /// # Errors
    /// Fails if the FMU returns an error.
    fn return_to(&mut self, state: &Kept) -> Result<(), Fault>;

    /// Serialises a state.
    ///
    /// # Errors
    /// Fails if the FMU returns an error.
    fn bytes(&mut self, state: &Kept) -> Result<Vec<u8>, Fault>;

    /// Reads a serialised state, replacing an earlier one.
    ///
    /// # Errors
    /// Fails if the FMU returns an error.
    fn read_bytes(&mut self, bytes: &[u8], state: &mut Kept) -> Result<(), Fault>;

    /// Frees a state.
    fn free(&mut self, state: &mut Kept);
}

/// Usability of an instance, and its log.
#[derive(Debug, Default)]
pub struct Health {
    /// Receiver of log messages.
    pub logger: Box<Logger>,
    /// True after a fatal error: no function may be called.
    pub fatal: bool,
}

impl Health {
    /// Checks the status returned by a function.
    ///
    /// # Errors
    /// Fails if the status is neither success nor success with a warning.
    pub fn check(&mut self, function: &str, status: Status) -> Result<(), Fault> {
        let what = match status {
            OK | WARNING => return Ok(()),
            DISCARD => "fmiDiscard",
            FATAL => {
                self.fatal = true;
                "fmiFatal"
            }
            _ => "fmiError",
        };
        let said = self.logger.take().map_or_else(String::new, |text| format!(": {text}"));
        Err(Fault(format!("{function} returned {what}{said}")))
    }

    /// Checks that the instance is usable.
    ///
    /// # Errors
    /// Fails after a fatal error.
    pub fn usable(&self) -> Result<(), Fault> {
        match self.fatal {
            true => Err(Fault("the FMU has failed with a fatal error before".to_owned())),
            false => Ok(()),
        }
    }
}
