//! What `coordinator fmu` leaves beside the case or the surrogate: which variables there are, in the order of
//! their value references.

use serde::{Deserialize, Serialize};
use std::path::Path;

/// The file, in the resources of an FMU.
pub const FILE: &str = "fmu.json";

/// The surrogate, in the resources of an FMU that has one.
pub const SURROGATE: &str = "surrogate.json";

/// The value reference of the time.
pub const TIME: u32 = 0;

/// Content of [`FILE`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Manifest {
    /// The token of the model description.
    pub token: String,
    /// What gives the outputs.
    pub of: Of,
    /// Live keys of the case, or keys of the surrogate; their value references count from 1.
    pub inputs: Vec<Input>,
    /// Keys of the figures; their value references go on from those of the inputs.
    pub outputs: Vec<String>,
}

/// What gives the outputs of an FMU.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Of {
    /// A case, which a coordinator runs.
    Case {
        /// Options of `coordinator drive` behind the case, such as files of the case by their names here.
        options: Vec<String>,
        /// Executables of the resources.
        programs: Vec<String>,
    },
    /// A surrogate, [`SURROGATE`], which is evaluated in the process of the host.
    Surrogate,
}

/// A live key, or a key of a surrogate.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Input {
    /// The dotted key.
    pub key: String,
    /// Its first value, in SI units.
    pub start: f64,
}

/// What a value reference means.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Variable {
    /// The time.
    Time,
    /// An input, by its place.
    Input(usize),
    /// An output, by its place.
    Output(usize),
}

impl Manifest {
    /// Reads the file of a folder of resources.
    ///
    /// # Errors
    /// There is none, or it is not of this version; in words.
    pub fn read(resources: &Path) -> Result<Self, String> {
        let path = resources.join(FILE);
        let named = |error: &dyn std::fmt::Display| format!("{}: {error}", path.display());
        let text = std::fs::read(&path).map_err(|error| named(&error))?;
        serde_json::from_slice(&text).map_err(|error| named(&error))
    }

    /// What a value reference means.
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

    /// The value reference of an input, by its place.
    #[must_use]
    pub fn input_reference(&self, place: usize) -> u32 {
        u32::try_from(place + 1).unwrap_or(u32::MAX)
    }

    /// The value reference of an output, by its place.
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
