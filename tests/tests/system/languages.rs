//! Participants in other languages that use the C library: their declarations agree with the
//! header, and a Fortran program gives the same results as one in C.

use crate::c_interface::Compiled;
use crate::harness::snippets::blocks;
use crate::harness::{Place, case, library, root};
use std::collections::BTreeMap;
use std::process::Command;

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

/// Fortran example, compiled as by a user.
fn fortran(folder: &std::path::Path) -> String {
    let (lib, program) = (library().display(), folder.join("solver").display().to_string());
    let mut compiler = Command::new("gfortran");
    compiler.args(["-std=f2018", "-O2", "-Wall", "-Wno-unused-dummy-argument", "-Werror"]);
    compiler.arg("-J").arg(folder);
    compiler.args(["proto/c/include/cosim.f90", "proto/c/examples/short_columns.f90"]);
    compiler.args([format!("-L{lib}"), format!("-Wl,-rpath,{lib}"), "-lcosim".to_owned()]);
    let built = compiler.args(["-o", &program]).current_dir(root()).output();
    let built = built
        .expect("gfortran is needed to test participants in Fortran: apt-get install gfortran");
    assert!(built.status.success(), "{}", String::from_utf8_lossy(&built.stderr));
    program
}

#[test]
fn the_solver_in_fortran_conforms_and_answers_like_the_one_in_c() {
    let folder = tempfile::tempdir().unwrap();
    let program = fortran(folder.path());
    let place = Place::new();
    let arguments = ["conform", "--role", "thermal", "--json", "--", &program];
    let ended = place.start(&arguments).wait();
    assert_eq!(ended.code, Some(0), "{}\n{}", ended.stderr, ended.stdout);
    place.assert_nothing_left();
    let rail = |program: &str| {
        let (place, command) = (Place::new(), format!("thermal.command={:?}", [program]));
        let sets = ["thermal.model=short", "output.fields=all", &command];
        let sets: Vec<&str> = sets.into_iter().flat_map(|set| ["--set", set]).collect();
        place.summary(&case("wheel-rail.toml"), &sets);
        place.field("thermal_passage_000000.vti", "rail_temperature")
    };
    let c = Compiled::from("proto/c/examples/short_columns.c");
    let (expected, found) = (rail(&c.path()), rail(&program));
    let peak = expected.iter().copied().fold(0.0, f64::max);
    let off = expected.iter().zip(&found).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(expected.len() == found.len() && peak > 200.0, "{peak} K");
    assert!(off < 1e-12 * peak, "sums in another order: {off:e} K");
}

#[test]
fn what_the_solver_in_fortran_refuses_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let program = fortran(folder.path());
    // Started directly, without a configuration.
    let ended = Command::new(&program).arg("--estimate").output().unwrap();
    assert_eq!(ended.status.code(), Some(1));
    assert!(String::from_utf8_lossy(&ended.stderr).starts_with("error: "));
    let ended = Command::new(&program).arg("--fly").output().unwrap();
    assert_eq!(ended.status.code(), Some(2), "{}", String::from_utf8_lossy(&ended.stderr));
}
