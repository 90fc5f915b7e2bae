//! What a sweep has found so far: what it is of in `sweep.json`, its points in a file of their own.

use super::design::{Design, Part};
use crate::study::Variant;
use crate::study::axis::Axis;
use crate::study::output::Kept;
use crate::study::quantity::{Quantities, Quantity};
use console::keys;
use contract::diagram::Diagram;
use run::error::RunError;
use run::identity::Identity;
use run::plan::Planned;
use serde::{Deserialize, Deserializer, Serialize};
use std::collections::HashSet;
use std::path::Path;

/// A sweep, as `sweep.json` has it, and its points.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Study {
    /// Version of this layout.
    pub schema: u32,
    /// Every point has been run.
    pub complete: bool,
    /// Name of the case.
    pub case: String,
    /// What the case is about.
    pub title: Option<String>,
    /// The case file.
    pub file: String,
    /// What is changed for all runs, as options of `run`.
    pub options: Vec<String>,
    /// Programs, values and files of the first point.
    pub identity: Identity,
    /// What varies.
    pub vary: Vec<Axis>,
    /// The SI unit of each key that varies, "1" for a plain number, empty if it is not known.
    #[serde(default)]
    pub units: Vec<String>,
    /// Names of the keys that vary, from their help.
    #[serde(default)]
    pub names: Vec<String>,
    /// Diagrams of the quantities, among which every point of the sweep has its mark.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub diagrams: Vec<Diagram>,
    /// The n-th values of all keys are a point; otherwise all combinations are.
    #[serde(default)]
    pub paired: bool,
    /// Only this part of the points is wanted.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub part: Option<Part>,
    /// Keys of the quantities that are drawn: those that participants rank, or show large.
    pub drawn: Vec<String>,
    /// The quantities that the runs give: when the sweep is complete in the order in which participants describe
    /// them, those of most interest first.
    pub quantities: Vec<Quantity>,
    /// Seconds of all runs.
    pub wall_s: f64,
    /// One for each point that has been run; when the sweep is complete in the order of the points.
    #[serde(skip)]
    pub rows: Vec<Row>,
    /// The numbers of the points that have been run.
    #[serde(skip)]
    done: HashSet<usize>,
}

/// Values with `null` where there is none.
fn gaps<'de, D: Deserializer<'de>>(from: D) -> Result<Vec<f64>, D::Error> {
    let values = Vec::<Option<f64>>::deserialize(from)?;
    Ok(values.into_iter().map(|value| value.unwrap_or(f64::NAN)).collect())
}

/// One point.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Row {
    /// An index into the values of each key.
    pub at: Vec<usize>,
    /// The quantities of the sweep, in their order; `NaN` where there is none, and none at the end.
    #[serde(default, skip_serializing_if = "Vec::is_empty", deserialize_with = "gaps")]
    pub values: Vec<f64>,
    /// Why there is no answer.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub failed: Option<String>,
    /// Seconds of the run.
    pub wall_s: f64,
}

/// Part of a figure that the arithmetic of two machines may differ by, in a run that iterates.
const SAME: f64 = 1e-6;

/// The identity of a sweep: that of its first point, with the files that vary.
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

/// The units of what varies.
fn units(plan: &run::plan::Plan, design: &Design) -> Vec<String> {
    let described: Vec<_> = plan.participants.iter().map(|one| one.description.clone()).collect();
    keys::units(&described, design.vary.iter().map(|one| one.key.as_str()))
}

/// Name of the key that varies.
fn names(plan: &run::plan::Plan, design: &Design) -> Vec<String> {
    let described: Vec<_> = plan.participants.iter().map(|one| one.description.clone()).collect();
    keys::names(&described, design.vary.iter().map(|one| one.key.as_str()))
}

impl Row {
    /// The quantity of this column.
    #[must_use]
    pub(crate) fn value(&self, column: usize) -> Option<f64> {
        self.values.get(column).copied().filter(|value| value.is_finite())
    }

