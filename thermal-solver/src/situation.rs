//! Estimates for a scene before it is run, on which the advice of the effects is based.
//!
//! The flux is elliptic, with the power and the size estimated by the mechanics. The rise of a body
//! at rest is exact, at the end of a transient case as well. That of a moving body combines the
//! rises of a fast and of a stationary source: the squares of their reciprocals are added. This is
//! exact in both limits and within 10 % between them; for ellipses six times as long as wide it is
//! within 25 %. In a transient case the fourth powers of the reciprocals of this and of conduction
//! normal to the surface for the time of the case are added. The estimate is of first order: it
//! tells whether an effect is worth a run, and the run gives its size.

use crate::scene::Scene;
use crate::{LOWER, UPPER};
use heat::closed_form::scales::{rest_length, rest_length_after};
use heat::fe::law::Law;
use proto::advice::{self, Advice};
use proto::configuration::Mode;
use proto::figure::contact::{
    APPROACH, FRICTION_POWER, SEMI_AXIS_A, SEMI_AXIS_B, SLIP_AREA_RATIO, max_rise,
};
use proto::params::Params;
use std::f64::consts::PI;

/// Figures of the contact that the estimates read; the mechanical participant provides them.
pub const OF_CONTACT: [&str; 5] =
    [FRICTION_POWER, SEMI_AXIS_A, SEMI_AXIS_B, APPROACH, SLIP_AREA_RATIO];

/// Rise under a fast elliptic flux, over q₀/β √(a/(πV)): the maximum of
/// [`heat::closed_form::ellipse::surface`].
const FAST: f64 = 2.188;

/// Share of the surface rise over which the heat capacity is averaged, for a flux that is constant
/// in time. Let heat capacity over conductivity rise by the relative amount δ per kelvin. Then ∫ λ
/// dT at the surface falls by the relative amount 0.196 δϑ (first-order perturbation of ierfc,
/// integrated numerically). With a constant mean over the share s of the rise it falls by s δϑ/4,
/// which is the same for this s.
const INSIDE: f64 = 0.785;
/// Number of bisection steps in the search for a rise.
const HALVINGS: usize = 50;
/// Coefficient k of the surface height, which is that of a heated layer over 1 + k d/b, with the
/// heated depth d and the semi-axis b across. Fitted to the rise integrals of `moving-source`,
/// within 10 %.
const WEIGHED_LESS: f64 = 1.4;

/// Smallest rise that justifies a thermal participant [K].
const LEAST_RISE: f64 = 1.0;

/// Estimated contact and temperatures of a scene, for the advice of the effects.
#[derive(Debug)]
pub struct Situation<'a> {
    /// Materials and speeds.
    pub scene: &'a Scene,
    /// The values of the case.
    pub case: &'a Params,
    /// Friction power [W].
    pub power: f64,
    /// Semi-axes of the contact [m].
    pub semi_axes: [f64; 2],
    /// Approach of the bodies [m].
    pub approach: f64,
    /// Heat flow into both bodies [W].
    pub heat: [f64; 2],
    /// Surface speeds of both bodies [m/s].
    pub speeds: [f64; 2],
    /// Largest rises of both bodies [K].
    pub rises: [f64; 2],
    /// Share of the contact length in which heat enters [-].
    slips: f64,
    /// Time for which heat has entered [s]; infinite in steady motion.
    pub time: f64,
}

impl<'a> Situation<'a> {
    /// Estimates a scene whose contact is known. `shares` returns the heat partition for the
    /// surface speeds [m/s] and for the rises that all of the heat would cause in either body [K].
    /// `None` if a figure of the contact is missing.
    pub fn of(
        scene: &'a Scene,
        asked: &'a advice::Scene,
        shares: impl Fn([f64; 2], [f64; 2]) -> [f64; 2],
    ) -> Option<Self> {
        let figure = |key: &str| asked.known.get(key).copied();
        let power = figure(FRICTION_POWER)?;
        let semi_axes = [figure(SEMI_AXIS_A)?, figure(SEMI_AXIS_B)?];
        let approach = figure(APPROACH)?;
        let rest = |body: usize| if scene.at_rest[body] { 0.0 } else { scene.speeds[body] };
        let speeds = [rest(UPPER), rest(LOWER)];
        let slips = figure(SLIP_AREA_RATIO).filter(|ratio| *ratio > 0.0).unwrap_or(1.0);
        let time = match asked.mode {
            Mode::Steady => f64::INFINITY,
            Mode::Transient => asked.case.maybe_number("time.end").ok()?.unwrap_or(f64::INFINITY),
        };
        let mut own = Self {
            scene,
            case: &asked.case,
            power,
            semi_axes,
            approach,
            heat: [power; 2],
            speeds,
            rises: [0.0; 2],
            slips,
            time,
        };
        let rises = own.estimate();
        let shares = shares(speeds, rises);
        own.heat = shares.map(|share| share * power);
        own.rises = own.estimate();
        Some(own)
    }

    /// Estimates the largest rises of both bodies [K] for their heat.
    fn estimate(&self) -> [f64; 2] {
        [UPPER, LOWER].map(|body| {
            let material = &self.scene.materials[body];
            self.potential(body, material.diffusivity()) / material.conductivity
        })
    }

