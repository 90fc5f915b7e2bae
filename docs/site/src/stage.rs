//! Copies the pages of docs/SUMMARY.md and the files that they link to. A folder that a page links
//! to becomes a list of its files; a link to docs/SUMMARY.md leads to the contents of the site.

use anyhow::{Context, Result, ensure};
use mdbook_markdown::pulldown_cmark::{Event, Tag};
use mdbook_markdown::{MarkdownOptions, new_cmark_parser};
use mdbook_summary::{Link, Summary, SummaryItem, parse_summary};
use std::collections::BTreeSet;
use std::fs;
use std::ops::Range;
use std::path::{Component, Path, PathBuf};

/// The pages of a site.
pub(crate) struct Pages {
    /// Their order, with places relative to the repository.
    pub(crate) summary: Summary,
    pub(crate) count: usize,
}

/// Files of these kinds open in a browser; others are shown as text.
const OPENS: [&str; 8] = ["svg", "png", "html", "pdf", "csv", "json", "css", "txt"];

/// Page with the contents of the site, which mdBook writes.
const CONTENTS: &str = "toc.html";

/// Copies everything that the site shows from the repository at `root`.
pub(crate) fn fill(root: &Path, into: &Path) -> Result<Pages> {
    let docs = Path::new("docs");
    let text = fs::read_to_string(root.join("docs/SUMMARY.md")).context("docs/SUMMARY.md")?;
    let mut summary = parse_summary(&text)?;
    let mut pages = BTreeSet::new();
    let Summary { prefix_chapters, numbered_chapters, suffix_chapters, .. } = &mut summary;
    for items in [prefix_chapters, numbered_chapters, suffix_chapters] {
        place(items, docs, &mut pages);
    }
    let mut files = BTreeSet::new();
    for page in &pages {
        let text =
            fs::read_to_string(root.join(page)).with_context(|| page.display().to_string())?;
        let text = linked(page, &text, &pages, &mut files)?;
        let to = into.join(page);
        fs::create_dir_all(to.parent().expect("a page is in a folder"))?;
        fs::write(to, text)?;
    }
    for file in files {
        let to = into.join(shown(&file));
        fs::create_dir_all(to.parent().expect("a file is in a folder"))?;
        copy(&root.join(&file), &to)
            .with_context(|| format!("{}, which a page links to", file.display()))?;
    }
    Ok(Pages { summary, count: pages.len() })
}

/// Copies a file, or writes the sorted names of the entries of a folder.
fn copy(from: &Path, to: &Path) -> Result<()> {
    if !from.is_dir() {
        fs::copy(from, to)?;
        return Ok(());
    }
    let mut names = Vec::new();
    for entry in fs::read_dir(from)? {
        let entry = entry?;
        let mark = if entry.file_type()?.is_dir() { "/" } else { "" };
        names.push(format!("{}{mark}\n", entry.file_name().display()));
    }
    names.sort();
    fs::write(to, names.concat())?;
    Ok(())
}

/// Gives every chapter its place in the repository.
fn place(items: &mut [SummaryItem], docs: &Path, pages: &mut BTreeSet<PathBuf>) {
    for item in items {
        let SummaryItem::Link(Link { location, nested_items, .. }) = item else { continue };
        if let Some(at) = location {
            *at = normal(&docs.join(&at));
            pages.insert(at.clone());
        }
        place(nested_items, docs, pages);
    }
}

/// Returns the text of a page for the site. Links to files that a browser does not open lead to
/// copies that it does; these files are added to `files`.
fn linked(
    page: &Path,
    text: &str,
    pages: &BTreeSet<PathBuf>,
    files: &mut BTreeSet<PathBuf>,
) -> Result<String> {
    let folder = page.parent().expect("a page is in a folder");
    let mut changes: Vec<(Range<usize>, String)> = Vec::new();
    for (event, range) in new_cmark_parser(text, &MarkdownOptions::default()).into_offset_iter() {
        let (Event::Start(Tag::Link { dest_url, .. }) | Event::Start(Tag::Image { dest_url, .. })) =
            event
        else {
            continue;
        };
        let (path, _) = dest_url.split_once('#').unwrap_or((&dest_url, ""));
        if path.is_empty() || path.contains(':') {
            continue;
        }
        let file = normal(&folder.join(path));
        let at = text[range.clone()].rfind(path).context("a link has its address in the text")?;
        let address = range.start + at..range.start + at + path.len();
        if file == Path::new("docs/SUMMARY.md") {
            changes.push((address, format!("{}{CONTENTS}", "../".repeat(depth(page)))));
            continue;
        }
        let is_page = pages.contains(&file);
        ensure!(
            is_page || file.extension().is_none_or(|kind| kind != "md"),
            "{}: links to {}, which is no page of docs/SUMMARY.md",
            page.display(),
            file.display()
        );
        if is_page {
            // mdBook turns README.md into the index of its folder, but does not change links to it.
            if let Some(folder) = path.strip_suffix("README.md") {
                changes.push((address, format!("{folder}index.md")));
            }
            continue;
        }
        if shown(&file) != file {
            changes.push((address, format!("{path}.txt")));
        }
        files.insert(file);
    }
    let mut text = text.to_owned();
    for (range, new) in changes.into_iter().rev() {
        text.replace_range(range, &new);
    }
    Ok(text)
}

/// Returns the place of a file in the site.
fn shown(file: &Path) -> PathBuf {
    let opens = file.extension().is_some_and(|kind| OPENS.iter().any(|one| kind == *one));
    match opens {
        true => file.to_owned(),
        false => PathBuf::from(format!("{}.txt", file.display())),
    }
}

/// Returns the number of folders above a page of the site.
fn depth(page: &Path) -> usize {
    page.components().count() - 1
}

/// A path without `..` and `.`.
fn normal(path: &Path) -> PathBuf {
    let mut parts = PathBuf::new();
    for part in path.components() {
        match part {
            Component::ParentDir => drop(parts.pop()),
            Component::CurDir => {}
            other => parts.push(other),
        }
    }
    parts
}
