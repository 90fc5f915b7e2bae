//! Model `rod`: one-dimensional conduction in two rods, end to end.
//!
//! Each body is a rod of length L along the normal of the contact. Its far end is kept at the
//! initial temperature; a body without a length keeps its initial temperature everywhere. The sides
//! are insulated. The flux g = h (T_u − T_l) from the upper into the lower body is added to their
//! shares of the friction heat. The conductance h is that of the contact or of the gap
//! ([`crate::effects::contact_conductance`]).
//!
//! With z from the far end, s_n = (n + ½)π/L and a flux q that is constant over a window Δt,
//!
//! ϑ(z, t + Δt) = q z/λ + Σ (ϑ_n − q c_n) e^{−κ s_n² Δt} sin(s_n z),  c_n = 2 (−1)ⁿ/(λ L s_n²).
//!
//! The first term is the steady state under q. The solution is exact in space and time except for
//! omitted modes that decay in less than a window. The rise of the end is the contribution of the
//! past plus R q, so that the exchanged flux follows from one linear equation. It uses the
//! temperatures at the end of the window, which is first-order accurate in Δt.
//!
//! Source: Carslaw & Jaeger, Conduction of Heat in Solids (1959), 3.4 and 3.8.

use super::conduction::{Conduction, Cost, InterfaceLoad, SolveStats};
use super::ends::{self, Ends};
use super::fields::fields;
use super::frame::Frame;
use super::names;
use super::summary::Peak;
use crate::capability::Capability;
use crate::effects::contact_conductance::Conductance;
use crate::{LOWER, UPPER};
use heat::Material;
use heat::window::{Drive, Stage};
use proto::accuracy::{Accuracy, Simplification};
use proto::configuration::Refusal;
use proto::description::ModelSpec;
use proto::field;
use proto::model::StepError;
use proto::state::{read_numbers, write_numbers};
use std::f64::consts::PI;
use std::io::{self, Read, Write};

/// Number of modes of a rod; the omitted ones decay within 1e-5 L²/κ.
const WAVES: usize = 200;

/// Optional capabilities of the model.
pub const CAPABILITIES: &[Capability] =
    &[Capability::Exchange, Capability::Gaps, Capability::RiseIntegrals];

/// Returns the description of the model.
#[must_use]
pub fn spec() -> ModelSpec {
    let (consumes, provides) = fields();
    ModelSpec {
        name: names::ROD.to_owned(),
        summary: "heat along two rods, end to end or apart, steady and in time".to_owned(),
        source: "Carslaw & Jaeger, Conduction of Heat in Solids, 3.4 and 3.8".to_owned(),
        steady: true,
        transient: true,
        rewinds: true,
        varies_step: true,
        consumes: consumes.into_iter().chain([field::GAP.name.to_owned()]).collect(),
        provides,
        keys: ends::keys(),
        accuracy: Accuracy::default(),
    }
}

/// State of a rod: mode amplitudes at the start of the last window, and that window.
#[derive(Clone, Debug, PartialEq)]
struct Instant {
    /// Mode amplitudes ϑ_n at the start [K].
    start: Vec<f64>,
    duration: f64,
    /// Flux into the rod [W/m²].
    flux: f64,
}

/// One of the two rods.
#[derive(Clone, Debug)]
struct Rod {
    /// Length L [m]; `None` for a body that keeps its initial temperature.
    length: Option<f64>,
    material: Material,
    /// Initial rise of the contact end [K].
    start: f64,
    accepted: Instant,
    trial: Instant,
}

impl Rod {
    fn new(ends: Ends, material: Material) -> Self {
        let mut rod = Self {
            length: ends.length,
            material,
            start: ends.start,
            accepted: Instant { start: vec![0.0; WAVES], duration: 0.0, flux: 0.0 },
            trial: Instant { start: vec![0.0; WAVES], duration: 0.0, flux: 0.0 },
        };
        if let Some(length) = ends.length {
            // A linear initial rise is the steady state of a constant flux.
            let flux = ends.start * material.conductivity / length;
            for wave in 0..WAVES {
                rod.trial.start[wave] = flux * rod.steady(length, wave);
            }
            rod.accepted.start.copy_from_slice(&rod.trial.start);
        }
        rod
    }

