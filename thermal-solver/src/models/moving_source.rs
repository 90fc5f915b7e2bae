//! Model `moving-source`: three-dimensional conduction into half-spaces under a moving flux, at any
//! speed including rest, steady and transient. Equations and discretisation:
//! [`heat::moving_source`].
//!
//! In transient cases the flux is constant over each time window. The contribution of earlier
//! windows is the sum of their influences, each over its own range of ages. Windows are merged as
//! they age ([`heat::columns::history`]). Their contribution is cached while only the flux of the
//! newest window changes.

use super::conduction::{Conduction, Cost, InterfaceLoad, SolveStats};
use super::fields::fields;
use super::frame::Frame;
use super::interface::{Flow, HeatedBodies, Interface, both};
use super::names;
use super::setup::{resolution, section_key, wake};
use super::summary::{Peak, hottest, hottest_in_contact};
use crate::capability::Capability;
use crate::{LOWER, UPPER};
use heat::Material;
use heat::columns::convolution::remove_negative_rounding;
use heat::columns::history::{History, Window};
use heat::columns::reconstruction::{Flux, sum_of_means};
use heat::moving_source::ages::PastInterval;
use heat::moving_source::contact_basis::Shapes;
use heat::moving_source::half_space::{Contracted, HalfSpace, Influence, convolution};
use heat::moving_source::past::stretches;
use heat::moving_source::rise_integral::RiseIntegral;
use heat::window::{Drive, Stage};
use numerics::convolution::Convolution;
use proto::accuracy::{Accuracy, Simplification};
use proto::configuration::Mode;
use proto::description::ModelSpec;
use proto::grid::Structured;
use proto::model::StepError;
use std::cell::RefCell;
use std::io::{self, Read, Write};
use std::sync::Arc;

/// Optional capabilities of the model.
pub const CAPABILITIES: &[Capability] = &[
    Capability::Exchange,
    Capability::Potentials,
    Capability::EarlierPassages,
    Capability::RiseIntegrals,
];

/// Returns the description of the model.
#[must_use]
pub fn spec() -> ModelSpec {
    let (consumes, provides) = fields();
    ModelSpec {
        name: names::MOVING_SOURCE.to_owned(),
        summary: "heat conduction in three dimensions into half-spaces, at any speed".to_owned(),
        source: "Carslaw & Jaeger, Conduction of Heat in Solids, 10.4 and 10.7".to_owned(),
        steady: true,
        transient: true,
        rewinds: true,
        varies_step: true,
        consumes,
        provides,
        keys: vec![resolution(), wake(), section_key()],
        accuracy: Accuracy { refinement: None, simplifications: vec![by_quadrature()] },
    }
}

/// Returns the quadrature error. The flux has an error of its own, that of the grid of another
/// participant.
fn by_quadrature() -> Simplification {
    let source = "closed forms in the tests of moving_source (docs/theory/moving-source.md)";
    Simplification::always("ages and elements by Gauss's rule", 1e-9, source)
}

/// Time of a solve per element of the grid, both bodies, measured [s].
const SECONDS_PER_POINT: f64 = 4e-6;
/// Multiply-adds per body from which on a second thread pays.
const WORTH: usize = 1_500_000;
/// Multiply-adds per element to compute an influence.
const INFLUENCE: usize = 500;
/// Multiply-adds per element of a convolution.
const TRANSFORMS: usize = 60;
/// Memory per element of the grid, for spectra and fields on padded grids [byte].
const BYTES_PER_POINT: u64 = 400;

/// A body: its history, and the influence of the newest window on its surface.
struct Body {
    /// Index of the body, [`UPPER`] or [`LOWER`].
    body: usize,
    grid: Structured,
    material: Material,
    convolution: Convolution,
    fields: [Vec<f64>; 3],
    history: History,
    /// Rises that earlier windows leave at the end of the newest one [K].
    past: Vec<f64>,
    /// Newest window for which `past` is valid.
    past_of: Option<PastInterval>,
    /// Newest window and its influence.
    newest: Option<(PastInterval, Arc<Influence>)>,
    /// Element means of the body's share of the friction heat [W/m²].
    means: Vec<f64>,
    /// Operator for the rise integral of the body, built on first use.
    integral: Option<RiseIntegral>,
}

