//! Participants of the moving pair.

use super::{MOTIONS, PATCH, flux, patch, plate, temperature};
use proto::accuracy::Accuracy;
use proto::configuration::{Configuration, FieldOnGrid, Layout, Refusal};
use proto::description::{Description, KeySpec, ModelSpec};
use proto::field::{Body, FieldSpec, Mapping};
use proto::grid::Grid;
use proto::model::{
    InputField, Inputs, Model, Outputs, Setup, Solver, StateError, Step, StepError, StepReport,
};
use proto::state::read_bytes;
use std::io::{self, Read, Write};

/// Flux sent by `mover` \[W/m²\].
pub const MOVING_FLUX: FieldSpec = FieldSpec {
    name: "moving_flux",
    unit: "W/m2",
    components: 1,
    mapping: Mapping::Conservative,
    body: Body::Interface,
    meaning: "flux into the plate",
};
/// Position of the mover's elements in the last accepted window \[m\]; only observed.
const MOVING_PLACE: FieldSpec = FieldSpec {
    name: "moving_place",
    unit: "m",
    components: 2,
    mapping: Mapping::Consistent,
    body: Body::Interface,
    meaning: "x and y of the elements' centres",
};
/// Temperature sent by `plate` \[K\].
const PLATE_TEMPERATURE: FieldSpec = FieldSpec {
    name: "plate_temperature",
    unit: "K",
    components: 1,
    mapping: Mapping::Consistent,
    body: Body::Interface,
    meaning: "temperature of the plate",
};

/// Participant of the moving pair.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Moving {
    /// Has the moving grid.
    Mover,
    /// Has the fixed grid.
    Plate,
}

impl Moving {
    fn role(self) -> &'static str {
        match self {
            Self::Mover => "mover",
            Self::Plate => "plate",
        }
    }

    fn sends(self) -> FieldSpec {
        match self {
            Self::Mover => MOVING_FLUX,
            Self::Plate => PLATE_TEMPERATURE,
        }
    }

    fn receives(self) -> FieldSpec {
        match self {
            Self::Mover => PLATE_TEMPERATURE,
            Self::Plate => MOVING_FLUX,
        }
    }

    fn model(self) -> ModelSpec {
        let mut provides = vec![self.sends().name.to_owned()];
        if self == Self::Mover {
            provides.push(MOVING_PLACE.name.to_owned());
        }
        ModelSpec {
            name: "law".to_owned(),
            summary: "a field given as a function of place".to_owned(),
            source: "a closed form".to_owned(),
            steady: false,
            transient: true,
            rewinds: true,
            varies_step: true,
            consumes: vec![self.receives().name.to_owned()],
            provides,
            keys: Vec::new(),
            accuracy: Accuracy::default(),
        }
    }

    fn own_keys(self) -> Vec<KeySpec> {
        match self {
            Self::Mover => vec![
                KeySpec::choice("mover.motion", MOTIONS, "how the patch moves")
                    .default_value("none"),
                KeySpec::integer("mover.every", "windows from one step to the next")
                    .at_least(1.0)
                    .default_value(1),
            ],
            Self::Plate => vec![
                KeySpec::integer("plate.resolution", "elements of the plate along x")
                    .at_least(2.0)
                    .default_value(53),
                KeySpec::flag("plate.direct", "it hears the flux on the mover's grid")
                    .default_value(false),
            ],
        }
    }
}

impl Solver for Moving {
    fn description(&self) -> Description {
        let gain = KeySpec::number("moving.gain", "how much each heeds the other [1/K, 1/kW]");
        let keys = [gain.at_least(0.0).default_value(0.0)].into_iter();
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
            keys: keys.chain(self.own_keys()).collect(),
            fields: [MOVING_FLUX, MOVING_PLACE, PLATE_TEMPERATURE].map(|f| f.kind()).to_vec(),
            figures: Vec::new(),
            diagrams: Vec::new(),
            renamed: Vec::new(),
        }
    }

    fn configure(&self, configuration: &Configuration) -> Result<Setup, Refusal> {
        let case = &configuration.case;
        let on = |field: FieldSpec, grid: &Grid| FieldOnGrid {
            field: field.name.to_owned(),
            grid: grid.name.clone(),
        };
        let flag = |key: &str| case.get(key).and_then(serde_json::Value::as_bool) == Some(true);
        let (mut motion, mut every) = ("none".to_owned(), 1);
        let mut layout = Layout::default();
        let grid = match self {
            Self::Mover => {
                motion = case.text("mover.motion")?.to_owned();
                every = case.integer("mover.every")? as u64;
                patch(&motion, 0)
            }
            Self::Plate => plate(case.integer("plate.resolution")? as usize),
        };
        layout.fields = vec![on(self.sends(), &grid)];
        if *self == Self::Mover {
            layout.fields.push(on(MOVING_PLACE, &grid));
        }
        if !flag("plate.direct") {
            layout.inputs.push(on(self.receives(), &grid));
        }
        if motion != "none" {
            layout.moving.push(PATCH.to_owned());
        }
        layout.grids.push(grid);
        let gain = case.number("moving.gain")?;
        let setup = MovingSetup { part: *self, motion, every, gain };
        let grids = layout.grids.clone();
        Ok(Setup::new(layout, |_| {
            let solved_on = grids[0].clone();
            let (accepted, trial) = (Books::default(), Books::default());
            Ok(Box::new(MovingModel { setup, grids, solved_on, accepted, trial }))
        }))
    }
}

