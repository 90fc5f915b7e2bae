//! Effect `friction_heat`: the frictional heat of the contact flows into the upper and the lower
//! body.
//!
//! The power density q_f ≥ 0 of the interface is split into q_upper = ε q_f and q_lower = (1 − ε)
//! q_f, with the heat partition ε of one of these laws:
//!
//! - `equal`: ε = ½, the paper's choice;
//! - `continuity`: the heat exchanged between the surfaces makes their temperatures equal wherever
//!   there is contact pressure, with or without friction;
//! - `effusivity`: ε = β_w√V_w / (β_w√V_w + β_r√V_r), with the effusivity β = √(λρc) and the
//!   surface speed V of each body. In steady motion with one-dimensional conduction both surfaces
//!   then have the same temperature everywhere, since T ∝ q/(β√V) (Ertz & Knothe, Wear 253 (2002)
//!   498–508, after Blok).

use crate::capability::{Capability, Need};
use crate::scene::Scene;
use crate::situation::{Situation, watts};
use crate::{LOWER, UPPER};
use heat::Material;
use proto::advice::Advice;
use proto::configuration::Refusal;
use proto::description::{EffectSpec, KeySpec, names};
use proto::field;
use proto::params::Params;

/// Name of the effect in the case file.
pub const NAME: &str = "friction_heat";

pub(crate) const PARTITION_KEY: &str = "effects.friction_heat.partition";

/// Names of the laws in the case file.
const WORDS: [&str; 3] = ["equal", "effusivity", "continuity"];

/// Law of the heat partition between the bodies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Partition {
    /// Equal shares of one half.
    Equal,
    /// Shares in proportion to β√V.
    Effusivity,
    /// Equal temperatures of the surfaces in contact.
    Continuity,
}

impl Partition {
    /// Reads the law from the case; the default is `equal`.
    ///
    /// # Errors
    /// An unknown law.
    pub fn read(case: &Params) -> Result<Self, Refusal> {
        if !case.has(PARTITION_KEY) {
            return Ok(Self::Equal);
        }
        match case.text(PARTITION_KEY)? {
            "equal" => Ok(Self::Equal),
            "effusivity" => Ok(Self::Effusivity),
            "continuity" => Ok(Self::Continuity),
            other => Err(Refusal::new(
                PARTITION_KEY,
                format!("`{other}` is not a partition law"),
                format!("write one of {}", WORDS.join(", ")),
            )),
        }
    }

    /// Returns the shares (upper, lower) of the heat [-] before heat is exchanged between the
    /// surfaces, for the surface speeds (upper, lower) [m/s].
    #[must_use]
    pub fn shares(self, materials: &[Material; 2], speeds: [f64; 2]) -> [f64; 2] {
        match self {
            Self::Equal => [0.5, 0.5],
            Self::Continuity if speeds == [0.0; 2] => [0.5, 0.5],
            Self::Effusivity | Self::Continuity => {
                let uptake = |body: usize| materials[body].effusivity() * speeds[body].sqrt();
                let upper = uptake(UPPER) / (uptake(UPPER) + uptake(LOWER));
                [upper, 1.0 - upper]
            }
        }
    }

    /// Estimates the shares (upper, lower) of the heat [-] that remain after heat is exchanged,
    /// for the surface speeds [m/s] and the rises that all of the heat would cause in either body
    /// [K]. Surfaces of the same temperature share the heat as the reciprocals of these rises.
    #[must_use]
    pub fn estimate(
        self,
        materials: &[Material; 2],
        speeds: [f64; 2],
        rises: [f64; 2],
    ) -> [f64; 2] {
        let moving = speeds.iter().all(|speed| *speed > 0.0);
        match self {
            Self::Equal => [0.5; 2],
            Self::Effusivity if moving => self.shares(materials, speeds),
            Self::Effusivity | Self::Continuity => {
                let [upper, lower] = rises;
                if upper + lower > 0.0 {
                    [lower / (upper + lower), upper / (upper + lower)]
                } else {
                    [0.5; 2]
                }
            }
        }
    }
}

/// Returns the capabilities that the partition needs: `continuity` needs heat exchange between the
/// surfaces.
///
/// # Errors
/// An unknown law.
pub fn needs_of_values(case: &Params) -> Result<Vec<Need>, Refusal> {
    let rests = Scene::read(case).is_ok_and(|scene| scene.at_rest.contains(&true));
    Ok(match Partition::read(case)? {
        Partition::Continuity => vec![Need {
            key: PARTITION_KEY,
            capability: Capability::Exchange,
            instead: (!rests).then_some("\"effusivity\", which is the same at high speed"),
        }],
        Partition::Equal | Partition::Effusivity => Vec::new(),
    })
}

/// Returns the thermal participant's part of the effect.
#[must_use]
pub fn spec() -> EffectSpec {
    EffectSpec {
        figures: Vec::new(),
        name: NAME.to_owned(),
        law: "q_upper = eps q_f, q_lower = (1 - eps) q_f; eps = 1/2, by effusivity times root of \
              speed, or so that T_u = T_l where the surfaces touch"
            .to_owned(),
        source: "Naeimi et al., eqs. 7-10; Ertz & Knothe, Wear 253 (2002) 498-508".to_owned(),
        models: Vec::new(),
        consumes: names(&[&field::FRICTION_POWER, &field::SURFACE_SPEED]),
        provides: names(&[
            &field::LOWER_TEMPERATURE,
            &field::UPPER_TEMPERATURE,
            &field::LOWER_SECTION_TEMPERATURE,
            &field::UPPER_SECTION_TEMPERATURE,
        ]),
        keys: vec![
            KeySpec::choice(PARTITION_KEY, &WORDS, "how the heat is split between the bodies")
                .default_value("equal")
                .consuming("continuity", &[&field::PRESSURE]),
        ],
    }
}

/// Estimates how much the effect matters in a scene.
#[must_use]
pub fn advise(situation: &Situation<'_>) -> Advice {
    let body = situation.hotter();
    let rise = situation.rises[body];
    let name = &situation.scene.names.0[body];
    let advice = Advice::new(
        NAME,
        format!("{} of friction warm {name} by about {rise:.1} K", watts(situation.power)),
    )
    .number("Peclet number V a/(2 kappa)", situation.peclet(body))
    .with(format!("effects.{NAME}={{}}"));
    // Without this effect there is no temperature rise.
    situation.moved(advice, body, f64::INFINITY)
}

#[cfg(test)]
mod tests {
    use super::*;

    const STEEL: Material = Material { density: 7850.0, specific_heat: 419.5, conductivity: 50.0 };

    #[test]
    fn effusivity_sends_more_heat_into_the_body_that_takes_it_better() {
        let better = Material { conductivity: 4.0 * STEEL.conductivity, ..STEEL };
        let shares = Partition::Effusivity.shares(&[better, STEEL], [1.0, 1.0]);
        // Tolerance: rounding of two roots and a quotient.
        assert!((shares[UPPER] - 2.0 / 3.0).abs() < 1e-15);
        let shares = Partition::Effusivity.shares(&[STEEL, STEEL], [1.0, 9.0]);
        assert!((shares[LOWER] - 0.75).abs() < 1e-15);
        assert_eq!(shares[UPPER] + shares[LOWER], 1.0);
    }

    #[test]
    fn an_unknown_law_is_refused_with_its_key() {
        let case = Params(serde_json::json!({"effects": {"friction_heat": {"partition": "half"}}}));
        assert_eq!(Partition::read(&case).unwrap_err().key, PARTITION_KEY);
        assert_eq!(Partition::read(&Params(serde_json::json!({}))), Ok(Partition::Equal));
    }
}
