//! Contributions of effects to a contact: terms of a few kinds.
//!
//! The registry entry of an effect creates its terms ([`crate::effects`]). The model that runs
//! holds the terms of all active effects, one list for each kind, and uses each kind in one place.
//! An empty list costs nothing.
//!
//! | [`Kind`] | term | quantity that it changes |
//! |---|---|---|
//! | `Gap` | heights [m] | the undeformed distance, to which they are added |
//! | `FrictionFactor` | factors on the friction coefficient; they multiply | the traction bound |
//! | `LocalSlip` | factors that depend on each element's slip | the traction bound, iteratively |
//! | `RailPlace` | factors that depend on the position on a rail of a track | the traction bound |
//! | `TractionBound` | a largest traction [Pa]; the smallest holds | the bound, after all factors |
//! | `PressureBound` | a largest pressure [Pa]; the smallest holds | the normal contact |
//! | `Adhesion` | permission to stick; without it all elements slide | the tangential contact |
//! | `Layer` | a tangential flexibility [m/Pa], in series | the displacement difference |
//! | `Yield` | yield stress of a layer over its plastic shift | the tangential contact |
//! | `Expansion` | thermal expansion [1/K] | the undeformed distance, or the stress of elements |
//! | `Softening` | stiffness and yield stress over temperature | the stress of finite elements |
//! | `Flow` | law of plastic flow of each body | the stress of finite elements |
//! | `Retardation` | delayed compliance of each body | the displacement difference |
//! | `Axle` | a mass that carries the load, and its irregularity | the height of the upper body |
//! | `HeatShare` | a factor | the friction power that is provided as heat |
//! | `Removal` | material removed by an accepted contact | the next undeformed distance |
//! | `Observation` | fields and quantities of an accepted contact | the outputs and the summary |
//!
//! A model declares the kinds that it uses, and an effect the kinds that it creates. A model
//! supports an effect if it uses all kinds of that effect.

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

/// Kinds of terms.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Heights of the surfaces.
    Gap,
    /// Factors on the friction coefficient of the case.
    FrictionFactor,
    /// Factors that depend on the slip of every element, elastic part included.
    LocalSlip,
    /// Factors that depend on the position on a rail of a track.
    RailPlace,
    /// Largest traction.
    TractionBound,
    /// Largest pressure.
    PressureBound,
    /// Permission for the surfaces to stick.
    Adhesion,
    /// Tangential flexibility between the surfaces.
    Layer,
    /// Plastic flow of a layer between the surfaces.
    Yield,
    /// Thermal expansion.
    Expansion,
    /// Softening with temperature.
    Softening,
    /// Plastic flow of the bodies.
    Flow,
    /// Compliance that grows with time.
    Retardation,
    /// Mass that carries the load, and the irregularity that it runs over.
    Axle,
    /// Share of the friction power that becomes heat.
    HeatShare,
    /// Material removed by the contact.
    Removal,
    /// Fields and quantities computed from an accepted contact.
    Observation,
}

impl Kind {
    /// Returns true if at most one effect of a contact may create this kind.
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

/// Term of the undeformed distance.
pub(crate) trait GapTerm: State + Debug {
    /// Height [m] at a position relative to the origin of the undeformed contact; positive opens
    /// the gap.
    fn height(&self, x: f64, y: f64) -> f64;

    /// Makes the heights periodic with these periods along x and y [m].
    ///
    /// # Errors
    /// A surface that cannot be periodic, or only by becoming another surface.
    fn repeat(&mut self, periods: [f64; 2]) -> Result<(), Refusal>;
}

/// Grid and position of a contact.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Place {
    /// Grid of the contact.
    pub(crate) grid: Structured,
    /// Semi-axes, or an estimate of them [m].
    pub(crate) semi_axes: [f64; 2],
    /// Lateral coordinate of the highest pressure without friction [m].
    pub(crate) peak_y: f64,
}

/// Fields and summary quantities computed from an accepted contact.
pub(crate) trait Observation: State + Debug {
    /// Sets the grid and position of the contact; called before all other methods.
    fn place(&mut self, place: &Place);

    /// Announces thermal expansion of both bodies, with their coefficients [1/K] and their surface
    /// speeds [m/s].
    ///
    /// # Errors
    /// An observation that is not defined for such bodies.
    fn expand(&mut self, coefficients: [f64; 2], speeds: [f64; 2]) -> Result<(), Refusal>;

