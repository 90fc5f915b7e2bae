//! A body: its temperatures under the flux of a window, steady and in time, of constant properties in the modes
//! of its mesh, otherwise node by node.

use super::basis::Basis;
use super::block::{Block, Elements, Solver};
use super::conductor::{Surroundings, Took};
use super::creep::{Creep, Position};
use super::law::{Law, Point};
use super::scheme::Scheme;
use super::steady::{self, Steady};
use super::transient::{Mesh, ModeFlux, ModeState};
use super::varying::{self, Given};
use crate::columns::convolution::remove_negative_rounding;
use crate::columns::reconstruction::Flux;
use crate::scene::Material;
use crate::window::Stage;
use proto::grid::Structured;
use proto::model::StepError;
use proto::state::{read_bytes, read_numbers, write_numbers};
use std::io::{self, Read, Write};

/// Columns on either side of a place that say what is there.
pub(super) const BESIDE: usize = 2;

/// A body.
pub struct Body {
    grid: Structured,
    nature: Nature,
    elements: Elements,
    block: Block,
    /// Element means of the flux into it [W/m²].
    pub means: Vec<f64>,
    /// The flux of the last solve.
    flux: Flux,
    motion: Motion,
    surfaces: Vec<f64>,
    rows: Vec<f64>,
    scratch: steady::Scratch,
}

/// Steady or in time, in modes or node by node.
enum Motion {
    Steady(Box<Held>),
    Transient(Box<Marched>),
    VaryingSteady(Box<varying::Swept>),
    VaryingTransient(Box<varying::Marched>),
}

/// What a body is made of, and what is round it.
#[derive(Clone, Debug, PartialEq)]
pub struct Nature {
    /// Its properties while it is cold.
    pub material: Material,
    /// The points of its properties over temperature, if they depend on it.
    pub points: Vec<Point>,
    /// Its temperature while it is cold [K].
    pub initial: f64,
    /// What is beyond the points counts as their ends.
    pub clamps: bool,
    /// What is round its free surface.
    pub surroundings: Surroundings,
}

impl Nature {
    /// It is solved in the modes of its mesh, unless another solver is asked for.
    #[must_use]
    pub fn is_constant(&self) -> bool {
        self.points.is_empty() && self.surroundings.is_none()
    }

    fn law(&self) -> Law {
        let Material { density, specific_heat, conductivity } = self.material;
        match self.points.as_slice() {
            [] => Law::constant(conductivity, density * specific_heat, self.initial),
            points => Law::new(points, self.initial),
        }
    }

    /// Why these rises cannot be [K].
    fn refuses(&self, rises: [f64; 2]) -> Option<String> {
        let [Some(first), Some(last)] = [self.points.first(), self.points.last()] else {
            return None;
        };
        let [cold, hot] = rises.map(|rise| self.initial + rise);
        let beyond = (hot > last.temperature).then_some(hot);
        let beyond =
            beyond.or((cold < first.temperature).then_some(cold)).filter(|_| !self.clamps)?;
        Some(format!(
            "{beyond:.1} K is beyond the table of properties, which is from {} to {} K; extend it, or write \
             effects.temperature_material.beyond = \"clamp\"",
            first.temperature, last.temperature
        ))
    }
}

/// A body in steady motion is known by its flux and its speed.
struct Held {
    basis: Basis,
    prepared: Option<(f64, Steady)>,
    speed: f64,
    accepted: Option<(f64, Flux)>,
}

/// A body in time.
struct Marched {
    mesh: Mesh,
    creep: Creep,
    trial: State,
    accepted: State,
    scratch: super::transient::Scratch,
    /// Every window of the past heated, and this one does.
    heating: [bool; 2],
}

/// Temperatures of a body's mesh.
#[derive(Clone, Debug, PartialEq)]
struct State {
    amplitudes: Vec<f64>,
    before: Vec<f64>,
    fluxes: Vec<f64>,
    position: Position,
}

/// Rises below a row: node after node in depth, column after column.
#[derive(Clone, Debug)]
pub struct Below {
    /// Rises [K].
    pub rises: Vec<f64>,
    /// Columns.
    pub columns: usize,
    /// Place of the first column [m].
    pub first: f64,
    /// Depths of the nodes [m].
    pub depths: Vec<f64>,
}

