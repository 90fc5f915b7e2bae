use super::*;
use crate::binary;
use crate::message::{Command, CommandKind, FieldHeader, Label, Reply, Topics};
use mcap::records::op;
use proptest::prelude::*;
use std::io::Cursor;

fn head() -> Head {
    let description = Description {
        protocol: crate::PROTOCOL_VERSION,
        name: "thermal-solver".to_owned(),
        version: "1".to_owned(),
        role: "thermal".to_owned(),
        standalone: false,
        estimates: false,
        advises: false,
        reusable: true,
        build: None,
        models: Vec::new(),
        effects: Vec::new(),
        keys: Vec::new(),
        fields: Vec::new(),
        figures: Vec::new(),
        diagrams: Vec::new(),
        renamed: Vec::new(),
    };
    let participant = Participant {
        role: "thermal".to_owned(),
        program: "thermal-solver".to_owned(),
        description,
    };
    Head {
        format: FORMAT,
        protocol: crate::PROTOCOL_VERSION,
        writer: "test".to_owned(),
        case: "small".to_owned(),
        scheme: "serial-implicit".to_owned(),
        acceleration: "iqn-ils".to_owned(),
        participants: vec![participant],
        files: Vec::new(),
    }
}

fn header(window: u64, points: u64) -> FieldHeader {
    FieldHeader {
        protocol: crate::PROTOCOL_VERSION,
        components: 2,
        points,
        window,
        iteration: 1,
        end: 0.5,
        sequence: window + 1,
        name: Label::new("slip_velocity"),
        unit: Label::new("m/s"),
        producer: Label::new("mech"),
        grid: Label::new("contact"),
        ..FieldHeader::default()
    }
}

fn value(window: u64, index: u64) -> f64 {
    1.0 / (1.0 + window as f64) - index as f64
}

/// Four windows with a command, a sample, a reply, a state and an iteration each; one chunk per
/// window.
fn recorded(compression: Compression) -> Vec<u8> {
    let files = [("case.toml".to_owned(), b"[case]".to_vec())];
    let out = Cursor::new(Vec::new());
    let mut writer = RecordingWriter::create(out, compression, &head(), &files).unwrap();
    for window in 0..4 {
        let command = Command { window, ..Command::new(CommandKind::Solve) };
        let body = vec![7; window as usize];
        writer.event(&Event::Command { participant: 0, command, body }).unwrap();
        let values: Vec<f64> = (0..12).map(|index| value(window, index)).collect();
        writer.sample("field/mech/slip_velocity", &header(window, 6), &values).unwrap();
        let reply = Reply { sequence: window, ..Reply::default() };
        writer.event(&Event::Reply { participant: 0, reply, body: Vec::new() }).unwrap();
        writer.state("thermal", &[window as u8; 5]).unwrap();
        let iteration = Iteration { window, residual: Some(0.5), ..Iteration::default() };
        writer.event(&Event::Iteration(iteration)).unwrap();
        writer.flush().unwrap();
    }
    writer.event(&Event::Ended { error: None }).unwrap();
    writer.finish().unwrap().into_inner()
}

/// Reads to the end and checks every value; returns the number of messages and the completeness.
fn read(bytes: &[u8]) -> Result<(usize, End), RecordingError> {
    let mut recording = Recording::open(bytes)?;
    let case = recording.attachment("case.toml").map(<[u8]>::to_vec);
    let (mut count, mut time) = (0, 0);
    while let Some(entry) = recording.read()? {
        assert!(entry.nanoseconds > time, "time stands still");
        time = entry.nanoseconds;
        let window = count as u64 / 5;
        match entry.item {
            Item::Event(Event::Command { command, body, .. }) => {
                assert_eq!((count % 5, command.window), (0, window));
                assert_eq!(body, vec![7; window as usize]);
            }
            Item::Sample { service, header: label, values } => {
                assert_eq!((count % 5, service), (1, "field/mech/slip_velocity"));
                assert_eq!(label, header(window, 6));
                let expected = (0..12).map(|index| value(window, index));
                assert!(values.iter().copied().eq(expected));
            }
            Item::Event(Event::Reply { reply, .. }) => {
                assert!(reply.sequence == window && reply.received_power().is_none());
            }
            Item::State { role, bytes } => {
                assert_eq!((count % 5, role, bytes), (3, "thermal", &[window as u8; 5][..]));
            }
            Item::Event(Event::Iteration(iteration)) => assert_eq!(iteration.residual, Some(0.5)),
            Item::Event(_) => assert_eq!(count, 20),
        }
        count += 1;
    }
    // The file may be cut between the head and the other attachments.
    assert!(case.is_some_and(|case| case == b"[case]") || count == 0);
    Ok((count, recording.end()))
}

