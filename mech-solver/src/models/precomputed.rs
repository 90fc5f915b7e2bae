//! Models without history: their fields are computed once, when the model is built, and a solve
//! copies them to the requested outputs.

use super::contact_model::{Contact, ContactModel};
use super::grids::{CONTACT_GRID, RIGID_GRID, is_rigid, laid_out, whole};
use crate::terms::Terms;
use proto::configuration::{Configuration, Layout};
use proto::field::{self, FieldSpec};
use proto::grid::Structured;
use proto::model::{Inputs, Model, Step, StepError, StepReport};
use serde_json::Value;

/// Time to copy one value to an output, measured [s].
const SECONDS_PER_COPY: f64 = 2e-9;

/// Number of points of a field.
pub(super) fn points(spec: &FieldSpec, grid: &Structured) -> usize {
    if is_rigid(spec) { 1 } else { grid.points() }
}

/// Number of values of a field.
pub(super) fn count(spec: &FieldSpec, grid: &Structured) -> usize {
    points(spec, grid) * spec.components as usize
}

/// Fields requested by this run, in the order of the table of fields.
pub(super) fn wanted_fields(configuration: &Configuration) -> Vec<&'static FieldSpec> {
    let named = |name: &str| {
        configuration.outputs.iter().chain(&configuration.observed).any(|wanted| wanted == name)
    };
    field::TABLE.iter().filter(|spec| named(spec.name)).collect()
}

/// Layout and cost of the wanted fields, which take `build_seconds` to compute.
pub(super) fn layout(
    configuration: &Configuration,
    grid: Structured,
    build_seconds: f64,
) -> Layout {
    let values: usize = wanted_fields(configuration).iter().map(|spec| count(spec, &grid)).sum();
    let on = |spec: &FieldSpec| if is_rigid(spec) { RIGID_GRID } else { CONTACT_GRID };
    let grids = vec![(CONTACT_GRID, grid), (RIGID_GRID, whole(&grid))];
    Layout {
        solve_seconds: SECONDS_PER_COPY * values as f64,
        build_seconds,
        memory_bytes: (values * size_of::<f64>()) as u64,
        remarks: vec!["the fields are computed once; a solve copies them".to_owned()],
        ..laid_out(configuration, on, grids)
    }
}

/// A contact that is the same in every window, with its precomputed fields.
pub(super) struct Precomputed {
    /// Sections of `summary.json`.
    pub(super) summary: Value,
    /// Work counter of a solve.
    pub(super) work: u64,
    /// Precomputed fields.
    pub(super) fields: Vec<(&'static FieldSpec, Vec<f64>)>,
    /// Terms of the active effects.
    pub(super) terms: Terms,
}

/// Values of the wanted fields, computed by `write`.
pub(super) fn fields(
    wanted: &[&'static FieldSpec],
    grid: &Structured,
    write: impl Fn(&FieldSpec, &mut [f64]),
) -> Vec<(&'static FieldSpec, Vec<f64>)> {
    let values = |spec: &&'static FieldSpec| {
        let mut values = vec![0.0; count(spec, grid)];
        write(spec, &mut values);
        (*spec, values)
    };
    wanted.iter().map(values).collect()
}

impl Precomputed {
    /// Returns the model that runs this contact.
    pub(super) fn model(self) -> Box<dyn Model> {
        Box::new(ContactModel::new(self))
    }
}

impl Contact for Precomputed {
    type Window = ();

    fn solve(
        &mut self,
        _step: &Step,
        _inputs: &dyn Inputs,
        _accepted: Option<&()>,
        _spent: Option<()>,
    ) -> Result<(), StepError> {
        Ok(())
    }

    fn first(&mut self) -> Option<()> {
        Some(())
    }

    fn report(&self, (): &()) -> StepReport {
        StepReport { substeps: 1, work: self.work, ..StepReport::default() }
    }

    fn write(&self, (): &(), spec: &FieldSpec, values: &mut [f64]) {
        if let Some((_, own)) = self.fields.iter().find(|(own, _)| *own == spec) {
            values.copy_from_slice(own);
        }
    }

    fn summary(&self, (): &()) -> Value {
        self.summary.clone()
    }

    fn terms(&self) -> &Terms {
        &self.terms
    }

    fn terms_mut(&mut self) -> &mut Terms {
        &mut self.terms
    }
}
