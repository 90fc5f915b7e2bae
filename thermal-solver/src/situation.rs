//! What is known of a scene before it is run, and what effects may say of themselves with it.
//!
//! The flux is that of an ellipse with the power and the size that the mechanics has estimated; its rise is that of a fast source and of
//! one at rest, whose squares of the reciprocals add up: exact at both ends, to a tenth between them, and to a quarter for ellipses six
//! times as long as wide. An estimate is of the first order: it says whether an effect is worth a run,
//! and a run says by how much.

use crate::scene::Scene;
use crate::{LOWER, UPPER};
use heat::closed_form::scales::rest_length;
use heat::fe::law::Law;
use proto::advice::{Advice, Known};
use proto::figure::contact::{
    APPROACH, FRICTION_POWER, SEMI_AXIS_A, SEMI_AXIS_B, SLIP_AREA_RATIO, max_rise,
};
use proto::params::Params;
use std::f64::consts::PI;

/// Figures of the contact that estimates read; the mechanics describes them.
pub const OF_CONTACT: [&str; 5] =
    [FRICTION_POWER, SEMI_AXIS_A, SEMI_AXIS_B, APPROACH, SLIP_AREA_RATIO];

/// Rise under a fast ellipse of flux, over q₀/β √(a/(πV)): the maximum of
/// [`heat::closed_form::ellipse::surface`].
const FAST: f64 = 2.188;

/// Share of the rise of the surface up to which the heat capacity counts, for a flux that is
/// constant in time. With heat capacity over conductivity rising by δ of itself a kelvin, ∫ λ dT at
/// the surface falls by 0.196 δϑ of itself (the first-order perturbation of ierfc, integrated
/// numerically), and for the mean over a share of the rise by a quarter of that share.
const INSIDE: f64 = 0.785;
/// Halvings of the range in which a rise is looked for.
const HALVINGS: usize = 50;
/// Depth of the heat over the semi-axis across, times this, is what the height of a warm surface
/// lacks of that of a layer: fitted to the rise integrals of `moving-source`, to a tenth.
const WEIGHED_LESS: f64 = 1.4;

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
    /// Part of the contact's length in which heat enters [-].
    slips: f64,
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
        let power = figure(FRICTION_POWER)?;
        let semi_axes = [figure(SEMI_AXIS_A)?, figure(SEMI_AXIS_B)?];
        let approach = figure(APPROACH)?;
        let rest = |body: usize| if scene.at_rest[body] { 0.0 } else { scene.speeds[body] };
        let speeds = [rest(UPPER), rest(LOWER)];
        let heat = shares(speeds).map(|share| share * power);
        let slips = figure(SLIP_AREA_RATIO).filter(|ratio| *ratio > 0.0).unwrap_or(1.0);
        let mut own =
            Self { scene, case, power, semi_axes, approach, heat, speeds, rises: [0.0; 2], slips };
        own.rises = [UPPER, LOWER].map(|body| {
            let material = &scene.materials[body];
            own.potential(body, material.diffusivity()) / material.conductivity
        });
        Some(own)
    }

    /// Largest λ ϑ of a body with a diffusivity [m²/s], or ∫ λ dT where λ depends on the
    /// temperature [W/m].
    fn potential(&self, body: usize, diffusivity: f64) -> f64 {
        let [a, b] = [self.semi_axes[0] * self.slips, self.semi_axes[1]];
        let flux = 1.5 * self.heat[body] / (PI * a * b);
        let rest = flux * rest_length([a, b]);
        if self.speeds[body] == 0.0 {
            return rest;
        }
        let fast = FAST * flux * (diffusivity * a / (PI * self.speeds[body])).sqrt();
        if fast == 0.0 { 0.0 } else { (fast.powi(-2) + rest.powi(-2)).powf(-0.5) }
    }

    /// Largest rise of a body whose properties depend on temperature [K].
    ///
    /// At rest ∫ λ dT is what it is for a constant λ. In motion the diffusivity counts as well, as
    /// a mean from the initial temperature to [`INSIDE`] of the rise.
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

    /// The body that becomes hotter.
    #[must_use]
    pub fn hotter(&self) -> usize {
        if self.rises[UPPER] > self.rises[LOWER] { UPPER } else { LOWER }
    }

    /// The key of the largest rise of a body.
    #[must_use]
    pub fn rise_of(&self, body: usize) -> String {
        max_rise(&self.scene.names.0[body])
    }

    /// What an effect makes of the rise of a body; nothing of one that is not worth a process.
    #[must_use]
    pub fn moved(&self, advice: Advice, body: usize, relative: f64) -> Advice {
        let counts = self.rises[body] >= LEAST_RISE;
        advice.moves(self.rise_of(body), if counts { relative } else { 0.0 })
    }

    /// Heat per area that a passage leaves in the middle of a body's track, over the half-ellipse
    /// of the flux [J/m²].
    #[must_use]
    pub fn left_behind(&self, body: usize) -> f64 {
        self.heat[body] / (self.speeds[body] * 4.0 / 3.0 * self.semi_axes[1])
    }

    /// Rise of a body behind the contact, integrated over its depth as the height of its surface
    /// feels it ([`heat::moving_source::rise_integral`]) [K·m]: heat per area over the heat
    /// capacity, less what has gone so deep that more than the place above it is raised. Infinite
    /// for a body at rest.
    #[must_use]
    pub fn rise_integral(&self, body: usize) -> f64 {
        let (material, [a, b]) = (&self.scene.materials[body], self.semi_axes);
        if self.speeds[body] == 0.0 {
            return f64::INFINITY;
        }
        let depth = (2.0 * material.diffusivity() * a / self.speeds[body]).sqrt();
        let layer = self.left_behind(body) / (material.density * material.specific_heat);
        layer / (1.0 + WEIGHED_LESS * depth / b)
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
