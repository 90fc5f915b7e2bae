//! Friction coefficient and largest traction of each element of a contact.

/// Friction coefficient and largest traction of each element.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ElementFriction {
    /// Friction coefficients f [-].
    coefficient: Vec<f64>,
    /// Largest tractions τ [Pa]; infinite for no limit.
    largest: Vec<f64>,
}

impl ElementFriction {
    /// Creates the friction of elements with these coefficients [-] and largest tractions [Pa],
    /// infinite for no limit.
    ///
    /// # Panics
    /// If the two lists differ in length.
    #[must_use]
    pub fn new(coefficient: Vec<f64>, largest: Vec<f64>) -> Self {
        assert_eq!(coefficient.len(), largest.len(), "one bound an element");
        Self { coefficient, largest }
    }

    /// Creates the friction of `count` elements with one coefficient [-] and no further limit.
    #[must_use]
    pub fn uniform(count: usize, coefficient: f64) -> Self {
        Self::of_coefficients(vec![coefficient; count])
    }

    /// Creates the friction of elements with these coefficients [-] and no further limit.
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

    /// Mean coefficient of some elements, weighted with their pressure: Σ f p/Σ p; 0 without
    /// pressure [-].
    #[must_use]
    pub fn mean(&self, elements: std::ops::Range<usize>, pressure: &[f64]) -> f64 {
        ratio(elements.map(|index| (self.coefficient[index] * pressure[index], pressure[index])))
    }

    /// Uniform coefficient under which a sliding contact carries the same force:
    /// Σ min(f p, τ s)/Σ p, for elements of which the share s touches. Their pressure is a mean
    /// over the whole element, the bound holds on the part that touches [-].
    #[must_use]
    pub fn equivalent(&self, pressure: &[f64], touching: &[f64]) -> f64 {
        let of = |(index, (p, share)): (usize, (&f64, &f64))| match *share > 0.0 {
            true => (share * self.bound(index, p / share), *p),
            false => (0.0, *p),
        };
        ratio(pressure.iter().zip(touching).enumerate().map(of))
    }

    /// Bound of an element, scaled from the bound under a uniform coefficient `mean` [Pa].
    #[must_use]
    pub fn limit(&self, index: usize, mean: f64, bound: f64) -> f64 {
        let share = if mean > 0.0 { self.coefficient[index] / mean } else { 0.0 };
        (share * bound).min(self.largest[index])
    }
}

/// Ratio of the sum of the first values to the sum of the second; 0 if the latter is zero.
fn ratio(pairs: impl Iterator<Item = (f64, f64)>) -> f64 {
    let (sum, weight) = pairs.fold((0.0, 0.0), |(sum, weight), (s, w)| (sum + s, weight + w));
    if weight > 0.0 { sum / weight } else { 0.0 }
}
