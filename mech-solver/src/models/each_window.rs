//! Models of which every window depends on its own values and what comes in alone: nothing is carried from one to the next.

use super::half_space::PASSAGE_GRID;
use crate::models::grids::{CONTACT_GRID, RIGID_GRID, is_rigid, laid_out};
use crate::terms::Observation;
use half_space::difference::Difference;
use proto::configuration::{Configuration, FieldOnGrid};
use proto::field::{self, FieldSpec};
use proto::grid::{Grid, Structured};
use proto::model::{InputField, Inputs, Model, Outputs, StateError, Step, StepError, StepReport};
use serde_json::{Value, json};
use std::io::{self, Read, Write};
use std::iter;

/// What solves windows.
pub(super) trait Windows {
    /// What a window prescribes.
    type Row: PartialEq;
    /// A window that is solved.
    type Window;

    /// What a window prescribes.
    ///
    /// # Errors
    /// A value is missing or out of range.
    fn row(&self, step: &Step) -> Result<Self::Row, StepError>;

    /// Solves from nothing but what comes in.
    ///
    /// # Errors
    /// There is no solution.
    fn solve(&mut self, row: &Self::Row, inputs: &dyn Inputs) -> Result<Self::Window, StepError>;

    /// Solves windows into which nothing comes, at the same time if it can.
    fn solve_all(&mut self, rows: &[Self::Row]) -> Vec<Result<Self::Window, StepError>> {
        rows.iter().map(|row| self.solve(row, &Nothing)).collect()
    }

    /// Number of windows that [`Windows::solve_all`] takes at once, for rows of a history.
    fn at_once(&self) -> usize {
        1
    }

    /// Speed of rolling [m/s].
    fn speed(&self, row: &Self::Row) -> f64;

    /// A window depends on what comes in.
    fn follows_inputs(&self) -> bool {
        false
    }

    /// Writes a field, if it is one of the model's.
    fn write(&self, window: &Self::Window, spec: &FieldSpec, values: &mut [f64]);

    /// Computes what is observed of an accepted window, and writes it; nothing, unless a model has more than its fields.
    fn observe(&mut self, _window: &Self::Window, _outputs: &mut dyn Outputs) {}

    /// Its part of `summary.json`.
    fn summary(&self, window: &Self::Window) -> Value;

    /// Iterations of the normal contact, and Newton steps.
    fn effort(&self, window: &Self::Window) -> [usize; 2];
}

/// Inputs of a window into which nothing comes.
pub(super) struct Nothing;

impl Inputs for Nothing {
    fn get(&self, _: &FieldSpec) -> Option<InputField<'_>> {
        None
    }
}

/// The model that runs.
pub(super) struct EachWindow<W: Windows> {
    windows: W,
    trial: Option<(W::Row, W::Window)>,
    accepted: Option<W::Window>,
    /// Rows of a history; 0 if there is none.
    rows: u64,
    /// Windows to come, the next one last, that were solved with one before.
    ahead: Vec<(W::Row, Answer<W>)>,
}

/// Answer to a row.
type Answer<W> = Result<<W as Windows>::Window, StepError>;

impl<W: Windows> EachWindow<W> {
    pub(super) fn new(windows: W, configuration: &Configuration) -> Self {
        let history = configuration.histories.as_ref();
        let rows = history.filter(|of| of.rows && of.live.is_none()).map_or(0, |of| of.times.len());
        Self { windows, trial: None, accepted: None, rows: rows as u64, ahead: Vec::new() }
    }

    /// A window; the last one of the same values is it, unless it depends on what comes in.
    fn window(
        &mut self,
        step: &Step,
        inputs: &dyn Inputs,
    ) -> Result<(W::Row, W::Window), StepError> {
        let row = self.windows.row(step)?;
        if self.windows.follows_inputs() {
            let window = self.windows.solve(&row, inputs)?;
            return Ok((row, window));
        }
        if let Some(same) = self.trial.take().filter(|(last, _)| *last == row) {
            return Ok(same);
        }
        if self.ahead.last().is_none_or(|(next, _)| *next != row) {
            self.solve_from(row, step);
        }
        let (row, window) = self.ahead.pop().expect("at least the window asked for");
        Ok((row, window?))
    }

