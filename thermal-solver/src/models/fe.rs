//! Model `fe`: finite elements of both bodies, extruded from the grid of the heat flux and graded
//! in depth. Steady cases are solved in the moving frame, transient cases in time. Equations and
//! discretisation: [`heat::fe`].

use super::conduction::{Conduction, Cost, InterfaceLoad, SolveStats};
use super::elements;
use super::fields::fields;
use super::frame::Frame;
use super::interface::{Flow, HeatedBodies, Interface, both};
use super::names;
use super::setup::{resolution, resolution_across, section_key};
use super::summary::{Peak, hottest, hottest_in_contact};
use crate::capability::Capability;
use crate::effects::contact_conductance::HARDNESS;
use crate::{LOWER, UPPER};
use heat::columns::convolution::remove_negative_rounding;
use heat::columns::reconstruction::sum_of_means;
use heat::fe::block::{Block, Elements, Solver};
use heat::fe::body::Body;
use heat::fe::body_properties::BodyProperties;
use heat::fe::height::Height;
use heat::fe::section::{Below, Interpolation};
use heat::moving_source::ages::PastInterval;
use heat::moving_source::contact_basis::Shapes;
use heat::moving_source::half_space::{HalfSpace, Influence};
use heat::window::{Drive, Stage};
use numerics::convolution::Convolution;
use proto::accuracy::{Accuracy, Simplification};
use proto::configuration::{Mode, Refusal};
use proto::description::ModelSpec;
use proto::grid::{Grid, Volume};
use proto::model::StepError;
use std::cell::RefCell;
use std::io::{self, Read, Write};
use std::sync::Arc;

/// Optional capabilities of the model.
pub const CAPABILITIES: &[Capability] = &[
    Capability::Exchange,
    Capability::RiseIntegrals,
    Capability::VaryingProperties,
    Capability::FreeSurfaces,
    Capability::Volumes,
];

/// Returns the description of the model.
#[must_use]
pub fn spec() -> ModelSpec {
    let (consumes, provides) = fields();
    let mut own = vec![resolution(), resolution_across(), section_key()];
    own.extend(elements::keys());
    ModelSpec {
        name: names::FE.to_owned(),
        summary: "finite elements of both bodies, graded in depth, at any speed".to_owned(),
        source:
            "Lynch, Rice & Thomas, Numer. Math. 6 (1964) 185-199; Ingerman, Druskin & Knizhnerman, \
                 Comm. Pure Appl. Math. 53 (2000) 1039-1066"
                .to_owned(),
        steady: true,
        transient: true,
        rewinds: true,
        varies_step: true,
        consumes,
        provides,
        keys: own,
        accuracy: Accuracy { refinement: None, simplifications: vec![by_layers()] },
    }
}

/// Returns the error of the discretisation in depth; `thermal.resolution` does not set the number
/// of layers.
fn by_layers() -> Simplification {
    let source =
        "wheel-rail and falling-friction against model `moving-source` (docs/theory/fe.md)";
    Simplification::always("layers of elements in depth", 5e-5, source)
}

/// Error of steps in time of the passage of an element or of a window, under a flux that varies.
const STEPPING: f64 = 2e-2;
/// Time of a step per unknown, in modes and node by node, measured [s].
const SECONDS_PER_UNKNOWN: [f64; 2] = [2.5e-9, 20e-9];
/// Time per unknown of a steady solution in modes, with its peak and its penetration depth [s].
const SECONDS_PER_STEADY_UNKNOWN: f64 = 50e-9;
/// Approximate number of marches that a steady solution node by node takes, with those for constant
/// properties.
const MARCHES: f64 = 6.0;
/// Memory per unknown, in modes and node by node [byte]: two states in time, and the scratch arrays
/// of a step node by node.
const BYTES_PER_UNKNOWN: [u64; 2] = [16, 120];
/// Memory per element of the grid [byte].
const BYTES_PER_POINT: u64 = 200;
/// Number of unknowns from which on a second thread pays.
const WORTH: usize = 100_000;
/// Names of the grids of the bodies' elements, upper and lower.
const VOLUME_GRIDS: [&str; 2] = ["upper_elements", "lower_elements"];
/// Approximate number of time steps per window.
const STEPS: f64 = 5.0;

