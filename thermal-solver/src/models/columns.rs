//! Model `columns`: one-dimensional conduction with the exact kernel, for any heat flux in space
//! and time. Equations and discretisation: [`heat::columns`].

use super::conduction::{Conduction, Cost, InterfaceLoad, SolveStats};
use super::fields::fields;
use super::frame::Frame;
use super::names;
use super::normal_only::{along_the_surface, along_the_surface_at};
use super::setup::{resolution, section_key, wake};
use super::summary::{Peak, hottest};
use crate::capability::Capability;
use crate::{LOWER, UPPER};
use heat::columns::convolution::{
    CROSSOVER, Steady, accumulate, at_point, remove_negative_rounding,
};
use heat::columns::history::History;
use heat::columns::reconstruction::Flux;
use heat::columns::stencil::{Part, Stencil};
use heat::moving_source::past::stretches;
use heat::moving_source::rise_integral::RiseIntegral;
use heat::window::{Drive, Stage};
use numerics::team::{ROWS, Team};
use proto::accuracy::{Accuracy, Simplification};
use proto::configuration::Mode;
use proto::description::ModelSpec;
use proto::grid::blocked_sum;
use proto::model::StepError;
use std::io::{self, Read, Write};
use std::ops::Range;

/// Optional capabilities of the model.
pub const CAPABILITIES: &[Capability] = &[Capability::EarlierPassages, Capability::RiseIntegrals];

/// Returns the description of the model.
#[must_use]
pub fn spec() -> ModelSpec {
    let (consumes, provides) = fields();
    ModelSpec {
        name: names::COLUMNS.to_owned(),
        summary: "heat conduction normal to the surface with the exact kernel, any flux in space \
                  and time"
            .to_owned(),
        source: "Naeimi et al., eqs. 3-8; Carslaw & Jaeger, Conduction of Heat in Solids, 2.9"
            .to_owned(),
        steady: true,
        transient: true,
        rewinds: true,
        varies_step: true,
        consumes,
        provides,
        keys: vec![resolution(), wake(), section_key()],
        accuracy: Accuracy { refinement: None, simplifications: vec![along_the_surface()] },
    }
}

// Measured on a plain x86-64 build; used for the expected cost only.
const SECONDS_PER_MULTIPLY_ADD: f64 = 0.1e-9;
const SECONDS_PER_POINT_OVER_FOURIER: f64 = 15e-9;
const SECONDS_PER_POINT: f64 = 6e-9;

/// Multiply-adds per point to reconstruct the flux.
const RECONSTRUCTION: u64 = 30;
/// Multiply-adds per point to sum the flux.
const MEANS: u64 = 10;
/// Multiply-adds per point of a convolution in Fourier space.
const OVER_FOURIER: u64 = 80;

/// Window duration and speeds for which the stored contribution of earlier windows is valid.
#[derive(Clone, Copy, Debug, PartialEq)]
struct PastKey {
    duration: f64,
    speeds: [f64; 2],
}

/// Scratch buffers of a thread.
#[derive(Clone)]
struct Scratch {
    /// Steady convolution of a row.
    steady: Steady,
    /// Mean fluxes of a row, or the result of its steady convolution.
    line: Vec<f64>,
}

/// Model of one-dimensional conduction normal to the surface.
pub struct Columns {
    frame: Frame,
    /// Heat flux of earlier windows into the upper and the lower body.
    histories: [History; 2],
    team: Team<Scratch>,
    row_sums: Vec<f64>,
    /// Transient weights of each body, for every window.
    stencils: [Stencil; 2],
    /// Rises of each body that earlier windows leave at the end of the newest one [K].
    past: [Vec<f64>; 2],
    /// Window and speeds for which `past` is valid.
    past_key: Option<PastKey>,
    /// Weights of one level of a section.
    level: Stencil,
    /// Operators for the rise integrals of both bodies, built on first use.
    integrals: [Option<RiseIntegral>; 2],
}

impl Conduction for Columns {
    const TRANSIENT: bool = true;
    const SOLVES_STATIONARY_BODY: bool = false;
    const KEEPS_WINDOWS: bool = true;
    const CAPABILITIES: &'static [Capability] = CAPABILITIES;
    const STATE_TAG: u8 = 2;

    fn new(frame: &Frame) -> Self {
        let (columns, rows) = (frame.grid.ni, frame.grid.nj);
        let past = match frame.mode {
            Mode::Steady => Vec::new(),
            Mode::Transient => vec![0.0; columns * rows],
        };
        Self {
            frame: frame.clone(),
            histories: [(); 2].map(|()| History::new(columns, rows, frame.grid.dx(), 0.0)),
            team: Team::new(
                frame.threads,
                Scratch { steady: Steady::new(columns), line: vec![0.0; columns] },
            ),
            row_sums: vec![0.0; rows],
            stencils: [Stencil::default(), Stencil::default()],
            past: [past.clone(), past],
            past_key: None,
            level: Stencil::default(),
            integrals: [None, None],
        }
    }

    fn cost(frame: &Frame) -> Cost {
        cost(frame)
    }

