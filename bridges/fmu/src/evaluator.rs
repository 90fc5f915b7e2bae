//! A surrogate, evaluated in the process of the host.

use super::manifest::{Manifest, SURROGATE};
use std::path::Path;
use surrogate::{Room, Surrogate};

/// A surrogate with the room that an evaluation needs.
#[derive(Debug)]
pub struct Evaluator {
    surrogate: Surrogate,
    room: Room,
}

impl Evaluator {
    /// Reads the surrogate of a folder of resources.
    ///
    /// # Errors
    /// It is not there, is no surrogate, or not the one that the manifest is of; in words.
    pub fn read(resources: &Path, manifest: &Manifest) -> Result<Self, String> {
        let path = resources.join(SURROGATE);
        let named = |error: &dyn std::fmt::Display| format!("{}: {error}", path.display());
        let text = std::fs::read(&path).map_err(|error| named(&error))?;
        let surrogate = Surrogate::read(&text).map_err(|error| named(&error))?;
        let keys = surrogate.keys().iter().map(|key| &key.key);
        let figures = surrogate.figures().iter().map(|figure| &figure.key);
        if !keys.eq(manifest.inputs.iter().map(|input| &input.key))
            || !figures.eq(&manifest.outputs)
        {
            return Err(named(&"its keys and figures are not the variables of this FMU"));
        }
        let room = surrogate.room();
        Ok(Self { surrogate, room })
    }

    /// Writes the figures at a point \[SI\], which has the value of each key; NaN for all where there is no
    /// answer.
    ///
    /// # Errors
    /// The point is outside of the region that the surrogate was made in; in words.
    pub fn figures(&mut self, at: &[f64], figures: &mut [f64]) -> Result<(), String> {
        match self.surrogate.ask(at, &mut self.room) {
            Ok(found) => {
                figures.copy_from_slice(found);
                Ok(())
            }
            Err(refused) => {
                figures.fill(f64::NAN);
                Err(refused.to_string())
            }
        }
    }
}
