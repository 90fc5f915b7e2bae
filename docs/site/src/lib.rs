//! The documentation as a site that opens offline, with search: the pages of this repository in the
//! order of docs/SUMMARY.md, built by mdBook.
//!
//! Pages link to each other as in the repository. [`stage`] copies pages and linked files into a
//! folder with the same structure, from which mdBook builds the site. [`links`] then follows every
//! link of every page.

#![forbid(unsafe_code)]

mod links;
mod stage;

use anyhow::{Context, Result, ensure};
use mdbook_driver::MDBook;
use mdbook_driver::config::Config;
use std::path::Path;

/// Counts of a site.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Site {
    /// Number of pages.
    pub pages: usize,
    /// Number of links within the site, all of which were followed.
    pub links: usize,
}

/// Builds the site of the repository at `root` in the folder `into`, which is replaced.
///
/// # Errors
/// A page or a linked file is missing, `into` is a folder that is not a site, or links are broken.
/// The error lists all broken links with their pages.
pub fn build(root: &Path, into: &Path) -> Result<Site> {
    replaceable(into)?;
    let stage = tempfile::tempdir().context("a folder for the pages")?;
    let pages = stage::fill(root, &stage.path().join("src"))?;
    let style = stage.path().join("docs/site/site.css");
    std::fs::create_dir_all(style.parent().expect("it is in a folder"))?;
    std::fs::copy(root.join("docs/site/site.css"), style).context("docs/site/site.css")?;
    let mut config = Config::from_disk(root.join("docs/book.toml"))?;
    config.book.src = "src".into();
    config.build.build_dir = std::path::absolute(into)?;
    let book = MDBook::load_with_config_and_summary(stage.path(), config, pages.summary)?;
    book.build()?;
    let followed = links::follow(into)?;
    ensure!(
        followed.broken.is_empty(),
        "{} links lead nowhere:\n{}",
        followed.broken.len(),
        followed.broken.join("\n")
    );
    Ok(Site { pages: pages.count, links: followed.links })
}

/// A folder is replaced if it is empty or a site of this kind.
fn replaceable(into: &Path) -> Result<()> {
    let empty = match std::fs::read_dir(into) {
        Ok(mut entries) => entries.next().is_none(),
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => true,
        Err(error) => return Err(error).with_context(|| into.display().to_string()),
    };
    ensure!(
        empty || into.join("toc.html").is_file(),
        "{} is no site: name another folder, or remove it",
        into.display()
    );
    Ok(())
}
