//! The style of docs/style.md, as far as a program can check it: openings of doc comments, empty
//! phrases, line lengths, and lengths of sentences in pages.

use super::paths::files;
use std::collections::BTreeMap;
use std::fmt::Write as _;
use tests::harness::root;

/// Words that do not open a doc comment: a noun or a verb names the thing at once.
const OPENINGS: [&str; 10] =
    ["What", "That", "Those", "Of", "How", "Whose", "Its", "Which", "Where", "There"];
/// Phrases that a reader has to decode.
const PHRASES: [&str; 6] =
    ["is told", "are told", "nought", "See there", "There are none", "but for rounding"];
/// Longest line of a comment or a page.
const COLUMNS: usize = 100;
/// Most words of a sentence in a page.
const WORDS: usize = 40;
/// Pages that a command writes.
const GENERATED: [&str; 9] = [
    "docs/case.md",
    "docs/fields.md",
    "docs/figures.md",
    "docs/limits.md",
    "docs/measured.md",
    "docs/mistakes.md",
    "docs/models.md",
    "docs/paper-elements.md",
    "docs/paper.md",
];
/// Findings that were there when the check was made, by file. A number may only fall.
const EXCEPTIONS: [(&str, usize); 0] = [];

/// A finding, with its line.
type Finding = (usize, String);

/// Comments of a source file: those of documentation with `true`, and the first line of each.
fn of_source(text: &str) -> Vec<Finding> {
    let mut found = Vec::new();
    let mut inside = false;
    for (number, line) in text.lines().enumerate().map(|(n, line)| (n + 1, line)) {
        let line = line.trim_start();
        let doc = line.strip_prefix("///").or_else(|| line.strip_prefix("//!"));
        let comment = doc.or_else(|| line.strip_prefix("//"));
        let Some(comment) = comment else {
            inside = false;
            continue;
        };
        let words = comment.trim();
        let first = words.split(|c: char| !c.is_alphanumeric()).next().unwrap_or_default();
        let how_to = words.starts_with("How to ");
        if doc.is_some() && !inside && OPENINGS.contains(&first) && !how_to {
            found.push((number, format!("a doc comment opens with `{first}`")));
        }
        inside = doc.is_some();
        found.extend(phrases(words).map(|phrase| (number, format!("`{phrase}`"))));
    }
    found
}

fn phrases(line: &str) -> impl Iterator<Item = &'static str> {
    PHRASES.into_iter().filter(move |phrase| line.contains(phrase))
}

/// Comment lines that are too long. Code, rows of tables, and lines of one word cannot be broken.
fn long_comments(text: &str) -> Vec<Finding> {
    let mut found = Vec::new();
    let mut code = false;
    for (n, line) in text.lines().enumerate() {
        let Some(comment) = line.trim_start().strip_prefix("//") else { continue };
        let words = comment.trim_start_matches(['/', '!']).trim();
        if words.starts_with("```") {
            code = !code;
        }
        let breakable = !code && !words.starts_with('|') && words.contains(' ');
        let length = line.chars().count();
        if length > COLUMNS && breakable {
            found.push((n + 1, format!("{length} columns")));
        }
    }
    found
}

/// Phrases, long lines and long sentences of a page. Tables, code and comments are left out.
fn of_page(text: &str) -> Vec<Finding> {
    let mut found = Vec::new();
    let mut paragraph: Option<(usize, String)> = None;
    let mut code = false;
    for (number, line) in text.lines().chain([""]).enumerate().map(|(n, line)| (n + 1, line)) {
        if line.trim_start().starts_with("```") {
            code = !code;
        }
        let plain = line.trim_start();
        let special = code || plain.starts_with(['|', '<', '#', '!']) || plain.starts_with("```");
        let item = ["- ", "* "].iter().any(|mark| plain.starts_with(mark))
            || plain.split_once(". ").is_some_and(|(head, _)| head.parse::<u32>().is_ok());
        if special || plain.is_empty() || item {
            found.extend(paragraph.take().into_iter().flat_map(|(n, text)| sentences(n, &text)));
        }
        if special || plain.is_empty() {
            continue;
        }
        let length = line.chars().count();
        if length > COLUMNS && plain.contains(' ') && !plain.contains("](") {
            found.push((number, format!("{length} columns")));
        }
        found.extend(phrases(line).map(|phrase| (number, format!("`{phrase}`"))));
        let (_, text) = paragraph.get_or_insert_with(|| (number, String::new()));
        let _ = write!(text, "{plain} ");
    }
    found
}