impl Body {
    /// A cold body below a grid of the heat flux, in steady motion or in time.
    #[must_use]
    pub fn new(
        grid: &Structured,
        nature: &Nature,
        expected_speed: f64,
        elements: &Elements,
        steady: bool,
    ) -> Self {
        let block = Block::new(grid, &nature.material, expected_speed, elements);
        let in_modes = nature.is_constant() && elements.solver == Solver::Auto;
        let given = || {
            let (law, surroundings) = (nature.law(), nature.surroundings);
            Given { block: &block, grid, law, surroundings, elements }
        };
        let (motion, columns) = match (in_modes, steady) {
            (true, true) => (Motion::Steady(Box::new(Held::new(&block, grid.nj))), grid.ni),
            (true, false) => {
                let marched = Marched::new(&block, grid.nj, nature, elements.scheme);
                (Motion::Transient(Box::new(marched)), block.columns.count())
            }
            (false, true) => (Motion::VaryingSteady(Box::new(varying::Swept::new(&given()))), 0),
            (false, false) => {
                (Motion::VaryingTransient(Box::new(varying::Marched::new(&given()))), 0)
            }
        };
        Self {
            grid: *grid,
            nature: nature.clone(),
            elements: *elements,
            means: vec![0.0; grid.points()],
            flux: Flux::zero(grid.ni, grid.nj),
            motion,
            surfaces: vec![0.0; block.across.len() * columns],
            rows: Vec::new(),
            scratch: steady::Scratch::default(),
            block,
        }
    }

    /// Prepares a window of this duration [s] at this speed [m/s].
    ///
    /// # Errors
    /// The motion is too slow for how it is solved.
    pub fn pass(&mut self, duration: f64, speed: f64) -> Result<(), StepError> {
        match &mut self.motion {
            Motion::Steady(held) => {
                held.speed = speed;
                if held.prepared.as_ref().is_none_or(|(of, _)| *of != speed) {
                    let (columns, h) = (self.grid.ni, self.grid.dx());
                    let steady = Steady::new(&held.basis, &self.nature.material, columns, h, speed);
                    held.prepared = Some((speed, steady));
                }
            }
            Motion::Transient(marched) => {
                let Marched { mesh, creep, accepted, .. } = &mut **marched;
                let (h, columns) = (mesh.columns.h, mesh.columns.count());
                let window = [duration, speed / h, self.elements.step];
                creep.plan(&accepted.position, window, columns, self.elements.scheme);
            }
            Motion::VaryingSteady(swept) => {
                if let Some(fourier) = swept.too_slow(speed) {
                    return Err(StepError::NoSolution(format!(
                        "heat spreads over {fourier:.2} elements squared while the surface passes one at \
                         {speed} m/s, and the march downstream needs 0.2; write time.mode = \"transient\", \
                         a smaller thermal.resolution, or a higher speed"
                    )));
                }
                swept.pass(speed);
            }
            Motion::VaryingTransient(marched) => marched.pass(duration, speed, self.elements.step),
        }
        Ok(())
    }

    /// Rises of the surface [K] at the end of the window under the element means; the work.
    ///
    /// # Errors
    /// There is no solution, or it is hotter than what is known of the material.
    pub fn warm(&mut self, rise: &mut [f64]) -> Result<u64, StepError> {
        self.flux.reconstruct(&self.means);
        rise.fill(0.0);
        let (flux, scratch) = (&self.flux, &mut self.scratch);
        match &mut self.motion {
            Motion::Steady(held) => {
                let Held { basis, prepared, .. } = &**held;
                let (_, steady) = prepared.as_ref().expect("the body has passed");
                let columns = self.grid.ni;
                for (mode, surface) in self.surfaces.chunks_exact_mut(columns).enumerate() {
                    steady.surface(basis, mode, flux, scratch, surface);
                }
                basis.add_modes(0, columns, &self.surfaces, rise);
                if flux.is_heating() {
                    remove_negative_rounding(rise);
                }
                Ok((basis.across.len() * basis.size() * columns) as u64)
            }
            Motion::Transient(marched) => {
                let work = marched.march(flux, scratch, &mut self.surfaces);
                let (basis, columns) = (&marched.mesh.basis, marched.mesh.columns.count());
                self.rows.clear();
                self.rows.resize(self.grid.nj * columns, 0.0);
                basis.add_modes(0, columns, &self.surfaces, &mut self.rows);
                let behind = marched.mesh.columns.behind;
                let front = marched.creep.position.front;
                let rows = self.rows.chunks_exact(columns);
                for (row, rise) in rows.zip(rise.chunks_exact_mut(self.grid.ni)) {
                    place(&row[behind - BESIDE..], front, rise);
                }
                if marched.heating[0] && flux.is_heating() {
                    remove_negative_rounding(rise);
                }
                Ok(work)
            }
            Motion::VaryingSteady(swept) => {
                let took = swept.warm(flux, rise).map_err(|change| {
                    StepError::NoSolution(format!(
                        "the march downstream does not settle: it changes by {change:.3e} W/m; write a \
                         higher speed or time.mode = \"transient\""
                    ))
                })?;
                check(&self.nature, swept.extremes(), took)
            }
            Motion::VaryingTransient(marched) => {
                let took = marched.warm(flux, rise);
                check(&self.nature, marched.extremes(), took)
            }
        }
    }

