//! Model `moving-source`: conduction in all directions into half-spaces under a moving flux, at any speed
//! down to rest. Equations and discretisation: [`crate::moving_source`].

use super::conduction::{Conduction, Cost, Work};
use super::fields::fields;
use super::frame::Frame;
use super::names;
use super::setup::{resolution, section_key};
use super::summary::Peak;
use crate::columns::convolution::remove_negative_rounding;
use crate::columns::reconstruction::Flux;
use crate::moving_source::exchange::Exchange;
use crate::moving_source::half_space::{Contracted, HalfSpace, convolution};
use crate::search::maximum;
use crate::window::{Drive, Stage};
use crate::{LOWER, UPPER};
use numerics::convolution::Convolution;
use proto::accuracy::{Accuracy, Simplification};
use proto::description::ModelSpec;
use proto::grid::blocked_sum;
use proto::model::StepError;
use proto::state::{read_numbers, write_numbers};
use std::cell::RefCell;
use std::io::{self, Read, Write};
use std::rc::Rc;

/// Its description.
#[must_use]
pub fn spec() -> ModelSpec {
    let (consumes, provides) = fields();
    ModelSpec {
        name: names::MOVING_SOURCE.to_owned(),
        summary: "heat conduction in three dimensions into half-spaces, at any speed".to_owned(),
        source: "Carslaw & Jaeger, Conduction of Heat in Solids, 10.4 and 10.7".to_owned(),
        steady: true,
        transient: false,
        rewinds: true,
        consumes,
        provides,
        keys: vec![resolution(), section_key()],
        accuracy: Accuracy { refinement: None, simplifications: Vec::new() },
    }
}

/// Time of a solve over the elements of the grid, both bodies, measured [s].
const SECONDS_PER_POINT: f64 = 4e-6;
/// Difference of the temperatures, over the highest, at which what flows between the surfaces is found.
const SETTLED: f64 = 1e-7;
/// Corrections of it at most.
const MOST_CORRECTIONS: usize = 40;
/// Memory over the elements of the grid: spectra and fields on padded grids [byte].
const BYTES_PER_POINT: u64 = 400;

/// What is known of both bodies.
#[derive(Clone)]
struct State {
    bodies: [Option<Rc<HalfSpace>>; 2],
    /// Element means of the flux into each body [W/m²].
    means: [Vec<f64>; 2],
    flux: [Flux; 2],
}

/// The flux into a body, contracted to a row; kept from one question to the next.
struct Row {
    stage: Stage,
    body: usize,
    row: usize,
    contracted: Contracted,
    /// The place asked for last [m], and what every age adds there.
    place: Option<(f64, Vec<f64>)>,
}

/// The model.
pub struct MovingSource {
    frame: Frame,
    convolution: Convolution,
    fields: [Vec<f64>; 3],
    line: Vec<f64>,
    /// What flows between the surfaces of two bodies, with the speeds that it is for.
    exchange: Option<([f64; 2], Exchange)>,
    trial: State,
    accepted: State,
    /// What was asked for last.
    row: RefCell<Option<Row>>,
}

impl Conduction for MovingSource {
    const TRANSIENT: bool = false;
    const AT_REST: bool = true;
    const EXCHANGES: bool = true;
    const STATE_TAG: u8 = 3;

    fn new(frame: &Frame) -> Self {
        let (columns, rows) = (frame.grid.ni, frame.grid.nj);
        let zeros = vec![0.0; columns * rows];
        let flux = Flux::zero(columns, rows);
        let cold = State {
            bodies: [None, None],
            means: [zeros.clone(), zeros],
            flux: [flux.clone(), flux],
        };
        Self {
            frame: frame.clone(),
            convolution: convolution(&frame.grid),
            fields: Default::default(),
            line: vec![0.0; columns],
            exchange: None,
            trial: cold.clone(),
            accepted: cold,
            row: RefCell::new(None),
        }
    }

    fn cost(frame: &Frame) -> Cost {
        let points = frame.grid.points();
        Cost {
            solve_seconds: points as f64 * SECONDS_PER_POINT,
            memory_bytes: points as u64 * BYTES_PER_POINT,
        }
    }

    fn remarks(_: &Frame) -> Vec<String> {
        Vec::new()
    }

    fn left_out(_: &Frame) -> Option<Simplification> {
        None
    }

