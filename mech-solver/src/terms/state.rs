//! Accepted contact as seen by a term, and the state that a term keeps.

use crate::terms::surface::Surface;
use proto::model::StateError;
use std::io::{self, Read, Write};

/// State of a term. The default methods are those of a term without state.
pub(crate) trait State: Send + Sync {
    /// Accepts the last solve.
    fn accept(&mut self) {}

    /// Writes the accepted state.
    ///
    /// # Errors
    /// A failure to write.
    fn save(&self, _into: &mut dyn Write) -> io::Result<()> {
        Ok(())
    }

    /// Restores the state that [`State::save`] wrote.
    ///
    /// # Errors
    /// Data that does not match the term.
    fn restore(&mut self, _from: &mut dyn Read) -> Result<(), StateError> {
        Ok(())
    }
}

/// Accepted solution of a contact.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Accepted<'a> {
    /// Pressure that bounds the tractions [Pa].
    pub(crate) pressure: &'a [f64],
    /// Pressure of the normal contact, not resampled from displaced rows [Pa].
    pub(crate) normal_pressure: &'a [f64],
    /// Tractions on the upper body, x then y [Pa].
    pub(crate) traction: &'a [f64],
    /// Velocity of the upper body relative to the lower one, x then y [m/s].
    pub(crate) slip_velocity: &'a [f64],
    /// Friction power density [W/m²].
    pub(crate) friction_power: &'a [f64],
    /// Speeds at which the material of both bodies passes through the contact [m/s].
    pub(crate) surface_speed: [f64; 2],
    /// Temperature rises of both bodies, integrated over depth [K·m], if the bodies expand and a
    /// term observes them.
    pub(crate) heated: Option<[Surface<'a>; 2]>,
}
