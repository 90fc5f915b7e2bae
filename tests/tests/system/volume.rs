//! Fields on volumes: written, recorded and replayed; no participant consumes them.

use crate::harness::compiled::Compiled;
use crate::harness::python::interpreter;
use crate::harness::{Place, case, completed, field_files, number, root, sets, toy};
use run::plan::{sample_bytes, topic_bytes};
use serde_json::Value;
use tests::volume::{KINDS, hexahedra};

const CASE: &str = "volume.toml";

/// Runs a command on the case with these settings; returns exit code, standard output and standard
/// error.
fn asked(command: &str, settings: &[&str]) -> (Option<i32>, String, String) {
    let (name, place) = (case(CASE), Place::new());
    let sets = sets(settings);
    let arguments: Vec<&str> = [command, &name].into_iter().chain(sets).collect();
    let ended = place.start(&arguments).wait();
    place.assert_nothing_left();
    (ended.code, ended.stdout, ended.stderr)
}

/// Output of `command RECORDING` as JSON.
fn of_recording(place: &Place, command: &str, more: &[&str]) -> Value {
    let path = place.out().join("recording.mcap").display().to_string();
    let arguments: Vec<&str> =
        [command, &path, "--json"].into_iter().chain(more.iter().copied()).collect();
    let ended = place.start(&arguments).wait();
    assert_eq!(ended.code, Some(0), "{more:?}: {}{}", ended.stdout, ended.stderr);
    serde_json::from_str(&ended.stdout).unwrap()
}

/// The geometry is sent once, or in every window; replay from the start and from a state in the
/// middle.
#[test]
fn every_kind_is_recorded_and_replays_to_the_bit() {
    for kind in KINDS {
        for (swells, geometries) in [("false", 1), ("true", 5)] {
            let set = [format!("volume.hexahedra={kind}"), format!("volume.swells={swells}")];
            let settings = [&set[0], &set[1], "output.every=3", "output.checkpoint_every=2"];
            let place = Place::new();
            let more: Vec<&str> = ["--record"].into_iter().chain(sets(&settings)).collect();
            place.summary(&case(CASE), &more);
            let seen = of_recording(&place, "inspect", &[]);
            let samples = |topic: &str| {
                let mut fields = seen["fields"].as_array().unwrap().iter();
                let field = fields.find(|field| field["topic"] == topic).unwrap();
                (field["samples"].as_u64().unwrap(), field["values"].as_u64().unwrap())
            };
            let values = 3 * hexahedra(kind, 8).vectors() as u64;
            assert_eq!(samples("geometry/volume/block"), (geometries, values), "{settings:?}");
            assert_eq!(samples("field/volume/volume_temperature"), (4, 64), "{settings:?}");
            let program = toy("volume").join(" ");
            let only = ["--only", "volume", "--command", &program];
            for from in [&[][..], &["--from", "3"]] {
                let replay = of_recording(&place, "replay", &[from, &only].concat());
                assert_eq!(replay["comparison"]["unequal_samples"], 0, "{replay:#}");
                assert!(replay["comparison"]["samples"].as_u64().unwrap() > 2, "{replay:#}");
            }
        }
    }
}

#[test]
fn a_run_leaves_files_and_a_report() {
    let place = Place::new();
    for (kind, ending) in [("rectilinear", "vtr"), ("structured", "vts"), ("unstructured", "vtu")] {
        // Same folder: the files of the previous run are removed.
        let hexahedra = format!("volume.hexahedra={kind}");
        place.summary(&case(CASE), &sets(&[&hexahedra]));
        let entries = std::fs::read_dir(place.out().join("fields")).unwrap().flatten();
        let mut names: Vec<_> =
            entries.map(|entry| entry.file_name().into_string().unwrap()).collect();
        names.sort();
        let file = format!("volume_block_000003.{ending}");
        assert_eq!(names, ["last.bin", "open.py", "volume_block.pvd", &file]);
        let out = place.out().display().to_string();
        let report = place.start(&["report", &out]).wait();
        assert_eq!(report.code, Some(0), "{}", report.stderr);
    }
}

/// The plan needs only the announced counts: planning a million elements takes no longer than
/// eight.
#[test]
fn the_plan_tells_what_a_volume_takes() {
    let (code, plan, stderr) = asked("plan", &["volume.elements=200"]);
    assert_eq!(code, Some(0), "{stderr}");
    for told in [
        "volume_temperature             volume -> output only         8.00 MB",
        "volume `block` of volume: 1000000 elements, 24.8 MB of geometry once",
    ] {
        assert!(plan.contains(told), "{told}: {plan}");
    }
    let (_, plan, _) = asked("plan", &["output.fields=none"]);
    assert!(!plan.contains("volume `block`"), "{plan}");
}