    fn solve(
        &mut self,
        drive: &Drive,
        flux: &[f64],
        rise: &mut [Vec<f64>; 2],
    ) -> Result<Work, StepError> {
        let mut work = Work::default();
        self.row.get_mut().take_if(|row| row.stage == Stage::Trial);
        for body in 0..2 {
            work.operations += self.pass_at(body, drive.speeds[body]);
            let share = drive.shares[body];
            let means = &mut self.trial.means[body];
            means.iter_mut().zip(flux).for_each(|(mean, flux)| *mean = share * flux);
        }
        work.operations += self.warm(rise);
        if let Some(resistance) = self.frame.partition.resistance() {
            work.operations += self.settle(resistance, drive.speeds, flux, rise)?;
        }
        for (flux, (heat, rise)) in self.trial.flux.iter().zip(work.heat.iter_mut().zip(rise)) {
            *heat = heat_of(flux, &mut self.line);
            if flux.is_heating() {
                remove_negative_rounding(rise);
            }
        }
        Ok(work)
    }

    fn accept(&mut self) {
        self.accepted.clone_from(&self.trial);
        let row = self.row.get_mut().take_if(|row| row.stage == Stage::Trial);
        *self.row.get_mut() = row.map(|row| Row { stage: Stage::Accepted, ..row });
    }

    fn section(&mut self, stage: Stage, body: usize, row: usize, depths: &[f64], rise: &mut [f64]) {
        rise.fill(0.0);
        self.on_row(stage, body, row, |half_space, row| {
            half_space.section(&row.contracted, depths, rise);
        });
    }

    fn rise_at(&self, body: usize, row: usize, x: f64, depth: f64) -> f64 {
        let mut rise = 0.0;
        self.on_row(Stage::Accepted, body, row, |half_space, row| {
            let (_, shares) = match row.place.take_if(|(at, _)| *at == x) {
                Some(place) => row.place.insert(place),
                None => row.place.insert((x, half_space.shares_at(&row.contracted, x))),
            };
            rise = half_space.rise_below(shares, depth);
        });
        rise
    }

    fn peak(&self, body: usize, rise: &[f64]) -> Option<Peak> {
        let grid = &self.frame.grid;
        let hottest = (0..rise.len()).reduce(|a, b| if rise[b] > rise[a] { b } else { a })?;
        if rise[hottest] <= 0.0 {
            return None;
        }
        let (row, column) = (hottest / grid.ni, hottest % grid.ni);
        let low = grid.x(column.saturating_sub(1));
        let high = grid.x((column + 1).min(grid.ni - 1));
        let (x, rise) = maximum(low, high, |x| self.rise_at(body, row, x, 0.0));
        Some(Peak { rise, x, row })
    }

    fn save(&self, into: &mut dyn Write) -> io::Result<()> {
        let State { bodies, means, .. } = &self.accepted;
        for (body, means) in bodies.iter().zip(means) {
            // A body without a speed has not been heated.
            let speed = body.as_ref().map_or(f64::NAN, |body| body.speed());
            write_numbers(into, std::iter::once(&speed).chain(means))?;
        }
        Ok(())
    }

    fn restore(&mut self, from: &mut dyn Read) -> io::Result<()> {
        let mut speeds = [f64::NAN; 2];
        let mut means = self.accepted.means.clone();
        for (speed, means) in speeds.iter_mut().zip(&mut means) {
            read_numbers(from, std::iter::once(speed).chain(means))?;
        }
        for (body, speed) in speeds.into_iter().enumerate() {
            if speed >= 0.0 {
                self.pass_at(body, speed);
            } else {
                self.trial.bodies[body] = None;
            }
            self.trial.flux[body].reconstruct(&means[body]);
        }
        self.trial.means = means;
        self.accept();
        Ok(())
    }
}

impl MovingSource {
    /// Rises of both surfaces under the element means of the trial.
    fn warm(&mut self, rise: &mut [Vec<f64>; 2]) -> u64 {
        for (body, rise) in rise.iter_mut().enumerate() {
            let flux = &mut self.trial.flux[body];
            flux.reconstruct(&self.trial.means[body]);
            if let Some(half_space) = &self.trial.bodies[body] {
                half_space.surface(flux, &mut self.convolution, &mut self.fields, rise);
            }
        }
        2 * rise[0].len() as u64
    }

