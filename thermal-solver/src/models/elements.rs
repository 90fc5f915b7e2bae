//! What a case says of the elements of a model that has its own, and where they have no answer.

use super::frame::Frame;
use crate::fe::block::{Back, Elements, Solver};
use crate::scene::Scene;
use crate::{LOWER, UPPER};
use proto::configuration::{Mode, Refusal};
use proto::params::Params;

/// What the case says of the elements of the upper and the lower body.
///
/// # Errors
/// Those of [`Elements::read`] and [`Elements::of`].
pub(super) fn read(case: &Params, scene: &Scene) -> Result<[Elements; 2], Refusal> {
    let all = Elements::read(case)?;
    let of = |body| all.of(case, &scene.names, body);
    Ok([of(UPPER)?, of(LOWER)?])
}

/// Refuses what a model's elements have no answer to.
///
/// # Errors
/// Earlier passages, or a sheet, where they have no answer.
pub(super) fn check(frame: &Frame) -> Result<(), Refusal> {
    check_passages(frame)?;
    check_sheets(frame)
}

/// Refuses earlier passages where they have no answer.
fn check_passages(frame: &Frame) -> Result<(), Refusal> {
    let length = frame.grid.ni as f64 * frame.grid.dx();
    for (body, elements) in frame.elements.iter().flatten().enumerate() {
        let Some(passages) = elements.passages else { continue };
        let key = frame.scene.names.key(body, "return_distance");
        if passages.distance < length {
            let reason =
                format!("{} m is shorter than the contact's grid, {length} m", passages.distance);
            return Err(Refusal::new(
                &key,
                reason,
                "write the way of a turn, or to the next contact",
            ));
        }
        let in_modes = frame.natures[body].is_constant() && elements.solver == Solver::Auto;
        if frame.mode == Mode::Transient || !in_modes {
            return Err(Refusal::new(
                "thermal.passages",
                "earlier passages are known in steady cases of constant properties",
                "write time.mode = \"steady\" without temperature_material, convection and radiation, \
                 or 1 passage",
            ));
        }
    }
    Ok(())
}

/// Refuses a steady case with a sheet at rest that no heat leaves.
fn check_sheets(frame: &Frame) -> Result<(), Refusal> {
    for (body, elements) in frame.elements.iter().flatten().enumerate() {
        let insulated = elements.sheet.is_some_and(|sheet| sheet.back == Back::Insulated);
        if insulated && frame.mode == Mode::Steady && frame.scene.at_rest[body] {
            return Err(Refusal::new(
                &frame.scene.names.key(body, "back"),
                "a sheet at rest that no heat leaves has no steady state",
                "write \"fixed\", or time.mode = \"transient\"",
            ));
        }
    }
    Ok(())
}