/// Finite-element model of both bodies.
pub struct FiniteElements {
    frame: Frame,
    bodies: [Body; 2],
    /// Half-space windows that stand for the bodies when the exchanged flux is corrected.
    windows: [PastInterval; 2],
    /// Interface between the surfaces; `None` if no heat flows between them.
    interface: Option<Interface>,
    /// Scratch buffers of the sums over the elements.
    row_sums: Vec<f64>,
    line: Vec<f64>,
    threads: usize,
    /// Operators for the rise integrals of both bodies, built on first use.
    heights: [Option<Height>; 2],
    /// Rises below the last requested row of a body, cached between queries.
    below: RefCell<Option<(Stage, usize, usize, Below)>>,
}

fn elements(frame: &Frame, body: usize) -> Elements {
    frame.elements.map_or_else(Elements::default, |elements| elements[body])
}

/// Lowest expected speed of a body [m/s], for which its elements are laid out.
fn expected_speed(frame: &Frame, body: usize) -> f64 {
    frame.slowest[body]
}

/// Returns true if both bodies are solved in the modes of their meshes.
fn is_modal(frame: &Frame) -> bool {
    elements(frame, LOWER).solver == Solver::Auto
        && frame.body_properties.iter().all(BodyProperties::is_constant)
}

/// Returns the number of unknowns of both bodies.
fn unknowns(frame: &Frame) -> usize {
    let of = |body: usize| {
        let material = &frame.scene.materials[body];
        let block =
            Block::new(&frame.grid, material, expected_speed(frame, body), &elements(frame, body));
        let columns = match (frame.mode, is_modal(frame)) {
            (Mode::Steady, true) => frame.grid.ni,
            (Mode::Steady, false) => frame.grid.ni + frame.behind(),
            (Mode::Transient, _) => block.columns.count(),
        };
        columns * block.across.len() * block.depth.len()
    };
    of(UPPER) + of(LOWER)
}

impl Conduction for FiniteElements {
    const TRANSIENT: bool = true;
    const SOLVES_STATIONARY_BODY: bool = true;
    const ELEMENTS: bool = true;
    const CAPABILITIES: &'static [Capability] = CAPABILITIES;
    const STATE_TAG: u8 = 4;

    fn check(frame: &Frame) -> Result<(), Refusal> {
        let by_pressure = frame.conductance.is_some_and(|law| law.hardness.is_some());
        if by_pressure && frame.mode == Mode::Transient {
            return Err(Refusal::new(
                HARDNESS,
                "finite elements in time support only a constant conductance",
                "remove the key, or write [thermal] model = \"moving-source\"",
            ));
        }
        [LOWER, UPPER].into_iter().try_for_each(|body| {
            let (material, speed) = (&frame.scene.materials[body], expected_speed(frame, body));
            elements::check_size(&elements(frame, body), &frame.grid, material, speed)
        })
    }

    fn new(frame: &Frame) -> Self {
        let body = |body: usize| {
            let (nature, speed) = (&frame.body_properties[body], expected_speed(frame, body));
            let steady = frame.mode == Mode::Steady;
            Body::new(&frame.grid, nature, speed, &elements(frame, body), steady)
        };
        let shapes = match frame.mode {
            Mode::Steady => Shapes::Elements,
            Mode::Transient => Shapes::Hats,
        };
        Self {
            bodies: [body(UPPER), body(LOWER)],
            windows: [PastInterval::steady(0.0); 2],
            interface: Interface::of(frame, shapes),
            row_sums: vec![0.0; frame.grid.nj],
            line: vec![0.0; frame.grid.ni],
            threads: if unknowns(frame) < WORTH { 1 } else { frame.threads },
            heights: [None, None],
            below: RefCell::new(None),
            frame: frame.clone(),
        }
    }

