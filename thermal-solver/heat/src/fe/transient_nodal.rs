//! Nodal solver of a body in time ([`super::conductor`]), for properties over temperature and free
//! surfaces that exchange heat. The mesh, its heat input, its shifts and the output of its surface
//! are those of [`super::transient`].

use super::block::Block;
use super::body_properties::BodyProperties;
use super::body_solver::{BodySolver, Rises, SolverInput};
use super::conductor::{Conductor, NewtonStats, Request, Workspace};
use super::error::SolveError;
use super::mesh::Axis;
use super::mesh_advection::{MeshAdvection, Position, Step};
use super::scheme::Scheme;
use super::section::{BESIDE, Interpolation, place};
use super::transient::{Columns, ModeFlux};
use super::varying::{conductor, extremes};
use crate::columns::reconstruction::{Flux, FluxRow};
use crate::window::Stage;
use grids::state::{read_numbers, write_numbers};
use std::io::{self, Read, Write};

/// State of a mesh that moves with the material, as Θ [W/m].
#[derive(Clone, Debug, PartialEq)]
struct State {
    now: Vec<f64>,
    /// Θ one step ago, at the same material.
    last: Vec<f64>,
    /// Means of the flux at the columns in the last step, for a scheme that needs them [W/m²].
    fluxes: Vec<f64>,
    position: Position,
}

/// Solver of one body.
pub struct TransientNodal {
    nature: BodyProperties,
    flux: Flux,
    /// Longest step [s].
    longest: f64,
    block: Conductor,
    columns: Columns,
    first_row: usize,
    rows: usize,
    widths: Vec<f64>,
    scheme: Scheme,
    creep: MeshAdvection,
    trial: State,
    accepted: State,
    memory: Workspace,
    /// Θ one and two steps ago.
    old: [Vec<f64>; 2],
    means: Vec<f64>,
    surface: Vec<f64>,
    free: Vec<bool>,
}

impl TransientNodal {
    /// Creates the solver of a cold body.
    #[must_use]
    pub fn new(given: SolverInput) -> Self {
        let Block { columns, across, depth, first_row, .. } = given.block;
        let along = Axis::middles(0.0, vec![columns.h; columns.count()]).ending(columns.ends);
        let (block, memory) = conductor(given, [&along, across, depth]);
        let (size, scheme, rows) = (block.nodes(), given.elements.scheme, given.grid.nj);
        let two = scheme == Scheme::Bdf2;
        let cold = State {
            now: vec![0.0; size],
            last: vec![0.0; size],
            fluxes: vec![0.0; if two { columns.count() * rows } else { 0 }],
            position: Position::default(),
        };
        let places = columns.count() * across.len();
        Self {
            nature: given.nature.clone(),
            flux: Flux::zero(given.grid.ni, given.grid.nj),
            longest: given.elements.step,
            block,
            columns: *columns,
            first_row: *first_row,
            rows,
            widths: across.widths.clone(),
            scheme,
            creep: MeshAdvection::default(),
            trial: cold.clone(),
            accepted: cold,
            memory,
            old: [vec![0.0; size], vec![0.0; if two { size } else { 0 }]],
            means: vec![0.0; columns.count()],
            surface: vec![0.0; places],
            free: vec![true; places],
        }
    }

    /// Advances the body through the window. Returns the effort of the steps.
    fn go(&mut self) -> NewtonStats {
        self.begin();
        let mut all = NewtonStats::default();
        for index in 0..self.creep.steps.len() {
            let step = self.creep.steps[index];
            self.receive(&step);
            self.shift(&step);
            let request = Request {
                duration: step.duration,
                by: step.by,
                surface: &self.surface,
                free: &self.free,
                inside: &[],
            };
            let old = self.old.each_ref().map(Vec::as_slice);
            all.add(self.block.step(&request, &mut self.trial.now, old, &mut self.memory));
            std::mem::swap(&mut self.trial.last, &mut self.old[0]);
        }
        self.trial.position = self.creep.position;
        if self.trial.now.iter().all(|value| *value == 0.0) {
            self.trial.position.steps = 0;
        }
        all
    }

    fn begin(&mut self) {
        let Self { trial, accepted, creep, .. } = self;
        let pairs = [
            (&mut trial.now, &accepted.now),
            (&mut trial.last, &accepted.last),
            (&mut trial.fluxes, &accepted.fluxes),
        ];
        for (own, others) in pairs {
            if creep.fresh {
                own.fill(0.0);
            } else {
                own.copy_from_slice(others);
            }
        }
    }

