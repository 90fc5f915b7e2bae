//! Key `resolution`: elements per semi-axis a. Each model has its own default.

use crate::case::keys::CheckedParams;
use proto::configuration::Refusal;
use proto::description::KeySpec;
use proto::params::Params;

/// Name of the key.
pub(crate) const RESOLUTION: &str = "mech.resolution";

/// Largest number of elements per semi-axis.
pub(crate) const MOST: usize = 2000;

/// Returns the key with the default of a model.
pub(crate) fn key(default: usize) -> KeySpec {
    KeySpec::integer(RESOLUTION, "elements per semi-axis a: dx = dy = a/resolution; half-space: dx less where the slip zone is short")
        .default_value(default)
        .at_least(1.0)
        .at_most(MOST as f64)
}

/// Reads the value of a case.
///
/// # Errors
/// A value out of range.
pub(crate) fn read(case: &Params, default: usize) -> Result<usize, Refusal> {
    let value = CheckedParams::new(case, vec![key(default)]).integer(RESOLUTION)?;
    Ok(usize::try_from(value).expect("the key's range is positive and small"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn the_default_is_the_models_and_the_range_is_kept() {
        assert_eq!(read(&Params(json!({})), 7), Ok(7));
        assert_eq!(read(&Params(json!({"mech": {"resolution": 3}})), 7), Ok(3));
        for wrong in [0, 2001] {
            let refusal = read(&Params(json!({"mech": {"resolution": wrong}})), 7).unwrap_err();
            assert_eq!(refusal.key, RESOLUTION);
        }
    }
}