    fn left_out(frame: &Frame) -> Option<Simplification> {
        along_the_surface_at(frame)
    }

    fn solve(
        &mut self,
        drive: &Drive,
        rub: &InterfaceLoad<'_>,
        rise: &mut [Vec<f64>; 2],
    ) -> Result<SolveStats, StepError> {
        let heat = self.take(rub.flux, drive);
        let heat = drive.shares.map(|share| share * heat);
        let operations = match self.frame.mode {
            Mode::Steady => self.solve_steady(drive, rise),
            Mode::Transient => self.solve_transient(drive, rise),
        };
        Ok(SolveStats { operations, heat })
    }

    fn rise_integral(&mut self, body: usize, integral: &mut [f64]) -> u64 {
        let Self { frame, histories, integrals, .. } = self;
        let new = || RiseIntegral::new(&frame.grid, frame.scene.materials[body]);
        let past = stretches(&histories[body], Stage::Trial);
        let past = past.map(|(stretch, window)| (stretch, window.share, &window.flux));
        integrals[body].get_or_insert_with(new).of(past, integral)
    }

    fn accept(&mut self) {
        self.histories.iter_mut().for_each(History::accept);
        self.past_key = None;
    }

    fn section(&mut self, stage: Stage, body: usize, row: usize, depths: &[f64], rise: &mut [f64]) {
        for (depth, rise) in depths.iter().zip(rise.chunks_exact_mut(self.frame.grid.ni)) {
            self.level_at(stage, body, row, *depth, rise);
        }
    }

    fn rise_at(&self, body: usize, row: usize, x: f64, depth: f64) -> f64 {
        let grid = &self.frame.grid;
        let place = (x - grid.x(0)) / grid.dx();
        let element = place.round().clamp(0.0, (grid.ni - 1) as f64);
        let theta = (place - element + 0.5).clamp(0.0, 1.0);
        let past = self.histories[body].past(Stage::Accepted, self.frame.amplitude(body));
        at_point(past, row, element as usize, theta, depth)
    }

    fn peak(&self, body: usize, rise: &[f64]) -> Option<Peak> {
        hottest(&self.frame.grid, rise, |row, x| self.rise_at(body, row, x, 0.0))
    }

    fn save(&self, into: &mut dyn Write) -> io::Result<()> {
        self.histories.iter().try_for_each(|history| history.save(into))
    }

    fn restore(&mut self, from: &mut dyn Read) -> io::Result<()> {
        History::restore_pair(&mut self.histories, from)?;
        self.past_key = None;
        Ok(())
    }
}

impl Columns {
    /// Makes the flux that of the newest window of both bodies. Returns the sum of its element
    /// means [W/m²].
    fn take(&mut self, flux: &[f64], drive: &Drive) -> f64 {
        let [upper, lower] = self.histories.each_mut().map(History::trial_mut);
        let pieces = upper.flux.pieces(flux, ROWS);
        self.team.sweep(flux.len() as u64 * RECONSTRUCTION, pieces, |_, piece| {
            piece.reconstruct();
            0
        });
        lower.flux.copy_from(&upper.flux);
        let heat = heat(&upper.flux, &mut self.team, &mut self.row_sums);
        for (body, window) in [upper, lower].into_iter().enumerate() {
            (window.duration, window.heat) = (drive.duration, heat);
            (window.speed, window.share) = (drive.speeds[body], drive.shares[body]);
        }
        heat
    }

    /// Returns true if no flux of a body's state cools it.
    fn is_heating(&self, stage: Stage, body: usize) -> bool {
        self.histories[body].windows(stage).all(|window| window.flux.is_heating())
    }

    /// Computes the steady rises with one convolution for both bodies: share/(β√π) · √(h/V) times
    /// the convolution for unit speed and length.
    fn solve_steady(&mut self, drive: &Drive, rise: &mut [Vec<f64>; 2]) -> u64 {
        let heating = self.is_heating(Stage::Trial, UPPER);
        let (columns, flux) = (self.frame.grid.ni, &self.histories[UPPER].trial_mut().flux);
        let factors: [f64; 2] = std::array::from_fn(|body| {
            let passing = self.frame.grid.dx() / drive.speeds[body];
            drive.shares[body] * self.frame.amplitude(body) * passing.sqrt()
        });
        let [wheel, rail] = rise;
        let (size, points) = (ROWS * columns, wheel.len() as u64);
        let each = if columns < CROSSOVER { columns as u64 } else { OVER_FOURIER };
        let pieces = wheel.chunks_mut(size).zip(rail.chunks_mut(size)).enumerate();
        self.team.sweep(each * points, pieces, |scratch, (piece, (wheel, rail))| {
            let rows = wheel.chunks_mut(columns).zip(rail.chunks_mut(columns));
            let mut work = 0;
            for (row, (wheel, rail)) in (piece * ROWS..).zip(rows) {
                work += scratch.steady.apply(flux.row(row), &mut scratch.line);
                for (rise, factor) in [wheel, rail].into_iter().zip(factors) {
                    for (rise, value) in rise.iter_mut().zip(&scratch.line) {
                        *rise = factor * value;
                    }
                    if heating {
                        remove_negative_rounding(rise);
                    }
                }
            }
            work
        })
    }

