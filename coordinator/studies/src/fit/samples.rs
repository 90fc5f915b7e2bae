//! The rows of a sweep as numbers: coordinates and figures at the points used for a surrogate,
//! restricted to a large box free of failed points.

use crate::study::axis::Axis;
use crate::study::quantity::Quantity;
use crate::sweep::Study;
use case::parse_quantity;
use run::error::RunError;
use run::format::counted;
use surrogate::{Coordinate, Key};

/// Minimum number of distinct values of a key, below which the dependence between the values is
/// unknown.
const FEWEST_VALUES: usize = 3;
/// Minimum number of points.
const FEWEST_POINTS: usize = 4;

/// The quotient of two keys.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Quotient {
    /// Key of the dividend.
    pub of: String,
    /// Key of the divisor.
    pub by: String,
}

impl Quotient {
    /// Parses `KEY/KEY`.
    ///
    /// # Errors
    /// The text has another form.
    pub(super) fn read(text: &str) -> Result<Self, String> {
        let parts =
            text.split_once('/').map(|(of, by)| (of.trim().to_owned(), by.trim().to_owned()));
        let fits = |(of, by): &(String, String)| !of.is_empty() && !by.is_empty() && of != by;
        let (of, by) = parts.filter(fits).ok_or_else(|| format!("`{text}` is not KEY/KEY"))?;
        Ok(Self { of, by })
    }
}

/// Coordinates and figures at the points.
#[derive(Debug)]
pub(super) struct Samples {
    /// Keys with their bounds.
    pub keys: Vec<Key>,
    /// Values of the keys at the points \[SI\].
    pub key_values: Vec<Vec<f64>>,
    /// Coordinates with their bounds.
    pub coordinates: Vec<Coordinate>,
    /// Values of the coordinates at the points \[SI\].
    pub at: Vec<Vec<f64>>,
    /// Figures that are known at all points.
    pub figures: Vec<(Quantity, Vec<f64>)>,
    /// Number of points.
    pub points: usize,
    /// Number of points without a result.
    pub failed: usize,
    /// Number of points with a result that lie outside the box.
    pub cut: usize,
    /// Keys that have a single value, as `KEY=VALUE`.
    pub fixed: Vec<String>,
}

impl Samples {
    /// Extracts the samples of a sweep.
    ///
    /// # Errors
    /// [`RunError::Usage`] if values are not numbers or too few, if a quotient uses a key that did
    /// not vary, or if no sufficiently large box is free of failed points.
    pub(super) fn of(study: &Study, quotients: &[Quotient]) -> Result<Self, RunError> {
        let (one_value, varied): (Vec<_>, Vec<_>) =
            study.vary.iter().enumerate().partition(|(_, axis)| has_one_value(axis));
        if varied.is_empty() {
            return Err(RunError::Usage(
                "no key of the sweep has two values, so there is nothing to fit; vary a key over a \
                 range"
                    .to_owned(),
            ));
        }
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

/// Values of a key \[SI\].
fn numbers(axis: &Axis, unit: &str) -> Result<Vec<f64>, RunError> {
    axis.values.iter().map(|text| number(&axis.key, text, unit)).collect()
}

/// Parses the value of a key from a case, an option or a table \[SI\].
///
/// # Errors
/// [`RunError::Usage`] if the text is not a number, or the unit does not fit the key.
pub(crate) fn number(key: &str, text: &str, unit: &str) -> Result<f64, RunError> {
    let text = text.trim().trim_matches(['"', '\'']);
    let plain = || text.replace('_', "").parse::<f64>().ok().filter(|value| value.is_finite());
    let wrong = |why: &dyn std::fmt::Display| RunError::Usage(format!("{key} = {text}: {why}"));
    match (plain(), unit) {
        (Some(value), _) => Ok(value),
        (None, "") => {
            Err(wrong(&"is not a number; its key has no known unit, so give it in SI units"))
        }
        (None, unit) => parse_quantity(text, unit).map_err(|error| wrong(&error)),
    }
}

/// Number of the key, number of the divisor, and the values.
type Made = (usize, Option<usize>, Vec<f64>);

fn coordinates(
    names: &[&str],
    values: &[Vec<f64>],
    quotients: &[Quotient],
) -> Result<Vec<Made>, RunError> {
    let place = |key: &str| {
        let told =
            || format!("--per: `{key}` does not vary; the keys that vary: {}", names.join(", "));
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
                "--per: the range of `{key}` includes 0, so it cannot be a divisor"
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
            "{with_answer} with results are too few for a surrogate; at least {FEWEST_POINTS} are \
             needed"
        ),
        false => format!(
            "{failed} have no result, and no box free of them contains half of the {with_answer} \
             with results; reduce the ranges of the keys, or use the quotient that limits where \
             results exist as a coordinate, `coordinator fit DIR --per KEY/KEY`"
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
        "{name} has {} at the points with results; a surrogate needs {FEWEST_VALUES} or more to \
         know the figures between them",
        counted(sorted.len() as u64, "value")
    )))
}

