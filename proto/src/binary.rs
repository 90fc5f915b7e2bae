//! The binary form of what only this project writes and reads back: control events of recordings,
//! states, checkpoints. The only user of bincode beside the models' own states.
//!
//! Lengths inside are checked against a limit before anything is allocated for them.

use serde::Serialize;
use serde::de::DeserializeOwned;

/// Longest content that is read back [byte].
pub const LONGEST: usize = 1 << 30;
/// Contents up to this length claim no more than [`SMALL_CLAIM`] [byte].
const SMALL: usize = SMALL_CLAIM / WIDEST;
const SMALL_CLAIM: usize = 1 << 20;
/// The most that a byte of content stands for: a number of eight bytes, with room to spare.
const WIDEST: usize = 16;

/// Appends the binary form of a value.
///
/// # Errors
/// The value cannot be serialised, a map of unknown length for example.
pub fn append(into: &mut Vec<u8>, value: &impl Serialize) -> Result<(), String> {
    bincode::serde::encode_into_std_write(value, into, bincode::config::standard())
        .map(|_| ())
        .map_err(|error| error.to_string())
}

/// Reads a value back; every byte must have been used.
///
/// # Errors
/// The bytes are cut, too many, or not of such a value.
pub fn read<T: DeserializeOwned>(bytes: &[u8]) -> Result<T, String> {
    use bincode::{config::standard, serde::decode_from_slice as decode};
    let decoded = match bytes.len() {
        // What a length inside claims is allocated before it is found missing.
        0..=SMALL => decode(bytes, standard().with_limit::<SMALL_CLAIM>()),
        _ => decode(bytes, standard().with_limit::<LONGEST>()),
    };
    let (value, used) = decoded.map_err(|error| error.to_string())?;
    match bytes.len() - used {
        0 => Ok(value),
        rest => Err(format!("{rest} bytes follow its end")),
    }
}
