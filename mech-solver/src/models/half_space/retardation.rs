//! What has no answer with bodies whose compliance grows ([`crate::effects::viscoelasticity`]).

use crate::scene::{GivenPatch, Scene};
use crate::terms::{Kind, Terms};
use proto::configuration::Refusal;

/// Refuses what has no steady state, or a pressure that does not follow from the shapes.
pub(super) fn refuse(
    scene: &Scene,
    patch: Option<GivenPatch>,
    terms: &Terms,
    memory: bool,
    varies: bool,
) -> Result<(), Refusal> {
    let Some(effect) = terms.effect_of(Kind::Retardation) else { return Ok(()) };
    let refused = |reason: &str, fix: &str| {
        let fix = format!("{fix}, or remove the effect");
        Err(Refusal::new(&format!("effects.{effect}"), reason, fix))
    };
    if scene.speeds.rolling == 0.0 {
        return refused(
            "bodies that do not roll have no steady state in which their compliance could have grown",
            "write a motion.speed above 0",
        );
    }
    if memory {
        return refused(
            "the displacement of such bodies is known in steady rolling only",
            "write mech.rolling = \"steady\"",
        );
    }
    if varies {
        return refused(
            "the displacement of such bodies is known in steady rolling only, and a load or a speed that varies is none",
            "write numbers in the place of columns and no axle",
        );
    }
    if patch.is_some() {
        return refused("such bodies change the pressure, which is given", "remove [contact]");
    }
    if terms.pressure_bound() < f64::INFINITY {
        let bound = terms.effect_of(Kind::PressureBound).unwrap_or_default();
        return refused(
            "with a largest pressure such a contact is not solved",
            &format!("remove effects.{bound}"),
        );
    }
    Ok(())
}
