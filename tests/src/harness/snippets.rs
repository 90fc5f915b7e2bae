//! Runs the commands shown on a page, in order, and checks that they print the lines shown below
//! them.
//!
//! A block is skipped if the line before it says so: `<!-- not run: it needs a cluster -->` gives a
//! reason, `<!-- test -->` marks a command run elsewhere by the gate.

use super::{programs, root};
use std::fmt::Write;
use std::os::unix::fs::symlink;
use std::path::Path;
use std::process::Command;

/// Fenced block of a page.
#[derive(Debug)]
pub struct Block {
    /// Language after the opening fence.
    pub language: String,
    /// Content of the block.
    pub text: String,
    /// Reason why the block is not run, if given.
    pub left_out: Option<String>,
}

impl Block {
    /// True for commands that a reader types.
    pub fn is_typed(&self) -> bool {
        matches!(self.language.as_str(), "sh" | "python")
    }
}

/// Returns the blocks of a page of the repository.
pub fn blocks(page: &str) -> Vec<Block> {
    let page = std::fs::read_to_string(root().join(page)).unwrap();
    let mut found = Vec::new();
    let mut lines = page.lines();
    let mut before = "";
    while let Some(line) = lines.next() {
        if let Some(language) = line.strip_prefix("```") {
            let mut text = String::new();
            for line in lines.by_ref().take_while(|line| *line != "```") {
                writeln!(text, "{line}").unwrap();
            }
            let gate = ["<!-- run -->", "<!-- test -->", "<!-- nightly -->"].contains(&before);
            let reason =
                before.strip_prefix("<!-- not run: ").or(gate.then_some("the gate runs it"));
            let left_out = reason.map(|reason| reason.trim_end_matches(" -->").to_owned());
            found.push(Block { language: language.to_owned(), text, left_out });
        }
        before = line;
    }
    found
}

/// Runs the blocks of a page in a copy of the repository's folders. Each line shown below a command
/// must be the start of a printed line. Python is the given interpreter. Returns the number of
/// commands and of lines.
///
/// # Panics
/// Panics if a command fails or does not print a line shown on the page.
pub fn run(page: &str, interpreter: &Path) -> (usize, usize) {
    let folder = tempfile::tempdir().unwrap();
    for name in ["cases", "proto", "docs", "coordinator", "tests"] {
        symlink(root().join(name), folder.path().join(name)).unwrap();
    }
    std::fs::create_dir(folder.path().join("target")).unwrap();
    symlink(programs(), folder.path().join("target/release")).unwrap();
    let python = interpreter.parent().unwrap().display();
    let path = format!("{}:{python}:{}", programs().display(), std::env::var("PATH").unwrap());
    // `None` after a skipped block, whose output is unknown.
    let mut said: Option<String> = None;
    let (mut commands, mut shown) = (0, 0);
    for Block { language, text, left_out } in blocks(page) {
        let mut command = match language.as_str() {
            "sh" | "python" if left_out.is_some() => {
                said = None;
                continue;
            }
            "sh" => Command::new("bash"),
            "python" => Command::new(interpreter),
            "text" => {
                let Some(said) = &said else { continue };
                for line in text.lines() {
                    let there = said.lines().any(|printed| printed.starts_with(line));
                    assert!(there, "{page} shows `{line}`, which is not in:\n{said}");
                    shown += 1;
                }
                continue;
            }
            _ => continue,
        };
        match language.as_str() {
            "sh" => command.args(["-euc", &text]),
            _ => command.args(["-c", &text]),
        };
        command.current_dir(folder.path()).env("PATH", &path);
        command.env("COSIM_COORDINATOR", programs().join("coordinator"));
        let ended = command.output().unwrap();
        let printed = String::from_utf8_lossy(&[ended.stdout, ended.stderr].concat()).into_owned();
        assert!(ended.status.success(), "{page}: {text}: {printed}");
        said = Some(printed);
        commands += 1;
    }
    (commands, shown)
}
