//! Two toy participants, `left` and `right`, that exchange one scalar field each way: each sends
//! the received values plus one. Window `w` (from 1) of a serial run gives `2w - 1` in the left
//! field and `2w` in the right one.

use proto::accuracy::Accuracy;
use proto::configuration::{Configuration, FieldOnGrid, Layout, Refusal};
use proto::description::{Description, KeySpec, ModelSpec};
use proto::field::{Body, FieldKind, FieldSpec, Mapping};
use proto::grid::{Grid, Structured};
use proto::model::{
    Inputs, Model, Outputs, Setup, Solver, StateError, Step, StepError, StepReport,
};
use proto::state::read_bytes;
use std::io::{self, Read, Write};
use std::time::Duration;

/// Field sent by `left`.
pub const LEFT_VALUE: FieldSpec = field("left_value");
/// Field sent by `right`.
pub const RIGHT_VALUE: FieldSpec = field("right_value");

/// Line on standard error at the begin of a solve with a delay longer than [`LONG`].
pub const SOLVING: &str = "solving";
/// Delay from which on a solve is announced.
const LONG: Duration = Duration::from_secs(60);

/// Ways to misbehave, as values of `ROLE.fault`, in the window `ROLE.fault_window`. Only
/// [`crate::rogue`] supports the entries after `exit-at-start`.
pub const FAULTS: &[&str] = &[
    "none",
    "not-finite",
    "panic",
    "exit",
    "hang",
    "error",
    "unwritten",
    "half-written",
    "heat-is-no-number",
    "wish-is-no-number",
    "exit-at-start",
    "refuse-build",
    "short",
    "label",
    "sequence",
    "silence",
    "old-reply",
    "wrong-answer",
    "lost-reply",
    "time-is-no-number",
    "negative-time",
    "negative-wish",
    "endless-wish",
    "infinite-power",
    "power-once",
    "unannounced",
    "old-revision",
    "falling",
    "flat",
    "fraction",
    "truncated",
    "other-grid",
    "repeated",
    "grown",
    "unpublished",
    "wish-flat",
    "wish-nowhere",
    "wish-unheard",
];

const fn field(name: &'static str) -> FieldSpec {
    FieldSpec {
        name,
        unit: "1",
        components: 1,
        mapping: Mapping::Consistent,
        body: Body::Interface,
        meaning: "a number",
    }
}

/// Toy participant.
#[derive(Clone, Copy, Debug)]
pub struct Toy {
    /// Role of the participant.
    pub role: &'static str,
    /// Field it sends.
    pub sends: FieldSpec,
    /// Field it receives.
    pub receives: FieldSpec,
    /// Version of the protocol it claims.
    pub protocol: u32,
}

impl Toy {
    /// First participant.
    pub const LEFT: Toy = Toy {
        role: "left",
        sends: LEFT_VALUE,
        receives: RIGHT_VALUE,
        protocol: proto::PROTOCOL_VERSION,
    };
    /// Second participant.
    pub const RIGHT: Toy =
        Toy { role: "right", sends: RIGHT_VALUE, receives: LEFT_VALUE, ..Self::LEFT };

    fn key(&self, name: &str) -> String {
        format!("{}.{name}", self.role)
    }
}

impl Solver for Toy {
    fn description(&self) -> Description {
        let fields: Vec<FieldKind> = vec![LEFT_VALUE.kind(), RIGHT_VALUE.kind()];
        Description {
            protocol: self.protocol,
            name: format!("toy-{}", self.role),
            version: env!("CARGO_PKG_VERSION").to_owned(),
            role: self.role.to_owned(),
            standalone: true,
            estimates: true,
            advises: false,
            reusable: true,
            build: None,
            models: vec![ModelSpec {
                name: "increment".to_owned(),
                summary: "sends what it received plus one".to_owned(),
                source: "counting".to_owned(),
                steady: true,
                transient: true,
                rewinds: true,
                varies_step: true,
                consumes: vec![self.receives.name.to_owned()],
                provides: vec![self.sends.name.to_owned()],
                keys: Vec::new(),
                accuracy: Accuracy::default(),
            }],
            effects: Vec::new(),
            keys: vec![
                KeySpec::integer(&self.key("points"), "size of the field")
                    .at_least(2.0)
                    .default_value(1000),
                KeySpec::quantity(&self.key("delay"), "s", "time that a solve takes")
                    .at_least(0.0)
                    .default_value(0.0),
                KeySpec::quantity(&self.key("build_delay"), "s", "time that building takes")
                    .at_least(0.0)
                    .default_value(0.0),
                KeySpec::quantity(&self.key("build_expected"), "s", "time it is said to take")
                    .at_least(0.0)
                    .default_value(0.0),
                KeySpec::choice(&self.key("fault"), FAULTS, "way to misbehave")
                    .default_value("none"),
                KeySpec::integer(&self.key("fault_window"), "window in which to misbehave")
                    .at_least(0.0)
                    .default_value(0),
            ],
            fields,
            figures: Vec::new(),
            diagrams: Vec::new(),
            renamed: Vec::new(),
        }
    }

