//! Manifest of an FMU, written by `coordinator fmu` beside the case or the surrogate: the
//! variables, in the order of their value references.

use serde::{Deserialize, Serialize};
use std::path::Path;

/// Name of the manifest file, in the resources of an FMU.
pub const FILE: &str = "fmu.json";

/// Name of the surrogate file, in the resources of an FMU with a surrogate.
pub const SURROGATE: &str = "surrogate.json";

/// Value reference of the time.
pub const TIME: u32 = 0;

/// Content of [`FILE`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Manifest {
    /// Token of the model description.
    pub token: String,
    /// Source of the outputs.
    pub of: Of,
    /// Live keys of the case, or keys of the surrogate. Value references count from 1.
    pub inputs: Vec<Input>,
    /// Keys of the figures. Value references follow those of the inputs.
    pub outputs: Vec<String>,
}

/// Source of the outputs of an FMU.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Of {
    /// Case, run by a coordinator.
    Case {
        /// Options of `coordinator drive` after the case; files of the case are named relative to
        /// the resources.
        options: Vec<String>,
        /// Executables in the resources.
        programs: Vec<String>,
    },
    /// Surrogate [`SURROGATE`], evaluated in the process of the host.
    Surrogate,
}

/// Live key of a case, or key of a surrogate.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Input {
    /// Dotted key.
    pub key: String,
    /// Initial value, in SI units.
    pub start: f64,
}

/// Variable that belongs to a value reference.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Variable {
    /// The time.
    Time,
    /// Input, with its index.
    Input(usize),
    /// Output, with its index.
    Output(usize),
}

impl Manifest {
    /// Reads the manifest from a folder of resources.
    ///
    /// # Errors
    /// Fails if the file is missing or does not match this version.
    pub fn read(resources: &Path) -> Result<Self, String> {
        let path = resources.join(FILE);
        let named = |error: &dyn std::fmt::Display| format!("{}: {error}", path.display());
        let text = std::fs::read(&path).map_err(|error| named(&error))?;
        serde_json::from_slice(&text).map_err(|error| named(&error))
    }

    /// Returns the variable of a value reference; `None` if there is none.
    #[must_use]
    pub fn variable(&self, reference: u32) -> Option<Variable> {
        let inputs = self.inputs.len();
        let place = usize::try_from(reference).ok()?.checked_sub(1);
        match place {
            None => Some(Variable::Time),
            Some(place) if place < inputs => Some(Variable::Input(place)),
            Some(place) if place - inputs < self.outputs.len() => {
                Some(Variable::Output(place - inputs))
            }
            Some(_) => None,
        }
    }

    /// Returns the value reference of an input by its index.
    #[must_use]
    pub fn input_reference(&self, place: usize) -> u32 {
        u32::try_from(place + 1).unwrap_or(u32::MAX)
    }

    /// Returns the value reference of an output by its index.
    #[must_use]
    pub fn output_reference(&self, place: usize) -> u32 {
        u32::try_from(place + 1 + self.inputs.len()).unwrap_or(u32::MAX)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn references_count_through() {
        let input = |key: &str| Input { key: key.to_owned(), start: 1.0 };
        let manifest = Manifest {
            token: String::new(),
            of: Of::Surrogate,
            inputs: vec![input("a"), input("b")],
            outputs: vec!["x".to_owned(), "y".to_owned(), "z".to_owned()],
        };
        let found: Vec<_> = (0..7).map(|reference| manifest.variable(reference)).collect();
        let (input, output) = (Variable::Input, Variable::Output);
        let expected = [Variable::Time, input(0), input(1), output(0), output(1), output(2)];
        assert_eq!(found[..6], expected.map(Some));
        assert_eq!(found[6], None);
        assert_eq!(manifest.variable(u32::MAX), None);
        assert_eq!(manifest.output_reference(2), 5);
        assert_eq!(manifest.input_reference(1), 2);
    }
}
