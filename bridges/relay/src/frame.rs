//! Messages between client and server, and their encoding.
//!
//! A message consists of the number of its kind, an entry of fixed layout, and a variable number of
//! bytes. Every message is treated as untrusted.

use crate::pack::Packing;
use contract::message::{Command, FieldHeader, ProgressReport, Reply};
use zerocopy::{Immutable, IntoBytes, KnownLayout, TryFromBytes};

/// Message.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Frame<'a> {
    /// To the server: a piece of the file named by the case under `key`; `ending` is the file
    /// extension.
    File { key: &'a str, ending: &'a str, last: bool, bytes: &'a [u8] },
    /// To the server: start the program as a participant, with this packing of values.
    Join { packing: Packing },
    /// To the client: the participant has joined; its description as JSON.
    Joined { description: &'a [u8] },
    /// To the server: a command, with all paths removed.
    Command(Command, &'a [u8]),
    /// To the client: the reply to a command.
    Reply(Reply, &'a [u8]),
    /// Sample of the topic with this number, counted separately for inputs and outputs.
    Sample { topic: u16, header: FieldHeader, packing: Packing, values: u64, bytes: &'a [u8] },
    /// Piece of a state (part 0) or of a saved output (parts from 1).
    State { part: u16, last: bool, bytes: &'a [u8] },
    /// To the client: the run has ended, with exit code and reason.
    Ended { code: u8, words: &'a str },
    /// Sign of life of the sender.
    Alive,
    /// To the client: heartbeat of the participant.
    Beat,
    /// To the client: progress of the participant.
    Progress(ProgressReport),
    /// The sender closes the connection in order.
    Bye,
}

/// Invalid message.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the other end sent an invalid message")]
pub(crate) struct Malformed;

/// Lengths of key and extension, which follow the entry.
#[derive(Immutable, IntoBytes, KnownLayout, TryFromBytes)]
#[repr(C, packed)]
struct FileEntry {
    key: u16,
    ending: u8,
    last: bool,
}

#[derive(Immutable, IntoBytes, KnownLayout, TryFromBytes)]
#[repr(C, packed)]
struct SampleEntry {
    header: FieldHeader,
    values: u64,
    topic: u16,
    packing: Packing,
}

#[derive(Immutable, IntoBytes, KnownLayout, TryFromBytes)]
#[repr(C, packed)]
struct StateEntry {
    part: u16,
    last: bool,
}

/// Encodes number and entry.
fn head(number: u8, entry: &(impl IntoBytes + Immutable)) -> Vec<u8> {
    [&[number], entry.as_bytes()].concat()
}

/// Decodes an entry; returns it with the remaining bytes.
fn entry<T: TryFromBytes + KnownLayout + Immutable>(bytes: &[u8]) -> Result<(T, &[u8]), Malformed> {
    let (taken, rest) = bytes.split_at_checked(size_of::<T>()).ok_or(Malformed)?;
    T::try_read_from_bytes(taken).map(|entry| (entry, rest)).map_err(|_| Malformed)
}

/// Decodes a text of `length` bytes; returns it with the remaining bytes.
fn text(bytes: &[u8], length: usize) -> Result<(&str, &[u8]), Malformed> {
    let (text, rest) = bytes.split_at_checked(length).ok_or(Malformed)?;
    std::str::from_utf8(text).map(|text| (text, rest)).map_err(|_| Malformed)
}

/// Truncates a text to at most `most` bytes.
fn cut(text: &str, most: usize) -> &str {
    &text[..text.floor_char_boundary(most)]
}

impl<'a> Frame<'a> {
    /// Encodes a message: number and entry, then the variable part.
    pub(crate) fn write(&self) -> (Vec<u8>, &'a [u8]) {
        match *self {
            Self::File { key, ending, last, bytes } => {
                let (key, ending) = (cut(key, u16::MAX.into()), cut(ending, u8::MAX.into()));
                let (of_key, of_ending) = (key.len() as u16, ending.len() as u8);
                let mut head = head(1, &FileEntry { key: of_key, ending: of_ending, last });
                head.extend([key, ending].concat().bytes());
                (head, bytes)
            }
            Self::Join { packing } => (head(2, &packing), &[]),
            Self::Joined { description } => (vec![3], description),
            Self::Command(ref command, body) => (head(4, command), body),
            Self::Reply(ref reply, body) => (head(5, reply), body),
            Self::Sample { topic, header, packing, values, bytes } => {
                (head(6, &SampleEntry { header, values, topic, packing }), bytes)
            }
            Self::State { part, last, bytes } => (head(7, &StateEntry { part, last }), bytes),
            Self::Ended { code, words } => (head(8, &code), words.as_bytes()),
            Self::Alive => (vec![9], &[]),
            Self::Beat => (vec![10], &[]),
            Self::Progress(ref report) => (head(11, report), &[]),
            Self::Bye => (vec![12], &[]),
        }
    }

    /// Decodes a message.
    pub(crate) fn read(bytes: &'a [u8]) -> Result<Self, Malformed> {
        let (number, rest) = bytes.split_first().ok_or(Malformed)?;
        let whole = |frame: Self, rest: &[u8]| rest.is_empty().then_some(frame).ok_or(Malformed);
        match number {
            1 => {
                let (FileEntry { key, ending, last }, rest) = entry(rest)?;
                let (key, rest) = text(rest, key.into())?;
                let (ending, bytes) = text(rest, ending.into())?;
                Ok(Self::File { key, ending, last, bytes })
            }
            2 => entry(rest).and_then(|(packing, rest)| whole(Self::Join { packing }, rest)),
            3 => Ok(Self::Joined { description: rest }),
            4 => entry(rest).map(|(command, body)| Self::Command(command, body)),
            5 => entry(rest).map(|(reply, body)| Self::Reply(reply, body)),
            6 => {
                let (SampleEntry { header, values, topic, packing }, bytes) = entry(rest)?;
                Ok(Self::Sample { topic, header, packing, values, bytes })
            }
            7 => {
                let (StateEntry { part, last }, bytes) = entry(rest)?;
                Ok(Self::State { part, last, bytes })
            }
            8 => {
                let (code, words) = entry(rest)?;
                let (words, _) = text(words, words.len())?;
                Ok(Self::Ended { code, words })
            }
            9 => whole(Self::Alive, rest),
            10 => whole(Self::Beat, rest),
            11 => entry(rest).and_then(|(report, rest)| whole(Self::Progress(report), rest)),
            12 => whole(Self::Bye, rest),
            _ => Err(Malformed),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use contract::message::{CommandKind, Label};
    use proptest::prelude::*;

    fn whole(frame: &Frame<'_>) -> Vec<u8> {
        let (head, rest) = frame.write();
        [&head, rest].concat()
    }

    fn examples() -> Vec<Frame<'static>> {
        let expected = std::array::from_fn(|n| n as u64);
        let mut command = Command {
            sequence: 3,
            window: 4,
            iteration: 5,
            expected,
            ..Command::new(CommandKind::Solve)
        };
        (command.start, command.end, command.flags) = (0.25, 0.5, 3);
        let reply = Reply {
            work: 7,
            substeps: 8,
            inner_iterations: 9,
            received_power: -1.5,
            model_seconds: 0.1,
            wanted_window: 2.0,
            present: 3,
            ..Reply::default()
        };
        let header = FieldHeader {
            components: 2,
            points: 3,
            grid_revision: 4,
            window: 5,
            iteration: 6,
            start: 7.0,
            end: 8.0,
            sequence: 9,
            name: Label::new("x"),
            unit: Label::new("K"),
            producer: Label::new("thermal"),
            grid: Label::new("g"),
            ..FieldHeader::default()
        };
        let report =
            ProgressReport { sequence: 1, done: 2, of: 3, what: Label::new("factorising") };
        vec![
            Frame::File { key: "bodies.rail.profile", ending: "csv", last: true, bytes: b"1,2" },
            Frame::Join { packing: Packing::Lz4 },
            Frame::Joined { description: b"{}" },
            Frame::Command(command, b"body"),
            Frame::Reply(reply, b"body"),
            Frame::Sample { topic: 2, header, packing: Packing::Lz4, values: 6, bytes: b"packed" },
            Frame::State { part: 1, last: false, bytes: b"state" },
            Frame::Ended { code: 9, words: "it is over" },
            Frame::Alive,
            Frame::Beat,
            Frame::Progress(report),
            Frame::Bye,
        ]
    }

    #[test]
    fn every_message_reads_back_and_none_that_is_cut_within_its_entries() {
        for frame in examples() {
            let (head, rest) = frame.write();
            assert_eq!(Frame::read(&[&head, rest].concat()), Ok(frame.clone()));
            for cut in 0..head.len() {
                assert_eq!(Frame::read(&head[..cut]), Err(Malformed), "{frame:?} cut at {cut}");
            }
        }
    }

    proptest! {
        #![proptest_config(crate::fuzz_config())]

        #[test]
        fn no_bytes_are_more_than_refused(bytes in proptest::collection::vec(any::<u8>(), 0..300)) {
            if let Ok(frame) = Frame::read(&bytes) {
                // NaN differs from itself, so that the bytes are compared.
                prop_assert_eq!(whole(&frame), bytes);
            }
        }

        #[test]
        fn a_changed_message_is_another_or_none(which in 0..examples().len(), at in any::<prop::sample::Index>(), to in any::<u8>()) {
            let mut bytes = whole(&examples()[which]);
            let at = at.index(bytes.len());
            bytes[at] = to;
            if let Ok(frame) = Frame::read(&bytes) {
                prop_assert_eq!(whole(&frame), bytes);
            }
        }
    }
}
