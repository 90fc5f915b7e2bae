//! The program as a solver: its description, and its start for a configuration.
//!
//! The vertices of a program are known only after it has started. The description therefore
//! announces no estimates, and [`ProgramSolver::configure`] starts the program.

use super::coupled::{Coupled, CoupledData};
use super::model::{Exchange, RunningProgram};
use super::program::ProgramError;
use super::starter::{Started, Starter, sizes};
use crate::protocol::Mesh;
use proto::accuracy::Accuracy;
use proto::configuration::{Configuration, FieldOnGrid, Layout, Refusal};
use proto::description::{Description, ModelSpec};
use proto::field::{self, FieldKind, Mapping};
use proto::grid::{Grid, Measure, Shape, Vertices};
use proto::model::{Setup, Solver};

/// Name of the only model.
const MODEL: &str = "program";
/// Longest name of a grid.
const LONGEST_NAME: usize = 31;
/// End of the name of a grid whose values are totals.
const TOTALS: &str = "-totals";
/// Longest name of a mesh before this end.
const SHORTER: usize = LONGEST_NAME - TOTALS.len();

/// Solver that describes a program, or starts it.
#[derive(Debug)]
pub struct ProgramSolver {
    starter: Starter,
    /// True if a run is resumed by repeating the accepted windows.
    repeats: bool,
}

impl ProgramSolver {
    /// Creates a solver. With `repeats`, a run is resumed by repeating its accepted windows.
    #[must_use]
    pub fn new(starter: Starter, repeats: bool) -> Self {
        Self { starter, repeats }
    }

    fn key(&self) -> String {
        format!("{}.command", self.starter.role)
    }
}

impl Solver for ProgramSolver {
    fn description(&self) -> Description {
        let Coupled { participant, read, written, source, .. } = &self.starter.coupled;
        let names = |list: &[CoupledData]| list.iter().map(|data| data.field.clone()).collect();
        let all = written.iter().chain(read);
        let own = all.filter(|data| field::find(&data.field).is_none());
        Description {
            protocol: proto::PROTOCOL_VERSION,
            name: "precice-participant".to_owned(),
            version: env!("CARGO_PKG_VERSION").to_owned(),
            role: self.starter.role.clone(),
            standalone: true,
            estimates: false,
            advises: false,
            reusable: false,
            build: None,
            models: vec![ModelSpec {
                name: MODEL.to_owned(),
                summary: format!("program with a preCICE adapter, participant {participant}"),
                source: source.clone(),
                steady: false,
                transient: true,
                rewinds: true,
                varies_step: true,
                consumes: names(read),
                provides: names(written),
                keys: Vec::new(),
                accuracy: Accuracy::default(),
            }],
            effects: Vec::new(),
            keys: Vec::new(),
            fields: own.map(CoupledData::kind).collect(),
            figures: Vec::new(),
            diagrams: Vec::new(),
            renamed: Vec::new(),
        }
    }

    fn configure(&self, configuration: &Configuration) -> Result<Setup, Refusal> {
        let inputs = self.inputs(configuration)?;
        let failed = |error: ProgramError| {
            let fix = "correct the program or its command; its output is in log.jsonl";
            Refusal::new(&self.key(), error.to_string(), fix)
        };
        let threads = configuration.threads;
        let Started { mut program, meshes, first } = self.starter.start(threads).map_err(failed)?;
        let placed = self.place(configuration, inputs, meshes);
        let (layout, exchange) = placed.map_err(|reason| {
            program.refuse(&reason);
            Refusal::new(&self.key(), reason, "correct the mesh of the program")
        })?;
        let (starter, repeats) = (self.starter.clone(), self.repeats);
        Ok(Setup::new(layout, move |_| {
            let running = (program, first);
            Ok(Box::new(RunningProgram::new(starter, threads, running, exchange, repeats)))
        }))
    }
}

