//! Steady rolling of heated bodies, computed anew for all inputs.
//!
//! Every solve starts from cold steady rolling, so that it depends on the inputs only.

use super::creep_curve::CreepCurve;
use super::outcome::{self, Fields, met_force};
use super::passage::Report;
use crate::case::scene::Scene;
use crate::models::contact_model::Contact;
use crate::models::varying::no_answer;
use crate::terms::softening::LEAST_SHARE;
use crate::terms::surface::Surface;
use crate::terms::{Kind, Terms};
use explicit_fe::rolling::{Means, Rolling};
use explicit_fe::steady_rolling::settle_again;
use proto::field::{self, FieldSpec};
use proto::model::{Inputs, Step, StepError, StepReport};
use serde_json::Value;

/// A contact of heated bodies.
pub(super) struct Heated {
    rolling: Rolling,
    curve: CreepCurve,
    fields: Fields,
    report: Report,
    /// State of steady rolling without heat.
    cold: Vec<f64>,
    /// Summary of steady rolling without heat.
    cold_summary: Value,
}

/// A solved time window; its fields are those of the rolling bodies.
pub(super) struct Window {
    summary: Value,
    report: StepReport,
}

impl Heated {
    /// Creates the contact from steady rolling without heat, with its means.
    pub(super) fn new(
        mut rolling: Rolling,
        means: &Means,
        curve: CreepCurve,
        fields: Fields,
        report: Report,
    ) -> Self {
        let mut cold = Vec::new();
        rolling.keep(&mut cold);
        let cold_summary =
            warm_summary(&fields.scene, &rolling, means, fields.terms.softens().then_some(1.0));
        Self { rolling, curve, fields, report, cold, cold_summary }
    }
}

/// Summary without the figures of elastic energy, which would include free thermal expansion. If a
/// material softens, the least share of the stiffness is added, and the power of plastic flow is
/// removed, since it would depend on the temperature at which the material flowed.
fn warm_summary(
    scene: &Scene,
    rolling: &Rolling,
    means: &Means,
    least_share: Option<f64>,
) -> Value {
    let mut summary = outcome::summary(scene, rolling, means);
    if let Some(figures) = summary["contact"].as_object_mut() {
        figures.retain(|name, _| name != "elastic_energy_j" && name != "hourglass_energy_ratio");
        if let Some(share) = least_share {
            figures.remove("plastic_power_w");
            figures.insert(LEAST_SHARE.to_owned(), share.into());
        }
    }
    summary
}

/// Applies temperature-dependent stiffness and thermal expansion to the first layers of elements.
/// Returns the smallest share of the stiffness if a material softens.
///
/// # Errors
/// A temperature beyond the softening table.
fn warm(
    rolling: &mut Rolling,
    Fields { scene, terms }: &Fields,
    integrals: &[Surface<'_>; 2],
) -> Result<Option<f64>, StepError> {
    let mut least = None;
    if terms.softens() {
        let mut smallest = 1.0_f64;
        rolling.soften(|body, x, y, depth| {
            let Some(softening) = &terms.softening[body] else { return Ok([1.0; 2]) };
            let shares = softening.at(integrals[body].at(x, y) / depth).map_err(|temperature| {
                StepError::NoSolution(format!(
                    "elements of `{}` reach {temperature:.1} K, beyond their softening_table; extend it, or write \
                     effects.{}.beyond = \"hold\"",
                    scene.names.0[body],
                    terms.effect_of(Kind::Softening).unwrap_or_default(),
                ))
            })?;
            smallest = smallest.min(shares[0]);
            Ok(shares)
        })?;
        least = Some(smallest);
    }
    if let Some(coefficients) = terms.expansion {
        rolling.expand(|body, x, y| coefficients[body] * integrals[body].at(x, y));
    }
    Ok(least)
}

impl Contact for Heated {
    type Window = Window;

    fn solve(
        &mut self,
        _step: &Step,
        inputs: &dyn Inputs,
        _accepted: Option<&Window>,
        _spent: Option<Window>,
    ) -> Result<Window, StepError> {
        let integrals = [
            Surface::of(inputs, &field::UPPER_RISE_INTEGRAL)?,
            Surface::of(inputs, &field::LOWER_RISE_INTEGRAL)?,
        ];
        let Self { rolling, curve, fields, report, cold, .. } = self;
        rolling.restore(cold);
        let before = rolling.steps();
        let least_share = warm(rolling, fields, &integrals)?;
        let settled = settle_again(rolling, |ratio| curve.creepage(ratio), &mut **report);
        let (means, met) = settled.map_err(no_answer)?;
        outcome::check(rolling, &means).map_err(no_answer)?;
        met_force(&means, met).map_err(no_answer)?;
        let summary = warm_summary(&fields.scene, rolling, &means, least_share);
        let report = outcome::report(rolling, rolling.steps() - before);
        Ok(Window { summary, report })
    }

    fn first(&mut self) -> Option<Window> {
        let summary = self.cold_summary.clone();
        Some(Window { summary, report: StepReport::default() })
    }

    fn report(&self, window: &Window) -> StepReport {
        window.report
    }

    fn write(&self, _: &Window, spec: &FieldSpec, values: &mut [f64]) {
        self.fields.write(spec, &self.rolling, values);
    }

    fn summary(&self, window: &Window) -> Value {
        window.summary.clone()
    }

    fn terms(&self) -> &Terms {
        &self.fields.terms
    }

    fn terms_mut(&mut self) -> &mut Terms {
        &mut self.fields.terms
    }
}
