//! The documentation as a site: every link leads to a page or a file, the search finds entries, and
//! no page loads anything from the network.

#![allow(missing_docs, reason = "a test has no readers")]

use std::path::Path;
use std::process::Command;

/// The page at an address, when its scripts have run.
fn document(address: &str) -> String {
    let chromium = std::env::var_os("COSIM_CHROMIUM").unwrap_or_else(|| "chromium".into());
    let profile = tempfile::tempdir().unwrap();
    let shown = Command::new(chromium)
        .args(["--headless", "--no-sandbox", "--virtual-time-budget=20000", "--dump-dom"])
        .arg(format!("--user-data-dir={}", profile.path().display()))
        .arg(address)
        .output()
        .unwrap();
    assert!(shown.status.success(), "{}", String::from_utf8_lossy(&shown.stderr));
    String::from_utf8(shown.stdout).unwrap()
}

#[test]
fn the_site_opens_offline_and_its_search_finds() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let folder = tempfile::tempdir().unwrap();
    let into = folder.path().join("site");
    // Every link is followed as it is made.
    let site = site::build(&root, &into).unwrap();
    assert!(site.pages > 40 && site.links > 1000, "{site:?}");
    let begin = document(&format!("file://{}", into.join("index.html").display()));
    assert!(begin.contains("Swap a solver"), "{begin}");
    let found =
        document(&format!("file://{}?search=loop%20gain", into.join("index.html").display()));
    assert!(found.contains("search results for 'loop gain'"), "{found}");
    assert!(found.contains("Debug a coupling that does not converge"), "{found}");
    let asks = |mark: &str| begin.contains(&format!("{mark}=\"http"));
    assert!(!asks("src") && !begin.contains("<link rel=\"stylesheet\" href=\"http"), "{begin}");
    // A site is replaced by the next one, what is none is not.
    site::build(&root, &into).unwrap();
    let refused = site::build(&root, &root.join("docs")).unwrap_err().to_string();
    assert!(refused.contains("is no site: name another folder"), "{refused}");
}