    /// Largest λ ϑ [W/m] of a body with the given diffusivity [m²/s]; the value of ∫ λ dT if λ
    /// depends on the temperature.
    fn potential(&self, body: usize, diffusivity: f64) -> f64 {
        let [a, b] = [self.semi_axes[0] * self.slips, self.semi_axes[1]];
        let flux = 1.5 * self.heat[body] / (PI * a * b);
        let spread = (4.0 * diffusivity * self.time).sqrt();
        if self.speeds[body] == 0.0 {
            return flux * rest_length_after([a, b], spread);
        }
        let rest = flux * rest_length([a, b]);
        let fast = FAST * flux * (diffusivity * a / (PI * self.speeds[body])).sqrt();
        if fast == 0.0 {
            return 0.0;
        }
        let early = flux * spread / PI.sqrt();
        let steady = (fast.powi(-2) + rest.powi(-2)).powf(-0.5);
        (steady.powi(-4) + early.powi(-4)).powf(-0.25)
    }

    /// Returns the largest rise of a body whose properties depend on temperature [K].
    ///
    /// For a stationary body ∫ λ dT is the same as for a constant λ. For a moving body the
    /// diffusivity matters as well, as a mean from the initial temperature to [`INSIDE`] of the
    /// rise.
    #[must_use]
    pub fn rise_with(&self, body: usize, law: &Law) -> f64 {
        let (mut low, mut high) = (0.0, self.potential(body, f64::INFINITY));
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            let inside = INSIDE * middle;
            if self.potential(body, inside / law.held(inside).heat) > middle {
                low = middle;
            } else {
                high = middle;
            }
        }
        law.rise(high)
    }

    /// Returns the body with the higher rise.
    #[must_use]
    pub fn hotter(&self) -> usize {
        if self.rises[UPPER] > self.rises[LOWER] { UPPER } else { LOWER }
    }

    /// Returns the key of the largest rise of a body.
    #[must_use]
    pub fn rise_of(&self, body: usize) -> String {
        max_rise(&self.scene.names.0[body])
    }

    /// Adds the relative change of a body's rise to an advice; zero if the rise is too small to
    /// justify a thermal participant.
    #[must_use]
    pub fn moved(&self, advice: Advice, body: usize, relative: f64) -> Advice {
        let counts = self.rises[body] >= LEAST_RISE;
        advice.moves(self.rise_of(body), if counts { relative } else { 0.0 })
    }

    /// Heat per area that a passage of the elliptic flux leaves in the middle of a body's track
    /// [J/m²].
    #[must_use]
    pub fn left_behind(&self, body: usize) -> f64 {
        self.heat[body] / (self.speeds[body] * 4.0 / 3.0 * self.semi_axes[1])
    }

    /// Rise of a body behind the contact, or of a body at rest within it, integrated over the depth
    /// with the weight of the surface height ([`heat::moving_source::rise_integral`]) [K·m]. It is
    /// the heat per area over the heat capacity, reduced by [`Situation::spread`] because deep heat
    /// raises more than the surface above it. Infinite for a stationary body in a steady case.
    #[must_use]
    pub fn rise_integral(&self, body: usize) -> f64 {
        let (material, [a, b]) = (&self.scene.materials[body], self.semi_axes);
        let left = match self.speeds[body] {
            0.0 => 1.5 * self.heat[body] / (PI * a * b) * self.time,
            _ => self.left_behind(body),
        };
        match left {
            f64::INFINITY => left,
            _ => left / (material.density * material.specific_heat) / self.spread(body),
        }
    }

    /// Factor by which heat spreads beyond the width of the contact below it, 1 + k d/b with the
    /// depth d that it has reached.
    #[must_use]
    pub fn spread(&self, body: usize) -> f64 {
        let heated = match self.speeds[body] {
            0.0 => self.time,
            speed => 2.0 * self.semi_axes[0] / speed,
        };
        let depth = (self.scene.materials[body].diffusivity() * heated).sqrt();
        1.0 + WEIGHED_LESS * depth / self.semi_axes[1]
    }

    /// Péclet number Va/(2κ) of a body.
    #[must_use]
    pub fn peclet(&self, body: usize) -> f64 {
        0.5 * self.speeds[body] * self.semi_axes[0] / self.scene.materials[body].diffusivity()
    }

    /// Relative change of the rise of the hotter body that a heat transfer coefficient [W/(m²·K)]
    /// causes while material passes the contact.
    #[must_use]
    pub fn lost_to(&self, coefficient: f64) -> f64 {
        let body = self.hotter();
        let material = &self.scene.materials[body];
        let biot = coefficient * self.semi_axes[0] / material.conductivity;
        let share = biot / (1.0 + self.peclet(body)).sqrt();
        -share / (1.0 + share)
    }
}

/// Formats a power [W], in kilowatts from one on.
#[must_use]
pub fn watts(power: f64) -> String {
    match power.abs() >= 1e3 {
        true => format!("{:.2} kW", 1e-3 * power),
        false => format!("{power:.2} W"),
    }
}