impl Body {
    fn new(frame: &Frame, body: usize) -> Self {
        let (grid, material) = (frame.grid, frame.scene.materials[body]);
        let (columns, rows) = (grid.ni, grid.nj);
        Self {
            body,
            convolution: convolution(&grid),
            fields: Default::default(),
            history: History::new(columns, rows, grid.dx(), material.diffusivity()),
            past: vec![0.0; columns * rows],
            past_of: None,
            newest: None,
            means: vec![0.0; columns * rows],
            integral: None,
            grid,
            material,
        }
    }

    fn half_space(&self, stretch: PastInterval) -> HalfSpace {
        let (diffusivity, effusivity) = (self.material.diffusivity(), self.material.effusivity());
        HalfSpace::new(&self.grid, diffusivity, effusivity, stretch)
    }

    /// Computes the influence of the newest window unless it is cached. Returns the operation
    /// count.
    fn meet(&mut self, stretch: PastInterval) -> u64 {
        if self.newest.as_ref().is_some_and(|(of, _)| *of == stretch) {
            return 0;
        }
        let influence = self.half_space(stretch).influence(&mut self.convolution);
        let work = influence.work();
        self.newest = Some((stretch, Arc::new(influence)));
        work
    }

    /// Computes the influence of the newest window and the rises that earlier windows leave, unless
    /// both are cached. Returns the operation count.
    fn pass(&mut self, stretch: PastInterval) -> u64 {
        let mut work = self.meet(stretch);
        if self.past_of == Some(stretch) {
            return work;
        }
        let window = self.history.trial_mut();
        (window.duration, window.speed, window.share) = (stretch.to, stretch.speed, 1.0);
        self.past.fill(0.0);
        for (stretch, window) in stretches(&self.history, Stage::Trial).skip(1) {
            let influence = self.half_space(stretch).influence(&mut self.convolution);
            influence.add(&window.flux, &mut self.convolution, &mut self.fields, &mut self.past);
            work += influence.work() + self.past.len() as u64;
        }
        self.past_of = Some(stretch);
        work
    }

    fn newest(&self) -> &(PastInterval, Arc<Influence>) {
        self.newest.as_ref().expect("the body has passed")
    }

    /// Computes the surface rises under the body's share of the friction heat in the newest window
    /// and the exchanged flux.
    fn warm(&mut self, flow: Flow, rise: &mut [f64]) {
        rise.copy_from_slice(&self.past);
        let window = self.history.trial_mut();
        window.flux.reconstruct(&self.means);
        flow.add(self.body, &mut window.flux);
        if let Some((_, influence)) = &self.newest {
            influence.add(&window.flux, &mut self.convolution, &mut self.fields, rise);
        }
    }
}

/// Fluxes into a body in one state, contracted to a row, newest window first. Cached between
/// queries.
struct Row {
    stage: Stage,
    body: usize,
    row: usize,
    windows: Vec<(HalfSpace, Contracted)>,
    /// Last requested x [m], and the contribution of every age of every window there.
    place: Option<(f64, Vec<Vec<f64>>)>,
}

/// Model of half-spaces under a moving heat flux.
pub struct MovingSource {
    frame: Frame,
    bodies: [Body; 2],
    row_sums: Vec<f64>,
    line: Vec<f64>,
    /// Interface between the surfaces; `None` if no heat flows between them.
    interface: Option<Interface>,
    /// Last requested row, cached between queries.
    row: RefCell<Option<Row>>,
}

impl Conduction for MovingSource {
    const TRANSIENT: bool = true;
    const SOLVES_STATIONARY_BODY: bool = true;
    const KEEPS_WINDOWS: bool = true;
    const CAPABILITIES: &'static [Capability] = CAPABILITIES;
    const STATE_TAG: u8 = 3;

    fn new(frame: &Frame) -> Self {
        Self {
            frame: frame.clone(),
            bodies: [Body::new(frame, UPPER), Body::new(frame, LOWER)],
            row_sums: vec![0.0; frame.grid.nj],
            line: vec![0.0; frame.grid.ni],
            interface: Interface::of(frame, Shapes::Elements),
            row: RefCell::new(None),
        }
    }

