//! How a body's temperatures follow from the flux into it: what differs from one way to solve for them to the
//! next. [`super::body`] chooses.

use super::block::{Block, Elements};
use super::body_properties::BodyProperties;
use super::error::SolveError;
use super::section::Interpolation;
use crate::columns::reconstruction::Flux;
use crate::window::Stage;
use grids::Structured;
use std::io::{self, Read, Write};

/// A body, its mesh and its settings, for which a solver is made.
#[derive(Clone, Copy)]
pub struct Given<'a> {
    /// The grid of the heat flux.
    pub grid: &'a Structured,
    /// Material and surroundings of the body.
    pub nature: &'a BodyProperties,
    /// Its mesh.
    pub block: &'a Block,
    /// Settings of the elements.
    pub elements: &'a Elements,
}

/// Rises below a row.
pub struct Rises {
    /// Node after node in depth, column after column [K].
    pub values: Vec<f64>,
    /// Distance of the first column behind the middle of the first element, in elements.
    pub behind: f64,
    /// Columns in an element.
    pub dense: usize,
}

/// A way to solve, with its states.
pub trait BodySolver: Send {
    /// Prepares a window of this duration [s], infinite in steady motion, at this speed [m/s].
    ///
    /// # Errors
    /// The speed is none that it can solve for.
    fn pass(&mut self, duration: f64, speed: f64) -> Result<(), SolveError>;

    /// Solves for the end of the window, from the accepted state, under the flux; the work.
    ///
    /// # Errors
    /// There is no solution.
    fn warm(&mut self) -> Result<u64, SolveError>;

    /// Rises of the surface [K] in the last solve.
    fn show(&mut self, between: Interpolation, rise: &mut [f64]);

    /// The flux into the body in the window.
    fn flux(&mut self) -> &mut Flux;

    /// The last solve becomes the accepted state.
    fn accept(&mut self);

    /// Rises below a row of a state.
    fn below(&self, stage: Stage, row: usize) -> Rises;

    /// A state in which anything below zero is rounding.
    fn is_heated(&self, stage: Stage) -> bool;

    /// Writes the accepted state.
    ///
    /// # Errors
    /// Errors of `into`.
    fn save(&self, into: &mut dyn Write) -> io::Result<()>;

    /// Reads back what [`BodySolver::save`] wrote.
    ///
    /// # Errors
    /// It does not fit; then nothing has changed.
    fn restore(&mut self, from: &mut dyn Read) -> io::Result<()>;
}