#[derive(Clone, Debug)]
struct MovingSetup {
    part: Moving,
    motion: String,
    every: u64,
    gain: f64,
}

/// Accepted state.
#[derive(Clone, Copy, Debug, Default)]
struct Books {
    windows: u64,
    /// Revision of the grid of the last input.
    revision: u64,
    /// Largest relative error of an input.
    error: f64,
}

struct MovingModel {
    setup: MovingSetup,
    /// The only grid, in its accepted position.
    grids: Vec<Grid>,
    /// Grid in the last accepted window.
    solved_on: Grid,
    accepted: Books,
    trial: Books,
}

impl MovingModel {
    /// Largest difference between the input and its law, relative to the law.
    fn error(&self, input: &InputField) -> f64 {
        let law = match self.setup.part {
            Moving::Mover => temperature,
            Moving::Plate => flux,
        };
        let of = |(n, value): (usize, &f64)| {
            let expected = law(input.grid.centre(n));
            (value - expected).abs() / expected
        };
        input.values.iter().enumerate().map(of).fold(0.0, f64::max)
    }

    fn grid_after(&self, windows: u64) -> Grid {
        patch(&self.setup.motion, windows / self.setup.every)
    }

    fn heat_up(&self, input: &InputField, sent: &mut [f64]) -> f64 {
        let power: f64 =
            input.values.iter().zip(input.grid.areas()).map(|(q, area)| q * area).sum();
        for (n, value) in sent.iter_mut().enumerate() {
            let gain = 1.0 + 1e-3 * self.setup.gain * power;
            *value = temperature(self.grids[0].centre(n)) * gain;
        }
        power
    }

    fn send_heat(&self, input: &InputField, sent: &mut [f64]) -> Result<(), StepError> {
        if *input.grid != self.grids[0] {
            let (found, own) = (input.grid.revision, self.grids[0].revision);
            let reason = format!("the input is on revision {found} of the patch, not {own}");
            return Err(StepError::NoSolution(reason));
        }
        for (n, (value, t)) in sent.iter_mut().zip(input.values).enumerate() {
            *value = flux(self.grids[0].centre(n)) * (1.0 - self.setup.gain * t);
        }
        Ok(())
    }
}

impl Model for MovingModel {
    fn solve(
        &mut self,
        _step: &Step,
        inputs: &dyn Inputs,
        outputs: &mut dyn Outputs,
    ) -> Result<StepReport, StepError> {
        let (receives, sends) = (self.setup.part.receives(), self.setup.part.sends());
        let missing = |field: &FieldSpec| StepError::MissingInput { field: field.name.to_owned() };
        let input = inputs.get(&receives).ok_or_else(|| missing(&receives))?;
        let sent = outputs.get(&sends).ok_or_else(|| missing(&sends))?;
        let mut report = StepReport { substeps: 1, work: sent.len() as u64, ..<_>::default() };
        match self.setup.part {
            Moving::Mover => self.send_heat(&input, sent)?,
            Moving::Plate => report.received_power = Some(self.heat_up(&input, sent)),
        }
        self.trial = Books {
            windows: self.accepted.windows + 1,
            revision: input.grid.revision,
            error: self.accepted.error.max(self.error(&input)),
        };
        Ok(report)
    }

    fn first_outputs(&mut self, outputs: &mut dyn Outputs) {
        let law = match self.setup.part {
            Moving::Mover => flux,
            Moving::Plate => temperature,
        };
        if let Some(values) = outputs.get(&self.setup.part.sends()) {
            let places = (0..values.len()).map(|n| self.grids[0].centre(n));
            values.iter_mut().zip(places).for_each(|(value, place)| *value = law(place));
        }
    }

    fn accept(&mut self) {
        self.accepted = self.trial;
        if self.setup.part == Moving::Mover {
            let next = self.grid_after(self.accepted.windows);
            self.solved_on = std::mem::replace(&mut self.grids[0], next);
        }
    }

    fn moved_grids(&self) -> &[Grid] {
        &self.grids
    }

    fn observe(&mut self, outputs: &mut dyn Outputs) {
        if let Some(values) = outputs.get(&MOVING_PLACE) {
            let points = self.solved_on.points();
            for n in 0..points {
                let [x, y, _] = self.solved_on.centre(n);
                (values[n], values[points + n]) = (x, y);
            }
        }
    }

    fn summary(&self) -> serde_json::Value {
        let Books { windows, revision, error } = self.accepted;
        let role = self.setup.part.role();
        serde_json::json!({ role: {
            "windows": windows, "grid_revision": revision, "largest_error": error,
        }})
    }

    fn save(&self, into: &mut dyn Write) -> io::Result<()> {
        let Books { windows, revision, error } = self.accepted;
        into.write_all([windows, revision, error.to_bits()].map(u64::to_le_bytes).as_flattened())
    }

    fn restore(&mut self, from: &mut dyn Read) -> Result<(), StateError> {
        let mut next = || read_bytes(from).map(u64::from_le_bytes);
        let (windows, revision, error) = (next()?, next()?, f64::from_bits(next()?));
        self.accepted = Books { windows, revision, error };
        if self.setup.part == Moving::Mover {
            self.grids[0] = self.grid_after(windows);
            self.solved_on = self.grid_after(windows - 1);
        }
        Ok(())
    }
}
