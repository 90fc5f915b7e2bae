//! Binary form of data that only this project writes and reads: control events of recordings,
//! states, checkpoints. Besides the models' own states, only this module uses bincode.
//!
//! Lengths inside the data are checked against a limit before memory is allocated.

use serde::Serialize;
use serde::de::DeserializeOwned;

/// Maximum length of data to read [byte].
pub const LONGEST: usize = 1 << 30;
/// Data up to this length may claim at most [`SMALL_CLAIM`] [byte].
const SMALL: usize = SMALL_CLAIM / WIDEST;
const SMALL_CLAIM: usize = 1 << 20;
/// Upper bound of the memory that one byte of data can claim: a number of eight bytes, with room to
/// spare.
const WIDEST: usize = 16;

/// Appends the binary form of a value.
///
/// # Errors
/// Fails if the value cannot be serialised, for example a map of unknown length.
pub fn append(into: &mut Vec<u8>, value: &impl Serialize) -> Result<(), String> {
    bincode::serde::encode_into_std_write(value, into, bincode::config::standard())
        .map(|_| ())
        .map_err(|error| error.to_string())
}

/// Returns the words for an error of the decoder, whose own text has the form of its source code.
fn reason(error: &bincode::error::DecodeError) -> &'static str {
    use bincode::error::DecodeError;
    match error {
        DecodeError::UnexpectedEnd { .. } => "it is truncated",
        DecodeError::LimitExceeded => "it claims more memory than its length allows",
        DecodeError::Utf8 { .. } => "a text in it is not UTF-8",
        DecodeError::UnexpectedVariant { .. } => "it is a message of an unknown kind",
        _ => "it is malformed",
    }
}

/// Reads a value back; all bytes must be used.
///
/// # Errors
/// Fails if the bytes are truncated, too many, or do not represent such a value.
pub fn read<T: DeserializeOwned>(bytes: &[u8]) -> Result<T, String> {
    use bincode::{config::standard, serde::decode_from_slice as decode};
    let decoded = match bytes.len() {
        // The decoder allocates a claimed length before it finds data missing.
        0..=SMALL => decode(bytes, standard().with_limit::<SMALL_CLAIM>()),
        _ => decode(bytes, standard().with_limit::<LONGEST>()),
    };
    let (value, used) = decoded.map_err(|error| reason(&error).to_owned())?;
    match bytes.len() - used {
        0 => Ok(value),
        rest => Err(format!("{rest} bytes follow its end")),
    }
}