    /// Solves a window and those behind it.
    fn solve_from(&mut self, row: W::Row, step: &Step) {
        let last = self.rows.min(step.window + self.windows.at_once() as u64);
        let behind = (step.window + 1..last)
            .map_while(|window| self.windows.row(&Step { window, ..*step }).ok());
        let rows: Vec<W::Row> = iter::once(row).chain(behind).collect();
        let solved = self.windows.solve_all(&rows);
        self.ahead = rows.into_iter().zip(solved).rev().collect();
    }

    fn write(&self, window: &W::Window, outputs: &mut dyn Outputs) {
        for spec in field::TABLE {
            if let Some(values) = outputs.get(spec) {
                self.windows.write(window, spec, values);
            }
        }
    }
}

impl<W: Windows> Model for EachWindow<W> {
    fn solve(
        &mut self,
        step: &Step,
        inputs: &dyn Inputs,
        outputs: &mut dyn Outputs,
    ) -> Result<StepReport, StepError> {
        let (row, window) = self.window(step, inputs)?;
        self.write(&window, outputs);
        let [iterations, steps] = self.windows.effort(&window);
        self.trial = Some((row, window));
        Ok(StepReport {
            substeps: 1,
            inner_iterations: iterations as u32,
            work: steps as u64,
            ..StepReport::default()
        })
    }

    /// The fields of the first window, if it depends on its own values alone and has an answer; if not there is nothing but its speed.
    fn first_outputs(&mut self, outputs: &mut dyn Outputs) {
        if !self.windows.follows_inputs()
            && let Ok((row, window)) = self.window(&Step::STEADY, &Nothing)
        {
            self.write(&window, outputs);
            self.trial = Some((row, window));
            return;
        }
        let speed = self.windows.row(&Step::STEADY).map_or(0.0, |row| self.windows.speed(&row));
        for spec in field::TABLE {
            if let Some(values) = outputs.get(spec) {
                values.fill(if *spec == field::SURFACE_SPEED { speed } else { 0.0 });
            }
        }
    }

    fn accept(&mut self) {
        if let Some((_, window)) = self.trial.take() {
            self.accepted = Some(window);
        }
    }

    fn observe(&mut self, outputs: &mut dyn Outputs) {
        if let Some(window) = &self.accepted {
            self.write(window, outputs);
            self.windows.observe(window, outputs);
        }
    }

    fn summary(&self) -> Value {
        let summary = |window| self.windows.summary(window);
        self.accepted.as_ref().map_or_else(|| json!({}), summary)
    }

    fn save(&self, _into: &mut dyn Write) -> io::Result<()> {
        Ok(())
    }

    fn restore(&mut self, _from: &mut dyn Read) -> Result<(), StateError> {
        Ok(())
    }
}

/// The components of a vector, one after the other.
pub(super) fn write_pair(values: &mut [f64], [x, y]: &[Vec<f64>; 2]) {
    let (first, second) = values.split_at_mut(x.len());
    first.copy_from_slice(x);
    second.copy_from_slice(y);
}

/// The fields of a contact on this grid: slip and friction power at the place of the difference, speeds for all of it; those of
/// observations where they say.
pub(super) fn fields_over(
    configuration: &Configuration,
    grid: Structured,
    difference: Difference,
    observations: &[Box<dyn Observation>],
) -> (Vec<Grid>, Vec<FieldOnGrid>) {
    let on = |spec: &FieldSpec| match *spec {
        _ if let Some(grid) = observations.iter().find_map(|term| term.grid_of(spec)) => grid,
        _ if is_rigid(spec) => RIGID_GRID,
        field::SLIP_VELOCITY | field::FRICTION_POWER => PASSAGE_GRID,
        _ => CONTACT_GRID,
    };
    let (length, width) = (grid.dx() * grid.ni as f64, grid.dy() * grid.nj as f64);
    let mut passage = grid;
    passage.origin[0] += difference.middle() * grid.dx();
    let whole = Structured::contact_plane(0.0, 0.0, length, width, 1, 1);
    let mut grids = vec![
        (CONTACT_GRID, grid.into()),
        (PASSAGE_GRID, passage.into()),
        (RIGID_GRID, whole.into()),
    ];
    grids.extend(observations.iter().flat_map(|term| term.grids()));
    laid_out(configuration, on, grids)
}
