//! A material that is softer where it is warm.

use crate::case::piecewise_linear::PiecewiseLinear;

/// Of the softest element, among the figures of a contact.
pub(crate) const LEAST_SHARE: &str = "least_stiffness_share";

/// Shares of Young's modulus and of the yield stress over the temperature, of a body that begins at one.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Softening {
    /// Shares that fall with the temperature [K].
    curve: PiecewiseLinear<2>,
    /// Initial temperature [K].
    initial: f64,
    /// Shares at that.
    at_first: [f64; 2],
}

impl Softening {
    /// Of shares that fall with the temperature; `None` if they have none at the initial one [K].
    pub(crate) fn new(curve: PiecewiseLinear<2>, initial: f64) -> Option<Self> {
        let at_first = curve.at(initial)?;
        Some(Self { curve, initial, at_first })
    }

    /// The shares that all of the body has, which is as warm as that.
    pub(crate) fn of_body(&self) -> [f64; 2] {
        self.at_first
    }

    /// The shares at a rise [K], of what the body has.
    ///
    /// # Errors
    /// The temperature [K], if it is beyond the curve.
    pub(crate) fn at(&self, rise: f64) -> Result<[f64; 2], f64> {
        let temperature = self.initial + rise.max(0.0);
        let shares = self.curve.at(temperature).ok_or(temperature)?;
        Ok([0, 1].map(|k| shares[k] / self.at_first[k]))
    }
}