    fn cost(frame: &Frame) -> Cost {
        let (unknowns, points) = (unknowns(frame), frame.grid.points() as u64);
        let by_modes = is_modal(frame);
        let node_by_node = usize::from(!by_modes);
        let seconds = match (frame.mode, by_modes) {
            (Mode::Transient, _) => STEPS * SECONDS_PER_UNKNOWN[node_by_node],
            (Mode::Steady, true) => SECONDS_PER_STEADY_UNKNOWN,
            (Mode::Steady, false) => MARCHES * SECONDS_PER_UNKNOWN[node_by_node],
        };
        let bytes = match (frame.mode, by_modes) {
            (Mode::Steady, true) => 0,
            _ => BYTES_PER_UNKNOWN[node_by_node],
        };
        Cost {
            solve_seconds: seconds * unknowns as f64,
            memory_bytes: points * BYTES_PER_POINT + unknowns as u64 * bytes,
        }
    }

    fn remarks(frame: &Frame) -> Vec<String> {
        let of = |body: usize| {
            let material = &frame.scene.materials[body];
            let speed = expected_speed(frame, body);
            let block = Block::new(&frame.grid, material, speed, &elements(frame, body));
            let depth = block.depths();
            let layers = depth.len() - 1;
            format!(
                "elements of `{}`: {} along, {} across, {layers} layers from {:.2} µm to {:.3} mm of depth",
                frame.scene.names.0[body],
                frame.grid.ni + frame.behind(),
                block.across.len(),
                1e6 * depth[1],
                1e3 * depth[layers]
            )
        };
        vec![of(LOWER), of(UPPER)]
    }

    fn warnings(frame: &Frame) -> Vec<Refusal> {
        let of = |body: usize| elements::thick_layer(frame, body, expected_speed(frame, body));
        [LOWER, UPPER].into_iter().filter_map(of).collect()
    }

    fn left_out(frame: &Frame) -> Option<Simplification> {
        let missing = [LOWER, UPPER].map(|body| {
            let (material, speed) = (&frame.scene.materials[body], expected_speed(frame, body));
            elements(frame, body).missing_share(&frame.grid, material, speed)
        });
        let missing = missing[LOWER].max(missing[UPPER]);
        (frame.mode == Mode::Transient).then(|| Simplification {
            error: STEPPING + missing,
            ..Simplification::always(
                "steps in time, and the first layer in the shortest window",
                STEPPING,
                "moving ellipse and cold start against closed forms (docs/theory/fe.md)",
            )
        })
    }

    fn solve(
        &mut self,
        drive: &Drive,
        rub: &InterfaceLoad<'_>,
        rise: &mut [Vec<f64>; 2],
    ) -> Result<SolveStats, StepError> {
        let flux = rub.flux;
        let mut work = SolveStats::default();
        self.below.get_mut().take_if(|(stage, ..)| *stage == Stage::Trial);
        for (body, speed) in drive.speeds.into_iter().enumerate() {
            let share = drive.shares[body];
            let own = &mut self.bodies[body];
            own.means.iter_mut().zip(flux).for_each(|(mean, flux)| *mean = share * flux);
            let passed = own.motion.pass(drive.duration, speed);
            passed.map_err(|error| elements::no_solution(error, self.frame.mode))?;
            self.windows[body] = PastInterval { from: 0.0, to: drive.duration, way: 0.0, speed };
        }
        if let Some(mut interface) = self.interface.take() {
            for body in &mut self.bodies {
                body.motion.flux().reconstruct(&body.means);
            }
            work.heat = self.heat();
            let settled = interface.settle(&self.frame.grid.clone(), rub, self, rise);
            let settled = settled.and_then(|operations| {
                interface.audit(work.heat, self.heat())?;
                Ok(operations)
            });
            self.interface = Some(interface);
            work.operations += settled?;
            for (body, rise) in self.bodies.iter_mut().zip(rise) {
                body.motion.show(Interpolation::Bounded, rise);
            }
        } else {
            work.operations += self.solve_for(Flow::default(), Interpolation::Bounded, rise)?;
            work.heat = self.heat();
        }
        Ok(work)
    }

