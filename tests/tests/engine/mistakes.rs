//! Common mistakes in a case and the messages about them: `mistakes.toml`, and docs/mistakes.md
//! generated from it.

use crate::harness::{checked, root};
use std::fmt::Write as _;

/// An error as `check` prints it.
struct Told<'a> {
    /// Key and reason, behind the place.
    what: &'a str,
    /// Line of the case, counted from 0, and the marked part of it in characters.
    place: Option<(usize, std::ops::Range<usize>)>,
    fix: &'a str,
}

/// Returns the errors of a message with their fixes.
fn errors(said: &str) -> Vec<Told<'_>> {
    let mut errors = Vec::new();
    for part in said.split("error: case.toml").skip(1) {
        let lines: Vec<&str> = part.lines().collect();
        let Some(fix) = lines.iter().find_map(|line| line.strip_prefix("  fix: ")) else {
            continue;
        };
        let (at, what) = lines[0].split_once(": ").unwrap();
        let mut numbers = at.split(':').filter_map(|number| number.parse::<usize>().ok());
        let place = numbers.next().zip(numbers.next()).map(|(line, column)| {
            let width = lines[2].chars().filter(|c| *c == '^').count();
            (line - 1, column - 1..column - 1 + width)
        });
        errors.push(Told { what, place, fix });
    }
    errors
}

/// A case of which single lines are changed.
struct Lines(Vec<String>);

impl Lines {
    fn of(case: &str) -> Self {
        Self(case.lines().map(str::to_owned).collect())
    }

    /// Writes lines into a section, which is added if there is none.
    fn add(mut self, section: &str, lines: &[&str]) -> String {
        let header = format!("[{section}]");
        let at = self.0.iter().position(|line| line.trim_start().starts_with(&header));
        let at = at.unwrap_or_else(|| {
            self.0.push(header);
            self.0.len() - 1
        });
        self.0.splice(at + 1..at + 1, lines.iter().map(|line| (*line).to_owned()));
        self.0.join("\n")
    }

    fn write(mut self, line: usize, text: String) -> String {
        self.0[line] = text;
        self.0.join("\n")
    }

    /// Writes `text` in place of the marked part of a line.
    fn replace(self, (line, marked): &(usize, std::ops::Range<usize>), text: &str) -> String {
        let letters: Vec<char> = self.0[*line].chars().collect();
        let [before, after] =
            [&letters[..marked.start], letters.get(marked.end..).unwrap_or_default()]
                .map(|part| part.iter().collect::<String>());
        self.write(*line, format!("{before}{text}{after}"))
    }
}

/// Returns the parts of a text between two marks.
fn between(text: &str, mark: char) -> Vec<&str> {
    text.split(mark).skip(1).step_by(2).collect()
}

