//! What the pages have people type does what stands under it.

use crate::harness::root;
use crate::harness::snippets::{self, blocks};
use crate::keys::{fits, flatten, known_keys};

/// Pages that are run here, each in a test of its own.
const DAILY: [&str; 8] = [
    "docs/install.md",
    "docs/tutorial.md",
    "docs/how-to/swap-a-solver.md",
    "docs/how-to/choose-accuracy.md",
    "docs/how-to/debug-a-coupling.md",
    "docs/how-to/run-on-a-cluster.md",
    "docs/recording.md",
    "docs/fmi.md",
];

table_of_tests! {
    is_true:
    install(DAILY[0]);
    the_tutorial(DAILY[1]);
    swap_a_solver(DAILY[2]);
    choose_accuracy(DAILY[3]);
    debug_a_coupling(DAILY[4]);
    run_on_a_cluster(DAILY[5]);
    recordings(DAILY[6]);
    fmus(DAILY[7]);
}

fn is_true(page: &str) {
    let (commands, _) = snippets::run(page);
    assert!(commands > 0, "{page} has no commands");
}

/// The pages of the site, by their paths in the repository.
fn pages() -> Vec<String> {
    let summary = std::fs::read_to_string(root().join("docs/SUMMARY.md")).unwrap();
    let links = summary.lines().filter_map(|line| line.split_once("](")?.1.strip_suffix(')'));
    links
        .map(|link| match link.strip_prefix("../") {
            Some(outside) => outside.to_owned(),
            None => format!("docs/{link}"),
        })
        .collect()
}

/// Every block that people type is run, here or in the nightly test of the same name, or says why it is not.
#[test]
fn every_block_is_run_or_says_why_not() {
    let nightly = include_str!("../nightly/snippets.rs");
    let mut seen = 0;
    for page in pages() {
        let run = DAILY.contains(&page.as_str()) || nightly.contains(&format!("\"{page}\""));
        for block in blocks(&page).iter().filter(|block| block.is_typed()) {
            assert!(
                run || block.left_out.is_some(),
                "{page} has a block that nothing runs:\n{}",
                block.text
            );
            seen += 1;
        }
    }
    assert!(seen > 60, "{seen} blocks");
}

/// Parts of cases on the pages are TOML, and have keys that there are.
#[test]
fn parts_of_cases_have_keys_that_there_are() {
    let known = known_keys();
    let mut seen = 0;
    for page in pages().iter().filter(|page| *page != "docs/mistakes.md") {
        let left_out =
            |block: &&snippets::Block| block.left_out.is_none() && block.language == "toml";
        for block in blocks(page).iter().filter(left_out) {
            let table: toml::Table =
                block.text.parse().unwrap_or_else(|error| panic!("{page}: {error}"));
            let mut keys = Vec::new();
            flatten("", &table.into(), &mut keys);
            for key in keys {
                assert!(known.iter().any(|one| fits(one, &key)), "{page}: `{key}` is no key");
                seen += 1;
            }
        }
    }
    assert!(seen > 10, "{seen} keys");
}