    /// Computes the heat that the surface nodes receive in a step, and the nodes that are free.
    fn receive(&mut self, step: &Step) {
        let columns = self.columns.count();
        for row in 0..self.rows {
            let of = row * columns..(row + 1) * columns;
            let FluxRow { middle, edge, support } = self.flux.row(row);
            let edge = &edge[..self.columns.heated + 1];
            ModeFlux { middle, edge }.means(step.middle, self.columns.behind, &mut self.means);
            let node = (self.first_row + row) * columns;
            let surface = &mut self.surface[node..node + columns];
            let remembered =
                of.start.min(self.trial.fluxes.len())..of.end.min(self.trial.fluxes.len());
            step.receive(&self.means, &mut self.trial.fluxes[remembered], surface);
            let area = self.columns.h * self.widths[self.first_row + row];
            surface.iter_mut().for_each(|heat| *heat *= area);
            // A node belongs to the contact if it is there in the middle of the step.
            let front = step.middle;
            let touching = support.0 as f64..support.1 as f64;
            for (column, free) in self.free[node..node + columns].iter_mut().enumerate() {
                let at = column as f64 - self.columns.behind as f64 + front + 0.5;
                *free = !touching.contains(&at);
            }
        }
    }

    /// Shifts both states with the material, and replaces the newest by a guess: the change at the
    /// same place in the last step is repeated.
    fn shift(&mut self, step: &Step) {
        let columns = self.columns.count();
        let shift = step.shifts[0];
        let (kept, over) = (columns - shift, 1.0 / step.over_last);
        let [old, older] = &mut self.old;
        for start in (0..self.trial.now.len()).step_by(columns) {
            let now = &mut self.trial.now[start..start + columns];
            let last = &self.trial.last[start..start + columns];
            let old = &mut old[start..start + columns];
            old[..kept].copy_from_slice(&now[shift..]);
            old[kept..].fill(0.0);
            if let Some(older) = older.get_mut(start..start + columns) {
                older[..kept].copy_from_slice(&last[shift..]);
                older[kept..].fill(0.0);
            }
            for ((now, last), old) in now.iter_mut().zip(last).zip(old) {
                *now = *old + over * (*now - last);
            }
        }
    }

    fn state(&self, stage: Stage) -> &State {
        match stage {
            Stage::Trial => &self.trial,
            Stage::Accepted => &self.accepted,
        }
    }
}

impl BodySolver for TransientNodal {
    fn pass(&mut self, duration: f64, speed: f64) -> Result<(), SolveError> {
        let window = [duration, speed / self.columns.h, self.longest];
        self.creep.plan(&self.accepted.position, window, self.columns.count(), self.scheme);
        Ok(())
    }

    fn warm(&mut self) -> Result<u64, SolveError> {
        let took = self.go();
        self.nature.check(extremes(&self.trial.now, &self.block.law), took)
    }

    fn show(&mut self, between: Interpolation, rise: &mut [f64]) {
        let columns = self.columns.count();
        for (row, rise) in rise.chunks_exact_mut(self.columns.heated).enumerate() {
            let start = (self.first_row + row) * self.block.counts[2] * columns;
            let surface = &self.trial.now[start..start + columns];
            for (mean, value) in self.means.iter_mut().zip(surface) {
                *mean = self.block.law.rise(*value);
            }
            let means = &self.means[self.columns.behind - BESIDE..];
            place(means, self.trial.position.front, between, rise);
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
        let size = self.block.counts[2] * self.columns.count();
        let start = (self.first_row + row) * size;
        let rise = |value: &f64| self.block.law.rise(*value);
        let values = state.now[start..start + size].iter().map(rise).collect();
        Rises { values, behind: self.columns.behind as f64 - state.position.front, dense: 1 }
    }

    /// Always false: rises below zero are errors of the iterations, not rounding.
    fn is_heated(&self, _: Stage) -> bool {
        false
    }

    fn save(&self, into: &mut dyn Write) -> io::Result<()> {
        let State { now, last, fluxes, position } = &self.accepted;
        position.save(into)?;
        write_numbers(into, now.iter().chain(last).chain(fluxes))
    }

    fn read(&mut self, from: &mut dyn Read) -> io::Result<()> {
        let State { now, last, fluxes, position } = &mut self.trial;
        *position = Position::restore(from)?;
        read_numbers(from, now.iter_mut().chain(last).chain(fluxes))
    }
}
