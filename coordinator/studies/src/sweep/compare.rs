//! Differences of two sweeps over the same keys, point by point: `coordinator compare`.

use super::study::{Row, Study};
use crate::study::output::StudyFile as _;
use crate::study::quantity::{Quantity, show_change};
use crate::study::table::{Cell, Column, Table};
use contract::figure::Measure;
use run::error::RunError;
use run::format::counted;
use serde::Serialize;
use std::collections::BTreeMap;
use std::path::Path;

/// Largest number of quantities on the terminal.
const MOST: usize = 24;

/// Differences between two sweeps.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SweepDifference {
    /// Differences of cases, files and programs, in words.
    pub case: Vec<String>,
    /// Number of points with the same values of the keys.
    pub points: usize,
    /// Number of points that only A, or only B, has.
    pub unmatched: [usize; 2],
    /// Number of common points with a result in one sweep only.
    pub without_result: usize,
    /// Quantities that differ: first those that participants rank or show as headlines, with the
    /// largest change first.
    pub quantities: Vec<QuantityDifference>,
    /// Number of quantities with equal digits at all points.
    pub same: usize,
}

/// A quantity that differs at some points.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct QuantityDifference {
    /// Dotted key in the summaries.
    pub key: String,
    /// Name for people.
    pub name: String,
    /// Measure of the change.
    pub measure: Measure,
    /// Number of points where the values differ.
    pub points: usize,
    /// Point with the largest change: values of the varied keys.
    pub at: Vec<String>,
    /// Values of A and B there.
    pub values: [f64; 2],
    /// Change from A to B there; absent if A is zero.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub change: Option<f64>,
}

/// Returns whether a folder holds a sweep.
#[must_use]
pub fn is_sweep(folder: &Path) -> bool {
    folder.join(Study::FILE).is_file()
}

/// Compares the sweeps in two folders.
///
/// # Errors
/// A folder holds no finished sweep, the sweeps vary different keys, or they have no common point.
pub fn compare(a: &Path, b: &Path) -> Result<SweepDifference, RunError> {
    let studies = [Study::read(a)?, Study::read(b)?];
    SweepDifference::of(&studies).map_err(|why| {
        let fix = "compare sweeps of the same keys with common values";
        RunError::Usage(format!("{} and {}: {why}; {fix}", a.display(), b.display()))
    })
}

impl SweepDifference {
    fn of([a, b]: &[Study; 2]) -> Result<Self, String> {
        let keys = |of: &Study| of.vary.iter().map(|axis| axis.key.clone()).collect::<Vec<_>>();
        if keys(a) != keys(b) {
            return Err(format!("A varies {}, B {}", keys(a).join(", "), keys(b).join(", ")));
        }
        let (of_a, mut of_b) = (by_place(a), by_place(b));
        let pairs = of_a.iter().filter_map(|(place, row)| Some((*row, of_b.remove(place)?)));
        let pairs: Vec<(&Row, &Row)> = pairs.collect();
        if pairs.is_empty() {
            return Err("they have no common point".to_owned());
        }
        let half = |(a, b): &&(&Row, &Row)| a.failed.is_some() != b.failed.is_some();
        let common = a.quantities.iter().filter(|one| b.column(&one.key).is_some());
        let count = common.clone().count();
        let found = common.filter_map(|one| difference(one, [a, b], &pairs));
        let mut quantities: Vec<QuantityDifference> = found.collect();
        let size = |one: &QuantityDifference| one.change.map_or(f64::INFINITY, f64::abs);
        quantities.sort_by(|a, b| size(b).total_cmp(&size(a)));
        // Rounding errors of 0 change most.
        quantities.sort_by_key(|one| !a.drawn.contains(&one.key));
        Ok(Self {
            case: a.identity.differences(&b.identity),
            points: pairs.len(),
            unmatched: [of_a.len() - pairs.len(), of_b.len()],
            without_result: pairs.iter().filter(half).count(),
            same: count - quantities.len(),
            quantities,
        })
    }