#[test]
fn shared_memory_is_counted_with_the_geometry() {
    let topic = |points, components| topic_bytes(sample_bytes(points, components));
    let (elements, vectors) = (64, hexahedra("structured", 8).vectors());
    let needed = (1 << 20) + topic(elements, 1) + topic(elements, 3) + topic(vectors, 3);
    let limit = |bytes: u64| format!("limits.shared_memory={bytes}");
    completed(CASE, &[&limit(needed)]);
    let ended = Place::new().run(&case(CASE), &sets(&[&limit(needed - 1)]));
    assert!(ended.stderr.contains("before the fields were created"), "{}", ended.stderr);
    let (_, summary) = completed(CASE, &[&limit(1 << 20), "output.fields=none"]);
    assert_eq!(number(&summary, "/volume/windows"), 4.0);
}

#[test]
fn nobody_consumes_a_field_on_a_volume() {
    let script = root().join("tests/tests/system/python/reader.py");
    let words = [interpreter().display().to_string(), script.display().to_string()];
    let command = format!("reader.command={words:?}");
    let settings = ["reader.model=mean", &command];
    for command in ["plan", "run"] {
        let (code, _, stderr) = asked(command, &settings);
        assert_eq!(code, Some(2), "{command}: {stderr}");
        for part in [
            "reader.model",
            "`reader` consumes `volume_temperature` of `volume`, which is on the volume `block`: \
             fields on volumes are only written out",
            "choose a model of `volume` that provides `volume_temperature` on a surface",
        ] {
            assert!(stderr.contains(part), "{part}: {stderr}");
        }
    }
}

#[test]
fn a_volume_without_a_right_geometry_is_told() {
    for (fault, part) in [
        ("missing", "the geometry of the volume `block` is not given"),
        ("mirrored", "the volume `block` is given without geometry"),
    ] {
        let fault = format!("volume.fault={fault}");
        let place = Place::new();
        let ended = place.run(&case(CASE), &sets(&[&fault]));
        place.assert_nothing_left();
        assert_eq!(ended.code, Some(1), "{}", ended.stderr);
        assert!(ended.stderr.contains("volume (toy) failed"), "{}", ended.stderr);
        assert!(ended.stderr.contains(part), "{part}: {}", ended.stderr);
    }
}

/// Asserts that two files are equal except for rounding in the appended doubles.
fn assert_same_file((name, a): &(String, Vec<u8>), (_, b): &(String, Vec<u8>)) {
    const MARK: &[u8] = b"<AppendedData encoding=\"raw\">\n_";
    let at = a.windows(MARK.len()).position(|window| window == MARK).unwrap() + MARK.len();
    assert!(a.len() == b.len() && a[..at] == b[..at], "{name}: the heads differ");
    // Lengths, numbers of vertices and packed cell types are not doubles; they must be equal.
    for (a, b) in a[at..].as_chunks().0.iter().zip(b[at..].as_chunks().0) {
        let [a, b] = [a, b].map(|word| u64::from_le_bytes(*word));
        let off = (f64::from_bits(a) - f64::from_bits(b)).abs();
        assert!(a == b || off < 1e-14 * f64::from_bits(a).abs().max(1.0), "{name}: {off:e}");
    }
}

/// Asserts that the block in another language writes the same files as ours.
fn assert_as_in_rust(command: &str, settings: &[&str]) {
    for kind in KINDS {
        let kind = format!("volume.hexahedra={kind}");
        let settings = [settings, &[&kind, "output.every=3"]].concat();
        let (ours, _) = completed(CASE, &settings);
        let (theirs, _) = completed(CASE, &[&settings[..], &[command]].concat());
        let files = |place: &Place| {
            let of_block = |(name, _): &(String, _)| name.starts_with("volume_block_");
            field_files(&place.out()).into_iter().filter(of_block).collect::<Vec<_>>()
        };
        let (ours, theirs) = (files(&ours), files(&theirs));
        assert_eq!((ours.len(), theirs.len()), (2, 2), "{settings:?}");
        ours.iter().zip(&theirs).for_each(|(a, b)| assert_same_file(a, b));
    }
}

#[test]
fn a_volume_in_python_is_as_in_rust() {
    let script = root().join("tests/tests/system/python/volume.py");
    let command = format!("volume.command=[{:?}, {script:?}]", interpreter());
    for swells in ["volume.swells=false", "volume.swells=true"] {
        assert_as_in_rust(&command, &[swells]);
    }
}

#[test]
fn a_volume_in_c_is_as_in_rust() {
    let program = Compiled::from("proto/c/tests/volume.c");
    let command = format!("volume.command=[{:?}]", program.path());
    assert_as_in_rust(&command, &[]);
    let ended = Place::new().run(&case(CASE), &sets(&[&command, "volume.fault=unwritten"]));
    assert_eq!(ended.code, Some(1), "{}", ended.stderr);
    let part = "volume `block`: value 0 of its geometry is NaN";
    assert!(ended.stderr.contains(part), "{}", ended.stderr);
}
