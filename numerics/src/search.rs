//! Maximum and root of a function of one variable.

/// Place and value of the maximum of a function with one maximum in [low, high], by golden
/// section (Kiefer 1953).
///
/// The place is found to about the square root of the rounding error of `f`, relative to the
/// scale on which `f` varies: closer, values no longer differ.
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

/// The place in [0, ∞) where a decreasing function with `f(0) > 0` changes sign, to rounding: bracketed by
/// doubling from `scale`, then by inverse parabolas, and halves where those are not safe (Chandrupatla,
/// Advances in Engineering Software 28 (1997) 145–149). `None` if it keeps its sign over 2^60 scales.
pub fn root_of_decreasing(scale: f64, f: impl Fn(f64) -> f64) -> Option<f64> {
    const STEPS: u32 = 200;
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
    let mut share = 0.5;
    for _ in 0..STEPS {
        let next = at(newest.0 + share * (other.0 - newest.0));
        // The root lies between the newest place and the other one; the last is on the same side as either.
        let last;
        if (next.1 > 0.0) == (newest.1 > 0.0) {
            last = newest;
        } else {
            (last, other) = (other, newest);
        }
        newest = next;
        let closest = if newest.1.abs() < other.1.abs() { newest } else { other };
        let least = 2.0 * f64::EPSILON * closest.0 / (other.0 - newest.0).abs();
        if closest.1 == 0.0 || least >= 0.5 {
            return Some(closest.0);
        }
        if least.is_nan() {
            // Places or values that are no numbers bracket nothing.
            return None;
        }
        share = interpolated(newest, other, last).clamp(least, 1.0 - least);
    }
    Some(newest.0)
}

/// Way from `newest` towards `other` at which the inverse parabola through the three is zero, as a part of
/// it; half of it where that parabola is not monotone between them.
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

    #[test]
    fn maximum_of_a_parabola() {
        let (x, value) = maximum(-1.0, 2.0, |x| 3.0 - (x - 0.3) * (x - 0.3));
        // Place: square root of the rounding error of f.
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
        // Values that are no numbers beyond a place, or everywhere, are no roots.
        for known in [0.5, -1.0] {
            let value = |x: f64| if x < known { 1.0 } else { f64::NAN };
            assert_eq!(root_of_decreasing(1.0, value), None);
        }
        assert_eq!(root_of_decreasing(f64::INFINITY, |x| 1.0 - x), None);
    }
}