/// Returns the figures that every point has, except those that are errors themselves.
fn figures(study: &Study, kept: &[bool]) -> Vec<(Quantity, Vec<f64>)> {
    let rows: Vec<_> =
        study.rows.iter().zip(kept).filter(|(_, kept)| **kept).map(|(row, _)| row).collect();
    let measured = study.quantities.iter().enumerate();
    let measured = measured.filter(|(_, one)| one.measure != contract::figure::Measure::Itself);
    let values = |column| rows.iter().map(|row| row.value(column)).collect::<Option<_>>();
    measured.filter_map(|(column, one)| Some((one.clone(), values(column)?))).collect()
}

/// Selects the points in a box of the bounded values that contains no failed point. The search
/// starts with the box around all points with results. At each failed point inside, the box is cut
/// on the side that loses the fewest points.
#[must_use]
fn within(bounded: &[&[f64]], answered: &[bool]) -> Vec<bool> {
    let mut kept = answered.to_vec();
    let failed: Vec<usize> = (0..answered.len()).filter(|n| !answered[*n]).collect();
    loop {
        let ends: Vec<[f64; 2]> = bounded.iter().map(|values| bounds(values, &kept)).collect();
        let inside = |n: &&usize| {
            bounded
                .iter()
                .zip(&ends)
                .all(|(values, [from, to])| (from..=to).contains(&&values[**n]))
        };
        let Some(failed) = failed.iter().find(inside) else { return kept };
        let cuts = bounded.iter().flat_map(|values| {
            let at = values[*failed];
            [Cut { values, at, above: true }, Cut { values, at, above: false }]
        });
        let Some(cut) = cuts.min_by_key(|cut| cut.lost(&kept)) else { return kept };
        kept.iter_mut().enumerate().for_each(|(n, kept)| *kept &= !cut.takes(n));
    }
}

/// The half-space at or beyond a value.
struct Cut<'a> {
    values: &'a [f64],
    at: f64,
    above: bool,
}

impl Cut<'_> {
    fn takes(&self, n: usize) -> bool {
        if self.above { self.values[n] >= self.at } else { self.values[n] <= self.at }
    }

    fn lost(&self, kept: &[bool]) -> usize {
        kept.iter().enumerate().filter(|(n, kept)| **kept && self.takes(*n)).count()
    }
}

/// Smallest and largest of the kept values.
fn bounds(values: &[f64], kept: &[bool]) -> [f64; 2] {
    let kept = values.iter().zip(kept).filter(|(_, kept)| **kept).map(|(value, _)| *value);
    kept.fold([f64::INFINITY, f64::NEG_INFINITY], |[from, to], value| {
        [from.min(value), to.max(value)]
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A grid of 4 × 3 points. Points with one of the two largest first values and the smallest
    /// second value have no result.
    #[test]
    fn the_box_is_cut_where_the_fewest_are_lost() {
        let points: Vec<[f64; 2]> = (0..12).map(|n| [f64::from(n % 4), f64::from(n / 4)]).collect();
        let [x, y] = [0, 1].map(|i| points.iter().map(|point| point[i]).collect::<Vec<_>>());
        let answered: Vec<bool> = points.iter().map(|[x, y]| !(*x >= 2.0 && *y == 0.0)).collect();
        let kept = within(&[&x, &y], &answered);
        let left: Vec<_> = points.iter().zip(&kept).filter(|(_, kept)| **kept).collect();
        assert_eq!(left.len(), 8, "the smallest second value is cut off: {left:?}");
        assert!(left.iter().all(|([_, y], _)| *y >= 1.0));
        // No point is lost if the limiting quantity is a coordinate.
        let sum: Vec<f64> = points.iter().map(|[x, y]| x - 9.0 * y).collect();
        let kept = within(&[&x, &y, &sum], &answered);
        assert_eq!(kept, answered);
    }
}