    fn configure(&self, configuration: &Configuration) -> Result<Setup, Refusal> {
        let case = &configuration.case;
        let points = case.integer(&self.key("points"))? as usize;
        let shape = Structured::contact_plane(0.0, 0.0, 1.0, 1.0, points, 1);
        let on_grid = FieldOnGrid { field: self.sends.name.to_owned(), grid: "numbers".to_owned() };
        let setup = ToySetup {
            toy: *self,
            delay: Duration::from_secs_f64(case.number(&self.key("delay"))?),
            build_delay: Duration::from_secs_f64(case.number(&self.key("build_delay"))?),
            fault: case.text(&self.key("fault"))?.to_owned(),
            fault_window: case.integer(&self.key("fault_window"))? as u64,
        };
        let layout = Layout {
            grids: vec![Grid::structured("numbers", shape)],
            fields: vec![on_grid],
            build_seconds: case.number(&self.key("build_expected"))?,
            ..Layout::default()
        };
        Ok(Setup::new(layout, |_| {
            if setup.fault == "exit-at-start" {
                std::process::exit(9);
            }
            if setup.fault == "refuse-build" {
                let key = setup.toy.key("points");
                return Err(Refusal::new(&key, "cannot be built", "choose other ones"));
            }
            std::thread::sleep(setup.build_delay);
            Ok(Box::new(ToyModel { setup, solves: 0 }))
        }))
    }
}

#[derive(Clone, Debug)]
struct ToySetup {
    toy: Toy,
    delay: Duration,
    build_delay: Duration,
    fault: String,
    fault_window: u64,
}

#[derive(Debug)]
struct ToyModel {
    setup: ToySetup,
    solves: u64,
}

impl ToyModel {
    fn misbehave(&self, step: &Step, sent: &mut [f64]) -> Result<(), StepError> {
        if step.window != self.setup.fault_window {
            return Ok(());
        }
        match self.setup.fault.as_str() {
            "not-finite" => sent[sent.len() / 2] = f64::NAN,
            "panic" => panic!("told to panic"),
            "exit" => std::process::exit(9),
            "hang" => loop {
                std::thread::sleep(Duration::from_secs(1));
            },
            "error" => return Err(StepError::NoSolution("told to fail".to_owned())),
            _ => {}
        }
        Ok(())
    }
}

impl Model for ToyModel {
    fn solve(
        &mut self,
        step: &Step,
        inputs: &dyn Inputs,
        outputs: &mut dyn Outputs,
    ) -> Result<StepReport, StepError> {
        let missing = |field: &FieldSpec| StepError::MissingInput { field: field.name.to_owned() };
        let received = inputs
            .get(&self.setup.toy.receives)
            .ok_or_else(|| missing(&self.setup.toy.receives))?;
        let sent =
            outputs.get(&self.setup.toy.sends).ok_or_else(|| missing(&self.setup.toy.sends))?;
        let at = |fault: &str| step.window == self.setup.fault_window && self.setup.fault == fault;
        let written = match () {
            () if at("unwritten") => 0,
            () if at("half-written") => sent.len() / 2,
            () => sent.len(),
        };
        // If the sent field is longer than the received one, the rest counts from zero.
        let received = received.values.iter().chain(std::iter::repeat(&0.0));
        for (sent, received) in sent.iter_mut().zip(received).take(written) {
            *sent = received + 1.0;
        }
        if self.setup.delay > LONG {
            // A test waits for this line in the log before it disturbs the solve.
            let _ = writeln!(io::stderr(), "{SOLVING}");
        }
        if !self.setup.delay.is_zero() {
            std::thread::sleep(self.setup.delay);
        }
        self.misbehave(step, sent)?;
        self.solves += 1;
        let mut report =
            StepReport { substeps: 1, work: sent.len() as u64, ..StepReport::default() };
        report.received_power = at("heat-is-no-number").then_some(f64::NAN);
        report.wanted_window = at("wish-is-no-number").then_some(f64::NAN);
        Ok(report)
    }

    fn first_outputs(&mut self, outputs: &mut dyn Outputs) {
        if let Some(values) = outputs.get(&self.setup.toy.sends) {
            values.fill(0.0);
        }
    }

    fn accept(&mut self) {}

    fn observe(&mut self, _outputs: &mut dyn Outputs) {}

    fn summary(&self) -> serde_json::Value {
        serde_json::json!({ self.setup.toy.role: { "solves": self.solves } })
    }

    fn save(&self, into: &mut dyn Write) -> io::Result<()> {
        into.write_all(&self.solves.to_le_bytes())
    }

    fn restore(&mut self, from: &mut dyn Read) -> Result<(), StateError> {
        self.solves = u64::from_le_bytes(read_bytes(from)?);
        Ok(())
    }
}
