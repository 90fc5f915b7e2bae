//! Kinks and smoothing of splines through measured points.
//!
//! For a function z(y) the parameter is y. For a plane curve (y(s), z(s)) it is the length s of the
//! chords, and both coordinates are splines over s.
//!
//! *Kinks.* τ_k are the turns of the chords and c_k = 2 τ_k/(h_{k−1} + h_k) the curvatures, with
//! the steps h of the parameter. A point is a kink if three conditions hold:
//!
//! - |τ_k| > [`LEAST_TURN`]; a smaller turn moves a spline by less than 10⁻⁴ h.
//! - |c_k| is more than [`SHARPNESS`] times the second largest among the points two and three away.
//!   Neither the beginning of an arc nor a rounding with several points is then a kink, and a
//!   corner cut by two kinks is two kinks.
//! - |c_k| exceeds the median of all points by the same factor, which is the level of noise.
//!
//! A corner between two points is two kinks with a straight chord between them.
//!
//! *Smoothing.* Between kinks the curve minimises ∫z''² + (1/λ) Σ (z_k − measured)², with the
//! largest λ that leaves every point within the tolerance; kinks and ends stay. A corner whose turn
//! amounts to less than the tolerance, τ h_{k−1} h_k/(h_{k−1} + h_k), is smoothed too.
//!
//! Source: de Boor, *A Practical Guide to Splines* (1978) ch. 4 and 14; Reinsch, Numer. Math. 10
//! (1967) 177, for the smoothing spline.

/// Smallest turn of a kink [rad].
const LEAST_TURN: f64 = 2e-3;
/// Curvature of a kink relative to its surroundings.
const SHARPNESS: f64 = 4.0;
/// Bisection steps in the search for ln λ.
const STEPS: usize = 40;
/// Range of λ over the cubed mean spacing, from no smoothing to smoothing over about a hundred
/// points.
const SMOOTHING: [f64; 2] = [1e-6, 1e8];

/// Indices of the kinks of a polygon whose chords have these lengths [m] and turn by `turns` from
/// one to the next. Corners within the tolerance [m] are no kinks.
pub(crate) fn kinks(spacing: &[f64], turns: &[f64], tolerance: f64) -> Vec<usize> {
    let curvature = |(at, turn): (usize, &f64)| 2.0 * turn.abs() / (spacing[at] + spacing[at + 1]);
    let curvatures: Vec<f64> = turns.iter().enumerate().map(curvature).collect();
    let mut sorted = curvatures.clone();
    sorted.sort_by(f64::total_cmp);
    let median = sorted.get(sorted.len() / 2).copied().unwrap_or(0.0);
    let is_kink = |at: &usize| {
        let (left, right) = (spacing[*at], spacing[at + 1]);
        let corner = turns[*at].abs() * left * right / (left + right);
        let around = second_largest(&curvatures, *at);
        let sharp = around.is_some_and(|c| curvatures[*at] > SHARPNESS * c.max(median));
        sharp && turns[*at].abs() > LEAST_TURN && corner > tolerance
    };
    (0..turns.len()).filter(is_kink).map(|at| at + 1).collect()
}

/// Result of `fit` with the largest λ that moves no point by more than the tolerance [m]. `fit`
/// also returns the largest move of a point. `spacing` is the mean step of the parameter [m].
pub(crate) fn smoothest<T>(
    spacing: f64,
    tolerance: f64,
    fit: impl Fn(f64) -> (T, f64),
) -> (T, f64) {
    let mut best = fit(0.0);
    if tolerance <= 0.0 {
        return best;
    }
    let mut bracket = SMOOTHING.map(|factor| (factor * spacing.powi(3)).ln());
    for step in 0..STEPS {
        // Try the strongest smoothing first, which may suffice.
        let exponent = if step == 0 { bracket[1] } else { 0.5 * (bracket[0] + bracket[1]) };
        let found = fit(exponent.exp());
        let within = found.1 <= tolerance;
        bracket[usize::from(!within)] = exponent;
        if within {
            best = found;
        }
        if within && step == 0 {
            break;
        }
    }
    best
}

