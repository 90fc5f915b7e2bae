//! Measured values, and the runs of a case that are compared with them.
//!
//! A [`Measurement`] names a table of measured values, a case with one row for each row of the
//! table, and the figure of the case that corresponds to the values. Its runs are
//!
//! | run | |
//! |---|---|
//! | `NAME/stated` | the case as it is, without a fit |
//! | `NAME/fit-VALUE` | one value of the fitted key |
//! | `NAME/input-N` | one input at an end of its range, counted from 1 |
//!
//! Between two values of the fitted key, computed values are interpolated linearly, so that the
//! least squares have a closed form in each interval. The residuals are weighted with the standard
//! deviations of the measured values, where the table has them.

use contract::table::{Reading, Table};
use pages::source::Columns;
use serde::Deserialize;
use std::path::{Path, PathBuf};

/// Size above which a table is refused \[byte\].
const MOST_BYTES: u64 = 1 << 24;
/// Standard deviations around a computed value within which a measured value counts as covered.
const COVERED: f64 = 2.0;

/// A measurement of others.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Measurement {
    /// Name, part of the names of its runs and of its plot.
    pub name: String,
    /// Title in tables and plots.
    pub title: String,
    /// Kind of measurement, such as `creep curve`.
    pub kind: String,
    /// Publication, and how the values were read.
    pub source: String,
    /// Remark on what the comparison shows.
    #[serde(default)]
    pub note: String,
    /// Case file, relative to the study: a sequence with one row for each measured value.
    pub case: PathBuf,
    /// Table of measured values, relative to the study.
    pub table: PathBuf,
    /// Key of the computed values in `history.csv`.
    pub figure: String,
    /// Column of the measured values.
    pub value: String,
    /// Column of their standard deviations.
    pub scatter: Option<String>,
    /// SI unit of the figure and of the measured values.
    pub unit: String,
    /// Axes of the plot.
    pub x: PlotAxis,
    pub y: PlotAxis,
    /// The fitted key of the case.
    pub fit: Option<Fit>,
    /// Changes that put one uncertain input to an end of its range.
    #[serde(default)]
    pub inputs: Vec<String>,
}

/// An axis of a plot.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct PlotAxis {
    /// Column of the table; ignored for the vertical axis.
    #[serde(default)]
    pub column: String,
    /// SI unit of the column.
    #[serde(default)]
    pub unit: String,
    /// Label, with its unit.
    pub label: String,
    /// Divisor of the values in SI units.
    #[serde(default = "one")]
    pub per: f64,
}

/// The fitted key of a case.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Fit {
    /// Key of the case.
    pub key: String,
    /// Name in texts and legends.
    pub label: String,
    /// Values that are run, increasing. The fitted value lies between the first and the last.
    pub values: Vec<String>,
}

const fn one() -> f64 {
    1.0
}

impl Fit {
    /// Values of the key as numbers.
    ///
    /// # Errors
    /// A value is not a number, or the values do not increase.
    fn numbers(&self) -> Result<Vec<f64>, String> {
        let number = |value: &String| {
            value.parse::<f64>().map_err(|_| format!("`{value}` of the fit is not a number"))
        };
        let numbers = self.values.iter().map(number).collect::<Result<Vec<f64>, String>>()?;
        if numbers.len() < 2 || numbers.windows(2).any(|pair| pair[0] >= pair[1]) {
            return Err("a fit needs two or more values in increasing order".to_owned());
        }
        Ok(numbers)
    }
}

impl Measurement {
    /// Name of the run without a fit.
    #[must_use]
    pub(crate) fn stated(&self) -> String {
        format!("{}/stated", self.name)
    }

    fn fits(&self) -> impl Iterator<Item = String> {
        let values = self.fit.iter().flat_map(|fit| &fit.values);
        values.map(|value| format!("{}/fit-{value}", self.name))
    }

    fn input(&self, n: usize) -> String {
        format!("{}/input-{}", self.name, n + 1)
    }

    /// Names of the runs, and the change of the case in each.
    pub(crate) fn runs(&self) -> Vec<(String, Option<String>)> {
        let mut runs = vec![(self.stated(), None)];
        if let Some(fit) = &self.fit {
            let changes = fit.values.iter().map(|value| Some(format!("{}={value}", fit.key)));
            runs.extend(self.fits().zip(changes));
        }
        let inputs = self.inputs.iter().enumerate();
        runs.extend(inputs.map(|(n, change)| (self.input(n), Some(change.clone()))));
        runs
    }

