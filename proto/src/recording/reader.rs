//! Reading a recording from front to back, or from a chunk on.

use super::chunks::Chunk;
use super::held::MemoryBudget;
use super::zstd::Zstd;
use super::{
    CONTROL, Event, FORMAT, Head, LONGEST_RECORD, RecordingError, STATE, admit, format_1,
    read_label,
};
use crate::binary;
use crate::message::FieldHeader;
use mcap::records::{Record, op};
use mcap::sans_io::linear_reader::{LinearReadEvent, LinearReader, LinearReaderOptions};
use std::collections::HashMap;
use std::io::{Read, Seek, SeekFrom};

/// Maximum number of bytes requested from the file at a time. A length claimed in the file is
/// allocated only as far as its bytes exist.
const READ: usize = 1 << 20;

/// A recording being read; memory is bounded, see [`MemoryBudget`].
pub struct Recording<R: Read> {
    source: Source<R>,
    head: Head,
    attachments: Vec<(String, Vec<u8>)>,
    channels: HashMap<u16, String>,
    values: Vec<f64>,
    /// First record after the head, returned before all others.
    held: Option<(u8, Vec<u8>)>,
}

/// A message of a recording.
#[derive(Debug)]
pub struct Entry<'a> {
    /// Time since the start of the recording [ns].
    pub nanoseconds: u64,
    /// Content of the message.
    pub item: Item<'a>,
}

/// Content of a message.
#[derive(Debug)]
pub enum Item<'a> {
    /// A command, a reply, or a decision of the coordinator.
    Event(Event),
    /// A sample of a field.
    Sample {
        /// Service of the sample.
        service: &'a str,
        /// Header of the sample.
        header: FieldHeader,
        /// `components * points` values, component-major.
        values: &'a [f64],
    },
    /// Saved state of a participant.
    State {
        /// Role of the participant.
        role: &'a str,
        /// State as written by the participant.
        bytes: &'a [u8],
    },
}

/// Completeness of a recording.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum End {
    /// The recording has not been read to its end.
    Unknown,
    /// The recording has an index and a footer.
    Complete,
    /// The file is truncated after this many bytes.
    Cut(u64),
}

impl<R: Read> Recording<R> {
    /// Reads the head and all attachments.
    ///
    /// # Errors
    /// Fails if the file is not a recording, has another format, is damaged, or is truncated before
    /// its first message.
    pub fn open(file: R) -> Result<Self, RecordingError> {
        let mut source = Source::new(file, At::Start);
        let mut attachments = Vec::new();
        let mut held = None;
        while let Some((opcode, bytes)) = source.next()? {
            if opcode == op::ATTACHMENT && !attachment_is_whole(bytes) {
                return damaged("an attachment is shorter than its length".to_owned());
            }
            match mcap::parse_record(opcode, bytes)? {
                Record::Header(header) if header.profile != super::PROFILE => {
                    let profile = header.profile;
                    return damaged(format!("an MCAP file of profile {profile:?}, not of a run"));
                }
                Record::Attachment { header, data, .. } => {
                    admit::attachment(&header.name).or_else(damaged)?;
                    attachments.push((header.name, data.into_owned()));
                }
                Record::Header(_) => {}
                _ => {
                    held = Some((opcode, bytes.to_vec()));
                    break;
                }
            }
        }
        let head = attachments.iter().find(|(name, _)| name == "head.json");
        let (_, head) = head.ok_or(RecordingError::NoHead)?;
        let format: Format = serde_json::from_slice(head).map_err(content)?;
        if !(1..=FORMAT).contains(&format.format) {
            return Err(RecordingError::Format { found: format.format });
        }
        let head: Head = serde_json::from_slice(head).map_err(content)?;
        admit::head(&head).or_else(damaged)?;
        let (channels, values) = (HashMap::new(), Vec::new());
        Ok(Self { source, head, attachments, channels, values, held })
    }

    /// Returns the head of the recording.
    #[must_use]
    pub fn head(&self) -> &Head {
        &self.head
    }

    /// Returns an attached text or file by name.
    #[must_use]
    pub fn attachment(&self, name: &str) -> Option<&[u8]> {
        self.attachments.iter().find(|(found, _)| found == name).map(|(_, data)| data.as_slice())
    }

    /// Returns the completeness; known after [`Recording::read`] has returned `None`.
    #[must_use]
    pub fn end(&self) -> End {
        self.source.end
    }

    /// Returns the number of bytes read from the file so far.
    #[must_use]
    pub fn bytes_read(&self) -> u64 {
        self.source.bytes_read
    }

