//! Keys of bodies that are rods with a fixed far-end temperature.

use crate::{LOWER, UPPER};
use proto::bodies::Bodies;
use proto::configuration::Refusal;
use proto::description::KeySpec;
use proto::params::Params;

const LENGTH: &str = "length";
const START: &str = "start_rise";

/// Returns the keys of the rods.
pub(super) fn keys() -> Vec<KeySpec> {
    let length =
        "length of the rod, whose far end is held; absent: the body keeps its initial temperature";
    let start = "initial rise of the contact end, which falls linearly to the far end";
    vec![
        KeySpec::quantity(&format!("bodies.*.{LENGTH}"), "m", length).above(0.0),
        KeySpec::quantity(&format!("bodies.*.{START}"), "K", start)
            .of_differences()
            .default_value(0.0),
    ]
}

/// Length and initial rise of a body as a rod.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ends {
    /// Length [m]; `None` for a body that keeps its initial temperature.
    pub length: Option<f64>,
    /// Initial rise of the contact end [K].
    pub start: f64,
}

impl Ends {
    /// Reads the rods of both bodies.
    ///
    /// # Errors
    /// A length that is not positive; an initial rise of a body without a length.
    pub fn read(case: &Params, bodies: &Bodies) -> Result<[Self; 2], Refusal> {
        let of = |body: usize| {
            let key = |name: &str| bodies.key(body, name);
            let length = case.maybe_number(&key(LENGTH))?;
            let start = case.maybe_number(&key(START))?.unwrap_or(0.0);
            if let Some(length) = length.filter(|length| *length <= 0.0) {
                let reason = format!("{length} m is not greater than 0");
                return Err(Refusal::new(&key(LENGTH), reason, "write a positive length"));
            }
            if length.is_none() && start != 0.0 {
                let reason = "a body without a length keeps its initial temperature";
                let fix = format!("add `{}`, or remove the key", key(LENGTH));
                return Err(Refusal::new(&key(START), reason, fix));
            }
            Ok(Self { length, start })
        };
        Ok([of(UPPER)?, of(LOWER)?])
    }
}
