//! Modal solver of a body of constant properties in time ([`super::transient`]).

use super::basis::Basis;
use super::body_solver::{BodySolver, Rises, SolverInput};
use super::error::SolveError;
use super::mesh_advection::{MeshAdvection, Position};
use super::scheme::Scheme;
use super::section::{BESIDE, Interpolation, place};
use super::steady;
use super::transient::{Mesh, ModeFlux, ModeState, Scratch};
use crate::columns::convolution::remove_negative_rounding;
use crate::columns::reconstruction::Flux;
use crate::window::Stage;
use grids::state::{read_bytes, read_numbers, write_numbers};
use std::io::{self, Read, Write};

/// Solver of one body.
pub struct TransientModal {
    mesh: Mesh,
    scheme: Scheme,
    /// Longest step [s].
    longest: f64,
    creep: MeshAdvection,
    flux: Flux,
    trial: State,
    accepted: State,
    /// Surface values of the modes across, and of the rows.
    surfaces: Vec<f64>,
    rows: Vec<f64>,
    scratch: Scratch,
    modes: steady::Scratch,
}

/// State of the temperatures of a mesh.
#[derive(Clone, Debug, PartialEq)]
struct State {
    amplitudes: Vec<f64>,
    /// Amplitudes one step before and the flux of that step, for a scheme that needs them.
    before: Vec<f64>,
    fluxes: Vec<f64>,
    position: Position,
    /// Whether no window has had a negative flux.
    heated: bool,
}

impl TransientModal {
    /// Creates the solver of a cold body.
    #[must_use]
    pub fn new(given: SolverInput) -> Self {
        let SolverInput { grid, nature, block, elements } = given;
        let basis = Basis::new(&block.across, &block.depth, block.first_row, grid.nj);
        let mesh = Mesh::new(basis, block.columns, &nature.material);
        let accepted = State::cold(&mesh, elements.scheme);
        let count = block.columns.count();
        Self {
            scheme: elements.scheme,
            longest: elements.step,
            creep: MeshAdvection::default(),
            flux: Flux::zero(grid.ni, grid.nj),
            trial: accepted.clone(),
            accepted,
            surfaces: vec![0.0; mesh.basis.across.len() * count],
            rows: vec![0.0; grid.nj * count],
            scratch: Scratch::default(),
            modes: steady::Scratch::default(),
            mesh,
        }
    }

    /// Advances all modes through the window and writes the surface. Returns the work.
    fn march(&mut self) -> u64 {
        let Self { mesh, creep, flux, trial, accepted, modes, .. } = self;
        let (size, count) = (mesh.mode_size(), mesh.columns.count());
        if creep.fresh {
            trial.chill();
        } else {
            trial.copy(accepted);
        }
        trial.heated &= flux.is_heating();
        let remembers = !trial.before.is_empty();
        for (mode, surface) in self.surfaces.chunks_exact_mut(count).enumerate() {
            modes.project(&mesh.basis, mode, flux);
            let of = |size: usize| mode * size..(mode + 1) * size;
            let if_any = |size: usize| if remembers { of(size) } else { 0..0 };
            let state = ModeState {
                now: &mut trial.amplitudes[of(size)],
                before: &mut trial.before[if_any(size)],
                flux: &mut trial.fluxes[if_any(count)],
            };
            let flux = ModeFlux { middle: &modes.middle, edge: &modes.edge };
            mesh.window(mode, &creep.steps, flux, state, &mut self.scratch, surface);
        }
        trial.position = creep.position;
        if trial.is_cold() {
            trial.position.steps = 0;
        }
        (creep.steps.len() * trial.amplitudes.len()) as u64
    }

    fn state(&self, stage: Stage) -> &State {
        match stage {
            Stage::Trial => &self.trial,
            Stage::Accepted => &self.accepted,
        }
    }
}

impl BodySolver for TransientModal {
    fn pass(&mut self, duration: f64, speed: f64) -> Result<(), SolveError> {
        let columns = self.mesh.columns;
        let window = [duration, speed / columns.h, self.longest];
        self.creep.plan(&self.accepted.position, window, columns.count(), self.scheme);
        Ok(())
    }

    fn warm(&mut self) -> Result<u64, SolveError> {
        Ok(self.march())
    }

    fn show(&mut self, between: Interpolation, rise: &mut [f64]) {
        let (basis, columns) = (&self.mesh.basis, self.mesh.columns);
        self.rows.fill(0.0);
        basis.add_modes(columns.count(), &self.surfaces, &mut self.rows);
        let rows = self.rows.chunks_exact(columns.count());
        for (row, rise) in rows.zip(rise.chunks_exact_mut(columns.heated)) {
            place(&row[columns.behind - BESIDE..], self.trial.position.front, between, rise);
        }
        if self.trial.heated && between == Interpolation::Bounded {
            remove_negative_rounding(rise);
        }
    }

    fn flux(&mut self) -> &mut Flux {
        &mut self.flux
    }

    fn accept(&mut self) {
        std::mem::swap(&mut self.trial, &mut self.accepted);
    }

    fn below(&self, stage: Stage, row: usize) -> Rises {
        let state = self.state(stage);
        let amplitudes = self.mesh.below(&state.amplitudes, row);
        let behind = self.mesh.columns.behind as f64 - state.position.front;
        Rises { values: self.mesh.basis.rises(&amplitudes), behind, dense: 1 }
    }

    fn is_heated(&self, stage: Stage) -> bool {
        self.state(stage).heated
    }

    fn save(&self, into: &mut dyn Write) -> io::Result<()> {
        self.accepted.save(into)
    }

    fn read(&mut self, from: &mut dyn Read) -> io::Result<()> {
        self.trial.restore(from)
    }
}

impl State {
    fn cold(mesh: &Mesh, scheme: Scheme) -> Self {
        let modes = mesh.basis.across.len();
        let (size, count) = (mesh.mode_size(), mesh.columns.count());
        let remembers = if scheme == Scheme::Bdf2 { modes } else { 0 };
        Self {
            amplitudes: vec![0.0; modes * size],
            before: vec![0.0; remembers * size],
            fluxes: vec![0.0; remembers * count],
            position: Position::default(),
            heated: true,
        }
    }

    /// Returns whether the body has received no heat yet.
    fn is_cold(&self) -> bool {
        self.amplitudes.iter().all(|amplitude| *amplitude == 0.0)
    }

    fn chill(&mut self) {
        for values in [&mut self.amplitudes, &mut self.before, &mut self.fluxes] {
            values.fill(0.0);
        }
        self.heated = true;
    }

    fn copy(&mut self, other: &Self) {
        self.amplitudes.copy_from_slice(&other.amplitudes);
        self.before.copy_from_slice(&other.before);
        self.fluxes.copy_from_slice(&other.fluxes);
        self.heated = other.heated;
    }

    fn save(&self, into: &mut dyn Write) -> io::Result<()> {
        into.write_all(&[u8::from(self.heated)])?;
        self.position.save(into)?;
        write_numbers(into, self.amplitudes.iter().chain(&self.before).chain(&self.fluxes))
    }

    fn restore(&mut self, from: &mut dyn Read) -> io::Result<()> {
        let [mark] = read_bytes(from)?;
        self.heated = mark == 1;
        self.position = Position::restore(from)?;
        let own = self.amplitudes.iter_mut().chain(&mut self.before).chain(&mut self.fluxes);
        read_numbers(from, own)
    }
}