    fn cost(frame: &Frame) -> Cost {
        let points = frame.grid.points();
        let windows = frame.kept_windows(UPPER) + frame.kept_windows(LOWER);
        Cost {
            solve_seconds: (points * windows) as f64 * 0.5 * SECONDS_PER_POINT,
            memory_bytes: points as u64 * BYTES_PER_POINT
                + windows as u64 * Flux::bytes(frame.grid.ni, frame.grid.nj),
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
        let flux = rub.flux;
        let mut work = SolveStats::default();
        self.row.get_mut().take_if(|row| row.stage == Stage::Trial);
        for (body, share) in self.bodies.iter_mut().zip(drive.shares) {
            body.means.iter_mut().zip(flux).for_each(|(mean, flux)| *mean = share * flux);
        }
        work.operations += self.pass(drive, rise)?;
        if let Some(mut interface) = self.interface.take() {
            for body in &mut self.bodies {
                body.history.trial_mut().flux.reconstruct(&body.means);
            }
            work.heat = self.heat();
            let settled = interface.settle(&self.frame.grid.clone(), rub, self, rise);
            let settled = settled.and_then(|operations| {
                interface.audit(work.heat, self.heat())?;
                Ok(operations)
            });
            self.interface = Some(interface);
            work.operations += settled?;
        } else {
            work.operations += self.warm(Flow::default(), rise)?;
            work.heat = self.heat();
        }
        for (body, rise) in self.bodies.iter_mut().zip(rise) {
            if body.history.windows(Stage::Trial).all(|window| window.flux.is_heating()) {
                remove_negative_rounding(rise);
            }
        }
        Ok(work)
    }

    fn rise_integral(&mut self, body: usize, integral: &mut [f64]) -> u64 {
        let Body { grid, material, history, integral: known, .. } = &mut self.bodies[body];
        let known = known.get_or_insert_with(|| RiseIntegral::new(grid, *material));
        let past = stretches(history, Stage::Trial);
        known.of(past.map(|(stretch, window)| (stretch, 1.0, &window.flux)), integral)
    }

    fn exchanged(&self) -> Option<f64> {
        self.interface.as_ref().map(Interface::flow)
    }

    fn accept(&mut self) {
        self.interface.iter_mut().for_each(Interface::accept);
        for body in &mut self.bodies {
            body.history.accept();
            body.past_of = None;
        }
        // Older windows may have been merged.
        let same = self.frame.mode == Mode::Steady;
        let row = self.row.get_mut().take_if(|row| same && row.stage == Stage::Trial);
        *self.row.get_mut() = row.map(|row| Row { stage: Stage::Accepted, ..row });
    }

    fn section(&mut self, stage: Stage, body: usize, row: usize, depths: &[f64], rise: &mut [f64]) {
        rise.fill(0.0);
        self.on_row(stage, body, row, |row| {
            for (half_space, contracted) in &row.windows {
                half_space.section(contracted, depths, rise);
            }
        });
        if self.bodies[body].history.windows(stage).all(|window| window.flux.is_heating()) {
            remove_negative_rounding(rise);
        }
    }

    fn rise_at(&self, body: usize, row: usize, x: f64, depth: f64) -> f64 {
        let mut rise = 0.0;
        self.on_row(Stage::Accepted, body, row, |row| {
            let windows = &row.windows;
            let shares = || windows.iter().map(|(half_space, flux)| half_space.shares_at(flux, x));
            let (_, shares) = match row.place.take_if(|(at, _)| *at == x) {
                Some(place) => row.place.insert(place),
                None => row.place.insert((x, shares().collect())),
            };
            let of = |((half_space, _), shares): (&(HalfSpace, _), &Vec<f64>)| {
                half_space.rise_below(shares, depth)
            };
            rise = windows.iter().zip(shares.iter()).map(of).sum();
        });
        rise
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
        self.bodies.iter().try_for_each(|body| body.history.save(into))
    }

    fn restore(&mut self, from: &mut dyn Read) -> io::Result<()> {
        self.row.get_mut().take();
        let points = self.frame.grid.points();
        let touching =
            self.interface.as_ref().map(|_| Interface::read(from, points)).transpose()?;
        let [upper, lower] = &mut self.bodies;
        let mut before = Vec::new();
        upper.history.save(&mut before)?;
        upper.history.restore(from)?;
        if let Err(error) = lower.history.restore(from) {
            upper.history.restore(&mut before.as_slice())?;
            return Err(error);
        }
        self.bodies.iter_mut().for_each(|body| body.past_of = None);
        self.interface.iter_mut().zip(touching).for_each(|(own, read)| own.touched = read);
        Ok(())
    }
}

impl HeatedBodies for MovingSource {
    fn warm(&mut self, flow: Flow, rise: &mut [Vec<f64>; 2]) -> Result<u64, StepError> {
        let points = self.frame.grid.points();
        let threads = self.threads(TRANSFORMS * points);
        both(threads, &mut self.bodies, rise, |_, body, rise| {
            body.warm(flow, rise);
            Ok(points as u64)
        })
    }

