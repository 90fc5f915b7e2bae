//! Key shared by both ends: a file readable by its owner only. The key itself is never transmitted.

use contract::input_file::{self, InputFileError};
use ring::digest::{SHA256, digest};
use ring::rand::{SecureRandom, SystemRandom};
use std::fs::OpenOptions;
use std::io::{self, Read, Write};
use std::os::unix::fs::{MetadataExt, OpenOptionsExt};
use std::path::Path;

/// Allowed lengths of a key [byte].
const LENGTHS: std::ops::RangeInclusive<usize> = 32..=4096;
/// Bytes of a new key; the file holds two hexadecimal digits a byte.
const NEW: usize = 32;

/// Key shared by both ends.
pub struct Key(Vec<u8>);

impl std::fmt::Debug for Key {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("Key(..)")
    }
}

/// Reason why a key cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum KeyError {
    /// The file cannot be read or written.
    #[error("the key file {path}: {error}")]
    File {
        /// Path of the key file.
        path: String,
        /// Error of the system.
        error: io::Error,
    },
    /// Other users may read the file.
    #[error(
        "the key file {path} can be read by others (mode {mode:03o}); \
         make it yours alone: chmod 600 {path}"
    )]
    Open {
        /// Path of the key file.
        path: String,
        /// Permission bits.
        mode: u32,
    },
    /// The key is too short to resist guessing, or the file is not a key file.
    #[error(
        "the key file {path} has {bytes} bytes, not {} to {}; \
         make one: coordinator relay --new-key FILE",
        LENGTHS.start(), LENGTHS.end()
    )]
    Length {
        /// Path of the key file.
        path: String,
        /// Number of bytes without trailing white space.
        bytes: usize,
    },
}

impl Key {
    /// Reads a key file.
    ///
    /// # Errors
    /// Fails if the file cannot be read, is readable by other users, or has a length outside the
    /// limits.
    pub fn read(path: &Path) -> Result<Self, KeyError> {
        let shown = path.display().to_string();
        let failed = |error| KeyError::File { path: shown.clone(), error };
        let file = input_file::open(path).map_err(|error| match error {
            InputFileError::System(error) => failed(error),
            error => failed(std::io::Error::other(error.to_string())),
        })?;
        let mode = file.metadata().map_err(failed)?.mode() & 0o777;
        if mode & 0o077 != 0 {
            return Err(KeyError::Open { path: shown, mode });
        }
        let mut bytes = Vec::new();
        let most = *LENGTHS.end() as u64 + 2;
        (&file).take(most).read_to_end(&mut bytes).map_err(failed)?;
        while bytes.last().is_some_and(u8::is_ascii_whitespace) {
            bytes.pop();
        }
        match LENGTHS.contains(&bytes.len()) {
            true => Ok(Self(bytes)),
            false => Err(KeyError::Length { path: shown, bytes: bytes.len() }),
        }
    }

    /// Writes a new key to a new file, readable by its owner only.
    ///
    /// # Errors
    /// Fails if the file exists or cannot be written.
    pub fn create(path: &Path) -> Result<(), KeyError> {
        let failed = |error| KeyError::File { path: path.display().to_string(), error };
        let mut bytes = [0; NEW];
        SystemRandom::new().fill(&mut bytes).expect("the system has random numbers");
        let text: String = bytes.iter().map(|byte| format!("{byte:02x}")).collect();
        let mut options = OpenOptions::new();
        let mut file =
            options.write(true).create_new(true).mode(0o600).open(path).map_err(failed)?;
        writeln!(file, "{text}").and_then(|()| file.sync_all()).map_err(failed)
    }

    /// Returns the pre-shared key of the handshake: SHA-256 of a fixed prefix and the bytes of the
    /// key.
    pub(crate) fn pre_shared(&self) -> [u8; 32] {
        let hashed = digest(&SHA256, &[b"cosim relay: key", &self.0[..]].concat());
        hashed.as_ref().try_into().expect("SHA-256 has 32 bytes")
    }

    #[cfg(test)]
    pub(crate) fn of(bytes: &[u8]) -> Self {
        Self(bytes.to_vec())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs::Permissions;
    use std::os::unix::fs::PermissionsExt;

    #[test]
    fn a_new_key_is_read_back_and_is_ours_alone() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("key");
        Key::create(&path).unwrap();
        assert_eq!(Key::read(&path).unwrap().0.len(), 2 * NEW);
        assert!(Key::create(&path).unwrap_err().to_string().contains("exists"));
        for mode in [0o640, 0o604, 0o660] {
            std::fs::set_permissions(&path, Permissions::from_mode(mode)).unwrap();
            let error = Key::read(&path).unwrap_err().to_string();
            assert!(error.contains("can be read by others") && error.contains("chmod 600"));
        }
    }

    #[test]
    fn what_is_no_key_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("key");
        for length in [0, 31, 4097, 100_000] {
            std::fs::write(&path, "k".repeat(length) + "\n").unwrap();
            std::fs::set_permissions(&path, Permissions::from_mode(0o600)).unwrap();
            let error = Key::read(&path).unwrap_err().to_string();
            assert!(error.contains("--new-key"), "{error}");
        }
        assert!(Key::read(&folder.path().join("none")).is_err());
        // A pipe would block until its writer writes; a device may never end.
        let device = Key::read(Path::new("/dev/zero")).unwrap_err().to_string();
        assert!(device.contains("is a device"), "{device}");
    }
}
