//! The documentation as a site: every link leads somewhere, its search finds, and nothing is asked of the network.

use crate::harness::browser::document;
use crate::harness::root;

#[test]
fn the_site_opens_offline_and_its_search_finds() {
    let folder = tempfile::tempdir().unwrap();
    let into = folder.path().join("site");
    // Every link is followed as it is made.
    let site = site::build(&root(), &into).unwrap();
    assert!(site.pages > 40 && site.links > 1000, "{site:?}");
    let begin = document(&format!("file://{}", into.join("index.html").display()));
    assert!(begin.contains("Three ways to use it"), "{begin}");
    let found =
        document(&format!("file://{}?search=loop%20gain", into.join("index.html").display()));
    assert!(found.contains("search results for 'loop gain'"), "{found}");
    assert!(found.contains("Debug a coupling that does not converge"), "{found}");
    let asks = |mark: &str| begin.contains(&format!("{mark}=\"http"));
    assert!(!asks("src") && !begin.contains("<link rel=\"stylesheet\" href=\"http"), "{begin}");
    // A site is replaced by the next one, what is none is not.
    site::build(&root(), &into).unwrap();
    let refused = site::build(&root(), &root().join("docs")).unwrap_err().to_string();
    assert!(refused.contains("is no site: name another folder"), "{refused}");
}