/// Sentences that are too long.
fn sentences(line: usize, paragraph: &str) -> Vec<Finding> {
    let ends = [". ", ".) ", "? ", "! ", ": ", "; "];
    let mut rest = paragraph;
    let mut found = Vec::new();
    while !rest.is_empty() {
        let end = ends.iter().filter_map(|end| Some(rest.find(end)? + end.len())).min();
        let (sentence, others) = rest.split_at(end.unwrap_or(rest.len()));
        let words = sentence.split_whitespace().filter(|word| word.contains(char::is_alphabetic));
        let count = words.count();
        if count > WORDS {
            let start: String = sentence.chars().take(60).collect();
            found.push((line, format!("a sentence of {count} words: {start}…")));
        }
        rest = others;
    }
    found
}

fn findings(path: &str, text: &str) -> Vec<Finding> {
    match path.rsplit_once('.') {
        // This file quotes what it looks for.
        Some(_) if path.ends_with("architecture/prose.rs") => Vec::new(),
        Some((_, "rs")) => of_source(text).into_iter().chain(long_comments(text)).collect(),
        Some((_, "md")) if !GENERATED.contains(&path) && !path.contains("changelog/") => {
            of_page(text)
        }
        _ => Vec::new(),
    }
}

#[test]
fn comments_and_pages_keep_the_style() {
    let mut allowed: BTreeMap<&str, usize> = EXCEPTIONS.into_iter().collect();
    let mut wrong = String::new();
    for path in files() {
        let Ok(text) = std::fs::read_to_string(root().join(&path)) else { continue };
        let found = findings(&path, &text);
        let most = allowed.remove(path.as_str()).unwrap_or(0);
        if found.len() < most {
            let _ = writeln!(wrong, "{path}: {} findings, {most} in EXCEPTIONS", found.len());
        }
        if found.len() > most {
            found.iter().for_each(|(line, what)| _ = writeln!(wrong, "{path}:{line}: {what}"));
        }
    }
    allowed.keys().for_each(|path| _ = writeln!(wrong, "{path}: not a file"));
    assert!(wrong.is_empty(), "see docs/style.md:\n{wrong}");
}

#[test]
fn every_rule_can_fail() {
    let source = "/// What it is.\n/// How, of a second line, is no opening.\nfn f() {}\n\
                  // A thing of which nothing is told.\n";
    let found: Vec<usize> = of_source(source).into_iter().map(|(line, _)| line).collect();
    assert_eq!(found, [1, 4]);
    let long = format!("    // {}\n    // {}\n", "word ".repeat(20), "x".repeat(120));
    assert_eq!(long_comments(&long).len(), 1);
    let words = "word ".repeat(WORDS);
    let page = format!(
        "{}one.\nAnd short. There are none.\n\n| {words} {words} |\n",
        words.replace("word word word word word ", "word word word word\nword ")
    );
    let found: Vec<String> = of_page(&page).into_iter().map(|(_, what)| what).collect();
    assert_eq!(found.len(), 2, "{found:?}");
}

/// Messages show numbers through `readable`: `7.896 mm`, not `7.896e-3 m`. A text that is parsed
/// again is no message, nor is one of a test.
#[test]
fn messages_have_readable_numbers() {
    let mut wrong = String::new();
    for path in files().into_iter().filter(|path| path.ends_with(".rs") && !path.contains("test")) {
        let Ok(text) = std::fs::read_to_string(root().join(&path)) else { continue };
        let code = text.split("#[cfg(test)]").next().unwrap_or_default();
        for (number, line) in code.lines().enumerate() {
            let scientific = line.split('{').skip(1).any(|rest| {
                let field = rest.split('}').next().unwrap_or_default();
                field.split_once(":.").is_some_and(|(_, digits)| digits.ends_with('e'))
            });
            if scientific && !line.contains(".parse") {
                let _ = writeln!(wrong, "{path}:{}: {}", number + 1, line.trim());
            }
        }
    }
    assert!(wrong.is_empty(), "use tables::readable:\n{wrong}");
}