    /// Computes the transient rises: the contribution of earlier windows, cached while only the
    /// flux of the newest window changes, plus that of the newest window.
    fn solve_transient(&mut self, drive: &Drive, rise: &mut [Vec<f64>; 2]) -> u64 {
        let key = PastKey { duration: drive.duration, speeds: drive.speeds };
        let mut work = 0;
        if self.past_key != Some(key) {
            work += self.rebuild_past();
            self.past_key = Some(key);
        }
        let columns = self.frame.grid.ni;
        for (body, rise) in rise.iter_mut().enumerate() {
            rise.copy_from_slice(&self.past[body]);
            let parts = Parts { stencil: &self.stencils[body], which: 0..1 };
            work += parts.add(&mut self.team, &self.histories[body], columns, rise);
            if self.is_heating(Stage::Trial, body) {
                remove_negative_rounding(rise);
            }
        }
        work
    }

    fn rebuild_past(&mut self) -> u64 {
        let columns = self.frame.grid.ni;
        let mut work = 0;
        for (body, rise) in self.past.iter_mut().enumerate() {
            let history = &self.histories[body];
            let past = history.past(Stage::Trial, self.frame.amplitude(body));
            self.stencils[body].build(past.map(|(segment, _)| segment), columns, 0.0);
            rise.fill(0.0);
            // Part 0 belongs to the trial window, which always has a positive duration.
            let parts = Parts { stencil: &self.stencils[body], which: 1..usize::MAX };
            work += parts.add(&mut self.team, history, columns, rise);
        }
        work
    }

    /// Computes the rises along a row at a depth.
    fn level_at(&mut self, stage: Stage, body: usize, row: usize, depth: f64, rise: &mut [f64]) {
        let past = self.histories[body].past(stage, self.frame.amplitude(body));
        self.level.build(past.map(|(segment, _)| segment), rise.len(), depth);
        rise.fill(0.0);
        for part in self.level.parts() {
            if let Some(window) = self.histories[body].window(stage, part.segment) {
                accumulate(&part, window.flux.row(row), rise);
            }
        }
        if self.is_heating(stage, body) {
            remove_negative_rounding(rise);
        }
    }
}

/// Selected parts of a stencil, each the contribution of one window of the trial state.
struct Parts<'a> {
    stencil: &'a Stencil,
    which: Range<usize>,
}

impl Parts<'_> {
    fn iter(&self) -> impl Iterator<Item = Part<'_>> {
        self.stencil.parts().skip(self.which.start).take(self.which.len())
    }

    /// Adds the contributions to the rises on the whole grid. Returns the operation count.
    fn add(
        &self,
        team: &mut Team<Scratch>,
        history: &History,
        columns: usize,
        rise: &mut [f64],
    ) -> u64 {
        let weights: usize = self.iter().map(|part| 2 * part.edge.len()).sum();
        let operations = (weights * rise.len()) as u64;
        let pieces = rise.chunks_mut(ROWS * columns).enumerate();
        team.sweep(operations, pieces, |_, (piece, rise)| {
            let mut work = 0;
            for part in self.iter() {
                let Some(window) = history.window(Stage::Trial, part.segment) else { continue };
                for (row, rise) in (piece * ROWS..).zip(rise.chunks_mut(columns)) {
                    work += accumulate(&part, window.flux.row(row), rise);
                }
            }
            work
        })
    }
}

/// Sums the element means of the reconstructed flux [W/m²], which is the flux that is convolved.
/// The order of the sum does not depend on the number of threads.
fn heat(flux: &Flux, team: &mut Team<Scratch>, row_sums: &mut [f64]) -> f64 {
    let points = (flux.rows() * flux.columns()) as u64;
    let pieces = row_sums.chunks_mut(ROWS).enumerate();
    team.sweep(points * MEANS, pieces, |scratch, (piece, sums)| {
        for (row, sum) in (piece * ROWS..).zip(sums) {
            flux.means_into(row, &mut scratch.line);
            *sum = blocked_sum(&scratch.line);
        }
        0
    });
    blocked_sum(row_sums)
}

fn cost(frame: &Frame) -> Cost {
    let (columns, rows) = (frame.grid.ni, frame.grid.nj);
    let windows = frame.kept_windows(UPPER) + frame.kept_windows(LOWER);
    let grid_bytes = (8 * columns * rows) as u64;
    let (n, rows) = (columns as f64, rows as f64);
    let per_row = match frame.mode {
        Mode::Steady if columns < CROSSOVER => n * n * SECONDS_PER_MULTIPLY_ADD,
        Mode::Steady => n * SECONDS_PER_POINT_OVER_FOURIER,
        Mode::Transient => 4.0 * n * n * SECONDS_PER_MULTIPLY_ADD,
    };
    Cost {
        solve_seconds: rows * (per_row + n * SECONDS_PER_POINT),
        memory_bytes: windows as u64 * Flux::bytes(columns, frame.grid.nj) + 8 * grid_bytes,
    }
}
