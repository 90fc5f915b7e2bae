//! Participants of the linear pair.

use super::problem::{LARGEST_DENSE, PROBLEMS, Problem};
use proto::accuracy::Accuracy;
use proto::configuration::{Configuration, FieldOnGrid, Layout, Refusal};
use proto::description::{Description, KeySpec, ModelSpec};
use proto::field::{Body, FieldSpec, Mapping};
use proto::grid::{Grid, Structured};
use proto::model::{
    Inputs, Model, Outputs, Setup, Solver, StateError, Step, StepError, StepReport,
};
use proto::params::Params;
use proto::state::{read_numbers, write_numbers};
use std::io::{self, Read, Write};

/// Field sent by `relay`.
pub const RELAY_VALUE: FieldSpec = field("relay_value");
/// Field sent by `operator`.
pub const OPERATOR_VALUE: FieldSpec = field("operator_value");

const fn field(name: &'static str) -> FieldSpec {
    FieldSpec {
        name,
        unit: "1",
        components: 1,
        mapping: Mapping::Consistent,
        body: Body::Interface,
        meaning: "a vector of unknowns",
    }
}

/// Grid of a participant with `points` points, over a length equal to the number of unknowns,
/// shifted by `offset` along x. With one point per unknown all grids match.
#[must_use]
pub fn grid(unknowns: usize, points: usize, offset: f64) -> Grid {
    let step = unknowns as f64 / points as f64;
    let first = 0.5 * (step - 1.0) + offset;
    Grid::structured(GRID, Structured::contact_plane(first, 0.0, step, 1.0, points, 1))
}

const GRID: &str = "unknowns";

/// Participant of the linear pair.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Linear {
    /// Sends back the values it receives.
    Relay,
    /// Answers x with Mx + b_w.
    Operator,
}

impl Linear {
    fn role(self) -> &'static str {
        match self {
            Self::Relay => "relay",
            Self::Operator => "operator",
        }
    }

    fn sends(self) -> FieldSpec {
        match self {
            Self::Relay => RELAY_VALUE,
            Self::Operator => OPERATOR_VALUE,
        }
    }

    fn receives(self) -> FieldSpec {
        match self {
            Self::Relay => OPERATOR_VALUE,
            Self::Operator => RELAY_VALUE,
        }
    }

    fn model(self) -> ModelSpec {
        let (name, summary) = match self {
            Self::Relay => ("identity", "sends on what it receives"),
            Self::Operator => ("affine", "answers x with Mx + b"),
        };
        ModelSpec {
            name: name.to_owned(),
            summary: summary.to_owned(),
            source: "linear algebra".to_owned(),
            steady: true,
            transient: true,
            rewinds: true,
            varies_step: true,
            consumes: vec![self.receives().name.to_owned()],
            provides: vec![self.sends().name.to_owned()],
            keys: Vec::new(),
            accuracy: Accuracy::default(),
        }
    }
}

impl Linear {
    /// Keys of this participant: the relay may have its own grid.
    fn own_keys(self) -> Vec<KeySpec> {
        match self {
            Self::Operator => Vec::new(),
            Self::Relay => vec![
                KeySpec::integer("relay.points", "points of the grid; absent: the unknowns")
                    .at_least(2.0)
                    .at_most(1e8),
                KeySpec::number("relay.offset", "way by which the grid is moved")
                    .default_value(0.0),
            ],
        }
    }

    fn own_grid(self, case: &Params, size: usize) -> Result<Grid, Refusal> {
        if self == Self::Operator {
            return Ok(grid(size, size, 0.0));
        }
        let points = match case.has("relay.points") {
            true => case.integer("relay.points")? as usize,
            false => size,
        };
        Ok(grid(size, points, case.number("relay.offset")?))
    }
}

