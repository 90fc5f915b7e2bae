//! Periodic cell: its keys and its grid.

use crate::case::keys::CheckedParams;
use proto::accuracy::Refinement;
use proto::configuration::Refusal;
use proto::description::KeySpec;
use proto::grid::Structured;
use proto::params::Params;

const PERIODS: [&str; 2] = ["mech.period_x", "mech.period_y"];
const RESOLUTION: &str = "mech.resolution";
const LATERAL_RESOLUTION: &str = "mech.lateral_resolution";

/// Default number of elements along x.
const ALONG: usize = 64;
/// Maximum number of elements along a side.
const MOST: f64 = 16384.0;

/// Keys read by [`grid`].
pub(super) fn keys() -> Vec<KeySpec> {
    vec![
        KeySpec::quantity(PERIODS[0], "m", "length of the periodic cell").required().above(0.0),
        KeySpec::quantity(PERIODS[1], "m", "width of the periodic cell").required().above(0.0),
        KeySpec::integer(RESOLUTION, "even number of elements along the cell")
            .default_value(ALONG)
            .at_least(4.0)
            .at_most(MOST),
        KeySpec::integer(LATERAL_RESOLUTION, "elements across the cell; 1: nothing depends on y")
            .default_value(1)
            .at_least(1.0)
            .at_most(MOST),
    ]
}

/// Convergence of the largest pressure with the elements per wave: order, and error at eight
/// elements.
pub(super) fn refinement() -> Refinement {
    Refinement {
        key: RESOLUTION.to_owned(),
        levels: vec![8, 16, 32, 64, 128, 256, 512],
        order: 2.0,
        error: 0.08,
        source: "Westergaard's wave, a quarter of which touches, in the tests of this model"
            .to_owned(),
    }
}

/// Returns the grid of a cell centred at the origin. An element's centre lies at the origin if its
/// row and column counts are odd or one.
///
/// # Errors
/// A value that is out of range; an odd number of elements along x.
pub(super) fn grid(params: &Params) -> Result<Structured, Refusal> {
    let case = CheckedParams::new(params, keys());
    let [length, width] = [case.number(PERIODS[0])?, case.number(PERIODS[1])?];
    let count = |key: &str| Ok(case.integer(key)?.unsigned_abs() as usize);
    let (along, across) = (count(RESOLUTION)?, count(LATERAL_RESOLUTION)?);
    if !along.is_multiple_of(2) {
        let fix = format!("write {} or {}", along - 1, along + 1);
        return Err(Refusal::new(RESOLUTION, format!("{along} is an odd number of elements"), fix));
    }
    let (dx, dy) = (length / along as f64, width / across as f64);
    let first = |count: usize, step: f64| -((count / 2) as f64) * step;
    Ok(Structured::contact_plane(first(along, dx), first(across, dy), dx, dy, along, across))
}
