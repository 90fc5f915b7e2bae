//! Interface between wheel and rail: heights of their surfaces, and friction with the quantities it
//! may depend on.

use super::rail::Side;
use grids::Structured;
use half_space::friction::ElementFriction;
use half_space::slip_velocity::SlipStart;

/// Elements of a patch, and their motion relative to each other.
#[derive(Clone, Copy)]
pub struct Elements<'a> {
    /// Side of the track.
    pub side: Side,
    /// Grid over x in track axes and the tape distance [m].
    pub grid: Structured,
    /// Pressure [Pa].
    pub pressure: &'a [f64],
    /// x in track axes and the tape distance of the reference of the patch [m].
    pub reference: [f64; 2],
    /// Angle of the patch, from the y-axis to its tangent [rad].
    pub angle: f64,
    /// Rolling speed V [m/s].
    pub speed: f64,
    /// Slip velocity of an element if the bodies were rigid [m/s].
    pub rigid_slip: &'a dyn Fn(usize) -> f64,
    /// Slip velocity with its elastic part, for friction that depends on it [m/s].
    pub slip: Option<&'a [f64]>,
}

/// Heights and friction between wheel and rail.
pub trait Interface: Sync {
    /// True if heights are to be added to the undeformed distance.
    fn is_rough(&self) -> bool {
        false
    }

    /// Combined height of both surfaces [m] at x in track axes and a tape distance [m]. Positive
    /// opens the gap.
    fn height(&self, _side: Side, _place: [f64; 2]) -> f64 {
        0.0
    }

    /// Friction of the elements of a patch.
    ///
    /// # Errors
    /// Returns the reason if the friction law has no value here.
    fn friction(&self, elements: &Elements<'_>) -> Result<ElementFriction, String>;

    /// Returns the initial slip if friction depends on the elastic slip of every element; such
    /// contacts are iterated.
    fn follows_elements(&self) -> Option<SlipStart> {
        None
    }
}

/// Smooth bodies with a uniform coefficient of friction [-].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Constant(pub f64);

impl Interface for Constant {
    fn friction(&self, elements: &Elements<'_>) -> Result<ElementFriction, String> {
        Ok(ElementFriction::uniform(elements.grid.points(), self.0))
    }
}