    fn rise_integral(&mut self, body: usize, integral: &mut [f64]) -> u64 {
        let Self { frame, bodies, heights, .. } = self;
        let grid = &frame.grid;
        let height = heights[body].get_or_insert_with(|| {
            let (material, speed) = (&frame.scene.materials[body], expected_speed(frame, body));
            let block = Block::new(grid, material, speed, &elements(frame, body));
            Height::new(grid, &block.depths(), &block.faces())
        });
        let rows: Vec<Below> =
            (0..grid.nj).map(|row| bodies[body].below(Stage::Trial, row)).collect();
        let (columns, first) =
            (grid.ni + height.behind, grid.x(0) - height.behind as f64 * grid.dx());
        let level = |layer: usize, rises: &mut [f64]| {
            for (below, rises) in rows.iter().zip(rises.chunks_exact_mut(columns)) {
                below.level(below.depths[layer], grid.dx(), first, rises);
            }
        };
        height.of(level, integral)
    }

    fn exchanged(&self) -> Option<f64> {
        self.interface.as_ref().map(Interface::flow)
    }

    fn accept(&mut self) {
        self.interface.iter_mut().for_each(Interface::accept);
        self.bodies.iter_mut().for_each(|body| body.motion.accept());
        let trial = self.below.get_mut().take_if(|(stage, ..)| *stage == Stage::Trial);
        *self.below.get_mut() =
            trial.map(|(_, body, row, below)| (Stage::Accepted, body, row, below));
    }

    fn section(&mut self, stage: Stage, body: usize, row: usize, depths: &[f64], rise: &mut [f64]) {
        let (h, behind) = (self.frame.grid.dx(), self.frame.behind());
        let first = self.frame.grid.x(0) - behind as f64 * h;
        let scale = 2.0 * self.frame.scene.materials[body].diffusivity().sqrt();
        self.on_row(stage, body, row, |below| {
            let levels = rise.chunks_exact_mut(self.frame.grid.ni + behind);
            for (depth, rise) in depths.iter().zip(levels) {
                below.level(depth * scale, h, first, rise);
            }
        });
        if self.bodies[body].motion.is_heated(stage) {
            remove_negative_rounding(rise);
        }
    }

    fn rise_at(&self, body: usize, row: usize, x: f64, depth: f64) -> f64 {
        let scale = 2.0 * self.frame.scene.materials[body].diffusivity().sqrt();
        self.on_row(Stage::Accepted, body, row, |below| below.at(x, depth * scale))
    }

    /// Returns the grid of the boxes that the nodes represent in the rows of the heat flux. They
    /// lie between the faces of columns, rows and layers, in ascending z.
    fn volume(frame: &Frame, body: usize) -> Option<Grid> {
        let (grid, material) = (&frame.grid, &frame.scene.materials[body]);
        let block = Block::new(grid, material, expected_speed(frame, body), &elements(frame, body));
        let faces = |first: f64, width: f64, count: usize| -> Vec<f64> {
            (0..=count).map(|face| first + (face as f64 - 0.5) * width).collect()
        };
        let behind = frame.behind();
        let x = faces(grid.x(0) - behind as f64 * grid.dx(), grid.dx(), grid.ni + behind);
        let y = faces(grid.y(0), grid.dy(), grid.nj);
        let mut z = block.faces();
        if body == LOWER {
            z = z.iter().rev().map(|depth| 0.0 - depth).collect();
        }
        Some(Grid::volume(VOLUME_GRIDS[body], Volume::rectilinear([&x, &y, &z])))
    }

