//! Reading of the files of a result folder. The folder may come from elsewhere, so that a pipe, a
//! device or a link to one may be in the place of a file.

use contract::input_file::{self, InputFileError};
use std::path::Path;

/// Largest file of results that is read as a whole \[byte\]: tables of some million windows.
const MOST: u64 = 1 << 30;

/// Reads a file of a result folder.
///
/// # Errors
/// The file is missing, is not a regular file, or is larger than any file of results.
pub fn read_file(path: &Path) -> Result<Vec<u8>, InputFileError> {
    input_file::read(path, MOST)
}

#[cfg(test)]
mod tests {
    use super::*;
    use rustix::fs::{CWD, FileType, Mode, mknodat};
    use std::os::unix::fs::symlink;

    #[test]
    fn a_pipe_or_a_device_is_no_file_of_results() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        mknodat(CWD, at("pipe"), FileType::Fifo, Mode::from_raw_mode(0o600), 0).unwrap();
        symlink("/dev/zero", at("link")).unwrap();
        for (name, what) in [("pipe", "a named pipe"), ("link", "a device")] {
            let refused = read_file(&at(name)).unwrap_err().to_string();
            assert!(refused.contains(what), "{refused}");
        }
    }
}
