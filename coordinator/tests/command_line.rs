//! The command line of the executable: help, version, and exit code 2 of wrong usage.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use coordinator::cli::parser;
use std::process::{Command, Output};

fn coordinator(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_coordinator")).args(arguments).output().unwrap()
}

fn text(bytes: &[u8]) -> &str {
    std::str::from_utf8(bytes).unwrap()
}

#[test]
fn help_lists_version_and_commands() {
    let version = coordinator(&["--version"]);
    assert!(version.status.success());
    let said =
        text(&version.stdout).strip_prefix(concat!("coordinator ", env!("CARGO_PKG_VERSION")));
    let commit = said.unwrap().trim_end();
    // Where there is a repository, the commit that was built.
    let is_commit = |text: &str| text.len() == 10 && text.chars().all(|c| c.is_ascii_hexdigit());
    let named = commit.strip_prefix(" (").and_then(|rest| rest.strip_suffix(')'));
    assert!(commit.is_empty() || named.is_some_and(is_commit), "{commit}");
    let root = concat!(env!("CARGO_MANIFEST_DIR"), "/..");
    let git = Command::new("git").args(["-C", root, "rev-parse", "HEAD"]).output();
    let is_own = std::path::Path::new(root).join(".git").exists();
    assert_eq!(named.is_some(), is_own && git.is_ok_and(|ended| ended.status.success()));
    let help = coordinator(&["--help"]);
    assert!(help.status.success());
    let all = parser();
    let commands: Vec<&str> = all.get_subcommands().map(clap::Command::get_name).collect();
    assert!(commands.len() > 20, "{commands:?}");
    for command in commands {
        let told =
            text(&help.stdout).lines().any(|line| line.split_whitespace().next() == Some(command));
        assert!(told, "{command} is not in:\n{}", text(&help.stdout));
        assert!(coordinator(&[command, "--help"]).status.success(), "{command} --help");
    }
}

/// The examples of each help are commands that parse, in lines of a terminal.
#[test]
fn every_example_parses() {
    for command in parser().get_subcommands() {
        let help = command.get_after_help().unwrap().to_string();
        let examples: Vec<&str> = help.lines().skip(1).map(str::trim).collect();
        assert!(!examples.is_empty(), "{}", command.get_name());
        for example in examples {
            assert!(example.len() < 80, "{example}");
            let words: Vec<&str> = example.split(' ').collect();
            let name = format!("coordinator {}", command.get_name());
            assert!(example.starts_with(&name), "{example}");
            let parsed = parser().try_get_matches_from(&words);
            assert!(parsed.is_ok(), "{example}: {}", parsed.unwrap_err());
        }
    }
}

/// Wrong usage has exit code 2, names the reason, and prints nothing on standard output.
#[test]
fn wrong_usage_is_an_error() {
    for (arguments, told) in [
        (&[][..], "Usage"),
        (&["run"], "required"),
        (&["rum", "x"], "unrecognized subcommand 'rum'"),
        (&["run", "x", "--set"], "a value is required for '--set"),
        (&["run", "x", "--no-such-option"], "unexpected argument '--no-such-option'"),
        (&["run", "no/such/case.toml"], "no/such/case.toml"),
    ] {
        let ended = coordinator(arguments);
        assert_eq!(ended.status.code(), Some(2), "{arguments:?}");
        assert_eq!(text(&ended.stdout), "", "{arguments:?}");
        let errors = text(&ended.stderr);
        assert!(errors.contains(told), "{arguments:?}: `{told}` is missing in: {errors}");
    }
}
