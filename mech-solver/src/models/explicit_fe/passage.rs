//! Rolling on in time, on an axle that may move.
//!
//! Fields of a window are its means. A window takes the fewest equal steps that are not longer than those of steady
//! rolling, so windows of whole passages of an element take exactly those.

use super::outcome::{self, Fields};
use crate::models::varying::no_answer;
use elastic::axle::Axle;
use explicit_fe::rolling::{Means, Rolling};
use proto::field::FieldSpec;
use proto::model::{Inputs, Model, Outputs, StateError, Step, StepError, StepReport};
use proto::state::{read_numbers, write_numbers};
use serde_json::Value;
use std::io::{self, Read, Write};

/// Hears how many steps of how many are taken.
pub(super) type Report = Box<dyn FnMut(u64, u64)>;

/// The model that runs.
pub(super) struct Passage {
    rolling: Rolling,
    axle: Axle,
    fields: Fields,
    wanted: Vec<&'static FieldSpec>,
    report: Report,
    /// The accepted state; that of the bodies may be a trial beyond it.
    kept: Vec<f64>,
    totals: Totals,
    trial: Option<(Means, f64)>,
    accepted: Value,
}

/// What the accepted windows come to.
#[derive(Clone, Copy, Debug, Default)]
struct Totals {
    /// Work of friction [J].
    friction: f64,
    /// Time without contact [s].
    apart: f64,
    /// Largest mean normal force of a window [N].
    largest: f64,
}

impl Totals {
    fn add(&mut self, means: &Means, duration: f64) {
        self.friction += duration * means.friction;
        self.apart += duration * means.apart;
        self.largest = self.largest.max(means.force[2]);
    }

    fn numbers(&mut self) -> [&mut f64; 3] {
        [&mut self.friction, &mut self.apart, &mut self.largest]
    }
}

impl Passage {
    /// Goes on from steady rolling, of which these are means.
    pub(super) fn new(
        mut rolling: Rolling,
        means: &Means,
        axle: Axle,
        fields: Fields,
        wanted: Vec<&'static FieldSpec>,
        report: Report,
    ) -> Self {
        let mut kept = Vec::new();
        rolling.keep(&mut kept);
        let accepted = outcome::summary(&fields.scene, &rolling, means);
        let totals = Totals::default();
        Self { rolling, axle, fields, wanted, report, kept, totals, trial: None, accepted }
    }

    fn write(&self, outputs: &mut dyn Outputs) {
        self.fields.write(&self.wanted, &self.rolling, outputs);
    }
}

impl Model for Passage {
    fn solve(
        &mut self,
        step: &Step,
        _inputs: &dyn Inputs,
        outputs: &mut dyn Outputs,
    ) -> Result<StepReport, StepError> {
        if self.trial.take().is_some() {
            self.rolling.restore(&self.kept);
        }
        let (before, report) = (self.rolling.steps(), &mut self.report);
        let count = self.rolling.steps_in(step.duration());
        let mut told = |steps: u64| report(steps - before, count);
        let means = self.rolling.pass(step.duration(), &self.axle, &mut told);
        self.trial = Some((means, step.duration()));
        outcome::check(&self.rolling, &means).map_err(no_answer)?;
        self.write(outputs);
        let elements: u64 = self.rolling.bodies.iter().map(|body| body.elements() as u64).sum();
        let substeps = u32::try_from(count).unwrap_or(u32::MAX);
        Ok(StepReport { substeps, work: count * elements, ..StepReport::default() })
    }

    fn first_outputs(&mut self, outputs: &mut dyn Outputs) {
        self.write(outputs);
    }

    fn accept(&mut self) {
        if let Some((means, duration)) = self.trial.take() {
            self.rolling.keep(&mut self.kept);
            self.totals.add(&means, duration);
            let mut summary = outcome::summary(&self.fields.scene, &self.rolling, &means);
            summary["contact"]["friction_work_j"] = self.totals.friction.into();
            summary["contact"]["apart_s"] = self.totals.apart.into();
            summary["contact"]["largest_normal_force_n"] = self.totals.largest.into();
            self.accepted = summary;
        }
    }

    fn observe(&mut self, outputs: &mut dyn Outputs) {
        self.write(outputs);
    }

    fn summary(&self) -> Value {
        self.accepted.clone()
    }

    fn save(&self, into: &mut dyn Write) -> io::Result<()> {
        write_numbers(into, &self.kept)?;
        let mut totals = self.totals;
        write_numbers(into, totals.numbers().map(|number| &*number))
    }

    fn restore(&mut self, from: &mut dyn Read) -> Result<(), StateError> {
        read_numbers(from, &mut self.kept)?;
        read_numbers(from, self.totals.numbers())?;
        self.rolling.restore(&self.kept);
        self.trial = None;
        Ok(())
    }
}
