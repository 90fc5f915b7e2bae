//! The archive that an FMU is. It has no times of files: the same case gives the same bytes.

use run::error::{RunError, file_failure};
use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::Path;
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipWriter};

/// A file of the archive.
pub(super) struct Entry {
    pub(super) name: String,
    pub(super) content: Vec<u8>,
    pub(super) executable: bool,
}

/// Writes an archive, first beside where it goes, so that there is a whole one or none.
///
/// # Errors
/// The file system.
pub(super) fn write(path: &Path, entries: &[Entry]) -> Result<(), RunError> {
    let failed = |error: &io::Error| file_failure(path, error);
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
    let draft = tempfile::Builder::new()
        .prefix(".fmu-")
        .tempfile_in(folder.unwrap_or(Path::new(".")))
        .map_err(|error| failed(&error))?;
    archive(draft.as_file(), entries).map_err(|error| failed(&error))?;
    draft.persist(path).map_err(|error| failed(&error.error))?;
    let mode = std::os::unix::fs::PermissionsExt::from_mode(0o644);
    std::fs::set_permissions(path, mode).map_err(|error| failed(&error))
}

fn archive(file: &File, entries: &[Entry]) -> io::Result<()> {
    let mut zip = ZipWriter::new(BufWriter::new(file));
    for Entry { name, content, executable } in entries {
        let mode = if *executable { 0o755 } else { 0o644 };
        let options = SimpleFileOptions::default()
            .compression_method(CompressionMethod::Deflated)
            .last_modified_time(zip::DateTime::default())
            .unix_permissions(mode);
        zip.start_file(name, options).map_err(io::Error::other)?;
        zip.write_all(content)?;
    }
    zip.finish().map_err(io::Error::other)?.flush()
}
