//! Friction of the elements of a contact: a coefficient and a largest traction of each.

/// Friction of elements: a coefficient and a largest traction of each.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ElementFriction {
    /// Friction coefficients f [-].
    coefficient: Vec<f64>,
    /// Largest tractions τ [Pa]; infinite without a bound.
    largest: Vec<f64>,
}

impl ElementFriction {
    /// Friction of elements with these coefficients [-] and largest tractions [Pa], infinite
    /// without a bound.
    ///
    /// # Panics
    /// If there are not as many tractions as coefficients.
    #[must_use]
    pub fn new(coefficient: Vec<f64>, largest: Vec<f64>) -> Self {
        assert_eq!(coefficient.len(), largest.len(), "one bound an element");
        Self { coefficient, largest }
    }

    /// Friction of `count` elements with one coefficient [-] and no further bound.
    #[must_use]
    pub fn uniform(count: usize, coefficient: f64) -> Self {
        Self::of_coefficients(vec![coefficient; count])
    }

    /// Friction of elements with these coefficients [-] and no further bound.
    #[must_use]
    pub fn of_coefficients(coefficient: Vec<f64>) -> Self {
        Self { largest: vec![f64::INFINITY; coefficient.len()], coefficient }
    }

    /// Traction bound min(f p, τ) of an element under a pressure [Pa].
    #[must_use]
    pub fn bound(&self, index: usize, pressure: f64) -> f64 {
        (self.coefficient[index] * pressure).min(self.largest[index])
    }

    /// Traction bounds of all elements under their pressures [Pa].
    pub fn bounds<'a>(&'a self, pressure: &'a [f64]) -> impl Iterator<Item = f64> + 'a {
        pressure.iter().enumerate().map(|(index, pressure)| self.bound(index, *pressure))
    }

    /// Coefficient of some elements, weighted with their pressure: Σ f p/Σ p; 0 without pressure [-].
    #[must_use]
    pub fn mean(&self, elements: std::ops::Range<usize>, pressure: &[f64]) -> f64 {
        ratio(elements.map(|index| (self.coefficient[index] * pressure[index], pressure[index])))
    }

    /// The one coefficient with which a contact that slides carries the same force: Σ min(f p, τ)/Σ p [-].
    #[must_use]
    pub fn equivalent(&self, pressure: &[f64]) -> f64 {
        ratio(self.bounds(pressure).zip(pressure.iter().copied()))
    }

    /// Bound of an element from that of friction with one coefficient `mean` [Pa].
    #[must_use]
    pub fn limit(&self, index: usize, mean: f64, bound: f64) -> f64 {
        let share = if mean > 0.0 { self.coefficient[index] / mean } else { 0.0 };
        (share * bound).min(self.largest[index])
    }
}

/// Sum of the first over that of the second; 0 of nothing.
fn ratio(pairs: impl Iterator<Item = (f64, f64)>) -> f64 {
    let (sum, weight) = pairs.fold((0.0, 0.0), |(sum, weight), (s, w)| (sum + s, weight + w));
    if weight > 0.0 { sum / weight } else { 0.0 }
}