    /// Its values in other columns: the n-th is put into the n-th of these.
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
    /// A sweep of which nothing has been run.
    ///
    /// # Errors
    /// A file that the case names cannot be read.
    pub(super) fn new(
        standing: &Planned,
        file: String,
        base: &Variant,
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

    /// Another one is of the same points, and of the same part of them.
    #[must_use]
    pub(super) fn asks_the_same(&self, other: &Self) -> bool {
        self.is_of_the_same_points(other) && self.part == other.part
    }

    /// Another one is of the same points, or of a part of them. Its case may be another one.
    #[must_use]
    pub(super) fn is_of_the_same_points(&self, other: &Self) -> bool {
        let asked = |one: &Self| (one.schema, one.paired);
        asked(self) == asked(other) && self.vary == other.vary
    }

    /// Demands that the points of another sweep are of the same case.
    ///
    /// # Errors
    /// Names what differs.
    pub(super) fn require_same_case(
        &self,
        other: &Self,
        place: &str,
        fix: &str,
    ) -> Result<(), RunError> {
        other.identity.require_same(&self.identity, place, fix)
    }

    /// The numbers of the points that are wanted and have not been run.
    #[must_use]
    pub(super) fn missing(&self) -> Vec<usize> {
        let part = self.part.unwrap_or(Part { one: 1, of: 1 });
        let wanted = part.numbers(self.count());
        wanted.filter(|number| !self.done.contains(number)).collect()
    }

    /// How many points the sweep has, all its parts together.
    #[must_use]
    pub(super) fn count(&self) -> usize {
        Design::count(&self.vary, self.paired)
    }

    /// The sweep with its points, as JSON is printed.
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

    /// The point of this number: an index into the values of each key.
    #[must_use]
    pub(super) fn point(&self, number: usize) -> Vec<usize> {
        Design::point(&self.vary, self.paired, number)
    }

    /// A point in words.
    #[must_use]
    pub(super) fn told(&self, at: &[usize]) -> String {
        let value = |(one, at): (&Axis, &usize)| format!("{} = {}", one.key, one.values[*at]);
        self.vary.iter().zip(at).map(value).collect::<Vec<_>>().join(", ")
    }

    /// The number of a point.
    ///
    /// # Errors
    /// There is no such point.
    pub(super) fn number(&self, at: &[usize]) -> Result<usize, String> {
        let number = Design::number(&self.vary, self.paired, at);
        number.ok_or_else(|| format!("there is no point {at:?}"))
    }

    /// A sweep of a part of these points, of which nothing has been run.
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

    /// Adds a row, unless its point has been run, or is not wanted; whether it was added.
    ///
    /// # Errors
    /// There is no such point.
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

    /// A contradiction between two rows of the same point, in words.
    pub(super) fn contradiction(&self, row: &Row, other: &Row) -> Option<String> {
        let point = self.told(&row.at);
        if row.failed.is_some() != other.failed.is_some() {
            return Some(format!("{point} has an answer in one folder and none in another"));
        }
        self.drawn.iter().find_map(|key| {
            let column = self.column(key)?;
            let (one, other) = (row.value(column)?, other.value(column)?);
            let off = (one - other).abs() > SAME * one.abs().max(other.abs());
            off.then(|| format!("{point} has {key} = {one} in one folder and {other} in another"))
        })
    }

    /// A run has this quantity; its column.
    pub(super) fn learn(&mut self, one: &Quantity) -> usize {
        self.column(&one.key).unwrap_or_else(|| {
            self.quantities.push(one.clone());
            self.quantities.len() - 1
        })
    }

    /// The column of a quantity.
    #[must_use]
    pub(crate) fn column(&self, key: &str) -> Option<usize> {
        self.quantities.iter().position(|one| one.key == key)
    }

    /// Every point has been run: rows and columns get an order that does not depend on what was run first, and where.
    pub(super) fn settle(&mut self, known: &Quantities) {
        self.rows.sort_by(|a, b| a.at.cmp(&b.at));
        let mut sorted = std::mem::take(&mut self.quantities);
        let keys: Vec<String> = sorted.iter().map(|one| one.key.clone()).collect();
        sorted.sort_by_key(|one| (known.place(&one.key), one.key.clone()));
        self.quantities = sorted;
        let columns: Vec<usize> = keys.iter().filter_map(|key| self.column(key)).collect();
        let rows = std::mem::take(&mut self.rows);
        self.rows = rows.into_iter().map(|row| row.placed(&columns)).collect();
        // A sum of the same numbers in another order is another one.
        self.wall_s = self.rows.iter().map(|row| row.wall_s).sum();
        self.complete = true;
    }

    /// The values of a row's keys.
    pub(super) fn varied<'a>(&'a self, row: &'a Row) -> impl Iterator<Item = &'a str> {
        self.vary
            .iter()
            .zip(&row.at)
            .map(|(one, at)| one.values.get(*at).map_or("", String::as_str))
    }

    /// The changing quantities that are not one of the keys that vary themselves, and their columns.
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

    /// The quantities that are not the same in all rows: those are what a sweep is for; and their columns.
    pub(super) fn changing(&self) -> impl Iterator<Item = (usize, &Quantity)> {
        self.quantities.iter().enumerate().filter(|(column, _)| {
            let mut values = self.rows.iter().filter_map(|row| row.value(*column));
            let first = values.next();
            values.any(|value| Some(value) != first)
        })
    }
}