/// Participants of this version take messages that were recorded by an earlier one.
#[test]
fn messages_of_an_earlier_protocol_have_the_present_one() {
    let out = Cursor::new(Vec::new());
    let mut writer = RecordingWriter::create(out, Compression::None, &head(), &[]).unwrap();
    let command = Command { protocol: 1, ..Command::new(CommandKind::Solve) };
    writer.event(&Event::Command { participant: 0, command, body: Vec::new() }).unwrap();
    let label = FieldHeader { protocol: 1, ..header(0, 6) };
    writer.sample("field/mech/slip_velocity", &label, &[0.0; 12]).unwrap();
    let bytes = writer.finish().unwrap().into_inner();
    let mut recording = Recording::open(&*bytes).unwrap();
    while let Some(entry) = recording.read().unwrap() {
        let protocol = match entry.item {
            Item::Event(Event::Command { command, .. }) => command.protocol,
            Item::Sample { header, .. } => header.protocol,
            other => panic!("not written: {other:?}"),
        };
        assert_eq!(protocol, crate::PROTOCOL_VERSION);
    }
}

#[test]
fn everything_comes_back_to_the_bit() {
    for compression in [Compression::None, Compression::Lz4] {
        assert_eq!(read(&recorded(compression)).unwrap(), (21, End::Complete));
    }
}

/// A truncated file is readable up to the cut: all complete messages if uncompressed, all messages
/// of complete chunks if compressed.
#[test]
fn a_file_cut_at_any_byte_reads_up_to_the_cut() {
    for compression in [Compression::None, Compression::Lz4] {
        let whole = recorded(compression);
        let mut before = None;
        for length in 0..whole.len() {
            match read(&whole[..length]) {
                Err(RecordingError::NoHead) => assert_eq!(before, None, "at {length}"),
                Err(error) => panic!("cut at {length}: {error}"),
                Ok((count, end)) => {
                    assert!(count >= before.unwrap_or(0), "cut at {length}: {count} messages");
                    before = Some(count);
                    let complete = end == End::Complete;
                    assert!(complete || end == End::Cut(length as u64), "cut at {length}");
                    assert!(!complete || count == 21);
                }
            }
        }
        assert_eq!(before, Some(21));
    }
}

/// Damaged values are never accepted as the written ones.
#[test]
fn a_flipped_bit_in_a_chunk_is_noticed() {
    let whole = recorded(Compression::None);
    let text = value(2, 3).to_le_bytes();
    let at = whole.windows(8).position(|bytes| bytes == text).unwrap();
    let mut damaged = whole.clone();
    damaged[at] ^= 1;
    let mut recording = Recording::open(&damaged[..]).unwrap();
    let error = loop {
        match recording.read() {
            Ok(Some(_)) => {}
            Ok(None) => panic!("the damage was not noticed"),
            Err(error) => break error,
        }
    };
    assert!(error.to_string().starts_with("the recording is damaged"), "{error}");
}

