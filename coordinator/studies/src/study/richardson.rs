//! Error of a quantity, estimated from its values on several grids (Richardson extrapolation).
//!
//! ```text
//! v(h) = v₀ + C h^p     p = ln((v₁ − v₂)/(v₂ − v₃)) / ln r     v₀ = v₃ + (v₃ − v₂)/(r^p − 1)
//! ```
//!
//! v₁, v₂, v₃ are the values on three grids from coarsest to finest, each r times finer than the
//! one before. The estimated error on the finest grid is |v₃ − v₀| times a factor of safety, as in
//! Roache's grid convergence index (J. Fluids Eng. 116 (1994) 405): two for two grids, 1.25 for
//! three or more.
//!
//! Deviations: p is the observed order, however low, but at most the order that the model expects.
//! Quantities that change in steps with the elements at the edge of a contact show too high an
//! order by chance. Without an observed order, the expected one is used. Two grids may agree by
//! chance, so coarser pairs count as well: the error from each pair is scaled to the finest grid,
//! and the largest is taken. Where few elements lie across a slip zone, errors fall faster than
//! expected (order 2 to 3 from a/5 to a/20 where half-spaces expect 1.5). Differences of coarser
//! pairs are therefore scaled by 4/3 of the expected order.
//!
//! **The limit as the answer.** The two pairs of three grids give two limits at the expected order
//! p: L₁ from the coarser pair, L₂ from the finer pair. Their remaining error beyond C h^p moves
//! with the elements at the edges. Measurements show that this error falls like h^(3p/2)
//! (docs/theory/accuracy.md), so the error of L₂ is
//!
//! ```text
//! max( 2 |L₂ − L₁|/(r^(3p/2) − 1),  |L₂ − v₃|/5 )
//! ```
//!
//! The second term is needed because two limits may agree by chance.
//!
//! **Edges inside the contact.** Where a body sticks behind a narrow slip zone, the formulas hold
//! only if the zone is resolved. Its width in elements is a figure of the run
//! ([`contract::accuracy::EDGE_ELEMENTS`]). Measurements (see the tests) show: with fewer than
//! two elements on the coarsest of three grids, or three on the coarser of two, values follow the
//! accident of the edges. The error then is at least the largest difference of neighbouring
//! grids, times the factor of safety (three for two grids). With fewer than twelve, two limits
//! may agree on a wrong value, so that there is no limit. A zone over the whole contact has no
//! edge inside.
//!
//! **Factors of safety.** With them 95 of 100 stated errors of random rolling contacts cover the
//! true ones (docs/theory/accuracy.md). Errors of grids change sign at random: of a normal
//! distribution, 16 of 100 are less than a tenth of a bound that holds for 95.

/// Factor of safety for the difference of two grids.
const SAFETY_OF_TWO: f64 = 2.0;
/// The same where the slip zone is too narrow for an order.
const SAFETY_OF_TWO_NARROW: f64 = 3.0;
/// Factor of safety for three or more grids.
const SAFETY_OF_THREE: f64 = 1.25;
/// Factor of safety for the difference of two limits.
const SAFETY_OF_LIMITS: f64 = 2.0;

/// Order by which the differences of coarser pairs fall, relative to the expected order.
const ORDER_OF_COARSER: f64 = 4.0 / 3.0;

/// Lower bound of the error of a limit, as a share of the leading error.
const LEAST_SHARE: f64 = 0.2;
/// Width of the slip zone on the coarsest of three grids, below which values have no order
/// [element].
const NARROW: f64 = 2.0;
/// The same width of two grids, which do not show whether they have an order.
const NARROW_OF_TWO: f64 = 3.0;
/// The same width, below which there is no limit.
const NARROW_FOR_LIMIT: f64 = 12.0;
/// Order of the remaining error of a limit, relative to the expected order.
pub const ORDER_OF_LIMITS: f64 = 1.5;

/// A quantity on one grid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// Resolution of the grid: elements per length, or windows per time.
    pub level: f64,
    /// Value of the quantity.
    pub value: f64,
    /// Width of the slip zone \[element\]; `None` without an edge inside the contact.
    pub slip_zone: Option<f64>,
}

/// Width of the slip zone on the coarsest of the last three grids \[element\], infinite without an
/// edge.
fn narrowest(samples: &[Sample]) -> f64 {
    let last = samples.iter().rev().take(3);
    last.filter_map(|one| one.slip_zone).fold(f64::INFINITY, f64::min)
}

