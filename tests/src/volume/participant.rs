//! Participant with fields on a volume.

use super::{BLOCK, KINDS, block, hexahedra, temperature};
use proto::accuracy::Accuracy;
use proto::configuration::{Configuration, FieldOnGrid, Layout, Refusal};
use proto::description::{Description, KeySpec, ModelSpec};
use proto::field::{Body, FieldSpec, Mapping};
use proto::grid::Grid;
use proto::model::{
    Inputs, Model, Outputs, Setup, Solver, StateError, Step, StepError, StepReport,
};
use proto::state::read_bytes;
use std::io::{self, Read, Write};

/// Computed temperature \[K\].
pub const VOLUME_TEMPERATURE: FieldSpec = FieldSpec {
    name: "volume_temperature",
    unit: "K",
    components: 1,
    mapping: Mapping::Consistent,
    body: Body::Interface,
    meaning: "temperature in the block",
};
/// Position of the elements in the last accepted window \[m\].
pub const VOLUME_PLACE: FieldSpec = FieldSpec {
    name: "volume_place",
    unit: "m",
    components: 3,
    mapping: Mapping::Consistent,
    body: Body::Interface,
    meaning: "centres of the block's elements",
};

/// Ways to break the rules for volumes, as values of `volume.fault`.
const FAULTS: &[&str] = &["none", "missing", "mirrored"];

/// Upper bound of the number of windows of a run.
const MOST_WINDOWS: u64 = 1_000_000_000;

/// Participant with a block.
#[derive(Clone, Copy, Debug)]
pub struct Block;

impl Solver for Block {
    fn description(&self) -> Description {
        let fields = [VOLUME_TEMPERATURE, VOLUME_PLACE];
        Description {
            protocol: proto::PROTOCOL_VERSION,
            name: "toy-volume".to_owned(),
            version: env!("CARGO_PKG_VERSION").to_owned(),
            role: "volume".to_owned(),
            standalone: true,
            estimates: true,
            advises: false,
            reusable: true,
            build: None,
            models: vec![ModelSpec {
                name: "law".to_owned(),
                summary: "a temperature given as a function of place and time".to_owned(),
                source: "a closed form".to_owned(),
                steady: true,
                transient: true,
                consumes: Vec::new(),
                provides: fields.map(|field| field.name.to_owned()).to_vec(),
                keys: Vec::new(),
                accuracy: Accuracy::default(),
                rewinds: true,
                varies_step: true,
            }],
            effects: Vec::new(),
            keys: vec![
                KeySpec::integer("volume.elements", "elements along the block")
                    .at_least(1.0)
                    .default_value(8),
                KeySpec::choice("volume.hexahedra", KINDS, "kind of its elements")
                    .default_value("structured"),
                KeySpec::flag("volume.swells", "it grows by a hundredth with every window")
                    .default_value(false),
                KeySpec::choice("volume.fault", FAULTS, "way to misbehave").default_value("none"),
            ],
            fields: fields.map(|field| field.kind()).to_vec(),
            diagrams: Vec::new(),
            renamed: Vec::new(),
            figures: Vec::new(),
        }
    }

    fn configure(&self, configuration: &Configuration) -> Result<Setup, Refusal> {
        let case = &configuration.case;
        let kind = case.text("volume.hexahedra")?.to_owned();
        let elements = case.integer("volume.elements")? as usize;
        let fault = case.text("volume.fault")?.to_owned();
        let swells = case.get("volume.swells").and_then(serde_json::Value::as_bool) == Some(true);
        let on_block =
            |field: FieldSpec| FieldOnGrid { field: field.name.to_owned(), grid: BLOCK.to_owned() };
        let layout = Layout {
            grids: vec![Grid::volume(BLOCK, hexahedra(&kind, elements))],
            fields: vec![on_block(VOLUME_TEMPERATURE), on_block(VOLUME_PLACE)],
            ..Layout::default()
        };
        let setup = BlockSetup { kind, elements, swells, fault };
        Ok(Setup::new(layout, |_| {
            let block = setup.block_after(0);
            let grids = match setup.fault.as_str() {
                "missing" => Vec::new(),
                "mirrored" => vec![mirrored(&block)],
                _ => vec![block.clone()],
            };
            Ok(Box::new(BlockModel { setup, grids, solved_on: block, windows: 0 }))
        }))
    }
}

#[derive(Clone, Debug)]
struct BlockSetup {
    kind: String,
    elements: usize,
    swells: bool,
    fault: String,
}

impl BlockSetup {
    fn block_after(&self, windows: u64) -> Grid {
        block(&self.kind, self.elements, windows)
    }
}

/// Block with negated coordinates, which turns the elements inside out.
fn mirrored(block: &Grid) -> Grid {
    let mut values = vec![0.0; 3 * block.geometry_points()];
    block.encode_geometry(&mut values);
    values.iter_mut().for_each(|value| *value = -*value);
    let counts = block.announced();
    counts.with_geometry(&values, 1).unwrap_or(counts)
}

struct BlockModel {
    setup: BlockSetup,
    /// Block in its accepted position.
    grids: Vec<Grid>,
    /// Block in the last accepted window.
    solved_on: Grid,
    /// Number of accepted windows.
    windows: u64,
}

impl BlockModel {
    /// Moves the block to its position after the accepted windows; returns the previous grid.
    /// Revisions increase even after a return to an earlier state.
    fn swell(&mut self) -> Grid {
        let next = self.setup.block_after(self.windows);
        let revision = next.revision.max(self.grids[0].revision + 1);
        std::mem::replace(&mut self.grids[0], Grid { revision, ..next })
    }
}

impl Model for BlockModel {
    fn solve(
        &mut self,
        _step: &Step,
        _inputs: &dyn Inputs,
        _outputs: &mut dyn Outputs,
    ) -> Result<StepReport, StepError> {
        Ok(StepReport { substeps: 1, work: self.solved_on.points() as u64, ..<_>::default() })
    }

    fn first_outputs(&mut self, _outputs: &mut dyn Outputs) {}

    fn accept(&mut self) {
        self.windows += 1;
        if self.setup.swells {
            self.solved_on = self.swell();
        }
    }

    fn moved_grids(&self) -> &[Grid] {
        &self.grids
    }

    fn observe(&mut self, outputs: &mut dyn Outputs) {
        let points = self.solved_on.points();
        if let Some(values) = outputs.get(&VOLUME_TEMPERATURE) {
            for (n, value) in values.iter_mut().enumerate() {
                *value = temperature(self.solved_on.centre(n), self.windows);
            }
        }
        if let Some(values) = outputs.get(&VOLUME_PLACE) {
            for n in 0..points {
                for (c, coordinate) in self.solved_on.centre(n).into_iter().enumerate() {
                    values[c * points + n] = coordinate;
                }
            }
        }
    }

    fn summary(&self) -> serde_json::Value {
        serde_json::json!({"volume": {"windows": self.windows}})
    }

    fn save(&self, into: &mut dyn Write) -> io::Result<()> {
        into.write_all(&self.windows.to_le_bytes())
    }

    fn restore(&mut self, from: &mut dyn Read) -> Result<(), StateError> {
        let windows = u64::from_le_bytes(read_bytes(from)?);
        if windows > MOST_WINDOWS {
            return Err(StateError(format!("{windows} windows")));
        }
        self.windows = windows;
        if self.setup.swells {
            self.swell();
            self.solved_on = self.setup.block_after(windows.saturating_sub(1));
        }
        Ok(())
    }
}
