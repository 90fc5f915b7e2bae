//! Files that only this project reads back: a word for their format and its version, a CRC-64 of the
//! content, and the content in binary form.

use crate::checkpoint::sum;
use proto::binary;
use serde::Serialize;
use serde::de::DeserializeOwned;

/// The word that such a file begins with.
pub type Magic = [u8; 8];

const SUM: usize = size_of::<u64>();

/// Why a file is not used.
#[derive(Debug, PartialEq, Eq, thiserror::Error)]
pub enum Broken {
    /// It begins with another word, or is shorter.
    #[error("not of this version")]
    Foreign,
    /// Its length in bytes.
    #[error("corrupt: checksum mismatch in {0} bytes")]
    Sum(usize),
    /// The sum is right, the content is not.
    #[error("{0}")]
    Content(String),
}

/// The bytes of a file.
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

/// The content of a file.
///
/// # Errors
/// [`Broken`].
pub fn open<T: DeserializeOwned>(magic: &Magic, bytes: &[u8]) -> Result<T, Broken> {
    let rest = bytes.strip_prefix(magic.as_slice()).ok_or(Broken::Foreign)?;
    let (expected, content) = rest.split_first_chunk().ok_or(Broken::Foreign)?;
    if sum(content) != u64::from_le_bytes(*expected) {
        return Err(Broken::Sum(bytes.len()));
    }
    binary::read(content).map_err(Broken::Content)
}
