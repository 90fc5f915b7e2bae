//! A body whose properties depend on temperature, or whose free surface exchanges heat: blocks of
//! [`super::conductor`] under the flux of a window.
//!
//! In time it is the mesh of [`super::transient`], which moves with the material, node by node in the place of
//! mode by mode. What the mesh receives, how it is shifted and how its surface is seen are the same.
//!
//! In steady motion every slice of material across the motion has the same past. One slice is taken from the
//! leading edge downstream, from column to column of the moving frame, in as many steps of time: the solution
//! where nothing is conducted along. What is conducted along is then a source in every column, from the
//! slices of the sweep before, and the march is repeated until the slices stay the same. Each sweep brings the
//! error down by about 4κ/(Vh); where an element is passed more slowly than heat spreads over it that is no way to the solution,
//! and is refused.

use super::block::{Block, Elements, Solver};
use super::body::{BESIDE, place};
use super::conductor::{Conductor, Memory, Request, Surroundings, Took};
use super::creep::{Creep, Position, Step};
use super::direct::Direct;
use super::law::Law;
use super::mesh::Axis;
use super::scheme::Scheme;
use super::transient::{Columns, ModeFlux};
use crate::columns::reconstruction::{Flux, FluxRow};
use crate::window::Stage;
use proto::grid::Structured;
use proto::state::{read_numbers, write_numbers};
use std::io::{self, Read, Write};

/// Fourier number along, of the passage of an element, above which a steady case is refused.
const SLOW: f64 = 0.2;
/// Change of a sweep over the largest value at which it was the last one.
const SETTLED: f64 = 1e-7;
/// Sweeps at most.
const MOST_SWEEPS: usize = 60;

/// A mesh, its law and what is round it.
pub struct Given<'a> {
    /// The mesh.
    pub block: &'a Block,
    /// The grid of the heat flux.
    pub grid: &'a Structured,
    /// The material.
    pub law: Law,
    /// What is round the free surface.
    pub surroundings: Surroundings,
    /// What the case says of elements and their solver.
    pub elements: &'a Elements,
}

impl Given<'_> {
    fn conductor(&self, axes: [&Axis; 3]) -> (Conductor, Memory) {
        let mut block = Conductor::new(axes, self.law.clone());
        block.surroundings = self.surroundings;
        let direct = match self.elements.solver {
            Solver::Direct => Some(Direct::new(block.counts)),
            Solver::Auto | Solver::Iterative => None,
        };
        (block, Memory::with(direct))
    }
}

/// Θ of a body's mesh [W/m] that moves with the material.
#[derive(Clone, Debug, PartialEq)]
struct State {
    now: Vec<f64>,
    /// A step ago, at the same material.
    last: Vec<f64>,
    /// Means of the flux at the columns in the last step, for a scheme that asks for it [W/m²].
    fluxes: Vec<f64>,
    position: Position,
}

/// A body in time.
pub struct Marched {
    block: Conductor,
    columns: Columns,
    first_row: usize,
    rows: usize,
    widths: Vec<f64>,
    scheme: Scheme,
    creep: Creep,
    trial: State,
    accepted: State,
    memory: Memory,
    /// One and two steps ago.
    old: [Vec<f64>; 2],
    means: Vec<f64>,
    surface: Vec<f64>,
    free: Vec<bool>,
}

