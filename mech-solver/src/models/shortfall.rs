//! Shortfall of a prescribed force that friction cannot carry, for friction that depends on inputs
//! or slip.
//!
//! An iterate of a coupling loop may exceed the converged state. Such an iterate is solved with the
//! force that friction carries, so that the loop can recover. As an accepted state it is refused.

use crate::case::scene::Drive;
use crate::terms::Terms;
use proto::model::StepError;

/// A prescribed force that friction cannot carry in an iterate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Shortfall {
    /// Prescribed force [N].
    pub(super) asked: f64,
    /// Force carried by friction [N].
    pub(super) carried: f64,
}

impl Shortfall {
    /// Returns the drive, with a longitudinal force beyond friction reduced to the force that
    /// friction carries.
    pub(super) fn of(drive: Drive, friction: f64, normal_force: f64) -> (Drive, Option<Self>) {
        let most = friction * normal_force;
        let short = |asked: f64| {
            let asked = asked.abs();
            (asked > most).then_some(Self { asked, carried: most })
        };
        match drive {
            Drive::TractionCoefficient(value) => {
                let within = Drive::TractionCoefficient(value.clamp(-friction, friction));
                (within, short(value * normal_force))
            }
            Drive::TangentialForce(value) => {
                (Drive::TangentialForce(value.clamp(-most, most)), short(value))
            }
            other => (other, None),
        }
    }

    /// Refuses a state with a shortfall.
    pub(super) fn refused(shortfall: Option<Self>, terms: &Terms) -> Result<(), StepError> {
        let Some(Self { asked, carried }) = shortfall else { return Ok(()) };
        Err(StepError::NoSolution(format!(
            "{}: of the prescribed {:.3} kN friction carries {:.3} kN; prescribe less, or \
             motion.creepage",
            terms.friction.shortfalls().join(", and "),
            1e-3 * asked,
            1e-3 * carried
        )))
    }
}
