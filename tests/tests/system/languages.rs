//! Participants in other languages that use the C library: their declarations agree with the
//! header.

use crate::harness::root;
use crate::harness::snippets::blocks;
use std::collections::BTreeMap;

fn read(file: &str) -> String {
    std::fs::read_to_string(root().join(file)).unwrap()
}

/// Header without comments.
fn header() -> String {
    let mut text = String::new();
    for part in read("proto/c/include/cosim.h").split("/*") {
        text += part.split_once("*/").map_or(part, |(_, code)| code);
    }
    text
}

/// Returns the text up to the closing bracket; `text` starts after the opening one.
fn enclosed(text: &str) -> &str {
    let mut depth = 1;
    let end = text.find(|c: char| {
        depth += match c {
            '(' | '{' => 1,
            ')' | '}' => -1,
            _ => 0,
        };
        depth == 0
    });
    &text[..end.expect("brackets are closed")]
}

/// Splits at commas outside of brackets.
fn parts(list: &str) -> Vec<&str> {
    let mut depth = 0;
    let split = |c: char| {
        depth += match c {
            '(' | '{' | '[' => 1,
            ')' | '}' | ']' => -1,
            _ => 0,
        };
        c == ',' && depth == 0
    };
    list.split(split).map(str::trim).filter(|part| !part.is_empty()).collect()
}

/// Words that start with `cosim_` and are followed by a bracket, with the parts inside.
fn calls<'a>(text: &'a str, before: &str) -> Vec<(&'a str, Vec<&'a str>)> {
    let start = format!("{before}cosim_");
    let found = text.match_indices(&start).filter_map(|(at, _)| {
        let rest = &text[at + before.len()..];
        let end = rest.find(|c: char| !c.is_ascii_alphanumeric() && c != '_')?;
        let (name, rest) = rest.split_at(end);
        Some((name, parts(enclosed(rest.strip_prefix('(')?))))
    });
    found.collect()
}

/// Functions of the header, with the number of their arguments.
fn functions() -> BTreeMap<String, usize> {
    let text = header();
    let calls = calls(&text, "");
    calls.into_iter().map(|(name, arguments)| (name.to_owned(), arguments.len())).collect()
}

/// Name declared by a C declaration: `double origin[3]`, `int (*build)(void *user)`.
fn declared(member: &str) -> String {
    let named = member
        .split_once("(*")
        .map_or(member, |(_, rest)| rest.split_once(')').expect("a name is in the bracket").0);
    let named = named.split('[').next().unwrap_or_default();
    named.rsplit(|c: char| !c.is_ascii_alphanumeric() && c != '_').next().unwrap().to_owned()
}

/// Members of a structure of the header, in order.
fn members(name: &str) -> Vec<String> {
    let text = header();
    let body =
        text.split_once(&format!("typedef struct {name} {{")).expect("it is in the header").1;
    enclosed(body).split(';').map(str::trim).filter(|m| !m.is_empty()).map(declared).collect()
}

#[test]
fn the_module_of_fortran_is_the_header() {
    let text = read("proto/c/include/cosim.f90");
    let known = functions();
    let mut count = 0;
    for line in text.lines().filter(|line| line.contains("bind(c) result(")) {
        let (name, arguments) = calls(line, "function ").pop().expect("it is a function");
        assert_eq!(known.get(name), Some(&arguments.len()), "{name}");
        count += 1;
    }
    assert!(count > 25, "{count} functions");
    for name in ["cosim_step", "cosim_report", "cosim_grid", "cosim_solver"] {
        let begin = format!("type, bind(c) :: {name}\n");
        let body =
            text.split_once(&begin).expect("it is there").1.split("end type").next().unwrap();
        let names = body.lines().filter_map(|line| line.split_once("::")).flat_map(|(_, list)| {
            let name = |one: &str| one.split(['=', '(']).next().unwrap().trim().to_owned();
            parts(list).into_iter().map(name).collect::<Vec<_>>()
        });
        assert_eq!(names.collect::<Vec<_>>(), members(name), "{name}");
    }
}

#[test]
fn what_is_written_in_julia_is_the_header() {
    let page = blocks("proto/c/README.md");
    let block = page.iter().find(|block| block.language == "julia").expect("it is on the page");
    assert!(block.left_out.is_some(), "the page says that it is not run");
    let (known, text) = (functions(), &block.text);
    let calls = calls(text, "LIB.");
    assert!(calls.len() >= 10 && calls.len() == text.matches("@ccall").count(), "{calls:?}");
    for (name, arguments) in calls {
        assert_eq!(known.get(name), Some(&arguments.len()), "{name}");
        assert!(arguments.iter().all(|one| one.contains("::")), "{name}: {arguments:?}");
    }
    for (name, of) in
        [("Grid", "cosim_grid"), ("Report", "cosim_report"), ("Solver", "cosim_solver")]
    {
        let begin = format!("struct {name}\n");
        let body = text.split_once(&begin).expect("it is there").1.split("\nend").next().unwrap();
        let names = body.lines().map(|line| line.split("::").next().unwrap().trim().to_owned());
        assert_eq!(names.collect::<Vec<_>>(), members(of), "{name}");
    }
}

/// Checks that [`header`] and [`functions`] find declarations.
#[test]
fn the_header_is_read() {
    let known = functions();
    assert_eq!(
        (known["cosim_main"], known["cosim_fail"], known["cosim_layout_left_out"]),
        (4, 1, 4)
    );
    assert_eq!(members("cosim_step"), ["window", "iteration", "start", "end"]);
}
