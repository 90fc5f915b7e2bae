//! The key that chooses the difference along x of steady rolling, the same in every model that has one.

use crate::half_space::difference::Difference;
use crate::keys::CheckedParams;
use proto::configuration::Refusal;
use proto::description::KeySpec;
use proto::params::Params;

pub(crate) const DIFFERENCE: &str = "mech.difference";

/// The key.
pub(crate) fn key() -> KeySpec {
    let help = "slip in steady rolling is a difference of displacements along x: Fromm's, of second order, or the upwind one, of \
                first order, which CONTACT has";
    KeySpec::choice(DIFFERENCE, &["fromm", "upwind"], help).default_value("upwind")
}

/// The difference of a case.
///
/// # Errors
/// It is none of them.
pub(crate) fn read(case: &Params) -> Result<Difference, Refusal> {
    Ok(match CheckedParams::new(case, vec![key()]).text(DIFFERENCE)? {
        "fromm" => Difference::Fromm,
        _ => Difference::Upwind,
    })
}
