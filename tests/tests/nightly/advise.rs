//! Advice on every shipped case; on some of them the system tests say what it is.

use tests::harness::{Place, root};

/// Whatever is shipped can be advised on, scenes of which nobody can say anything too.
#[test]
fn every_shipped_case_is_advised() {
    for entry in std::fs::read_dir(root().join("cases")).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|extension| extension == "toml") {
            let ended =
                Place::new().start(&["plan", &path.display().to_string(), "--advise"]).wait();
            assert_eq!(ended.code, Some(0), "{}: {}", path.display(), ended.stderr);
        }
    }
}
