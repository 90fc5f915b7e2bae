//! Models without memory: their fields are computed once, when the model is built, and a solve
//! copies them to the outputs that are asked for.

use super::grids::{CONTACT_GRID, RIGID_GRID, is_rigid};
use proto::configuration::{Configuration, FieldOnGrid, Layout};
use proto::field::{self, FieldSpec};
use proto::grid::{Grid, Structured};
use proto::model::{Inputs, Model, Outputs, StateError, Step, StepError, StepReport};
use std::io::{self, Read, Write};

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

/// The fields that this run asks for, in the order of the table of fields.
pub(super) fn wanted_fields(configuration: &Configuration) -> Vec<&'static FieldSpec> {
    let named = |name: &str| {
        configuration.outputs.iter().chain(&configuration.observed).any(|wanted| wanted == name)
    };
    field::TABLE.iter().filter(|spec| named(spec.name)).collect()
}

/// Grids and cost of the wanted fields, which take `build_seconds` to compute.
pub(super) fn layout(
    wanted: &[&'static FieldSpec],
    grid: Structured,
    build_seconds: f64,
) -> Layout {
    let mut grids = vec![Grid::structured(CONTACT_GRID, grid)];
    if wanted.iter().any(|spec| is_rigid(spec)) {
        let (length, width) = (grid.dx() * grid.ni as f64, grid.dy() * grid.nj as f64);
        let whole = Structured::contact_plane(0.0, 0.0, length, width, 1, 1);
        grids.push(Grid::structured(RIGID_GRID, whole));
    }
    let values: usize = wanted.iter().map(|spec| count(spec, &grid)).sum();
    Layout {
        grids,
        fields: wanted.iter().map(|spec| on_grid(spec)).collect(),
        solve_seconds: SECONDS_PER_COPY * values as f64,
        build_seconds,
        memory_bytes: (values * size_of::<f64>()) as u64,
        remarks: vec!["the fields are computed once; a solve copies them".to_owned()],
        ..Layout::default()
    }
}

fn on_grid(spec: &FieldSpec) -> FieldOnGrid {
    let grid = if is_rigid(spec) { RIGID_GRID } else { CONTACT_GRID };
    FieldOnGrid { field: spec.name.to_owned(), grid: grid.to_owned() }
}

/// The model that runs: the fields, computed once.
pub(super) struct Precomputed {
    /// Its part of `summary.json`.
    pub(super) summary: serde_json::Value,
    /// Its measure of work.
    pub(super) work: u64,
    /// Its fields.
    pub(super) fields: Vec<(&'static FieldSpec, Vec<f64>)>,
}

impl Precomputed {
    /// Copies the fields that are asked for.
    pub(super) fn write(&self, outputs: &mut dyn Outputs) {
        for (spec, values) in &self.fields {
            if let Some(place) = outputs.get(spec) {
                place.copy_from_slice(values);
            }
        }
    }
}

impl Model for Precomputed {
    fn solve(
        &mut self,
        _step: &Step,
        _inputs: &dyn Inputs,
        outputs: &mut dyn Outputs,
    ) -> Result<StepReport, StepError> {
        self.write(outputs);
        Ok(StepReport { substeps: 1, work: self.work, ..StepReport::default() })
    }

    fn first_outputs(&mut self, outputs: &mut dyn Outputs) {
        self.write(outputs);
    }

    fn accept(&mut self) {}

    fn observe(&mut self, outputs: &mut dyn Outputs) {
        self.write(outputs);
    }

    fn summary(&self) -> serde_json::Value {
        self.summary.clone()
    }

    fn save(&self, _into: &mut dyn Write) -> io::Result<()> {
        Ok(())
    }

    fn restore(&mut self, _from: &mut dyn Read) -> Result<(), StateError> {
        Ok(())
    }
}
