//! A small recording: followed while it grows, compared, drawn, and damaged.

use crate::index::{DifferenceSearch, Index};
use crate::steps::Move;
use crate::view::{Against, Request, view};
use crate::watched::Watched;
use contract::grid::{Grid, Structured};
use contract::message::{Command, CommandKind, FieldHeader, Label, Topic, Topics};
use proptest::prelude::*;
use proto::recording::{Compression, Event, FORMAT, Head, Iteration, RecordingWriter};
use std::fs::{self, File};
use std::io::Cursor;
use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime};
use tempfile::TempDir;

const SERVICE: &str = "field/mech/friction_power";
/// A name that a page must not take for markup.
const HOSTILE: &str = "<img src=x onerror=alert(1)>";

fn head() -> Head {
    let description = serde_json::json!({
        "protocol": 1, "name": "mech-solver", "version": "1", "role": "mech", "standalone": false,
        "estimates": false, "models": [], "effects": [], "keys": [],
    });
    Head {
        format: FORMAT,
        protocol: 1,
        writer: "test".to_owned(),
        case: HOSTILE.to_owned(),
        scheme: "serial-implicit".to_owned(),
        acceleration: "iqn-ils".to_owned(),
        participants: vec![proto::recording::Participant {
            role: "mech".to_owned(),
            program: "mech-solver".to_owned(),
            description: serde_json::from_value(description).unwrap(),
        }],
        files: Vec::new(),
    }
}

fn grid() -> Grid {
    Grid::structured("contact", Structured::contact_plane(0.0, 0.0, 1e-3, 1e-3, 3, 2))
}

/// Three windows of two iterations; the values of the last iteration are `last` times as large.
fn recorded(last: f64) -> Vec<u8> {
    let case = format!("[case]\nname = \"x\"\ntitle = \"{HOSTILE}\"\n");
    let attachments = [("case.toml".to_owned(), case.into_bytes())];
    let out = Cursor::new(Vec::new());
    let mut writer = RecordingWriter::create(out, Compression::Lz4, &head(), &attachments).unwrap();
    let topic = Topic {
        field: "friction_power".to_owned(),
        service: SERVICE.to_owned(),
        grid: grid(),
        subscribers: 0,
        geometry: None,
    };
    let topics = Topics {
        inputs: Vec::new(),
        outputs: vec![topic],
        deadline: 1.0,
        interpolation: Default::default(),
        geometry: Vec::new(),
        figures: Vec::new(),
    };
    let body = serde_json::to_vec(&topics).unwrap();
    let command = Command::new(CommandKind::Connect);
    writer.event(&Event::Command { participant: 0, command, body }).unwrap();
    for step in 0..6_u32 {
        let (window, iteration) = (u64::from(step / 2), step % 2 + 1);
        let factor = if step == 5 { last } else { 1.0 };
        let values: Vec<f64> = (0..6).map(|n| factor * f64::from(step + n)).collect();
        let header = FieldHeader {
            components: 1,
            points: 6,
            window,
            iteration,
            name: Label::new("friction_power"),
            unit: Label::new("W/m2"),
            producer: Label::new("mech"),
            grid: Label::new("contact"),
            ..FieldHeader::default()
        };
        writer.sample(SERVICE, &header, &values).unwrap();
        let residuals = vec![("friction_power".to_owned(), 0.5)];
        let model_seconds = vec![1e-3];
        let event = Iteration {
            window,
            iteration,
            end: 1.0,
            residual: Some(0.5),
            residuals,
            model_seconds,
            ..Iteration::default()
        };
        writer.event(&Event::Iteration(event)).unwrap();
        writer.flush().unwrap();
    }
    writer.event(&Event::Ended { error: None }).unwrap();
    writer.finish().unwrap().into_inner()
}

fn stored(folder: &TempDir, name: &str, bytes: &[u8]) -> PathBuf {
    let path = folder.path().join(name);
    fs::write(&path, bytes).unwrap();
    path
}

fn indexed(path: &Path) -> Index {
    let mut index = Index::open(path).unwrap();
    while index.advance().unwrap() {}
    index
}