    /// Reads the next message; returns `None` at the end or where the file is truncated.
    ///
    /// # Errors
    /// Fails if the file cannot be read or is damaged.
    pub fn read(&mut self) -> Result<Option<Entry<'_>>, RecordingError> {
        let Self { source, head, channels, values, held, .. } = self;
        if let Some((opcode, bytes)) = held.take()
            && let Record::Channel(channel) = mcap::parse_record(opcode, &bytes)?
        {
            open_channel(channels, channel.id, channel.topic)?;
        }
        loop {
            let Some((opcode, bytes)) = source.next()? else { return Ok(None) };
            match opcode {
                op::CHANNEL => {
                    if let Record::Channel(channel) = mcap::parse_record(opcode, bytes)? {
                        open_channel(channels, channel.id, channel.topic)?;
                    }
                }
                op::MESSAGE => break,
                _ => {}
            }
        }
        let Source { record, held, bytes_read, .. } = source;
        let Record::Message { header, data } = mcap::parse_record(op::MESSAGE, record)? else {
            return Err(RecordingError::Content("an invalid message".to_owned()));
        };
        let Some(channel) = channels.get(&header.channel_id) else {
            let what = format!("a message on channel {}, which is unknown", header.channel_id);
            return Err(RecordingError::Content(what));
        };
        // The record lies in the source's own buffer, so borrowed data stays borrowed.
        let std::borrow::Cow::Borrowed(data) = data else {
            return Err(RecordingError::Content("an incomplete message".to_owned()));
        };
        let item = match channel.strip_prefix(STATE) {
            Some(role) => Item::State { role, bytes: data },
            None if channel == CONTROL => {
                let event = event(data, head)?;
                held.text(event.text_length(), *bytes_read).or_else(damaged)?;
                Item::Event(event)
            }
            None => sample(channel, data, values)?,
        };
        Ok(Some(Entry { nanoseconds: header.log_time, item }))
    }
}

impl<R: Read + Seek> Recording<R> {
    /// Goes to the first message of a chunk, which [`Recording::read`] returns next. Channels named
    /// before stay known.
    ///
    /// # Errors
    /// Fails if the file cannot be positioned.
    pub fn seek(&mut self, chunk: Chunk) -> Result<(), RecordingError> {
        self.source.seek(chunk)
    }
}

fn damaged<T>(what: String) -> Result<T, RecordingError> {
    Err(RecordingError::Content(what))
}

/// Registers a channel; a channel must keep its first name.
fn open_channel(
    channels: &mut HashMap<u16, String>,
    id: u16,
    name: String,
) -> Result<(), RecordingError> {
    admit::channel(&name).or_else(damaged)?;
    match channels.get(&id).filter(|known| **known != name) {
        Some(known) => damaged(format!("channel {id} is called {known} and {name}")),
        None => {
            channels.insert(id, name);
            Ok(())
        }
    }
}

/// Returns true if an attachment has all its parts: two times, two texts with lengths, a length,
/// the content and a checksum.
fn attachment_is_whole(bytes: &[u8]) -> bool {
    let text = |rest: &'_ [u8]| -> Option<usize> {
        let (length, rest) = rest.split_first_chunk()?;
        let length = u32::from_le_bytes(*length) as usize;
        rest.get(length..).map(<[u8]>::len)
    };
    let after = |left: usize| &bytes[bytes.len() - left..];
    let times = bytes.get(16..).map(<[u8]>::len);
    let texts = times.and_then(|left| text(after(left))).and_then(|left| text(after(left)));
    texts.is_some_and(|left| left >= size_of::<u64>() + size_of::<u32>())
}

/// Part of the head that is common to all formats.
#[derive(serde::Deserialize)]
struct Format {
    format: u32,
}

fn content(error: serde_json::Error) -> RecordingError {
    RecordingError::Content(format!("head.json: {error}"))
}

fn event(bytes: &[u8], head: &Head) -> Result<Event, RecordingError> {
    let read = match head.format {
        1 => format_1::read(bytes),
        _ => binary::read(bytes),
    };
    let mut event =
        read.map_err(|error| RecordingError::Content(format!("a control event: {error}")))?;
    if let Event::Command { participant, .. } | Event::Reply { participant, .. } = &event
        && usize::from(*participant) >= head.participants.len()
    {
        let what = format!("an event of participant {participant}, which is unknown");
        return Err(RecordingError::Content(what));
    }
    match &mut event {
        Event::Command { command, .. } => translate(&mut command.protocol),
        Event::Reply { reply, .. } => translate(&mut reply.protocol),
        Event::Iteration(_) | Event::Repeated { .. } | Event::Ended { .. } => {}
    }
    Ok(event)
}