    fn rises_in(&self, body: usize, rises: &mut [f64]) {
        let (grid, behind) = (&self.frame.grid, self.frame.behind());
        let (h, columns) = (grid.dx(), grid.ni + behind);
        let first = grid.x(0) - behind as f64 * h;
        for row in 0..grid.nj {
            let below = self.bodies[body].below(Stage::Accepted, row);
            let layers = below.depths.len();
            for (layer, depth) in below.depths.iter().enumerate() {
                let k = if body == LOWER { layers - 1 - layer } else { layer };
                let start = (k * grid.nj + row) * columns;
                below.level(*depth, h, first, &mut rises[start..start + columns]);
            }
        }
        if self.bodies[body].motion.is_heated(Stage::Accepted) {
            remove_negative_rounding(rises);
        }
    }

    fn peak(&self, body: usize, rise: &[f64]) -> Option<Peak> {
        let rise_at = |row: usize, x: f64| self.rise_at(body, row, x, 0.0);
        match &self.interface {
            Some(interface) => {
                hottest_in_contact(&self.frame.grid, rise, &interface.touched, rise_at)
            }
            None => hottest(&self.frame.grid, rise, rise_at),
        }
    }

    fn save(&self, into: &mut dyn Write) -> io::Result<()> {
        self.interface.iter().try_for_each(|interface| interface.save(into))?;
        self.bodies.iter().try_for_each(|body| body.motion.save(into))
    }

    fn restore(&mut self, from: &mut dyn Read) -> io::Result<()> {
        self.below.get_mut().take();
        let points = self.frame.grid.points();
        let touching =
            self.interface.as_ref().map(|_| Interface::read(from, points)).transpose()?;
        self.bodies.iter_mut().try_for_each(|body| body.motion.read(from))?;
        self.bodies.iter_mut().for_each(|body| body.motion.accept());
        self.interface.iter_mut().zip(touching).for_each(|(own, read)| own.touched = read);
        Ok(())
    }
}

impl HeatedBodies for FiniteElements {
    fn warm(&mut self, flow: Flow, rise: &mut [Vec<f64>; 2]) -> Result<u64, StepError> {
        self.solve_for(flow, Interpolation::Cubic, rise)
    }

    fn windows(&self) -> [PastInterval; 2] {
        self.windows
    }

    fn influences(&self, convolution: &mut Convolution) -> [Arc<Influence>; 2] {
        [UPPER, LOWER].map(|body| {
            let material = &self.frame.scene.materials[body];
            let (diffusivity, effusivity) = (material.diffusivity(), material.effusivity());
            let (grid, window) = (&self.frame.grid, self.windows[body]);
            let half_space = HalfSpace::new(grid, diffusivity, effusivity, window);
            Arc::new(half_space.influence(convolution))
        })
    }
}

impl FiniteElements {
    /// Sums over the elements of the fluxes into the bodies [W/m²].
    fn heat(&mut self) -> [f64; 2] {
        let Self { bodies, row_sums, line, .. } = self;
        bodies.each_mut().map(|body| sum_of_means(body.motion.flux(), row_sums, line))
    }

    /// Solves both bodies under their shares of the friction heat and the exchanged flux, and
    /// writes their surface rises. Returns the operation count.
    fn solve_for(
        &mut self,
        flow: Flow,
        between: Interpolation,
        rise: &mut [Vec<f64>; 2],
    ) -> Result<u64, StepError> {
        let mode = self.frame.mode;
        both(self.threads, &mut self.bodies, rise, |index, body, rise| {
            let Body { means, motion, .. } = body;
            motion.flux().reconstruct(means);
            flow.add(index, motion.flux());
            let warmed = motion.warm();
            let work = warmed.map_err(|error| elements::no_solution(error, mode))?;
            motion.show(between, rise);
            Ok(work)
        })
    }

    /// Evaluates `ask` on the rises below a row, which are cached.
    fn on_row<A>(&self, stage: Stage, body: usize, row: usize, ask: impl FnOnce(&Below) -> A) -> A {
        let mut kept = self.below.borrow_mut();
        let key = (stage, body, row);
        if !kept.as_ref().is_some_and(|(stage, body, row, _)| (*stage, *body, *row) == key) {
            *kept = Some((stage, body, row, self.bodies[body].below(stage, row)));
        }
        let (.., below) = kept.as_ref().expect("it has just been made");
        ask(below)
    }
}
