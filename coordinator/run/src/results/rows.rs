//! A table of a result folder, written row by row during the run.

use crate::error::{RunError, file_failure};
use crate::results::dir::shown;
use crate::results::write::fresh;
use rustix::fs::OFlags;
use std::fs::File;
use std::io::{Read, Seek, SeekFrom, Write};
use std::os::unix::fs::OpenOptionsExt;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Longest time for which rows stay in memory while further rows are added.
const UNWRITTEN: Duration = Duration::from_secs(1);

/// Writer of the table.
#[derive(Debug)]
pub(crate) struct Rows {
    file: File,
    path: PathBuf,
    /// Buffered rows, not yet in the file.
    unwritten: Vec<u8>,
    /// Length of the file \[byte\].
    bytes: u64,
    flushed: Instant,
}

impl Rows {
    /// Creates the file and writes its header.
    pub(super) fn create(path: &Path, head: Vec<u8>) -> Result<Self, RunError> {
        let file = fresh(path).map_err(|error| file_failure(path, &error))?;
        let mut rows = Self { unwritten: head, ..Self::in_file(file, path, 0) };
        rows.flush()?;
        Ok(rows)
    }

    fn in_file(file: File, path: &Path, bytes: u64) -> Self {
        let (path, unwritten) = (path.to_owned(), Vec::new());
        Self { file, path, unwritten, bytes, flushed: Instant::now() }
    }

    /// Opens the table of a resumed run, and discards the content after the first `bytes` bytes.
    ///
    /// # Errors
    /// The file is shorter, or cannot be opened.
    pub(super) fn resume(path: &Path, bytes: u64) -> Result<Self, RunError> {
        let failed = |error| file_failure(path, &error);
        // Neither through a link nor into a pipe, whose other end would be waited for.
        let flags = (OFlags::NOFOLLOW | OFlags::NONBLOCK).bits().cast_signed();
        let open = File::options().write(true).custom_flags(flags).open(path);
        let mut file = open.map_err(failed)?;
        let found = file.metadata().map_err(failed)?.len();
        if found < bytes {
            let shown = shown(path);
            let shown = shown.display();
            return Err(RunError::Usage(format!(
                "{shown} has {found} bytes, but had {bytes} at the checkpoint; the run cannot be \
                 resumed without them"
            )));
        }
        file.set_len(bytes).and_then(|()| file.seek(SeekFrom::End(0))).map_err(failed)?;
        Ok(Self::in_file(file, path, bytes))
    }

    /// Flushes everything to the disk and returns the length of the file \[byte\].
    pub(crate) fn seal(&mut self) -> Result<u64, RunError> {
        self.flush()?;
        self.file.sync_data().map_err(|error| file_failure(&self.path, &error))?;
        Ok(self.bytes)
    }

    /// Writes buffered rows to the file and returns its length \[byte\].
    pub(crate) fn mark(&mut self) -> Result<u64, RunError> {
        self.flush()?;
        Ok(self.bytes)
    }

    /// Cuts the file to `bytes` bytes and returns the removed rows.
    pub(crate) fn cut(&mut self, bytes: u64) -> Result<Vec<u8>, RunError> {
        self.flush()?;
        let Self { file, path, bytes: length, .. } = self;
        let mut cut = || {
            let mut rest = Vec::new();
            let mut written = File::open(&*path)?;
            written.seek(SeekFrom::Start(bytes))?;
            written.read_to_end(&mut rest)?;
            file.set_len(bytes)?;
            file.seek(SeekFrom::Start(bytes))?;
            Ok(rest)
        };
        let rest = cut().map_err(|error| file_failure(path, &error))?;
        *length = bytes;
        Ok(rest)
    }

    /// Adds rows that were cut.
    pub(crate) fn append(&mut self, rows: &[u8]) -> Result<(), RunError> {
        self.unwritten.extend_from_slice(rows);
        self.flush()
    }

    /// Adds a row. It is written within about a second, with a later row.
    pub(super) fn add(&mut self, write: impl FnOnce(&mut Vec<u8>)) -> Result<(), RunError> {
        write(&mut self.unwritten);
        self.unwritten.push(b'\n');
        if self.flushed.elapsed() >= UNWRITTEN { self.flush() } else { Ok(()) }
    }

    /// Writes buffered rows to the file. On a full disk the file is cut after the last complete
    /// flush.
    pub(crate) fn flush(&mut self) -> Result<(), RunError> {
        self.flushed = Instant::now();
        let written = self.file.write_all(&self.unwritten);
        if written.is_ok() {
            self.bytes += self.unwritten.len() as u64;
        }
        self.unwritten.clear();
        written.map_err(|error| {
            let _ = self.file.set_len(self.bytes);
            file_failure(&self.path, &error)
        })
    }
}

/// Writes a comma and a number, or only a comma.
pub(super) fn cell(out: &mut Vec<u8>, value: Option<f64>) {
    match value {
        Some(value) => push(out, format_args!(",{value:e}")),
        None => out.push(b','),
    }
}

/// Adds text to a row.
pub(super) fn push(out: &mut Vec<u8>, text: std::fmt::Arguments<'_>) {
    out.write_fmt(text).expect("memory takes whatever is written");
}
