//! Model `periodic`: conduction into half-spaces under a flux that is periodic along x and y, in
//! time, at any speed including rest. Equations: [`heat::periodic`].
//!
//! Both surfaces are in contact permanently, or return to it periodically. The partition
//! `effusivity` therefore depends on the effusivities alone, which gives both surfaces the same
//! mean temperature at any speeds.

use super::conduction::{Conduction, Cost, InterfaceLoad, SolveStats};
use super::fields::fields;
use super::frame::Frame;
use super::names;
use super::setup::section_key;
use super::summary::{Peak, hottest};
use crate::capability::Capability;
use crate::{LOWER, UPPER};
use heat::periodic::half_space::{Instant, PeriodicHalfSpace};
use heat::window::{Drive, Stage};
use numerics::convolution::Complex64;
use numerics::waves::Waves;
use proto::accuracy::{Accuracy, Simplification};
use proto::configuration::{Mode, Refusal};
use proto::description::ModelSpec;
use proto::grid::Structured;
use proto::model::StepError;
use proto::state::{read_numbers, write_numbers};
use std::cell::RefCell;
use std::f64::consts::TAU;
use std::io::{self, Read, Write};

/// Optional capabilities of the model.
pub const CAPABILITIES: &[Capability] = &[Capability::RiseIntegrals];

/// Returns the description of the model.
#[must_use]
pub fn spec() -> ModelSpec {
    let (consumes, provides) = fields();
    ModelSpec {
        name: names::PERIODIC.to_owned(),
        summary: "heat conduction in half-spaces under a flux that repeats, in time".to_owned(),
        source: "Carslaw & Jaeger, Conduction of Heat in Solids, 2.4 and 10.7".to_owned(),
        steady: false,
        transient: true,
        rewinds: true,
        varies_step: true,
        consumes,
        provides,
        keys: vec![section_key()],
        accuracy: Accuracy { refinement: None, simplifications: vec![by_quadrature()] },
    }
}

/// Returns the quadrature error. The flux has an error of its own, that of the grid of another
/// participant.
fn by_quadrature() -> Simplification {
    let source = "closed forms in the tests of periodic (docs/theory/periodic.md)";
    Simplification::always("wave numbers in depth by Gauss's rule", 1e-8, source)
}

/// Approximate time of a solve per element of the grid, both bodies [s].
const SECONDS_PER_POINT: f64 = 2e-6;
/// Memory per element of the grid for the states of both bodies [byte].
const BYTES_PER_POINT: u64 = 2 * 2 * 190 * 8;

/// Model of half-spaces under a periodic heat flux.
pub struct Periodic {
    grid: Structured,
    diffusivities: [f64; 2],
    bodies: [PeriodicHalfSpace; 2],
    waves: RefCell<Waves>,
    /// Fourier coefficients of the surface rises in the last solve.
    surfaces: [Vec<Complex64>; 2],
    /// Fourier coefficients of the surface rises in the accepted state.
    accepted: [Vec<Complex64>; 2],
    flux: Vec<Complex64>,
    work: Vec<Complex64>,
    field: Vec<f64>,
}

impl Conduction for Periodic {
    const TRANSIENT: bool = true;
    const SOLVES_STATIONARY_BODY: bool = true;
    const REPEATS: bool = true;
    const CAPABILITIES: &'static [Capability] = CAPABILITIES;
    const STATE_TAG: u8 = 5;

    fn new(frame: &Frame) -> Self {
        let grid = frame.grid;
        let waves = Waves::new(grid.ni, grid.nj);
        let bases = [grid.ni as f64 * grid.dx(), grid.nj as f64 * grid.dy()].map(|side| TAU / side);
        let numbers = |wave: usize| {
            let (k, l) = waves.numbers(wave);
            let (along, across) = (f64::from(k) * bases[0], f64::from(l) * bases[1]);
            [along, along.hypot(across)]
        };
        let numbers: Vec<[f64; 2]> = (0..waves.count()).map(numbers).collect();
        let cold = vec![Complex64::default(); waves.count()];
        let body =
            |body: usize| PeriodicHalfSpace::new(frame.scene.materials[body], numbers.clone());
        Self {
            grid,
            diffusivities: frame.scene.materials.map(|material| material.diffusivity()),
            bodies: [body(UPPER), body(LOWER)],
            waves: RefCell::new(waves),
            surfaces: [cold.clone(), cold.clone()],
            accepted: [cold.clone(), cold.clone()],
            flux: cold.clone(),
            work: cold,
            field: vec![0.0; grid.points()],
        }
    }

