//! Limits of bodies whose compliance grows ([`crate::effects::viscoelasticity`]): they roll
//! steadily, or are pressed and shifted without rolling.

use crate::case::scene::{GivenPatch, Scene};
use crate::terms::{Kind, Terms};
use proto::configuration::Refusal;

/// Refuses transient rolling, and a pressure that does not follow from the shapes.
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
    let rolls = scene.speeds.rolling > 0.0;
    if rolls && memory {
        return refused(
            "if such bodies roll, their displacement is known in the steady state only",
            "write mech.rolling = \"steady\"",
        );
    }
    if rolls && varies {
        return refused(
            "if such bodies roll, their displacement is known in the steady state only, which excludes a varying load or speed",
            "write numbers in place of columns and no axle",
        );
    }
    if patch.is_some() {
        return refused(
            "such bodies change the pressure, but the case gives it",
            "remove [contact]",
        );
    }
    if terms.pressure_bound() < f64::INFINITY {
        let bound = terms.effect_of(Kind::PressureBound).unwrap_or_default();
        return refused(
            "such a contact does not support a pressure bound",
            &format!("remove effects.{bound}"),
        );
    }
    Ok(())
}
