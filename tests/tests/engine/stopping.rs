//! Solver whose models find no solution in one window.

use proto::advice::{Opinion, Scene};
use proto::configuration::{Configuration, Refusal};
use proto::description::Description;
use proto::grid::Grid;
use proto::model::{
    Inputs, Model, Outputs, Setup, Solver, StateError, Step, StepError, StepReport,
};
use serde_json::Value;
use std::io::{self, Read, Write};

/// Wrapper of a solver, which fails in one window.
#[derive(Debug)]
pub(crate) struct Stopping<S> {
    /// Wrapped solver.
    pub(crate) solver: S,
    /// Window without a solution, counted from 0.
    pub(crate) window: u64,
}

struct StoppingModel {
    model: Box<dyn Model>,
    window: u64,
}

impl<S: Solver> Solver for Stopping<S> {
    fn description(&self) -> Description {
        self.solver.description()
    }

    fn configure(&self, configuration: &Configuration) -> Result<Setup, Refusal> {
        let (setup, window) = (self.solver.configure(configuration)?, self.window);
        let layout = setup.layout().clone();
        Ok(Setup::new(layout, move |progress| {
            Ok(Box::new(StoppingModel { model: setup.build(progress)?, window }))
        }))
    }

    fn advise(&self, scene: &Scene) -> Opinion {
        self.solver.advise(scene)
    }
}

impl Model for StoppingModel {
    fn solve(
        &mut self,
        step: &Step,
        inputs: &dyn Inputs,
        outputs: &mut dyn Outputs,
    ) -> Result<StepReport, StepError> {
        if step.window == self.window {
            return Err(StepError::NoSolution("stopped".to_owned()));
        }
        self.model.solve(step, inputs, outputs)
    }

    fn first_outputs(&mut self, outputs: &mut dyn Outputs) {
        self.model.first_outputs(outputs);
    }

    fn acceptable(&self) -> Result<(), StepError> {
        self.model.acceptable()
    }

    fn accept(&mut self) {
        self.model.accept();
    }

    fn moved_grids(&self) -> &[Grid] {
        self.model.moved_grids()
    }

    fn observe(&mut self, outputs: &mut dyn Outputs) {
        self.model.observe(outputs);
    }

    fn summary(&self) -> Value {
        self.model.summary()
    }

    fn save(&self, into: &mut dyn Write) -> io::Result<()> {
        self.model.save(into)
    }

    fn restore(&mut self, from: &mut dyn Read) -> Result<(), StateError> {
        self.model.restore(from)
    }
}
