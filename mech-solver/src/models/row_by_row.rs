//! Models without memory whose case varies: every window is computed from its values, and its fields are
//! written where they are asked for.

use super::varying::{Varying, no_answer};
use crate::case::scene::Scene;
use proto::configuration::Refusal;
use proto::field::FieldSpec;
use proto::model::{Inputs, Model, Outputs, StateError, Step, StepError, StepReport};
use serde_json::{Value, json};
use std::io::{self, Read, Write};

/// What a model without memory makes of a scene.
pub(super) trait Rows {
    /// The contact of a row, of which everything that is asked for follows.
    type Contact;

    /// Computes a row, if it likes in the memory of one that is no longer needed.
    ///
    /// # Errors
    /// The scene has no answer.
    fn compute(
        &self,
        scene: &Scene,
        spent: Option<Self::Contact>,
    ) -> Result<Self::Contact, Refusal>;

    /// Its measure of work.
    fn work(&self, contact: &Self::Contact) -> u64;

    /// Its part of `summary.json`.
    fn summary(&self, contact: &Self::Contact) -> Value;

    /// Writes all values of a field.
    fn write(&self, contact: &Self::Contact, spec: &FieldSpec, values: &mut [f64]);
}

/// The model that runs.
pub(super) struct RowByRow<R: Rows> {
    rows: R,
    varying: Varying,
    wanted: Vec<&'static FieldSpec>,
    trial: Option<(R::Contact, Step)>,
    accepted: Option<(R::Contact, Step)>,
    /// The contact of an earlier row.
    spent: Option<R::Contact>,
}

impl<R: Rows> RowByRow<R> {
    /// Of rows of which these fields are asked for.
    pub(super) fn new(rows: R, varying: Varying, wanted: Vec<&'static FieldSpec>) -> Self {
        Self { rows, varying, wanted, trial: None, accepted: None, spent: None }
    }

    fn write(&self, contact: &R::Contact, outputs: &mut dyn Outputs) {
        for spec in &self.wanted {
            if let Some(values) = outputs.get(spec) {
                self.rows.write(contact, spec, values);
            }
        }
    }
}

impl<R: Rows> Model for RowByRow<R> {
    fn solve(
        &mut self,
        step: &Step,
        _inputs: &dyn Inputs,
        outputs: &mut dyn Outputs,
    ) -> Result<StepReport, StepError> {
        let scene = self.varying.scene(step)?;
        let contact = self.rows.compute(&scene, self.spent.take()).map_err(no_answer)?;
        self.write(&contact, outputs);
        let work = self.rows.work(&contact);
        self.trial = Some((contact, *step));
        Ok(StepReport { substeps: 1, work, ..StepReport::default() })
    }

    /// The fields of the first row, if it has an answer; zero if not.
    fn first_outputs(&mut self, outputs: &mut dyn Outputs) {
        for spec in proto::field::TABLE {
            if let Some(place) = outputs.get(spec) {
                place.fill(0.0);
            }
        }
        let first = self.varying.scene(&Step::STEADY).ok();
        if let Some(contact) = first.and_then(|scene| self.rows.compute(&scene, None).ok()) {
            self.write(&contact, outputs);
        }
    }

    fn accept(&mut self) {
        if let Some(solved) = self.trial.take() {
            self.spent = self.accepted.replace(solved).map(|(contact, _)| contact);
        }
    }

    fn observe(&mut self, outputs: &mut dyn Outputs) {
        if let Some((contact, _)) = &self.accepted {
            self.write(contact, outputs);
        }
    }

    fn summary(&self) -> Value {
        let Some((contact, step)) = &self.accepted else { return json!({}) };
        let mut summary = self.rows.summary(contact);
        self.varying.add_to(&mut summary["contact"], step);
        summary
    }

    fn save(&self, _into: &mut dyn Write) -> io::Result<()> {
        Ok(())
    }

    fn restore(&mut self, _from: &mut dyn Read) -> Result<(), StateError> {
        Ok(())
    }
}
