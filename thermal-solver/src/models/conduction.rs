//! Trait of the models whose surface temperatures are on the grid of the heat flux; it covers only
//! what differs between them. [`super::conduction_model`] turns an implementation into a complete
//! model. A model with other unknowns implements [`proto::model::Model`] itself, with the same
//! helpers: [`super::setup`], [`super::inputs`] and [`super::summary`].

use super::frame::Frame;
use super::summary::Peak;
use crate::capability::Capability;
use heat::window::{Drive, Stage};
use proto::accuracy::Simplification;
use proto::configuration::Refusal;
use proto::grid::Grid;
use proto::model::StepError;
use std::io::{self, Read, Write};

/// Expected cost of a model.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Cost {
    /// Processor time of one solve [s].
    pub solve_seconds: f64,
    /// Memory of the model's arrays [byte].
    pub memory_bytes: u64,
}

/// Loads of the interface between the bodies, averaged over a window.
#[derive(Clone, Copy, Debug)]
pub struct InterfaceLoad<'a> {
    /// Friction power density of the elements [W/m²].
    pub flux: &'a [f64],
    /// Contact pressure of the elements [Pa], if the model needs it.
    pub pressure: Option<&'a [f64]>,
    /// Gap between the surfaces at the elements [m], if the model needs it.
    pub gap: Option<&'a [f64]>,
}

/// Operation count of a solve, and the heat into the bodies.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SolveStats {
    /// Elementary operations, in a unit of the model's choice.
    pub operations: u64,
    /// Shares of the friction heat that entered the upper and the lower body, without the exchanged
    /// flux, summed over the elements [W/m²].
    pub heat: [f64; 2],
}

/// Heat conduction on the grid of the heat flux.
pub trait Conduction: Sized + 'static {
    /// True if the model supports transient cases.
    const TRANSIENT: bool;
    /// True if the model supports a stationary body in a steady case.
    const SOLVES_STATIONARY_BODY: bool;
    /// True if rise integrals keep an influence in memory for every earlier window.
    const KEEPS_WINDOWS: bool = false;
    /// True if the model has elements of its own ([`heat::fe::block`]).
    const ELEMENTS: bool = false;
    /// True if both surfaces are in contact permanently, or return to it periodically.
    const REPEATS: bool = false;
    /// True if the bodies are finite with a fixed far-end temperature, so that a stationary body
    /// has a steady state and thermal expansion. The surfaces may separate.
    const ENDS: bool = false;
    /// Optional capabilities of the model.
    const CAPABILITIES: &'static [Capability];
    /// Tag that marks saved states of this model.
    const STATE_TAG: u8;

    /// Refuses a case that the model does not support for reasons beyond its constants.
    ///
    /// # Errors
    /// An unsupported setting of the case.
    fn check(_: &Frame) -> Result<(), Refusal> {
        Ok(())
    }

    /// Creates the model in its initial state and allocates all memory.
    fn new(frame: &Frame) -> Self;

    /// Returns the expected cost.
    fn cost(frame: &Frame) -> Cost;

    /// Returns remarks for the plan of the run.
    fn remarks(_: &Frame) -> Vec<String> {
        Vec::new()
    }

    /// Returns warnings about the case.
    fn warnings(_: &Frame) -> Vec<Refusal> {
        Vec::new()
    }

    /// Returns a simplification that applies to this case in addition to those of the model's
    /// description.
    fn left_out(frame: &Frame) -> Option<Simplification>;

    /// Returns the surface rise [K] of a body before the first window, and its integral over the
    /// depth [K·m].
    fn first(&self, _body: usize) -> [f64; 2] {
        [0.0; 2]
    }

    /// Computes the surface rises of the upper and the lower body [K] at the end of a window that
    /// starts from the accepted state.
    ///
    /// # Errors
    /// A solve that does not converge; inputs for which there is no solution.
    fn solve(
        &mut self,
        drive: &Drive,
        rub: &InterfaceLoad<'_>,
        rise: &mut [Vec<f64>; 2],
    ) -> Result<SolveStats, StepError>;

    /// Computes the rise of a body after the last solve, integrated over its depth, at the elements
    /// of its surface [K·m]. Returns the number of multiply-adds.
    fn rise_integral(&mut self, _body: usize, _integral: &mut [f64]) -> u64 {
        0
    }

    /// Returns the flux from the upper into the lower body in the last solve, without their shares
    /// of the friction heat, summed over the elements [W/m²]. `None` if no heat flows between them.
    fn exchanged(&self) -> Option<f64> {
        None
    }

    /// Accepts the last solve.
    fn accept(&mut self);

    /// Computes the rises [K] of a body along a row at the depths c = z/(2√κ) [√s], depth after
    /// depth. The points are the centres of the elements and of the [`Frame::behind`] columns
    /// behind them.
    fn section(&mut self, stage: Stage, body: usize, row: usize, depths: &[f64], rise: &mut [f64]);

    /// Returns the rise [K] of a body in the accepted state at any x [m] of a row and at the depth
    /// c [√s].
    fn rise_at(&self, body: usize, row: usize, x: f64, depth: f64) -> f64;

    /// Returns the grid of a body's elements; `None` if the model has no elements.
    fn volume(_: &Frame, _body: usize) -> Option<Grid> {
        None
    }

    /// Computes the rises [K] of a body's elements in the accepted state.
    fn rises_in(&self, _body: usize, _rises: &mut [f64]) {}

    /// Returns the hottest point of a body in the accepted state, among the rows in which the given
    /// surface rises are not zero; `None` if no rise is positive.
    fn peak(&self, body: usize, rise: &[f64]) -> Option<Peak>;

    /// Writes the accepted state.
    ///
    /// # Errors
    /// A failure to write to `into`.
    fn save(&self, into: &mut dyn Write) -> io::Result<()>;

    /// Reads a state that [`Conduction::save`] wrote.
    ///
    /// # Errors
    /// Data of another size, or a failure to read them; the state is then unchanged.
    fn restore(&mut self, from: &mut dyn Read) -> io::Result<()>;
}
