//! Choice of scales for a fit: linear or logarithmic, for the figure and for each coordinate,
//! whichever gives the smallest error at held-out points.

use super::grow::{Axis, Sum, Task, grow};
use super::held::HeldOut;
use super::samples::Samples;
use crate::study::quantity::Quantity;
use contract::figure::Measure as Compared;
use surrogate::{Coordinate, FittedFigure, HeldOutError, Measure, Scale};

/// Largest degree; fewer for a coordinate with few values.
const LARGEST_DEGREE: usize = 16;
/// Another scale is chosen only if it reduces the error below this share.
const BETTER: f64 = 0.9;
/// Errors below this are rounding errors.
const ROUNDING: f64 = 1e-11;
/// A figure counts as constant if its relative variation is below this.
const CONSTANT: f64 = 1e-9;
/// A fit is rejected if its error exceeds this share of the variation of the figure.
const TELLS: f64 = 0.3;

/// Polynomials of all coordinates at all points, linear and (if the range is positive) logarithmic.
pub(super) struct Axes(Vec<(Axis, Option<Axis>)>);

impl Axes {
    /// Evaluates the polynomials at the points of the samples.
    #[must_use]
    pub(super) fn of(samples: &Samples) -> Self {
        let both = |(one, values): (&Coordinate, &Vec<f64>)| {
            let linear = polynomials(values, one.from, one.to);
            let logs = || values.iter().map(|value| value.ln()).collect::<Vec<_>>();
            let log = (one.from > 0.0).then(|| polynomials(&logs(), one.from.ln(), one.to.ln()));
            (linear, log)
        };
        Self(samples.coordinates.iter().zip(&samples.at).map(both).collect())
    }

    fn get(&self, scales: &[Scale]) -> Option<Vec<&Axis>> {
        self.0
            .iter()
            .zip(scales)
            .map(|((linear, log), scale)| match scale {
                Scale::Linear => Some(linear),
                Scale::Log => log.as_ref(),
            })
            .collect()
    }
}

/// Evaluates Chebyshev polynomials. The degree is limited so that the fit stays determined when one
/// value of the coordinate is held out.
fn polynomials(values: &[f64], from: f64, to: f64) -> Axis {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted.dedup();
    let degree = LARGEST_DEGREE.min(sorted.len().saturating_sub(2));
    let s: Vec<f64> = values.iter().map(|value| (2.0 * value - from - to) / (to - from)).collect();
    let mut axis = vec![vec![1.0; s.len()], s.clone()];
    while axis.len() <= degree {
        let next =
            (0..s.len()).map(|n| 2.0 * s[n] * axis[axis.len() - 1][n] - axis[axis.len() - 2][n]);
        axis.push(next.collect());
    }
    axis
}

/// Values of a figure at the points, with their logarithms and the measure of error.
struct Values<'a> {
    of: &'a [f64],
    logs: Option<Vec<f64>>,
    measure: Measure,
}

impl<'a> Values<'a> {
    fn new(quantity: &Quantity, of: &'a [f64]) -> Self {
        let one_sign = of.iter().all(|value| *value > 0.0) || of.iter().all(|value| *value < 0.0);
        let logs = one_sign.then(|| of.iter().map(|value| value.abs().ln()).collect());
        let relative = one_sign && quantity.measure == Compared::Relative;
        Self { of, logs, measure: if relative { Measure::Relative } else { Measure::Absolute } }
    }

    /// Converts the error of the fitted quantity into the error of the figure at a point.
    fn error(&self, scale: Scale, n: usize, error: f64) -> f64 {
        match (scale, self.measure) {
            (Scale::Linear, Measure::Absolute) => error,
            (Scale::Linear, Measure::Relative) => error / self.of[n],
            (Scale::Log, Measure::Relative) => (-error).exp_m1(),
            (Scale::Log, Measure::Absolute) => self.of[n] * (-error).exp_m1(),
        }
    }

