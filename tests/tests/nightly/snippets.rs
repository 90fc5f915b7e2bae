//! What pages have people type that takes long, or compiles.

use tests::harness::snippets;

/// Pages that take minutes, or need what only `--workspace` builds.
const PAGES: [&str; 4] =
    ["README.md", "docs/surrogate.md", "docs/scaling.md", "proto/python/README.md"];

#[test]
fn what_takes_long_is_true() {
    for page in PAGES {
        let (commands, _) = snippets::run(page);
        assert!(commands > 0, "{page} has no commands");
    }
}
