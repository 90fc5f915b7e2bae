//! What an accepted contact is to a term, and what a term remembers of it.

use crate::terms::surface::Surface;
use proto::model::StateError;
use std::io::{self, Read, Write};

/// State of a term. A term without any leaves all of it out.
pub(crate) trait State: Send + Sync {
    /// The last solve becomes the accepted state.
    fn accept(&mut self) {}

    /// Writes the accepted state.
    ///
    /// # Errors
    /// Those of `into`.
    fn save(&self, _into: &mut dyn Write) -> io::Result<()> {
        Ok(())
    }

    /// Reads back what [`State::save`] wrote.
    ///
    /// # Errors
    /// It does not fit.
    fn restore(&mut self, _from: &mut dyn Read) -> Result<(), StateError> {
        Ok(())
    }
}

/// The contact as it was accepted.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Accepted<'a> {
    /// Pressure [Pa].
    pub(crate) pressure: &'a [f64],
    /// Tractions on the upper body, x then y [Pa].
    pub(crate) traction: &'a [f64],
    /// Velocity of the upper body relative to the lower one, x then y [m/s].
    pub(crate) slip_velocity: &'a [f64],
    /// Friction power density [W/m²].
    pub(crate) friction_power: &'a [f64],
    /// Speeds at which the material of both bodies passes through [m/s].
    pub(crate) surface_speed: [f64; 2],
    /// The rises of both bodies integrated over their depth, where they expand and that is observed [K·m].
    pub(crate) heated: Option<[Surface<'a>; 2]>,
}
