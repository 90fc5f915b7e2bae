//! What effects contribute to a contact: terms of a few kinds.
//!
//! The registry entry of an effect makes its terms ([`crate::effects`]); the model that runs holds the
//! terms of all active effects, a list a kind, and takes each kind in one place. A list without terms
//! costs nothing.
//!
//! | [`Kind`] | a term is | it enters |
//! |---|---|---|
//! | `Gap` | heights [m] | the undeformed distance, to which they are added |
//! | `FrictionFactor` | factors on the friction coefficient of the case | the traction bound, before every solve; several multiply |
//! | `LocalSlip` | such factors by the slip of every element | the same, in turn with that slip |
//! | `RailPlace` | such factors by a place on a rail of a track | the same |
//! | `TractionBound` | a largest traction [Pa] | the same; the smallest holds, after all factors |
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

pub(crate) use crate::terms::state::{Accepted, State};

pub(crate) mod axle_load;
pub(crate) mod bands;
pub mod friction;
pub(crate) mod removal;
pub(crate) mod softening;
pub(crate) mod state;
pub(crate) mod surface;
pub(crate) mod thermal_stress;

use crate::terms::friction::FrictionLaw;
use crate::terms::removal::Removal;
use crate::terms::softening::Softening;
use elastic::axle::Axle;
use explicit_fe::kernel::Flow;
use half_space::viscoelastic::Retardation;
use half_space::yielding::Yield;
use proto::configuration::Refusal;
use proto::field::FieldSpec;
use proto::grid::{Shape, Structured};
use proto::model::{Outputs, StateError};
use serde_json::Value;
use std::fmt::Debug;
use std::io::{self, Read, Write};

/// The kinds of terms.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Heights of the surfaces.
    Gap,
    /// Factors on the friction coefficient of the case.
    FrictionFactor,
    /// Such factors by the slip of every element with its elastic part.
    LocalSlip,
    /// Such factors by a place on a rail of a track.
    RailPlace,
    /// Largest traction.
    TractionBound,
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

impl Kind {
    /// A contact has at most one of it.
    pub(crate) fn is_exclusive(self) -> bool {
        match self {
            Self::Yield
            | Self::Expansion
            | Self::Softening
            | Self::Flow
            | Self::Retardation
            | Self::Axle
            | Self::Removal => true,
            Self::Gap
            | Self::FrictionFactor
            | Self::LocalSlip
            | Self::RailPlace
            | Self::TractionBound
            | Self::PressureBound
            | Self::Adhesion
            | Self::Layer
            | Self::HeatShare
            | Self::Observation => false,
        }
    }
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

/// A kind that the value of a key needs a model to take, beyond those that its effect always makes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Need {
    pub(crate) kind: Kind,
    pub(crate) key: &'static str,
    /// The model lacks this.
    pub(crate) lacks: &'static str,
    /// Value of the key that every model takes.
    pub(crate) instead: &'static str,
}

/// The terms of all active effects.
#[derive(Debug, Default)]
pub(crate) struct Terms {
    /// The active effects, with the kinds that they make.
    pub(crate) effects: Vec<(&'static str, &'static [Kind])>,
    pub(crate) gap: Vec<Box<dyn GapTerm>>,
    pub(crate) friction: FrictionLaw,
    /// Capabilities of a model that values of keys need.
    pub(crate) needs: Vec<Need>,
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
    ///
    /// # Errors
    /// Refuses a second effect of a kind of which a contact has one; both are named.
    pub(crate) fn join(
        &mut self,
        name: &'static str,
        kinds: &'static [Kind],
        more: Self,
    ) -> Result<(), Refusal> {
        for kind in kinds.iter().filter(|kind| kind.is_exclusive()) {
            if let Some(first) = self.effect_of(*kind) {
                return Err(Refusal::new(
                    &format!("effects.{name}"),
                    format!(
                        "and effects.{first} exclude each other: both make the one `{kind:?}` that a contact has"
                    ),
                    format!("remove [effects.{first}] or [effects.{name}]"),
                ));
            }
        }
        self.effects.push((name, kinds));
        self.gap.extend(more.gap);
        self.friction.join(more.friction);
        self.needs.extend(more.needs);
        self.pressure_bounds.extend(more.pressure_bounds);
        self.adhesion |= more.adhesion;
        self.layers.extend(more.layers);
        self.heat_shares.extend(more.heat_shares);
        self.observations.extend(more.observations);
        // No earlier effect has made a term of these kinds.
        self.yields = self.yields.take().or(more.yields);
        self.expansion = self.expansion.take().or(more.expansion);
        self.axle = self.axle.take().or(more.axle);
        self.removal = self.removal.take().or(more.removal);
        for (own, more) in self.softening.iter_mut().zip(more.softening) {
            *own = own.take().or(more);
        }
        for (own, more) in self.flow.iter_mut().zip(more.flow) {
            *own = own.take().or(more);
        }
        for (own, more) in self.retardation.iter_mut().zip(more.retardation) {
            *own = own.take().or(more);
        }
        Ok(())
    }

