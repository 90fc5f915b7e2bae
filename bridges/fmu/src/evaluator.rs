//! Evaluation of a surrogate in the process of the host.

use super::manifest::{Manifest, SURROGATE};
use std::path::Path;
use surrogate::{Surrogate, Workspace};

/// Surrogate with the scratch buffers of an evaluation.
#[derive(Debug)]
pub struct Evaluator {
    surrogate: Surrogate,
    room: Workspace,
}

impl Evaluator {
    /// Reads the surrogate from a folder of resources.
    ///
    /// # Errors
    /// Fails if the file is missing or invalid, or if its keys and figures differ from the
    /// manifest.
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
            return Err(named(&"its keys and figures differ from the variables of this FMU"));
        }
        let room = surrogate.room();
        Ok(Self { surrogate, room })
    }

    /// Writes the figures at a point; `at` holds the value of each key in SI units. Writes NaN to
    /// all figures if the point is refused.
    ///
    /// # Errors
    /// Fails if the point lies outside the region the surrogate was built for.
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