    fn windows(&self) -> [PastInterval; 2] {
        self.bodies.each_ref().map(|body| body.newest().0)
    }

    fn influences(&self, _: &mut Convolution) -> [Arc<Influence>; 2] {
        self.bodies.each_ref().map(|body| Arc::clone(&body.newest().1))
    }
}

impl MovingSource {
    /// Sums the fluxes into the bodies in the newest window over the elements [W/m²], and stores
    /// the sums with the window.
    fn heat(&mut self) -> [f64; 2] {
        let Self { bodies, row_sums, line, .. } = self;
        bodies.each_mut().map(|body| {
            let window = body.history.trial_mut();
            window.heat = sum_of_means(&window.flux, row_sums, line);
            window.heat
        })
    }

    /// Number of threads for this many operations per body.
    fn threads(&self, operations: usize) -> usize {
        if operations < WORTH { 1 } else { self.frame.threads }
    }

    /// Prepares the newest window of both bodies. Bodies of the same material and speed share one
    /// influence.
    fn pass(&mut self, drive: &Drive, rise: &mut [Vec<f64>; 2]) -> Result<u64, StepError> {
        let stretch = |speed: f64| PastInterval { from: 0.0, to: drive.duration, way: 0.0, speed };
        let [upper, lower] = drive.speeds.map(stretch);
        let mut work = 0;
        if upper == lower && self.bodies[UPPER].material == self.bodies[LOWER].material {
            work += self.bodies[UPPER].meet(upper);
            self.bodies[LOWER].newest = self.bodies[UPPER].newest.clone();
        }
        let known = |body: &Body, stretch: PastInterval| {
            let met = body.newest.as_ref().is_some_and(|(of, _)| *of == stretch);
            met && body.past_of == Some(stretch)
        };
        if known(&self.bodies[UPPER], upper) && known(&self.bodies[LOWER], lower) {
            return Ok(work);
        }
        let threads = self.threads(INFLUENCE * self.frame.grid.points());
        let passed = both(threads, &mut self.bodies, rise, |_, body, _| {
            Ok(body.pass(if body.body == UPPER { upper } else { lower }))
        });
        Ok(work + passed?)
    }

    /// Evaluates `ask` on a row of a body, whose contracted fluxes are cached.
    fn on_row(&self, stage: Stage, body: usize, row: usize, ask: impl FnOnce(&mut Row)) {
        let mut kept = self.row.borrow_mut();
        let kept = match &mut *kept {
            Some(kept) if (kept.stage, kept.body, kept.row) == (stage, body, row) => kept,
            other => {
                let of = &self.bodies[body];
                let contracted = |(stretch, window): (PastInterval, &Window)| {
                    let half_space = of.half_space(stretch);
                    let contracted = half_space.contract(&window.flux, row);
                    (half_space, contracted)
                };
                let windows = stretches(&of.history, stage).map(contracted).collect();
                other.insert(Row { stage, body, row, windows, place: None })
            }
        };
        ask(kept);
    }
}