    /// The kinds of which there are terms. [`Kind::LocalSlip`] and [`Kind::RailPlace`] are needs of values.
    #[cfg(test)]
    pub(crate) fn kinds(&self) -> Vec<Kind> {
        let lists = [
            (Kind::Gap, self.gap.len()),
            (Kind::FrictionFactor, self.friction.factors.len()),
            (Kind::TractionBound, self.friction.bounds.len()),
            (Kind::PressureBound, self.pressure_bounds.len()),
            (Kind::Adhesion, usize::from(self.adhesion)),
            (Kind::Layer, self.layers.len()),
            (Kind::Yield, usize::from(self.yields.is_some())),
            (Kind::Expansion, usize::from(self.expansion.is_some())),
            (Kind::Softening, self.softening.iter().flatten().count()),
            (Kind::Retardation, self.retardation.iter().flatten().count()),
            (Kind::Flow, self.flow.iter().flatten().count()),
            (Kind::Axle, usize::from(self.axle.is_some())),
            (Kind::HeatShare, self.heat_shares.len()),
            (Kind::Removal, usize::from(self.removal.is_some())),
            (Kind::Observation, self.observations.len()),
        ];
        lists.iter().filter(|(_, count)| *count > 0).map(|(kind, _)| *kind).collect()
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

    /// The first active effect that changes the traction bound.
    pub(crate) fn friction_effect(&self) -> Option<&'static str> {
        self.effect_of(Kind::FrictionFactor).or_else(|| self.effect_of(Kind::TractionBound))
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
        self.friction.follows_inputs() || self.warms()
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
        let removal = self.removal.iter().map(|removal| removal as &dyn State);
        let observations = self.observations.iter().map(|term| &**term as &dyn State);
        gap.chain(removal).chain(observations)
    }

    fn states_mut(&mut self) -> impl Iterator<Item = &mut dyn State> {
        let gap = self.gap.iter_mut().map(|term| &mut **term as &mut dyn State);
        let observations = self.observations.iter_mut().map(|term| &mut **term as &mut dyn State);
        let removal = self.removal.iter_mut().map(|removal| removal as &mut dyn State);
        gap.chain(removal).chain(observations)
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
        terms.join("one", &[Kind::Gap, Kind::Layer], one).unwrap();
        terms.join("other", &[Kind::PressureBound], other).unwrap();
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

    /// The second effect of an exclusive kind is refused, by both names, and nothing of it is taken.
    #[test]
    fn a_second_effect_of_an_exclusive_kind_is_refused() {
        for kinds in [&[Kind::Yield], &[Kind::Expansion], &[Kind::Axle]] {
            let mut terms = Terms::default();
            let first = Terms { expansion: Some([1.0, 1.0]), ..Terms::default() };
            terms.join("first", kinds, first).unwrap();
            let second = Terms { expansion: Some([2.0, 2.0]), ..Terms::default() };
            let refusal = terms.join("second", kinds, second).unwrap_err();
            let text = format!("{} {} {}", refusal.key, refusal.reason, refusal.fix);
            assert!(text.contains("effects.first") && text.contains("effects.second"), "{text}");
            assert_eq!((terms.expansion, terms.effects.len()), (Some([1.0, 1.0]), 1));
        }
    }
}