/// Width of the slip zone on the coarsest of the last three grids \[element\], if it is too narrow
/// for a limit.
#[must_use]
pub fn too_narrow(samples: &[Sample]) -> Option<f64> {
    Some(narrowest(samples)).filter(|width| *width < NARROW_FOR_LIMIT)
}

/// Error estimate from several grids.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// Order observed on the three finest grids, plausible or not; `None` with fewer than three
    /// grids or without an order.
    pub observed_order: Option<f64>,
    /// Order used in the estimate.
    pub order: f64,
    /// Extrapolated value on an infinitely fine grid.
    pub limit: f64,
    /// Estimated error on the finest grid, in the unit of the quantity, including the factor of
    /// safety.
    pub error: f64,
}

impl Estimate {
    /// Estimates the error from samples of one quantity, coarsest grid first; `None` with fewer
    /// than two grids.
    #[must_use]
    pub fn of(samples: &[Sample], expected_order: f64) -> Option<Self> {
        let [.., coarse, fine] = samples else { return None };
        let narrow = narrowest(samples) < if samples.len() > 2 { NARROW } else { NARROW_OF_TWO };
        let observed_order = observed_order(samples);
        let believed = observed_order.filter(|_| !narrow).unwrap_or(expected_order);
        let order = believed.min(expected_order);
        let told = |coarse: &Sample, fine: &Sample, order: f64| {
            (fine.value - coarse.value) / ((fine.level / coarse.level).powf(order) - 1.0)
        };
        let correction = told(coarse, fine, order);
        let of_coarser = |pair: &[Sample]| {
            let order = ORDER_OF_COARSER * expected_order;
            let falls = (fine.level / pair[1].level).powf(order);
            (told(&pair[0], &pair[1], order) / falls).abs()
        };
        let coarser = &samples[..samples.len() - 1];
        let largest = coarser.windows(2).map(of_coarser).fold(correction.abs(), f64::max);
        let safety = match samples.len() {
            2 if narrow => SAFETY_OF_TWO_NARROW,
            2 => SAFETY_OF_TWO,
            _ => SAFETY_OF_THREE,
        };
        if narrow {
            let last = &samples[samples.len().saturating_sub(3)..];
            let steps = last.windows(2).map(|pair| (pair[1].value - pair[0].value).abs());
            let error = safety * steps.fold(largest, f64::max);
            return Some(Self { observed_order, order, limit: fine.value, error });
        }
        let (limit, error) = (fine.value + correction, safety * largest);
        Some(Self { observed_order, order, limit, error })
    }
}

/// Extrapolated value on an infinitely fine grid, used as the answer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limit {
    /// Value of the quantity.
    pub value: f64,
    /// Estimated error, in the unit of the quantity, including the factor of safety.
    pub error: f64,
}

impl Limit {
    /// Extrapolates samples of one quantity, coarsest grid first; `None` with fewer than three
    /// grids, or with a slip zone too narrow for the coarsest.
    #[must_use]
    pub fn of(samples: &[Sample], expected_order: f64) -> Option<Self> {
        let [.., first, second, third] = samples else { return None };
        if too_narrow(samples).is_some() {
            return None;
        }
        let limit = |coarse: &Sample, fine: &Sample| {
            let ratio = (fine.level / coarse.level).powf(expected_order);
            fine.value + (fine.value - coarse.value) / (ratio - 1.0)
        };
        let [before, value] = [limit(first, second), limit(second, third)];
        let falls = (third.level / second.level).powf(ORDER_OF_LIMITS * expected_order);
        let left = SAFETY_OF_LIMITS * (value - before).abs() / (falls - 1.0);
        Some(Self { value, error: left.max(LEAST_SHARE * (value - third.value).abs()) })
    }
}

/// Order observed on the three finest grids; `None` unless the values change monotonically in ever
/// smaller steps.
#[must_use]
pub fn observed_order(samples: &[Sample]) -> Option<f64> {
    let [.., first, second, third] = samples else { return None };
    let steps = [second.value - first.value, third.value - second.value];
    let ratios = [second.level / first.level, third.level / second.level];
    let ratio = steps[0] / steps[1];
    if !ratio.is_finite() || ratio <= 0.0 {
        return None;
    }
    order_of_steps(ratio, ratios)
}

