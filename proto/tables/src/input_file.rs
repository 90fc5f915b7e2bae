//! Files named by a user or a case, read as regular files of limited size.
//!
//! Pipes, devices and directories are refused, because a named pipe could block forever and a
//! device has no end. Messages never quote contents, because the file may not belong to the user.

use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

/// Reason why a file cannot be used. Each message continues a sentence that begins with the path.
#[derive(Debug, thiserror::Error)]
pub enum InputFileError {
    /// The operating system reports an error.
    #[error("cannot be read: {0}")]
    System(#[from] io::Error),
    /// The path is not a regular file.
    #[error("is {0}, where a regular file is expected")]
    NotRegular(&'static str),
    /// The file is larger than its kind may be.
    #[error("is larger than the limit of {most} bytes")]
    TooLarge {
        /// Maximum size [byte].
        most: u64,
    },
    /// The file is UTF-16 text.
    #[error("is UTF-16 text; save it as UTF-8")]
    Utf16,
    /// The file is not UTF-8 text.
    #[error("is not UTF-8 text in line {line}; save it as UTF-8")]
    NotUtf8 {
        /// Number of the line, from 1.
        line: usize,
    },
    /// The file contains a zero byte.
    #[error("is not a text file: line {line} holds a zero byte")]
    Binary {
        /// Number of the line, from 1.
        line: usize,
    },
}

/// Opens a regular file.
///
/// # Errors
/// Fails if the file cannot be opened, or is a pipe, a device, a socket or a directory.
pub fn open(path: &Path) -> Result<File, InputFileError> {
    // Checked before opening, because opening a named pipe waits for its writer.
    refuse_irregular(&path.metadata()?)?;
    let file = File::open(path)?;
    refuse_irregular(&file.metadata()?)?;
    Ok(file)
}

/// Reads a regular file of at most `most` bytes.
///
/// # Errors
/// Fails like [`open`], or if the file is larger.
pub fn read(path: &Path, most: u64) -> Result<Vec<u8>, InputFileError> {
    let file = open(path)?;
    let length = file.metadata()?.len();
    if length > most {
        return Err(InputFileError::TooLarge { most });
    }
    // Files in /proc report no length, and others may grow while they are read.
    let mut bytes = Vec::with_capacity(usize::try_from(length).unwrap_or(0));
    file.take(most + 1).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > most { Err(InputFileError::TooLarge { most }) } else { Ok(bytes) }
}

/// Reads a regular text file, without its byte order mark.
///
/// # Errors
/// Fails like [`read`], or if the file is not UTF-8 text.
pub fn read_text(path: &Path, most: u64) -> Result<String, InputFileError> {
    into_text(read(path, most)?)
}

/// Returns bytes as text, without a byte order mark.
///
/// # Errors
/// Fails if the bytes are not UTF-8 text.
pub fn into_text(bytes: Vec<u8>) -> Result<String, InputFileError> {
    if bytes.starts_with(&[0xff, 0xfe]) || bytes.starts_with(&[0xfe, 0xff]) {
        return Err(InputFileError::Utf16);
    }
    let line = |at: usize, bytes: &[u8]| 1 + bytes[..at].iter().filter(|b| **b == b'\n').count();
    if let Some(at) = bytes.iter().position(|byte| *byte == 0) {
        return Err(InputFileError::Binary { line: line(at, &bytes) });
    }
    let mut text = String::from_utf8(bytes).map_err(|error| {
        let at = error.utf8_error().valid_up_to();
        InputFileError::NotUtf8 { line: line(at, error.as_bytes()) }
    })?;
    if text.starts_with('\u{feff}') {
        text.drain(..'\u{feff}'.len_utf8());
    }
    Ok(text)
}

fn refuse_irregular(found: &std::fs::Metadata) -> Result<(), InputFileError> {
    use std::os::unix::fs::FileTypeExt;
    let kind = found.file_type();
    let name = match () {
        () if kind.is_file() => return Ok(()),
        () if kind.is_dir() => "a directory",
        () if kind.is_fifo() => "a named pipe",
        () if kind.is_socket() => "a socket",
        () => "a device",
    };
    Err(InputFileError::NotRegular(name))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refusal(path: &str) -> String {
        read(Path::new(path), 1 << 20).unwrap_err().to_string()
    }

    #[test]
    fn only_regular_files_of_a_limited_size_are_read() {
        assert!(refusal("/dev/zero").contains("a device"));
        assert!(refusal("/dev").contains("a directory"));
        assert!(refusal("/nowhere").contains("cannot be read"));
        let path = std::env::temp_dir().join(format!("contract-input-file-{}", std::process::id()));
        std::fs::write(&path, "12345").unwrap();
        assert_eq!(read(&path, 5).unwrap(), b"12345");
        assert!(matches!(read(&path, 4), Err(InputFileError::TooLarge { most: 4 })));
        std::fs::remove_file(&path).unwrap();
    }

    #[test]
    fn text_loses_its_mark_and_other_encodings_are_named() {
        assert_eq!(into_text("\u{feff}a\n".into()).unwrap(), "a\n");
        let said = |bytes: &[u8]| into_text(bytes.to_vec()).unwrap_err().to_string();
        assert!(said(&[0xff, 0xfe, b'a', 0]).contains("UTF-16"));
        assert!(said(b"a\n\xb0C\n").contains("line 2"));
        assert!(said(b"a\n\n\0").contains("line 3"));
    }
}
