//! A prescribed force that friction does not carry, where friction follows what comes in.
//!
//! An iterate of a coupling loop may be beyond what it settles at. It is answered with the force that
//! friction carries, so that the loop may come back; as an accepted state it is refused.

use crate::case::scene::Drive;
use crate::terms::Terms;
use proto::model::StepError;

/// A force that friction does not carry in an iterate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Shortfall {
    /// What is prescribed [N].
    pub(super) asked: f64,
    /// What the answer has [N].
    pub(super) carried: f64,
}

impl Shortfall {
    /// What is prescribed, or of a longitudinal force beyond friction what that carries.
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

    /// The error of a state that would be accepted so.
    pub(super) fn refused(shortfall: Option<Self>, terms: &Terms) -> Result<(), StepError> {
        let Some(Self { asked, carried }) = shortfall else { return Ok(()) };
        Err(StepError::NoSolution(format!(
            "{}: of {:.3} kN that are prescribed friction carries {:.3} kN; prescribe less, or \
             motion.creepage",
            terms.friction.shortfalls().join(", and "),
            1e-3 * asked,
            1e-3 * carried
        )))
    }
}