/// Second largest of the values two and three places from `at`; the largest if there is only one.
fn second_largest(values: &[f64], at: usize) -> Option<f64> {
    let before = [3, 2].into_iter().filter_map(|d| at.checked_sub(d));
    let around = before.chain([at + 2, at + 3]).filter_map(|k| values.get(k).copied());
    let mut around: Vec<f64> = around.collect();
    around.sort_by(f64::total_cmp);
    around.iter().rev().nth(1).or(around.first()).copied()
}

/// A smoothing spline.
pub(crate) struct Smoothed {
    /// Values at the points.
    pub(crate) z: Vec<f64>,
    /// Second derivatives at the points, zero at the ends.
    pub(crate) bend: Vec<f64>,
    /// Distance by which each point moved.
    pub(crate) moves: Vec<f64>,
}

/// Smoothing spline of λ with fixed ends: (R + λ QᵀVQ) z'' = Qᵀ measured and z = measured − λ V Q
/// z''. Q are the second differences, V is the identity except for zeros at the ends. λ = 0
/// interpolates.
pub(crate) fn smoothed(y: &[f64], z: &[f64], lambda: f64) -> Smoothed {
    let count = y.len();
    let h: Vec<f64> = y.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let free = |k: usize| if k == 0 || k == count - 1 { 0.0 } else { lambda };
    // Column k of Q, at the points k − 1, k and k + 1.
    let q = |k: usize| [1.0 / h[k - 1], -1.0 / h[k - 1] - 1.0 / h[k], 1.0 / h[k]];
    // Row k of the matrix: the diagonal, and one and two places beside it.
    let row = |k: usize| {
        let [left, middle, right] = q(k);
        let diagonal = (h[k - 1] + h[k]) / 3.0
            + free(k - 1) * left * left
            + free(k) * middle * middle
            + free(k + 1) * right * right;
        let next = (k + 2 < count).then(|| q(k + 1));
        let beside = next.map_or(0.0, |[first, second, _]| {
            h[k] / 6.0 + free(k) * middle * first + free(k + 1) * right * second
        });
        let beyond = if k + 3 < count { free(k + 1) * right * q(k + 2)[0] } else { 0.0 };
        [diagonal, beside, beyond]
    };
    let right_side = |k: usize| {
        let [left, middle, right] = q(k);
        left * z[k - 1] + middle * z[k] + right * z[k + 1]
    };
    let inner = 1..count - 1;
    let mut bend = vec![0.0; count];
    let solved = solve_pentadiagonal(
        inner.clone().map(row).collect(),
        inner.clone().map(right_side).collect(),
    );
    bend[inner].copy_from_slice(&solved);
    let (mut smooth, mut moves) = (z.to_vec(), vec![0.0; count]);
    if lambda > 0.0 {
        for k in 1..count - 1 {
            let turn = (bend[k + 1] - bend[k]) / h[k] - (bend[k] - bend[k - 1]) / h[k - 1];
            smooth[k] -= lambda * turn;
            moves[k] = lambda * turn;
        }
    }
    Smoothed { z: smooth, bend, moves }
}

/// Solves a symmetric positive definite system by LDLᵀ; `rows` holds the diagonal and the entries
/// one and two places beside it.
fn solve_pentadiagonal(mut rows: Vec<[f64; 3]>, mut values: Vec<f64>) -> Vec<f64> {
    let count = rows.len();
    for k in 0..count {
        let [diagonal, beside, beyond] = rows[k];
        let factors = [beside / diagonal, beyond / diagonal];
        if k + 1 < count {
            rows[k + 1][0] -= factors[0] * beside;
            rows[k + 1][1] -= factors[0] * beyond;
            values[k + 1] -= factors[0] * values[k];
        }
        if k + 2 < count {
            rows[k + 2][0] -= factors[1] * beyond;
            values[k + 2] -= factors[1] * values[k];
        }
        rows[k] = [diagonal, factors[0], factors[1]];
    }
    for k in (0..count).rev() {
        let [diagonal, one, two] = rows[k];
        let after = |distance: usize| values.get(k + distance).copied().unwrap_or(0.0);
        values[k] = values[k] / diagonal - one * after(1) - two * after(2);
    }
    values
}
