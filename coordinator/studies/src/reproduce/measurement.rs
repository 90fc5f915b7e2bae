//! Measured values, and the runs of a case that are compared with them.
//!
//! A [`Measurement`] names a table of measured values, a case with one row for each row of the
//! table, and the figure of the case that corresponds to the values. Its runs are
//!
//! | run | |
//! |---|---|
//! | `NAME/stated` | the case as it is, without a fit |
//! | `NAME/fit-N-VALUE` | one value of the key of fit N, counted from 1 |
//! | `NAME/fit-N-VALUE-OTHER` | the same with one value of the second key of the fit |
//! | `NAME/input-N` | one input at an end of its range, counted from 1 |
//!
//! Between two values of the fitted key, computed values are interpolated linearly, so that the
//! least squares have a closed form in each interval. A second key is not interpolated: the best of
//! its values is taken. The residuals are weighted with the standard deviations of the measured
//! values, where the table has them.

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
    /// Fits, each on its own.
    #[serde(default, rename = "fit")]
    pub fits: Vec<Fit>,
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

/// A fit of one key of the case, or of two.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Fit {
    /// Key of the case.
    pub key: String,
    /// Name in texts and legends.
    pub label: String,
    /// Values that are run, increasing. The fitted value lies between the first and the last.
    pub values: Vec<String>,
    /// A second key, of which the best value is taken.
    pub second: Option<SecondKey>,
}

/// The second key of a fit.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct SecondKey {
    /// Key of the case.
    pub key: String,
    /// Name in texts and legends.
    pub label: String,
    /// Unit of the values.
    pub unit: String,
    /// Values that are run.
    pub values: Vec<String>,
}

const fn one() -> f64 {
    1.0
}

/// A run of a fit: its name, and its changes of the case.
type FitRun = (String, Vec<String>);

impl Fit {
    /// Values of the key as numbers.
    ///
    /// # Errors
    /// A value is not a number, or the values do not increase.
    fn numbers(&self) -> Result<Vec<f64>, String> {
        let numbers = numbers(&self.values)?;
        if numbers.len() < 2 || numbers.windows(2).any(|pair| pair[0] >= pair[1]) {
            return Err("a fit needs two or more values in increasing order".to_owned());
        }
        Ok(numbers)
    }

    /// Runs of the fit: one list over the values of the key for each value of the second key.
    fn runs(&self, prefix: &str) -> Vec<Vec<FitRun>> {
        let first =
            |value: &String| (format!("{prefix}-{value}"), vec![format!("{}={value}", self.key)]);
        let Some(second) = &self.second else {
            return vec![self.values.iter().map(first).collect()];
        };
        let with = |other: &String| {
            let both = |value: &String| {
                let (name, mut changes) = first(value);
                changes.push(format!("{}={other}", second.key));
                (format!("{name}-{other}"), changes)
            };
            self.values.iter().map(both).collect()
        };
        second.values.iter().map(with).collect()
    }
}

fn numbers(values: &[String]) -> Result<Vec<f64>, String> {
    let number = |value: &String| {
        value.parse::<f64>().map_err(|_| format!("`{value}` of the fit is not a number"))
    };
    values.iter().map(number).collect()
}

impl Measurement {
    /// Name of the run without a fit.
    #[must_use]
    pub(crate) fn stated(&self) -> String {
        format!("{}/stated", self.name)
    }

    /// Runs of each fit.
    fn fit_runs(&self) -> Vec<Vec<Vec<FitRun>>> {
        let prefix = |n: usize| format!("{}/fit-{}", self.name, n + 1);
        self.fits.iter().enumerate().map(|(n, fit)| fit.runs(&prefix(n))).collect()
    }

    fn input(&self, n: usize) -> String {
        format!("{}/input-{}", self.name, n + 1)
    }

    /// Names of the runs, and the changes of the case in each.
    pub(crate) fn runs(&self) -> Vec<(String, Vec<String>)> {
        let inputs = self.inputs.iter().enumerate();
        let inputs = inputs.map(|(n, change)| (self.input(n), vec![change.clone()]));
        let fits = self.fit_runs().into_iter().flatten().flatten();
        std::iter::once((self.stated(), Vec::new())).chain(fits).chain(inputs).collect()
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
        let column =
            |name: &str, unit: &str| read.column(name, None, unit).map_err(|error| refused(&error));
        let scatter = self.scatter.as_ref().map(|name| column(name, &self.unit)).transpose()?;
        if scatter.iter().flatten().any(|deviation| *deviation <= 0.0) {
            return Err(refused(&"a standard deviation is not positive"));
        }
        Ok(Comparison {
            x: column(&self.x.column, &self.x.unit)?,
            measured: column(&self.value, &self.unit)?,
            scatter,
            fits: self.fits.iter().map(FitValues::of).collect::<Result<_, _>>()?,
            ..Comparison::default()
        })
    }