    /// The last solve becomes the accepted state.
    pub fn accept(&mut self) {
        match &mut self.motion {
            Motion::Steady(held) => match &mut held.accepted {
                Some((speed, flux)) => {
                    *speed = held.speed;
                    std::mem::swap(flux, &mut self.flux);
                }
                none => *none = Some((held.speed, self.flux.clone())),
            },
            Motion::Transient(marched) => {
                marched.heating[0] &= self.flux.is_heating();
                std::mem::swap(&mut marched.trial, &mut marched.accepted);
            }
            Motion::VaryingSteady(swept) => swept.accept(),
            Motion::VaryingTransient(marched) => marched.accept(),
        }
    }

    /// Rises below a row of a state.
    #[must_use]
    pub fn below(&self, stage: Stage, row: usize) -> Below {
        let h = self.grid.dx();
        let behind = self.elements.behind(&self.grid) as f64;
        let along = self.block.columns.behind as f64;
        // How far the first column is behind the first element, in elements.
        let (rises, first) = match &self.motion {
            Motion::Steady(held) => {
                let material = &self.nature.material;
                let amplitudes =
                    held.below(stage, &self.flux, &self.grid, material, row, behind as usize);
                (held.basis.rises(&amplitudes), behind)
            }
            Motion::Transient(marched) => {
                let state = match stage {
                    Stage::Trial => &marched.trial,
                    Stage::Accepted => &marched.accepted,
                };
                let amplitudes = marched.mesh.below(&state.amplitudes, row);
                (marched.mesh.basis.rises(&amplitudes), along - state.position.front)
            }
            Motion::VaryingSteady(swept) => (swept.below(stage, row), behind),
            Motion::VaryingTransient(marched) => {
                let (rises, front) = marched.below(stage, row);
                (rises, along - front)
            }
        };
        let depths = self.block.depth.places.clone();
        Below {
            columns: rises.len() / depths.len(),
            rises,
            first: self.grid.x(0) - first * h,
            depths,
        }
    }

    /// Sum of the element means of the flux as the elements receive it [W/m²].
    pub fn heat(&self, row_sums: &mut [f64], line: &mut [f64]) -> f64 {
        crate::columns::reconstruction::sum_of_means(&self.flux, row_sums, line)
    }

    /// All that a state has is not negative.
    #[must_use]
    pub fn is_heated(&self, stage: Stage) -> bool {
        match (&self.motion, stage) {
            (Motion::Steady(_), Stage::Trial) => self.flux.is_heating(),
            (Motion::Steady(held), Stage::Accepted) => {
                held.accepted.as_ref().is_none_or(|(_, flux)| flux.is_heating())
            }
            (Motion::Transient(marched), Stage::Trial) => {
                marched.heating[0] && self.flux.is_heating()
            }
            (Motion::Transient(marched), Stage::Accepted) => marched.heating[0],
            // Its equations are solved to their own tolerance.
            (Motion::VaryingSteady(_) | Motion::VaryingTransient(_), _) => false,
        }
    }

    /// Writes the accepted state.
    ///
    /// # Errors
    /// Those of `into`.
    pub fn save(&self, into: &mut dyn Write) -> io::Result<()> {
        match &self.motion {
            Motion::Steady(held) => {
                into.write_all(&[u8::from(held.accepted.is_some())])?;
                let Some((speed, flux)) = &held.accepted else { return Ok(()) };
                write_numbers(into, &[*speed])?;
                flux.save(into)
            }
            Motion::Transient(marched) => {
                into.write_all(&[u8::from(marched.heating[0])])?;
                marched.accepted.save(into)
            }
            Motion::VaryingSteady(swept) => swept.save(into),
            Motion::VaryingTransient(marched) => marched.save(into),
        }
    }

