//! What is known of a scene before it is run, and what effects may say of themselves with it.
//!
//! The flux is that of an ellipse with the power and the size that the mechanics has estimated; its rise is that of a fast source and of
//! one at rest, whose squares of the reciprocals add up: exact at both ends, to a tenth between them, and to a quarter for ellipses six
//! times as long as wide. An estimate is of the first order: it says whether an effect is worth a run,
//! and a run says by how much.

use crate::reference::scales::rest_length;
use crate::scene::Scene;
use crate::{LOWER, UPPER};
use proto::advice::{Advice, Known};
use proto::params::Params;
use std::f64::consts::PI;

const POWER: &str = "contact.friction_power_w";
const SEMI_AXES: [&str; 2] = ["contact.semi_axis_a_m", "contact.semi_axis_b_m"];
const APPROACH: &str = "contact.approach_m";
const SLIP_AREA_RATIO: &str = "contact.slip_area_ratio";

/// Figures of the contact that estimates read; the mechanics describes them.
pub const OF_CONTACT: [&str; 5] = [POWER, SEMI_AXES[0], SEMI_AXES[1], APPROACH, SLIP_AREA_RATIO];

/// Rise under a fast ellipse of flux, over q₀/β √(a/(πV)) (Naeimi et al., eq. 10; PHYSICS: 2.188).
const FAST: f64 = 2.188;

/// Smaller rises are not worth a process [K].
const LEAST_RISE: f64 = 1.0;

/// A scene, as an effect looks at it.
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
    /// Heat that goes into both bodies [W].
    pub heat: [f64; 2],
    /// Speeds of the surfaces [m/s].
    pub speeds: [f64; 2],
    /// Largest rises of both bodies [K].
    pub rises: [f64; 2],
}

impl<'a> Situation<'a> {
    /// Of a scene whose contact is known, and whose heat goes into both bodies by `shares` at some speeds.
    pub fn of(
        scene: &'a Scene,
        case: &'a Params,
        known: &Known,
        shares: impl Fn([f64; 2]) -> [f64; 2],
    ) -> Option<Self> {
        let figure = |key: &str| known.get(key).copied();
        let power = figure(POWER)?;
        let semi_axes = [figure(SEMI_AXES[0])?, figure(SEMI_AXES[1])?];
        let approach = figure(APPROACH)?;
        let rest = |body: usize| if scene.at_rest[body] { 0.0 } else { scene.speeds[body] };
        let speeds = [rest(UPPER), rest(LOWER)];
        let heat = shares(speeds).map(|share| share * power);
        let slips = figure(SLIP_AREA_RATIO).filter(|ratio| *ratio > 0.0).unwrap_or(1.0);
        let mut own =
            Self { scene, case, power, semi_axes, approach, heat, speeds, rises: [0.0; 2] };
        own.rises = [UPPER, LOWER].map(|body| own.rise(body, slips));
        Some(own)
    }

    /// Rise of a body whose heat enters in a part of the contact's length [K].
    fn rise(&self, body: usize, part: f64) -> f64 {
        let [a, b] = [self.semi_axes[0] * part, self.semi_axes[1]];
        let material = &self.scene.materials[body];
        let flux = 1.5 * self.heat[body] / (PI * a * b);
        let rest = flux * rest_length([a, b]) / material.conductivity;
        if self.speeds[body] == 0.0 {
            return rest;
        }
        let fast = FAST * flux / material.effusivity() * (a / (PI * self.speeds[body])).sqrt();
        if fast == 0.0 { 0.0 } else { (fast.powi(-2) + rest.powi(-2)).powf(-0.5) }
    }

    /// The body that becomes hotter.
    #[must_use]
    pub fn hotter(&self) -> usize {
        if self.rises[UPPER] > self.rises[LOWER] { UPPER } else { LOWER }
    }

    /// The key of the largest rise of a body.
    #[must_use]
    pub fn rise_of(&self, body: usize) -> String {
        format!("temperature.{}.max_rise_k", self.scene.names.0[body])
    }

    /// What an effect makes of the rise of a body; nothing of one that is not worth a process.
    #[must_use]
    pub fn moved(&self, advice: Advice, body: usize, relative: f64) -> Advice {
        let counts = self.rises[body] >= LEAST_RISE;
        advice.moves(self.rise_of(body), if counts { relative } else { 0.0 })
    }

    /// Rise of a body behind the contact, integrated over its depth [K·m]: heat per area over its capacity.
    #[must_use]
    pub fn rise_integral(&self, body: usize) -> f64 {
        let (material, [_, b]) = (&self.scene.materials[body], self.semi_axes);
        let swept = self.speeds[body] * 0.5 * PI * b;
        self.heat[body] / (swept * material.density * material.specific_heat)
    }

    /// Va/(2κ) of a body.
    #[must_use]
    pub fn peclet(&self, body: usize) -> f64 {
        0.5 * self.speeds[body] * self.semi_axes[0] / self.scene.materials[body].diffusivity()
    }

    /// What a coefficient of heat transfer [W/(m²·K)] takes of the rise of the hotter body while it is in the contact, relative to it.
    #[must_use]
    pub fn lost_to(&self, coefficient: f64) -> f64 {
        let body = self.hotter();
        let material = &self.scene.materials[body];
        let biot = coefficient * self.semi_axes[0] / material.conductivity;
        let share = biot / (1.0 + self.peclet(body)).sqrt();
        -share / (1.0 + share)
    }
}
