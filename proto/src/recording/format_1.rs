//! Events of recordings of format 1, written up to protocol 6. A reply had NaN for an absent
//! received power and 0 for an absent limit of the window.

use super::Event;
use crate::binary;
use crate::message::{RECEIVED_POWER, Reply, WANTED_WINDOW};
use serde::Deserialize;

/// Fixed part of a reply in format 1.
#[derive(Deserialize)]
struct OldReply {
    protocol: u32,
    status: u32,
    sequence: u64,
    work: u64,
    substeps: u32,
    inner_iterations: u32,
    received_power: f64,
    model_seconds: f64,
    wanted_window: f64,
}

impl From<OldReply> for Reply {
    fn from(old: OldReply) -> Self {
        let OldReply { protocol, status, sequence, work, substeps, inner_iterations, .. } = old;
        let (reports, limits) = (!old.received_power.is_nan(), old.wanted_window != 0.0);
        Self {
            protocol,
            status,
            sequence,
            work,
            substeps,
            inner_iterations,
            received_power: if reports { old.received_power } else { 0.0 },
            model_seconds: old.model_seconds,
            wanted_window: old.wanted_window,
            present: if reports { RECEIVED_POWER } else { 0 }
                | if limits { WANTED_WINDOW } else { 0 },
            reserved: 0,
        }
    }
}

/// Reads an event.
///
/// # Errors
/// Fails if the bytes are truncated, too many, or do not represent an event.
pub(super) fn read(bytes: &[u8]) -> Result<Event, String> {
    Ok(match binary::read::<Event<OldReply>>(bytes)? {
        Event::Reply { participant, reply, body } => {
            Event::Reply { participant, reply: reply.into(), body }
        }
        Event::Command { participant, command, body } => {
            Event::Command { participant, command, body }
        }
        Event::Iteration(iteration) => Event::Iteration(iteration),
        Event::Repeated { window, cause } => Event::Repeated { window, cause },
        Event::Ended { error } => Event::Ended { error },
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Compares with bytes that were written in format 1.
    #[test]
    fn an_old_reply_has_the_quantities_that_it_had() {
        let nan = [0, 0, 0, 0, 0, 0, 0xf8, 0x7f];
        let cases = [
            (nan, 0.0_f64, (None, None)),
            ((-1.5_f64).to_le_bytes(), 0.25, (Some(-1.5), Some(0.25))),
            ([0; 8], 0.0, (Some(0.0), None)),
        ];
        for (power, window, expected) in cases {
            let start = [1, 0, 6, 0, 3, 251, 44, 1, 1, 2];
            let (seconds, end) = (0.5_f64.to_le_bytes(), [2, 7, 8]);
            let bytes = [&start[..], &power, &seconds, &window.to_le_bytes(), &end].concat();
            let Event::Reply { participant: 0, reply, body } = read(&bytes).unwrap() else {
                panic!("not a reply");
            };
            let counts = (reply.work, reply.substeps, reply.inner_iterations);
            assert_eq!((reply.protocol, reply.sequence, counts), (6, 3, (300, 1, 2)));
            assert_eq!((reply.received_power(), reply.wanted_window()), expected);
            assert_eq!((reply.model_seconds, body), (0.5, vec![7, 8]));
            assert!(read(&bytes[..bytes.len() - 1]).is_err());
        }
    }
}
