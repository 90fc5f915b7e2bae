//! Outputs of an FMU as figures of the summary: `ROLE.NAME`, small arrays element by element.

use crate::description::ModelDescription;
use crate::variable::{Causality, Variable};
use proto::figure::FigureSpec;
use proto::text::one_line;
use std::collections::BTreeSet;

/// Maximum size of an array whose values become figures.
const LARGEST: usize = 16;
/// Maximum number of figures.
const MOST: usize = 500;
/// Number of figures shown on a line of the terminal; the first ones are shown.
const SHOWN: usize = 8;

/// Output variable whose values are figures.
#[derive(Clone, Debug, PartialEq)]
pub struct Figures {
    /// The variable.
    pub variable: Variable,
    /// Last part of the key, for each value.
    pub words: Vec<String>,
    /// True if shown on a line of the terminal.
    pub shown: bool,
}

/// Returns the outputs of an FMU that are figures.
#[must_use]
pub fn figures(of: &ModelDescription) -> Vec<Figures> {
    let outputs = || of.variables.iter().filter(|one| one.causality == Causality::Output);
    // A name that is a word stays the same, also if the word of an earlier variable is equal.
    let keeps = |one: &Variable| one.size == 1 && one.word() == one.name;
    let mut taken: BTreeSet<String> =
        outputs().filter(|one| keeps(one)).map(|one| one.name.clone()).collect();
    let mut left = MOST;
    let mut figures = Vec::new();
    for variable in outputs() {
        if variable.size > LARGEST.min(left) {
            continue;
        }
        let word = variable.word();
        let one = |place: usize| match variable.size {
            1 => word.clone(),
            _ => format!("{word}_{}", place + 1),
        };
        let words = match keeps(variable) {
            true => vec![word],
            false => (0..variable.size).map(|place| free(one(place), &mut taken)).collect(),
        };
        left -= variable.size;
        let shown = MOST - left <= SHOWN;
        figures.push(Figures { variable: variable.clone(), words, shown });
    }
    figures
}

/// Returns `word`, with a number appended if already taken.
fn free(word: String, taken: &mut BTreeSet<String>) -> String {
    let numbered = (2..).map(|number| format!("{word}_{number}"));
    let mut candidates = std::iter::once(word.clone()).chain(numbered);
    let free = candidates.find(|one| !taken.contains(one)).expect("numbers do not end");
    taken.insert(free.clone());
    free
}

impl Figures {
    /// Describes the figures for the summary.
    pub fn specs(&self, role: &str) -> impl Iterator<Item = FigureSpec> {
        let Variable { name, words, unit, .. } = &self.variable;
        let (unit, said) = (unit.si(), if words.is_empty() { name } else { words });
        let said = one_line(said).into_owned();
        self.words.iter().map(move |word| {
            let spec = FigureSpec::new(&format!("{role}.{word}"), unit, &said);
            if self.shown { spec.on(role, word) } else { spec }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_output_has_a_word_of_its_own() {
        let outputs: String = ["a.b", "a_b", "der(x)", "y", "T[1]", "T_1_", "y_2"]
            .iter()
            .enumerate()
            .map(|(n, name)| {
                let of = if *name == "y" { r#"<Dimension start="2"/>"# } else { "" };
                format!(
                    r#"<Float64 name="{name}" valueReference="{n}" causality="output" unit="m">{of}</Float64>"#
                )
            })
            .collect();
        let text = format!(
            r#"<fmiModelDescription fmiVersion="3.0" modelName="m"><CoSimulation modelIdentifier="m"/>
            <ModelVariables>{outputs}</ModelVariables></fmiModelDescription>"#
        );
        let all = figures(&ModelDescription::parse(&text).unwrap());
        let words: Vec<_> = all.iter().flat_map(|one| &one.words).collect();
        let expected = ["a_b_2", "a_b", "der_x_", "y_1", "y_2_2", "T_1__2", "T_1_", "y_2"];
        assert_eq!(words, expected);
        let specs: Vec<_> = all.iter().flat_map(|one| one.specs("vehicle")).collect();
        assert!(specs.iter().all(|spec| spec.check() == Ok(()) && spec.unit == "m"));
        assert_eq!(specs[3].key, "vehicle.y_1");
    }
}
