//! The running program as a model: a solve is the program's way through one window.
//!
//! A program cannot save its state through preCICE's interface. A program that always computes the
//! same from the same values can be brought back to a state all the same: it is started anew and
//! computes the accepted windows again, with the values that it read in them. The saved state is
//! the history of these values: of the first iteration, in which the program writes its
//! checkpoint, and of the last.

use super::coupled::CoupledData;
use super::placement::Placement;
use super::program::{Program, ProgramError};
use super::starter::{SECOND_PARTICIPANT, Started, Starter, check, sizes};
use crate::protocol::{Answer, Request, Window};
use proto::binary;
use proto::field::{FieldSpec, Mapping};
use proto::grid::Grid;
use proto::model::{
    Inputs, Model, Outputs, StateError, Step, StepError, StepReport, first_non_finite,
};
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::io::{self, Read, Write};

/// Reason why a run with a program has no checkpoints.
const NO_STATE: &str = "a program cannot save its state through preCICE's interface; give \
    precice-participant the option --resume-by-repeating if the program computes the same from \
    the same values, or remove output.checkpoint_every";

/// Data of a program and the fields to which they are wired.
#[derive(Debug, Default)]
pub struct Exchange {
    /// Numbers of vertices of the meshes.
    pub sizes: Vec<usize>,
    /// Data that the program reads.
    pub read: Vec<(CoupledData, FieldSpec)>,
    /// Data that the program writes.
    pub written: Vec<(CoupledData, FieldSpec)>,
    /// Placement of meshes that move, and their grids at t = 0.
    pub moving: Option<(Placement, Vec<Grid>)>,
}

/// State of a program: its way from the start.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
struct History {
    /// First and last iteration of each accepted window, with the values that were read.
    iterations: Vec<Window>,
    /// Values written at the end of the last of them, as bits.
    written: Vec<Vec<u64>>,
    /// Start and end of the last of them [s].
    last: [f64; 2],
}

/// A program that waits for its next window.
#[derive(Debug)]
pub struct RunningProgram {
    starter: Starter,
    threads: usize,
    program: Program,
    exchange: Exchange,
    /// First and last iteration of the window that is not accepted.
    iterations: Vec<Window>,
    /// Values of the last solve, in the order of the written data.
    trial: Vec<Vec<f64>>,
    accepted: Vec<Vec<f64>>,
    /// Iterations of accepted windows, if the run is to be resumed by repeating them.
    history: Option<Vec<Window>>,
    /// Start and end of the last window [s].
    last: [f64; 2],
    /// Moving grids in the window to solve.
    grids: Vec<Grid>,
}

impl RunningProgram {
    /// Creates a model of a program that has started. With `repeats`, its accepted windows are
    /// kept to resume a run.
    pub(super) fn new(
        starter: Starter,
        threads: usize,
        (program, first): (Program, Vec<Vec<f64>>),
        exchange: Exchange,
        repeats: bool,
    ) -> Self {
        let grids = exchange.moving.iter().flat_map(|(_, grids)| grids.clone()).collect();
        Self {
            starter,
            threads,
            program,
            exchange,
            iterations: Vec::new(),
            trial: first.clone(),
            accepted: first,
            history: repeats.then(Vec::new),
            last: [0.0; 2],
            grids,
        }
    }

    /// Returns the window with the values that the program reads, and the power received through
    /// densities [W].
    fn window(&self, step: &Step, inputs: &dyn Inputs) -> Result<(Window, Option<f64>), StepError> {
        let (mut ends, mut starts, mut heat) = (Vec::new(), Vec::new(), None);
        for (data, spec) in &self.exchange.read {
            let name = || data.field.clone();
            let input =
                inputs.get(spec).ok_or_else(|| StepError::MissingInput { field: name() })?;
            if let Some(index) = first_non_finite(input.values) {
                let value = input.values[index];
                return Err(StepError::NonFiniteInput { field: name(), index, value });
            }
            let scaled = |values: &[f64]| {
                let mut values = values.to_vec();
                data.scale.apply(&mut values);
                values
            };
            if spec.mapping == Mapping::Conservative
                && spec.components == 1
                && input.grid.has_areas()
            {
                *heat.get_or_insert(0.0) += input.grid.integrate(input.values);
            }
            ends.push(scaled(input.values));
            starts.push(inputs.start(spec).map(scaled).unwrap_or_default());
        }
        let repeats = !self.iterations.is_empty();
        Ok((Window { length: step.duration(), repeats, ends, starts }, heat))
    }

    /// Lets the program compute a window; returns the number of its steps.
    fn compute(&mut self, window: Window) -> Result<u32, ProgramError> {
        let answer = Answer::Window(window);
        self.program.answer(&answer);
        if let Answer::Window(window) = answer {
            self.iterations.truncate(1);
            self.iterations.push(window);
        }
        let computed = self.computed();
        let (values, steps) = computed.inspect_err(|error| self.program.refuse(error))?;
        self.trial = values;
        Ok(steps)
    }

