//! An instance of an FMU for co-simulation, whichever version of FMI it follows.

use crate::logger::{DISCARD, FATAL, Logger, OK, Status, WARNING};
use crate::variable::Variable;
use std::ffi::c_void;

/// A function of FMI that has not done what it should.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct Fault(pub String);

/// A state of the FMU, which only it can read.
#[derive(Debug, PartialEq, Eq)]
pub struct Kept(pub *mut c_void);

/// What is done with an instance, in the order of the functions.
pub trait Slave {
    /// Sets the values of a variable, in its own unit.
    ///
    /// # Errors
    /// The FMU's words.
    fn set(&mut self, variable: &Variable, values: &[f64]) -> Result<(), Fault>;

    /// Reads the values of a variable, in its own unit.
    ///
    /// # Errors
    /// The FMU's words.
    fn get(&mut self, variable: &Variable, values: &mut [f64]) -> Result<(), Fault>;

    /// Ends the setting of parameters; time begins at 0.
    ///
    /// # Errors
    /// The FMU's words.
    fn start(&mut self) -> Result<(), Fault>;

    /// Steps from `start` [s] over `length` [s].
    ///
    /// # Errors
    /// The FMU's words; it wants to end, or has returned early.
    fn step(&mut self, start: f64, length: f64) -> Result<(), Fault>;

    /// Keeps the present state, in the place of an earlier one.
    ///
    /// # Errors
    /// The FMU's words.
    fn keep(&mut self, state: &mut Kept) -> Result<(), Fault>;

    /// Returns to a state.
    ///
    /// # Errors
    /// The FMU's words.
    fn return_to(&mut self, state: &Kept) -> Result<(), Fault>;

    /// A state as bytes.
    ///
    /// # Errors
    /// The FMU's words.
    fn bytes(&mut self, state: &Kept) -> Result<Vec<u8>, Fault>;

    /// A state from bytes, in the place of an earlier one.
    ///
    /// # Errors
    /// The FMU's words.
    fn read_bytes(&mut self, bytes: &[u8], state: &mut Kept) -> Result<(), Fault>;

    /// Frees a state.
    fn free(&mut self, state: &mut Kept);
}

/// Whether an instance can still be used, and what it has said.
#[derive(Debug, Default)]
pub struct Health {
    /// Where it is told.
    pub logger: Box<Logger>,
    /// No function may be called any more.
    pub fatal: bool,
}

impl Health {
    /// What a function has returned.
    ///
    /// # Errors
    /// Neither fine nor fine with a warning.
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
        Err(Fault(format!("{function} has returned {what}{said}")))
    }

    /// Refuses to use an instance after a fatal error.
    ///
    /// # Errors
    /// There was one.
    pub fn usable(&self) -> Result<(), Fault> {
        match self.fatal {
            true => Err(Fault("the FMU has ended with a fatal error before".to_owned())),
            false => Ok(()),
        }
    }
}
