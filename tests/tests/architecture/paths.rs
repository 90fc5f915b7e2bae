//! Paths in back ticks, in pages and comments, lead to an existing file or folder of this project.

use std::collections::BTreeSet;
use std::path::{Component, Path, PathBuf};
use std::process::Command;
use tests::harness::root;

/// Types of files that are checked.
const READ: [&str; 7] = ["md", "rs", "py", "c", "h", "toml", "f90"];
/// Extensions that mark a path to a source file.
const SOURCES: [&str; 9] = ["md", "rs", "py", "c", "h", "toml", "f90", "sh", "ipynb"];
/// Folders created by a user or a build: results, FMUs, executables.
const MADE: [&str; 4] = ["results", "fields", "resources", "target"];
/// Changelogs refer to files of their time.
const HISTORY: [&str; 2] = ["docs/changelog/", "CHANGELOG.md"];

/// Files of the project: tracked by git, or untracked but not ignored.
pub(crate) fn files() -> Vec<String> {
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

/// Every file, and every folder that contains one.
fn places(files: &[String]) -> BTreeSet<&Path> {
    files.iter().flat_map(|file| Path::new(file).ancestors()).collect()
}

/// Parts of a line in back ticks.
fn quoted(line: &str) -> impl Iterator<Item = &str> {
    line.split('`').skip(1).step_by(2)
}

/// True if the text looks like a path in this project.
fn is_path(text: &str, top: &BTreeSet<&str>) -> bool {
    let plain = |c: char| c.is_ascii_alphanumeric() || "._-/".contains(c);
    if !text.chars().all(plain) || text.starts_with(['/', '.', '-']) {
        return false;
    }
    let ending = Path::new(text).extension().and_then(|ending| ending.to_str());
    match text.split_once('/') {
        Some((first, _)) if MADE.contains(&first) => false,
        Some((first, _)) => top.contains(first) || ending.is_some_and(|e| SOURCES.contains(&e)),
        // A single word counts only with the extension `rs`: files of users have the other
        // extensions.
        None => ending == Some("rs") && text.len() > ".rs".len(),
    }
}

/// True for a placeholder in a path: `NAME.rs`, `SOLVER`.
fn is_placeholder(part: &str) -> bool {
    let stem = part.split('.').next().unwrap_or_default();
    stem.len() > 1 && stem.chars().all(|c| c.is_ascii_uppercase())
}

/// True if the place ends with this path. A placeholder matches any name with the same extension.
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

/// Targets of the links and pictures of a Markdown page.
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
            // Links to other sites, to the same page, and formulas are skipped.
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