    /// Reads the measured values from their copy in `folder`, and the computed values from the
    /// histories of the runs.
    ///
    /// # Errors
    /// The table is refused ([`Measurement::read`]), a run lacks the figure, or its number of rows
    /// differs from that of the table.
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
        for (fit, runs) in comparison.fits.iter_mut().zip(self.fit_runs()) {
            let values = |list: Vec<FitRun>| {
                list.into_iter().map(|(name, _)| computed(name)).collect::<Result<Vec<_>, _>>()
            };
            fit.values = runs.into_iter().map(values).collect::<Result<_, _>>()?;
        }
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
    fits: Vec<FitValues>,
    /// Values computed with each change of an input.
    inputs: Vec<Vec<f64>>,
}

/// Values computed for a fit.
#[derive(Clone, Debug, Default, PartialEq)]
struct FitValues {
    /// Values of the key.
    parameters: Vec<f64>,
    /// Values of the second key; empty without one.
    second: Vec<f64>,
    /// Computed values, for each value of the second key and each value of the key.
    values: Vec<Vec<Vec<f64>>>,
}

impl FitValues {
    fn of(fit: &Fit) -> Result<Self, String> {
        let second = fit.second.as_ref().map(|second| numbers(&second.values)).transpose()?;
        let (parameters, second) = (fit.numbers()?, second.unwrap_or_default());
        Ok(Self { parameters, second, values: Vec::new() })
    }
}

/// Fitted parameters, and the values computed with them.
#[derive(Clone, Debug, PartialEq)]
struct Fitted {
    parameter: f64,
    second: Option<f64>,
    values: Vec<f64>,
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
    /// Values computed with the parameters of each fit, fitted to all rows.
    pub(super) fn fitted(&self) -> impl Iterator<Item = Vec<f64>> {
        self.fits.iter().filter_map(|fit| Some(self.fit(fit, Part::All)?.values))
    }

    /// Least squares in every interval between two values of the key, for every value of the
    /// second key; the smallest sum wins.
    fn fit(&self, fit: &FitValues, part: Part) -> Option<Fitted> {
        let mut best: Option<(f64, Fitted)> = None;
        for (n, lists) in fit.values.iter().enumerate() {
            for (ends, runs) in fit.parameters.windows(2).zip(lists.windows(2)) {
                let share = self.share(runs, part);
                let between = |low: f64, high: f64| low + share * (high - low);
                let values: Vec<f64> =
                    runs[0].iter().zip(&runs[1]).map(|(low, high)| between(*low, *high)).collect();
                let sum = self.weighted(part, |row| (values[row] - self.measured[row]).powi(2));
                if best.as_ref().is_none_or(|(least, _)| sum < *least) {
                    let parameter = between(ends[0], ends[1]);
                    let second = fit.second.get(n).copied();
                    best = Some((sum, Fitted { parameter, second, values }));
                }
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
        let inside =
            |row: &&usize| (values[**row] - self.measured[**row]).abs() <= COVERED * scatter[**row];
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
        if let Some(key) = key.strip_prefix("relative.") {
            return Some(self.quantity(key)? / largest);
        }
        match key {
            "points" => Some(self.measured.len() as f64),
            "largest" => Some(largest),
            "scatter" => self.scatter.as_ref().map(|s| root_mean_square(s, &none, Part::All)),
            "deviation" => Some(self.deviation(&self.stated, Part::All)),
            "covered" => self.covered(&self.stated, Part::All),
            _ => self.fit_quantity(key).or_else(|| self.input_quantity(key)),
        }
    }

    /// Looks up `fit.N.parameter`, `second`, `deviation` or `covered`, or the same after
    /// `fit.N.held_out`, with N counted from 1.
    fn fit_quantity(&self, key: &str) -> Option<f64> {
        let (fit, what) = numbered(&self.fits, key.strip_prefix("fit.")?)?;
        let held_out = what.strip_prefix("held_out.");
        let seen = if held_out.is_some() { Part::Odd } else { Part::All };
        let judged = if held_out.is_some() { Part::Even } else { Part::All };
        let fitted = self.fit(fit, seen)?;
        match held_out.unwrap_or(what) {
            "parameter" => Some(fitted.parameter),
            "second" => fitted.second,
            "deviation" => Some(self.deviation(&fitted.values, judged)),
            "covered" => self.covered(&fitted.values, judged),
            _ => None,
        }
    }

    /// Looks up `input.N.deviation` or `input.N.change`, with N counted from 1.
    fn input_quantity(&self, key: &str) -> Option<f64> {
        let (run, what) = numbered(&self.inputs, key.strip_prefix("input.")?)?;
        match what {
            "deviation" => Some(self.deviation(run, Part::All)),
            "change" => Some(root_mean_square(run, &self.stated, Part::All)),
            _ => None,
        }
    }
}

/// Finds the entry of `N.REST`, with N counted from 1, and returns it with REST.
fn numbered<'a, 'k, T>(entries: &'a [T], key: &'k str) -> Option<(&'a T, &'k str)> {
    let (number, rest) = key.split_once('.')?;
    let entry = entries.get(number.parse::<usize>().ok()?.checked_sub(1)?)?;
    Some((entry, rest))
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
            fits: vec![FitValues {
                parameters: vec![1.0, 3.0, 5.0],
                second: Vec::new(),
                values: vec![vec![runs(1.0), runs(3.0), runs(5.0)]],
            }],
            inputs: vec![runs(2.5), runs(3.5)],
            x: x.clone(),
        }
    }

