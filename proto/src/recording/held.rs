//! Memory limit of the reader of a recording.
//!
//! A reader keeps the attachments, the newest message of each channel, and the grids from the
//! messages. A compressed chunk of a few kilobytes can claim any length for these. Therefore their
//! total is limited to a base plus a multiple of the bytes read from the file. Uncompressed
//! recordings never reach the limit, whatever their size.

use mcap::records::op;
use std::collections::HashMap;

/// Memory permitted for a file of any length [byte].
const BASE: u64 = 256 << 20;
/// Additional memory permitted for each byte read from the file [byte].
const PER_BYTE: u64 = 16;
/// Memory of a parsed text for each of its bytes [byte].
const UNDERSTOOD: u64 = 4;
/// Memory of an entry besides its content [byte].
const ENTRY: u64 = 256;

/// Memory that the reader of a recording holds.
#[derive(Debug, Default)]
pub(super) struct MemoryBudget {
    bytes: u64,
    /// Length of the longest message of each channel so far.
    longest: HashMap<u16, u64>,
}

impl MemoryBudget {
    /// Accounts for a record before it is read; `read` is the number of bytes read from the file.
    ///
    /// # Errors
    /// Fails if the total memory would exceed the limit.
    pub(super) fn record(&mut self, opcode: u8, record: &[u8], read: u64) -> Result<(), String> {
        let length = record.len() as u64;
        let (kept, passing) = match (opcode, record.first_chunk()) {
            (op::ATTACHMENT, _) => (length + ENTRY, 0),
            (op::MESSAGE, Some(channel)) => {
                let longest = self.longest.entry(u16::from_le_bytes(*channel)).or_insert(0);
                let more = length.saturating_sub(*longest);
                *longest += more;
                (more, 0)
            }
            _ => (0, length),
        };
        self.bytes += kept;
        self.within(passing, read)
    }

    /// Accounts for a text in a command or reply.
    ///
    /// # Errors
    /// Fails like [`MemoryBudget::record`].
    pub(super) fn text(&mut self, length: usize, read: u64) -> Result<(), String> {
        self.bytes += UNDERSTOOD * length as u64;
        self.within(0, read)
    }

    fn within(&self, passing: u64, read: u64) -> Result<(), String> {
        let (needed, most) = (self.bytes + passing, BASE.saturating_add(PER_BYTE * read));
        if needed <= most {
            return Ok(());
        }
        let mib = |bytes: u64| bytes >> 20;
        Err(format!(
            "its attachments, samples and grids claim {} MiB by byte {read} of the file, {} MiB at \
             most",
            mib(needed),
            mib(most)
        ))
    }
}
