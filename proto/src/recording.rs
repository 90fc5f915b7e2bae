//! Recordings: all messages of a run, in one file.
//!
//! The container is [MCAP](https://mcap.dev), which many tools read. Its chunks have an index and a
//! CRC-32 each, and are uncompressed or compressed with LZ4. Content:
//!
//! | record | name | content |
//! |---|---|---|
//! | attachment | `head.json` | [`Head`]: versions and descriptions of the participants |
//! | attachment | `case.toml`, `plan.txt` | the case as run, and its plan |
//! | attachment | `files/KEY` | the file that the case names with this key |
//! | channel | `control` | one [`Event`] per message, bincode 2 (standard configuration) |
//! | channel | `field/ROLE/NAME`, ... | one sample per message, see [`FIELD_SCHEMA`] |
//! | channel | `state/ROLE` | saved state of a participant, readable only by this participant |
//!
//! Messages are in the order of their exchange. `log_time` counts nanoseconds from the start of the
//! recording and increases strictly. A recording contains no calendar time, no path, and no name of
//! a machine or person.
//!
//! **Files from elsewhere.** Names obey the same rule as in messages, and grids are checked like
//! those of a participant. The total memory of a reader is limited. A file that violates a rule is
//! damaged.
//!
//! **Truncated files.** Each chunk is written at once. [`Recording`] reads from front to back and
//! needs neither index nor footer, so a truncated file is readable up to the cut.
//! [`Recording::end`] tells whether the file is complete.

mod admit;
mod chunks;
mod event;
mod format_1;
mod held;
mod label;
mod reader;
mod writer;
mod zstd;

pub use chunks::{Chunk, Chunks};
pub use event::{Event, Iteration, read_topics};
pub use label::{LABEL_BYTES, read_label, write_label};
pub use reader::{End, Entry, Item, Recording};
pub use writer::{Compression, RecordingWriter};

use crate::description::Description;
use crate::field::{Body, FieldKind, Mapping};
use crate::message::FieldHeader;
use serde::{Deserialize, Serialize};

/// Version of the content of the container; raised when a layout below changes. The module
/// `format_1` translates recordings of format 1.
pub const FORMAT: u32 = 2;
/// Profile in the container's header.
pub const PROFILE: &str = "cosim";
/// Name of the channel of [`Event`]s.
pub const CONTROL: &str = "control";
/// Prefix of channels of states.
pub const STATE: &str = "state/";
/// Prefix of attached files of the case.
pub const FILES: &str = "files/";
/// Maximum length of a message [byte]: samples of up to 128 million doubles.
pub const LONGEST_RECORD: usize = 1 << 30;

/// Schema of the channels of fields, readable by other tools.
pub const FIELD_SCHEMA: &str = "\
One sample of a field. Little-endian; offsets in bytes.
  0  u32 protocol      version of the participant contract
  4  u32 components
  8  u64 points
 16  u64 grid_revision
 24  u64 window        from 0
 32  u32 iteration     from 1; 0 before the first solve
 36  u32 reserved      0
 40  f64 start         of the interval the values hold for [s]
 48  f64 end           [s]
 56  u64 sequence      from 1 on each channel
 64  char[32] name     zero-padded ASCII
 96  char[16] unit     SI
112  char[32] producer role
144  char[32] grid     name of the grid
176  f64 values[components * points], component-major
The grids stand as JSON in the replies to Configure on the channel `control`.
";

/// Head of a recording.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Head {
    /// [`FORMAT`] of the writer.
    pub format: u32,
    /// [`crate::PROTOCOL_VERSION`] of the run.
    pub protocol: u32,
    /// Name and version of the program that wrote the recording.
    pub writer: String,
    /// Short name of the case.
    pub case: String,
    /// Coupling scheme.
    pub scheme: String,
    /// Acceleration method of the coupling iterations.
    pub acceleration: String,
    /// Participants; an [`Event`] refers to a participant by its index in this list.
    pub participants: Vec<Participant>,
    /// Keys of the case that name a file, with the attachment of each.
    pub files: Vec<CaseFile>,
}

impl Head {
    /// Returns the kind of the field of a sample, as the contract or a participant describes it. An
    /// unknown field has its label only, and belongs to the interface.
    #[must_use]
    pub fn field_kind(&self, header: &FieldHeader) -> FieldKind {
        let name = header.name.as_str();
        let known = self.participants.iter().find_map(|one| one.description.field_kind(name));
        known.unwrap_or_else(|| FieldKind {
            name: name.to_owned(),
            unit: header.unit.as_str().to_owned(),
            components: header.components,
            mapping: Mapping::Consistent,
            body: Body::Interface,
            meaning: String::new(),
        })
    }
}

/// A participant of a recorded run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Participant {
    /// Role of the participant.
    pub role: String,
    /// File name of the program.
    pub program: String,
    /// Description of the participant.
    pub description: Description,
}

/// A file that the case names.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct CaseFile {
    /// Dotted key of the case.
    pub key: String,
    /// Name of the attachment, which replaces the path in recorded configurations.
    pub attachment: String,
}

/// Error of reading or writing a recording.
#[derive(Debug, thiserror::Error)]
pub enum RecordingError {
    /// The file cannot be read or written.
    #[error("{0}")]
    Io(#[from] std::io::Error),
    /// The container is damaged, or the file is not a container.
    #[error("the recording is damaged: {0}")]
    Container(mcap::McapError),
    /// The content of the container violates the format.
    #[error("the recording is damaged: {0}")]
    Content(String),
    /// The program that wrote the recording is too new or too old.
    #[error("the recording has format {found}; this program reads formats 1 to {FORMAT}")]
    Format {
        /// Format of the recording.
        found: u32,
    },
    /// The file is truncated before the end of the head.
    #[error(
        "the recording is truncated before its header is complete: nothing can be read from \
             it"
    )]
    NoHead,
}

impl From<mcap::McapError> for RecordingError {
    fn from(error: mcap::McapError) -> Self {
        match error {
            mcap::McapError::Io(error) => Self::Io(error),
            other => Self::Container(other),
        }
    }
}

#[cfg(test)]
mod tests;