    /// Receives the values at the end of the window, and the number of the program's steps.
    fn computed(&mut self) -> Result<(Vec<Vec<f64>>, u32), ProgramError> {
        let wrong = match self.program.receive("in this window")? {
            Request::Advance { values, steps } => {
                check(&self.starter.coupled.written, &self.exchange.sizes, &values)?;
                return Ok((values, steps));
            }
            Request::Create { .. } => SECOND_PARTICIPANT,
            Request::Initialise { .. } => "calls initialize a second time",
            Request::Finalise | Request::Fail { .. } => "finalises before the simulation ends",
        };
        Err(ProgramError::Order(wrong))
    }

    fn write(&self, values: &[Vec<f64>], outputs: &mut dyn Outputs) {
        for ((data, spec), values) in self.exchange.written.iter().zip(values) {
            if let Some(room) = outputs.get(spec) {
                room.copy_from_slice(values);
                data.scale.apply(room);
            }
        }
    }

    /// Makes the last window the accepted one, and moves the grids to the end of the next, which
    /// is expected to be as long: values are those at the end of a window.
    fn advance(&mut self) {
        match &mut self.history {
            Some(history) => history.append(&mut self.iterations),
            None => self.iterations.clear(),
        }
        self.accepted.clone_from(&self.trial);
        self.place();
    }

    fn place(&mut self) {
        let [start, end] = self.last;
        if let Some((placement, grids)) = &self.exchange.moving {
            let next = |(at, grid): (usize, &Grid)| {
                placement.at(grid, 2.0 * end - start, self.grids[at].revision + 1)
            };
            self.grids = grids.iter().enumerate().map(next).collect();
        }
    }

    /// Starts the program anew and repeats its accepted windows.
    fn repeat(&mut self, history: History) -> Result<(), ProgramError> {
        let Started { program, meshes, first } = self.starter.start(self.threads)?;
        if sizes(&meshes) != self.exchange.sizes {
            return Err(ProgramError::Order("has another number of vertices than before"));
        }
        std::mem::replace(&mut self.program, program).kill();
        (self.trial, self.history) = (first, Some(Vec::new()));
        self.iterations.clear();
        for window in history.iterations {
            let fits = |(data, values): (&(CoupledData, FieldSpec), &Vec<f64>)| {
                values.len() == self.exchange.sizes[data.0.info.mesh] * data.0.info.components
            };
            if window.ends.len() != self.exchange.read.len()
                || !self.exchange.read.iter().zip(&window.ends).all(fits)
            {
                return Err(ProgramError::Order("reads other data than before"));
            }
            if !window.repeats && !self.iterations.is_empty() {
                self.advance();
            }
            self.compute(window)?;
        }
        self.advance();
        if bits(&self.trial) != history.written {
            return Err(ProgramError::Order(
                "computes other values from the same ones, so that it cannot be resumed",
            ));
        }
        self.last = history.last;
        self.place();
        Ok(())
    }
}

fn bits(values: &[Vec<f64>]) -> Vec<Vec<u64>> {
    values.iter().map(|values| values.iter().map(|value| value.to_bits()).collect()).collect()
}

impl Model for RunningProgram {
    fn solve(
        &mut self,
        step: &Step,
        inputs: &dyn Inputs,
        outputs: &mut dyn Outputs,
    ) -> Result<StepReport, StepError> {
        if step.duration().is_nan() || step.duration() <= 0.0 {
            return Err(StepError::NoSolution("the window has no duration".to_owned()));
        }
        let (window, received_power) = self.window(step, inputs)?;
        self.last = [step.start, step.end];
        let computed = self.compute(window);
        let substeps = computed.map_err(|error| StepError::NoSolution(error.to_string()))?;
        self.write(&self.trial, outputs);
        Ok(StepReport { substeps, work: 1, received_power, ..StepReport::default() })
    }

    fn first_outputs(&mut self, outputs: &mut dyn Outputs) {
        self.write(&self.accepted, outputs);
    }

    fn accept(&mut self) {
        self.advance();
    }

    fn moved_grids(&self) -> &[Grid] {
        &self.grids
    }

    fn observe(&mut self, outputs: &mut dyn Outputs) {
        self.write(&self.accepted, outputs);
    }

    fn summary(&self) -> Value {
        Value::Object(serde_json::Map::new())
    }

    fn save(&self, into: &mut dyn Write) -> io::Result<()> {
        let iterations = self.history.clone().ok_or_else(|| io::Error::other(NO_STATE))?;
        let history = History { iterations, written: bits(&self.accepted), last: self.last };
        let mut bytes = Vec::new();
        binary::append(&mut bytes, &history).map_err(io::Error::other)?;
        into.write_all(&bytes)
    }

    fn restore(&mut self, from: &mut dyn Read) -> Result<(), StateError> {
        if self.history.is_none() {
            return Err(StateError(NO_STATE.to_owned()));
        }
        let mut bytes = Vec::new();
        from.take(binary::LONGEST as u64 + 1).read_to_end(&mut bytes)?;
        let history = binary::read(&bytes).map_err(StateError)?;
        self.repeat(history).map_err(|error| StateError(error.to_string()))
    }
}