impl ProgramSolver {
    /// Returns the grids of the program in the case, and the data on them.
    fn place(
        &self,
        configuration: &Configuration,
        inputs: Vec<FieldKind>,
        mut meshes: Vec<Mesh>,
    ) -> Result<(Layout, Exchange), String> {
        let coupled = &self.starter.coupled;
        let placement = coupled.placement.clone();
        for point in meshes.iter_mut().flat_map(|mesh| &mut mesh.points) {
            *point = placement.place(*point);
        }
        let mut exchange = Exchange { sizes: sizes(&meshes), ..Exchange::default() };
        let mut grids = Grids { meshes, made: Vec::new() };
        let mut layout = Layout::default();
        for (data, kind) in coupled.read.iter().zip(inputs) {
            let grid = grids.of(data, kind.mapping)?;
            layout.inputs.push(FieldOnGrid { field: kind.name.clone(), grid });
            exchange.read.push((data.clone(), data.spec(&kind)));
        }
        for data in &coupled.written {
            let kind = data.kind();
            let asked = configuration.outputs.iter().chain(&configuration.observed);
            if asked.into_iter().any(|name| *name == kind.name) {
                let grid = grids.of(data, kind.mapping)?;
                layout.fields.push(FieldOnGrid { field: kind.name.clone(), grid });
            }
            exchange.written.push((data.clone(), data.spec(&kind)));
        }
        layout.grids = grids.made;
        if placement.moves() {
            layout.moving = layout.grids.iter().map(|grid| grid.name.clone()).collect();
            exchange.moving = Some((placement, layout.grids.clone()));
        }
        Ok((layout, exchange))
    }

    /// Returns the kinds of the fields that the program reads.
    fn inputs(&self, configuration: &Configuration) -> Result<Vec<FieldKind>, Refusal> {
        let one = |data: &CoupledData| {
            let field = &data.field;
            let kind = configuration
                .inputs
                .iter()
                .map(|input| &input.field)
                .find(|kind| kind.name == *field)
                .ok_or_else(|| {
                    let reason = format!(
                        "the program reads `{}` from the field `{field}`, which nothing provides",
                        data.info.name
                    );
                    let fix = "wire it to a field of another participant with --wire";
                    Refusal::new(&self.key(), reason, fix)
                })?;
            let (found, expected) = (kind.components as usize, data.info.components);
            if found != expected {
                let reason = format!(
                    "`{}` has {expected} components, and the field `{field}` has {found}",
                    data.info.name
                );
                return Err(Refusal::new(&self.key(), reason, "wire it to another field"));
            }
            Ok(kind.clone())
        };
        self.starter.coupled.read.iter().map(one).collect()
    }
}

/// Grids made from the meshes of a program.
struct Grids {
    meshes: Vec<Mesh>,
    made: Vec<Grid>,
}

impl Grids {
    /// Returns the name of the grid for data, which is made when it is needed first. Totals and
    /// densities on one mesh have grids of their own.
    fn of(&mut self, data: &CoupledData, mapping: Mapping) -> Result<String, String> {
        let Mesh { points, edges, triangles } = self.meshes[data.info.mesh].clone();
        let totals = data.is_total && mapping == Mapping::Conservative;
        let mut name: String = data.mesh.chars().map(plain).take(LONGEST_NAME).collect();
        if totals {
            name = format!("{name:.SHORTER$}{TOTALS}");
        }
        let measure = if totals { Measure::PerPoint } else { Measure::PerArea };
        let vertices = Vertices { points, edges, triangles, measure };
        let mut grid = Grid::vertices(&name, vertices);
        // Vertices without connectivity have no areas.
        if let (Err(_), Shape::Vertices(vertices)) = (grid.check(), &mut grid.shape)
            && !totals
        {
            vertices.measure = Measure::Unknown;
        }
        match self.made.iter().find(|other| other.name == grid.name) {
            Some(other) if *other != grid => {
                return Err(format!("two meshes would have the grid name `{}`", grid.name));
            }
            Some(_) => {}
            None => {
                grid.check()?;
                self.made.push(grid.clone());
            }
        }
        Ok(grid.name)
    }
}

/// Replaces a character that a grid name cannot have.
fn plain(character: char) -> char {
    match character.is_ascii_alphanumeric() || matches!(character, '_' | '-') {
        true => character,
        false => '_',
    }
}
