//! Steady rolling that heat changes: from steady rolling without heat on, anew for what comes in.
//!
//! A solve begins where the bodies rolled steadily and cold, so that it depends on what comes in and on nothing else.

use super::creep_curve::CreepCurve;
use super::outcome::{self, Fields, met_force};
use super::passage::Report;
use crate::explicit::rolling::{Means, Rolling};
use crate::explicit::settle::settle_again;
use crate::models::varying::no_answer;
use crate::surface::Surface;
use proto::field::{self, FieldSpec};
use proto::model::{Inputs, Model, Outputs, StateError, Step, StepError, StepReport};
use serde_json::Value;
use std::io::{self, Read, Write};

/// The model that runs.
pub(super) struct Heated {
    rolling: Rolling,
    curve: CreepCurve,
    /// Coefficients of thermal expansion of the upper and the lower body [1/K].
    coefficients: [f64; 2],
    fields: Fields,
    wanted: Vec<&'static FieldSpec>,
    report: Report,
    /// The state of steady rolling without heat.
    cold: Vec<f64>,
    summary: Value,
}

impl Heated {
    /// Goes on from steady rolling without heat, of which these are means.
    pub(super) fn new(
        mut rolling: Rolling,
        means: &Means,
        curve: CreepCurve,
        coefficients: [f64; 2],
        fields: Fields,
        wanted: Vec<&'static FieldSpec>,
        report: Report,
    ) -> Self {
        let mut cold = Vec::new();
        rolling.keep(&mut cold);
        let summary = warm_summary(&rolling, means);
        Self { rolling, curve, coefficients, fields, wanted, report, cold, summary }
    }

    fn write(&self, outputs: &mut dyn Outputs) {
        self.fields.write(&self.wanted, &self.rolling, outputs);
    }
}

/// The figures but for those of the elastic energy, which would count what expands freely.
fn warm_summary(rolling: &Rolling, means: &Means) -> Value {
    let mut summary = outcome::summary(rolling, means);
    if let Some(figures) = summary["contact"].as_object_mut() {
        figures.retain(|name, _| name != "elastic_energy_j" && name != "hourglass_energy_ratio");
    }
    summary
}

impl Model for Heated {
    fn solve(
        &mut self,
        _step: &Step,
        inputs: &dyn Inputs,
        outputs: &mut dyn Outputs,
    ) -> Result<StepReport, StepError> {
        let integrals = [
            Surface::of(inputs, &field::UPPER_RISE_INTEGRAL)?,
            Surface::of(inputs, &field::LOWER_RISE_INTEGRAL)?,
        ];
        let Self { rolling, curve, coefficients, report, cold, .. } = self;
        rolling.restore(cold);
        let before = rolling.steps();
        rolling.expand(|body, x, y| coefficients[body] * integrals[body].at(x, y));
        let settled = settle_again(rolling, |ratio| curve.creepage(ratio), &mut **report);
        let (means, met) = settled.map_err(no_answer)?;
        outcome::check(&self.rolling, &means).map_err(no_answer)?;
        met_force(&means, met).map_err(no_answer)?;
        self.summary = warm_summary(&self.rolling, &means);
        self.write(outputs);
        let elements: u64 = self.rolling.bodies.iter().map(|body| body.elements() as u64).sum();
        let steps = self.rolling.steps() - before;
        let substeps = u32::try_from(steps).unwrap_or(u32::MAX);
        Ok(StepReport { substeps, work: steps * elements, ..StepReport::default() })
    }

    fn first_outputs(&mut self, outputs: &mut dyn Outputs) {
        self.write(outputs);
    }

    fn accept(&mut self) {}

    fn observe(&mut self, outputs: &mut dyn Outputs) {
        self.write(outputs);
    }

    fn summary(&self) -> Value {
        self.summary.clone()
    }

    fn save(&self, _into: &mut dyn Write) -> io::Result<()> {
        Ok(())
    }

    fn restore(&mut self, _from: &mut dyn Read) -> Result<(), StateError> {
        Ok(())
    }
}