#[test]
fn what_is_no_recording_is_reported() {
    let error = |bytes: &[u8]| Recording::open(bytes).err().unwrap().to_string();
    assert!(error(b"[case]\nname = \"x\"\n").contains("damaged"));
    assert!(error(b"").contains("truncated before its header"));
    let foreign = mcap::WriteOptions::new().profile("ros2").create(Cursor::new(Vec::new()));
    let mut foreign = foreign.unwrap();
    foreign.finish().unwrap();
    assert!(error(&foreign.into_inner().into_inner()).contains("profile \"ros2\""));
    let newer = Head { format: FORMAT + 1, ..head() };
    let out = Cursor::new(Vec::new());
    let newer = RecordingWriter::create(out, Compression::None, &newer, &[]).unwrap();
    let newer = newer.finish().unwrap().into_inner();
    let refused = Recording::open(&newer[..]).map(drop);
    assert!(matches!(refused, Err(RecordingError::Format { found }) if found == FORMAT + 1));
}

/// Reads as far as possible; must terminate without a panic.
fn survive(bytes: &[u8]) {
    let Ok(mut recording) = Recording::open(bytes) else { return };
    while let Ok(Some(_)) = recording.read() {}
}

fn cases() -> ProptestConfig {
    let cases = std::env::var("FUZZ_CASES").ok().and_then(|text| text.parse().ok());
    ProptestConfig::with_cases(cases.unwrap_or(400))
}

/// Changes, omits or duplicates pieces of a valid file.
fn edited(whole: &[u8], edits: &[(f64, usize, Vec<u8>)]) -> Vec<u8> {
    let mut bytes = whole.to_vec();
    for (share, length, piece) in edits {
        let start = (share * bytes.len() as f64) as usize;
        let end = (start + length).min(bytes.len());
        bytes.splice(start..end, piece.iter().copied());
    }
    bytes
}

fn edits() -> impl Strategy<Value = Vec<(f64, usize, Vec<u8>)>> {
    let piece = proptest::collection::vec(any::<u8>(), 0..9);
    proptest::collection::vec((0.0..1.0_f64, 0..9_usize, piece), 1..6)
}

proptest! {
    #![proptest_config(cases())]

    #[test]
    fn any_bytes_are_survived(bytes in proptest::collection::vec(any::<u8>(), 0..400)) {
        survive(&bytes);
        survive(&[mcap::MAGIC, &bytes[..]].concat());
    }

    #[test]
    fn any_changed_recording_is_survived(edits in edits(), lz4 in any::<bool>()) {
        static GOOD: std::sync::OnceLock<[Vec<u8>; 2]> = std::sync::OnceLock::new();
        let good = GOOD.get_or_init(|| [recorded(Compression::None), recorded(Compression::Lz4)]);
        survive(&edited(&good[usize::from(lz4)], &edits));
    }

    #[test]
    fn any_control_message_is_survived(bytes in proptest::collection::vec(any::<u8>(), 0..200)) {
        let _ = binary::read::<Event>(&bytes);
        let _ = read_label(&bytes);
        let _ = serde_json::from_slice::<Topics>(&bytes);
    }

    #[test]
    fn any_changed_event_is_survived(edits in edits()) {
        let command = Command::new(CommandKind::Solve);
        let body = b"{\"inputs\":[]}".to_vec();
        let event: Event = Event::Command { participant: 0, command, body };
        let mut bytes = Vec::new();
        binary::append(&mut bytes, &event).unwrap();
        let _ = binary::read::<Event>(&edited(&bytes, &edits));
    }
}

/// Record of the container.
fn record(opcode: u8, body: &[u8]) -> Vec<u8> {
    [&[opcode][..], &(body.len() as u64).to_le_bytes(), body].concat()
}

fn text(text: &str) -> Vec<u8> {
    [&(text.len() as u32).to_le_bytes(), text.as_bytes()].concat()
}

/// Bytes in front of the content of an attachment with this name and length.
fn attachment(name: &str, length: usize) -> Vec<u8> {
    [&[0; 16][..], &text(name), &text(""), &(length as u64).to_le_bytes()].concat()
}

/// A recording up to the end of its head.
fn beginning() -> Vec<u8> {
    let head = serde_json::to_vec(&head()).unwrap();
    let attached = [attachment("head.json", head.len()), head, vec![0; 4]].concat();
    let header = [text(PROFILE), text("")].concat();
    [mcap::MAGIC, &record(op::HEADER, &header), &record(op::ATTACHMENT, &attached)].concat()
}