    /// Grids of the observation, by name.
    fn grids(&self) -> Vec<(&'static str, Shape)>;

    /// Name of the grid of a field; `None` for fields of other terms.
    fn grid_of(&self, field: &FieldSpec) -> Option<&'static str>;

    /// Computes the fields and quantities of an accepted contact.
    fn observe(&mut self, accepted: &Accepted<'_>);

    /// Writes the requested fields.
    fn write(&self, outputs: &mut dyn Outputs);

    /// Name and content of the section of `summary.json`; `None` before the first observation.
    fn summary(&self) -> Option<(&'static str, Value)>;
}

/// Kind that a model must use if a key has a certain value, beyond the kinds of its effect.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Need {
    pub(crate) kind: Kind,
    pub(crate) key: &'static str,
    /// Noun phrase for the message: the capability that the model lacks.
    pub(crate) lacks: &'static str,
    /// Value of the key that every model takes.
    pub(crate) instead: &'static str,
}

/// Terms of all active effects.
#[derive(Debug, Default)]
pub(crate) struct Terms {
    /// Active effects, with the kinds that they create.
    pub(crate) effects: Vec<(&'static str, &'static [Kind])>,
    pub(crate) gap: Vec<Box<dyn GapTerm>>,
    pub(crate) friction: FrictionLaw,
    /// Kinds that the model must use because of the values of keys.
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
    /// Adds the terms of another effect.
    ///
    /// # Errors
    /// A second effect of an exclusive kind; the refusal names both effects.
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
                        "and effects.{first} exclude each other: both create the term `{kind:?}`, of which a contact has one"
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
        // No earlier effect has created a term of these kinds.
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

    /// Kinds with at least one term. [`Kind::LocalSlip`] and [`Kind::RailPlace`] are not listed:
    /// they are needs of key values.
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

    /// Name of the first active effect that creates terms of a kind.
    pub(crate) fn effect_of(&self, kind: Kind) -> Option<&'static str> {
        self.effects.iter().find(|(_, kinds)| kinds.contains(&kind)).map(|(name, _)| *name)
    }

    /// Sum of the heights and of the worn depth at a position [m].
    pub(crate) fn height(&self, x: f64, y: f64) -> f64 {
        let worn = self.removal.as_ref().map_or(0.0, |removal| removal.depth(y));
        self.gap.iter().map(|term| term.height(x, y)).sum::<f64>() + worn
    }

    /// Name of the first active effect that changes the traction bound.
    pub(crate) fn friction_effect(&self) -> Option<&'static str> {
        self.effect_of(Kind::FrictionFactor).or_else(|| self.effect_of(Kind::TractionBound))
    }

    /// Smallest pressure bound [Pa]; infinite without one.
    pub(crate) fn pressure_bound(&self) -> f64 {
        self.pressure_bounds.iter().copied().fold(f64::INFINITY, f64::min)
    }

    /// Returns true if no term changes the Hertz pressure of smooth bodies.
    pub(crate) fn leave_hertz(&self) -> bool {
        let as_given = self.gap.is_empty() && self.pressure_bounds.is_empty();
        as_given && self.expansion.is_none() && self.removal.is_none()
    }

    /// Returns true if the contact depends on input fields.
    pub(crate) fn follow_inputs(&self) -> bool {
        self.friction.follows_inputs() || self.warms()
    }

    /// Returns true if a material expands or softens with temperature.
    pub(crate) fn warms(&self) -> bool {
        self.expansion.is_some() || self.softens()
    }

    /// Returns true if a material softens with temperature.
    pub(crate) fn softens(&self) -> bool {
        self.softening.iter().any(Option::is_some)
    }

    /// Total flexibility of all layers [m/Pa].
    pub(crate) fn layer(&self) -> f64 {
        self.layers.iter().sum()
    }

    /// Multiplies the friction power by the share that becomes heat.
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

    /// Accepts the last solve as the state of every term.
    pub(crate) fn accept(&mut self) {
        self.states_mut().for_each(State::accept);
    }

    /// Writes the accepted states of all terms in sequence.
    ///
    /// # Errors
    /// A failure to write.
    pub(crate) fn save(&self, into: &mut dyn Write) -> io::Result<()> {
        self.states().try_for_each(|term| term.save(into))
    }

    /// Restores the states that [`Terms::save`] wrote.
    ///
    /// # Errors
    /// Data that does not match the terms.
    pub(crate) fn restore(&mut self, from: &mut dyn Read) -> Result<(), StateError> {
        self.states_mut().try_for_each(|term| term.restore(from))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proto::state::{read_numbers, write_numbers};

    /// Height that grows with every accepted state.
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

    /// Terms of two effects add up. Their states are accepted, saved and restored in sequence, and
    /// a truncated state is refused.
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

    /// A second effect of an exclusive kind is refused with both names, and none of its terms is
    /// added.
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