    fn wave_number(length: f64, wave: usize) -> f64 {
        (wave as f64 + 0.5) * PI / length
    }

    /// Coefficient c_n [K·m²/W] of the steady state for unit flux.
    fn steady(&self, length: f64, wave: usize) -> f64 {
        let s = Self::wave_number(length, wave);
        let sign = if wave.is_multiple_of(2) { 1.0 } else { -1.0 };
        2.0 * sign / (self.material.conductivity * length * s * s)
    }

    fn decay(&self, length: f64, wave: usize, duration: f64) -> f64 {
        let s = Self::wave_number(length, wave);
        (-self.material.diffusivity() * s * s * duration).exp()
    }

    /// Weighted sum of ϑ, with the weight `always` of the steady state for unit flux and `weight`
    /// of the modes. Returns the contribution of the initial amplitudes, and the response to a unit
    /// flux.
    fn sum(&self, state: &Instant, always: f64, weight: impl Fn(f64) -> f64) -> [f64; 2] {
        let Some(length) = self.length else { return [0.0; 2] };
        let mut sums = [0.0, always];
        for (wave, value) in state.start.iter().enumerate() {
            let decay = self.decay(length, wave, state.duration);
            if decay == 0.0 {
                break;
            }
            let factor = decay * weight(Self::wave_number(length, wave));
            sums[0] += factor * value;
            sums[1] -= factor * self.steady(length, wave);
        }
        sums
    }

    /// Rise of the contact end at the end of a window: contribution of the past, and response to a
    /// unit flux.
    fn end(&self, state: &Instant) -> [f64; 2] {
        let length = self.length.unwrap_or(0.0);
        self.sum(state, length / self.material.conductivity, |s| (s * length).sin())
    }

    fn rise(&self, state: &Instant, depth: f64) -> f64 {
        let Some(length) = self.length.filter(|length| depth <= *length) else { return 0.0 };
        let place = length - depth;
        let [past, response] =
            self.sum(state, place / self.material.conductivity, |s| (s * place).sin());
        past + response * state.flux
    }

    /// Integral ∫ ϑ dz over the length [K·m].
    fn integral(&self, state: &Instant) -> f64 {
        let length = self.length.unwrap_or(0.0);
        let always = 0.5 * length * length / self.material.conductivity;
        let [past, response] = self.sum(state, always, |s| s.recip());
        past + response * state.flux
    }

    /// Sets the trial state to start at the end of the accepted window.
    fn go_on(&mut self) {
        let Some(length) = self.length else { return };
        for wave in 0..WAVES {
            let state = &self.accepted;
            let steady = state.flux * self.steady(length, wave);
            let decay = self.decay(length, wave, state.duration);
            self.trial.start[wave] = steady + (state.start[wave] - steady) * decay;
        }
    }
}

/// Model of two rods in contact or apart.
pub struct Rods {
    rods: [Rod; 2],
    law: Option<Conductance>,
    /// Initial temperature of the upper body minus that of the lower one [K].
    warmer: f64,
    /// Exchanged flux from the upper into the lower body [W/m²].
    flow: f64,
}

impl Conduction for Rods {
    const TRANSIENT: bool = true;
    const SOLVES_STATIONARY_BODY: bool = true;
    const ENDS: bool = true;
    const CAPABILITIES: &'static [Capability] = CAPABILITIES;
    const STATE_TAG: u8 = 6;

    fn check(frame: &Frame) -> Result<(), Refusal> {
        if frame.grid.points() == 1 {
            return Ok(());
        }
        Err(Refusal::new(
            "thermal.model",
            format!("rods meet in one element, and the heat arrives on {}", frame.grid.points()),
            "write [mech] model = \"rod\", or another thermal model",
        ))
    }

    fn new(frame: &Frame) -> Self {
        let scene = &frame.scene;
        let rod = |body: usize| Rod::new(frame.ends[body], scene.materials[body]);
        let [upper, lower] = scene.initial_temperatures;
        Self {
            rods: [rod(UPPER), rod(LOWER)],
            law: frame.conductance,
            warmer: upper - lower,
            flow: 0.0,
        }
    }