/// Chunk in zstd's simplest form: raw blocks, and blocks of zeros encoded in four bytes.
fn chunk_of_zeros(records: &[(u8, Vec<u8>, usize)]) -> Vec<u8> {
    let block = |kind: usize, size: usize| (size << 3 | kind << 1).to_le_bytes()[..3].to_vec();
    let (mut frame, mut length) = (vec![0x28, 0xb5, 0x2f, 0xfd, 0, 0x38], 0);
    for (opcode, body, zeros) in records {
        let size = ((body.len() + zeros) as u64).to_le_bytes();
        let head = [&[*opcode][..], &size, body].concat();
        frame.extend([block(0, head.len()), head.clone()].concat());
        let mut left = *zeros;
        while left > 0 {
            let some = left.min(1 << 16);
            frame.extend([block(1, some), vec![0]].concat());
            left -= some;
        }
        length += head.len() + zeros;
    }
    frame.extend([1, 0, 0]);
    let numbers = [&[0; 16][..], &(length as u64).to_le_bytes(), &[0; 4]].concat();
    let compression = [&4_u32.to_le_bytes()[..], b"zstd"].concat();
    let compressed = [&(frame.len() as u64).to_le_bytes()[..], &frame].concat();
    record(op::CHUNK, &[numbers, compression, compressed].concat())
}

/// A recording of a few kilobytes cannot make its reader hold gigabytes, neither in one piece nor
/// in many.
#[test]
fn what_a_small_file_claims_is_limited_in_sum() {
    let read_error = |chunk: Vec<u8>| {
        let file = [beginning(), chunk].concat();
        assert!(file.len() < 100_000, "{}", file.len());
        let mut recording = match Recording::open(&file[..]) {
            Err(error) => return error.to_string(),
            Ok(recording) => recording,
        };
        loop {
            match recording.read() {
                Err(error) => break error.to_string(),
                Ok(entry) => assert!(entry.is_some(), "all of it was read"),
            }
        }
    };
    let attached = |n: usize| {
        let length = 16 << 20;
        (op::ATTACHMENT, attachment(&format!("files/{n}"), length), length + 4)
    };
    let error = read_error(chunk_of_zeros(&(0..40).map(attached).collect::<Vec<_>>()));
    assert!(error.contains("256 MiB at most"), "{error}");
    // States are the only messages without a label.
    let states = (1_u16..=40).flat_map(|id| {
        let topic = format!("state/role-{id}");
        let channel = [&id.to_le_bytes()[..], &[0; 2], &text(&topic), &[0; 8]].concat();
        [(op::CHANNEL, channel, 0), (op::MESSAGE, id.to_le_bytes().to_vec(), 20 + (16 << 20))]
    });
    let error = read_error(chunk_of_zeros(&states.collect::<Vec<_>>()));
    assert!(error.contains("256 MiB at most"), "{error}");
}

/// An uncompressed file holds every byte that it claims, so many topics with many values are
/// readable.
#[test]
fn an_uncompressed_file_of_any_length_reads() {
    let out = Cursor::new(Vec::new());
    let mut writer = RecordingWriter::create(out, Compression::None, &head(), &[]).unwrap();
    let values = vec![0.5; 2 << 20];
    for role in 0..20 {
        let header =
            FieldHeader { producer: Label::new(&format!("role-{role}")), ..header(0, 1 << 20) };
        writer.sample(&format!("field/role-{role}/slip_velocity"), &header, &values).unwrap();
    }
    let file = writer.finish().unwrap().into_inner();
    let mut recording = Recording::open(&file[..]).unwrap();
    let mut count = 0;
    while recording.read().unwrap().is_some() {
        count += 1;
    }
    assert_eq!((count, recording.end()), (20, End::Complete));
}

#[test]
fn an_attachment_shorter_than_its_length_is_reported() {
    let body = attachment("head.json", 0);
    for missing in 0..body.len() {
        let file = [mcap::MAGIC, &record(op::ATTACHMENT, &body[..body.len() - missing])].concat();
        let error = Recording::open(&file[..]).err().unwrap().to_string();
        assert!(error.contains("shorter than its length"), "{missing}: {error}");
    }
}

