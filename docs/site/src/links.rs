//! Follows every link of every page of a site.

use anyhow::{Context, Result};
use scraper::{Html, Selector};
use std::collections::{BTreeMap, HashSet};
use std::path::{Path, PathBuf};

/// Results of following all links.
#[derive(Debug, Default)]
pub(crate) struct Followed {
    pub(crate) links: usize,
    /// Broken links, each with its page.
    pub(crate) broken: Vec<String>,
}

/// A page: its anchors, and the addresses of its links, scripts, styles and pictures.
struct Page {
    names: HashSet<String>,
    addresses: Vec<String>,
}

/// Follows the links of all pages under a folder, except links to other sites.
pub(crate) fn follow(site: &Path) -> Result<Followed> {
    let site = site.canonicalize()?;
    let mut pages = BTreeMap::new();
    read(&site, &mut pages)?;
    let mut followed = Followed::default();
    for (path, page) in &pages {
        for address in &page.addresses {
            if address.contains(':') || address.starts_with("//") {
                continue;
            }
            followed.links += 1;
            if !leads(path, address, &pages) {
                let path = path.strip_prefix(&site).unwrap_or(path);
                followed.broken.push(format!("{}: {address}", path.display()));
            }
        }
    }
    Ok(followed)
}

fn leads(from: &Path, address: &str, pages: &BTreeMap<PathBuf, Page>) -> bool {
    let (path, name) = address.split_once('#').unwrap_or((address, ""));
    let to = match path {
        "" => from.to_owned(),
        path => from.parent().expect("a page is in a folder").join(path),
    };
    let Ok(to) = to.canonicalize() else { return false };
    match pages.get(&to) {
        Some(page) => name.is_empty() || page.names.contains(name),
        None => to.is_file() && name.is_empty(),
    }
}

fn read(folder: &Path, pages: &mut BTreeMap<PathBuf, Page>) -> Result<()> {
    for entry in std::fs::read_dir(folder).with_context(|| folder.display().to_string())? {
        let path = entry?.path().canonicalize()?;
        if path.is_dir() {
            read(&path, pages)?;
        } else if path.extension().is_some_and(|kind| kind == "html") {
            let page = page(&std::fs::read_to_string(&path)?);
            pages.insert(path, page);
        }
    }
    Ok(())
}

fn page(text: &str) -> Page {
    let html = Html::parse_document(text);
    let all = |selector: &str, attribute: &str| -> Vec<String> {
        let selector = Selector::parse(selector).expect("a selector of ours");
        let elements = html.select(&selector);
        elements.filter_map(|element| element.attr(attribute)).map(str::to_owned).collect()
    };
    let names = all("[id]", "id").into_iter().collect();
    let addresses =
        [all("a[href], link[href]", "href"), all("img[src], script[src]", "src")].concat();
    Page { names, addresses }
}
