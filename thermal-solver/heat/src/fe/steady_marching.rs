//! Nodal solver of a body in steady motion ([`super::conductor`]), for properties over temperature
//! and free surfaces that exchange heat.
//!
//! Every slice of material across the motion has the same past. One slice is followed from the
//! leading edge downstream, from column to column of the moving frame, in as many time steps. This
//! gives the solution without conduction along. Conduction along is then a source in every column,
//! computed from the slices of the previous sweep, and the march is repeated until the slices no
//! longer change. Each sweep reduces the error by about four times the Fourier number κ/(Vh) of the
//! passage of an element. A case with a Fourier number above [`SLOW`] would not converge and is
//! refused.

use super::block::Block;
use super::body_properties::BodyProperties;
use super::body_solver::{BodySolver, Rises, SolverInput};
use super::conductor::{Conductor, NewtonStats, Request, Workspace};
use super::error::SolveError;
use super::mesh::Axis;
use super::scheme::Scheme;
use super::section::Interpolation;
use super::transient::ModeFlux;
use super::varying::{conductor, extremes};
use crate::columns::reconstruction::{Flux, FluxRow};
use crate::window::Stage;
use grids::state::{read_numbers, write_numbers};
use std::io::{self, Read, Write};

/// Fourier number of the passage of an element above which a steady case is refused.
const SLOW: f64 = 0.2;
/// Change of a sweep, relative to the largest value, at which the march has converged.
const SETTLED: f64 = 1e-7;
/// Largest number of sweeps.
const MOST_SWEEPS: usize = 60;

/// Solver of one body.
pub struct SteadyMarching {
    nature: BodyProperties,
    flux: Flux,
    block: Conductor,
    first_row: usize,
    rows: usize,
    widths: Vec<f64>,
    h: f64,
    /// Number of columns of the flux, and behind them.
    heated: usize,
    behind: usize,
    scheme: Scheme,
    speed: f64,
    /// Θ of all columns [W/m], downstream first, each in depth and across.
    trial: Vec<f64>,
    accepted: Vec<f64>,
    sweep: Vec<f64>,
    memory: Workspace,
    means: Vec<f64>,
    surface: Vec<f64>,
    inside: Vec<f64>,
    free: Vec<bool>,
}

impl SteadyMarching {
    /// Creates the solver of a cold body.
    #[must_use]
    pub fn new(given: SolverInput) -> Self {
        let Block { columns, across, depth, first_row, .. } = given.block;
        let one = Axis::middles(0.0, vec![1.0]);
        let (block, memory) = conductor(given, [across, &one, depth]);
        let (heated, behind) = (given.grid.ni, given.elements.behind(given.grid));
        let all = vec![0.0; block.nodes() * (heated + behind)];
        Self {
            nature: given.nature.clone(),
            flux: Flux::zero(given.grid.ni, given.grid.nj),
            first_row: *first_row,
            rows: given.grid.nj,
            widths: across.widths.clone(),
            h: columns.h,
            heated,
            behind,
            scheme: given.elements.scheme,
            speed: 0.0,
            trial: all.clone(),
            accepted: all.clone(),
            sweep: all,
            memory,
            means: vec![0.0; (heated + behind) * given.grid.nj],
            surface: vec![0.0; across.len()],
            inside: vec![0.0; block.nodes()],
            free: vec![true; across.len()],
            block,
        }
    }

    /// Sweeps until the state no longer changes. Returns the effort of the steps, or the change of
    /// the last sweep as an error.
    fn settle(&mut self) -> Result<NewtonStats, f64> {
        let columns = self.heated + self.behind;
        for (row, means) in self.means.chunks_exact_mut(columns).enumerate() {
            let FluxRow { middle, edge, .. } = self.flux.row(row);
            let edge = &edge[..self.heated + 1];
            ModeFlux { middle, edge }.means(0.5, self.behind, means);
        }
        let (mut all, mut change) = (NewtonStats::default(), f64::INFINITY);
        for sweep in 0..MOST_SWEEPS {
            all.add(self.march(sweep == 0));
            let largest = self.sweep.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
            let pairs = self.sweep.iter().zip(&self.trial);
            change = pairs.fold(0.0_f64, |most, (new, old)| most.max((new - old).abs()));
            std::mem::swap(&mut self.sweep, &mut self.trial);
            if sweep > 0 && change <= SETTLED * largest || largest == 0.0 {
                return Ok(all);
            }
        }
        Err(change)
    }

