//! Recordings: everything that was exchanged in a run, in one file.
//!
//! The container is [MCAP](https://mcap.dev), which many tools read: chunks with an index and a
//! CRC-32 each, uncompressed or zstd. What is inside:
//!
//! | record | name | content |
//! |---|---|---|
//! | attachment | `head.json` | [`Head`]: versions, participants and what they say of themselves |
//! | attachment | `case.toml`, `plan.txt` | the case as run, and what was planned from it |
//! | attachment | `files/KEY` | a file that the case names with this key |
//! | channel | `control` | an [`Event`] a message, bincode 2 (standard configuration) |
//! | channel | `field/ROLE/NAME`, ... | a sample a message, under the name of its service: schema [`FIELD_SCHEMA`] |
//! | channel | `state/ROLE` | a participant's state as it saved it; of use to that participant alone |
//!
//! Messages stand in the order in which they were exchanged; `log_time` counts nanoseconds from the
//! start of the recording and rises strictly. There is no calendar time, no path, no name of a
//! machine or person in a recording.
//!
//! **Files from elsewhere.** Names obey the rule of names on the wire, grids are checked like those of
//! a participant, and what a reader has to hold is limited in sum; a file that breaks this is damaged.
//!
//! **Cut files.** A recording is written chunk by chunk, each in one go. [`Recording`] reads from
//! front to back and needs neither index nor footer: a file that was cut, wherever, reads up to the
//! cut ([`Recording::end`] tells which it was).

mod admit;
mod event;
mod held;
mod label;
mod reader;
mod writer;

pub use event::{Event, Iteration, read_topics};
pub use label::{LABEL_BYTES, read_label, write_label};
pub use reader::{End, Entry, Item, Recording};
pub use writer::{Compression, RecordingWriter};

use crate::description::Description;
use serde::{Deserialize, Serialize};

/// Version of what stands inside the container. Raised whenever a layout below changes.
pub const FORMAT: u32 = 1;
/// Profile in the container's header.
pub const PROFILE: &str = "cosim";
/// Name of the channel of [`Event`]s.
pub const CONTROL: &str = "control";
/// Begins the name of a channel of states.
pub const STATE: &str = "state/";
/// Begins the name of an attached file of the case.
pub const FILES: &str = "files/";
/// Longest message [byte]: samples up to 128 million doubles.
pub const LONGEST_RECORD: usize = 1 << 30;

/// Schema of the channels of fields, as foreign tools find it in the file.
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

/// What a recording is of.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Head {
    /// [`FORMAT`] of the writer.
    pub format: u32,
    /// [`crate::PROTOCOL_VERSION`] of the run.
    pub protocol: u32,
    /// Name and version of the program that wrote it.
    pub writer: String,
    /// Short name of the case.
    pub case: String,
    /// Coupling scheme.
    pub scheme: String,
    /// How the next iterate was chosen.
    pub acceleration: String,
    /// The participants; [`Event`]s name them by their index here.
    pub participants: Vec<Participant>,
    /// Keys of the case that name a file, with the name of the attachment that holds it.
    pub files: Vec<CaseFile>,
}

/// A participant of a recorded run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Participant {
    /// Role it played.
    pub role: String,
    /// File name of its program.
    pub program: String,
    /// What it said of itself.
    pub description: Description,
}

/// A file that the case names.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct CaseFile {
    /// Dotted key of the case.
    pub key: String,
    /// Name of the attachment; in recorded configurations it stands in the place of the path.
    pub attachment: String,
}

/// What is wrong with a recording.
#[derive(Debug, thiserror::Error)]
pub enum RecordingError {
    /// It cannot be read or written.
    #[error("{0}")]
    Io(#[from] std::io::Error),
    /// The container is not one, or is damaged.
    #[error("the recording is damaged: {0}")]
    Container(mcap::McapError),
    /// What stands in the container does not fit the format.
    #[error("the recording is damaged: {0}")]
    Content(String),
    /// Written by a program that is too new or too old.
    #[error("the recording has format {found}; this program reads format {FORMAT}")]
    Format {
        /// Its format.
        found: u32,
    },
    /// Cut before the head was complete.
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