    fn fit(&self, axes: &Axes, held: &HeldOut, scale: Scale, scales: &[Scale]) -> Option<Sum> {
        let values = match scale {
            Scale::Linear => self.of,
            Scale::Log => self.logs.as_ref()?,
        };
        let judge = |n: usize, error: f64| self.error(scale, n, error);
        grow(&Task { axes: &axes.get(scales)?, values, held, judge: &judge })
    }

    /// Standard deviation of the figure, relative to its mean if errors are relative.
    fn spread(&self) -> f64 {
        let count = self.of.len() as f64;
        let mean = self.of.iter().sum::<f64>() / count;
        let square = self.of.iter().map(|value| (value - mean) * (value - mean)).sum::<f64>();
        let spread = (square / count).sqrt();
        if self.measure == Measure::Relative { spread / mean.abs() } else { spread }
    }
}

/// Fits a figure in its best scales; an error states why the figure is left out.
pub(super) fn fit(
    quantity: &Quantity,
    of: &[f64],
    axes: &Axes,
    held: &HeldOut,
) -> Result<FittedFigure, String> {
    let values = Values::new(quantity, of);
    let linear = vec![Scale::Linear; axes.0.len()];
    let largest = of.iter().fold(0.0f64, |largest, value| largest.max(value.abs()));
    let apart = of.iter().fold(0.0f64, |apart, value| apart.max((value - of[0]).abs()));
    if apart <= CONSTANT * largest {
        let measure = values.measure;
        let error = if measure == Measure::Relative { apart / largest } else { apart };
        let degrees = vec![vec![0; axes.0.len()]];
        let sum = Sum { degrees, coefficients: vec![of[0]], largest: error, rms: error };
        return Ok(figure(quantity, &values, (sum, Scale::Linear, linear)));
    }
    let best = search(&values, axes, held, &linear).ok_or("the points cannot determine a fit")?;
    let part = best.0.rms / values.spread();
    if part.is_nan() || part > TELLS {
        let why = "its variation is mere rounding, or follows no smooth law";
        return Err(format!(
            "{why} (error at held-out points: {:.0} % of its range)",
            100.0 * part
        ));
    }
    Ok(figure(quantity, &values, best))
}

type Found = (Sum, Scale, Vec<Scale>);

/// Tries all-logarithmic and all-linear scales first, then the other scale for one coordinate at a
/// time.
fn search(values: &Values<'_>, axes: &Axes, held: &HeldOut, linear: &[Scale]) -> Option<Found> {
    let mut best: Option<Found> = None;
    let better = |best: &mut Option<Found>, scale, scales: &[Scale]| {
        let limit = best.as_ref().map_or(f64::INFINITY, |best| BETTER * best.0.rms);
        if best.as_ref().is_some_and(|best| best.0.rms <= ROUNDING) {
            return;
        }
        let found = values.fit(axes, held, scale, scales).filter(|sum| sum.rms < limit);
        if let Some(sum) = found {
            *best = Some((sum, scale, scales.to_vec()));
        }
    };
    let log =
        |(_, log): &(Axis, Option<Axis>)| if log.is_some() { Scale::Log } else { Scale::Linear };
    let logs: Vec<Scale> = axes.0.iter().map(log).collect();
    for scales in [logs.as_slice(), linear] {
        better(&mut best, Scale::Log, scales);
        better(&mut best, Scale::Linear, scales);
    }
    for (n, log) in logs.iter().enumerate() {
        let (_, scale, mut scales) = best.clone()?;
        scales[n] = if scales[n] == Scale::Log { Scale::Linear } else { *log };
        better(&mut best, scale, &scales);
    }
    best
}

fn figure(quantity: &Quantity, values: &Values<'_>, (sum, scale, scales): Found) -> FittedFigure {
    FittedFigure {
        key: quantity.key.clone(),
        words: quantity.name.clone(),
        held: HeldOutError { measure: values.measure, largest: sum.largest, rms: sum.rms },
        scale,
        negative: scale == Scale::Log && values.of[0] < 0.0,
        scales,
        degrees: sum.degrees,
        coefficients: sum.coefficients,
    }
}