impl Solver for Linear {
    fn description(&self) -> Description {
        Description {
            protocol: proto::PROTOCOL_VERSION,
            name: format!("toy-{}", self.role()),
            version: env!("CARGO_PKG_VERSION").to_owned(),
            role: self.role().to_owned(),
            standalone: true,
            estimates: true,
            advises: false,
            reusable: true,
            build: None,
            models: vec![self.model()],
            effects: Vec::new(),
            keys: vec![
                KeySpec::choice("linear.problem", PROBLEMS, "kind of matrix").default_value("P1"),
                KeySpec::integer("linear.seed", "seed of its numbers")
                    .at_least(0.0)
                    .default_value(42),
                KeySpec::integer("linear.size", "number of unknowns")
                    .at_least(2.0)
                    .at_most(1e8)
                    .default_value(100),
            ]
            .into_iter()
            .chain(self.own_keys())
            .collect(),
            fields: vec![RELAY_VALUE.kind(), OPERATOR_VALUE.kind()],
            figures: Vec::new(),
            diagrams: Vec::new(),
            renamed: Vec::new(),
        }
    }

    fn configure(&self, configuration: &Configuration) -> Result<Setup, Refusal> {
        let case = &configuration.case;
        let size = case.integer("linear.size")? as usize;
        let name = case.text("linear.problem")?.to_owned();
        if matches!(name.as_str(), "P5" | "P6") && size > LARGEST_DENSE {
            let reason = format!("{name} is a full matrix, of at most {LARGEST_DENSE} unknowns");
            return Err(Refusal::new("linear.size", reason, "write less, or take P1 to P4"));
        }
        let on_grid =
            |field: FieldSpec| FieldOnGrid { field: field.name.to_owned(), grid: GRID.to_owned() };
        let layout = Layout {
            grids: vec![self.own_grid(case, size)?],
            fields: vec![on_grid(self.sends())],
            inputs: vec![on_grid(self.receives())],
            ..Layout::default()
        };
        let (part, seed) = (*self, case.integer("linear.seed")? as u64);
        Ok(Setup::new(layout, move |_| {
            let problem = match part {
                Linear::Relay => None,
                Linear::Operator => {
                    let unknown = || {
                        Refusal::new("linear.problem", "unknown", format!("one of {PROBLEMS:?}"))
                    };
                    Some(Problem::new(&name, seed, size).ok_or_else(unknown)?)
                }
            };
            let last = vec![0.0; if problem.is_some() { size } else { 0 }];
            Ok(Box::new(LinearModel { part, problem, last, window: 0, true_error: 0.0 }))
        }))
    }
}

#[derive(Debug)]
struct LinearModel {
    part: Linear,
    /// Problem, for the operator only.
    problem: Option<Problem>,
    /// Last answer of the operator.
    last: Vec<f64>,
    window: u64,
    true_error: f64,
}

impl Model for LinearModel {
    fn solve(
        &mut self,
        step: &Step,
        inputs: &dyn Inputs,
        outputs: &mut dyn Outputs,
    ) -> Result<StepReport, StepError> {
        let missing = |field: &FieldSpec| StepError::MissingInput { field: field.name.to_owned() };
        let (receives, sends) = (self.part.receives(), self.part.sends());
        let received = inputs.get(&receives).ok_or_else(|| missing(&receives))?;
        let sent = outputs.get(&sends).ok_or_else(|| missing(&sends))?;
        match &self.problem {
            None => sent.copy_from_slice(received.values),
            Some(problem) => {
                problem.apply(step.window, received.values, sent);
                self.last.copy_from_slice(sent);
            }
        }
        self.window = step.window;
        Ok(StepReport { substeps: 1, work: sent.len() as u64, ..StepReport::default() })
    }

    fn first_outputs(&mut self, outputs: &mut dyn Outputs) {
        if let Some(values) = outputs.get(&self.part.sends()) {
            values.fill(0.0);
        }
    }

    fn accept(&mut self) {
        if let Some(problem) = &self.problem {
            self.true_error = self.true_error.max(problem.true_error(self.window, &self.last));
        }
    }

    fn observe(&mut self, _outputs: &mut dyn Outputs) {}

    fn summary(&self) -> serde_json::Value {
        match self.part {
            Linear::Relay => serde_json::json!({}),
            Linear::Operator => serde_json::json!({ "linear": { "true_error": self.true_error } }),
        }
    }

    fn save(&self, into: &mut dyn Write) -> io::Result<()> {
        write_numbers(into, [&self.true_error])
    }

    fn restore(&mut self, from: &mut dyn Read) -> Result<(), StateError> {
        Ok(read_numbers(from, [&mut self.true_error])?)
    }
}
