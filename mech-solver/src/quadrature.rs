//! Quadrature that tests compare closed forms with; independent of the rule in `strips`.

/// ∫ over [from, to] by Simpson's rule after the substitution s(3 − s²)/2, which flattens both ends
/// and thus turns roots there into smooth functions. Relative error below 1e-10 for such functions.
pub(crate) fn integral(from: f64, to: f64, function: impl Fn(f64) -> f64) -> f64 {
    let (middle, half, intervals) = (0.5 * (from + to), 0.5 * (to - from), 4000);
    let step = 2.0 / f64::from(intervals);
    let term = |i: i32| {
        let s = -1.0 + step * f64::from(i);
        let simpson = if i % 2 == 1 { 4.0 } else { 2.0 };
        simpson * function(middle + half * 0.5 * s * (3.0 - s * s)) * 1.5 * (1.0 - s * s)
    };
    half * step / 3.0 * (1..intervals).map(term).sum::<f64>()
}