    /// The exact least squares of a straight line through zero: Σxm / Σx².
    #[test]
    fn the_fit_is_that_of_least_squares() {
        let parameter = comparison().quantity("fit.1.parameter").unwrap();
        let exact = (2.1 + 2.0 * 3.9 + 3.0 * 6.1 + 4.0 * 7.9) / 30.0;
        assert!((parameter - exact).abs() < 1e-14, "{parameter} {exact}");
        let values = comparison().fitted().next().unwrap();
        assert!((values[3] - 4.0 * exact).abs() < 1e-13, "{values:?}");
    }

    #[test]
    fn weights_favour_values_with_less_scatter() {
        let mut weighted = comparison();
        weighted.scatter = Some(vec![1e-6, 1.0, 1.0, 1.0]);
        assert!((weighted.quantity("fit.1.parameter").unwrap() - 2.1).abs() < 1e-9);
    }

    #[test]
    fn the_fit_stays_between_the_first_and_the_last_value() {
        let mut outside = comparison();
        outside.measured = vec![9.0, 18.0, 27.0, 36.0];
        assert_eq!(outside.quantity("fit.1.parameter"), Some(5.0));
    }

    /// The fit sees rows 1 and 3, the deviation rows 2 and 4.
    #[test]
    fn held_out_rows_take_no_part_in_the_fit() {
        let mut other = comparison();
        let parameter = comparison().quantity("fit.1.held_out.parameter").unwrap();
        assert!((parameter - (2.1 + 3.0 * 6.1) / 10.0).abs() < 1e-14);
        other.measured[1] = 100.0;
        assert_eq!(other.quantity("fit.1.held_out.parameter"), Some(parameter));
        let deviation = other.quantity("fit.1.held_out.deviation").unwrap();
        assert!((deviation - ((96.0_f64 - 0.08).powi(2) / 2.0).sqrt()).abs() < 0.1, "{deviation}");
    }

    /// The list of runs whose straight line passes closer wins.
    #[test]
    fn the_best_value_of_a_second_key_is_taken() {
        let mut two = comparison();
        let fit = &mut two.fits[0];
        fit.second = vec![7.0, 8.0];
        let shifted = |run: &Vec<f64>| run.iter().map(|value| value + 3.0).collect();
        fit.values.insert(0, fit.values[0].iter().map(shifted).collect());
        let of = |key: &str| (two.quantity(key), comparison().quantity(key));
        assert_eq!(two.quantity("fit.1.second"), Some(8.0));
        assert_eq!(comparison().quantity("fit.1.second"), None);
        for key in ["fit.1.parameter", "fit.1.deviation", "fit.1.held_out.covered"] {
            assert_eq!(of(key).0, of(key).1, "{key}");
        }
    }

    #[test]
    fn quantities_of_the_stated_case_and_of_inputs() {
        let comparison = comparison();
        let of = |key: &str| comparison.quantity(key);
        assert_eq!((of("points"), of("largest")), (Some(4.0), Some(7.9)));
        let deviation = ((0.81_f64 + 4.41 + 8.41 + 16.81) / 4.0).sqrt();
        assert!((of("deviation").unwrap() - deviation).abs() < 1e-14);
        assert!((of("relative.deviation").unwrap() - deviation / 7.9).abs() < 1e-14);
        assert_eq!((of("covered"), of("fit.1.covered")), (Some(0.0), Some(1.0)));
        assert!((of("input.2.change").unwrap() - (0.25_f64 * 30.0 / 4.0).sqrt()).abs() < 1e-14);
        assert_eq!((of("input.3.change"), of("input.0.change"), of("colour")), (None, None, None));
        let [low, high] = comparison.band().unwrap();
        assert_eq!((low[1], high[1]), (5.0, 7.0));
    }
}
