//! What docs/tutorial.md has people type does what stands under it.

use crate::harness::{programs, root};
use crate::python::interpreter;
use std::fmt::Write;
use std::process::Command;

/// A block of a page: its language, its lines, and whether the page says that it is not run.
struct Block {
    language: String,
    text: String,
    left_out: bool,
}

fn blocks(page: &str) -> Vec<Block> {
    let mut found = Vec::new();
    let mut lines = page.lines();
    let mut before = "";
    while let Some(line) = lines.next() {
        if let Some(language) = line.strip_prefix("```") {
            let mut text = String::new();
            for line in lines.by_ref().take_while(|line| *line != "```") {
                writeln!(text, "{line}").unwrap();
            }
            let left_out = before.starts_with("<!-- not run");
            found.push(Block { language: language.to_owned(), text, left_out });
        }
        before = line;
    }
    found
}

/// Commands in order, in a folder with the project's cases; of the lines that are shown under one each is, from its beginning, in one that it prints.
#[test]
fn the_tutorial_is_true() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["cases", "proto"] {
        std::os::unix::fs::symlink(root().join(name), folder.path().join(name)).unwrap();
    }
    let path = format!("{}:{}", programs().display(), std::env::var("PATH").unwrap());
    let page = std::fs::read_to_string(root().join("docs/tutorial.md")).unwrap();
    let mut said = String::new();
    let (mut commands, mut shown) = (0, 0);
    for Block { language, text, left_out } in blocks(&page) {
        let mut command = match language.as_str() {
            "sh" if !left_out => {
                let mut shell = Command::new("bash");
                shell.args(["-euc", &text]);
                shell
            }
            "python" => {
                let mut python = Command::new(interpreter());
                python.args(["-c", &text]).env("COSIM_COORDINATOR", programs().join("coordinator"));
                python
            }
            "text" => {
                for line in text.lines() {
                    let there = said.lines().any(|printed| printed.starts_with(line));
                    assert!(there, "docs/tutorial.md shows `{line}`, which is not in:\n{said}");
                    shown += 1;
                }
                continue;
            }
            _ => continue,
        };
        let ended = command.current_dir(folder.path()).env("PATH", &path).output().unwrap();
        said = String::from_utf8_lossy(&[ended.stdout, ended.stderr].concat()).into_owned();
        assert!(ended.status.success(), "{text}: {said}");
        commands += 1;
    }
    assert!(commands >= 10 && shown >= 10, "{commands} commands, {shown} lines");
}
