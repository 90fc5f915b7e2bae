//! Commands on pages that take long or compile code.

use tests::harness::python::interpreter_with_packages;
use tests::harness::snippets;

/// Pages that take minutes, or need what only `--workspace` builds.
const PAGES: [&str; 10] = [
    "README.md",
    "docs/how-to/run-a-case.md",
    "docs/how-to/look-at-results.md",
    "docs/how-to/vary-a-case.md",
    "docs/how-to/fit-to-measurements.md",
    "docs/how-to/sensitivity.md",
    "docs/how-to/probability.md",
    "docs/surrogate.md",
    "docs/scaling.md",
    "proto/python/README.md",
];

#[test]
fn what_takes_long_is_true() {
    for page in PAGES {
        let (commands, _) = snippets::run(page, interpreter_with_packages());
        assert!(commands > 0, "{page} has no commands");
    }
}
