//! Maximum and root of a function of one variable.

/// Place and value of the maximum of a function with one maximum in [low, high]: the vertex of the
/// parabola through the three best places, golden section where that does not help (Brent, Algorithms
/// for Minimization without Derivatives, 1973, ch. 5).
///
/// The place is found to about the square root of the rounding error of `f`, relative to the
/// scale on which `f` varies: closer, values no longer differ.
pub fn maximum(mut low: f64, mut high: f64, f: impl Fn(f64) -> f64) -> (f64, f64) {
    const GOLDEN: f64 = 0.381_966_011_250_105_1;
    const STEPS: u32 = 60;
    let near = 1e-8 * (high - low);
    let at = |x: f64| (x, f(x));
    let mut best = at(low + GOLDEN * (high - low));
    let (mut second, mut third) = (best, best);
    let (mut step, mut before) = (0.0_f64, 0.0_f64);
    for _ in 0..STEPS {
        let middle = 0.5 * (low + high);
        if (best.0 - middle).abs() <= 2.0 * near - 0.5 * (high - low) {
            break;
        }
        let vertex = vertex(best, second, third);
        let inside = low < best.0 + vertex && best.0 + vertex < high;
        if inside && vertex.abs() < 0.5 * before.abs() {
            (step, before) = (vertex, step);
            let (left, right) = (best.0 + step - low, high - best.0 - step);
            if left.min(right) < 2.0 * near {
                step = near.copysign(middle - best.0);
            }
        } else {
            before = if best.0 < middle { high } else { low } - best.0;
            step = GOLDEN * before;
        }
        let next = at(best.0 + step.abs().max(near).copysign(step));
        if next.1 >= best.1 {
            *(if next.0 < best.0 { &mut high } else { &mut low }) = best.0;
            (third, second, best) = (second, best, next);
            continue;
        }
        *(if next.0 < best.0 { &mut low } else { &mut high }) = next.0;
        if next.1 >= second.1 || second.0 == best.0 {
            (third, second) = (second, next);
        } else if next.1 >= third.1 || third.0 == best.0 || third.0 == second.0 {
            third = next;
        }
    }
    best
}

/// From the first of three points to the vertex of the parabola through them; no number if there is none.
fn vertex(first: (f64, f64), second: (f64, f64), third: (f64, f64)) -> f64 {
    let to_second = (first.0 - second.0) * (first.1 - third.1);
    let to_third = (first.0 - third.0) * (first.1 - second.1);
    let across = (first.0 - second.0) * to_second - (first.0 - third.0) * to_third;
    across / (2.0 * (to_third - to_second))
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

    /// Few evaluations of a smooth function, and a bounded number of one with a corner; maxima at an end.
    #[test]
    fn maximum_of_what_is_no_parabola() {
        let count = Cell::new(0);
        let counted = |f: fn(f64) -> f64| {
            count.set(0);
            let (x, value) = maximum(0.0, 1.0, |x| {
                count.set(count.get() + 1);
                f(x)
            });
            assert_eq!(value, f(x));
            (x, count.get())
        };
        let (x, evaluations) = counted(|x| x * (-3.0 * x).exp());
        assert!((x - 1.0 / 3.0).abs() < 3e-8 && evaluations <= 14, "{x} {evaluations}");
        for f in [|x: f64| -(x - 0.7).abs(), |x: f64| x.powi(8), |x: f64| -x.sqrt()] {
            let (x, evaluations) = counted(f);
            let highest =
                (0..=1000).map(|step| f(f64::from(step) / 1000.0)).fold(f64::MIN, f64::max);
            // Corner: the place as near as asked for; an end is met from inside.
            assert!(f(x) > highest - 2e-4 && evaluations <= 61, "{x} {evaluations}");
        }
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
    }
}