/// Reads a recording with this head and a single message, a sample on a topic.
fn with_sample(head: &Head, topic: &str, header: &FieldHeader) -> Result<(), RecordingError> {
    let out = Cursor::new(Vec::new());
    let mut writer = RecordingWriter::create(out, Compression::None, head, &[])?;
    let count = header.points.saturating_mul(header.components.into());
    writer.sample(topic, header, &vec![1.0; count.min(100) as usize])?;
    let file = writer.finish()?.into_inner();
    let mut recording = Recording::open(&file[..])?;
    while recording.read()?.is_some() {}
    Ok(())
}

#[test]
fn names_obey_the_rule_of_names_on_the_wire() {
    let (topic, good) = ("field/mech/slip_velocity", header(0, 2));
    assert!(with_sample(&head(), topic, &good).is_ok());
    assert!(
        with_sample(
            &head(),
            "field/coordinator/slip_velocity/thermal",
            &FieldHeader { producer: Label::new("coordinator"), ..good }
        )
        .is_ok()
    );
    let label = |header: FieldHeader| with_sample(&head(), topic, &header);
    let wrong = [
        label(FieldHeader { name: Label::new("../slip"), ..good }),
        label(FieldHeader { producer: Label::new("/etc"), ..good }),
        label(FieldHeader { grid: Label::new(".."), ..good }),
        label(FieldHeader { grid: Label::new(""), ..good }),
        label(FieldHeader { unit: Label::new("\u{1b}[2J"), ..good }),
        label(FieldHeader { producer: Label::new("thermal"), ..good }),
        label(FieldHeader { components: 0, ..good }),
        with_sample(&head(), "field/../slip_velocity", &good),
        with_sample(&head(), "field/mech/../slip_velocity", &good),
        with_sample(&head(), "/etc/passwd", &good),
        with_sample(&head(), "", &good),
    ];
    for (n, one) in wrong.iter().enumerate() {
        let error = one.as_ref().expect_err(&n.to_string()).to_string();
        assert!(error.contains("damaged") && !error.contains('\u{1b}'), "{n}: {error}");
    }
    let change = |change: &dyn Fn(&mut Head)| {
        let mut head = head();
        change(&mut head);
        with_sample(&head, topic, &good).map_err(|error| error.to_string())
    };
    let wrong = [
        change(&|head| head.participants[0].role = "..".to_owned()),
        change(&|head| head.participants[0].program = "../../bin/sh".to_owned()),
        change(&|head| head.participants[0].description.version = "1\n2".to_owned()),
        change(&|head| head.case = "a\u{1b}[2Jb".to_owned()),
        change(&|head| head.participants = vec![head.participants[0].clone(); 2]),
        change(&|head| {
            let (key, attachment) = ("bodies.rail.profile".to_owned(), "case.toml".to_owned());
            head.files.push(CaseFile { key, attachment });
        }),
    ];
    for (n, one) in wrong.iter().enumerate() {
        let error = one.as_ref().expect_err(&n.to_string());
        assert!(error.contains("damaged") && !error.contains(['\u{1b}', '\n']), "{n}: {error}");
    }
}