impl Marched {
    /// A cold body.
    #[must_use]
    pub fn new(given: &Given) -> Self {
        let Block { columns, across, depth, first_row } = given.block;
        let along = Axis::middles(0.0, vec![columns.h; columns.count()]).ending(columns.ends);
        let (block, memory) = given.conductor([&along, across, depth]);
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
            block,
            columns: *columns,
            first_row: *first_row,
            rows,
            widths: across.widths.clone(),
            scheme,
            creep: Creep::default(),
            trial: cold.clone(),
            accepted: cold,
            memory,
            old: [vec![0.0; size], vec![0.0; if two { size } else { 0 }]],
            means: vec![0.0; columns.count()],
            surface: vec![0.0; places],
            free: vec![true; places],
        }
    }

    /// Plans a window of this duration [s] at this speed [m/s], with steps no longer than this [s].
    pub fn pass(&mut self, duration: f64, speed: f64, longest: f64) {
        let window = [duration, speed / self.columns.h, longest];
        self.creep.plan(&self.accepted.position, window, self.columns.count(), self.scheme);
    }

    /// Takes the body through the window; writes the surface of the rows of the flux; what the steps took.
    pub fn warm(&mut self, flux: &Flux, rise: &mut [f64]) -> Took {
        self.begin();
        let mut all = Took::default();
        for step in std::mem::take(&mut self.creep.steps) {
            self.receive(flux, &step);
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
        let columns = self.columns.count();
        for (row, rise) in rise.chunks_exact_mut(self.columns.heated).enumerate() {
            let start = (self.first_row + row) * self.block.counts[2] * columns;
            let surface = &self.trial.now[start..start + columns];
            for (mean, value) in self.means.iter_mut().zip(surface) {
                *mean = self.block.law.rise(*value);
            }
            place(&self.means[self.columns.behind - BESIDE..], self.creep.position.front, rise);
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

    /// The heat that the surface nodes receive in a step, and which of them are free.
    fn receive(&mut self, flux: &Flux, step: &Step) {
        let columns = self.columns.count();
        let [new, _, old] = step.by.a;
        for row in 0..self.rows {
            let of = row * columns..(row + 1) * columns;
            let FluxRow { middle, edge, support } = flux.row(row);
            let edge = &edge[..self.columns.heated + 1];
            ModeFlux { middle, edge }.means(step.middle, self.columns.behind, &mut self.means);
            let node = (self.first_row + row) * columns;
            let surface = &mut self.surface[node..node + columns];
            surface.copy_from_slice(&self.means);
            if !self.trial.fluxes.is_empty() {
                let last = &mut self.trial.fluxes[of];
                let shift = step.shifts[0];
                let before = last[shift..].iter().copied().chain(std::iter::repeat(0.0));
                if old != 0.0 {
                    for (heat, before) in surface.iter_mut().zip(before) {
                        *heat = new * *heat + old * step.over_last * before;
                    }
                }
                last.copy_from_slice(&self.means);
            }
            let area = self.columns.h * self.widths[self.first_row + row];
            surface.iter_mut().for_each(|heat| *heat *= area);
            // A node is in the contact while it is in the middle of the step.
            let front = step.middle;
            let touching = support.0 as f64..support.1 as f64;
            for (column, free) in self.free[node..node + columns].iter_mut().enumerate() {
                let at = column as f64 - self.columns.behind as f64 + front + 0.5;
                *free = !touching.contains(&at);
            }
        }
    }

    /// Lets both states go with the material, and puts a guess in the place of the newest: what has changed at
    /// the same place in the last step changes in this one.
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

    /// The last solve becomes the accepted state.
    pub fn accept(&mut self) {
        std::mem::swap(&mut self.trial, &mut self.accepted);
    }

    /// Rises below a row of a state [K], node after node in depth, column after column, and how far in front of
    /// their places the columns are, in elements.
    #[must_use]
    pub fn below(&self, stage: Stage, row: usize) -> (Vec<f64>, f64) {
        let state = match stage {
            Stage::Trial => &self.trial,
            Stage::Accepted => &self.accepted,
        };
        let size = self.block.counts[2] * self.columns.count();
        let start = (self.first_row + row) * size;
        let rise = |value: &f64| self.block.law.rise(*value);
        (state.now[start..start + size].iter().map(rise).collect(), state.position.front)
    }

    /// Coldest and hottest rise of the last solve [K].
    #[must_use]
    pub fn extremes(&self) -> [f64; 2] {
        extremes(&self.trial.now, &self.block.law)
    }

    /// Writes the accepted state.
    ///
    /// # Errors
    /// Those of `into`.
    pub fn save(&self, into: &mut dyn Write) -> io::Result<()> {
        let State { now, last, fluxes, position } = &self.accepted;
        position.save(into)?;
        write_numbers(into, now.iter().chain(last).chain(fluxes))
    }

    /// Reads back what [`Marched::save`] wrote.
    ///
    /// # Errors
    /// It does not fit; then nothing has changed.
    pub fn restore(&mut self, from: &mut dyn Read) -> io::Result<()> {
        let mut accepted = self.accepted.clone();
        accepted.position = Position::restore(from)?;
        let State { now, last, fluxes, .. } = &mut accepted;
        read_numbers(from, now.iter_mut().chain(last).chain(fluxes))?;
        self.accepted = accepted;
        Ok(())
    }
}

/// A body in steady motion.
pub struct Swept {
    block: Conductor,
    first_row: usize,
    rows: usize,
    widths: Vec<f64>,
    h: f64,
    /// Columns of the flux, and behind them.
    heated: usize,
    behind: usize,
    scheme: Scheme,
    speed: f64,
    /// Θ of all columns [W/m], downstream first, each in depth and across.
    trial: Vec<f64>,
    accepted: Vec<f64>,
    sweep: Vec<f64>,
    memory: Memory,
    means: Vec<f64>,
    surface: Vec<f64>,
    inside: Vec<f64>,
    free: Vec<bool>,
}

impl Swept {
    /// A cold body.
    #[must_use]
    pub fn new(given: &Given) -> Self {
        let Block { columns, across, depth, first_row } = given.block;
        let one = Axis::middles(0.0, vec![1.0]);
        let (block, memory) = given.conductor([across, &one, depth]);
        let (heated, behind) = (given.grid.ni, given.elements.behind(given.grid));
        let all = vec![0.0; block.nodes() * (heated + behind)];
        Self {
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

    /// Fourier number along, of the passage of an element at a speed [m/s]: it is too slow if above
    /// [`SLOW`].
    #[must_use]
    pub fn too_slow(&self, speed: f64) -> Option<f64> {
        let fourier = 1.0 / (self.block.law.held(0.0).rate * speed * self.h);
        (fourier.is_nan() || fourier > SLOW).then_some(fourier)
    }

    /// Prepares a speed [m/s].
    pub fn pass(&mut self, speed: f64) {
        self.speed = speed;
    }

    /// Sweeps until nothing changes; writes the surface of the rows of the flux; what the steps took, or the
    /// change of the last sweep.
    ///
    /// # Errors
    /// The sweeps do not end.
    pub fn warm(&mut self, flux: &Flux, rise: &mut [f64]) -> Result<Took, f64> {
        let columns = self.heated + self.behind;
        for (row, means) in self.means.chunks_exact_mut(columns).enumerate() {
            let FluxRow { middle, edge, .. } = flux.row(row);
            let edge = &edge[..self.heated + 1];
            ModeFlux { middle, edge }.means(0.5, self.behind, means);
        }
        let (mut all, mut change) = (Took::default(), f64::INFINITY);
        for sweep in 0..MOST_SWEEPS {
            all.add(self.march(flux, sweep == 0));
            let largest = self.sweep.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
            let pairs = self.sweep.iter().zip(&self.trial);
            change = pairs.fold(0.0_f64, |most, (new, old)| most.max((new - old).abs()));
            std::mem::swap(&mut self.sweep, &mut self.trial);
            if sweep > 0 && change <= SETTLED * largest || largest == 0.0 {
                self.show(rise);
                return Ok(all);
            }
        }
        Err(change)
    }

    /// One sweep from the leading edge downstream.
    fn march(&mut self, flux: &Flux, first: bool) -> Took {
        let (size, columns) = (self.block.nodes(), self.heated + self.behind);
        let cold = vec![0.0; size];
        let mut all = Took::default();
        for column in (0..columns).rev() {
            let by = self.scheme.coefficients((columns - 1 - column) as u64, 1.0);
            self.receive(flux, column, by.a);
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

    /// The heat that the surface nodes of a column receive on its way there, and which are free.
    fn receive(&mut self, flux: &Flux, column: usize, [new, _, old]: [f64; 3]) {
        let columns = self.heated + self.behind;
        self.surface.fill(0.0);
        self.free.fill(true);
        for row in 0..self.rows {
            let means = &self.means[row * columns..(row + 1) * columns];
            let before = means.get(column + 1).copied().unwrap_or(0.0);
            let node = self.first_row + row;
            self.surface[node] = self.widths[node] * (new * means[column] + old * before);
            let (first, end) = flux.row(row).support;
            self.free[node] = !(first + self.behind..end + self.behind).contains(&column);
        }
    }

    /// What is conducted along into a column on its way there, by the sweep before.
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

    fn show(&self, rise: &mut [f64]) {
        let size = self.block.nodes();
        for (row, rise) in rise.chunks_exact_mut(self.heated).enumerate() {
            for (column, rise) in rise.iter_mut().enumerate() {
                let at = (column + self.behind) * size + self.first_row + row;
                *rise = self.block.law.rise(self.trial[at]);
            }
        }
    }

    /// The last solve becomes the accepted state.
    pub fn accept(&mut self) {
        self.accepted.copy_from_slice(&self.trial);
    }

    /// Rises below a row of a state [K], node after node in depth, column after column.
    #[must_use]
    pub fn below(&self, stage: Stage, row: usize) -> Vec<f64> {
        let state = match stage {
            Stage::Trial => &self.trial,
            Stage::Accepted => &self.accepted,
        };
        let (size, across) = (self.block.nodes(), self.widths.len());
        let node = self.first_row + row;
        let at = |k: usize, column: usize| state[column * size + k * across + node];
        let layer = |k: usize| (0..state.len() / size).map(move |column| (k, column));
        let all = (0..size / across).flat_map(layer);
        all.map(|(k, column)| self.block.law.rise(at(k, column))).collect()
    }

    /// Coldest and hottest rise of the last solve [K].
    #[must_use]
    pub fn extremes(&self) -> [f64; 2] {
        extremes(&self.trial, &self.block.law)
    }

    /// Writes the accepted state.
    ///
    /// # Errors
    /// Those of `into`.
    pub fn save(&self, into: &mut dyn Write) -> io::Result<()> {
        write_numbers(into, &self.accepted)
    }

    /// Reads back what [`Swept::save`] wrote.
    ///
    /// # Errors
    /// It does not fit; then nothing has changed.
    pub fn restore(&mut self, from: &mut dyn Read) -> io::Result<()> {
        let mut accepted = vec![0.0; self.accepted.len()];
        read_numbers(from, &mut accepted)?;
        self.accepted = accepted;
        Ok(())
    }
}

fn extremes(potentials: &[f64], law: &Law) -> [f64; 2] {
    let range = potentials
        .iter()
        .fold([0.0_f64; 2], |[low, high], value| [low.min(*value), high.max(*value)]);
    range.map(|value| law.rise(value))
}
