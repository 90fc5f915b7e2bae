//! Paths in back ticks, in pages and in comments, lead to a file or a folder of this project.

use std::collections::BTreeSet;
use std::path::{Component, Path, PathBuf};
use std::process::Command;
use tests::harness::root;

/// Files whose text is followed.
const READ: [&str; 7] = ["md", "rs", "py", "c", "h", "toml", "f90"];
/// A path that ends like this is of a source.
const SOURCES: [&str; 9] = ["md", "rs", "py", "c", "h", "toml", "f90", "sh", "ipynb"];
/// Folders of what a user or a build makes: results, FMUs, executables.
const MADE: [&str; 4] = ["results", "fields", "resources", "target"];
/// Fragments of the history speak of the files of their time.
const HISTORY: [&str; 2] = ["docs/changelog/", "CHANGELOG.md"];

/// The files of the project: those that are in its repository, or would be.
fn files() -> Vec<String> {
    let listed = Command::new("git")
        .args(["ls-files", "--cached", "--others", "--exclude-standard"])
        .current_dir(root())
        .output();
    let listed = listed.ok().filter(|ended| ended.status.success()).map(|ended| ended.stdout);
    match listed {
        Some(bytes) => String::from_utf8(bytes).unwrap().lines().map(str::to_owned).collect(),
        // An archive of the sources has no repository.
        None => below(&root(), &root()),
    }
}

fn below(folder: &Path, root: &Path) -> Vec<String> {
    let hidden = |path: &PathBuf| {
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        (name.starts_with('.') && name != ".cargo") || MADE.contains(&name.as_str())
    };
    let entries = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let (folders, files): (Vec<_>, Vec<_>) =
        entries.filter(|path| !hidden(path)).partition(|path| path.is_dir());
    let own = files.iter().map(|path| path.strip_prefix(root).unwrap().display().to_string());
    own.chain(folders.iter().flat_map(|folder| below(folder, root))).collect()
}

/// Every file, and every folder that has one.
fn places(files: &[String]) -> BTreeSet<&Path> {
    files.iter().flat_map(|file| Path::new(file).ancestors()).collect()
}

/// The pieces of a line that stand in back ticks.
fn quoted(line: &str) -> impl Iterator<Item = &str> {
    line.split('`').skip(1).step_by(2)
}

/// A text that is meant as a path of this project.
fn is_path(text: &str, top: &BTreeSet<&str>) -> bool {
    let plain = |c: char| c.is_ascii_alphanumeric() || "._-/".contains(c);
    if !text.chars().all(plain) || text.starts_with(['/', '.', '-']) {
        return false;
    }
    let ending = Path::new(text).extension().and_then(|ending| ending.to_str());
    match text.split_once('/') {
        Some((first, _)) if MADE.contains(&first) => false,
        Some((first, _)) => top.contains(first) || ending.is_some_and(|e| SOURCES.contains(&e)),
        // A single word: users have files with the other endings.
        None => ending == Some("rs") && text.len() > ".rs".len(),
    }
}

/// A part of a path that stands for any name: `NAME.rs`, `SOLVER`.
fn is_placeholder(part: &str) -> bool {
    let stem = part.split('.').next().unwrap_or_default();
    stem.len() > 1 && stem.chars().all(|c| c.is_ascii_uppercase())
}

/// The place ends with this path, in which a placeholder fits any name of the same ending.
fn fits(place: &Path, path: &[&str]) -> bool {
    let parts: Vec<&str> = place.components().map(of_component).collect();
    let ending = |part: &str| part.split_once('.').map(|(_, ending)| ending.to_owned());
    let same = |(one, part): (&&str, &&str)| match is_placeholder(part) {
        true => ending(part).is_none() || ending(part) == ending(one),
        false => one == part,
    };
    parts.len() >= path.len() && parts[parts.len() - path.len()..].iter().zip(path).all(same)
}

fn of_component(component: Component<'_>) -> &str {
    component.as_os_str().to_str().unwrap()
}

#[test]
fn every_path_in_back_ticks_exists() {
    let files = files();
    let places = places(&files);
    let top: BTreeSet<&str> =
        files.iter().filter_map(|file| file.split_once('/')).map(|(first, _)| first).collect();
    let read = |file: &&String| {
        let ending = Path::new(file).extension().and_then(|ending| ending.to_str());
        ending.is_some_and(|ending| READ.contains(&ending))
            && !HISTORY.iter().any(|past| file.starts_with(past))
    };
    let (mut followed, mut astray) = (0, Vec::new());
    for file in files.iter().filter(read) {
        let text = std::fs::read_to_string(root().join(file)).unwrap_or_default();
        for (number, line) in text.lines().enumerate() {
            for path in quoted(line).filter(|text| is_path(text, &top)) {
                followed += 1;
                let parts: Vec<&str> = path.split('/').filter(|part| !part.is_empty()).collect();
                if !places.iter().any(|place| fits(place, &parts)) {
                    astray.push(format!("{file}:{}: {path}", number + 1));
                }
            }
        }
    }
    assert!(astray.is_empty(), "there is no such file:\n{}", astray.join("\n"));
    assert!(followed > 300, "only {followed} paths were found");
}

/// The targets of the links and pictures of a page in Markdown.
fn targets(text: &str) -> impl Iterator<Item = &str> {
    text.split("](").skip(1).filter_map(|rest| rest.split_once([')', '\n']).map(|(to, _)| to))
}

#[test]
fn every_link_of_a_page_leads_to_a_file() {
    let files = files();
    let pages = files.iter().filter(|file| file.ends_with(".md"));
    let (mut followed, mut astray) = (0, Vec::new());
    for file in pages.filter(|file| !HISTORY.iter().any(|past| file.starts_with(past))) {
        let text = std::fs::read_to_string(root().join(file)).unwrap_or_default();
        let folder = root().join(file).parent().unwrap().to_owned();
        for target in targets(&text) {
            let path = target.split('#').next().unwrap_or_default();
            // Another site, this very page, or a formula.
            if path.is_empty() || path.contains([':', ' ', '*', ',']) {
                continue;
            }
            followed += 1;
            if !folder.join(path).exists() {
                astray.push(format!("{file}: {target}"));
            }
        }
    }
    assert!(astray.is_empty(), "there is no such file:\n{}", astray.join("\n"));
    assert!(followed > 200, "only {followed} links were found");
}

#[test]
fn what_is_a_path_and_where_it_leads() {
    let top = BTreeSet::from(["docs", "proto", "target"]);
    for (text, expected) in [
        ("docs/tutorial.md", true),
        ("proto/src", true),
        ("session/window.rs", true),
        ("window.rs", true),
        ("results/first/report.html", false),
        ("target/release/coordinator", false),
        ("km/h", false),
        ("field/ROLE/NAME", false),
        ("case.toml", false),
        ("/dev/shm", false),
        (".rs", false),
    ] {
        assert_eq!(is_path(text, &top), expected, "{text}");
    }
    let place = Path::new("mech-solver/src/models/rod.rs");
    for (path, expected) in [
        (&["models", "rod.rs"][..], true),
        (&["SOLVER", "src", "models", "NAME.rs"], true),
        (&["models", "NAME.py"], false),
        (&["src", "rod.rs"], false),
    ] {
        assert_eq!(fits(place, path), expected, "{path:?}");
    }
}
