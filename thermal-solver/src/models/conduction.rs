//! A way to conduct heat whose surface temperatures are on the grid of the heat flux: what differs from
//! one such model to the next. [`super::conduction_model`] makes a model of it. A model with other unknowns
//! implements [`proto::model::Model`] itself, with the same helpers beside it: [`super::setup`],
//! [`super::inputs`] and [`super::summary`].

use super::frame::Frame;
use super::summary::Peak;
use heat::window::{Drive, Stage};
use proto::accuracy::Simplification;
use proto::configuration::Refusal;
use proto::grid::Grid;
use proto::model::StepError;
use std::io::{self, Read, Write};

/// Expected cost of a model.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Cost {
    /// Processor seconds of one solve.
    pub solve_seconds: f64,
    /// Memory of the model's arrays [byte].
    pub memory_bytes: u64,
}

/// What happens where the bodies touch, mean of a window.
#[derive(Clone, Copy, Debug)]
pub struct InterfaceLoad<'a> {
    /// Friction power density of the elements [W/m²].
    pub flux: &'a [f64],
    /// Contact pressure of the elements, where it matters [Pa].
    pub pressure: Option<&'a [f64]>,
    /// Distance of the surfaces of the elements, where it matters [m].
    pub gap: Option<&'a [f64]>,
}

/// What a solve cost and what heat it put into the bodies.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SolveStats {
    /// Elementary operations, in the model's own measure.
    pub operations: u64,
    /// Sums over the elements of the shares of the friction heat that went into the upper and the lower body, without what
    /// flows between them [W/m²].
    pub heat: [f64; 2],
}

/// A way to conduct heat on the grid of the heat flux.
pub trait Conduction: Sized + 'static {
    /// It can answer a transient case.
    const TRANSIENT: bool;
    /// It can answer for a body at rest in a steady case.
    const SOLVES_STATIONARY_BODY: bool;
    /// For what the heat does to the height of the surfaces it keeps what every window of the past does.
    const KEEPS_WINDOWS: bool = false;
    /// It has elements of its own ([`heat::fe::block`]).
    const ELEMENTS: bool = false;
    /// Every place of both surfaces is always rubbed, or always again.
    const REPEATS: bool = false;
    /// Its bodies end where they are held, so that those at rest have a steady state and height; they may be apart.
    const ENDS: bool = false;
    /// Marks its states among those of other models.
    const STATE_TAG: u8;

    /// Refuses what it has no answer to, beyond what its constants say.
    ///
    /// # Errors
    /// There is some.
    fn check(_: &Frame) -> Result<(), Refusal> {
        Ok(())
    }

    /// Allocates everything.
    fn new(frame: &Frame) -> Self;

    /// Expected cost.
    fn cost(frame: &Frame) -> Cost;

    /// Remarks for the plan.
    fn remarks(frame: &Frame) -> Vec<String>;

    /// What it leaves out in this case beyond what its description says.
    fn left_out(frame: &Frame) -> Option<Simplification>;

    /// Rise of a body's surface [K] before the first window, and its integral over the depth [K·m].
    fn first(&self, _body: usize) -> [f64; 2] {
        [0.0; 2]
    }

    /// Surface rises of the upper and the lower body [K] at the end of a window, from the accepted state.
    fn solve(
        &mut self,
        drive: &Drive,
        rub: &InterfaceLoad<'_>,
        rise: &mut [Vec<f64>; 2],
    ) -> Result<SolveStats, StepError>;

    /// Rise of a body after the last solve, integrated over its depth, at the elements of its surface [K·m]; the
    /// multiply-adds that it took.
    fn rise_integral(&mut self, _body: usize, _integral: &mut [f64]) -> u64 {
        0
    }

    /// What flowed from the upper into the lower body in the last solve besides their shares of the friction heat, summed over the
    /// elements [W/m²]; `None` where nothing flows between them.
    fn exchanged(&self) -> Option<f64> {
        None
    }

    /// The last solve becomes the accepted state.
    fn accept(&mut self);

    /// Rises [K] of a body along a row at some depths c = z/(2√κ) [√s], at the element centres and those of
    /// the [`Frame::behind`] columns behind them, depth after depth.
    fn section(&mut self, stage: Stage, body: usize, row: usize, depths: &[f64], rise: &mut [f64]);

    /// Rise [K] of a body in the accepted state at any x [m] of a row, at the depth c [√s].
    fn rise_at(&self, body: usize, row: usize, x: f64, depth: f64) -> f64;

    /// The elements of a body, for a model that has some.
    fn volume(_: &Frame, _body: usize) -> Option<Grid> {
        None
    }

    /// Rises [K] of a body's elements in the accepted state.
    fn rises_in(&self, _body: usize, _rises: &mut [f64]) {}

    /// The hottest place of a body in the accepted state, whose surface rises are given, among the
    /// rows in which they are not zero; `None` if nothing is warm.
    fn peak(&self, body: usize, rise: &[f64]) -> Option<Peak>;

    /// Writes the accepted state.
    ///
    /// # Errors
    /// Those of `into`.
    fn save(&self, into: &mut dyn Write) -> io::Result<()>;

    /// Reads back what [`Conduction::save`] wrote.
    ///
    /// # Errors
    /// It does not fit; then nothing has changed.
    fn restore(&mut self, from: &mut dyn Read) -> io::Result<()>;
}