/// Raises the version in a message of an earlier one, so that participants of this version take it.
/// The head of the recording keeps the version of the run.
fn translate(protocol: &mut u32) {
    *protocol = (*protocol).max(crate::PROTOCOL_VERSION);
}

fn sample<'a>(
    service: &'a str,
    bytes: &[u8],
    values: &'a mut Vec<f64>,
) -> Result<Item<'a>, RecordingError> {
    let wrong = |what: &str| Err(RecordingError::Content(format!("a sample of {service} {what}")));
    let Some((mut header, bytes)) = read_label(bytes) else { return wrong("without a label") };
    translate(&mut header.protocol);
    admit::label(service, &header)
        .or_else(|what| damaged(format!("a sample of {service} has {what}")))?;
    let (doubles, rest) = bytes.as_chunks();
    let count = header.points.checked_mul(u64::from(header.components));
    if !rest.is_empty() || count != Some(doubles.len() as u64) {
        return wrong("whose length is not that of its label");
    }
    values.clear();
    values.extend(doubles.iter().map(|bytes| f64::from_le_bytes(*bytes)));
    Ok(Item::Sample { service, header, values })
}

/// Records of the container in sequence, with chunks decompressed.
struct Source<R: Read> {
    file: R,
    reader: LinearReader,
    record: Vec<u8>,
    bytes_read: u64,
    held: MemoryBudget,
    end: End,
}

/// Place of a file where reading begins.
#[derive(Clone, Copy, PartialEq)]
enum At {
    Start,
    Chunk,
}

/// Returns a reader of the container from this place on.
fn reader(at: At) -> LinearReader {
    let options = LinearReaderOptions::default()
        .with_skip_start_magic(at == At::Chunk)
        .with_skip_end_magic(true)
        .with_validate_chunk_crcs(true)
        .with_record_length_limit(LONGEST_RECORD + 64);
    let mut reader = LinearReader::new_with_options(options);
    reader.add_decompressor(Zstd::new()).expect("the decompressor has a name");
    reader
}

impl<R: Read + Seek> Source<R> {
    fn seek(&mut self, chunk: Chunk) -> Result<(), RecordingError> {
        self.file.seek(SeekFrom::Start(chunk.position))?;
        self.reader = reader(At::Chunk);
        self.end = End::Unknown;
        Ok(())
    }
}

impl<R: Read> Source<R> {
    fn new(file: R, at: At) -> Self {
        Self {
            file,
            reader: reader(at),
            record: Vec::new(),
            bytes_read: 0,
            held: MemoryBudget::default(),
            end: End::Unknown,
        }
    }

    /// Returns the next record's opcode and bytes; `None` at the end or where the file is
    /// truncated.
    fn next(&mut self) -> Result<Option<(u8, &[u8])>, RecordingError> {
        if self.end != End::Unknown {
            return Ok(None);
        }
        loop {
            match self.reader.next_event() {
                None => break self.end = End::Cut(self.bytes_read),
                Some(Err(mcap::McapError::UnexpectedEof)) => {
                    break self.end = End::Cut(self.bytes_read);
                }
                Some(Err(error)) => return Err(error.into()),
                Some(Ok(LinearReadEvent::ReadRequest(wanted))) => {
                    let space = self.reader.insert(wanted.clamp(1, READ));
                    let count = read(&mut self.file, space)?;
                    self.reader.notify_read(count);
                    self.bytes_read += count as u64;
                }
                Some(Ok(LinearReadEvent::Record { opcode: op::FOOTER, .. })) => {
                    break self.end = End::Complete;
                }
                Some(Ok(LinearReadEvent::Record { opcode, data })) => {
                    self.held.record(opcode, data, self.bytes_read).or_else(damaged)?;
                    self.record.clear();
                    self.record.extend_from_slice(data);
                    return Ok(Some((opcode, &self.record)));
                }
            }
        }
        Ok(None)
    }
}

/// Reads available bytes, up to the length of the buffer; returns 0 at the end of the file.
fn read(file: &mut impl Read, into: &mut [u8]) -> Result<usize, RecordingError> {
    loop {
        match file.read(into) {
            Err(error) if error.kind() == std::io::ErrorKind::Interrupted => {}
            outcome => return Ok(outcome?),
        }
    }
}
