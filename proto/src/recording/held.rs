//! How much a recording makes its reader hold.
//!
//! A reader of a recording keeps its attachments, the newest message of each channel and what the
//! conversation says of grids. A compressed chunk of some kilobytes can claim any length for those,
//! so that their sum is limited: to a base, and beyond it to a multiple of what has been read of the
//! file. Uncompressed recordings never reach the limit, whatever their size.

use mcap::records::op;
use std::collections::HashMap;

/// What may be held whatever the length of the file [byte].
const BASE: u64 = 256 << 20;
/// Bytes that may be held for each byte of the file.
const PER_BYTE: u64 = 16;
/// What a text of the conversation takes once it is understood, for each of its bytes.
const UNDERSTOOD: u64 = 4;
/// What an entry takes besides its content [byte].
const ENTRY: u64 = 256;

/// What the reader of a recording holds.
#[derive(Debug, Default)]
pub(super) struct Held {
    bytes: u64,
    /// The longest message of each channel so far.
    longest: HashMap<u16, u64>,
}

impl Held {
    /// A record that is about to be taken from the file, of which so much has been read.
    ///
    /// # Errors
    /// With it more would be held than is reasonable.
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

    /// A text of the conversation.
    ///
    /// # Errors
    /// As [`Held::record`].
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
