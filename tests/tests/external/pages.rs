//! Commands on pages that need packages of Python.

use tests::harness::python::interpreter_with_packages;
use tests::harness::snippets;

fn is_true(page: &str) {
    let (commands, _) = snippets::run(page, interpreter_with_packages());
    assert!(commands > 0, "{page} has no commands");
}

#[test]
fn recordings() {
    is_true("docs/recording.md");
}

#[test]
fn fmus() {
    is_true("docs/fmi.md");
}
