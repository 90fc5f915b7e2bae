//! Participant with long work that reports its progress. It plays `right` beside `left` of
//! [`crate::toy`]. Building and solving take a given time, in steps of progress, and may hang at a
//! given step. The model `once` cannot rewind: each solve advances its state.

use crate::toy::{LEFT_VALUE, RIGHT_VALUE};
use proto::accuracy::Accuracy;
use proto::configuration::{Configuration, FieldOnGrid, Layout, Refusal};
use proto::description::{Description, KeySpec, ModelSpec, names};
use proto::grid::{Grid, Structured};
use proto::model::{
    Inputs, Model, Outputs, Setup, Solver, StateError, Step, StepError, StepReport,
};
use proto::progress::Progress;
use proto::state::read_bytes;
use std::io::{self, Read, Write};
use std::time::Duration;

const ROLE: &str = "right";

/// Model that cannot rewind.
const ONCE: &str = "once";

/// Participant with long work.
#[derive(Clone, Copy, Debug)]
pub struct Long;

fn key(name: &str) -> String {
    format!("{ROLE}.{name}")
}

fn model(name: &str, summary: &str) -> ModelSpec {
    ModelSpec {
        name: name.to_owned(),
        summary: summary.to_owned(),
        source: "counting".to_owned(),
        steady: true,
        transient: true,
        rewinds: name != ONCE,
        varies_step: true,
        consumes: names(&[&LEFT_VALUE]),
        provides: names(&[&RIGHT_VALUE]),
        keys: Vec::new(),
        accuracy: Accuracy::default(),
    }
}

impl Solver for Long {
    fn description(&self) -> Description {
        let seconds = |name: &str, help: &str| {
            KeySpec::quantity(&key(name), "s", help).at_least(0.0).default_value(0.0)
        };
        let count = |name: &str, help: &str| KeySpec::integer(&key(name), help).at_least(1.0);
        Description {
            protocol: proto::PROTOCOL_VERSION,
            name: "toy-long".to_owned(),
            version: env!("CARGO_PKG_VERSION").to_owned(),
            role: ROLE.to_owned(),
            standalone: true,
            estimates: true,
            advises: false,
            reusable: true,
            build: None,
            models: vec![
                model("patient", "sends what it received plus one, after a while"),
                model(ONCE, "sends what it received plus the number of solves"),
            ],
            effects: Vec::new(),
            keys: vec![
                seconds("build_time", "time that building takes"),
                seconds("solve_time", "time that a solve takes"),
                count("steps", "steps of progress").default_value(60),
                count("stop_at", "step at which progress stops; absent: none"),
            ],
            fields: vec![LEFT_VALUE.kind(), RIGHT_VALUE.kind()],
            diagrams: Vec::new(),
            renamed: Vec::new(),
            figures: Vec::new(),
        }
    }

    fn configure(&self, given: &Configuration) -> Result<Setup, Refusal> {
        let (case, stop_at) = (&given.case, key("stop_at"));
        let shape = Structured::contact_plane(0.0, 0.0, 1.0, 1.0, 1000, 1);
        let stop_at = case.has(&stop_at).then(|| case.integer(&stop_at)).transpose()?;
        let seconds = |name: &str| case.number(&key(name)).map(Duration::from_secs_f64);
        let setup = LongSetup {
            goes_back: given.model != ONCE,
            build: seconds("build_time")?,
            solve: seconds("solve_time")?,
            pace: Pace {
                steps: case.integer(&key("steps"))? as u64,
                stop_at: stop_at.map(|at| at as u64),
            },
        };
        let numbers =
            FieldOnGrid { field: RIGHT_VALUE.name.to_owned(), grid: "numbers".to_owned() };
        let layout = Layout {
            grids: vec![Grid::structured("numbers", shape)],
            fields: vec![numbers],
            ..Layout::default()
        };
        Ok(Setup::new(layout, |progress| {
            setup.pace.work(setup.build, "factorising", progress);
            Ok(Box::new(LongModel { setup, progress: progress.clone(), solves: 0 }))
        }))
    }
}

#[derive(Clone, Copy, Debug)]
struct Pace {
    steps: u64,
    stop_at: Option<u64>,
}

impl Pace {
    /// Works for `time`.
    fn work(self, time: Duration, what: &str, progress: &Progress) {
        if time.is_zero() {
            return;
        }
        for done in 0..self.steps {
            progress.report(done, self.steps, what);
            while self.stop_at == Some(done) {
                std::thread::sleep(Duration::from_secs(1));
            }
            std::thread::sleep(time / self.steps as u32);
        }
    }
}

struct LongSetup {
    goes_back: bool,
    build: Duration,
    solve: Duration,
    pace: Pace,
}

struct LongModel {
    setup: LongSetup,
    progress: Progress,
    solves: u64,
}

impl Model for LongModel {
    fn solve(
        &mut self,
        _step: &Step,
        inputs: &dyn Inputs,
        outputs: &mut dyn Outputs,
    ) -> Result<StepReport, StepError> {
        let missing = |field: &str| StepError::MissingInput { field: field.to_owned() };
        let received = inputs.get(&LEFT_VALUE).ok_or_else(|| missing(LEFT_VALUE.name))?.values;
        if let Some(index) = proto::model::first_non_finite(received) {
            let (field, value) = (LEFT_VALUE.name.to_owned(), received[index]);
            return Err(StepError::NonFiniteInput { field, index, value });
        }
        self.setup.pace.work(self.setup.solve, "sweeping", &self.progress);
        self.solves += 1;
        let more = if self.setup.goes_back { 1.0 } else { self.solves as f64 };
        let received = received.iter().chain(std::iter::repeat(&0.0));
        for (sent, received) in outputs.get(&RIGHT_VALUE).into_iter().flatten().zip(received) {
            *sent = received + more;
        }
        Ok(StepReport { substeps: 1, ..StepReport::default() })
    }

    fn first_outputs(&mut self, outputs: &mut dyn Outputs) {
        outputs.get(&RIGHT_VALUE).into_iter().for_each(|values| values.fill(0.0));
    }

    fn accept(&mut self) {}

    fn observe(&mut self, _outputs: &mut dyn Outputs) {}

    fn summary(&self) -> serde_json::Value {
        serde_json::json!({ ROLE: { "solves": self.solves } })
    }

    fn save(&self, into: &mut dyn Write) -> io::Result<()> {
        into.write_all(&self.solves.to_le_bytes())
    }

    fn restore(&mut self, from: &mut dyn Read) -> Result<(), StateError> {
        self.solves = u64::from_le_bytes(read_bytes(from)?);
        Ok(())
    }
}
