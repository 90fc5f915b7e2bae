//! Bodies that end: rods, which are held at their far ends.

use crate::{LOWER, UPPER};
use proto::bodies::Bodies;
use proto::configuration::Refusal;
use proto::description::KeySpec;
use proto::params::Params;

const LENGTH: &str = "length";
const START: &str = "start_rise";

/// The keys of the bodies that are rods.
pub(super) fn keys() -> Vec<KeySpec> {
    let length = "length of the rod, held at its far end; absent: it stays as warm as it is";
    let start = "rise of the rod's end at the start, from which it falls evenly to the far end";
    vec![
        KeySpec::quantity(&format!("bodies.*.{LENGTH}"), "m", length).above(0.0),
        KeySpec::quantity(&format!("bodies.*.{START}"), "K", start)
            .of_differences()
            .default_value(0.0),
    ]
}

/// What a rod of the case is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ends {
    /// Length [m]; `None` for a body that stays as warm as it is.
    pub length: Option<f64>,
    /// Rise of its end at the start [K].
    pub start: f64,
}

impl Ends {
    /// Both bodies of a case.
    ///
    /// # Errors
    /// A length that is not above 0, and a start of a body without one.
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
                let reason = "a body without a length stays as warm as it is";
                let fix = format!("add `{}`, or remove the key", key(LENGTH));
                return Err(Refusal::new(&key(START), reason, fix));
            }
            Ok(Self { length, start })
        };
        Ok([of(UPPER)?, of(LOWER)?])
    }
}
