//! What is between wheel and rail: heights of their surfaces, and friction with what it may depend on.

use super::rail::Side;
use grids::Structured;
use half_space::friction::ElementFriction;
use half_space::slip_iteration::SlipStart;

/// The elements of a patch, and how they move over each other.
#[derive(Clone, Copy)]
pub struct Elements<'a> {
    /// Side of the track.
    pub side: Side,
    /// Over x in track axes and the tape distance [m].
    pub grid: Structured,
    /// Pressure [Pa].
    pub pressure: &'a [f64],
    /// x in track axes and the tape distance of the reference of the patch [m].
    pub reference: [f64; 2],
    /// Angle of the patch, from the y-axis to its tangent [rad].
    pub angle: f64,
    /// Rolling speed V [m/s].
    pub speed: f64,
    /// Slip velocity that an element would have if the bodies were rigid [m/s].
    pub rigid_slip: &'a dyn Fn(usize) -> f64,
    /// Slip velocity with its elastic part, where friction follows that [m/s].
    pub slip: Option<&'a [f64]>,
}

/// Heights and friction between wheel and rail.
pub trait Interface: Sync {
    /// Heights are to be added to the undeformed distance.
    fn is_rough(&self) -> bool {
        false
    }

    /// Height of both surfaces at x in track axes and a tape distance [m]; positive opens the gap [m].
    fn height(&self, _side: Side, _place: [f64; 2]) -> f64 {
        0.0
    }

    /// Friction of the elements of a patch.
    ///
    /// # Errors
    /// There is none, and why.
    fn friction(&self, elements: &Elements<'_>) -> Result<ElementFriction, String>;

    /// It follows the slip of every element with its elastic part, looked for from here.
    fn follows_elements(&self) -> Option<SlipStart> {
        None
    }
}

/// Smooth bodies with a coefficient of friction that is the same everywhere [-].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Constant(pub f64);

impl Interface for Constant {
    fn friction(&self, elements: &Elements<'_>) -> Result<ElementFriction, String> {
        Ok(ElementFriction::uniform(elements.grid.points(), self.0))
    }
}
