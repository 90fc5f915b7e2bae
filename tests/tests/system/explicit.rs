//! Softening tables that explicit elements cannot use. The method itself is compared with
//! half-spaces and closed forms by the tests of `mech-solver`, and in complete runs by the target
//! `nightly`.

use crate::harness::{Place, case};

/// A temperature beyond the table ends the run when it occurs, and the message says what to write.
/// Values that rise, or a table without the initial temperature, are rejected before the run.
#[test]
fn a_table_that_does_not_suit_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let refused = |lines: &str, words: &[&str]| {
        let table = folder.path().join(format!("{}.csv", words[0].len()));
        std::fs::write(&table, lines).unwrap();
        let place = Place::new();
        let table = format!("materials.steel.softening_table={}", table.display());
        let coarse = ["--set", "mech.resolution=2", "--set", &table];
        let ended = place.start(&[&["run", &case("softening.toml")], &coarse[..]].concat()).wait();
        let said: String = ended.stderr.split_whitespace().collect::<Vec<_>>().join(" ");
        assert_ne!(ended.code, Some(0));
        assert!(words.iter().all(|word| said.contains(word)), "{words:?}: {said}");
    };
    refused("300 1 1\n674 0.5 0.5\n", &["beyond their softening_table", "hold"]);
    refused(
        "300 0.5 1\n1500 0.6 1\n",
        &["rises with the temperature", "materials.steel.softening_table"],
    );
    refused(
        "300 1 1\n600 0.6 1\n",
        &["673.15 K, the initial temperature of the body", "materials.steel"],
    );
    refused("300 1 1.5\n600 0.6 1\n", &["in line 1", "above 0 and at most 1"]);
}
