//! Expected errors of a model, stated before a run: convergence with resolution, and modelling
//! errors.
//!
//! A study uses the expectations to choose a model and a resolution for a target accuracy without
//! running every combination. The numbers come from the studies named in `source`. The error that a
//! run reports is estimated from its own grids.
//!
//! Errors are relative errors of the requested quantity (default: the largest temperature rise):
//!
//! ```text
//! error = Σ simplifications + refinement.error · (levels[0] / level)^order
//! ```

use serde::{Deserialize, Serialize};

/// Key of the figure that counts the elements across a zone whose edge lies inside the contact.
/// Studies extrapolate over grids only if the zone is wide enough on the coarsest.
pub const EDGE_ELEMENTS: &str = crate::figure::contact::SLIP_ZONE_ELEMENTS;

/// Expected errors of a model. The default describes an exact model without a resolution.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Accuracy {
    /// Convergence with resolution; `None` for a model without a resolution.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub refinement: Option<Refinement>,
    /// Modelling errors, which no resolution reduces.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub simplifications: Vec<Simplification>,
}

impl Accuracy {
    /// Returns true if nothing is stated.
    #[must_use]
    pub fn is_silent(&self) -> bool {
        *self == Self::default()
    }

    /// Returns the expected relative modelling error for a set of active effects.
    #[must_use]
    pub fn of_model(&self, active: &dyn Fn(&str) -> bool) -> f64 {
        let counts = |one: &&Simplification| one.applies(active);
        self.simplifications.iter().filter(counts).map(|one| one.error).sum()
    }

    /// Checks a statement received from another process.
    ///
    /// # Errors
    /// Fails if the levels do not rise, if the order or the error of a refinement is not positive,
    /// or if the error of a simplification is negative or not finite.
    pub fn check(&self) -> Result<(), String> {
        let bad = |error: f64| !(error.is_finite() && error >= 0.0);
        if let Some(one) = self.simplifications.iter().find(|one| bad(one.error)) {
            return Err(format!("`{}` has an error of {}", one.what, one.error));
        }
        self.refinement.as_ref().map_or(Ok(()), Refinement::check)
    }
}

/// Convergence of a model with its resolution.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Refinement {
    /// Case key that sets the resolution; a larger value is finer.
    pub key: String,
    /// Values worth running, coarsest first.
    pub levels: Vec<u32>,
    /// Order of convergence: the error falls as `level^-order`.
    pub order: f64,
    /// Expected relative error at the first level.
    pub error: f64,
    /// Origin of the numbers.
    pub source: String,
}

impl Refinement {
    /// Returns the expected relative error at a level.
    #[must_use]
    pub fn at(&self, level: f64) -> f64 {
        let first = self.levels.first().copied().map_or(level, f64::from);
        self.error * (first / level).powf(self.order)
    }

    fn check(&self) -> Result<(), String> {
        let Self { key, levels, order, error, .. } = self;
        let positive = |value: f64| value.is_finite() && value > 0.0;
        if levels.first().is_none_or(|first| *first == 0) || !levels.is_sorted_by(|a, b| a < b) {
            return Err(format!("the levels of `{key}` do not rise: {levels:?}"));
        }
        match positive(*order) && positive(*error) {
            true => Ok(()),
            false => Err(format!("`{key}` has the order {order} and the error {error}")),
        }
    }
}

/// A modelling simplification.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Simplification {
    /// Description of the neglected or replaced physics.
    pub what: String,
    /// Effects with which the simplification matters; empty if it always matters.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub with_effects: Vec<String>,
    /// Expected relative error.
    pub error: f64,
    /// Origin of the number.
    pub source: String,
}

impl Simplification {
    /// Returns a simplification that always matters.
    #[must_use]
    pub fn always(what: &str, error: f64, source: &str) -> Self {
        let [what, source] = [what, source].map(str::to_owned);
        Self { what, with_effects: Vec::new(), error, source }
    }

    /// Returns a simplification that matters only with the given effect.
    #[must_use]
    pub fn with(effect: &str, what: &str, error: f64, source: &str) -> Self {
        Self { with_effects: vec![effect.to_owned()], ..Self::always(what, error, source) }
    }

    /// Returns true if the simplification matters for a set of active effects.
    #[must_use]
    pub fn applies(&self, active: &dyn Fn(&str) -> bool) -> bool {
        self.with_effects.is_empty() || self.with_effects.iter().any(|effect| active(effect))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refinement() -> Refinement {
        let (key, source) = ("mech.resolution".to_owned(), "a study".to_owned());
        Refinement { key, levels: vec![10, 20], order: 2.0, error: 0.04, source }
    }

    #[test]
    fn an_error_falls_with_its_order_down_to_what_is_left_out() {
        let strips = Simplification::with("partial_slip", "strips", 0.3, "a study");
        let always = Simplification::always("no conduction along the surface", 0.01, "a study");
        let model =
            Accuracy { refinement: Some(refinement()), simplifications: vec![strips, always] };
        assert_eq!(model.check(), Ok(()));
        assert!((refinement().at(40.0) - 0.0025).abs() < 1e-15);
        assert!((model.of_model(&|_| false) - 0.01).abs() < 1e-15);
        assert!((model.of_model(&|name| name == "partial_slip") - 0.31).abs() < 1e-15);
        assert!(Accuracy::default().is_silent() && !model.is_silent());
    }

    #[test]
    fn nonsense_is_reported() {
        let of = |refinement| Accuracy { refinement: Some(refinement), ..Accuracy::default() };
        let levels = |levels: &[u32]| of(Refinement { levels: levels.to_vec(), ..refinement() });
        for wrong in [levels(&[]), levels(&[20, 10]), levels(&[0, 10]), levels(&[10, 10])] {
            assert!(wrong.check().unwrap_err().contains("do not rise"));
        }
        assert!(of(Refinement { order: 0.0, ..refinement() }).check().is_err());
        assert!(of(Refinement { error: f64::NAN, ..refinement() }).check().is_err());
        let negative = Simplification::always("x", -1.0, "s");
        let model = Accuracy { refinement: None, simplifications: vec![negative] };
        assert_eq!(model.check().unwrap_err(), "`x` has an error of -1");
    }
}