#[test]
fn a_recording_is_followed_while_it_grows() {
    let folder = tempfile::tempdir().unwrap();
    let bytes = recorded(1.0);
    // The head, without a step.
    let path = stored(&folder, "recording.mcap", &bytes[..bytes.len() / 2]);
    let mut index = indexed(&path);
    let half = index.steps().len();
    assert!(half < 6 && !index.is_complete());
    fs::write(&path, &bytes).unwrap();
    while index.advance().unwrap() {}
    assert_eq!((index.steps().len(), index.end()), (6, Some(None)));
    assert!(index.is_complete());
    let steps: Vec<(u64, u32)> = index.steps().iter().map(|s| (s.window, s.iteration)).collect();
    assert_eq!(steps, [(0, 1), (0, 2), (1, 1), (1, 2), (2, 1), (2, 2)]);
    for step in 0..6 {
        let time = index.steps()[step].nanoseconds;
        let (place, sample) = index.sample(0, time).unwrap().unwrap();
        assert_eq!(place.range, [step as f64, step as f64 + 5.0]);
        assert_eq!(sample.values[1], step as f64 + 1.0);
        assert_eq!(sample.grid, Some(grid()));
    }
    assert_eq!(index.table(4..5).lines().nth(1).unwrap(), "2,1,0e0,1e0,5e-1,5e-1,0e0,,,1e-3,");
}

#[test]
fn the_first_difference_is_found() {
    let folder = tempfile::tempdir().unwrap();
    let [one, other] = [1.0, 1.0 + f64::EPSILON]
        .map(|last| indexed(&stored(&folder, &format!("{last:e}.mcap"), &recorded(last))));
    let mut one = one;
    let mut again = indexed(&stored(&folder, "again.mcap", &recorded(1.0)));
    let first = |now: &Index, then: &mut Index| DifferenceSearch::default().first(now, then);
    assert_eq!(first(&one, &mut again), None);
    let (series, time) = first(&other, &mut one).unwrap();
    assert_eq!(other.series()[series].service, SERVICE);
    let steps = other.steps();
    assert!(steps[4].nanoseconds < time && time < steps[5].nanoseconds);
}

#[test]
fn every_comparison_is_drawn() {
    let folder = tempfile::tempdir().unwrap();
    let mut now = indexed(&stored(&folder, "now.mcap", &recorded(2.0)));
    let mut other = indexed(&stored(&folder, "other.mcap", &recorded(1.0)));
    let mut drawn = |against, step| {
        let request = Request { series: 0, step, go: Move::Stay, against };
        view(&mut now, Some(&mut other), request).unwrap()
    };
    let first = drawn(Against::Iteration, 0).html;
    assert!(first.contains("There is no iteration before this one."), "{first}");
    let plain = drawn(Against::Nothing, 5);
    assert!(plain.caption.starts_with("window 2, iteration 2 · "), "{}", plain.caption);
    assert!(plain.html.contains("data-range=\"10 20\""), "the values are 10 to 20 W/m²");
    let mut change = |against, text: &str| {
        let html = drawn(against, 5).html;
        assert!(html.contains(text), "{against:?}: {html}");
    };
    change(Against::Iteration, "friction power minus that of the iteration before");
    change(Against::Window, "friction power minus that of the window before");
    change(Against::Other, "friction power minus that of the other recording");
}

/// A folder as a run leaves it, with the recording.
fn results(folder: &TempDir, recording: &[u8]) -> PathBuf {
    let results = folder.path().join("results");
    fs::create_dir(&results).unwrap();
    fs::write(results.join("log.jsonl"), "").unwrap();
    fs::write(results.join("recording.mcap"), recording).unwrap();
    results
}

fn shown(watched: &mut Watched) -> String {
    watched.read_all();
    let last = Request { series: 0, step: 0, go: Move::Last, against: Against::Nothing };
    watched.view(last).unwrap().html
}

/// Another run with as many steps is another run, whether its recording is a new file or is written
/// into the old one.
#[test]
fn another_run_in_the_folder_is_noticed() {
    let folder = tempfile::tempdir().unwrap();
    let path = results(&folder, &recorded(1.0));
    let recording = path.join("recording.mcap");
    let mut watched = Watched::open(&path, None).unwrap();
    assert!(shown(&mut watched).contains("data-range=\"5 10\""));
    let first = watched.state();
    fs::remove_file(&recording).unwrap();
    fs::write(&recording, recorded(2.0)).unwrap();
    assert!(shown(&mut watched).contains("data-range=\"10 20\""));
    let second = watched.state();
    assert!(second.run != first.run && second.fields == first.fields);
    fs::write(&recording, recorded(3.0)).unwrap();
    // The clock of a file system may be coarse.
    let later = SystemTime::now() + Duration::from_secs(5);
    File::options().append(true).open(&recording).unwrap().set_modified(later).unwrap();
    assert!(shown(&mut watched).contains("data-range=\"15 30\""));
    assert_ne!(watched.state().run, second.run);
}

