//! Modal solver of a body of constant properties in steady motion ([`super::steady`]). The state
//! consists of the flux and the speed.

use super::basis::Basis;
use super::block::Passages;
use super::body_solver::{BodySolver, Rises, SolverInput};
use super::error::SolveError;
use super::section::Interpolation;
use super::steady::{Scratch, SteadyMotion};
use crate::Material;
use crate::columns::convolution::remove_negative_rounding;
use crate::columns::reconstruction::Flux;
use crate::window::Stage;
use grids::Structured;
use grids::state::{read_numbers, write_numbers};
use std::io::{self, Read, Write};

/// Solver of one body.
pub struct SteadyModal {
    grid: Structured,
    material: Material,
    behind: usize,
    passages: Option<Passages>,
    basis: Basis,
    prepared: Option<(f64, SteadyMotion)>,
    /// Speed [m/s] and flux of the last solve and of the accepted solve.
    speed: f64,
    flux: Flux,
    accepted: (f64, Flux),
    surfaces: Vec<f64>,
    scratch: Scratch,
}

impl SteadyModal {
    /// Creates the solver of a cold body.
    #[must_use]
    pub fn new(given: SolverInput) -> Self {
        let SolverInput { grid, nature, block, elements } = given;
        let basis = Basis::new(&block.across, &block.depth, block.first_row, grid.nj);
        let flux = Flux::zero(grid.ni, grid.nj);
        Self {
            grid: *grid,
            material: nature.material,
            behind: elements.behind(grid),
            passages: elements.passages,
            surfaces: vec![0.0; basis.across.len() * grid.ni],
            basis,
            prepared: None,
            // Any speed is valid while the flux is zero.
            speed: 1.0,
            accepted: (1.0, flux.clone()),
            flux,
            scratch: Scratch::default(),
        }
    }

    fn prepare(&self, speed: f64) -> SteadyMotion {
        let (columns, h) = (self.grid.ni, self.grid.dx());
        SteadyMotion::new(&self.basis, &self.material, columns, h, speed, self.passages)
    }
}

impl BodySolver for SteadyModal {
    fn pass(&mut self, _: f64, speed: f64) -> Result<(), SolveError> {
        self.speed = speed;
        if self.prepared.as_ref().is_none_or(|(of, _)| *of != speed) {
            self.prepared = Some((speed, self.prepare(speed)));
        }
        Ok(())
    }

    fn warm(&mut self) -> Result<u64, SolveError> {
        let Self { basis, prepared, flux, scratch, .. } = self;
        let (_, steady) = prepared.as_ref().expect("the body has passed");
        let columns = self.grid.ni;
        for (mode, surface) in self.surfaces.chunks_exact_mut(columns).enumerate() {
            steady.surface(basis, mode, flux, scratch, surface);
        }
        Ok((basis.across.len() * basis.size() * columns) as u64)
    }

    fn show(&mut self, _: Interpolation, rise: &mut [f64]) {
        rise.fill(0.0);
        self.basis.add_modes(self.grid.ni, &self.surfaces, rise);
        if self.flux.is_heating() {
            remove_negative_rounding(rise);
        }
    }

    fn flux(&mut self) -> &mut Flux {
        &mut self.flux
    }

    fn accept(&mut self) {
        self.accepted.0 = self.speed;
        std::mem::swap(&mut self.accepted.1, &mut self.flux);
    }

    fn below(&self, stage: Stage, row: usize) -> Rises {
        let (speed, flux) = match stage {
            Stage::Trial => (self.speed, &self.flux),
            Stage::Accepted => (self.accepted.0, &self.accepted.1),
        };
        let amplitudes = match &self.prepared {
            Some((of, steady)) if *of == speed => steady.below(&self.basis, flux, row, self.behind),
            _ => self.prepare(speed).below(&self.basis, flux, row, self.behind),
        };
        Rises { values: self.basis.rises(&amplitudes), behind: self.behind as f64 + 0.5, dense: 2 }
    }

    fn is_heated(&self, stage: Stage) -> bool {
        match stage {
            Stage::Trial => self.flux.is_heating(),
            Stage::Accepted => self.accepted.1.is_heating(),
        }
    }

    fn save(&self, into: &mut dyn Write) -> io::Result<()> {
        write_numbers(into, &[self.accepted.0])?;
        self.accepted.1.save(into)
    }

    fn read(&mut self, from: &mut dyn Read) -> io::Result<()> {
        read_numbers(from, [&mut self.speed])?;
        self.flux.restore(from)
    }
}
