//! Checks of the inputs, and the speeds and heat partition of a window.

use super::frame::Frame;
use crate::effects::friction_heat::Partition;
use heat::window::Drive;
use proto::configuration::Mode;
use proto::field::{self, FieldSpec};
use proto::model::{InputField, Inputs, Step, StepError, first_non_finite};

/// Returns duration, surface speeds and heat partition of a window.
///
/// # Errors
/// A missing or invalid surface speed; a stationary body that the model does not support; a
/// transient window without duration.
pub(super) fn drive(
    frame: &Frame,
    at_rest: bool,
    repeats: bool,
    step: &Step,
    inputs: &dyn Inputs,
) -> Result<Drive, StepError> {
    let speeds = checked(inputs, &field::SURFACE_SPEED, 1)?.values;
    let speeds = [speeds[0], speeds[1]];
    for (speed, body) in speeds.iter().zip(&frame.scene.names.0) {
        refuse_rest(frame, at_rest, repeats, body, *speed)?;
    }
    let duration = match frame.mode {
        Mode::Steady => f64::INFINITY,
        Mode::Transient => step.duration(),
    };
    if duration > 0.0 {
        let taking = if repeats { [1.0; 2] } else { speeds };
        let shares = frame.partition.shares(&frame.scene.materials, taking);
        return Ok(Drive { duration, speeds, shares });
    }
    Err(StepError::NoSolution(format!("a transient window lasts {duration} s")))
}

/// Refuses a speed for which there is no solution. With conduction normal to the surface only, a
/// point that is heated permanently has no steady temperature.
fn refuse_rest(
    frame: &Frame,
    at_rest: bool,
    repeats: bool,
    body: &str,
    speed: f64,
) -> Result<(), StepError> {
    let why = match frame.mode {
        _ if speed > 0.0 => return Ok(()),
        _ if speed < 0.0 => runs_backwards(body, speed),
        Mode::Steady if !at_rest => {
            format!("{}; {OF_RESTING_BODIES}", never_steady(body, ""))
        }
        _ if frame.partition == Partition::Effusivity && !repeats => format!(
            "`{body}` is at rest: the partition by effusivity and speed gives it no heat; write \
             effects.friction_heat.partition = \"continuity\" and thermal.model = \"moving-source\""
        ),
        _ => return Ok(()),
    };
    Err(StepError::NoSolution(why))
}

/// Advice for a body at rest in a steady case.
pub(super) const OF_RESTING_BODIES: &str =
    "write [thermal] model = \"moving-source\", or a speed above 0 m/s";

/// States why a body at rest, in this row of a table, has no steady temperature.
pub(super) fn never_steady(body: &str, row: &str) -> String {
    format!(
        "`{body}` is at rest{row}: one place of it is heated without end, and conduction normal to \
         the surface then has no steady state"
    )
}

/// States why there is no solution for a body that moves against the direction of rolling.
pub(super) fn runs_backwards(body: &str, speed: f64) -> String {
    format!("the surface of `{body}` passes at {speed} m/s: heat is carried towards -x")
}

/// Refuses a stationary body in a steady case with thermal expansion, because its surface rises
/// without limit.
///
/// # Errors
/// A stationary body in a steady case.
pub(super) fn refuse_without_height(frame: &Frame, drive: &Drive) -> Result<(), StepError> {
    let resting = (0..2).find(|body| drive.speeds[*body] == 0.0 && frame.mode == Mode::Steady);
    let Some(body) = resting else { return Ok(()) };
    let (name, body) = (field::SURFACE_SPEED.name, &frame.scene.names.0[body]);
    Err(StepError::NoSolution(format!(
        "`{name}` of `{body}` is 0 m/s: its surface has no steady height; write time.mode = \"transient\""
    )))
}

/// Returns an input after checking its length and that its values are finite.
///
/// # Errors
/// A missing input, a wrong number of values, or a value that is not finite.
pub(super) fn checked<'a>(
    inputs: &'a dyn Inputs,
    spec: &FieldSpec,
    points: usize,
) -> Result<InputField<'a>, StepError> {
    let field = || spec.name.to_owned();
    let Some(input) = inputs.get(spec) else {
        return Err(StepError::MissingInput { field: field() });
    };
    let expected = points * spec.components as usize;
    if input.values.len() != expected {
        let (name, got) = (spec.name, input.values.len());
        return Err(StepError::NoSolution(format!("`{name}` has {got} values, not {expected}")));
    }
    match first_non_finite(input.values) {
        Some(index) => {
            let value = input.values[index];
            Err(StepError::NonFiniteInput { field: field(), index, value })
        }
        None => Ok(input),
    }
}
