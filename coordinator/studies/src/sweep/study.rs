//! State of a sweep: its description in `sweep.json`, and its points in a file of their own.

use super::design::{Design, Part};
use crate::study::axis::Axis;
use crate::study::levels::reason;
use crate::study::output::StudyFile;
use crate::study::quantity::{Quantities, Quantity};
use crate::study::runner::{Attempt, Outcome};
use console::case_arguments::Changes;
use console::keys;
use contract::description::Description;
use contract::diagram::Diagram;
use run::error::RunError;
use run::identity::Identity;
use run::plan::Planned;
use run::results::summary::Summary;
use run::warnings::Warning;
use serde::{Deserialize, Deserializer, Serialize};
use std::collections::HashSet;
use std::path::Path;

/// A sweep: the contents of `sweep.json`, and the points.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Study {
    /// Version of the file's layout.
    pub schema: u32,
    /// Whether every point has been run.
    pub complete: bool,
    /// Name of the case.
    pub case: String,
    /// Title of the case.
    pub title: Option<String>,
    /// The case file.
    pub file: String,
    /// Changes common to all runs, as options of `run`.
    pub options: Vec<String>,
    /// Programs, values and files of the first point.
    pub identity: Identity,
    /// Varied keys and their values.
    pub vary: Vec<Axis>,
    /// SI unit of each varied key: "1" for a plain number, empty if unknown.
    #[serde(default)]
    pub units: Vec<String>,
    /// Names of the varied keys, from their help texts.
    #[serde(default)]
    pub names: Vec<String>,
    /// Diagrams of the quantities, in which every point of the sweep gets a mark.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub diagrams: Vec<Diagram>,
    /// Whether point n takes the n-th value of every key; otherwise the points are all
    /// combinations.
    #[serde(default)]
    pub paired: bool,
    /// Part of the points to run; all points if absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub part: Option<Part>,
    /// Keys of the plotted quantities: the ones that participants rank or show as headlines.
    pub drawn: Vec<String>,
    /// Quantities of the runs. In a complete sweep they follow the order of the participants'
    /// descriptions, most interesting first.
    pub quantities: Vec<Quantity>,
    /// Total time of all runs \[s\].
    pub wall_s: f64,
    /// One row for each point that has been run, in the order of the points once the sweep is
    /// complete.
    #[serde(skip)]
    pub rows: Vec<Row>,
    /// Numbers of the points that have been run.
    #[serde(skip)]
    done: HashSet<usize>,
}

/// Reads values, with `null` for missing ones.
fn gaps<'de, D: Deserializer<'de>>(from: D) -> Result<Vec<f64>, D::Error> {
    let values = Vec::<Option<f64>>::deserialize(from)?;
    Ok(values.into_iter().map(|value| value.unwrap_or(f64::NAN)).collect())
}

/// One point and its results.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Row {
    /// Index into the values of each key.
    pub at: Vec<usize>,
    /// Values in the order of the sweep's quantities; `NaN` for missing values, omitted at the end.
    #[serde(default, skip_serializing_if = "Vec::is_empty", deserialize_with = "gaps")]
    pub values: Vec<f64>,
    /// Reason for a missing result.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub failed: Option<String>,
    /// Warnings about the results.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub warnings: Vec<Warning>,
    /// Time of the run \[s\].
    pub wall_s: f64,
}

/// Relative difference up to which results of two machines count as equal, because iterative runs
/// differ by rounding.
const SAME: f64 = 1e-6;

/// Identity of a sweep: the identity of its first point, plus the varied files.
fn identity(standing: &Planned, vary: &[Axis]) -> Result<Identity, RunError> {
    let mut identity = Identity::of(standing)?;
    let named = identity.files.clone();
    for axis in vary.iter().filter(|axis| named.contains_key(&axis.key)) {
        for (number, value) in axis.values.iter().enumerate() {
            let path = Path::new(value.trim_matches('"'));
            identity.add_file(&format!("{}[{}]", axis.key, number + 1), path)?;
        }
    }
    Ok(identity)
}

/// Warnings of a summary about its figures; those about the case are shown before the runs.
fn about_results(summary: &Summary) -> Vec<Warning> {
    let figures = |warning: &&Warning| summary.value(warning.key()).is_some();
    summary.warnings.iter().filter(figures).cloned().collect()
}

fn descriptions(plan: &run::plan::Plan) -> Vec<Description> {
    plan.participants.iter().map(|one| (*one.description).clone()).collect()
}

/// Units of the varied keys.
fn units(plan: &run::plan::Plan, design: &Design) -> Vec<String> {
    let described = descriptions(plan);
    keys::units(&described, design.vary.iter().map(|one| one.key.as_str()))
}

/// Names of the varied keys.
fn names(plan: &run::plan::Plan, design: &Design) -> Vec<String> {
    let described = descriptions(plan);
    keys::names(&described, design.vary.iter().map(|one| one.key.as_str()))
}

