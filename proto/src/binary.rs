//! The binary form of what only this project writes and reads back: control events of recordings,
//! states, checkpoints. The only user of bincode beside the models' own states.
//!
//! Lengths inside are checked against a limit before anything is allocated for them.

use serde::Serialize;
use serde::de::DeserializeOwned;

/// Longest content that is read back [byte].
pub const LONGEST: usize = 1 << 30;

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
    let config = bincode::config::standard().with_limit::<LONGEST>();
    let (value, used) =
        bincode::serde::decode_from_slice(bytes, config).map_err(|error| error.to_string())?;
    match bytes.len() - used {
        0 => Ok(value),
        rest => Err(format!("{rest} bytes follow its end")),
    }
}
