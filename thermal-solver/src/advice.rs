//! Advice of the thermal participant on its effects in a scene, before it is run.

use crate::effects::REGISTRY;
use crate::effects::friction_heat::Partition;
use crate::scene::Scene;
use crate::situation::Situation;
use crate::{LOWER, UPPER};
use proto::advice::{self, Advice, Opinion};

/// Returns the estimated rises and the advice for a scene. The result is empty if the contact is
/// unknown.
#[must_use]
pub fn opinion(asked: &advice::Scene) -> Opinion {
    let Ok(scene) = Scene::read(&asked.case) else { return Opinion::default() };
    let partition = Partition::read(&asked.case).unwrap_or(Partition::Equal);
    let shares = |speeds, rises| partition.estimate(&scene.materials, speeds, rises);
    let Some(situation) = Situation::of(&scene, asked, shares) else {
        return Opinion::default();
    };
    let known = [UPPER, LOWER].map(|body| (situation.rise_of(body), situation.rises[body]));
    let advice: Vec<Advice> =
        REGISTRY.iter().filter_map(|effect| Some((effect.advise?)(&situation))).collect();
    Opinion { known: known.into_iter().collect(), advice }
}