    /// Reads back what [`Body::save`] wrote.
    ///
    /// # Errors
    /// It does not fit; then nothing has changed.
    pub fn restore(&mut self, from: &mut dyn Read) -> io::Result<()> {
        match &mut self.motion {
            Motion::Steady(held) => {
                let [mark] = read_bytes(from)?;
                let mut accepted = None;
                if mark == 1 {
                    let (mut speed, mut flux) = ([0.0], Flux::zero(self.grid.ni, self.grid.nj));
                    read_numbers(from, &mut speed)?;
                    flux.restore(from)?;
                    accepted = Some((speed[0], flux));
                }
                held.accepted = accepted;
            }
            Motion::Transient(marched) => {
                let [mark] = read_bytes(from)?;
                let mut accepted = marched.accepted.clone();
                accepted.restore(from)?;
                marched.accepted = accepted;
                marched.heating[0] = mark == 1;
            }
            Motion::VaryingSteady(swept) => swept.restore(from)?,
            Motion::VaryingTransient(marched) => marched.restore(from)?,
        }
        Ok(())
    }
}

/// The work of a solve, if its rises can be.
fn check(nature: &Nature, extremes: [f64; 2], took: Took) -> Result<u64, StepError> {
    match nature.refuses(extremes) {
        Some(why) => Err(StepError::NoSolution(why)),
        None => Ok((took.newton + took.iterations) as u64),
    }
}

impl Held {
    fn new(block: &Block, rows: usize) -> Self {
        let basis = Basis::new(&block.across, &block.depth, block.first_row, rows);
        Self { basis, prepared: None, speed: 0.0, accepted: None }
    }

    fn below(
        &self,
        stage: Stage,
        trial: &Flux,
        grid: &Structured,
        material: &Material,
        row: usize,
        behind: usize,
    ) -> Vec<f64> {
        let (speed, flux) = match (stage, &self.accepted) {
            (Stage::Trial, _) => (self.speed, trial),
            (Stage::Accepted, Some((speed, flux))) => (*speed, flux),
            (Stage::Accepted, None) => {
                return vec![0.0; (behind + grid.ni) * self.basis.size()];
            }
        };
        match &self.prepared {
            Some((of, steady)) if *of == speed => steady.below(&self.basis, flux, row, behind),
            _ => Steady::new(&self.basis, material, grid.ni, grid.dx(), speed).below(
                &self.basis,
                flux,
                row,
                behind,
            ),
        }
    }
}

impl Marched {
    fn new(block: &Block, rows: usize, nature: &Nature, scheme: Scheme) -> Self {
        let basis = Basis::new(&block.across, &block.depth, block.first_row, rows);
        let mesh = Mesh::new(basis, block.columns, &nature.material);
        let accepted = State::cold(&mesh, scheme);
        Self {
            mesh,
            creep: Creep::default(),
            trial: accepted.clone(),
            accepted,
            scratch: Default::default(),
            heating: [true; 2],
        }
    }

    /// Takes all modes through the window; writes them on the surface, and counts the work.
    fn march(&mut self, flux: &Flux, scratch: &mut steady::Scratch, surfaces: &mut [f64]) -> u64 {
        let Self { mesh, creep, trial, accepted, scratch: own, .. } = self;
        let (size, count) = (mesh.mode_size(), mesh.columns.count());
        if creep.fresh {
            trial.chill();
        } else {
            trial.copy(accepted);
        }
        let (before, fluxes) = (trial.before.len() / size * size, trial.fluxes.len());
        for (mode, surface) in surfaces.chunks_exact_mut(count).enumerate() {
            scratch.project(&mesh.basis, mode, flux);
            let of = |size: usize| mode * size..(mode + 1) * size;
            let none = 0..0;
            let state = ModeState {
                now: &mut trial.amplitudes[of(size)],
                before: &mut trial.before[if before > 0 { of(size) } else { none.clone() }],
                flux: &mut trial.fluxes[if fluxes > 0 { of(count) } else { none }],
            };
            let flux = ModeFlux { middle: &scratch.middle, edge: &scratch.edge };
            mesh.window(mode, &creep.steps, flux, state, own, surface);
        }
        trial.position = creep.position;
        (creep.steps.len() * trial.amplitudes.len()) as u64
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
        }
    }

    fn chill(&mut self) {
        for values in [&mut self.amplitudes, &mut self.before, &mut self.fluxes] {
            values.fill(0.0);
        }
    }

    fn copy(&mut self, other: &Self) {
        self.amplitudes.copy_from_slice(&other.amplitudes);
        self.before.copy_from_slice(&other.before);
        self.fluxes.copy_from_slice(&other.fluxes);
    }

    fn save(&self, into: &mut dyn Write) -> io::Result<()> {
        self.position.save(into)?;
        write_numbers(into, self.amplitudes.iter().chain(&self.before).chain(&self.fluxes))
    }

    fn restore(&mut self, from: &mut dyn Read) -> io::Result<()> {
        self.position = Position::restore(from)?;
        let own = self.amplitudes.iter_mut().chain(&mut self.before).chain(&mut self.fluxes);
        read_numbers(from, own)
    }
}