    fn cost(_: &Frame) -> Cost {
        Cost { solve_seconds: 1e-5, memory_bytes: 4 * 8 * WAVES as u64 }
    }

    fn left_out(_: &Frame) -> Option<Simplification> {
        None
    }

    fn first(&self, body: usize) -> [f64; 2] {
        let rod = &self.rods[body];
        [rod.start, 0.5 * rod.start * rod.length.unwrap_or(0.0)]
    }

    fn solve(
        &mut self,
        drive: &Drive,
        rub: &InterfaceLoad<'_>,
        rise: &mut [Vec<f64>; 2],
    ) -> Result<SolveStats, StepError> {
        let friction = rub.flux[0];
        let own = drive.shares.map(|share| share * friction);
        let mut ends = [[0.0; 2]; 2];
        for (rod, end) in self.rods.iter_mut().zip(&mut ends) {
            rod.trial.duration = drive.duration;
            *end = rod.end(&rod.trial);
        }
        let [[upper, by_upper], [lower, by_lower]] = ends;
        let law = self.law.filter(|_| rub.pressure.is_some());
        let conductance = law.map_or(0.0, |law| {
            law.across(rub.pressure.map_or(0.0, |p| p[0]), rub.gap.map_or(0.0, |gap| gap[0]))
        });
        let apart = self.warmer + upper + by_upper * own[UPPER] - (lower + by_lower * own[LOWER]);
        self.flow = conductance * apart / (1.0 + conductance * (by_upper + by_lower));
        let fluxes = [own[UPPER] - self.flow, own[LOWER] + self.flow];
        for (at, (rod, [past, response])) in self.rods.iter_mut().zip(ends).enumerate() {
            rod.trial.flux = fluxes[at];
            rise[at][0] = past + response * fluxes[at];
        }
        Ok(SolveStats { operations: 2 * WAVES as u64, heat: own })
    }

    fn rise_integral(&mut self, body: usize, integral: &mut [f64]) -> u64 {
        let rod = &self.rods[body];
        integral.fill(rod.integral(&rod.trial));
        WAVES as u64
    }

    fn exchanged(&self) -> Option<f64> {
        Some(self.flow)
    }

    fn accept(&mut self) {
        for rod in &mut self.rods {
            std::mem::swap(&mut rod.accepted, &mut rod.trial);
            rod.go_on();
        }
    }

    fn section(&mut self, stage: Stage, body: usize, _: usize, depths: &[f64], rise: &mut [f64]) {
        for (depth, rise) in depths.iter().zip(rise) {
            *rise = self.below(stage, body, *depth);
        }
    }

    fn rise_at(&self, body: usize, _: usize, _: f64, depth: f64) -> f64 {
        self.below(Stage::Accepted, body, depth)
    }

    fn peak(&self, _: usize, rise: &[f64]) -> Option<Peak> {
        (rise[0] > 0.0).then_some(Peak { rise: rise[0], x: 0.0, y: 0.0, row: 0 })
    }

    fn save(&self, into: &mut dyn Write) -> io::Result<()> {
        write_numbers(into, [&self.flow])?;
        self.rods.iter().try_for_each(|rod| {
            let Instant { start, duration, flux } = &rod.accepted;
            write_numbers(into, start.iter().chain([duration, flux]))
        })
    }

    fn restore(&mut self, from: &mut dyn Read) -> io::Result<()> {
        let mut flow = 0.0;
        read_numbers(from, [&mut flow])?;
        let mut restored = self.rods.each_ref().map(|rod| rod.accepted.clone());
        for Instant { start, duration, flux } in &mut restored {
            read_numbers(from, start.iter_mut().chain([duration, flux]))?;
        }
        self.flow = flow;
        for (rod, restored) in self.rods.iter_mut().zip(restored) {
            rod.accepted = restored;
            rod.go_on();
        }
        Ok(())
    }
}

impl Rods {
    /// Rise at a depth c = z/(2√κ) [√s] below the contact end of a rod.
    fn below(&self, stage: Stage, body: usize, depth: f64) -> f64 {
        let rod = &self.rods[body];
        let state = if stage == Stage::Trial { &rod.trial } else { &rod.accepted };
        rod.rise(state, 2.0 * depth * rod.material.diffusivity().sqrt())
    }
}
