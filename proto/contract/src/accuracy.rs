//! What is known of a model's errors before it runs: how they fall with its resolution, and what no
//! resolution removes.
//!
//! With it a target of accuracy can choose a model and a resolution without running all of them, and
//! a study knows what to refine. The errors are expectations, from the studies named in `source`;
//! what a run states is estimated from its own grids.
//!
//! An error is relative, of the quantity that a case is asked for (the largest temperature rise, if
//! nothing else is named):
//!
//! ```text
//! error = Σ simplifications + refinement.error · (levels[0] / level)^order
//! ```

use serde::{Deserialize, Serialize};

/// What is known of a model's errors. A model that says nothing is taken as exact, and has nothing
/// to refine.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Accuracy {
    /// How its error falls with its resolution; `None` for a model without a resolution of its own.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub refinement: Option<Refinement>,
    /// What it leaves out; no resolution brings it back.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub simplifications: Vec<Simplification>,
}

impl Accuracy {
    /// There is nothing to say.
    #[must_use]
    pub fn is_silent(&self) -> bool {
        *self == Self::default()
    }

    /// The expected relative error that no resolution removes, with these effects active.
    #[must_use]
    pub fn of_model(&self, active: &dyn Fn(&str) -> bool) -> f64 {
        let counts = |one: &&Simplification| one.applies(active);
        self.simplifications.iter().filter(counts).map(|one| one.error).sum()
    }

    /// What is wrong with it, as it came from outside.
    ///
    /// # Errors
    /// Levels that do not rise, an order or an error that is no positive number.
    pub fn check(&self) -> Result<(), String> {
        let bad = |error: f64| !(error.is_finite() && error >= 0.0);
        if let Some(one) = self.simplifications.iter().find(|one| bad(one.error)) {
            return Err(format!("`{}` has an error of {}", one.what, one.error));
        }
        self.refinement.as_ref().map_or(Ok(()), Refinement::check)
    }
}

/// How a model's error falls with its resolution.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Refinement {
    /// The case key that sets the resolution; the larger its value the finer.
    pub key: String,
    /// Values worth running, coarsest first.
    pub levels: Vec<u32>,
    /// Order of convergence: the error falls as `level^-order`.
    pub order: f64,
    /// Expected relative error at the first of the levels.
    pub error: f64,
    /// Where these numbers come from.
    pub source: String,
}

impl Refinement {
    /// The expected relative error at a level.
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

/// One thing that a model leaves out.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Simplification {
    /// What is left out, or stands for something else.
    pub what: String,
    /// It matters only with one of these effects; empty: always.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub with_effects: Vec<String>,
    /// Expected relative error.
    pub error: f64,
    /// Where the number comes from.
    pub source: String,
}

impl Simplification {
    /// One that matters always.
    #[must_use]
    pub fn always(what: &str, error: f64, source: &str) -> Self {
        let [what, source] = [what, source].map(str::to_owned);
        Self { what, with_effects: Vec::new(), error, source }
    }

    /// One that matters with this effect only.
    #[must_use]
    pub fn with(effect: &str, what: &str, error: f64, source: &str) -> Self {
        Self { with_effects: vec![effect.to_owned()], ..Self::always(what, error, source) }
    }

    /// It matters with these effects.
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
