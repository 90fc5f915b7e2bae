//! Integrals of a spread Gaussian over elements in a row.
//!
//! With v the position over the width s, an element from v₀ to v₁ = v₀ + H, θ = (v − v₀)/H and
//! g(v) = e^{−v²}/√π, the integrals are ∫ g dv across, and ∫ (1 − θ)² g, ∫ 2θ(1 − θ) g, ∫ θ² g
//! along, for the coefficients of a parabola in Bernstein form. For H above a fiftieth they follow
//! from ∫ vᵏ g dv, k = 0, 1, 2, by the error function and the Gaussian at both ends, which lose up
//! to (v₀/H)² roundings. For shorter elements Gauss's rule with three points has an error of order
//! H⁴. Both are accurate to 1e-9 of the length H.

use std::f64::consts::PI;

/// Length of an element above which the closed form is used.
const LONG: f64 = 0.02;

/// Nodes θ and weights of Gauss's rule on [0, 1].
const RULE: [(f64, f64); 3] = [
    (0.112_701_665_379_258_3, 5.0 / 18.0),
    (0.5, 4.0 / 9.0),
    (0.887_298_334_620_741_7, 5.0 / 18.0),
];

fn gauss(place: f64) -> f64 {
    (-place * place).exp() / PI.sqrt()
}

/// Returns ∫ g dv over `count` elements of length H, the first of which begins at v₀.
pub fn shares(first: f64, length: f64, count: usize) -> impl Iterator<Item = f64> {
    let place = move |at: usize| first + at as f64 * length;
    let mut before = if length > LONG { libm::erf(first) } else { 0.0 };
    (0..count).map(move |at| {
        if length > LONG {
            let erf = libm::erf(place(at + 1));
            return 0.5 * (erf - std::mem::replace(&mut before, erf));
        }
        let from = place(at);
        RULE.iter().map(|(theta, weight)| length * weight * gauss(from + theta * length)).sum()
    })
}

/// Returns ∫ (1 − θ)² g dv, ∫ 2θ(1 − θ) g dv and ∫ θ² g dv over each of `count` elements of length
/// H, the first of which begins at v₀.
pub fn parabolas(first: f64, length: f64, count: usize) -> impl Iterator<Item = [f64; 3]> {
    let place = move |at: usize| first + at as f64 * length;
    let mut before = match length > LONG {
        true => [libm::erf(first), gauss(first)],
        false => [0.0; 2],
    };
    (0..count).map(move |at| {
        let from = place(at);
        if length > LONG {
            let to = place(at + 1);
            let after = [libm::erf(to), gauss(to)];
            let [erf, gauss] = std::mem::replace(&mut before, after);
            return closed([from, to], [erf, after[0]], [gauss, after[1]]);
        }
        let mut sums = [0.0; 3];
        for (theta, weight) in RULE {
            let value = length * weight * gauss(from + theta * length);
            sums[0] += value * (1.0 - theta) * (1.0 - theta);
            sums[1] += value * 2.0 * theta * (1.0 - theta);
            sums[2] += value * theta * theta;
        }
        sums
    })
}

/// Returns the integrals of an element from positions, error functions and Gaussians at both ends.
fn closed(place: [f64; 2], erf: [f64; 2], gauss: [f64; 2]) -> [f64; 3] {
    let length = place[1] - place[0];
    let zeroth = 0.5 * (erf[1] - erf[0]);
    let first = 0.5 * (gauss[0] - gauss[1]);
    let second = 0.5 * (zeroth + place[0] * gauss[0] - place[1] * gauss[1]);
    // ∫ θ g and ∫ θ² g.
    let once = (first - place[0] * zeroth) / length;
    let square = place[0] * place[0] * zeroth - 2.0 * place[0] * first + second;
    let twice = square / (length * length);
    [zeroth - 2.0 * once + twice, 2.0 * (once - twice), twice]
}

#[cfg(test)]
mod tests {
    use super::*;
    use numerics::quadrature::points;

    /// Reference: Gauss's rule with twelve points on parts of an element. Tolerance: the error
    /// stated in the module header.
    #[test]
    fn parts_of_elements() {
        for first in [-6.0, -3.0, -1.2, -0.5, 0.0, 0.7, 4.0] {
            for length in [1e-6, 0.01, LONG, LONG + 1e-12, 0.2, 1.0, 2.0, 30.0] {
                let last = first + length;
                let (low, high) = (first.clamp(-7.0, 7.0), last.clamp(-7.0, 7.0));
                let expected = (0..64).fold([0.0; 3], |sums, piece| {
                    let at = |k: i32| low + (high - low) * f64::from(k) / 64.0;
                    points(at(piece), at(piece + 1)).fold(sums, |sums, (place, weight)| {
                        let (theta, value) = ((place - first) / length, weight * gauss(place));
                        let rest = 1.0 - theta;
                        let parts = [rest * rest, 2.0 * theta * rest, theta * theta];
                        std::array::from_fn(|k| sums[k] + value * parts[k])
                    })
                });
                let found = parabolas(first, length, 1).next().unwrap();
                let share = shares(first, length, 1).next().unwrap();
                let tolerance = 1e-9 * length.min(1.0);
                for (found, expected) in found.iter().zip(expected) {
                    assert!(
                        (found - expected).abs() < tolerance,
                        "{first} {length}: {found} {expected}"
                    );
                }
                assert!(
                    (share - expected.iter().sum::<f64>()).abs() < tolerance,
                    "{first} {length}"
                );
            }
        }
    }

    /// Consecutive elements cover the whole Gaussian. Tolerance: rounding of a thousand terms.
    #[test]
    fn elements_in_a_row_add_up() {
        for length in [0.02, 0.3, 5.0] {
            let count = (16.0 / length) as usize + 1;
            let sum: f64 = shares(-8.0, length, count).sum();
            let parts: f64 = parabolas(-8.0, length, count).flatten().sum();
            assert!(
                (sum - 1.0).abs() < 1e-13 && (parts - 1.0).abs() < 1e-12,
                "{length}: {sum} {parts}"
            );
        }
    }
}
