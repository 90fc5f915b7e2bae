//! The documentation as a site that opens offline: pages of this repository in the order of docs/SUMMARY.md, with search, made by mdBook.
//!
//! Pages stay where they are and link to each other as they do in a repository. They and the files that they link to are copied
//! into a folder in the same places ([`stage`]), of which mdBook makes the site; then every link of every page is followed ([`links`]).

mod links;
mod stage;

use anyhow::{Context, Result, ensure};
use mdbook_driver::MDBook;
use mdbook_driver::config::Config;
use std::path::Path;

/// What a site has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Site {
    /// Its pages.
    pub pages: usize,
    /// Links that were followed, those to other sites left out.
    pub links: usize,
}

/// Makes the site of the repository at `root` in the folder `into`, which is replaced.
///
/// # Errors
/// A page or a file that a page links to is not there, a folder that is no site stands in the way, or links that lead nowhere: all of
/// them, with the page that each is on.
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
