//! Estimates for a scene before it is run, and the methods by which effects estimate their
//! influence.
//!
//! The contact is estimated by Hertz's theory and Kalker's simplified theory (milliseconds).
//! Temperatures are the estimates of the thermal side. Estimates are of first order: they show
//! whether an effect is worth a run, and a run shows the size of the effect.

use crate::case::scene::Scene;
use proto::advice::{Advice, Known};
use proto::figure::contact::{APPROACH, is_max_rise};
use proto::params::Params;
use proto::readable::quantity;

pub(crate) use proto::figure::contact::{
    CREEPAGE_XI as CREEPAGE, FRICTION_POWER as POWER, MAX_PRESSURE as PRESSURE,
};

/// Estimate of the contact of a scene.
pub(crate) type Estimate<'a> = dyn Fn(&Scene, bool, Option<f64>) -> Option<Known> + 'a;

/// Scene with its estimates, as an effect sees it.
pub(crate) struct Situation<'a> {
    pub(crate) scene: &'a Scene,
    pub(crate) case: &'a Params,
    /// True if surfaces may stick.
    pub(crate) sticks: bool,
    pub(crate) known: &'a Known,
    /// Estimates the quantities of the contact of a scene by their keys; the flag is true if
    /// surfaces may stick, the number is the largest traction, if it is limited [Pa].
    pub(crate) estimated: &'a Estimate<'a>,
}

impl Situation<'_> {
    /// Returns an estimated quantity, if it is known.
    pub(crate) fn known(&self, key: &str) -> Option<f64> {
        self.known.get(key).copied()
    }

    /// Returns true if the case has the effect.
    pub(crate) fn has(&self, effect: &str) -> bool {
        self.case.has(&format!("effects.{effect}"))
    }

    /// Largest temperature rise of the bodies [K].
    pub(crate) fn largest_rise(&self) -> Option<f64> {
        let rises = self.known.iter().filter(|(key, _)| is_max_rise(key));
        rises.map(|(_, rise)| *rise).reduce(f64::max)
    }

    /// Largest pressure [Pa] and approach [m].
    pub(crate) fn pressed(&self) -> Option<[f64; 2]> {
        Some([self.known(PRESSURE)?, self.known(APPROACH)?])
    }

    /// Estimates a quantity of the contact with another friction coefficient, with or without
    /// sticking; `None` if friction does not carry the force.
    pub(crate) fn otherwise(&self, key: &str, friction: f64, sticks: bool) -> Option<f64> {
        let scene = Scene { friction_coefficient: friction, ..self.scene.clone() };
        (self.estimated)(&scene, sticks, None)?.get(key).copied()
    }

    /// Estimates the influence of a layer with a shear yield stress [Pa] that is named by a key:
    /// the friction of Hertz's pressure is cut off at it.
    pub(crate) fn cut_off(&self, effect: &str, key: &str, yield_stress: f64) -> Advice {
        let advice = Advice::new(
            effect,
            format!(
                "friction cut off at {yield_stress}",
                yield_stress = quantity(yield_stress, "Pa", 2)
            ),
        )
        .with(format!("{key}={yield_stress:e}"));
        let friction = self.scene.friction_coefficient;
        let Some(largest) = self.known(PRESSURE).map(|pressure| friction * pressure) else {
            return advice;
        };
        let advice = advice.number("yield stress over largest friction", yield_stress / largest);
        if yield_stress >= largest {
            return advice.moves(POWER, 0.0);
        }
        let power = |largest: f64| {
            (self.estimated)(self.scene, self.sticks, Some(largest))?.get(POWER).copied()
        };
        let Some(now) = power(f64::INFINITY).filter(|power| *power > 0.0) else { return advice };
        match power(yield_stress) {
            Some(then) => advice.moves(POWER, then / now - 1.0),
            None => advice.impossible(),
        }
    }

    /// Adds the relative change of the friction power for another friction coefficient.
    pub(crate) fn with_friction(&self, advice: Advice, friction: f64) -> Advice {
        let now = self.otherwise(POWER, self.scene.friction_coefficient, self.sticks);
        let Some(now) = now.filter(|power| *power > 0.0) else { return advice };
        match self.otherwise(POWER, friction, self.sticks) {
            Some(then) => advice.moves(POWER, then / now - 1.0),
            None => advice.impossible(),
        }
    }

    /// Names of the materials of both bodies, each once.
    pub(crate) fn materials(&self) -> Vec<&str> {
        let of = |body: usize| self.case.text(&self.scene.names.key(body, "material")).ok();
        let mut names: Vec<&str> = (0..2).filter_map(of).collect();
        names.dedup();
        names
    }
}
