//! The rows of a sweep as numbers: coordinates and figures at the points that a surrogate can be made of.

use super::region::within;
use crate::study::axis::Axis;
use crate::study::quantity::Quantity;
use crate::sweep::Study;
use case::parse_quantity;
use run::error::RunError;
use run::format::counted;
use surrogate::{Coordinate, Key};

/// Fewest values of a key: of fewer nothing tells how the figures go between them.
const FEWEST_VALUES: usize = 3;
/// Fewest points.
const FEWEST_POINTS: usize = 4;

/// A key over another one.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Quotient {
    /// What is divided.
    pub of: String,
    /// What it is divided by.
    pub by: String,
}

impl Quotient {
    /// Reads `KEY/KEY`.
    ///
    /// # Errors
    /// Says how it is written.
    pub(super) fn read(text: &str) -> Result<Self, String> {
        let parts =
            text.split_once('/').map(|(of, by)| (of.trim().to_owned(), by.trim().to_owned()));
        let fits = |(of, by): &(String, String)| !of.is_empty() && !by.is_empty() && of != by;
        let (of, by) = parts.filter(fits).ok_or_else(|| format!("`{text}` is not KEY/KEY"))?;
        Ok(Self { of, by })
    }
}

/// Coordinates and figures, point by point.
#[derive(Debug)]
pub(super) struct Samples {
    /// The keys with their bounds.
    pub keys: Vec<Key>,
    /// Their values at the points \[SI\].
    pub key_values: Vec<Vec<f64>>,
    /// The coordinates with their bounds.
    pub coordinates: Vec<Coordinate>,
    /// Their values at the points \[SI\].
    pub at: Vec<Vec<f64>>,
    /// The figures that all points have.
    pub figures: Vec<(Quantity, Vec<f64>)>,
    /// Points.
    pub points: usize,
    /// Points without an answer.
    pub failed: usize,
    /// Points with an answer that were left out.
    pub cut: usize,
    /// Keys of one value, as options.
    pub fixed: Vec<String>,
}

impl Samples {
    /// What a sweep has found.
    ///
    /// # Errors
    /// [`RunError::Usage`]: values that are no numbers, too few of them, a quotient of what did not vary, no
    /// box without points that have no answer.
    pub(super) fn of(study: &Study, quotients: &[Quotient]) -> Result<Self, RunError> {
        let (one_value, varied): (Vec<_>, Vec<_>) =
            study.vary.iter().enumerate().partition(|(_, axis)| has_one_value(axis));
        let mut key_values = Vec::new();
        for (n, axis) in &varied {
            let values = numbers(axis, study.units.get(*n).map_or("", String::as_str))?;
            key_values.push(study.rows.iter().map(|row| values[row.at[*n]]).collect::<Vec<f64>>());
        }
        let names: Vec<&str> = varied.iter().map(|(_, axis)| axis.key.as_str()).collect();
        let made = coordinates(&names, &key_values, quotients)?;
        let answered: Vec<bool> = study.rows.iter().map(|row| row.failed.is_none()).collect();
        let kept = {
            let quotients =
                made.iter().filter(|(_, by, _)| by.is_some()).map(|(.., values)| values);
            let bounded: Vec<&[f64]> =
                key_values.iter().chain(quotients).map(Vec::as_slice).collect();
            within(&bounded, &answered)
        };
        let keep = |all: &[f64]| {
            all.iter().zip(&kept).filter(|(_, kept)| **kept).map(|(v, _)| *v).collect()
        };
        let key_values: Vec<Vec<f64>> = key_values.iter().map(|values| keep(values)).collect();
        let at: Vec<Vec<f64>> = made.iter().map(|(.., values)| keep(values)).collect();
        let points = kept.iter().filter(|kept| **kept).count();
        let with_answer = answered.iter().filter(|answered| **answered).count();
        let failed = study.rows.len() - with_answer;
        check_rest(points, with_answer, failed)?;
        for (name, values) in
            names.iter().zip(&key_values).chain(made.iter().map(|one| &names[one.0]).zip(&at))
        {
            check_values(name, values)?;
        }
        let key = |((n, axis), values): (&(usize, &Axis), &Vec<f64>)| {
            let [from, to] = ends(values);
            Key {
                key: axis.key.clone(),
                unit: study.units.get(*n).cloned().unwrap_or_default(),
                from,
                to,
            }
        };
        let coordinate = |((of, by, _), values): (&Made, &Vec<f64>)| {
            let [from, to] = ends(values);
            Coordinate {
                key: names[*of].to_owned(),
                per: by.map(|by| names[by].to_owned()),
                from,
                to,
            }
        };
        Ok(Self {
            keys: varied.iter().zip(&key_values).map(key).collect(),
            coordinates: made.iter().zip(&at).map(coordinate).collect(),
            figures: figures(study, &kept),
            key_values,
            at,
            points,
            failed,
            cut: with_answer - points,
            fixed: one_value
                .iter()
                .map(|(_, axis)| format!("{}={}", axis.key, axis.values[0]))
                .collect(),
        })
    }
}

