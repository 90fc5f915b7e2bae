//! Maximum and root of a function of one variable.

/// Returns position and value of the maximum of a function with a single maximum in [low, high], by
/// golden-section search (Kiefer 1953).
///
/// The position has an error of about the square root of the rounding error of `f`, relative to the
/// scale on which `f` varies, because closer values of `f` cannot be distinguished.
pub fn maximum(mut low: f64, mut high: f64, f: impl Fn(f64) -> f64) -> (f64, f64) {
    const GOLDEN: f64 = 0.618_033_988_749_894_8;
    const STEPS: u32 = 44; // GOLDEN^44 = 6e-10
    let (mut left, mut right) = (high - GOLDEN * (high - low), low + GOLDEN * (high - low));
    let (mut f_left, mut f_right) = (f(left), f(right));
    for _ in 0..STEPS {
        if f_left < f_right {
            (low, left, f_left) = (left, right, f_right);
            right = low + GOLDEN * (high - low);
            f_right = f(right);
        } else {
            (high, right, f_right) = (right, left, f_left);
            left = high - GOLDEN * (high - low);
            f_left = f(left);
        }
    }
    if f_left < f_right { (right, f_right) } else { (left, f_left) }
}

/// Returns the point in [0, ∞) where a decreasing function with `f(0) > 0` changes sign, to
/// rounding. Brackets the root by doubling from `scale`, then uses [`root_in_bracket`]. Returns
/// `None` if `f` keeps its sign up to 2^60 scales.
pub fn root_of_decreasing(scale: f64, f: impl Fn(f64) -> f64) -> Option<f64> {
    let at = |x: f64| (x, f(x));
    let (mut other, mut newest) = (at(0.0), at(scale));
    let mut doublings = 0;
    while newest.1 > 0.0 {
        (other, newest) = (newest, at(2.0 * newest.0));
        doublings += 1;
        if doublings > 60 {
            return None;
        }
    }
    root_in_bracket([other, newest], f)
}

/// Returns the point between two ends where a function changes sign, to rounding. Returns `None` if
/// the function has the same sign at both ends.
pub fn root_between(ends: [f64; 2], f: impl Fn(f64) -> f64) -> Option<f64> {
    root_in_bracket(ends.map(|x| (x, f(x))), f)
}

/// Returns the point between two ends with known values where a function changes sign, to rounding.
/// Uses inverse quadratic interpolation where safe, otherwise bisection (Chandrupatla, Advances in
/// Engineering Software 28 (1997) 145–149). Returns `None` for equal signs at both ends, or for
/// NaN.
pub fn root_in_bracket(ends: [(f64, f64); 2], f: impl Fn(f64) -> f64) -> Option<f64> {
    const STEPS: u32 = 200;
    if let Some((place, _)) = ends.into_iter().find(|(_, value)| *value == 0.0) {
        return Some(place);
    }
    let [mut other, mut newest] = ends;
    let known = |(place, value): (f64, f64)| place.is_finite() && !value.is_nan();
    if (other.1 > 0.0) == (newest.1 > 0.0) || !ends.into_iter().all(known) {
        return None;
    }
    let mut share = 0.5;
    for _ in 0..STEPS {
        let place = newest.0 + share * (other.0 - newest.0);
        let next = (place, f(place));
        if !known(next) {
            // NaN brackets no root.
            return None;
        }
        // The root lies between `newest` and `other`; `last` is the point before.
        let last;
        if (next.1 > 0.0) == (newest.1 > 0.0) {
            last = newest;
        } else {
            (last, other) = (other, newest);
        }
        newest = next;
        let closest = if newest.1.abs() < other.1.abs() { newest } else { other };
        let least = 2.0 * f64::EPSILON * closest.0.abs() / (other.0 - newest.0).abs();
        if closest.1 == 0.0 || least >= 0.5 {
            return Some(closest.0);
        }
        let parabola = interpolated(newest, other, last);
        // Infinite values have no parabola.
        share = if parabola.is_finite() { parabola.clamp(least, 1.0 - least) } else { 0.5 };
    }
    Some(newest.0)
}

/// Returns the zero of the inverse parabola through three points, as a fraction of the way from
/// `newest` to `other`; 0.5 if the parabola is not monotone between them.
fn interpolated(newest: (f64, f64), other: (f64, f64), last: (f64, f64)) -> f64 {
    let place = (newest.0 - other.0) / (last.0 - other.0);
    let value = (newest.1 - other.1) / (last.1 - other.1);
    if value * value >= place || (1.0 - value).powi(2) >= 1.0 - place {
        return 0.5;
    }
    newest.1 / (other.1 - newest.1) * last.1 / (other.1 - last.1)
        + (last.0 - newest.0) / (other.0 - newest.0) * newest.1 / (last.1 - newest.1) * other.1
            / (last.1 - other.1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::cell::Cell;

    /// Roots at and near both ends, a function flat at one end, one infinite at both ends, and one
    /// without a root.
    #[test]
    fn roots_stay_in_their_bracket() {
        for root in [0.0, 1e-12, 1e-3, 0.5, 0.999, 1.0 - 1e-9, 1.0] {
            let value = |x: f64| 1.0 - (1.0 - x).powi(2);
            let target = value(root);
            let excess = |x: f64| {
                assert!((0.0..=1.0).contains(&x));
                value(x) - target
            };
            let found = root_between([0.0, 1.0], excess).unwrap();
            assert!((value(found) - target).abs() <= 4e-16, "{root}: {found}");
        }
        let infinite = |x: f64| 1.0 / x - 1.0 / (1.0 - x);
        assert!((root_between([0.0, 1.0], infinite).unwrap() - 0.5).abs() < 1e-15);
        assert!((root_between([-3.0, -1.0], |x| x + 2.0).unwrap() + 2.0).abs() < 1e-15);
        assert_eq!(root_between([0.0, 1.0], |x| 1.0 + x), None);
    }

    #[test]
    fn maximum_of_a_parabola() {
        let (x, value) = maximum(-1.0, 2.0, |x| 3.0 - (x - 0.3) * (x - 0.3));
        // Position: square root of the rounding error of f.
        assert!((x - 0.3).abs() < 1e-7 && (value - 3.0).abs() < 1e-14, "{x} {value}");
    }

    #[test]
    fn root_far_from_and_near_to_the_scale() {
        for scale in [1e-6, 1.0, 1e6] {
            let root = root_of_decreasing(scale, |x| (-x).exp() - 0.25).unwrap();
            // Rounding of the exponential.
            assert!((root - 4_f64.ln()).abs() < 1e-14, "{root}");
        }
        let count = Cell::new(0);
        let erfc = |x: f64| {
            count.set(count.get() + 1);
            libm::erfc(x) - (-1.0_f64).exp()
        };
        let root = root_of_decreasing(0.3, erfc).unwrap();
        assert!((libm::erfc(root) - (-1.0_f64).exp()).abs() < 1e-15 && count.get() <= 14, "{root}");
        // Flat on one side of the root, steep on the other.
        let root = root_of_decreasing(1.0, |x| (2.0 - x).powi(9)).unwrap();
        assert!((root - 2.0).abs() < 1e-12, "{root}");
        assert_eq!(root_of_decreasing(1.0, |_| 1.0), None);
        // NaN beyond a point, or everywhere, is not a root.
        for known in [0.5, -1.0] {
            let value = |x: f64| if x < known { 1.0 } else { f64::NAN };
            assert_eq!(root_of_decreasing(1.0, value), None);
        }
        assert_eq!(root_of_decreasing(f64::INFINITY, |x| 1.0 - x), None);
    }
}
