//! What the two ends say to each other: the bytes of each message.
//!
//! A message is a number, which says what it is, entries of fixed size, little-endian, and bytes that go on to
//! its end. Whatever is received is looked at as if anybody could have sent it.

use crate::pack::Packing;
use contract::message::{Command, FieldHeader, Label, MAX_INPUTS, ProgressReport, Reply};

/// What a program is asked without a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Question {
    Describe,
    Estimate,
    Advise,
}

impl Question {
    const ALL: [Self; 3] = [Self::Describe, Self::Estimate, Self::Advise];

    /// The option by which a program is asked.
    pub(crate) fn option(self) -> &'static str {
        match self {
            Self::Describe => "--describe",
            Self::Estimate => "--estimate",
            Self::Advise => "--advise",
        }
    }
}

/// A message.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Frame<'a> {
    /// To the far end: ask the program, with this on its standard input.
    Ask { question: Question, input: &'a [u8] },
    /// Home: what it has said; or, unless `code` is 0, why it has not.
    Answer { code: u8, said: &'a [u8] },
    /// To the far end: a piece of the file that the case names under this key. `ending` is that of its name.
    File { key: &'a str, ending: &'a str, last: bool, bytes: &'a [u8] },
    /// To the far end: start the program as a participant. Values are packed like this.
    Join { packing: Packing },
    /// Home: it has joined.
    Joined,
    /// To the far end: a command; without paths.
    Command(Command, &'a [u8]),
    /// Home: the reply.
    Reply(Reply, &'a [u8]),
    /// A sample of the topic with this number, one of inputs or one of outputs.
    Sample { topic: u16, header: FieldHeader, packing: Packing, values: u64, bytes: &'a [u8] },
    /// A piece of a state (part 0) or of what was sent last (the parts that follow).
    State { part: u16, last: bool, bytes: &'a [u8] },
    /// Home: it is over, with this exit code, for this reason.
    Ended { code: u8, words: &'a str },
    /// The sender lives.
    Alive,
    /// Home: the participant's heart has beaten.
    Beat,
    /// Home: how far it is.
    Progress(ProgressReport),
    /// The sender leaves, as was to be expected.
    Bye,
}

/// A message that is none.
#[derive(Debug, PartialEq, Eq, thiserror::Error)]
#[error("the other end sends what is no message of the relay")]
pub(crate) struct Malformed;

/// Puts entries one after the other.
#[derive(Default)]
struct Writer(Vec<u8>);

impl Writer {
    fn u8(&mut self, value: u8) {
        self.0.push(value);
    }
    fn u16(&mut self, value: u16) {
        self.0.extend(value.to_le_bytes());
    }
    fn u32(&mut self, value: u32) {
        self.0.extend(value.to_le_bytes());
    }
    fn u64(&mut self, value: u64) {
        self.0.extend(value.to_le_bytes());
    }
    fn f64(&mut self, value: f64) {
        self.u64(value.to_bits());
    }
    fn label<const N: usize>(&mut self, label: &Label<N>) {
        self.0.extend(label.0);
    }
    fn text(&mut self, text: &str) {
        let bytes = &text.as_bytes()[..text.len().min(usize::from(u16::MAX))];
        self.u16(bytes.len() as u16);
        self.0.extend(bytes);
    }
}

/// Takes entries one after the other.
struct Reader<'a>(&'a [u8]);

impl<'a> Reader<'a> {
    fn bytes<const N: usize>(&mut self) -> Result<[u8; N], Malformed> {
        let (first, rest) = self.0.split_first_chunk().ok_or(Malformed)?;
        self.0 = rest;
        Ok(*first)
    }
    fn u8(&mut self) -> Result<u8, Malformed> {
        self.bytes::<1>().map(|[byte]| byte)
    }
    fn flag(&mut self) -> Result<bool, Malformed> {
        match self.u8()? {
            0 => Ok(false),
            1 => Ok(true),
            _ => Err(Malformed),
        }
    }
    fn u16(&mut self) -> Result<u16, Malformed> {
        self.bytes().map(u16::from_le_bytes)
    }
    fn u32(&mut self) -> Result<u32, Malformed> {
        self.bytes().map(u32::from_le_bytes)
    }
    fn u64(&mut self) -> Result<u64, Malformed> {
        self.bytes().map(u64::from_le_bytes)
    }
    fn f64(&mut self) -> Result<f64, Malformed> {
        self.u64().map(f64::from_bits)
    }
    fn label<const N: usize>(&mut self) -> Result<Label<N>, Malformed> {
        self.bytes().map(Label)
    }
    fn text(&mut self) -> Result<&'a str, Malformed> {
        let length = usize::from(self.u16()?);
        let (text, rest) = self.0.split_at_checked(length).ok_or(Malformed)?;
        self.0 = rest;
        std::str::from_utf8(text).map_err(|_| Malformed)
    }
    fn rest(&mut self) -> &'a [u8] {
        std::mem::take(&mut self.0)
    }
    fn packing(&mut self) -> Result<Packing, Malformed> {
        Packing::from_number(self.u8()?).ok_or(Malformed)
    }
}

impl<'a> Frame<'a> {
    /// The bytes of a message: its entries, and those that it goes on with.
    pub(crate) fn write(&self) -> (Vec<u8>, &'a [u8]) {
        let mut w = Writer::default();
        let rest: &'a [u8] = match self {
            Self::Ask { question, input } => {
                w.u8(1);
                w.u8(*question as u8);
                input
            }
            Self::Answer { code, said } => {
                w.u8(2);
                w.u8(*code);
                said
            }
            Self::File { key, ending, last, bytes } => {
                w.u8(3);
                w.text(key);
                w.text(ending);
                w.u8((*last).into());
                bytes
            }
            Self::Join { packing } => {
                w.u8(4);
                w.u8(packing.number());
                &[]
            }
            Self::Joined => {
                w.u8(5);
                &[]
            }
            Self::Command(command, body) => {
                w.u8(6);
                write_command(&mut w, command);
                body
            }
            Self::Reply(reply, body) => {
                w.u8(7);
                write_reply(&mut w, reply);
                body
            }
            Self::Sample { topic, header, packing, values, bytes } => {
                w.u8(8);
                w.u16(*topic);
                write_header(&mut w, header);
                w.u8(packing.number());
                w.u64(*values);
                bytes
            }
            Self::State { part, last, bytes } => {
                w.u8(9);
                w.u16(*part);
                w.u8((*last).into());
                bytes
            }
            Self::Ended { code, words } => {
                w.u8(10);
                w.u8(*code);
                words.as_bytes()
            }
            Self::Alive => {
                w.u8(11);
                &[]
            }
            Self::Beat => {
                w.u8(12);
                &[]
            }
            Self::Progress(ProgressReport { sequence, done, of, what }) => {
                w.u8(13);
                [sequence, done, of].into_iter().for_each(|number| w.u64(*number));
                w.label(what);
                &[]
            }
            Self::Bye => {
                w.u8(14);
                &[]
            }
        };
        (w.0, rest)
    }

    /// Reads a message.
    ///
    /// # Errors
    /// It is none.
    pub(crate) fn read(bytes: &'a [u8]) -> Result<Self, Malformed> {
        let mut r = Reader(bytes);
        let frame = match r.u8()? {
            1 => {
                let question = Question::ALL.get(usize::from(r.u8()?)).ok_or(Malformed)?;
                Self::Ask { question: *question, input: r.rest() }
            }
            2 => Self::Answer { code: r.u8()?, said: r.rest() },
            3 => Self::File { key: r.text()?, ending: r.text()?, last: r.flag()?, bytes: r.rest() },
            4 => Self::Join { packing: r.packing()? },
            5 => Self::Joined,
            6 => Self::Command(read_command(&mut r)?, r.rest()),
            7 => Self::Reply(read_reply(&mut r)?, r.rest()),
            8 => Self::Sample {
                topic: r.u16()?,
                header: read_header(&mut r)?,
                packing: r.packing()?,
                values: r.u64()?,
                bytes: r.rest(),
            },
            9 => Self::State { part: r.u16()?, last: r.flag()?, bytes: r.rest() },
            10 => {
                let code = r.u8()?;
                Self::Ended { code, words: std::str::from_utf8(r.rest()).map_err(|_| Malformed)? }
            }
            11 => Self::Alive,
            12 => Self::Beat,
            13 => {
                let (sequence, done, of, what) = (r.u64()?, r.u64()?, r.u64()?, r.label()?);
                Self::Progress(ProgressReport { sequence, done, of, what })
            }
            14 => Self::Bye,
            _ => return Err(Malformed),
        };
        if r.0.is_empty() { Ok(frame) } else { Err(Malformed) }
    }
}

fn write_command(w: &mut Writer, c: &Command) {
    w.u32(c.protocol);
    w.u32(c.kind);
    w.u64(c.sequence);
    w.u64(c.window);
    w.u32(c.iteration);
    w.u32(c.flags);
    w.f64(c.start);
    w.f64(c.end);
    c.expected.iter().for_each(|number| w.u64(*number));
}

fn read_command(r: &mut Reader<'_>) -> Result<Command, Malformed> {
    let mut command = Command {
        protocol: r.u32()?,
        kind: r.u32()?,
        sequence: r.u64()?,
        window: r.u64()?,
        iteration: r.u32()?,
        flags: r.u32()?,
        start: r.f64()?,
        end: r.f64()?,
        expected: [0; MAX_INPUTS],
    };
    for number in &mut command.expected {
        *number = r.u64()?;
    }
    Ok(command)
}

fn write_reply(w: &mut Writer, reply: &Reply) {
    w.u32(reply.protocol);
    w.u32(reply.status);
    w.u64(reply.sequence);
    w.u64(reply.work);
    w.u32(reply.substeps);
    w.u32(reply.inner_iterations);
    w.f64(reply.heat_received);
    w.f64(reply.model_seconds);
    w.f64(reply.wanted_window);
}

fn read_reply(r: &mut Reader<'_>) -> Result<Reply, Malformed> {
    Ok(Reply {
        protocol: r.u32()?,
        status: r.u32()?,
        sequence: r.u64()?,
        work: r.u64()?,
        substeps: r.u32()?,
        inner_iterations: r.u32()?,
        heat_received: r.f64()?,
        model_seconds: r.f64()?,
        wanted_window: r.f64()?,
    })
}

fn write_header(w: &mut Writer, h: &FieldHeader) {
    w.u32(h.protocol);
    w.u32(h.components);
    w.u64(h.points);
    w.u64(h.grid_revision);
    w.u64(h.window);
    w.u32(h.iteration);
    w.u32(h.reserved);
    w.f64(h.start);
    w.f64(h.end);
    w.u64(h.sequence);
    w.label(&h.name);
    w.label(&h.unit);
    w.label(&h.producer);
    w.label(&h.grid);
}

fn read_header(r: &mut Reader<'_>) -> Result<FieldHeader, Malformed> {
    Ok(FieldHeader {
        protocol: r.u32()?,
        components: r.u32()?,
        points: r.u64()?,
        grid_revision: r.u64()?,
        window: r.u64()?,
        iteration: r.u32()?,
        reserved: r.u32()?,
        start: r.f64()?,
        end: r.f64()?,
        sequence: r.u64()?,
        name: r.label()?,
        unit: r.label()?,
        producer: r.label()?,
        grid: r.label()?,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use contract::message::CommandKind;
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
            heat_received: -1.5,
            model_seconds: 0.1,
            wanted_window: 2.0,
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
            Frame::Ask { question: Question::Advise, input: b"{}" },
            Frame::Answer { code: 0, said: b"{}" },
            Frame::File { key: "bodies.rail.profile", ending: "csv", last: true, bytes: b"1,2" },
            Frame::Join { packing: Packing::Zstd },
            Frame::Joined,
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

    #[test]
    fn headers_have_the_bytes_of_the_contract() {
        let sizes = examples().into_iter().map(|frame| frame.write().0.len());
        let sizes: Vec<usize> = sizes.collect();
        let of = |size: fn() -> usize| 1 + size();
        assert_eq!(sizes[5], of(size_of::<Command>));
        assert_eq!(sizes[6], of(size_of::<Reply>));
        assert_eq!(sizes[7], of(size_of::<FieldHeader>) + 2 + 1 + 8);
        assert_eq!(sizes[12], of(size_of::<ProgressReport>));
    }

    proptest! {
        #![proptest_config(crate::fuzz_config())]

        #[test]
        fn no_bytes_are_more_than_refused(bytes in proptest::collection::vec(any::<u8>(), 0..300)) {
            if let Ok(frame) = Frame::read(&bytes) {
                // NaNs are not equal to themselves; their bytes are.
                prop_assert_eq!(whole(&frame), bytes);
            }
        }

        #[test]
        fn a_changed_message_is_another_or_none(which in 0..14_usize, at in any::<prop::sample::Index>(), to in any::<u8>()) {
            let mut bytes = whole(&examples()[which]);
            let at = at.index(bytes.len());
            bytes[at] = to;
            if let Ok(frame) = Frame::read(&bytes) {
                prop_assert_eq!(whole(&frame), bytes);
            }
        }
    }
}
