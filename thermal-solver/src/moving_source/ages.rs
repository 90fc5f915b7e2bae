//! Ages and weights for ∫₀^∞ f(τ) dτ/√τ.
//!
//! With r = √τ it is 2 ∫ f(r²) dr. What f knows of an element is how the Gaussian of width
//! s = √(4κτ) about the way Vτ covers it, so that f changes over τ itself, and over s/V: panels are as long
//! as the shorter of three times either. The first one ends where neither has reached the end of an
//! element. Without speed f falls like 1/τ in the end, and what is left beyond the last age has a closed
//! form; with speed it ends when the material has left the grid.
//!
//! With twelve points a panel the error is about 1e-9 (test in [`super::half_space`]).

use crate::quadrature::points;

/// An age and its weight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Age {
    /// The age τ [s].
    pub age: f64,
    /// Its weight in ∫ f dτ/√τ [√s].
    pub weight: f64,
}

/// Length of a panel over its age, and over s/V.
const LONGEST: f64 = 3.0;
/// Widths s beyond which a Gaussian is nothing.
pub const REACH: f64 = 6.0;
/// The oldest age over the time in which heat spreads over the grid.
const OLDEST: f64 = 1e12;

/// The ages for elements of this size [m] on a grid of this length [m], for a body of this diffusivity
/// [m²/s] at this speed [m/s].
#[must_use]
pub fn ages(diffusivity: f64, speed: f64, element: [f64; 2], length: f64) -> Vec<Age> {
    let smallest = element[0].min(element[1]);
    let spread = |age: f64| (4.0 * diffusivity * age).sqrt();
    let to_spread = smallest * smallest / (4.0 * diffusivity);
    let first = (to_spread / 250.0).min(element[0] / (20.0 * speed));
    let oldest = OLDEST * length * length / diffusivity;
    let last = left_at(diffusivity, speed, length + element[0]).min(oldest);
    let mut ages = Vec::new();
    let (mut from, mut to) = (0.0, first);
    while from < last {
        let panel = points(f64::sqrt(from), f64::sqrt(to));
        ages.extend(panel.map(|(root, weight)| Age { age: root * root, weight: 2.0 * weight }));
        from = to;
        to = from + (LONGEST * from).min(LONGEST * spread(from) / speed);
    }
    if last == oldest {
        // Beyond it f is proportional to 1/age.
        ages.push(Age { age: from, weight: 2.0 * from.sqrt() });
    }
    ages
}

/// Age at which what was heated this far upstream [m] has left, its spread included [s].
fn left_at(diffusivity: f64, speed: f64, length: f64) -> f64 {
    let reach = REACH * (4.0 * diffusivity).sqrt();
    let root = (reach + (reach * reach + 4.0 * speed * length).sqrt()) / (2.0 * speed);
    root * root
}

#[cfg(test)]
mod tests {
    use super::*;

    /// ∫ dτ/√τ over an interval that ends when the material has left, and of 1/(1 + τ) without speed,
    /// which is π. Tolerance: Gauss's rule.
    #[test]
    fn integrals_of_known_functions() {
        let fast = ages(1e-5, 30.0, [1e-4, 1e-4], 0.02);
        let last = fast.last().unwrap().age;
        let sum: f64 = fast.iter().map(|age| age.weight).sum();
        assert!((sum / (2.0 * last.sqrt()) - 1.0).abs() < 0.02, "{sum} {last}");
        let rest = ages(1e-5, 0.0, [1e-4, 1e-4], 0.02);
        let integral: f64 = rest.iter().map(|one| one.weight / (1.0 + one.age)).sum();
        assert!((integral / std::f64::consts::PI - 1.0).abs() < 1e-9, "{integral}");
    }
}