impl Row {
    /// Value of the quantity in this column.
    #[must_use]
    pub(crate) fn value(&self, column: usize) -> Option<f64> {
        self.values.get(column).copied().filter(|value| value.is_finite())
    }

    /// Moves the values to other columns: value n goes to `columns[n]`.
    #[must_use]
    pub(super) fn placed(mut self, columns: &[usize]) -> Self {
        let length = columns.iter().take(self.values.len()).map(|n| n + 1).max().unwrap_or(0);
        let mut values = vec![f64::NAN; length];
        self.values.iter().zip(columns).for_each(|(value, column)| values[*column] = *value);
        self.values = values;
        self
    }
}

impl Study {
    /// Returns a sweep without results.
    ///
    /// # Errors
    /// A file that the case names cannot be read.
    pub(super) fn new(
        standing: &Planned,
        file: String,
        base: &Changes,
        design: Design,
    ) -> Result<Self, RunError> {
        let (plan, identity) = (&standing.plan, identity(standing, &design.vary)?);
        let figures = plan.figures.iter().filter(|one| one.rank.is_some() || one.headline);
        Ok(Self {
            schema: Self::SCHEMA,
            complete: false,
            case: plan.name.clone(),
            title: plan.title.clone(),
            file,
            options: base.options(),
            identity,
            units: units(plan, &design),
            names: names(plan, &design),
            diagrams: plan.diagrams.clone(),
            vary: design.vary,
            paired: design.paired,
            part: None,
            drawn: figures.map(|figure| figure.key.clone()).collect(),
            quantities: Vec::new(),
            wall_s: 0.0,
            rows: Vec::new(),
            done: HashSet::new(),
        })
    }

    /// Returns whether another sweep has the same points and the same part.
    #[must_use]
    pub(super) fn asks_the_same(&self, other: &Self) -> bool {
        self.is_of_the_same_points(other) && self.part == other.part
    }

    /// Returns whether another sweep has the same points or a part of them. The case may differ.
    #[must_use]
    pub(super) fn is_of_the_same_points(&self, other: &Self) -> bool {
        let asked = |one: &Self| (one.schema, one.paired);
        asked(self) == asked(other) && self.vary == other.vary
    }

    /// Requires the points of another sweep to belong to the same case.
    ///
    /// # Errors
    /// The cases differ. The error names the differences.
    pub(super) fn require_same_case(
        &self,
        other: &Self,
        place: &str,
        fix: &str,
    ) -> Result<(), RunError> {
        other.identity.require_same(&self.identity, place, fix)
    }

    /// Numbers of the requested points that have not been run.
    #[must_use]
    pub(super) fn missing(&self) -> Vec<usize> {
        let part = self.part.unwrap_or(Part { one: 1, of: 1 });
        let wanted = part.numbers(self.count());
        wanted.filter(|number| !self.done.contains(number)).collect()
    }

    /// Number of points of the whole sweep, including all parts.
    #[must_use]
    pub(super) fn count(&self) -> usize {
        Design::count(&self.vary, self.paired)
    }

