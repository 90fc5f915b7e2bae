//! Models without memory whose case varies: their fields are computed in every window.

use super::precomputed::Precomputed;
use super::varying::{Varying, no_answer};
use crate::scene::Scene;
use proto::configuration::Refusal;
use proto::model::{Inputs, Model, Outputs, StateError, Step, StepError, StepReport};
use serde_json::{Value, json};
use std::io::{self, Read, Write};

/// How a model computes a scene.
pub(super) type Compute = Box<dyn Fn(&Scene) -> Result<Precomputed, Refusal>>;

/// The model that runs.
pub(super) struct RowByRow {
    varying: Varying,
    compute: Compute,
    trial: Option<Precomputed>,
    accepted: Value,
}

impl RowByRow {
    pub(super) fn new(varying: Varying, compute: Compute) -> Self {
        Self { varying, compute, trial: None, accepted: json!({}) }
    }

    fn write(&self, outputs: &mut dyn Outputs) {
        if let Some(computed) = &self.trial {
            computed.write(outputs);
        }
    }
}

impl Model for RowByRow {
    fn solve(
        &mut self,
        step: &Step,
        _inputs: &dyn Inputs,
        outputs: &mut dyn Outputs,
    ) -> Result<StepReport, StepError> {
        let scene = self.varying.scene(step)?;
        let mut computed = (self.compute)(&scene).map_err(no_answer)?;
        self.varying.add_to(&mut computed.summary["contact"], step);
        let work = computed.work;
        self.trial = Some(computed);
        self.write(outputs);
        Ok(StepReport { substeps: 1, work, ..StepReport::default() })
    }

    /// The fields of the first row that has an answer; zero if none has.
    fn first_outputs(&mut self, outputs: &mut dyn Outputs) {
        for spec in proto::field::TABLE {
            if let Some(place) = outputs.get(spec) {
                place.fill(0.0);
            }
        }
        let first = self.varying.scene(&Step::STEADY).ok();
        self.trial = first.and_then(|scene| (self.compute)(&scene).ok());
        self.write(outputs);
    }

    fn accept(&mut self) {
        if let Some(computed) = &self.trial {
            self.accepted.clone_from(&computed.summary);
        }
    }

    fn observe(&mut self, outputs: &mut dyn Outputs) {
        self.write(outputs);
    }

    fn summary(&self) -> Value {
        self.accepted.clone()
    }

    fn save(&self, _into: &mut dyn Write) -> io::Result<()> {
        Ok(())
    }

    fn restore(&mut self, _from: &mut dyn Read) -> Result<(), StateError> {
        Ok(())
    }
}
