//! Traits of solvers and models, implemented by participants.
//!
//! A solver crate provides a [`Solver`]. `configure` turns a configuration into a cheap [`Setup`],
//! which knows grids and cost but has allocated nothing. `build` turns the setup into the [`Model`]
//! that runs. Because of this split, a plan can be made without starting anything.

pub use contract::step::{Step, StepReport};

use crate::advice::{Opinion, Scene};
use crate::configuration::{Configuration, Layout, Refusal};
use crate::description::Description;
use crate::field::FieldSpec;
use crate::grid::Grid;
use crate::progress::Progress;
use std::io::{self, Read, Write};

/// Program of a participant: describes itself and configures models.
pub trait Solver {
    /// Returns the description of models, effects, keys and fields.
    fn description(&self) -> Description;
    /// Checks a configuration and prepares a model. Cheap; allocates no fields.
    fn configure(&self, configuration: &Configuration) -> Result<Setup, Refusal>;
    /// Returns advice on the effects in a scene; empty unless the description announces advice.
    fn advise(&self, _scene: &Scene) -> Opinion {
        Opinion::default()
    }
}

/// A checked configuration, ready to build its model.
pub struct Setup {
    layout: Layout,
    build: Build,
}

type Build = Box<dyn FnOnce(&Progress) -> Result<Box<dyn Model>, Refusal>>;

impl Setup {
    /// Returns a setup with this layout and a function that builds the model. `build` allocates all
    /// memory of the model, so that steady steps allocate nothing. It reports the progress of a
    /// long build; a model with long solves keeps a clone of the [`Progress`].
    pub fn new(
        layout: Layout,
        build: impl FnOnce(&Progress) -> Result<Box<dyn Model>, Refusal> + 'static,
    ) -> Self {
        Self { layout, build: Box::new(build) }
    }

    /// Returns the grids, the placement of the fields and the expected cost. Volumes are announced
    /// only ([`Grid::announced`]).
    #[must_use]
    pub fn layout(&self) -> &Layout {
        &self.layout
    }

    /// Builds the model.
    ///
    /// # Errors
    /// Fails if the case is found to be unsolvable only while building.
    pub fn build(self, progress: &Progress) -> Result<Box<dyn Model>, Refusal> {
        (self.build)(progress)
    }
}

/// Inputs of a solve, read in place.
pub trait Inputs: Sync {
    /// Returns the values of a field, component-major, with its grid; `None` if no active effect
    /// needs the field.
    fn get(&self, field: &FieldSpec) -> Option<InputField<'_>>;

    /// Returns the values of a field at the start of the window, component-major, with the same
    /// length as those of [`Inputs::get`]. Within the window the field varies linearly from these
    /// values to those of [`Inputs::get`]. `None` for a field that is constant within a window.
    fn start(&self, _field: &FieldSpec) -> Option<&[f64]> {
        None
    }
}

/// Values of an input and their grid.
#[derive(Clone, Copy, Debug)]
pub struct InputField<'a> {
    /// `components * points` values, component-major.
    pub values: &'a [f64],
    /// Grid of the values; for a moving grid, in the revision of this sample.
    pub grid: &'a Grid,
}

/// Outputs of a solve, written directly into shared memory.
pub trait Outputs {
    /// Returns the buffer for the values of a field, component-major; `None` if nobody needs the
    /// field. Every value must be written. The buffer holds old data and some marks, by which
    /// unwritten outputs are detected.
    fn get(&mut self, field: &FieldSpec) -> Option<&mut [f64]>;
}

/// Reason for the failure of a solve.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum StepError {
    /// An input holds a NaN or an infinity.
    #[error("input `{field}` is not finite at index {index} ({value})")]
    NonFiniteInput {
        /// Name of the field.
        field: String,
        /// Index of the first such value.
        index: usize,
        /// The value.
        value: f64,
    },
    /// A required input is missing.
    #[error("input `{field}` is missing")]
    MissingInput {
        /// Name of the field.
        field: String,
    },
    /// The model has no solution, or the solver did not find one.
    #[error("{0}")]
    NoSolution(String),
}

/// A state that cannot be restored.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("state does not fit: {0}")]
pub struct StateError(pub String);

impl From<io::Error> for StateError {
    fn from(error: io::Error) -> Self {
        Self(match error.kind() {
            io::ErrorKind::UnexpectedEof => "it is truncated".to_owned(),
            _ => error.to_string(),
        })
    }
}

/// A running model. `solve` always starts from the last accepted state, so a window may be solved
/// any number of times; only `accept` advances the state.
pub trait Model {
    /// Solves one window from the accepted state with the given inputs and writes the outputs.
    fn solve(
        &mut self,
        step: &Step,
        inputs: &dyn Inputs,
        outputs: &mut dyn Outputs,
    ) -> Result<StepReport, StepError>;

    /// Writes the initial outputs, before the first solve.
    fn first_outputs(&mut self, outputs: &mut dyn Outputs);

    /// Checks whether the last solve may become the accepted state. A model refuses a solution here
    /// that is good enough for an iteration but not for acceptance; the run then ends.
    ///
    /// # Errors
    /// Fails with the reason why the solution is unacceptable.
    fn acceptable(&self) -> Result<(), StepError> {
        Ok(())
    }

    /// Makes the last solve the accepted state.
    fn accept(&mut self);

    /// Returns the moving grids of the layout in the accepted state, and the volumes, with their
    /// geometry from construction on. A changed grid has a higher revision. Grids change only in
    /// [`Model::accept`] and [`Model::restore`], so that the geometry is constant through the
    /// iterations of a window. Quadrilaterals and volumes keep their elements; a structured grid
    /// may grow.
    fn moved_grids(&self) -> &[Grid] {
        &[]
    }

    /// Writes the observed fields of the last accepted window, on the grids of its solve. Grids
    /// moved by `accept` take effect from the next window on.
    fn observe(&mut self, outputs: &mut dyn Outputs);

    /// Returns this model's part of `summary.json`: an object of sections, whose keys are merged
    /// over the participants (`{"contact": {...}}`, `{"temperature": {...}}`).
    fn summary(&self) -> serde_json::Value;

    /// Writes the accepted state piece by piece, to avoid a second copy in memory.
    ///
    /// # Errors
    /// Fails if writing to `into` fails.
    fn save(&self, into: &mut dyn Write) -> io::Result<()>;

    /// Reads back the output of [`Model::save`]; the run then continues bit-identically. The caller
    /// checks that all bytes have been read.
    ///
    /// # Errors
    /// Fails for a state that does not fit or ends too early; the run then ends.
    fn restore(&mut self, from: &mut dyn Read) -> Result<(), StateError>;
}

/// Returns the index of the first value that is not finite. A vectorised pass looks for any such
/// value; only then a search locates it.
#[must_use]
pub fn first_non_finite(values: &[f64]) -> Option<usize> {
    const EXPONENT: u64 = 0x7ff0_0000_0000_0000;
    let bad = |v: &f64| v.to_bits() & EXPONENT == EXPONENT;
    for (block, chunk) in values.chunks(1024).enumerate() {
        if chunk.iter().fold(false, |any, v| any | bad(v)) {
            return chunk.iter().position(bad).map(|i| block * 1024 + i);
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn finds_the_first_non_finite_value() {
        let mut values = vec![f64::MAX; 5000];
        assert_eq!(first_non_finite(&values), None);
        values[4001] = f64::NEG_INFINITY;
        assert_eq!(first_non_finite(&values), Some(4001));
        values[1023] = f64::NAN;
        assert_eq!(first_non_finite(&values), Some(1023));
    }
}