    /// The sweep with its points, for output as JSON.
    #[must_use]
    pub(super) fn whole(&self) -> impl Serialize {
        #[derive(Serialize)]
        struct Whole<'a> {
            #[serde(flatten)]
            study: &'a Study,
            rows: &'a [Row],
        }
        Whole { study: self, rows: &self.rows }
    }

    /// Point with this number, as an index into the values of each key.
    #[must_use]
    pub(super) fn point(&self, number: usize) -> Vec<usize> {
        Design::point(&self.vary, self.paired, number)
    }

    /// Describes a point in words.
    #[must_use]
    pub(super) fn told(&self, at: &[usize]) -> String {
        let value = |(one, at): (&Axis, &usize)| format!("{} = {}", one.key, one.values[*at]);
        self.vary.iter().zip(at).map(value).collect::<Vec<_>>().join(", ")
    }

    /// Number of a point.
    ///
    /// # Errors
    /// The point does not exist.
    pub(super) fn number(&self, at: &[usize]) -> Result<usize, String> {
        let number = Design::number(&self.vary, self.paired, at);
        number.ok_or_else(|| format!("there is no point {at:?}"))
    }

    /// Returns a sweep of one part of the points, without results.
    #[must_use]
    pub(super) fn part(&self, part: Part) -> Self {
        Self {
            part: Some(part),
            case: self.case.clone(),
            title: self.title.clone(),
            file: self.file.clone(),
            options: self.options.clone(),
            identity: self.identity.clone(),
            vary: self.vary.clone(),
            units: self.units.clone(),
            names: self.names.clone(),
            diagrams: self.diagrams.clone(),
            drawn: self.drawn.clone(),
            quantities: self.quantities.clone(),
            rows: Vec::new(),
            done: HashSet::new(),
            complete: false,
            wall_s: 0.0,
            ..*self
        }
    }

    /// Adds a row, unless its point is already known or belongs to another part. Returns whether
    /// the row was added.
    ///
    /// # Errors
    /// The point does not exist.
    pub(super) fn add(&mut self, row: Row) -> Result<bool, String> {
        let number = self.number(&row.at)?;
        let wanted = self.part.is_none_or(|part| Part::with(number, part.of) == part.one);
        let new = wanted && self.done.insert(number);
        if new {
            self.wall_s += row.wall_s;
            self.rows.push(row);
        }
        Ok(new)
    }

    /// Describes a contradiction between two rows of the same point.
    pub(super) fn contradiction(&self, row: &Row, other: &Row) -> Option<String> {
        let point = self.told(&row.at);
        if row.failed.is_some() != other.failed.is_some() {
            return Some(format!("{point} has a result in one folder and none in the other"));
        }
        self.drawn.iter().find_map(|key| {
            let column = self.column(key)?;
            let (one, other) = (row.value(column)?, other.value(column)?);
            let off = (one - other).abs() > SAME * one.abs().max(other.abs());
            off.then(|| format!("{point} has {key} = {one} in one folder and {other} in the other"))
        })
    }

    /// Registers a quantity and returns its column.
    pub(super) fn learn(&mut self, one: &Quantity) -> usize {
        self.column(&one.key).unwrap_or_else(|| {
            self.quantities.push(one.clone());
            self.quantities.len() - 1
        })
    }

    /// Column of a quantity.
    #[must_use]
    pub(crate) fn column(&self, key: &str) -> Option<usize> {
        self.quantities.iter().position(|one| one.key == key)
    }

    /// Completes the sweep: sorts rows and columns into an order independent of the order and place
    /// of the runs.
    pub(super) fn settle(&mut self, known: &Quantities) {
        self.rows.sort_by(|a, b| a.at.cmp(&b.at));
        let mut sorted = std::mem::take(&mut self.quantities);
        let keys: Vec<String> = sorted.iter().map(|one| one.key.clone()).collect();
        sorted.sort_by_key(|one| (known.place(&one.key), one.key.clone()));
        self.quantities = sorted;
        let columns: Vec<usize> = keys.iter().filter_map(|key| self.column(key)).collect();
        let rows = std::mem::take(&mut self.rows);
        self.rows = rows.into_iter().map(|row| row.placed(&columns)).collect();
        // Summing in a fixed order makes the total reproducible to the bit.
        self.wall_s = self.rows.iter().map(|row| row.wall_s).sum();
        self.complete = true;
    }

    /// Converts the run of a point into a row.
    pub(super) fn row(&mut self, at: &[usize], attempt: Attempt, quantities: &Quantities) -> Row {
        let Attempt { outcome, wall_s } = attempt;
        let (values, warnings) = (Vec::new(), Vec::new());
        let mut row = Row { at: at.to_vec(), values, failed: None, warnings, wall_s };
        match outcome {
            Outcome::Finished(run) => {
                let summary = &run.summary;
                let all = quantities.all(summary);
                for one in all.iter().filter(|one| !one.key.starts_with("coupling.")) {
                    let Some(value) = one.value(summary) else { continue };
                    let column = self.learn(one);
                    row.values.resize(row.values.len().max(column + 1), f64::NAN);
                    row.values[column] = value;
                }
                row.warnings = about_results(summary);
            }
            Outcome::Failed(error) => row.failed = Some(reason(&error)),
            Outcome::LeftOut(why) => row.failed = Some(why),
        }
        row
    }

    /// Values of the varied keys in a row.
    pub(super) fn varied<'a>(&'a self, row: &'a Row) -> impl Iterator<Item = &'a str> {
        self.vary
            .iter()
            .zip(&row.at)
            .map(|(one, at)| one.values.get(*at).map_or("", String::as_str))
    }

    /// Changing quantities and their columns, except those that merely repeat a varied key.
    pub(super) fn found(&self) -> impl Iterator<Item = (usize, &Quantity)> {
        let numbers: Vec<_> = self.vary.iter().map(|one| one.numbers().map(|all| all.0)).collect();
        let is_given = move |column: usize| {
            numbers.iter().enumerate().any(|(n, numbers)| {
                let Some(numbers) = numbers else { return false };
                let same = |row: &Row| {
                    let given = numbers[row.at[n]];
                    row.value(column)
                        .is_none_or(|value| (value - given).abs() <= 1e-9 * given.abs())
                };
                self.rows.iter().all(same)
            })
        };
        self.changing().filter(move |(column, _)| !is_given(*column))
    }

    /// Quantities that differ between rows, and their columns; all quantities if none differs, as
    /// in a sweep of one point.
    pub(super) fn changing(&self) -> impl Iterator<Item = (usize, &Quantity)> {
        let differs = |column: usize| {
            let mut values = self.rows.iter().filter_map(|row| row.value(column));
            let first = values.next();
            values.any(|value| Some(value) != first)
        };
        let all = 0..self.quantities.len();
        let none = !all.clone().any(differs);
        let kept: Vec<usize> = all.filter(|column| none || differs(*column)).collect();
        kept.into_iter().map(|column| (column, &self.quantities[column]))
    }
}
