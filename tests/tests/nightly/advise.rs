//! Advice on every shipped case; the system tests check its content for some of them.

use tests::harness::{Place, root};

/// Every shipped case gets advice, or the statement that there is none.
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