/// Follows the advice of an error as it is written. Returns the changed cases, one for each
/// alternative; none if the advice leaves a choice to the reader ("lower the load").
fn follow(case: &str, Told { place, fix, .. }: &Told<'_>) -> Vec<String> {
    let lines = || Lines::of(case);
    let section = |text: &str| {
        text.split_once('[')
            .and_then(|(_, rest)| rest.split_once(']'))
            .map(|(name, _)| name.to_owned())
    };
    let mut cases = Vec::new();
    let (first, add) = match fix.split_once("add [") {
        Some((first, add)) => (first, Some(add)),
        None => (*fix, None),
    };
    if let Some((name, values)) = add.and_then(|add| add.split_once("] with ")) {
        let values = between(values, '`');
        match fix.contains("with one of") {
            true => cases.extend(values.iter().map(|value| lines().add(name, &[value]))),
            false if !values.is_empty() => cases.push(lines().add(name, &values)),
            false => {}
        }
    }
    if let Some((values, name)) = first.strip_prefix("add ").and_then(|add| add.split_once(" to ["))
    {
        let name = name.trim_end_matches(']');
        cases.extend(between(values, '`').iter().map(|value| lines().add(name, &[value])));
    }
    if let Some(models) = first.strip_prefix("set mech.model to ") {
        let line = case.lines().position(|line| line.starts_with("model = ")).unwrap();
        let written = between(models, '"').into_iter().map(|model| format!("model = \"{model}\""));
        cases.extend(written.map(|written| lines().write(line, written)));
    }
    let Some(place) = place else { return cases };
    let (line, marked) = place;
    let old: String =
        case.lines().nth(*line).unwrap().chars().skip(marked.start).take(marked.len()).collect();
    let removed =
        ["remove it", "keep exactly one", "keep one"].iter().any(|word| first.starts_with(word));
    let clause = first.split([';']).next().unwrap();
    if removed {
        cases.push(lines().write(*line, String::new()));
    } else if first.starts_with("put the text in quotes") {
        cases.push(lines().replace(place, &format!("\"{}\"", old.trim_matches(['“', '”']))));
    } else if let Some(expected) = first.strip_prefix("TOML expects ") {
        cases.push(lines().replace(place, between(expected, '`')[0]));
    } else if let Some((_, example)) = clause.split_once("for example ") {
        cases.push(lines().replace(place, example));
    } else if let Some(key) = clause.strip_prefix("write `") {
        let key = key.trim_end_matches('`');
        let (name, key) = key.rsplit_once('.').unwrap();
        let written = Lines::of(&lines().replace(place, key)).0[*line].clone();
        let without = lines().write(*line, String::new());
        cases.push(Lines::of(&without).add(name, &[&written]));
    } else if let Some(name) =
        section(clause).filter(|name| clause.starts_with("write") && !name.contains("NAME"))
    {
        cases.push(lines().write(*line, format!("[{name}]")));
    } else if clause.starts_with("write \"") {
        let words = between(clause, '"').into_iter().map(|word| format!("\"{word}\""));
        cases.extend(words.map(|word| lines().replace(place, &word)));
    } else if let Some(number) = clause
        .strip_prefix("write ")
        .and_then(|rest| rest.split(',').next())
        .filter(|word| word.parse::<f64>().is_ok())
    {
        cases.push(lines().replace(place, number));
    }
    cases
}

/// Asserts that every alternative of every advice removes its error. Returns the number of advices
/// that were followed.
fn assert_followed(what: &str, case: &str, said: &str) -> usize {
    let mut count = 0;
    for told in errors(said) {
        let mended = follow(case, &told);
        count += usize::from(!mended.is_empty());
        for mended in mended {
            let ended = checked("case.toml", &mended);
            let again = [ended.stdout, ended.stderr].concat();
            let same = again.contains(&format!(": {}\n", told.what));
            assert!(
                !same,
                "{what}: `{}` is followed, and the error stays\n{again}\n{mended}",
                told.fix
            );
        }
    }
    count
}

/// Every mistake is reported with place, reason and fix. The page quotes the message exactly.
/// Advice that is followed as it stands removes the error.
/// `COSIM_WRITE_MISTAKES=1` writes the page.
#[test]
fn every_mistake_is_told() {
    let base = std::fs::read_to_string(root().join("cases/wheel-rail.toml")).unwrap();
    let list: toml::Table = include_str!("mistakes.toml").parse().unwrap();
    let mut page = String::from(
        "# Mistakes in a case, and what is said of them\n\nEach mistake is an edit of `cases/wheel-rail.toml`; \
         the answer is that of `coordinator check`. A test (`tests/tests/engine/mistakes.rs`) makes them all and writes \
         this page. `check` names all errors of a case at once.\n",
    );
    let all = list["mistake"].as_array().unwrap();
    assert!(all.len() >= 50, "{}", all.len());
    let mut followed = 0;
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
        followed += assert_followed(what, &case, &said);
        let _ = write!(page, "\n## {what}\n\n");
        let written = written.join("\n");
        if !written.trim().is_empty() {
            let _ = write!(page, "```toml\n{}\n```\n\n", written.trim_end());
        }
        let _ = write!(page, "```text\n{}\n```\n", said.trim_end());
    }
    assert!(followed >= 49, "{followed}");
    let path = root().join("docs/mistakes.md");
    if std::env::var_os("COSIM_WRITE_MISTAKES").is_some() {
        std::fs::write(&path, &page).unwrap();
    }
    let kept = std::fs::read_to_string(&path).unwrap_or_default();
    assert!(kept == page, "docs/mistakes.md is stale; run this test with COSIM_WRITE_MISTAKES=1");
}
