//! What effects contribute to a contact: terms of a few kinds.
//!
//! The registry entry of an effect makes its terms ([`crate::effects`]); the model that runs holds the
//! terms of all active effects, a list a kind, and takes each kind in one place. A list without terms
//! costs nothing.
//!
//! | [`Kind`] | a term is | it enters |
//! |---|---|---|
//! | `Gap` | heights [m] | the undeformed distance, to which they are added |
//! | `Friction` | a law for the friction coefficients of the elements | the traction bound, before every solve |
//! | `Bands` | factors on them over a coordinate | the same; one of the laws |
//! | `PressureBound` | a largest pressure [Pa], of several the smallest | the normal contact |
//! | `Adhesion` | that surfaces may stick | the tangential contact; without it all of the contact slides |
//! | `Layer` | a tangential flexibility [m/Pa], in series | the displacement difference |
//! | `Yield` | how the yield stress of a layer changes with its plastic shift | the tangential contact |
//! | `Expansion` | coefficients of thermal expansion [1/K] | the undeformed distance, or the stress of finite elements |
//! | `Softening` | stiffness and yield stress over temperature | the stress of finite elements |
//! | `Flow` | how the material of each body flows | the stress of finite elements |
//! | `Retardation` | what the compliance of each body gains with time | the displacement difference |
//! | `Axle` | a mass that carries the load, and what it runs over | the height of the upper body |
//! | `HeatShare` | a factor | the friction power that is provided as heat |
//! | `Removal` | what an accepted contact takes off both bodies | the undeformed distance of the next one |
//! | `Observation` | fields and figures of an accepted contact | the outputs and the summary |
//!
//! A model declares the kinds that it takes, an effect those that it makes; a model supports the
//! effects all of whose kinds it takes.

pub(crate) use crate::state::{Accepted, State};

use crate::axle::Axle;
use crate::bands::Bands;
use crate::explicit::kernel::Flow;
use crate::half_space::viscoelastic::Retardation;
use crate::half_space::yielding::Yield;
use crate::removal::Removal;
use crate::slip::SlipStart;
use crate::softening::Softening;
use proto::configuration::Refusal;
use proto::field::FieldSpec;
use proto::grid::{Shape, Structured};
use proto::model::{Inputs, Outputs, StateError, StepError};
use serde_json::Value;
use std::fmt::Debug;
use std::io::{self, Read, Write};

/// The kinds of terms.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Heights of the surfaces.
    Gap,
    /// Friction coefficients of the elements.
    Friction,
    /// Factors on friction coefficients over a coordinate.
    Bands,
    /// Largest pressure.
    PressureBound,
    /// Surfaces that may stick.
    Adhesion,
    /// Tangential flexibility between the surfaces.
    Layer,
    /// A layer that flows plastically.
    Yield,
    /// Materials that expand where they are warm.
    Expansion,
    /// Materials that are softer where they are warm.
    Softening,
    /// Materials that flow.
    Flow,
    /// Materials whose compliance grows with time.
    Retardation,
    /// What carries the load, and runs over irregularities.
    Axle,
    /// Part of the friction power that becomes heat.
    HeatShare,
    /// Material that the contact takes off.
    Removal,
    /// What is computed of an accepted contact.
    Observation,
}

/// A term of the undeformed distance.
pub(crate) trait GapTerm: State + Debug {
    /// Height at a place from the origin of the undeformed contact [m]; positive opens the gap.
    fn height(&self, x: f64, y: f64) -> f64;

    /// Repeats along x and y every so many metres from now on.
    ///
    /// # Errors
    /// It cannot, or not without becoming another surface.
    fn repeat(&mut self, periods: [f64; 2]) -> Result<(), Refusal>;
}