    /// Formats the differences for the terminal.
    #[must_use]
    pub fn text(&self) -> String {
        let mut lines: Vec<String> = self.case.iter().map(|what| format!("case: {what}")).collect();
        let [a, b] = self.unmatched.map(|count| counted(count as u64, "point"));
        lines.push(match self.unmatched {
            [0, 0] => format!("{} in both", counted(self.points as u64, "point")),
            _ => format!("{} in both, {a} only in A, {b} only in B", self.points),
        });
        if self.without_result > 0 {
            lines.push(format!("{} with a result in one only", self.without_result));
        }
        lines.push(match (self.quantities.is_empty(), self.same) {
            (true, same) => format!("all {} the same", counted(same as u64, "figure")),
            (false, same) => format!("{} the same at all points", counted(same as u64, "figure")),
        });
        let hidden = self.quantities.len().saturating_sub(MOST);
        if hidden > 0 {
            lines.push(format!("{} that differ less (--json)", counted(hidden as u64, "figure")));
        }
        let head: String = lines.iter().map(|line| format!("  {line}\n")).collect();
        let rows: Vec<&QuantityDifference> = self.quantities.iter().take(MOST).collect();
        if rows.is_empty() { head } else { head + &table().terminal(&rows) }
    }
}

/// Rows by the values of their keys; numbers count by value, however they are written.
fn by_place(study: &Study) -> BTreeMap<Vec<String>, &Row> {
    let word = |text: &str| match text.parse::<f64>() {
        Ok(number) => number.to_string(),
        Err(_) => text.trim_matches('"').to_owned(),
    };
    let place = |row| study.varied(row).map(word).collect();
    study.rows.iter().map(|row| (place(row), row)).collect()
}

/// Largest change of a quantity over pairs of rows; `None` if no value differs.
fn difference(
    one: &Quantity,
    [a, b]: [&Study; 2],
    pairs: &[(&Row, &Row)],
) -> Option<QuantityDifference> {
    let (in_a, in_b) = (a.column(&one.key)?, b.column(&one.key)?);
    let values = pairs.iter().filter_map(|(a, b)| Some((*a, [a.value(in_a)?, b.value(in_b)?])));
    let different: Vec<_> = values.filter(|(_, [a, b])| a != b).collect();
    let change = |[a, b]: [f64; 2]| one.change(a, b);
    let size = |values: [f64; 2]| change(values).map_or(f64::INFINITY, f64::abs);
    let (row, values) = *different.iter().max_by(|(_, a), (_, b)| size(*a).total_cmp(&size(*b)))?;
    Some(QuantityDifference {
        key: one.key.clone(),
        name: one.name.clone(),
        measure: one.measure,
        points: different.len(),
        at: a.varied(row).map(str::to_owned).collect(),
        values,
        change: change(values),
    })
}

fn table<'a>() -> Table<'a, QuantityDifference> {
    let shown = |one: &QuantityDifference, value: f64| {
        let largest = one.values.iter().fold(0.0, |largest: f64, value| largest.max(value.abs()));
        let quantity = Quantity::new(&one.key, &one.name, one.measure);
        Cell::text(quantity.scale(largest).show(value, 5))
    };
    Table::new(vec![
        Column::text("figure", |one: &QuantityDifference| {
            // Text after a comma explains the name.
            one.name.split(',').next().unwrap_or(&one.name).to_owned()
        }),
        Column::quantity("points", |one: &QuantityDifference| Cell::text(one.points)),
        Column::quantity("largest change", |one: &QuantityDifference| {
            Cell::text(one.change.map_or("–".to_owned(), |it| show_change(one.measure, it)))
        }),
        Column::quantity("A", move |one| shown(one, one.values[0])),
        Column::quantity("B", move |one| shown(one, one.values[1])),
        Column::text("at", |one: &QuantityDifference| one.at.join(", ")),
    ])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sweep::tests::study;

    #[test]
    fn sweeps_are_compared_where_they_have_common_points() {
        let (a, mut b) = (study(), study());
        let same = SweepDifference::of(&[a.clone(), a.clone()]).unwrap();
        assert_eq!((same.points, same.quantities.len(), same.same), (2, 0, 2));
        assert_eq!(same.text(), "  2 points in both\n  all 2 figures the same\n");
        // The same value in another form, another value, and a figure that is a tenth larger.
        b.vary[0].values = vec!["1e1".to_owned(), "30".to_owned()];
        b.rows[0].values[0] *= 1.1;
        let found = SweepDifference::of(&[a.clone(), b.clone()]).unwrap();
        assert_eq!((found.points, found.unmatched, found.same), (1, [1, 1], 1));
        let [rise] = &found.quantities[..] else { panic!("{found:?}") };
        assert_eq!((&*rise.key, &rise.at), ("heat.rise_k", &vec!["10".into(), "60 kN".into()]));
        assert!((rise.change.unwrap() - 0.1).abs() < 1e-12);
        assert!(found.text().contains("1 in both, 1 point only in A, 1 point only in B"));
        b.vary[0].key = "motion.yaw".to_owned();
        let refused = SweepDifference::of(&[a, b]).unwrap_err();
        assert!(refused.contains("A varies motion.speed, load.normal_force, B motion.yaw"));
    }
}