fn has_one_value(axis: &Axis) -> bool {
    axis.values.iter().all(|value| *value == axis.values[0])
}

/// The values of a key \[SI\].
fn numbers(axis: &Axis, unit: &str) -> Result<Vec<f64>, RunError> {
    axis.values.iter().map(|text| number(&axis.key, text, unit)).collect()
}

/// One value of a key as a case, an option or a table has it \[SI\].
///
/// # Errors
/// [`RunError::Usage`] if it is no number, or has a unit that is not one of the key.
pub(crate) fn number(key: &str, text: &str, unit: &str) -> Result<f64, RunError> {
    let text = text.trim().trim_matches(['"', '\'']);
    let plain = || text.replace('_', "").parse::<f64>().ok().filter(|value| value.is_finite());
    let wrong = |why: &dyn std::fmt::Display| RunError::Usage(format!("{key} = {text}: {why}"));
    match (plain(), unit) {
        (Some(value), _) => Ok(value),
        (None, "") => {
            Err(wrong(&"is no number; its key has no unit that is known, so give it in SI units"))
        }
        (None, unit) => parse_quantity(text, unit).map_err(|error| wrong(&error)),
    }
}

/// Numbers of the key and of the one it is divided by, and the values.
type Made = (usize, Option<usize>, Vec<f64>);

fn coordinates(
    names: &[&str],
    values: &[Vec<f64>],
    quotients: &[Quotient],
) -> Result<Vec<Made>, RunError> {
    let place = |key: &str| {
        let told = || format!("--per: `{key}` is none of the keys that vary: {}", names.join(", "));
        names.iter().position(|name| *name == key).ok_or_else(|| RunError::Usage(told()))
    };
    let mut made: Vec<Made> =
        values.iter().enumerate().map(|(n, values)| (n, None, values.clone())).collect();
    for Quotient { of, by } in quotients {
        let (of, by) = (place(of)?, place(by)?);
        let [from, to] = ends(&values[by]);
        if from <= 0.0 && to >= 0.0 {
            let key = names[by];
            return Err(RunError::Usage(format!(
                "--per: `{key}` can be 0, and nothing is divided by 0"
            )));
        }
        let quotient = values[of].iter().zip(&values[by]).map(|(of, by)| of / by).collect();
        made[of] = (of, Some(by), quotient);
    }
    Ok(made)
}

fn ends(values: &[f64]) -> [f64; 2] {
    let least = values.iter().copied().fold(f64::INFINITY, f64::min);
    [least, values.iter().copied().fold(f64::NEG_INFINITY, f64::max)]
}

fn check_rest(points: usize, with_answer: usize, failed: usize) -> Result<(), RunError> {
    if points >= FEWEST_POINTS && 2 * points >= with_answer {
        return Ok(());
    }
    let [with_answer, failed] = [with_answer, failed].map(|count| counted(count as u64, "point"));
    Err(RunError::Usage(match failed.starts_with("0 ") {
        true => format!(
            "{with_answer} with an answer are too few for a surrogate; take {FEWEST_POINTS} or more"
        ),
        false => format!(
            "{failed} have no answer, and there is no box without them that has half of the {with_answer} with an answer; \
             vary the keys less far, or take the quotient that bounds what has an answer as a coordinate, \
             `coordinator fit DIR --per KEY/KEY`"
        ),
    }))
}

fn check_values(name: &str, values: &[f64]) -> Result<(), RunError> {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted.dedup();
    if sorted.len() >= FEWEST_VALUES {
        return Ok(());
    }
    Err(RunError::Usage(format!(
        "{name} has {} at the points with an answer; a surrogate needs {FEWEST_VALUES} or more to tell how the figures go \
         between them",
        counted(sorted.len() as u64, "value")
    )))
}

/// The figures that every point has, but for those that are errors themselves.
fn figures(study: &Study, kept: &[bool]) -> Vec<(Quantity, Vec<f64>)> {
    let rows: Vec<_> =
        study.rows.iter().zip(kept).filter(|(_, kept)| **kept).map(|(row, _)| row).collect();
    let measured = study.quantities.iter().enumerate();
    let measured = measured.filter(|(_, one)| one.measure != contract::figure::Measure::Itself);
    let values = |column| rows.iter().map(|row| row.value(column)).collect::<Option<_>>();
    measured.filter_map(|(column, one)| Some((one.clone(), values(column)?))).collect()
}
