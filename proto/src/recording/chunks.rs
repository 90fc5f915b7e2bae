//! Positions of the chunks in a recording, which may still grow.
//!
//! Only the heads of the records are read: an opcode, the length of the record [byte] and, for a
//! chunk, the times of its first and last message [ns]. Messages have strictly increasing times.
//! The last message of a chunk is therefore known by its time.

use mcap::MAGIC;
use mcap::records::op;
use std::io::{self, Read, Seek, SeekFrom};

/// Length of the head of a record: opcode and length.
const HEAD: u64 = 9;

/// A complete chunk with messages. Chunks without messages before it belong to it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Chunk {
    /// Position of its record in the file [byte].
    pub(super) position: u64,
    /// Time of its last message [ns].
    pub last: u64,
    /// Position of its end in the file [byte].
    pub end: u64,
}

/// Finds the chunks of a recording, one after the other.
#[derive(Debug)]
pub struct Chunks<F: Read + Seek> {
    file: F,
    /// Position of the next record [byte].
    next: u64,
    /// Position of the first chunk without messages since the last chunk with messages.
    empty: Option<u64>,
    finished: bool,
}

impl<F: Read + Seek> Chunks<F> {
    /// Returns a search from the start of the file.
    pub fn new(file: F) -> Self {
        Self { file, next: MAGIC.len() as u64, empty: None, finished: false }
    }

    /// Returns whether all chunks were found, because the file has an end.
    #[must_use]
    pub fn is_finished(&self) -> bool {
        self.finished
    }

    /// Returns the next chunk that is complete in the file; `None` if there is none yet.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn find_next(&mut self) -> io::Result<Option<Chunk>> {
        let length = self.file.seek(SeekFrom::End(0))?;
        while !self.finished && self.next + HEAD <= length {
            let position = self.next;
            self.file.seek(SeekFrom::Start(position))?;
            let mut opcode = [0];
            self.file.read_exact(&mut opcode)?;
            let end = position.saturating_add(HEAD).saturating_add(self.number()?);
            if end > length {
                return Ok(None);
            }
            self.next = end;
            match opcode[0] {
                op::DATA_END | op::FOOTER => self.finished = true,
                op::CHUNK if end - position >= HEAD + 16 => {
                    let [_, last] = [self.number()?, self.number()?];
                    let from = self.empty.take().unwrap_or(position);
                    match last {
                        0 => self.empty = Some(from),
                        _ => return Ok(Some(Chunk { position: from, last, end })),
                    }
                }
                _ => {}
            }
        }
        Ok(None)
    }

    /// Replaces the file by one that begins with the same bytes.
    #[cfg(test)]
    pub(super) fn put_file(&mut self, file: F) {
        self.file = file;
    }

    fn number(&mut self) -> io::Result<u64> {
        let mut bytes = [0; 8];
        self.file.read_exact(&mut bytes)?;
        Ok(u64::from_le_bytes(bytes))
    }
}
