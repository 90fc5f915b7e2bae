//! Writer of recordings.

use super::{
    CONTROL, Event, FIELD_SCHEMA, FILES, Head, LONGEST_RECORD, PROFILE, RecordingError, STATE,
    write_label,
};
use crate::binary;
use crate::message::FieldHeader;
use mcap::records::MessageHeader;
use serde::{Deserialize, Serialize};
use std::borrow::Cow;
use std::collections::{BTreeMap, HashMap};
use std::io::{Seek, Write};
use std::time::{Duration, Instant};

/// Length at which a chunk is written [byte].
const CHUNK: u64 = 4 << 20;
/// Longest time that messages stay in memory while more are written.
const UNWRITTEN: Duration = Duration::from_millis(100);

/// Compression of chunks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Compression {
    /// Uncompressed, as fast as the disk.
    #[default]
    None,
    /// LZ4: less than half the size, if many values are zero.
    Lz4,
}

/// A recording being written. [`RecordingWriter::finish`] adds index and footer; otherwise the file
/// is readable up to its last chunk.
pub struct RecordingWriter<W: Write + Seek> {
    file: mcap::Writer<W>,
    control: u16,
    field_schema: u16,
    channels: HashMap<String, (u16, u32)>,
    message: Vec<u8>,
    begun: Instant,
    flushed: Instant,
    time: u64,
    bytes: u64,
}

impl<W: Write + Seek> RecordingWriter<W> {
    /// Begins a recording with its head, followed by texts and files by name (`case.toml`,
    /// `plan.txt`, `files/KEY`).
    ///
    /// # Errors
    /// Fails if the file cannot be written.
    pub fn create(
        out: W,
        compression: Compression,
        head: &Head,
        attachments: &[(String, Vec<u8>)],
    ) -> Result<Self, RecordingError> {
        let mut file = options(compression).create(out)?;
        let head = serde_json::to_vec_pretty(head).expect("a head is plain data");
        attach(&mut file, "head.json", "application/json", &head)?;
        for (name, content) in attachments {
            let kind =
                if name.starts_with(FILES) { "application/octet-stream" } else { "text/plain" };
            attach(&mut file, name, kind, content)?;
        }
        let events = file.add_schema("cosim.Event.v1", "bincode2", b"proto::recording::Event")?;
        let field_schema =
            file.add_schema("cosim.Field.v1", "text/plain", FIELD_SCHEMA.as_bytes())?;
        let control = file.add_channel(events, CONTROL, "bincode2", &BTreeMap::new())?;
        file.flush()?;
        let now = Instant::now();
        Ok(Self {
            file,
            control,
            field_schema,
            channels: HashMap::new(),
            message: Vec::new(),
            begun: now,
            flushed: now,
            time: 0,
            bytes: 0,
        })
    }

    /// Returns the length of all messages so far, before compression [byte].
    #[must_use]
    pub fn bytes(&self) -> u64 {
        self.bytes
    }

    /// Writes an event.
    ///
    /// # Errors
    /// Fails if the file cannot be written.
    pub fn event(&mut self, event: &Event) -> Result<(), RecordingError> {
        self.message.clear();
        binary::append(&mut self.message, event).map_err(RecordingError::Content)?;
        self.write(self.control, 0)
    }

    /// Writes a sample of this service.
    ///
    /// # Errors
    /// Fails if the file cannot be written, or if the sample is longer than [`LONGEST_RECORD`].
    pub fn sample(
        &mut self,
        service: &str,
        header: &FieldHeader,
        values: &[f64],
    ) -> Result<(), RecordingError> {
        let unit = || BTreeMap::from([("unit".to_owned(), header.unit.as_str().to_owned())]);
        let (channel, count) = self.channel(service, self.field_schema, "f64le", unit)?;
        self.message.clear();
        write_label(&mut self.message, header);
        append_values(&mut self.message, values);
        self.write(channel, count)
    }