    /// Finds what flows between the surfaces where friction heats them, until their temperatures differ by
    /// what the resistance asks for.
    fn settle(
        &mut self,
        resistance: f64,
        speeds: [f64; 2],
        flux: &[f64],
        rise: &mut [Vec<f64>; 2],
    ) -> Result<u64, StepError> {
        let touching = touching(flux, self.frame.grid.ni);
        let mut flows = vec![0.0; touching.len()];
        let mut correction = flows.clone();
        let mut work = 0;
        for _ in 0..MOST_CORRECTIONS {
            let error = |(at, flow): (&usize, &f64)| {
                rise[UPPER][*at] - rise[LOWER][*at] - resistance * flow
            };
            let errors: Vec<f64> = touching.iter().zip(&flows).map(error).collect();
            let largest = errors.iter().fold(0.0_f64, |most, error| most.max(error.abs()));
            let warmest = rise.iter().flatten().fold(0.0_f64, |most, rise| most.max(rise.abs()));
            if largest <= SETTLED * warmest {
                return Ok(work);
            }
            self.pair(resistance, speeds);
            let Some((_, exchange)) = &mut self.exchange else { unreachable!("a pair is made") };
            let products =
                exchange.correct(&mut self.convolution, &touching, &errors, &mut correction);
            for ((at, flow), more) in touching.iter().zip(&mut flows).zip(&correction) {
                *flow += more;
                self.trial.means[UPPER][*at] -= more;
                self.trial.means[LOWER][*at] += more;
            }
            work += self.warm(rise) + (products * flux.len()) as u64;
        }
        Err(StepError::NoSolution(format!(
            "the heat that flows between the surfaces was not found in {MOST_CORRECTIONS} \
             corrections; write another effects.friction_heat.partition or thermal.resolution"
        )))
    }

    /// Makes the operator of what flows between the bodies at these speeds.
    fn pair(&mut self, resistance: f64, speeds: [f64; 2]) {
        if self.exchange.as_ref().is_some_and(|(at, _)| *at == speeds) {
            return;
        }
        if let [Some(upper), Some(lower)] = &self.trial.bodies {
            let exchange = Exchange::new(&self.frame.grid, [upper, lower], resistance);
            self.exchange = Some((speeds, exchange));
        }
    }

    /// Lets a body pass at a speed; its share of the work.
    fn pass_at(&mut self, body: usize, speed: f64) -> u64 {
        let known = |half_space: &Option<Rc<HalfSpace>>| {
            half_space.as_ref().is_some_and(|half_space| half_space.speed() == speed)
        };
        let materials = &self.frame.scene.materials;
        if known(&self.trial.bodies[body]) {
            return 0;
        }
        let other = 1 - body;
        if materials[body] == materials[other] && known(&self.trial.bodies[other]) {
            self.trial.bodies[body] = self.trial.bodies[other].clone();
            return 0;
        }
        let (diffusivity, effusivity) =
            (materials[body].diffusivity(), materials[body].effusivity());
        let grid = &self.frame.grid;
        let made = HalfSpace::new(grid, diffusivity, effusivity, speed, &mut self.convolution);
        let work = made.work();
        self.trial.bodies[body] = Some(Rc::new(made));
        work
    }

    /// Asks a body about a row, whose contracted flux is kept.
    fn on_row(
        &self,
        stage: Stage,
        body: usize,
        row: usize,
        ask: impl FnOnce(&HalfSpace, &mut Row),
    ) {
        let state = if stage == Stage::Trial { &self.trial } else { &self.accepted };
        let Some(half_space) = &state.bodies[body] else { return };
        let mut kept = self.row.borrow_mut();
        let kept = match &mut *kept {
            Some(kept) if (kept.stage, kept.body, kept.row) == (stage, body, row) => kept,
            other => {
                let contracted = half_space.contract(&state.flux[body], row);
                other.insert(Row { stage, body, row, contracted, place: None })
            }
        };
        ask(half_space, kept);
    }
}

/// The elements where the surfaces rub: in every row from the first that is heated to the last.
fn touching(flux: &[f64], columns: usize) -> Vec<usize> {
    let mut touching = Vec::new();
    for (row, values) in flux.chunks_exact(columns).enumerate() {
        let heated = |value: &f64| *value != 0.0;
        let (Some(first), Some(last)) =
            (values.iter().position(heated), values.iter().rposition(heated))
        else {
            continue;
        };
        touching.extend((first..=last).map(|i| row * columns + i));
    }
    touching
}

/// Sum of the element means of a flux as it is convolved [W/m²].
fn heat_of(flux: &Flux, line: &mut [f64]) -> f64 {
    let sums: Vec<f64> = (0..flux.rows())
        .map(|row| {
            flux.means_into(row, line);
            blocked_sum(line)
        })
        .collect();
    blocked_sum(&sums)
}
