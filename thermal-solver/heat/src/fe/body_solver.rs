//! Interface of the solvers that compute a body's temperatures from the flux into it.
//! [`super::body`] selects the solver.

use super::block::{Block, Elements};
use super::body_properties::BodyProperties;
use super::error::SolveError;
use super::section::Interpolation;
use crate::columns::reconstruction::Flux;
use crate::window::Stage;
use grids::Structured;
use std::io::{self, Read, Write};

/// Input of a solver: a body, its mesh and its settings.
#[derive(Clone, Copy)]
pub struct SolverInput<'a> {
    /// The grid of the heat flux.
    pub grid: &'a Structured,
    /// Material and surroundings of the body.
    pub nature: &'a BodyProperties,
    /// Mesh of the body.
    pub block: &'a Block,
    /// Settings of the elements.
    pub elements: &'a Elements,
}

/// Rises below a row of the surface.
pub struct Rises {
    /// Rises [K], node after node in depth, column after column.
    pub values: Vec<f64>,
    /// Distance of the first column behind the middle of the first element, in elements.
    pub behind: f64,
    /// Number of columns in an element.
    pub dense: usize,
}

/// A temperature solver with its states.
pub trait BodySolver: Send {
    /// Prepares a window of this duration [s], infinite in steady motion, at this speed [m/s].
    ///
    /// # Errors
    /// The solver does not support this speed.
    fn pass(&mut self, duration: f64, speed: f64) -> Result<(), SolveError>;

    /// Solves for the end of the window under the flux, from the accepted state. Returns the work.
    ///
    /// # Errors
    /// The equations are not solved, or a temperature is outside the material data.
    fn warm(&mut self) -> Result<u64, SolveError>;

    /// Writes the rises of the surface [K] in the last solve.
    fn show(&mut self, between: Interpolation, rise: &mut [f64]);

    /// Returns the flux into the body in the window.
    fn flux(&mut self) -> &mut Flux;

    /// Makes the last solve the accepted state.
    fn accept(&mut self);

    /// Returns the rises below a row of a state.
    fn below(&self, stage: Stage, row: usize) -> Rises;

    /// Returns whether a rise below zero can only be rounding in this state.
    fn is_heated(&self, stage: Stage) -> bool;

    /// Writes the accepted state.
    ///
    /// # Errors
    /// Writing to `into` fails.
    fn save(&self, into: &mut dyn Write) -> io::Result<()>;

    /// Reads the state written by [`BodySolver::save`] in place of the last solve;
    /// [`BodySolver::accept`] makes it the accepted state.
    ///
    /// # Errors
    /// Reading fails or the data do not fit; the accepted state is unchanged in any case.
    fn read(&mut self, from: &mut dyn Read) -> io::Result<()>;
}
