//! Case key of the difference scheme along x, shared by all models with rolling half-spaces.

use crate::case::keys::CheckedParams;
use half_space::difference::Difference;
use proto::configuration::Refusal;
use proto::description::KeySpec;
use proto::params::Params;

pub(crate) const DIFFERENCE: &str = "mech.difference";

/// Declares the case key.
pub(crate) fn key() -> KeySpec {
    let help = "difference of displacements along x in rolling: Fromm's is of second order, the upwind one of first \
                order, as in CONTACT";
    KeySpec::choice(DIFFERENCE, &["fromm", "upwind"], help).default_value("fromm")
}

/// Reads the difference scheme of a case.
///
/// # Errors
/// An unknown difference scheme.
pub(crate) fn read(case: &Params) -> Result<Difference, Refusal> {
    Ok(match CheckedParams::new(case, vec![key()]).text(DIFFERENCE)? {
        "fromm" => Difference::Fromm,
        _ => Difference::Upwind,
    })
}