    /// Writes a participant's state.
    ///
    /// # Errors
    /// Fails if the file cannot be written, or if the state is longer than [`LONGEST_RECORD`].
    pub fn state(&mut self, role: &str, state: &[u8]) -> Result<(), RecordingError> {
        let name = format!("{STATE}{role}");
        let (channel, count) = self.channel(&name, 0, "bytes", BTreeMap::new)?;
        self.message.clear();
        self.message.extend_from_slice(state);
        self.write(channel, count)?;
        // After a crash, a run restored from this state continues where this recording ends.
        self.flush()
    }

    /// Adds index and footer, and returns the file.
    ///
    /// # Errors
    /// Fails if the file cannot be written.
    pub fn finish(mut self) -> Result<W, RecordingError> {
        self.file.finish()?;
        let mut out = self.file.into_inner();
        out.flush()?;
        Ok(out)
    }

    /// Returns the number of a channel and the number of its messages including the next one.
    fn channel(
        &mut self,
        name: &str,
        schema: u16,
        encoding: &str,
        metadata: impl FnOnce() -> BTreeMap<String, String>,
    ) -> Result<(u16, u32), RecordingError> {
        if let Some((channel, count)) = self.channels.get_mut(name) {
            *count = count.wrapping_add(1);
            return Ok((*channel, *count));
        }
        let channel = self.file.add_channel(schema, name, encoding, &metadata())?;
        self.channels.insert(name.to_owned(), (channel, 1));
        Ok((channel, 1))
    }

    fn write(&mut self, channel_id: u16, sequence: u32) -> Result<(), RecordingError> {
        if self.message.len() > LONGEST_RECORD {
            let length = self.message.len();
            return Err(RecordingError::Content(format!("a message of {length} bytes")));
        }
        let now = u64::try_from(self.begun.elapsed().as_nanos()).unwrap_or(u64::MAX);
        self.time = now.max(self.time + 1);
        let (log_time, publish_time) = (self.time, self.time);
        let header = MessageHeader { channel_id, sequence, log_time, publish_time };
        self.file.write_to_known_channel(&header, &self.message)?;
        self.bytes += self.message.len() as u64;
        if self.flushed.elapsed() >= UNWRITTEN {
            self.flush()?;
        }
        Ok(())
    }

    /// Writes all messages in memory to the file.
    ///
    /// # Errors
    /// Fails if the file cannot be written.
    pub fn flush(&mut self) -> Result<(), RecordingError> {
        self.flushed = Instant::now();
        Ok(self.file.flush()?)
    }
}

fn options(compression: Compression) -> mcap::WriteOptions {
    let compression = match compression {
        Compression::None => None,
        Compression::Lz4 => Some(mcap::Compression::Lz4),
    };
    mcap::WriteOptions::new()
        .compression(compression)
        .compression_level(1)
        .profile(PROFILE)
        .chunk_size(Some(CHUNK))
        // A chunk is written at once, not in pieces with lengths filled in later.
        .disable_seeking(true)
        // Chunks and attachments have checksums of their own.
        .calculate_data_section_crc(false)
}

fn attach<W: Write + Seek>(
    file: &mut mcap::Writer<W>,
    name: &str,
    media_type: &str,
    content: &[u8],
) -> Result<(), RecordingError> {
    let (name, media_type) = (name.to_owned(), media_type.to_owned());
    let data = Cow::Borrowed(content);
    Ok(file.attach(&mcap::Attachment { log_time: 0, create_time: 0, name, media_type, data })?)
}

/// Appends doubles as little-endian bytes. Works in pieces that fit into the first-level cache, so
/// that memory is read once and written once.
fn append_values(into: &mut Vec<u8>, values: &[f64]) {
    const PIECE: usize = 512;
    let mut bytes = [[0_u8; 8]; PIECE];
    into.reserve(size_of_val(values));
    for values in values.chunks(PIECE) {
        let bytes = &mut bytes[..values.len()];
        for (bytes, value) in bytes.iter_mut().zip(values) {
            *bytes = value.to_le_bytes();
        }
        into.extend_from_slice(bytes.as_flattened());
    }
}
