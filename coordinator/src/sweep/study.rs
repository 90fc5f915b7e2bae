//! What a sweep has found so far: `sweep.json`, and `sweep.csv` for everything else.

use super::design::{Design, Part, points_of};
use crate::keys;
use crate::study::Variant;
use crate::study::axis::Axis;
use crate::study::output::Kept;
use crate::study::quantity::Quantity;
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, HashSet};

/// A sweep, as `sweep.json` has it.
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
    /// What varies.
    pub vary: Vec<Axis>,
    /// The SI unit of each key that varies, "1" for a plain number, empty if it is not known.
    #[serde(default)]
    pub units: Vec<String>,
    /// The n-th values of all keys are a point; otherwise all combinations are.
    #[serde(default)]
    pub paired: bool,
    /// Only this part of the points is wanted.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub part: Option<Part>,
    /// Keys of the quantities that are drawn: those that participants rank, or show large.
    pub drawn: Vec<String>,
    /// The quantities that the runs give, those of most interest first.
    pub quantities: Vec<Quantity>,
    /// One for each point that has been run, in the order of the points.
    pub rows: Vec<Row>,
    /// Seconds of all runs.
    pub wall_s: f64,
}

impl Kept for Study {
    const COMMAND: &'static str = "sweep";
    const FILE: &'static str = "sweep.json";
    const SCHEMA: u32 = 1;
}

/// One point.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Row {
    /// An index into the values of each key.
    pub at: Vec<usize>,
    /// Quantities by key; empty where there is no answer.
    pub values: BTreeMap<String, f64>,
    /// Why there is no answer.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub failed: Option<String>,
    /// Seconds of the run.
    pub wall_s: f64,
}

/// The units of what varies.
fn units(plan: &run::plan::Plan, design: &Design) -> Vec<String> {
    let described: Vec<_> = plan.participants.iter().map(|one| one.description.clone()).collect();
    keys::units(&described, design.vary.iter().map(|one| one.key.as_str()))
}

impl Study {
    /// A sweep of which nothing has been run.
    #[must_use]
    pub(super) fn new(
        plan: &run::plan::Plan,
        file: String,
        base: &Variant,
        design: Design,
    ) -> Self {
        let figures = plan.figures.iter().filter(|one| one.rank.is_some() || one.headline);
        Self {
            schema: Self::SCHEMA,
            complete: false,
            case: plan.name.clone(),
            title: plan.title.clone(),
            file,
            options: base.options(),
            units: units(plan, &design),
            vary: design.vary,
            paired: design.paired,
            part: None,
            drawn: figures.map(|figure| figure.key.clone()).collect(),
            quantities: Vec::new(),
            rows: Vec::new(),
            wall_s: 0.0,
        }
    }

    /// Another one is of the same points of the same case.
    #[must_use]
    pub(super) fn asks_the_same(&self, other: &Self) -> bool {
        self.is_of_the_same_points(other) && self.part == other.part
    }

    /// Another one is of the same points of the same case, or of a part of them.
    #[must_use]
    fn is_of_the_same_points(&self, other: &Self) -> bool {
        let asked =
            |one: &Self| (one.file.clone(), one.options.clone(), one.vary.clone(), one.paired);
        self.schema == other.schema && asked(self) == asked(other)
    }

    /// The points that are wanted and have not been run.
    #[must_use]
    pub(super) fn missing(&self) -> Vec<Vec<usize>> {
        let done: HashSet<&Vec<usize>> = self.rows.iter().map(|row| &row.at).collect();
        let mut wanted = points_of(&self.vary, self.paired, self.part);
        wanted.retain(|at| !done.contains(at));
        wanted
    }

    /// Takes what another sweep of the same points, or of a part of them, has found; false if it is of others.
    #[must_use]
    pub(super) fn collect(&mut self, other: Self) -> bool {
        if !self.is_of_the_same_points(&other) {
            return false;
        }
        let wanted: HashSet<Vec<usize>> = self.missing().into_iter().collect();
        for row in other.rows.into_iter().filter(|row| wanted.contains(&row.at)) {
            self.wall_s += row.wall_s;
            self.rows.push(row);
        }
        other.quantities.iter().for_each(|one| self.learn(one));
        self.rows.sort_by(|a, b| a.at.cmp(&b.at));
        true
    }

    /// A run has this quantity.
    pub(super) fn learn(&mut self, one: &Quantity) {
        if self.quantities.iter().all(|other| other.key != one.key) {
            self.quantities.push(one.clone());
        }
    }

    /// The values of a row's keys.
    pub(super) fn varied<'a>(&'a self, row: &'a Row) -> impl Iterator<Item = &'a str> {
        self.vary
            .iter()
            .zip(&row.at)
            .map(|(one, at)| one.values.get(*at).map_or("", String::as_str))
    }

    /// The quantities that are not the same in all rows: those are what a sweep is for.
    pub(super) fn changing(&self) -> impl Iterator<Item = &Quantity> {
        self.quantities.iter().filter(|one| {
            let mut values = self.rows.iter().filter_map(|row| row.values.get(&one.key));
            let first = values.next();
            values.any(|value| Some(value) != first)
        })
    }

    /// A row a point: keys, quantities by their keys in `summary.json`, seconds, and why there is no answer.
    #[must_use]
    pub(super) fn csv(&self) -> Vec<u8> {
        let mut out = csv::Writer::from_writer(Vec::new());
        let keys = self.vary.iter().map(|one| one.key.as_str());
        let quantities = self.quantities.iter().map(|one| one.key.as_str());
        // A writer into memory does not fail.
        let _ = out.write_record(keys.chain(quantities).chain(["wall_s", "failed"]));
        for row in &self.rows {
            let values = self.quantities.iter().map(|one| row.values.get(&one.key));
            let values = values.map(|value| value.map(f64::to_string).unwrap_or_default());
            let ends = [row.wall_s.to_string(), row.failed.clone().unwrap_or_default()];
            let _ = out.write_record(self.varied(row).map(str::to_owned).chain(values).chain(ends));
        }
        out.into_inner().unwrap_or_default()
    }
}