/// What a friction law may depend on.
#[derive(Clone, Copy)]
pub(crate) struct Rubbing<'a> {
    /// What comes in.
    pub(crate) inputs: &'a dyn Inputs,
    /// Rolling speed V [m/s].
    pub(crate) speed: f64,
    /// Slip velocity that an element would have if the bodies were rigid [m/s].
    pub(crate) rigid_slip: &'a dyn Fn(usize) -> f64,
    /// The elements.
    pub(crate) grid: &'a Structured,
    /// Lateral coordinate of their origin in the case [m].
    pub(crate) origin_y: f64,
    /// Their pressure [Pa].
    pub(crate) pressure: &'a [f64],
    /// Slip velocity of every element, where a law follows that [m/s].
    pub(crate) velocity: Option<&'a [f64]>,
}

/// A term of the friction law.
pub(crate) trait FrictionTerm: State + Debug {
    /// Changes the friction coefficients of the elements, which enter as those of the case and of the terms before.
    ///
    /// # Errors
    /// An input is missing or unusable, or the law has no value for it.
    fn apply(&self, rubbing: &Rubbing<'_>, friction: &mut [f64]) -> Result<(), StepError>;

    /// The factors over a coordinate that it is.
    fn bands(&self) -> Option<&Bands> {
        None
    }

    /// It depends on the slip, so that a prescribed force and its creepage are found together.
    fn follows_slip(&self) -> bool {
        false
    }

    /// It depends on the slip of every element itself, looked for from here.
    fn follows_elements(&self) -> Option<SlipStart> {
        None
    }

    /// It depends on what comes in.
    fn follows_inputs(&self) -> bool {
        !self.follows_slip()
    }

    /// Why friction may carry less than a prescribed force.
    fn shortfall(&self) -> &'static str;
}

/// Where a contact is solved.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Place {
    /// The contact's grid.
    pub(crate) grid: Structured,
    /// Semi-axes, or what comes near them [m].
    pub(crate) semi_axes: [f64; 2],
    /// Lateral coordinate of the highest pressure without friction [m].
    pub(crate) peak_y: f64,
}

/// Fields and figures of an accepted contact.
pub(crate) trait Observation: State + Debug {
    /// Learns where the contact is solved; comes before all else.
    fn place(&mut self, place: &Place);

    /// Learns that both bodies expand where they are warm, with these coefficients [1/K], and how fast they pass [m/s].
    ///
    /// # Errors
    /// It has no answer to that.
    fn expand(&mut self, coefficients: [f64; 2], speeds: [f64; 2]) -> Result<(), Refusal>;

