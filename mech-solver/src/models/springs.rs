//! Case keys of the springs of the simplified theory ([`elastic::fastsim`]), shared by several
//! models.

use crate::case::keys::CheckedParams;
use elastic::fastsim::flexibility::Kind;
use elastic::fastsim::reduction::Reduction;
use proto::configuration::Refusal;
use proto::description::KeySpec;

const FLEXIBILITY: &str = "mech.flexibility";
const FACTOR: &str = "mech.slope_factor";
const RATIO: &str = "mech.slope_factor_ratio";
const DECREASE: &str = "mech.slope_factor_decrease";

/// Declares the key of the number of flexibilities.
pub(super) fn flexibility_key() -> KeySpec {
    KeySpec::choice(
        FLEXIBILITY,
        &["single", "kalker-1982", "three", "blended"],
        "one flexibility for all creepages (exact friction power), one averaged as in FASTSIM of 1982, one for each \
         (exact slopes), or three at small creepage and one at large",
    )
    .default_value("single")
}

/// Reads the number of flexibilities.
///
/// # Errors
/// A value that is not one of the choices.
pub(super) fn flexibility(case: &CheckedParams<'_>) -> Result<Kind, Refusal> {
    Ok(match case.text(FLEXIBILITY)? {
        "three" => Kind::Three,
        "blended" => Kind::Blended,
        "kalker-1982" => Kind::Kalker1982,
        _ => Kind::Single,
    })
}

/// Declares the keys that reduce the slope of the creep curve.
pub(super) fn reduction_keys() -> Vec<KeySpec> {
    vec![
        KeySpec::number(
            FACTOR,
            "initial slope of the creep curve over that of the linear theory, k_0",
        )
        .default_value(1.0)
        .above(0.0)
        .at_most(1.0),
        KeySpec::number(RATIO, "factor at large creepage over that at small creepage, alpha")
            .default_value(1.0)
            .above(0.0)
            .at_most(1.0),
        KeySpec::number(DECREASE, "rate at which the factor falls with the slip area, beta")
            .default_value(0.0)
            .at_least(0.0),
    ]
}

/// Reads the reduction of the slope of the creep curve.
///
/// # Errors
/// A value that is out of range.
pub(super) fn reduction(case: &CheckedParams<'_>) -> Result<Reduction, Refusal> {
    Ok(Reduction::new(case.number(FACTOR)?, case.number(RATIO)?, case.number(DECREASE)?))
}