    /// Name of the copy of the table in the folder of a reproduction.
    #[must_use]
    pub(crate) fn kept_table(&self) -> String {
        format!("measured-{}.csv", self.name)
    }

    /// Reads the measured values from `table`.
    ///
    /// # Errors
    /// The table or a column is missing or invalid, the values of the fit do not increase, or a
    /// standard deviation is not positive.
    pub(super) fn read(&self, table: &Path) -> Result<Comparison, String> {
        let refused = |error: &dyn std::fmt::Display| format!("{}: {error}", table.display());
        let read = Table::read(table, MOST_BYTES, Reading::NUMBERS);
        let read = read.map_err(|error| refused(&error))?;
        let column = |name: &str, unit: &str| {
            read.column(name, None, unit).map_err(|error| refused(&error))
        };
        let scatter = self.scatter.as_ref().map(|name| column(name, &self.unit)).transpose()?;
        if scatter.iter().flatten().any(|deviation| *deviation <= 0.0) {
            return Err(refused(&"a standard deviation is not positive"));
        }
        Ok(Comparison {
            x: column(&self.x.column, &self.x.unit)?,
            measured: column(&self.value, &self.unit)?,
            scatter,
            parameters: self.fit.as_ref().map(Fit::numbers).transpose()?.unwrap_or_default(),
            ..Comparison::default()
        })
    }

    /// Reads the measured values from their copy in `folder`, and the computed values from the
    /// histories of the runs.
    ///
    /// # Errors
    /// Those of [`Measurement::read`]; a run has no such figure or another number of rows.
    pub(super) fn compare<'a>(
        &self,
        folder: &Path,
        history: impl Fn(&str) -> Option<&'a Columns>,
    ) -> Result<Comparison, String> {
        let mut comparison = self.read(&folder.join(self.kept_table()))?;
        let rows = comparison.measured.len();
        let computed = |name: String| {
            let values = history(&name).and_then(|history| history.column(&self.figure));
            let values =
                values.ok_or_else(|| format!("run `{name}` has no figure `{}`", self.figure))?;
            match values.len() == rows {
                true => Ok(values),
                false => Err(format!(
                    "run `{name}` has {} rows for {rows} measured values; the case needs one row \
                     for each of them",
                    values.len()
                )),
            }
        };
        comparison.stated = computed(self.stated())?;
        comparison.fits = self.fits().map(computed).collect::<Result<_, _>>()?;
        let inputs = (0..self.inputs.len()).map(|n| computed(self.input(n)));
        comparison.inputs = inputs.collect::<Result<_, _>>()?;
        Ok(comparison)
    }
}

/// Measured and computed values in SI units, one for each row of the table.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Comparison {
    /// Positions along the horizontal axis.
    pub(super) x: Vec<f64>,
    pub(super) measured: Vec<f64>,
    /// Standard deviations of the measured values.
    pub(super) scatter: Option<Vec<f64>>,
    /// Computed values without a fit.
    pub(super) stated: Vec<f64>,
    /// Values of the fitted key, and the values computed with each.
    parameters: Vec<f64>,
    fits: Vec<Vec<f64>>,
    /// Values computed with each change of an input.
    inputs: Vec<Vec<f64>>,
}

/// A fitted parameter, and the values computed with it.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Fitted {
    pub(super) parameter: f64,
    pub(super) values: Vec<f64>,
}

/// Rows of a table that take part in a comparison.
#[derive(Clone, Copy, Debug)]
enum Part {
    All,
    /// Rows 1, 3, 5, …
    Odd,
    /// Rows 2, 4, 6, …
    Even,
}

impl Part {
    fn has(self, row: usize) -> bool {
        match self {
            Self::All => true,
            Self::Odd => row.is_multiple_of(2),
            Self::Even => !row.is_multiple_of(2),
        }
    }
}

impl Comparison {
    /// Fits the parameter to all rows; `None` without a fit.
    #[must_use]
    pub(super) fn fitted(&self) -> Option<Fitted> {
        self.fit(Part::All)
    }

