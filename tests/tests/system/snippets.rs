//! Commands on the pages print the output shown below them.

use crate::harness::python::interpreter;
use crate::harness::root;
use crate::harness::snippets::{self, blocks};
use crate::keys::{fits, flatten, known_keys};

/// Pages tested here, each in a test of its own.
const DAILY: [&str; 7] = [
    "docs/install.md",
    "docs/tutorial.md",
    "docs/how-to/swap-a-solver.md",
    "docs/how-to/choose-accuracy.md",
    "docs/how-to/debug-a-coupling.md",
    "docs/how-to/run-on-a-cluster.md",
    "docs/how-to/watch-a-run.md",
];

table_of_tests! {
    is_true:
    install(DAILY[0]);
    the_tutorial(DAILY[1]);
    swap_a_solver(DAILY[2]);
    choose_accuracy(DAILY[3]);
    debug_a_coupling(DAILY[4]);
    run_on_a_cluster(DAILY[5]);
    watch_a_run(DAILY[6]);
}

fn is_true(page: &str) {
    let (commands, _) = snippets::run(page, interpreter());
    assert!(commands > 0, "{page} has no commands");
}

/// Pages of the site, by their paths in the repository.
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

/// Every block of commands is run, here or in a test of another target, or the page says
/// why not.
#[test]
fn every_block_is_run_or_says_why_not() {
    let elsewhere = [include_str!("../nightly/snippets.rs"), include_str!("../external/pages.rs")];
    let mut seen = 0;
    for page in pages() {
        let named = |tests: &&str| tests.contains(&format!("\"{page}\""));
        let run = DAILY.contains(&page.as_str()) || elsewhere.iter().any(named);
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

/// Parts of cases on the pages are valid TOML, and contain only known keys.
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

/// Options of other programs mentioned on their own.
const FOREIGN: [&str; 4] = ["--test", "--lib", "--shm-size", "--time"];

/// Words between single back ticks on a page, outside of blocks, and the commands in its blocks.
fn said(page: &str) -> Vec<String> {
    let text = std::fs::read_to_string(root().join(page)).unwrap();
    let mut words = Vec::new();
    let mut prose = String::new();
    let mut fenced = false;
    for line in text.lines() {
        match line.trim_start().starts_with("```") {
            true => fenced = !fenced,
            false if !fenced => prose += &format!("{line}\n"),
            false => {}
        }
    }
    for paragraph in prose.split("\n\n") {
        let spans = paragraph.split('`').skip(1).step_by(2);
        words.extend(spans.map(|span| span.split_whitespace().collect::<Vec<_>>().join(" ")));
    }
    for block in blocks(page).iter().filter(|block| block.language == "sh") {
        let joined = block.text.replace("\\\n", " ");
        words.extend(joined.lines().map(|line| line.trim().to_owned()));
    }
    words
}

/// Options in the help of a program, or of one of its commands.
fn options_of(program: &str, command: &[&str]) -> Vec<String> {
    let path = crate::harness::programs().join(program);
    let ended = std::process::Command::new(path).args(command).arg("--help").output().unwrap();
    let text = String::from_utf8(ended.stdout).unwrap();
    let words = text.split(|c: char| c.is_whitespace() || "[]<>,;:()`.'=".contains(c));
    words.filter(|word| word.len() > 2 && word.starts_with("--")).map(str::to_owned).collect()
}

/// Options shown with a command belong to that command; an option on its own belongs to some
/// command.
#[test]
fn options_on_the_pages_exist() {
    const PROGRAMS: [&str; 6] = [
        "coordinator",
        "cosim-relay",
        "fmu-participant",
        "mech-solver",
        "precice-participant",
        "thermal-solver",
    ];
    let mut known: Vec<String> = PROGRAMS.iter().flat_map(|name| options_of(name, &[])).collect();
    let help = crate::harness::Place::new().start(&["--help"]).wait().stdout;
    let first = |line: &str| Some(line.strip_prefix("  ")?.split_whitespace().next()?.to_owned());
    let is_command = |word: &String| word.chars().all(|c| c.is_ascii_lowercase() || c == '-');
    let commands: Vec<String> = help
        .lines()
        .filter_map(first)
        .filter(|word| is_command(word) && !word.starts_with('-'))
        .collect();
    assert!(commands.len() > 20, "{commands:?}");
    let own: Vec<(String, Vec<String>)> = commands
        .into_iter()
        .map(|name| {
            let options = options_of("coordinator", &[&name]);
            (name, options)
        })
        .collect();
    known.extend(own.iter().flat_map(|(_, options)| options.clone()));
    let mut seen = 0;
    for page in pages().iter().filter(|page| *page != "CHANGELOG.md") {
        for span in said(page) {
            let words: Vec<&str> = span.split_whitespace().collect();
            let at = words.iter().position(|word| {
                let name = word.rsplit('/').next().unwrap();
                word.starts_with("--") || PROGRAMS.contains(&name)
            });
            // Options of other programs are skipped.
            let Some(0) = at else { continue };
            let of = words.get(1).and_then(|word| own.iter().find(|(name, _)| name == word));
            let known = match of {
                Some((_, options)) if words[0].ends_with("coordinator") => options,
                _ => &known,
            };
            // Words after `--` or a comment mark are not options of the command.
            let options =
                words.iter().take_while(|word| !["--", "#", "|", "||", "&&"].contains(word));
            for option in options.filter(|word| word.starts_with("--")) {
                let option = option.split(['=', ',', ';', ':', '…', ')']).next().unwrap();
                assert!(
                    known.iter().any(|one| one == option) || FOREIGN.contains(&option),
                    "{page}: `{option}` of `{span}` is no option"
                );
                seen += 1;
            }
        }
    }
    assert!(seen > 100, "{seen} options");
}

/// A dotted key on a page is a key of a case, the start of one, or a figure.
#[test]
fn keys_on_the_pages_exist() {
    let known = known_keys();
    let figures = crate::harness::Place::new().start(&["figures", "--json"]).wait().stdout;
    let figures: serde_json::Value = serde_json::from_str(&figures).unwrap();
    let figures: Vec<String> = figures
        .as_array()
        .unwrap()
        .iter()
        .map(|one| one["key"].as_str().unwrap().to_owned())
        .collect();
    let effects = crate::harness::Place::new().start(&["solvers"]).wait().stdout;
    let effects: std::collections::BTreeSet<&str> = effects.split_whitespace().collect();
    let roots: Vec<&str> = known.iter().map(|key| key.split('.').next().unwrap()).collect();
    let begins = |known: &str, key: &str| {
        let count = key.split('.').count();
        let part: Vec<&str> = known.split('.').take(count).collect();
        part.len() == count && (fits(&part.join("."), key) || part.join(".") == key)
    };
    let mut seen = 0;
    let current = |page: &&String| !page.ends_with("mistakes.md") && *page != "CHANGELOG.md";
    for page in pages().iter().filter(current) {
        for span in said(page) {
            for word in span.split_whitespace() {
                let key = word.split(['=', ':', ',', ';', '[', '{']).next().unwrap();
                let is_key = key.contains('.')
                    && roots.contains(&key.split('.').next().unwrap())
                    && key.split('.').all(|part| {
                        !part.is_empty()
                            && part.chars().all(|c| c.is_ascii_alphanumeric() || "_-*".contains(c))
                    });
                let is_file =
                    [".toml", ".csv", ".md", ".rs", ".json", ".py", ".h", ".mcap", ".fmu"]
                        .iter()
                        .any(|ending| key.ends_with(ending));
                // Other programs have keys of their own; words in capitals are placeholders.
                let is_foreign = span.contains(".command=") || key == "ROLE.NAME";
                if !is_key || is_file || is_foreign {
                    continue;
                }
                let effect = key.strip_prefix("effects.");
                let is_effect = effect.is_some_and(|name| effects.contains(name));
                let there = is_effect || known.iter().chain(&figures).any(|one| begins(one, key));
                assert!(there, "{page}: `{key}` is neither a key nor a figure");
                seen += 1;
            }
        }
    }
    assert!(seen > 100, "{seen} keys");
}