/// Finds by bisection the order p for which two steps of v = v₀ + C level^−p have this ratio.
fn order_of_steps(ratio: f64, [r1, r2]: [f64; 2]) -> Option<f64> {
    // With v₁ − v₂ = C(1 − r₁^−p) and v₂ − v₃ = C r₁^−p (1 − r₂^−p), in units of level₁.
    let predicted = |p: f64| (r1.powf(p) - 1.0) / (1.0 - r2.powf(-p));
    let (mut low, mut high) = (1e-3, 16.0);
    if !(predicted(low)..=predicted(high)).contains(&ratio) {
        return None;
    }
    for _ in 0..80 {
        let middle = 0.5 * (low + high);
        match predicted(middle) < ratio {
            true => low = middle,
            false => high = middle,
        }
    }
    Some(0.5 * (low + high))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rise of the rail in cases/wheel-rail.toml (half-space, columns) at small traction
    /// coefficients: width of the slip zone and value on grids of a/10 to a/160, and the limit of
    /// a/160 and a/320.
    const TRACTIONS: [(f64, [[f64; 2]; 5], f64); 5] = [
        (
            0.02,
            [[1.0, 0.3744], [1.0, 0.62447], [1.285, 0.75316], [2.325, 1.03221], [4.471, 1.01467]],
            0.965,
        ),
        (
            0.05,
            [[1.0, 2.6374], [1.715, 3.76463], [2.845, 4.17581], [5.66, 3.96768], [10.98, 3.76761]],
            3.72,
        ),
        (
            0.1,
            [
                [1.604, 10.52812],
                [2.911, 11.70694],
                [5.603, 11.39032],
                [11.24, 10.7662],
                [22.43, 10.70492],
            ],
            10.69,
        ),
        (
            0.2,
            [
                [3.16, 34.38292],
                [6.127, 32.466],
                [12.003, 31.61195],
                [23.93, 31.33422],
                [47.6, 31.3291],
            ],
            31.325,
        ),
        (
            0.3,
            [
                [5.0, 64.68152],
                [9.902, 60.81923],
                [19.38, 60.19896],
                [38.48, 60.18148],
                [76.82, 60.17686],
            ],
            60.175,
        ),
    ];

    fn samples(levels: &[f64], value: impl Fn(f64) -> f64) -> Vec<Sample> {
        let sample = |&level: &f64| Sample { level, value: value(level), slip_zone: None };
        levels.iter().map(sample).collect()
    }

    #[test]
    fn a_power_law_is_found_out() {
        for order in [0.5, 1.0, 1.7, 2.0, 4.0] {
            let values = samples(&[10.0, 20.0, 40.0], |n| 3.0 - 5.0 * n.powf(-order));
            let estimate = Estimate::of(&values, order).unwrap();
            assert!((estimate.observed_order.unwrap() - order).abs() < 1e-9, "{estimate:?}");
            assert!((estimate.limit - 3.0).abs() < 1e-10, "{estimate:?}");
            let true_error = 5.0 * 40f64.powf(-order);
            assert!((estimate.error / true_error - SAFETY_OF_THREE).abs() < 1e-6, "{estimate:?}");
            // Grids without a constant ratio.
            let values = samples(&[10.0, 16.0, 40.0], |n| 3.0 - 5.0 * n.powf(-order));
            assert!((observed_order(&values).unwrap() - order).abs() < 1e-9);
        }
    }

    #[test]
    fn two_grids_take_the_expected_order() {
        let values = samples(&[10.0, 20.0], |n| 1.0 + 1.0 / n);
        let estimate = Estimate::of(&values, 1.0).unwrap();
        assert_eq!((estimate.observed_order, estimate.order), (None, 1.0));
        assert!((estimate.limit - 1.0).abs() < 1e-12);
        assert!((estimate.error - SAFETY_OF_TWO * 0.05).abs() < 1e-12);
        assert_eq!(Estimate::of(&values[..1], 1.0), None);
    }

    /// For an error C/n + D/n^1.5, the second term remains, and is estimated with its factor of
    /// safety. A limit on which two pairs agree by chance is assigned a fifth of the leading error.
    #[test]
    fn a_limit_states_what_is_left_in_it() {
        let values = samples(&[10.0, 20.0, 40.0], |n| 3.0 - 0.5 / n + 2.0 * n.powf(-1.5));
        let limit = Limit::of(&values, 1.0).unwrap();
        let left = (limit.value - 3.0).abs();
        assert!((limit.error / left - SAFETY_OF_LIMITS).abs() < 1e-9, "{limit:?}");
        let values = samples(&[10.0, 20.0, 40.0], |n| 3.0 - 5.0 / n);
        let limit = Limit::of(&values, 1.0).unwrap();
        assert!((limit.value - 3.0).abs() < 1e-12);
        assert!((limit.error / (LEAST_SHARE * 5.0 / 40.0) - 1.0).abs() < 1e-9, "{limit:?}");
        assert_eq!(Limit::of(&values[..2], 1.0), None);
    }

    /// Stated errors cover the true ones, for all series of grids. Without the width of the slip
    /// zone, they do not: a/10 to a/40 at 0.05 gave 4.4007 ± 1.0 %, and 3.72 is right.
    #[test]
    fn a_narrow_slip_zone_has_no_order() {
        const ORDER: f64 = 1.5;
        let mut limits = 0;
        for (traction, grids, truth) in TRACTIONS {
            let sample = |n: usize| {
                let [width, value] = grids[n];
                Sample { level: 10.0 * f64::from(1 << n), value, slip_zone: Some(width) }
            };
            let all: Vec<Sample> = (0..grids.len()).map(sample).collect();
            for first in 0..all.len() - 1 {
                for last in first + 2..=all.len() {
                    let used = &all[first..last];
                    let off = (used[used.len() - 1].value - truth).abs();
                    let estimate = Estimate::of(used, ORDER).unwrap();
                    assert!(estimate.error >= off, "{traction}: {used:?}, {estimate:?}");
                    if let Some(limit) = Limit::of(used, ORDER) {
                        limits += 1;
                        let off = (limit.value - truth).abs();
                        assert!(limit.error >= off, "{traction}: {used:?}, {limit:?}");
                    }
                }
            }
        }
        assert_eq!(limits, 6, "of 0.2 and 0.3, where the zone is wide enough");
    }

    /// The two finest grids agree by chance; the coarser pair does not.
    #[test]
    fn an_agreement_by_chance_is_not_believed() {
        let values = [[10.0, 1.0], [20.0, 1.2], [40.0, 1.2]];
        let values = values.map(|[level, value]| Sample { level, value, slip_zone: None });
        let error = Estimate::of(&values, 1.0).unwrap().error;
        let falls = 2f64.powf(ORDER_OF_COARSER);
        assert!((error - SAFETY_OF_THREE * 0.2 / (falls - 1.0) / falls).abs() < 1e-12, "{error}");
    }

    /// An order above the expected one would understate the error.
    #[test]
    fn too_high_an_order_is_not_believed() {
        let values = samples(&[10.0, 20.0, 40.0], |n| 3.0 - 5.0 * n.powi(-3));
        let estimate = Estimate::of(&values, 1.0).unwrap();
        assert!((estimate.observed_order.unwrap() - 3.0).abs() < 1e-9);
        assert_eq!(estimate.order, 1.0);
        assert!(estimate.error > 5.0 * 40f64.powi(-3));
    }

    /// A slowly converging quantity has a large error, whatever order its model expects: the higher
    /// order would state 0.79 where 3.3 remain.
    #[test]
    fn a_low_order_is_believed() {
        for (order, expected) in [(0.2, 1.0), (0.4, 1.0), (0.9, 2.0), (0.05, 1.0)] {
            let values = samples(&[10.0, 20.0, 40.0], |n| 3.0 - 5.0 * n.powf(-order));
            let estimate = Estimate::of(&values, expected).unwrap();
            assert!((estimate.order - order).abs() < 1e-9, "{estimate:?}");
            let left = 5.0 * 40f64.powf(-order);
            assert!((estimate.error / left - SAFETY_OF_THREE).abs() < 1e-6, "{estimate:?}: {left}");
        }
    }

    /// Values that oscillate, stagnate or diverge show no order, so the expected one is used.
    #[test]
    fn no_order_is_no_reason_to_stop() {
        for values in [[1.0, 2.0, 1.5], [1.0, 1.0, 1.0], [1.0, 1.1, 2.0]] {
            let values: Vec<Sample> = [10.0, 20.0, 40.0]
                .into_iter()
                .zip(values)
                .map(|(level, value)| Sample { level, value, slip_zone: None })
                .collect();
            let estimate = Estimate::of(&values, 2.0).unwrap();
            assert_eq!((estimate.observed_order, estimate.order), (None, 2.0));
            assert!(estimate.error.is_finite());
        }
    }
}