    /// Least squares in every interval between two parameters; the smallest sum wins.
    fn fit(&self, part: Part) -> Option<Fitted> {
        let mut best: Option<(f64, Fitted)> = None;
        for (ends, runs) in self.parameters.windows(2).zip(self.fits.windows(2)) {
            let share = self.share(runs, part);
            let between = |low: f64, high: f64| low + share * (high - low);
            let values: Vec<f64> =
                runs[0].iter().zip(&runs[1]).map(|(low, high)| between(*low, *high)).collect();
            let sum = self.weighted(part, |row| (values[row] - self.measured[row]).powi(2));
            if best.as_ref().is_none_or(|(least, _)| sum < *least) {
                best = Some((sum, Fitted { parameter: between(ends[0], ends[1]), values }));
            }
        }
        best.map(|(_, fitted)| fitted)
    }

    /// Position of the least sum of squares between two runs, from 0 to 1.
    fn share(&self, runs: &[Vec<f64>], part: Part) -> f64 {
        let slope = |row: usize| runs[1][row] - runs[0][row];
        let above = self.weighted(part, |row| slope(row) * (self.measured[row] - runs[0][row]));
        let below = self.weighted(part, |row| slope(row).powi(2));
        if below > 0.0 { (above / below).clamp(0.0, 1.0) } else { 0.0 }
    }

    /// Sum over rows, weighted with the inverse variances.
    fn weighted(&self, part: Part, term: impl Fn(usize) -> f64) -> f64 {
        let weight = |row: usize| self.scatter.as_ref().map_or(1.0, |s| s[row].powi(-2));
        let rows = (0..self.measured.len()).filter(|row| part.has(*row));
        rows.map(|row| weight(row) * term(row)).sum()
    }

    /// Root mean square of the differences from the measured values.
    fn deviation(&self, values: &[f64], part: Part) -> f64 {
        root_mean_square(values, &self.measured, part)
    }

    /// Share of the measured values within twice their standard deviation of the computed ones.
    fn covered(&self, values: &[f64], part: Part) -> Option<f64> {
        let scatter = self.scatter.as_ref()?;
        let rows: Vec<usize> = (0..values.len()).filter(|row| part.has(*row)).collect();
        let inside = |row: &&usize| {
            (values[**row] - self.measured[**row]).abs() <= COVERED * scatter[**row]
        };
        Some(rows.iter().filter(inside).count() as f64 / rows.len() as f64)
    }

    /// Lowest and highest values computed within the ranges of the inputs.
    #[must_use]
    pub(super) fn band(&self) -> Option<[Vec<f64>; 2]> {
        if self.inputs.is_empty() {
            return None;
        }
        let ends = |pick: fn(f64, f64) -> f64| {
            let runs = |row: usize| self.inputs.iter().map(move |run| run[row]);
            let end = |row: usize| runs(row).fold(self.stated[row], pick);
            (0..self.stated.len()).map(end).collect()
        };
        Some([ends(f64::min), ends(f64::max)])
    }

    /// Looks up a quantity of the comparison; `None` if there is none under the key. The prefix
    /// `relative.` divides by the largest magnitude of the measured values.
    #[must_use]
    pub(super) fn quantity(&self, key: &str) -> Option<f64> {
        let none = vec![0.0; self.measured.len()];
        let largest = self.measured.iter().fold(0.0, |most: f64, value| most.max(value.abs()));
        let held_out = |of: &dyn Fn(&[f64]) -> Option<f64>| of(&self.fit(Part::Odd)?.values);
        if let Some(key) = key.strip_prefix("relative.") {
            return Some(self.quantity(key)? / largest);
        }
        match key {
            "points" => Some(self.measured.len() as f64),
            "largest" => Some(largest),
            "scatter" => self.scatter.as_ref().map(|s| root_mean_square(s, &none, Part::All)),
            "deviation" => Some(self.deviation(&self.stated, Part::All)),
            "covered" => self.covered(&self.stated, Part::All),
            "fitted.parameter" => Some(self.fitted()?.parameter),
            "fitted.deviation" => Some(self.deviation(&self.fitted()?.values, Part::All)),
            "fitted.covered" => self.covered(&self.fitted()?.values, Part::All),
            "held_out.parameter" => Some(self.fit(Part::Odd)?.parameter),
            "held_out.deviation" => held_out(&|values| Some(self.deviation(values, Part::Even))),
            "held_out.covered" => held_out(&|values| self.covered(values, Part::Even)),
            _ => self.input_quantity(key),
        }
    }

