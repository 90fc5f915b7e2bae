//! Ages and weights for ∫ f(τ) dτ/√τ over an interval of the past with constant speed.
//!
//! With r = √τ the integral is 2 ∫ f(r²) dr. f depends on how the Gaussian of width s = √(4κτ)
//! around the distance Vτ covers an element, so f varies over τ itself, and over s/V. A panel is as
//! long as the shorter of three times either. At high speed s is a small fraction of an element,
//! and f is the flux itself along the path: a parabola from each edge to the next. Panels of half
//! an element then suffice, and their number does not grow with the speed. The first panel ends
//! where neither scale has reached the end of an element. Without speed f finally falls like 1/τ,
//! and the remainder beyond the last age has a closed form. With speed the integral ends when the
//! material has left the grid, or at the end of the interval. The number of ages is thus bounded
//! for any speed and any interval.
//!
//! With twelve points a panel the error is about 1e-9 (test in [`super::half_space`]).

use numerics::quadrature::points;

/// An age and its weight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Age {
    /// The age τ [s].
    pub age: f64,
    /// Weight in ∫ f dτ/√τ [√s].
    pub weight: f64,
}

/// An interval of the past.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PastInterval {
    /// Youngest age [s].
    pub from: f64,
    /// Oldest age [s]; may be infinite.
    pub to: f64,
    /// Distance that the surface has moved since the youngest age [m].
    pub way: f64,
    /// Speed of the surface [m/s].
    pub speed: f64,
}

impl PastInterval {
    /// Returns the whole past, at one speed [m/s].
    #[must_use]
    pub fn steady(speed: f64) -> Self {
        Self { from: 0.0, to: f64::INFINITY, way: 0.0, speed }
    }

    /// Returns the distance that the surface has moved since an age in the interval [m].
    #[must_use]
    pub fn way_at(&self, age: f64) -> f64 {
        self.way + self.speed * (age - self.from)
    }
}

/// Largest length of a panel over its age, and over s/V.
const LONGEST: f64 = 3.0;
/// Fraction of half an element below which a panel is joined to the next.
const SHORT: f64 = 1e-3;
/// Number of widths s beyond which a Gaussian is negligible.
pub const REACH: f64 = 6.0;
/// Largest age, over the time in which heat spreads over the grid.
const OLDEST: f64 = 1e12;

/// Returns the ages for elements of this size [m] on a grid of this length [m], for a body of this
/// diffusivity [m²/s] and an interval of the past; an interval without an end begins now.
#[must_use]
pub fn ages(diffusivity: f64, stretch: &PastInterval, element: [f64; 2], length: f64) -> Vec<Age> {
    let speed = stretch.speed;
    let smallest = element[0].min(element[1]);
    let spread = |age: f64| (4.0 * diffusivity * age).sqrt();
    let to_spread = smallest * smallest / (4.0 * diffusivity);
    let first = (to_spread / 250.0).min(element[0] / (20.0 * speed));
    let oldest = OLDEST * length * length / diffusivity;
    let endless = stretch.to == f64::INFINITY;
    // Distance still ahead when the interval begins, with the spreading at that time: √(a + b) is
    // below √a + √b.
    let ahead = length + element[0] - stretch.way + REACH * spread(stretch.from);
    let left = stretch.from + left_at(diffusivity, speed, ahead);
    let last = if endless { left.min(oldest) } else { stretch.to };
    let half_element = 0.5 * element[0] / speed;
    let next = |from: f64| {
        let blurred = LONGEST * spread(from) / speed;
        let sharp = ((from / half_element + SHORT).floor() + 1.0) * half_element - from;
        let step = if blurred < half_element { sharp } else { blurred };
        let to = if from > 0.0 { from + step.min(LONGEST * from) } else { first };
        to.max(from.next_up())
    };
    let (mut ages, mut from) = (Vec::new(), stretch.from);
    // Material that has left contributes nothing: later panels are left out whole, and no other
    // panel changes.
    while from < last.min(left) {
        let to = if endless { next(from) } else { next(from).min(last) };
        let panel = points(from.sqrt(), to.sqrt());
        ages.extend(panel.map(|(root, weight)| Age { age: root * root, weight: 2.0 * weight }));
        from = to;
    }
    if endless && last == oldest {
        // Beyond the last age f is proportional to 1/age.
        ages.push(Age { age: from, weight: 2.0 * from.sqrt() });
    }
    ages
}

/// Returns the age at which material heated this far upstream [m] has left, its spreading included
/// [s]; infinite without speed.
fn left_at(diffusivity: f64, speed: f64, length: f64) -> f64 {
    if speed == 0.0 {
        return f64::INFINITY;
    }
    let reach = REACH * (4.0 * diffusivity).sqrt();
    let discriminant = reach * reach + 4.0 * speed * length;
    if discriminant < 0.0 {
        // The material has left from the beginning, and its spreading does not come back.
        return 0.0;
    }
    let root = (reach + discriminant.sqrt()) / (2.0 * speed);
    root * root
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The number of ages stays bounded for any speed and interval, and no age that contributes is
    /// left out.
    #[test]
    fn the_number_of_ages_is_bounded_at_any_speed() {
        let (element, length) = ([1e-4, 1e-4], 0.02);
        let number = |stretch: PastInterval| ages(1e-5, &stretch, element, length).len();
        for speed in [1.0, 1e3, 1e9, 1e30, 1e300] {
            for to in [1e-9, 1e-3, 1e6] {
                let newest = PastInterval { from: 0.0, to, way: 0.0, speed };
                assert!(number(newest) <= 12 * 800, "{speed} {to}: {}", number(newest));
                let older = PastInterval { from: to, to: 2.0 * to, way: 0.0, speed };
                assert!(number(older) <= 12 * 800, "{speed} {to}: {}", number(older));
            }
        }
        // An interval that ends before the material leaves is covered completely.
        let short = PastInterval { from: 0.0, to: 1e-3, way: 0.0, speed: 1.0 };
        let sum: f64 = ages(1e-5, &short, element, length).iter().map(|age| age.weight).sum();
        assert!((sum - 2.0 * 1e-3_f64.sqrt()).abs() < 1e-12, "{sum}");
        let gone = PastInterval { from: 1.0, to: 2.0, way: 1.0, speed: 1.0 };
        assert_eq!(number(gone), 0);
    }

    /// ∫ dτ/√τ over an interval that ends when the material has left; and, without speed, the
    /// integral of 1/(1 + τ), which is π. Tolerance: Gauss's rule.
    #[test]
    fn integrals_of_known_functions() {
        let fast = ages(1e-5, &PastInterval::steady(30.0), [1e-4, 1e-4], 0.02);
        let last = fast.last().unwrap().age;
        let sum: f64 = fast.iter().map(|age| age.weight).sum();
        assert!((sum / (2.0 * last.sqrt()) - 1.0).abs() < 0.02, "{sum} {last}");
        let rest = ages(1e-5, &PastInterval::steady(0.0), [1e-4, 1e-4], 0.02);
        let integral: f64 = rest.iter().map(|one| one.weight / (1.0 + one.age)).sum();
        assert!((integral / std::f64::consts::PI - 1.0).abs() < 1e-9, "{integral}");
        // The grid is longer than the distance moved.
        let stretch = PastInterval { from: 0.5, to: 2.0, way: 0.1, speed: 1.0 };
        let part: f64 = ages(1e-5, &stretch, [1e-4, 1e-4], 2.0).iter().map(|one| one.weight).sum();
        assert!((part - 2.0 * (2f64.sqrt() - 0.5f64.sqrt())).abs() < 1e-14, "{part}");
    }
}
