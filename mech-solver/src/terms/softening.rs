//! Material that softens with temperature.

use crate::case::piecewise_linear::PiecewiseLinear;

/// Key of the smallest stiffness share of all elements.
pub(crate) const LEAST_SHARE: &str = "least_stiffness_share";

/// Shares of Young's modulus and of the yield stress over temperature, for a body with an initial
/// temperature.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Softening {
    /// Shares that fall with the temperature [K].
    curve: PiecewiseLinear<2>,
    /// Initial temperature [K].
    initial: f64,
    /// Shares at the initial temperature.
    at_first: [f64; 2],
}

impl Softening {
    /// Creates the law from shares that fall with temperature; `None` if the curve does not contain
    /// the initial temperature [K].
    pub(crate) fn new(curve: PiecewiseLinear<2>, initial: f64) -> Option<Self> {
        let at_first = curve.at(initial)?;
        Some(Self { curve, initial, at_first })
    }

    /// Shares of the whole body at its initial temperature.
    pub(crate) fn of_body(&self) -> [f64; 2] {
        self.at_first
    }

    /// Returns the shares at a temperature rise [K], relative to those at the initial temperature.
    ///
    /// # Errors
    /// A temperature beyond the curve [K].
    pub(crate) fn at(&self, rise: f64) -> Result<[f64; 2], f64> {
        let temperature = self.initial + rise.max(0.0);
        let shares = self.curve.at(temperature).ok_or(temperature)?;
        Ok([0, 1].map(|k| shares[k] / self.at_first[k]))
    }
}
