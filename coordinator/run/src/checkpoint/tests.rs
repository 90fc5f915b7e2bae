use super::*;
use crate::sealed::sum;

fn state(next: u64) -> CoordinatorState {
    let mut controller =
        windows::Controller::new(windows::Windows::Fixed { window: 1.0, end: 9.0 });
    for _ in 0..next {
        let step = controller.window().unwrap();
        let none: [&[f64]; 0] = [];
        controller.judge(&step, true, None, none);
    }
    CoordinatorState {
        origin: Origin {
            version: "1".to_owned(),
            protocol: 2,
            case: "[case]".to_owned(),
            folder: PathBuf::from("/somewhere"),
            plan: vec![("mech".to_owned(), 7)],
            files: BTreeMap::from([("bodies.rail.profile".to_owned(), "8".to_owned())]),
        },
        step: (next - 1, 3, 0.1, 0.1 + 0.2),
        time: controller.state().clone(),
        counts: Counts { windows: next, final_residual: Some(1e-7), ..Counts::default() },
        coupling: vec![1, 2, 3],
        iterate: vec![f64::MIN_POSITIVE, -0.0],
        table_bytes: 99,
        history_bytes: 33,
        series: Vec::new(),
        recorded: Some(Compression::Lz4),
    }
}

fn written(next: &[u64]) -> (tempfile::TempDir, Checkpoints) {
    let place = tempfile::tempdir().unwrap();
    let checkpoints = Checkpoints::of(place.path());
    for &next in next {
        let draft = checkpoints.begin(next).unwrap();
        fs::write(draft.join("mech.state"), [next as u8; 100]).unwrap();
        checkpoints.complete(&draft, &["mech.state".to_owned()], &state(next)).unwrap();
    }
    (place, checkpoints)
}

#[test]
fn the_last_two_are_kept_and_read_back_to_the_bit() {
    let (_place, checkpoints) = written(&[3, 6, 9]);
    assert_eq!(checkpoints.names(), ["000006", "000009"]);
    let (newest, corrupt) = checkpoints.newest();
    let newest = newest.unwrap();
    assert_eq!((newest.state, corrupt), (state(9), Vec::new()));
    assert_eq!(fs::read(newest.folder.join("mech.state")).unwrap(), [9; 100]);
}

/// A file that is cut off or damaged at any byte is detected, and the checkpoint before is used.
#[test]
fn what_is_torn_is_named_and_the_one_before_used() {
    for file in ["mech.state", OWN] {
        let (place, checkpoints) = written(&[3, 6]);
        let path = place.path().join(FOLDER).join("000006").join(file);
        let whole = fs::read(&path).unwrap();
        let mut damaged = whole.clone();
        for at in 0..whole.len() {
            damaged[at] ^= 0x10;
            for content in [&whole[..at], &damaged] {
                fs::write(&path, content).unwrap();
                let (newest, corrupt) = checkpoints.newest();
                assert_eq!(newest.unwrap().state, state(3), "{file} at {at}");
                assert_eq!(corrupt[0].name, "000006");
                assert!(corrupt[0].reason.starts_with(file), "{corrupt:?}");
            }
            damaged[at] = whole[at];
        }
        fs::remove_file(&path).unwrap();
        assert_eq!(checkpoints.newest().1.len(), 1);
    }
}

/// Reads only files of the checkpoint itself, whatever names its own part holds.
#[test]
fn a_part_that_is_no_file_of_the_checkpoint_is_refused() {
    let (place, checkpoints) = written(&[3, 6]);
    let folder = place.path().join(FOLDER).join("000006");
    std::os::unix::fs::symlink("/dev/zero", folder.join("endless")).unwrap();
    for name in ["../000003/mech.state", "/dev/zero", "..", "endless"] {
        let part = Part { name: name.to_owned(), bytes: 100, sum: sum(&[3; 100]) };
        fs::write(folder.join(OWN), encode_own(&(vec![part], &state(6)))).unwrap();
        let (newest, corrupt) = checkpoints.newest();
        assert_eq!(newest.unwrap().state, state(3), "{name}");
        assert!(corrupt[0].reason.contains(name), "{corrupt:?}");
    }
}

#[test]
fn a_draft_is_no_checkpoint_and_goes_with_the_others() {
    let (place, checkpoints) = written(&[3]);
    let draft = checkpoints.begin(6).unwrap();
    fs::write(draft.join("mech.state"), "half").unwrap();
    assert_eq!(checkpoints.newest().0.unwrap().state, state(3));
    fs::create_dir(place.path().join(FOLDER).join("mine")).unwrap();
    checkpoints.clear().unwrap();
    assert_eq!(checkpoints.entries(), ["mine"]);
    assert!(checkpoints.newest().0.is_none());
}

/// Windows beyond 999999 sort after all windows before.
#[test]
fn long_numbers_are_later() {
    let (_place, checkpoints) = written(&[4]);
    for next in [999_999, 1_000_000] {
        let draft = checkpoints.begin(next).unwrap();
        checkpoints.complete(&draft, &[], &state(5)).unwrap();
    }
    assert_eq!(checkpoints.names(), ["999999", "1000000"]);
}

proptest::proptest! {
    #![proptest_config(crate::fuzz_config())]

    /// Bytes with a valid head and checksum reach the decoder.
    #[test]
    fn bytes_that_look_like_a_checkpoint_are_refused_in_peace(
        content in proptest::collection::vec(proptest::prelude::any::<u8>(), 0..300),
        edits in proptest::collection::vec((0.0..1.0_f64, proptest::prelude::any::<u8>()), 0..6),
    ) {
        let sealed = |content: &[u8]| {
            let mut bytes = MAGIC.to_vec();
            bytes.extend(sum(content).to_le_bytes());
            bytes.extend_from_slice(content);
            bytes
        };
        let _ = decode_own(&sealed(&content));
        let _ = decode_own(&content);
        let good = encode_own(&(Vec::new(), &state(3)));
        let mut content = good[MAGIC.len() + 8..].to_vec();
        for (share, byte) in edits {
            let at = (share * content.len() as f64) as usize;
            content[at] = byte;
        }
        let _ = decode_own(&sealed(&content));
    }
}