    /// Makes one sweep from the leading edge downstream.
    fn march(&mut self, first: bool) -> NewtonStats {
        let (size, columns) = (self.block.nodes(), self.heated + self.behind);
        let cold = vec![0.0; size];
        let mut all = NewtonStats::default();
        for column in (0..columns).rev() {
            let by = self.scheme.coefficients((columns - 1 - column) as u64, 1.0);
            self.receive(column, by.a);
            self.inside.fill(0.0);
            if !first {
                self.conduct_along(column, by.theta);
            }
            let (own, upstream) = self.sweep[column * size..].split_at_mut(size);
            let old = upstream.get(..size).unwrap_or(&cold);
            let older = upstream.get(size..2 * size).unwrap_or(&cold);
            if first {
                for (own, (old, older)) in own.iter_mut().zip(old.iter().zip(older)) {
                    *own = 2.0 * old - older;
                }
            } else {
                own.copy_from_slice(&self.trial[column * size..(column + 1) * size]);
            }
            let request = Request {
                duration: self.h / self.speed,
                by,
                surface: &self.surface,
                free: &self.free,
                inside: &self.inside,
            };
            all.add(self.block.step(&request, own, [old, older], &mut self.memory));
        }
        all
    }

    /// Computes the heat that the surface nodes of a column receive in its step, and the nodes that
    /// are free.
    fn receive(&mut self, column: usize, [new, _, old]: [f64; 3]) {
        let columns = self.heated + self.behind;
        self.surface.fill(0.0);
        self.free.fill(true);
        for row in 0..self.rows {
            let means = &self.means[row * columns..(row + 1) * columns];
            let before = means.get(column + 1).copied().unwrap_or(0.0);
            let node = self.first_row + row;
            self.surface[node] = self.widths[node] * (new * means[column] + old * before);
            let (first, end) = self.flux.row(row).support;
            self.free[node] = !(first + self.behind..end + self.behind).contains(&column);
        }
    }

    /// Adds the heat conducted along into a column during its step, from the previous sweep.
    fn conduct_along(&mut self, column: usize, theta: f64) {
        let (size, across) = (self.block.nodes(), self.widths.len());
        let columns = self.heated + self.behind;
        let scale = 1.0 / (self.h * self.h);
        let at = |column: isize, node: usize| match usize::try_from(column.max(0)) {
            Ok(column) if column < columns => self.trial[column * size + node],
            _ => 0.0,
        };
        let column = column as isize;
        let bend = |column: isize, node: usize| {
            at(column - 1, node) - 2.0 * at(column, node) + at(column + 1, node)
        };
        let depths = self.block.widths_in_depth();
        for (node, inside) in self.inside.iter_mut().enumerate() {
            let area = scale * self.widths[node % across] * depths[node / across];
            *inside = area * (theta * bend(column, node) + (1.0 - theta) * bend(column + 1, node));
        }
    }
}

impl BodySolver for SteadyMarching {
    fn pass(&mut self, _: f64, speed: f64) -> Result<(), SolveError> {
        let fourier = 1.0 / (self.block.law.held(0.0).rate * speed * self.h);
        if fourier <= SLOW {
            self.speed = speed;
            return Ok(());
        }
        Err(SolveError::TooSlow { fourier, speed, most: SLOW })
    }

    fn warm(&mut self) -> Result<u64, SolveError> {
        let took = self.settle().map_err(|change| SolveError::Unsettled { change })?;
        self.nature.check(extremes(&self.trial, &self.block.law), took)
    }

    fn show(&mut self, _: Interpolation, rise: &mut [f64]) {
        let size = self.block.nodes();
        for (row, rise) in rise.chunks_exact_mut(self.heated).enumerate() {
            for (column, rise) in rise.iter_mut().enumerate() {
                let at = (column + self.behind) * size + self.first_row + row;
                *rise = self.block.law.rise(self.trial[at]);
            }
        }
    }

    fn flux(&mut self) -> &mut Flux {
        &mut self.flux
    }

    fn accept(&mut self) {
        self.accepted.copy_from_slice(&self.trial);
    }

    fn below(&self, stage: Stage, row: usize) -> Rises {
        let state = match stage {
            Stage::Trial => &self.trial,
            Stage::Accepted => &self.accepted,
        };
        let (size, across) = (self.block.nodes(), self.widths.len());
        let node = self.first_row + row;
        let at = |k: usize, column: usize| state[column * size + k * across + node];
        let layer = |k: usize| (0..state.len() / size).map(move |column| (k, column));
        let all = (0..size / across).flat_map(layer);
        let values = all.map(|(k, column)| self.block.law.rise(at(k, column))).collect();
        Rises { values, behind: self.behind as f64, dense: 1 }
    }

    /// Always false: rises below zero are errors of the iterations, not rounding.
    fn is_heated(&self, _: Stage) -> bool {
        false
    }

    fn save(&self, into: &mut dyn Write) -> io::Result<()> {
        write_numbers(into, &self.accepted)
    }

    fn read(&mut self, from: &mut dyn Read) -> io::Result<()> {
        read_numbers(from, &mut self.trial)
    }
}