#[test]
fn topics_are_checked() {
    let topic = |service: &str, field: &str, shape: &str| {
        let grid = format!(
            "{{\"name\": \"g\", \"revision\": 1, \"kind\": \"structured\", \"origin\": [0, 0, 0], \
             \"step_i\": [1, 0, 0], \"step_j\": [0, 1, 0], {shape}}}"
        );
        let topic = format!(
            "{{\"field\": \"{field}\", \"service\": \"{service}\", \"grid\": {grid}, \"subscribers\": 1}}"
        );
        let body = format!("{{\"inputs\": [{topic}], \"outputs\": [{topic}], \"deadline\": 1}}");
        read_topics(body.as_bytes()).map(drop).map_err(|error| error.to_string())
    };
    let service = "field/mech/pressure";
    assert_eq!(topic(service, "pressure", "\"ni\": 3, \"nj\": 2"), Ok(()));
    for (service, field, shape, words) in [
        (service, "pressure", "\"ni\": 0, \"nj\": 2", "0 x 2 points"),
        (service, "pressure", "\"ni\": 7071068, \"nj\": 7071068", "7071068 x 7071068 points"),
        (service, "pressure", "\"ni\": 100000, \"nj\": 100000", "no recording holds a field on it"),
        (service, "pressure", "\"ni\": 18446744073709551615, \"nj\": 3", "points"),
        (service, "../../pressure", "\"ni\": 3, \"nj\": 2", "\"../../pressure\""),
        ("field/../pressure", "pressure", "\"ni\": 3, \"nj\": 2", "\"..\""),
        ("state/mech", "pressure", "\"ni\": 3, \"nj\": 2", "state/mech"),
    ] {
        let fault = topic(service, field, shape).unwrap_err();
        assert!(fault.contains(words), "{fault}");
    }
}

/// Reads a recording chunk by chunk, as far as its file has been written.
fn read_by_chunks(bytes: &[u8]) -> Result<Vec<u64>, RecordingError> {
    let mut recording = Recording::open(Cursor::new(bytes))?;
    let mut chunks = Chunks::new(Cursor::new(bytes));
    let mut times = Vec::new();
    while let Some(chunk) = chunks.find_next()? {
        recording.seek(chunk)?;
        while let Some(entry) = recording.read()? {
            times.push(entry.nanoseconds);
            if entry.nanoseconds >= chunk.last {
                break;
            }
        }
    }
    Ok(times)
}

#[test]
fn a_recording_is_read_chunk_by_chunk_in_any_order() {
    for compression in [Compression::None, Compression::Lz4] {
        let bytes = recorded(compression);
        let mut whole = Recording::open(bytes.as_slice()).unwrap();
        let mut times = Vec::new();
        while let Some(entry) = whole.read().unwrap() {
            times.push(entry.nanoseconds);
        }
        assert_eq!(read_by_chunks(&bytes).unwrap(), times);
        let mut finder = Chunks::new(Cursor::new(&bytes));
        let chunks: Vec<Chunk> = std::iter::from_fn(|| finder.find_next().unwrap()).collect();
        assert!(finder.is_finished() && chunks.len() >= 4, "{chunks:?}");
        // Backwards, after the channels have been read once.
        let mut recording = Recording::open(Cursor::new(&bytes)).unwrap();
        while recording.read().unwrap().is_some() {}
        for chunk in chunks.iter().rev() {
            recording.seek(*chunk).unwrap();
            let entry = recording.read().unwrap().unwrap();
            assert!(entry.nanoseconds <= chunk.last && times.contains(&entry.nanoseconds));
        }
    }
}

/// A chunk counts once it is complete; a search goes on where it has ended.
#[test]
fn a_recording_that_grows_is_followed() {
    let bytes = recorded(Compression::None);
    let mut all = Chunks::new(Cursor::new(&bytes));
    let expected: Vec<Chunk> = std::iter::from_fn(|| all.find_next().unwrap()).collect();
    let mut chunks = Chunks::new(Cursor::new(Vec::new()));
    let mut found = Vec::new();
    for length in (0..=bytes.len()).step_by(7).chain([bytes.len()]) {
        chunks.put_file(Cursor::new(bytes[..length].to_vec()));
        while let Some(chunk) = chunks.find_next().unwrap() {
            assert!(chunk.end <= length as u64);
            found.push(chunk);
        }
    }
    assert_eq!(found, expected);
    assert!(chunks.is_finished());
}

proptest! {
    /// Neither the search nor the reader trusts a length in the file.
    #[test]
    fn damaged_chunks_end_the_search(at in 0.0..1.0, bits in 1_u8.., cut in 0.0..1.0) {
        let mut bytes = recorded(Compression::Lz4);
        let place = (at * bytes.len() as f64) as usize;
        bytes[place] ^= bits;
        let _ = read_by_chunks(&bytes);
        bytes.truncate((cut * bytes.len() as f64) as usize);
        let _ = read_by_chunks(&bytes);
    }
}
