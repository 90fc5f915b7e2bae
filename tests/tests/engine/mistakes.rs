//! Common mistakes in a case and the messages about them: `mistakes.toml`, and docs/mistakes.md
//! generated from it.

use crate::harness::{checked, root};
use std::fmt::Write as _;

/// Every mistake is reported with place, reason and fix, and the page quotes the message exactly.
/// `COSIM_WRITE_MISTAKES=1` writes the page.
#[test]
fn every_mistake_is_told() {
    let base = std::fs::read_to_string(root().join("cases/wheel-rail.toml")).unwrap();
    let list: toml::Table = include_str!("mistakes.toml").parse().unwrap();
    let mut page = String::from(
        "# Mistakes in a case, and what is said of them\n\nEach is made in `cases/wheel-rail.toml`, and answered by `coordinator check`, as \
         the tests do it (`tests/tests/engine/mistakes.toml`; this page is written by them). Several at once are told at once.\n",
    );
    let all = list["mistake"].as_array().unwrap();
    assert!(all.len() >= 50, "{}", all.len());
    for one in all {
        let what = one["what"].as_str().unwrap();
        let mut case =
            one.get("text").map_or(base.as_str(), |text| text.as_str().unwrap()).to_owned();
        let mut written = Vec::new();
        for edit in one.get("edits").and_then(|edits| edits.as_array()).into_iter().flatten() {
            let [from, to] = [0, 1].map(|n| edit[n].as_str().unwrap());
            assert!(case.contains(from), "{what}: the case has no `{from}`");
            case = case.replacen(from, to, 1);
            written.push(to);
        }
        let ended = checked("case.toml", &case);
        let said = [ended.stdout, ended.stderr].concat();
        let expected = one.get("code").map_or(2, |code| code.as_integer().unwrap());
        assert_eq!(ended.code.map(i64::from), Some(expected), "{what}: {said}");
        for words in one["says"].as_array().unwrap() {
            let words = words.as_str().unwrap();
            assert!(said.contains(words), "{what}: `{words}` is not in\n{said}");
        }
        let _ = write!(page, "\n## {what}\n\n");
        let written = written.join("\n");
        if !written.trim().is_empty() {
            let _ = write!(page, "```toml\n{}\n```\n\n", written.trim_end());
        }
        let _ = write!(page, "```text\n{}\n```\n", said.trim_end());
    }
    let path = root().join("docs/mistakes.md");
    if std::env::var_os("COSIM_WRITE_MISTAKES").is_some() {
        std::fs::write(&path, &page).unwrap();
    }
    let kept = std::fs::read_to_string(&path).unwrap_or_default();
    assert!(kept == page, "docs/mistakes.md is stale; run this test with COSIM_WRITE_MISTAKES=1");
}