/// A run without a recording has no steps. A folder that is gone is named, and its steps stay.
#[test]
fn a_recording_or_a_folder_that_is_removed_is_noticed() {
    let folder = tempfile::tempdir().unwrap();
    let path = results(&folder, &recorded(1.0));
    let mut watched = Watched::open(&path, None).unwrap();
    watched.read_all();
    assert_eq!((watched.steps().len(), watched.state().remark), (6, None));
    fs::rename(&path, folder.path().join("elsewhere")).unwrap();
    watched.read_all();
    let remark = watched.state().remark.unwrap();
    assert!(remark.ends_with("results has been removed; the page shows what was read before"));
    assert_eq!(watched.steps().len(), 6);
    fs::rename(folder.path().join("elsewhere"), &path).unwrap();
    fs::remove_file(path.join("recording.mcap")).unwrap();
    watched.read_all();
    assert_eq!((watched.steps().len(), watched.state().remark), (0, None));
}

/// A full disk may cut a recording before its head; the report of the run is there nevertheless.
#[test]
fn a_recording_without_a_head_is_a_remark() {
    let folder = tempfile::tempdir().unwrap();
    let path = results(&folder, &recorded(1.0)[..60]);
    let mut watched = Watched::open(&path, None).unwrap();
    watched.read_all();
    let remark = watched.state().remark.unwrap();
    assert!(remark.contains("truncated before its header is complete"), "{remark}");
    let alone = Watched::open(&path.join("recording.mcap"), None).err().unwrap().to_string();
    assert!(alone.contains("truncated before its header"), "{alone}");
    let compared = Watched::open(&path, Some(&path)).err().unwrap().to_string();
    assert!(compared.contains("holds no recording to compare"), "{compared}");
}

/// The page of a recording that has just been completed does not call its run running.
#[test]
fn a_finished_run_is_not_running() {
    let folder = tempfile::tempdir().unwrap();
    let path = stored(&folder, "recording.mcap", &recorded(1.0));
    let mut watched = Watched::open(&path, Some(&path)).unwrap();
    watched.read_all();
    assert_eq!(watched.page().status, "recorded");
    let state = watched.state();
    assert!(!state.live && state.difference.is_none());
}

/// A recording with any number of steps takes a limited part of the memory.
#[test]
fn a_full_index_reads_no_further() {
    let folder = tempfile::tempdir().unwrap();
    let path = stored(&folder, "recording.mcap", &recorded(1.0));
    let mut index = Index::open_within(&path, 500).unwrap();
    while index.advance().unwrap() {}
    assert!(index.is_full());
    assert!((1..6).contains(&index.steps().len()), "{}", index.steps().len());
}

/// No text of a recording becomes markup, on the page and in the file.
#[test]
fn hostile_names_are_text() {
    let folder = tempfile::tempdir().unwrap();
    let path = stored(&folder, "recording.mcap", &recorded(1.0));
    let file = folder.path().join("page.html");
    crate::offline::write(Watched::open(&path, None).unwrap(), &file, false).unwrap();
    let page = fs::read_to_string(&file).unwrap();
    assert!(page.contains("&lt;img src=x") && !page.contains("<img"), "{page}");
    let again = Watched::open(&path, None).unwrap();
    let refused = crate::offline::write(again, &file, false).unwrap_err().to_string();
    assert!(refused.contains("exists; replace it with --replace"), "{refused}");
}

proptest! {
    /// Damage of a recording is an error or a shorter recording, never a panic.
    #[test]
    fn a_damaged_recording_is_survived(at in 0.0..1.0, bits in 1_u8.., cut in 0.5..1.0) {
        let folder = tempfile::tempdir().unwrap();
        let mut bytes = recorded(1.0);
        let place = (at * bytes.len() as f64) as usize;
        bytes[place] ^= bits;
        bytes.truncate((cut * bytes.len() as f64) as usize);
        let path = stored(&folder, "recording.mcap", &bytes);
        let Ok(mut watched) = Watched::open(&path, Some(&path)) else { return Ok(()) };
        while watched.advance() {}
        let _ = watched.state();
        for against in Against::ALL {
            let _ = watched.view(Request { series: 0, step: 3, go: Move::Next, against });
        }
    }
}