    /// Grids of its own, by name.
    fn grids(&self) -> Vec<(&'static str, Shape)>;

    /// Which of them a field is on; `None` for the fields of others.
    fn grid_of(&self, field: &FieldSpec) -> Option<&'static str>;

    /// Computes from an accepted contact.
    fn observe(&mut self, accepted: &Accepted<'_>);

    /// Writes those of its fields that are asked for.
    fn write(&self, outputs: &mut dyn Outputs);

    /// Its section of `summary.json`, by name; `None` before anything was observed.
    fn summary(&self) -> Option<(&'static str, Value)>;
}

/// The terms of all active effects.
#[derive(Debug, Default)]
pub(crate) struct Terms {
    /// The active effects, with the kinds that they make.
    pub(crate) effects: Vec<(&'static str, &'static [Kind])>,
    pub(crate) gap: Vec<Box<dyn GapTerm>>,
    pub(crate) friction: Vec<Box<dyn FrictionTerm>>,
    pub(crate) pressure_bounds: Vec<f64>,
    pub(crate) adhesion: bool,
    pub(crate) layers: Vec<f64>,
    pub(crate) yields: Option<Yield>,
    pub(crate) expansion: Option<[f64; 2]>,
    pub(crate) softening: [Option<Softening>; 2],
    pub(crate) flow: [Option<Flow>; 2],
    pub(crate) retardation: [Option<Retardation>; 2],
    pub(crate) axle: Option<Axle>,
    pub(crate) heat_shares: Vec<f64>,
    pub(crate) removal: Option<Removal>,
    pub(crate) observations: Vec<Box<dyn Observation>>,
}

impl Terms {
    /// Adds the terms of one more effect.
    pub(crate) fn join(&mut self, name: &'static str, kinds: &'static [Kind], more: Self) {
        self.effects.push((name, kinds));
        self.gap.extend(more.gap);
        self.friction.extend(more.friction);
        self.pressure_bounds.extend(more.pressure_bounds);
        self.adhesion |= more.adhesion;
        self.layers.extend(more.layers);
        self.yields = self.yields.or(more.yields);
        for (own, more) in self.softening.iter_mut().zip(more.softening) {
            *own = own.take().or(more);
        }
        for (own, more) in self.flow.iter_mut().zip(more.flow) {
            *own = own.or(more);
        }
        for (own, more) in self.retardation.iter_mut().zip(more.retardation) {
            *own = own.or(more);
        }
        self.expansion = self.expansion.or(more.expansion);
        self.axle = self.axle.or(more.axle);
        self.heat_shares.extend(more.heat_shares);
        self.removal = self.removal.take().or(more.removal);
        self.observations.extend(more.observations);
    }

    /// The first active effect that makes terms of a kind.
    pub(crate) fn effect_of(&self, kind: Kind) -> Option<&'static str> {
        self.effects.iter().find(|(_, kinds)| kinds.contains(&kind)).map(|(name, _)| *name)
    }

    /// Sum of the heights at a place, and what has been worn off there [m].
    pub(crate) fn height(&self, x: f64, y: f64) -> f64 {
        let worn = self.removal.as_ref().map_or(0.0, |removal| removal.depth(y));
        self.gap.iter().map(|term| term.height(x, y)).sum::<f64>() + worn
    }

    /// Friction coefficients of elements, from that of the case.
    ///
    /// # Errors
    /// Those of [`FrictionTerm::apply`].
    pub(crate) fn friction(
        &self,
        coefficient: f64,
        rubbing: &Rubbing<'_>,
        friction: &mut Vec<f64>,
    ) -> Result<(), StepError> {
        friction.clear();
        friction.resize(rubbing.grid.points(), coefficient);
        self.friction.iter().try_for_each(|term| term.apply(rubbing, friction))
    }

    /// The first active effect that changes friction coefficients.
    pub(crate) fn friction_effect(&self) -> Option<&'static str> {
        self.effect_of(Kind::Friction).or_else(|| self.effect_of(Kind::Bands))
    }

    /// Friction depends on the slip that it allows.
    pub(crate) fn friction_follows_slip(&self) -> bool {
        self.friction.iter().any(|term| term.follows_slip())
    }

    /// Friction depends on the slip of every element itself, looked for from here.
    pub(crate) fn friction_follows_elements(&self) -> Option<SlipStart> {
        self.friction.iter().find_map(|term| term.follows_elements())
    }

    /// The smallest of the largest pressures; infinite without one [Pa].
    pub(crate) fn pressure_bound(&self) -> f64 {
        self.pressure_bounds.iter().copied().fold(f64::INFINITY, f64::min)
    }

    /// The pressure of smooth bodies stays that of Hertz.
    pub(crate) fn leave_hertz(&self) -> bool {
        let as_given = self.gap.is_empty() && self.pressure_bounds.is_empty();
        as_given && self.expansion.is_none() && self.removal.is_none()
    }

    /// The contact depends on what comes in.
    pub(crate) fn follow_inputs(&self) -> bool {
        self.friction.iter().any(|term| term.follows_inputs()) || self.warms()
    }

    /// Materials expand or soften where they are warm.
    pub(crate) fn warms(&self) -> bool {
        self.expansion.is_some() || self.softens()
    }

    /// A material softens where it is warm.
    pub(crate) fn softens(&self) -> bool {
        self.softening.iter().any(Option::is_some)
    }

    /// Flexibility of all layers together [m/Pa].
    pub(crate) fn layer(&self) -> f64 {
        self.layers.iter().sum()
    }

    /// Leaves of a friction power what becomes heat.
    pub(crate) fn keep_heat(&self, power: &mut [f64]) {
        for share in &self.heat_shares {
            power.iter_mut().for_each(|power| *power *= share);
        }
    }

    fn states(&self) -> impl Iterator<Item = &dyn State> {
        let gap = self.gap.iter().map(|term| &**term as &dyn State);
        let friction = self.friction.iter().map(|term| &**term as &dyn State);
        let removal = self.removal.iter().map(|removal| removal as &dyn State);
        let observations = self.observations.iter().map(|term| &**term as &dyn State);
        gap.chain(friction).chain(removal).chain(observations)
    }

    fn states_mut(&mut self) -> impl Iterator<Item = &mut dyn State> {
        let gap = self.gap.iter_mut().map(|term| &mut **term as &mut dyn State);
        let friction = self.friction.iter_mut().map(|term| &mut **term as &mut dyn State);
        let observations = self.observations.iter_mut().map(|term| &mut **term as &mut dyn State);
        let removal = self.removal.iter_mut().map(|removal| removal as &mut dyn State);
        gap.chain(friction).chain(removal).chain(observations)
    }

    /// The last solve becomes the accepted state of every term.
    pub(crate) fn accept(&mut self) {
        self.states_mut().for_each(State::accept);
    }

    /// Writes the accepted states, one after the other.
    ///
    /// # Errors
    /// Those of `into`.
    pub(crate) fn save(&self, into: &mut dyn Write) -> io::Result<()> {
        self.states().try_for_each(|term| term.save(into))
    }

    /// Reads back what [`Terms::save`] wrote.
    ///
    /// # Errors
    /// It does not fit.
    pub(crate) fn restore(&mut self, from: &mut dyn Read) -> Result<(), StateError> {
        self.states_mut().try_for_each(|term| term.restore(from))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proto::state::{read_numbers, write_numbers};

    /// A height that grows with every accepted state.
    #[derive(Debug)]
    struct Growing {
        height: f64,
        by: f64,
    }

    impl State for Growing {
        fn accept(&mut self) {
            self.height += self.by;
        }

        fn save(&self, into: &mut dyn Write) -> io::Result<()> {
            write_numbers(into, [&self.height])
        }

        fn restore(&mut self, from: &mut dyn Read) -> Result<(), StateError> {
            Ok(read_numbers(from, [&mut self.height])?)
        }
    }

    impl GapTerm for Growing {
        fn height(&self, _x: f64, _y: f64) -> f64 {
            self.height
        }

        fn repeat(&mut self, _periods: [f64; 2]) -> Result<(), Refusal> {
            Ok(())
        }
    }

    /// Terms of two effects in one list: their contributions add up, their states are accepted, saved
    /// and restored one after the other, and a state that is cut off is refused.
    #[test]
    fn terms_add_up_and_keep_their_states() {
        let growing = |by: f64| -> Box<dyn GapTerm> { Box::new(Growing { height: 0.0, by }) };
        let mut terms = Terms::default();
        let one = Terms { gap: vec![growing(1.0)], layers: vec![2.0], ..Terms::default() };
        let other = Terms {
            gap: vec![growing(10.0)],
            layers: vec![3.0],
            pressure_bounds: vec![5.0, 4.0],
            heat_shares: vec![0.5],
            ..Terms::default()
        };
        assert!(terms.leave_hertz() && terms.pressure_bound() == f64::INFINITY);
        terms.join("one", &[Kind::Gap, Kind::Layer], one);
        terms.join("other", &[Kind::PressureBound], other);
        assert_eq!((terms.layer(), terms.pressure_bound(), terms.adhesion), (5.0, 4.0, false));
        assert_eq!(terms.effect_of(Kind::PressureBound), Some("other"));
        assert!(!terms.leave_hertz());
        let mut power = [4.0, 0.0];
        terms.keep_heat(&mut power);
        assert_eq!(power, [2.0, 0.0]);
        terms.accept();
        terms.accept();
        let mut saved = Vec::new();
        terms.save(&mut saved).unwrap();
        terms.accept();
        assert_eq!(terms.height(0.0, 0.0), 33.0);
        terms.restore(&mut saved.as_slice()).unwrap();
        assert_eq!(terms.height(0.0, 0.0), 22.0);
        assert!(terms.restore(&mut &saved[..9]).is_err());
    }
}
