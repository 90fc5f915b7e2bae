//! Rolling in time, on an axle that may move.
//!
//! Fields of a window are means over it. A window takes the smallest number of equal steps not
//! longer than those of steady rolling. Windows that span whole passages of an element therefore
//! keep the steps of steady rolling.

use super::outcome::{self, Fields};
use crate::models::contact_model::Contact;
use crate::models::varying::no_answer;
use crate::terms::Terms;
use elastic::axle::Axle;
use explicit_fe::rolling::{Means, Rolling};
use proto::field::FieldSpec;
use proto::model::{Inputs, StateError, Step, StepError, StepReport};
use proto::state::{read_numbers, write_numbers};
use serde_json::Value;
use std::io::{self, Read, Write};

/// Progress callback, called with the steps taken and the total number of steps.
pub(super) type Report = Box<dyn FnMut(u64, u64)>;

/// Bodies rolling in time.
pub(super) struct Passage {
    rolling: Rolling,
    axle: Axle,
    fields: Fields,
    report: Report,
    /// Accepted state.
    kept: Vec<f64>,
    /// True if the bodies have advanced beyond the accepted state in a trial.
    beyond: bool,
    totals: Totals,
    /// Means of steady rolling.
    first: Means,
    /// Summary of the accepted state.
    accepted: Value,
}

/// A solved time window; its fields are those of the rolling bodies.
pub(super) struct Window {
    means: Means,
    duration: f64,
    report: StepReport,
}

/// Totals over the accepted windows.
#[derive(Clone, Copy, Debug, Default)]
struct Totals {
    /// Friction work [J].
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
    /// Continues from steady rolling, with its means.
    pub(super) fn new(
        mut rolling: Rolling,
        means: &Means,
        axle: Axle,
        fields: Fields,
        report: Report,
    ) -> Self {
        let mut kept = Vec::new();
        rolling.keep(&mut kept);
        let accepted = outcome::summary(&fields.scene, &rolling, means);
        let (totals, beyond) = (Totals::default(), false);
        Self { rolling, axle, fields, report, kept, beyond, totals, first: *means, accepted }
    }
}

impl Contact for Passage {
    type Window = Window;

    fn solve(
        &mut self,
        step: &Step,
        _inputs: &dyn Inputs,
        _accepted: Option<&Window>,
        _spent: Option<Window>,
    ) -> Result<Window, StepError> {
        if std::mem::replace(&mut self.beyond, true) {
            self.rolling.restore(&self.kept);
        }
        let (before, report) = (self.rolling.steps(), &mut self.report);
        let count = self.rolling.steps_in(step.duration());
        let mut told = |steps: u64| report(steps - before, count);
        let means = self.rolling.pass(step.duration(), &self.axle, &mut told);
        outcome::check(&self.rolling, &means).map_err(no_answer)?;
        let report = outcome::report(&self.rolling, count);
        Ok(Window { means, duration: step.duration(), report })
    }

    fn first(&mut self) -> Option<Window> {
        Some(Window { means: self.first, duration: 0.0, report: StepReport::default() })
    }

    fn report(&self, window: &Window) -> StepReport {
        window.report
    }

    fn write(&self, _: &Window, spec: &FieldSpec, values: &mut [f64]) {
        self.fields.write(spec, &self.rolling, values);
    }

    fn accept(&mut self, Window { means, duration, .. }: &Window) {
        self.beyond = false;
        self.rolling.keep(&mut self.kept);
        self.totals.add(means, *duration);
        let mut summary = outcome::summary(&self.fields.scene, &self.rolling, means);
        summary["contact"]["friction_work_j"] = self.totals.friction.into();
        summary["contact"]["apart_s"] = self.totals.apart.into();
        summary["contact"]["largest_normal_force_n"] = self.totals.largest.into();
        self.accepted = summary;
    }

    fn summary(&self, _: &Window) -> Value {
        self.accepted.clone()
    }

    fn terms(&self) -> &Terms {
        &self.fields.terms
    }

    fn terms_mut(&mut self) -> &mut Terms {
        &mut self.fields.terms
    }

    fn save(&self, _: Option<&Window>, into: &mut dyn Write) -> io::Result<()> {
        write_numbers(into, &self.kept)?;
        let mut totals = self.totals;
        write_numbers(into, totals.numbers().map(|number| &*number))
    }

    fn restore(&mut self, from: &mut dyn Read) -> Result<Option<Window>, StateError> {
        read_numbers(from, &mut self.kept)?;
        read_numbers(from, self.totals.numbers())?;
        self.rolling.restore(&self.kept);
        self.beyond = false;
        Ok(None)
    }
}
