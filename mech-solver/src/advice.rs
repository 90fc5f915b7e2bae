//! Estimates of the influence of effects on a scene, before it is run.

pub(crate) mod situation;

use crate::advice::situation::Situation;
use crate::case::scene::Scene;
use crate::effects::{EFFECTS, of_kind};
use crate::models::estimated_contact;
use crate::terms::Kind;
use proto::advice::{self, Advice, Opinion};
use serde_json::Value;

/// Returns the estimates of a scene; empty for a scene that cannot be read.
pub(crate) fn opinion(asked: &advice::Scene) -> Opinion {
    let Ok(scene) = Scene::read(&asked.case) else { return Opinion::default() };
    let active = asked.case.get("effects").and_then(Value::as_object);
    let sticks = active
        .into_iter()
        .flatten()
        .any(|(name, _)| of_kind(Kind::Adhesion).any(|own| own == name));
    let estimated = |scene: &Scene, sticks: bool, largest: Option<f64>| {
        estimated_contact(scene, &asked.case, sticks, largest)
    };
    let own = estimated(&scene, sticks, None).unwrap_or_default();
    let mut known = asked.known.clone();
    known.extend(own.clone());
    let case = &asked.case;
    let situation = Situation { scene: &scene, case, sticks, known: &known, estimated: &estimated };
    let advice: Vec<Advice> =
        EFFECTS.iter().filter_map(|effect| Some((effect.advise?)(&situation))).collect();
    Opinion { known: own, advice }
}
