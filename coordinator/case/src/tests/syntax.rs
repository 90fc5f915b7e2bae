//! Malformed text: broken TOML, duplicate keys, other bytes, deep nesting.

use super::lines;
use crate::{Place, RawCase};

fn errors(text: &str) -> Vec<String> {
    lines(&RawCase::parse("case.toml", text).expect_err(text))
}

#[test]
fn several_errors_of_syntax_are_reported_at_once() {
    assert_eq!(
        errors("[a]\nx = 1\nx = 2\ny =\nw = steel\n[a]\n[b\nz = \"1\n"),
        [
            "3:1 : invalid TOML: duplicate key | keep one of the two",
            "4:4 : invalid TOML: no value after the `=` | write a value",
            "5:5 : invalid TOML: string values must be quoted | put the text in quotes",
            "6:2 : invalid TOML: duplicate key | keep one of the two",
            "7:3 : invalid TOML: unclosed table | TOML expects `]` here",
        ]
    );
}

#[test]
fn a_file_that_is_no_text_says_where() {
    let error = RawCase::parse_bytes("case.toml", b"a = 1\nb = \"\xff\xfe\"\n").unwrap_err();
    assert_eq!(lines(&error), ["2:6 : byte 11 (0xff) is not UTF-8 | save the file as UTF-8 text"]);
}

#[test]
fn a_file_that_is_not_there_is_named() {
    let error = RawCase::read(std::path::Path::new("no/such/case.toml")).unwrap_err();
    let problem = &error.list()[0];
    assert_eq!(problem.place, Place::Case { path: "no/such/case.toml".into() });
    assert!(problem.reason.starts_with("cannot be read: "), "{}", problem.reason);
    assert!(RawCase::read(std::path::Path::new(".")).is_err(), "a folder is not a case");
}

#[test]
fn a_huge_file_is_refused() {
    let error = RawCase::parse("case.toml", &"#".repeat(2 << 20)).unwrap_err();
    assert_eq!(lines(&error), ["case.toml : is larger than 1 MiB | name a case file"]);
}

#[test]
fn deep_nesting_is_an_error_and_no_overflow() {
    let dotted = vec!["a"; 79].join(".");
    let braces = format!("{{ {dotted} = ").repeat(78);
    let deep = [
        format!("x = {}", "[".repeat(100_000)),
        format!("x = {}", "{ a = ".repeat(100_000)),
        format!("{} = 1", vec!["a"; 100_000].join(".")),
        format!("[{}]", vec!["a"; 100_000].join(".")),
        format!("x = {}1{}", "[".repeat(70), "]".repeat(70)),
        format!("[{dotted}]\n{dotted} = {braces}1{}", "}".repeat(78)),
    ];
    for text in deep {
        let error = RawCase::parse("case.toml", &text).expect_err("nested too deeply");
        assert!(!error.list().is_empty());
        let mut raw = RawCase::parse("case.toml", "").unwrap();
        let value = text.split_once('=').map_or(text.as_str(), |(_, value)| value);
        let set = raw.set(&format!("x={value}"));
        match value {
            // The nesting of this assignment was in its key.
            " 1" => assert!(set.is_ok() && raw.text().contains("x = 1"), "{}", raw.text()),
            _ => assert!(set.is_err() && !raw.has("x"), "{value:.40}"),
        }
    }
    let mut raw = RawCase::parse("case.toml", "").unwrap();
    assert!(raw.set(&format!("{dotted}=1")).is_err());
}

#[test]
fn participants_are_seen_before_anything_is_validated() {
    let text = "[mech]\n[time]\nmodel = 3\n[track]\nmodel = \"t\"\n[python]\nattach = true\n\
                command = [\"python3\", \"a.py\"]\n[odd]\ncommand = \"x\"\n[plain]\na = 1\n";
    let found = RawCase::parse("case.toml", text).unwrap().participants();
    let roles: Vec<&str> = found.iter().map(|p| p.role.as_str()).collect();
    assert_eq!(roles, ["mech", "track", "python", "odd"]);
    let python = &found[2];
    assert_eq!(python.command.as_deref(), Some(&["python3".to_owned(), "a.py".to_owned()][..]));
    assert!(python.attach && python.model.is_none());
    assert_eq!(python.place.to_string(), "case.toml:8:11");
    assert_eq!((found[3].command.as_ref(), found[1].model.as_deref()), (None, Some("t")));
    assert_eq!(found[0].place.to_string(), "case.toml:1:1");
}
