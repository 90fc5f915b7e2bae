//! Cases in `cases/contact`, checked against reference values in `cases/contact/values.toml`.

use crate::harness::{Place, Table, case, number};
use serde::Deserialize;
use serde_json::Value;
use std::collections::BTreeSet;
use std::fmt::Write as _;

const FOLDER: &str = "contact";

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Values {
    run: Vec<Run>,
}

/// Case with options and reference values.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Run {
    case: String,
    #[serde(default)]
    set: Vec<String>,
    #[serde(default)]
    unset: Vec<String>,
    source: Option<String>,
    error: Option<String>,
    figures: Vec<Figure>,
}

/// Figure of the summary, or of a row of the history, counted from 1.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Figure {
    of: String,
    row: Option<usize>,
    value: f64,
    relative: Option<f64>,
    absolute: Option<f64>,
    source: Option<String>,
    error: Option<String>,
}

impl Run {
    fn name(&self) -> String {
        let options = |flag: &'static str, of: &[String]| -> String {
            of.iter().map(|option| format!(" {flag} {option}")).collect()
        };
        let [set, unset] = [options("--set", &self.set), options("--unset", &self.unset)];
        format!("{FOLDER}/{}.toml{set}{unset}", self.case)
    }

    /// Describes the figures outside their tolerances, one per line.
    fn misses(&self) -> String {
        let place = Place::new();
        let option = |flag, of: &'_ str| [flag, of].map(str::to_owned);
        let set = self.set.iter().flat_map(|key| option("--set", key));
        let more: Vec<String> =
            set.chain(self.unset.iter().flat_map(|key| option("--unset", key))).collect();
        let more: Vec<&str> = more.iter().map(String::as_str).collect();
        let summary = place.summary(&case(&format!("{FOLDER}/{}.toml", self.case)), &more);
        let history = place.table("history.csv");
        let mut misses = String::new();
        for figure in &self.figures {
            let (found, tolerance) = (figure.found(&summary, &history), figure.tolerance());
            // NaN counts as outside.
            let met = (found - figure.value).abs() <= tolerance;
            if !met {
                let source = figure.source.as_ref().or(self.source.as_ref()).unwrap();
                let error = figure.error.as_ref().or(self.error.as_ref()).unwrap();
                let row = figure.row.map_or_else(String::new, |row| format!(", row {row}"));
                let _ = writeln!(
                    misses,
                    "{}: {}{row}: {found:e} is not {:e} ± {tolerance:e} ({source}; {error})",
                    self.name(),
                    figure.of,
                    figure.value,
                );
            }
        }
        misses
    }
}

impl Figure {
    fn found(&self, summary: &Value, history: &Table) -> f64 {
        match self.row {
            // Other rows may lack the figure: a contact with two patches has no creepage.
            Some(row) => history.texts(&self.of)[row - 1].parse().unwrap_or(f64::NAN),
            None => number(summary, &format!("/{}", self.of.replace('.', "/"))),
        }
    }

    fn tolerance(&self) -> f64 {
        let relative = self.relative.map(|share| share * self.value.abs());
        relative.or(self.absolute).unwrap()
    }
}

fn values() -> Vec<Run> {
    let text = std::fs::read_to_string(case(&format!("{FOLDER}/values.toml"))).unwrap();
    toml::from_str::<Values>(&text).unwrap().run
}

/// Every case has reference values, and all values belong to a case. Each value has one tolerance
/// above zero, a source, and the error that the tolerance covers.
#[test]
fn every_case_of_the_folder_has_values() {
    let runs = values();
    let entries = std::fs::read_dir(case(FOLDER)).unwrap().flatten();
    let names = entries.filter_map(|entry| {
        let name = entry.file_name().into_string().unwrap();
        name.strip_suffix(".toml").filter(|name| *name != "values").map(str::to_owned)
    });
    let cases: BTreeSet<String> = names.collect();
    let valued: BTreeSet<String> = runs.iter().map(|run| run.case.clone()).collect();
    assert_eq!(cases, valued, "the cases of the folder, and those of values.toml");
    let distinct: BTreeSet<String> = runs.iter().map(Run::name).collect();
    assert_eq!(distinct.len(), runs.len(), "a run stands there twice");
    for run in &runs {
        assert!(!run.figures.is_empty(), "{}", run.name());
        for figure in &run.figures {
            let told = format!("{}: {}", run.name(), figure.of);
            assert!(figure.relative.is_some() != figure.absolute.is_some(), "{told}");
            assert!(figure.tolerance() > 0.0, "{told}: a value of 0 needs an absolute tolerance");
            assert!(figure.source.is_some() || run.source.is_some(), "{told}: no source");
            assert!(figure.error.is_some() || run.error.is_some(), "{told}: no error");
        }
    }
}

/// Runs the cases whose names start with one of these, and reports all deviations.
fn met(of: &[&str]) {
    let runs = values();
    let runs = runs.iter().filter(|run| of.iter().any(|part| run.case.starts_with(part)));
    let misses: String = runs.map(Run::misses).collect();
    assert!(misses.is_empty(), "\n{misses}");
}

const MANCHESTER: &[&str] = &["manchester"];
const CREEP_CURVES: &[&str] = &["creep-curve"];
const HEAT: &[&str] = &["sliding-heat", "hot-wheel", "creep-heat"];

table_of_tests! {
    met:
    the_manchester_benchmark_is_met(MANCHESTER);
    creep_curves_are_met(CREEP_CURVES);
    heat_is_met(HEAT);
}

/// All other cases, including new ones.
#[test]
fn the_other_examples_are_met() {
    let runs = values();
    let apart = [MANCHESTER, CREEP_CURVES, HEAT].concat();
    let others = runs.iter().filter(|run| !apart.iter().any(|part| run.case.starts_with(part)));
    let misses: String = others.map(Run::misses).collect();
    assert!(misses.is_empty(), "\n{misses}");
}