impl Below {
    /// Rises [K] at a depth [m], column after column, at places as far apart from `first` [m] on.
    pub fn level(&self, depth: f64, h: f64, first: f64, rise: &mut [f64]) {
        let at_node = |k: usize, column: usize| self.rises[k * self.columns + column];
        let column = |column: usize| interpolate(&self.depths, depth, |k| at_node(k, column));
        let values: Vec<f64> = (0..self.columns).map(column).collect();
        for (i, rise) in rise.iter_mut().enumerate() {
            *rise = between(&values, (first - self.first) / h + i as f64);
        }
    }

    /// Rise [K] at a place [m] and a depth [m].
    #[must_use]
    pub fn at(&self, place: f64, h: f64, depth: f64) -> f64 {
        let at = (place - self.first) / h;
        let from = (at.floor() as isize - 1).clamp(0, self.columns as isize - 1) as usize;
        let to = (from + 4).min(self.columns);
        let column = |column: usize| {
            interpolate(&self.depths, depth, |k| self.rises[k * self.columns + column])
        };
        let values: Vec<f64> = (from..to).map(column).collect();
        between(&values, at - from as f64)
    }
}

/// Rises at the middles of elements from those of columns that are `front` of an element in front of them,
/// the first being that [`BESIDE`] behind the first element.
pub(super) fn place(columns: &[f64], front: f64, rise: &mut [f64]) {
    if front == 0.0 {
        let count = rise.len();
        rise.copy_from_slice(&columns[BESIDE..BESIDE + count]);
        return;
    }
    for (i, rise) in rise.iter_mut().enumerate() {
        *rise = between(columns, (i + BESIDE) as f64 - front);
    }
}

/// A value between even ones, by the cubic through the four round it, within their range; that of the end
/// beyond the ends.
fn between(values: &[f64], at: f64) -> f64 {
    let last = values.len() - 1;
    let at = at.clamp(0.0, last as f64);
    let low = at.floor();
    let theta = at - low;
    let four: [f64; 4] =
        std::array::from_fn(|k| values[(low as usize + k).saturating_sub(1).min(last)]);
    if theta == 0.0 {
        return four[1];
    }
    let [a, b, c, d] = four;
    let cubic = b + theta
        * (c - a / 3.0 - b / 2.0 - d / 6.0
            + theta * ((a + c) / 2.0 - b + theta * ((d - a) / 6.0 + (b - c) / 2.0)));
    let range = |pick: fn(f64, f64) -> f64| four.into_iter().reduce(pick).expect("four values");
    cubic.clamp(range(f64::min), range(f64::max))
}

/// A value between uneven ones, by the cubic through the four round it, within the range of the two beside it.
fn interpolate(places: &[f64], at: f64, value: impl Fn(usize) -> f64) -> f64 {
    let last = places.len() - 1;
    if at >= places[last] {
        return value(last);
    }
    let next = places.partition_point(|place| *place <= at).clamp(1, last);
    let first = next.saturating_sub(2).min(last.saturating_sub(3));
    let nodes = first..=(first + 3).min(last);
    let lagrange = |k: usize| {
        let others = nodes.clone().filter(|other| *other != k);
        others.map(|other| (at - places[other]) / (places[k] - places[other])).product::<f64>()
    };
    let cubic: f64 = nodes.clone().map(|k| lagrange(k) * value(k)).sum();
    let (above, below) = (value(next - 1), value(next));
    cubic.clamp(above.min(below), above.max(below))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A cubic is met between even and uneven places; rounding.
    #[test]
    fn cubics_are_interpolated_exactly() {
        let cubic = |x: f64| x * (1.0 + x * (0.2 + 0.1 * x));
        let even: Vec<f64> = (0..9).map(|i| cubic(f64::from(i))).collect();
        let places = [0.0, 0.5, 1.5, 4.0, 7.0, 8.0];
        for at in [1.25, 2.0, 3.9, 5.5, 6.999] {
            assert!((between(&even, at) - cubic(at)).abs() < 1e-12 * cubic(8.0));
            let uneven = interpolate(&places, at, |k| cubic(places[k]));
            assert!((uneven - cubic(at)).abs() < 1e-12 * cubic(8.0), "{at}");
        }
    }
}