    /// Looks up `input.N.deviation` or `input.N.change`, with N counted from 1.
    fn input_quantity(&self, key: &str) -> Option<f64> {
        let (number, what) = key.strip_prefix("input.")?.split_once('.')?;
        let run = self.inputs.get(number.parse::<usize>().ok()?.checked_sub(1)?)?;
        match what {
            "deviation" => Some(self.deviation(run, Part::All)),
            "change" => Some(root_mean_square(run, &self.stated, Part::All)),
            _ => None,
        }
    }
}

/// Root mean square of the differences of two lists over a part of their rows.
fn root_mean_square(values: &[f64], others: &[f64], part: Part) -> f64 {
    let pairs = values.iter().zip(others).enumerate().filter(|(row, _)| part.has(*row));
    let squares: Vec<f64> = pairs.map(|(_, (value, other))| (value - other).powi(2)).collect();
    (squares.iter().sum::<f64>() / squares.len() as f64).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Measured values 2x with noise of ±0.1, and runs p·x for p = 1, 3 and 5.
    fn comparison() -> Comparison {
        let x = vec![1.0, 2.0, 3.0, 4.0];
        let runs = |p: f64| x.iter().map(|x| p * x).collect::<Vec<f64>>();
        Comparison {
            measured: vec![2.1, 3.9, 6.1, 7.9],
            scatter: Some(vec![0.1; 4]),
            stated: runs(3.0),
            parameters: vec![1.0, 3.0, 5.0],
            fits: vec![runs(1.0), runs(3.0), runs(5.0)],
            inputs: vec![runs(2.5), runs(3.5)],
            x: x.clone(),
        }
    }

    /// The exact least squares of a straight line through zero: Σxm / Σx².
    #[test]
    fn the_fit_is_that_of_least_squares() {
        let fitted = comparison().fitted().unwrap();
        let exact = (2.1 + 2.0 * 3.9 + 3.0 * 6.1 + 4.0 * 7.9) / 30.0;
        assert!((fitted.parameter - exact).abs() < 1e-14, "{fitted:?} {exact}");
        assert!((fitted.values[3] - 4.0 * exact).abs() < 1e-13);
    }

    #[test]
    fn weights_favour_values_with_less_scatter() {
        let mut weighted = comparison();
        weighted.scatter = Some(vec![1e-6, 1.0, 1.0, 1.0]);
        assert!((weighted.fitted().unwrap().parameter - 2.1).abs() < 1e-9);
    }

    #[test]
    fn the_fit_stays_between_the_first_and_the_last_value() {
        let mut outside = comparison();
        outside.measured = vec![9.0, 18.0, 27.0, 36.0];
        assert_eq!(outside.fitted().unwrap().parameter, 5.0);
    }

    /// The fit sees rows 1 and 3, the deviation rows 2 and 4.
    #[test]
    fn held_out_rows_take_no_part_in_the_fit() {
        let mut other = comparison();
        let parameter = comparison().quantity("held_out.parameter").unwrap();
        assert!((parameter - (2.1 + 3.0 * 6.1) / 10.0).abs() < 1e-14);
        other.measured[1] = 100.0;
        assert_eq!(other.quantity("held_out.parameter"), Some(parameter));
        let deviation = other.quantity("held_out.deviation").unwrap();
        assert!((deviation - ((96.0_f64 - 0.08).powi(2) / 2.0).sqrt()).abs() < 0.1, "{deviation}");
    }

    #[test]
    fn quantities_of_the_stated_case_and_of_inputs() {
        let comparison = comparison();
        let of = |key: &str| comparison.quantity(key);
        assert_eq!((of("points"), of("largest")), (Some(4.0), Some(7.9)));
        let deviation = ((0.81_f64 + 4.41 + 8.41 + 16.81) / 4.0).sqrt();
        assert!((of("deviation").unwrap() - deviation).abs() < 1e-14);
        assert!((of("relative.deviation").unwrap() - deviation / 7.9).abs() < 1e-14);
        assert_eq!((of("covered"), of("fitted.covered")), (Some(0.0), Some(1.0)));
        assert!((of("input.2.change").unwrap() - (0.25_f64 * 30.0 / 4.0).sqrt()).abs() < 1e-14);
        assert_eq!((of("input.3.change"), of("input.0.change"), of("colour")), (None, None, None));
        let [low, high] = comparison.band().unwrap();
        assert_eq!((low[1], high[1]), (5.0, 7.0));
    }
}