    fn check(frame: &Frame) -> Result<(), Refusal> {
        if frame.mode == Mode::Steady {
            return Err(Refusal::new(
                "time.mode",
                "surfaces that are heated everywhere warm up without end: model `periodic` supports only transient cases",
                "write mode = \"transient\", a window and an end",
            ));
        }
        match frame.grid.ni.is_multiple_of(2) {
            true => Ok(()),
            false => Err(Refusal::new(
                "mech.resolution",
                format!(
                    "model `periodic` needs an even number of elements along x, not {}",
                    frame.grid.ni
                ),
                "write an even number",
            )),
        }
    }

    fn cost(frame: &Frame) -> Cost {
        let points = frame.grid.points();
        Cost {
            solve_seconds: points as f64 * SECONDS_PER_POINT,
            memory_bytes: points as u64 * BYTES_PER_POINT,
        }
    }

    fn left_out(_: &Frame) -> Option<Simplification> {
        None
    }

    fn solve(
        &mut self,
        drive: &Drive,
        rub: &InterfaceLoad<'_>,
        rise: &mut [Vec<f64>; 2],
    ) -> Result<SolveStats, StepError> {
        let waves = self.waves.get_mut();
        waves.of(rub.flux, &mut self.flux);
        let sum: f64 = rub.flux.iter().sum();
        let mut work = SolveStats::default();
        for (at, body) in self.bodies.iter_mut().enumerate() {
            let share = drive.shares[at];
            work.operations += body.begin(drive.duration, drive.speeds[at]);
            for (own, flux) in body.trial.window.flux.iter_mut().zip(&self.flux) {
                *own = share * flux;
            }
            body.surface(&mut self.surfaces[at]);
            waves.sum(&self.surfaces[at], &mut rise[at]);
            work.heat[at] = share * sum;
            work.operations += self.flux.len() as u64;
        }
        Ok(work)
    }

    fn rise_integral(&mut self, body: usize, integral: &mut [f64]) -> u64 {
        self.bodies[body].integral(&mut self.work);
        self.waves.get_mut().sum(&self.work, integral);
        self.work.len() as u64
    }

    fn accept(&mut self) {
        self.bodies.iter_mut().for_each(PeriodicHalfSpace::accept);
        self.accepted.clone_from(&self.surfaces);
    }

    fn section(&mut self, stage: Stage, body: usize, row: usize, depths: &[f64], rise: &mut [f64]) {
        let columns = self.grid.ni;
        for (depth, rise) in depths.iter().zip(rise.chunks_exact_mut(columns)) {
            let waves = self.below(stage, body, *depth);
            self.waves.get_mut().sum(&waves, &mut self.field);
            rise.copy_from_slice(&self.field[row * columns..(row + 1) * columns]);
        }
    }

    fn rise_at(&self, body: usize, row: usize, x: f64, depth: f64) -> f64 {
        let i = (x - self.grid.x(0)) / self.grid.dx();
        let waves = self.waves.borrow();
        if depth == 0.0 {
            return waves.at(&self.accepted[body], i, row as f64);
        }
        waves.at(&self.below(Stage::Accepted, body, depth), i, row as f64)
    }

    fn peak(&self, body: usize, rise: &[f64]) -> Option<Peak> {
        hottest(&self.grid, rise, |row, x| self.rise_at(body, row, x, 0.0))
    }

    fn save(&self, into: &mut dyn Write) -> io::Result<()> {
        for (body, surface) in self.bodies.iter().zip(&self.accepted) {
            let Instant { start, window } = &body.accepted;
            write_numbers(into, [&window.duration, &window.speed])?;
            for waves in [start, &window.flux, surface] {
                write_numbers(into, waves.iter().flat_map(|wave| [&wave.re, &wave.im]))?;
            }
        }
        Ok(())
    }

    fn restore(&mut self, from: &mut dyn Read) -> io::Result<()> {
        let mut restored =
            [&self.bodies[UPPER].accepted, &self.bodies[LOWER].accepted].map(Instant::clone);
        let mut surfaces = self.accepted.clone();
        for (Instant { start, window }, surface) in restored.iter_mut().zip(&mut surfaces) {
            read_numbers(from, [&mut window.duration, &mut window.speed])?;
            for waves in [start, &mut window.flux, surface] {
                read_numbers(from, waves.iter_mut().flat_map(|wave| [&mut wave.re, &mut wave.im]))?;
            }
        }
        self.accepted = surfaces;
        for (body, restored) in self.bodies.iter_mut().zip(restored) {
            body.accepted = restored;
            body.go_on();
        }
        Ok(())
    }
}

impl Periodic {
    /// Returns the Fourier coefficients of the rise at a depth c = z/(2√κ) [√s].
    fn below(&self, stage: Stage, body: usize, depth: f64) -> Vec<Complex64> {
        let depth = 2.0 * depth * self.diffusivities[body].sqrt();
        let body = &self.bodies[body];
        let state = if stage == Stage::Trial { &body.trial } else { &body.accepted };
        body.below(state, depth)
    }
}
