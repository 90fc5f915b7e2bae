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

/// The place in [0, ∞) where a decreasing function with `f(0) > 0` changes sign: bracketed by
/// doubling from `scale`, then bisected to rounding. `None` if it keeps its sign over 2^60 scales.
pub fn root_of_decreasing(scale: f64, f: impl Fn(f64) -> f64) -> Option<f64> {
    let mut low = 0.0;
    let mut high = scale;
    let mut doublings = 0;
    while f(high) > 0.0 {
        (low, high) = (high, 2.0 * high);
        doublings += 1;
        if doublings > 60 {
            return None;
        }
    }
    loop {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            return Some(middle);
        }
        if f(middle) > 0.0 { low = middle } else { high = middle }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
        assert_eq!(root_of_decreasing(1.0, |_| 1.0), None);
    }
}
