//! Files that only this project reads: eight bytes for format and version, a CRC-64 of the content,
//! and the content in binary form.
//!
//! The checksum is CRC-64/XZ: reflected, polynomial 0x42F0E1EBA9EA3693 (ECMA-182), all ones before
//! and after. It detects a truncated or damaged file, but gives no protection against forgery.

use crc64fast::Digest;
use proto::binary;
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

/// First bytes of such a file.
pub type Magic = [u8; 8];

/// Size of the checksum [byte].
const SUM: usize = size_of::<u64>();

/// Reason why a file is not used.
#[derive(Debug, PartialEq, Eq, thiserror::Error)]
pub enum SealedFileError {
    /// The file begins with other bytes, or is shorter.
    #[error("not of this version")]
    Foreign,
    /// The checksum does not match; with the length in bytes.
    #[error("corrupt: checksum mismatch in {0} bytes")]
    Sum(usize),
    /// The checksum matches, but the content is invalid.
    #[error("{0}")]
    Content(String),
}

/// Returns the bytes of a file with this content.
///
/// # Errors
/// The content cannot be serialised.
pub fn seal(magic: &Magic, content: &impl Serialize) -> Result<Vec<u8>, String> {
    let mut bytes = [magic.as_slice(), &[0; SUM]].concat();
    binary::append(&mut bytes, content)?;
    let (head, content) = bytes.split_at_mut(magic.len() + SUM);
    head[magic.len()..].copy_from_slice(&sum(content).to_le_bytes());
    Ok(bytes)
}

/// Reads the content of a file.
///
/// # Errors
/// [`SealedFileError`] if the first bytes, the checksum or the content do not match.
pub fn open<T: DeserializeOwned>(magic: &Magic, bytes: &[u8]) -> Result<T, SealedFileError> {
    let rest = bytes.strip_prefix(magic.as_slice()).ok_or(SealedFileError::Foreign)?;
    let (expected, content) = rest.split_first_chunk().ok_or(SealedFileError::Foreign)?;
    if sum(content) != u64::from_le_bytes(*expected) {
        return Err(SealedFileError::Sum(bytes.len()));
    }
    binary::read(content).map_err(SealedFileError::Content)
}

/// Number of bytes of a stream that are read at once.
const PIECE: usize = 1 << 16;

/// Returns the CRC-64 of some bytes.
#[must_use]
pub fn sum(bytes: &[u8]) -> u64 {
    let mut digest = Digest::new();
    digest.write(bytes);
    digest.sum64()
}

/// Returns the CRC-64 of a file.
///
/// # Errors
/// The path is not a regular file, or cannot be read.
pub fn sum_of_file(path: &Path) -> io::Result<u64> {
    // The check comes before opening: opening a pipe would wait for a writer.
    if !path.metadata()?.is_file() {
        return Err(io::Error::other("is not a file"));
    }
    sum_of_stream(File::open(path)?).map(|(_, sum)| sum)
}

/// Returns length and CRC-64 of a stream. Only a piece of it is in memory at a time.
///
/// # Errors
/// Errors of the stream.
pub(crate) fn sum_of_stream(mut from: impl Read) -> io::Result<(u64, u64)> {
    let (mut length, mut digest, mut piece) = (0, Digest::new(), vec![0; PIECE]);
    loop {
        match from.read(&mut piece) {
            Ok(0) => return Ok((length, digest.sum64())),
            Ok(count) => {
                length += count as u64;
                digest.write(&piece[..count]);
            }
            Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
            Err(error) => return Err(error),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Check value from the catalogue of parametrised CRC algorithms.
    #[test]
    fn the_standard_check_value() {
        assert_eq!(sum(b"123456789"), 0x995D_C9BB_DF19_39FA);
        assert_eq!(sum(b""), 0);
    }

    #[test]
    fn a_stream_has_the_sum_of_its_bytes() {
        let bytes: Vec<u8> = (0..3 * PIECE + 7).map(|i| (i * i) as u8).collect();
        assert_eq!(sum_of_stream(bytes.as_slice()).unwrap(), (bytes.len() as u64, sum(&bytes)));
    }
}
