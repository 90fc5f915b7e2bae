//! Solvers and models: the traits that a participant implements.
//!
//! A solver crate offers a [`Solver`]. `configure` turns a configuration into a cheap [`Setup`]
//! that knows grids and cost but has allocated nothing; `build` turns that into the [`Model`]
//! that runs. The split is what lets a plan be made without starting anything.

pub use contract::step::{Step, StepReport};

use crate::advice::{Opinion, Scene};
use crate::configuration::{Configuration, Layout, Refusal};
use crate::description::Description;
use crate::field::FieldSpec;
use crate::grid::Grid;
use crate::progress::Progress;
use std::io::{self, Read, Write};

/// A participant's program: describes itself and sets up models.
pub trait Solver {
    /// Description of its models, effects, keys and fields.
    fn description(&self) -> Description;
    /// Checks a configuration and prepares a model; cheap, allocates no field.
    fn configure(&self, configuration: &Configuration) -> Result<Setup, Refusal>;
    /// Advice on its effects in a scene; empty unless the description says that it advises.
    fn advise(&self, _scene: &Scene) -> Opinion {
        Opinion::default()
    }
}

/// A checked configuration, from which a model is built.
pub struct Setup {
    layout: Layout,
    build: Build,
}

/// Builds a model.
type Build = Box<dyn FnOnce(&Progress) -> Result<Box<dyn Model>, Refusal>>;

impl Setup {
    /// Takes the layout of a configuration and what builds its model: `build` allocates everything
    /// that the model needs, so that nothing is allocated in a steady step. A build that takes long
    /// reports its progress; a model whose solves do keeps a clone.
    pub fn new(
        layout: Layout,
        build: impl FnOnce(&Progress) -> Result<Box<dyn Model>, Refusal> + 'static,
    ) -> Self {
        Self { layout, build: Box::new(build) }
    }

    /// Grids, of volumes the announced ones ([`Grid::announced`]), placement of the fields and
    /// expected cost.
    #[must_use]
    pub fn layout(&self) -> &Layout {
        &self.layout
    }

    /// Builds the model.
    ///
    /// # Errors
    /// A case that turns out to have no model only now.
    pub fn build(self, progress: &Progress) -> Result<Box<dyn Model>, Refusal> {
        (self.build)(progress)
    }
}

/// Inputs of a solve, read in place.
pub trait Inputs: Sync {
    /// Values of a field, component-major, with its grid; `None` when no active effect needs it.
    fn get(&self, field: &FieldSpec) -> Option<InputField<'_>>;

    /// Values of a field at the start of the window, component-major, as long as those of
    /// [`Inputs::get`]; within the window the field goes in a straight line from these to those.
    /// `None` for a field that does not vary within a window.
    fn start(&self, _field: &FieldSpec) -> Option<&[f64]> {
        None
    }
}

/// One input.
#[derive(Clone, Copy, Debug)]
pub struct InputField<'a> {
    /// `components * points` values, component-major.
    pub values: &'a [f64],
    /// Where they live: the grid of this very sample, if it is one that moves.
    pub grid: &'a Grid,
}

/// Outputs of a solve, written where consumers will read them.
pub trait Outputs {
    /// The place for a field's values, component-major; `None` when nobody needs the field. Every
    /// value must be written; the place holds old data before, and marks in some of it, by which an
    /// output that was not written is noticed.
    fn get(&mut self, field: &FieldSpec) -> Option<&mut [f64]>;
}

/// Why a solve failed.
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
    /// An input that the model cannot do without is missing.
    #[error("input `{field}` is missing")]
    MissingInput {
        /// Name of the field.
        field: String,
    },
    /// The model has no solution, or its solver did not find it.
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

/// A model that runs. `solve` always starts from the last accepted state, so a window may be
/// solved any number of times; only `accept` moves on.
pub trait Model {
    /// Solves one window from the accepted state with the given inputs, writes the outputs.
    fn solve(
        &mut self,
        step: &Step,
        inputs: &dyn Inputs,
        outputs: &mut dyn Outputs,
    ) -> Result<StepReport, StepError>;

    /// Writes the outputs that hold before the first solve.
    fn first_outputs(&mut self, outputs: &mut dyn Outputs);

    /// Whether the last solve may become the accepted state. An answer that is good for an iteration
    /// on its way only is refused here, which ends the run.
    ///
    /// # Errors
    /// Why it may not.
    fn acceptable(&self) -> Result<(), StepError> {
        Ok(())
    }

    /// Makes the last solve the accepted state.
    fn accept(&mut self);

    /// The grids of the layout that may move, as they are in the accepted state, and the volumes, with
    /// their geometry from the building on. One that has changed has a higher revision. They change with [`Model::accept`] and [`Model::restore`]
    /// alone, so that geometry is constant through the iterations of a window. Quadrilaterals and
    /// volumes keep their elements; a structured grid may grow.
    fn moved_grids(&self) -> &[Grid] {
        &[]
    }

    /// Writes the observed fields of the window that was accepted last, on the grids that it was
    /// solved on: where `accept` has moved them to holds from the next window on.
    fn observe(&mut self, outputs: &mut dyn Outputs);

    /// The part of `summary.json` that is this model's: an object of sections, whose keys are
    /// merged over the participants (`{"contact": {...}}`, `{"temperature": {...}}`).
    fn summary(&self) -> serde_json::Value;

    /// Writes the accepted state, piece by piece: it need not be in memory twice.
    ///
    /// # Errors
    /// Those of `into`.
    fn save(&self, into: &mut dyn Write) -> io::Result<()>;

    /// Reads back what [`Model::save`] wrote; a run continues from it bit-identically. The caller sees
    /// that all of it has been read.
    ///
    /// # Errors
    /// A state that does not fit, or ends too early; the run then ends.
    fn restore(&mut self, from: &mut dyn Read) -> Result<(), StateError>;
}

/// Finds the first value that is not finite: one pass that a compiler vectorises, and a search
/// only when there is something to find.
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
