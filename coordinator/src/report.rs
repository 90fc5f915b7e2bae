//! `coordinator report`: one page about a run, which needs nothing but itself.
//!
//! A result directory → [`source::Results`] → [`page::Section`]s → `report.html`. The page holds no
//! script and asks for nothing: plots are inline SVG, surface maps are small images within it, and
//! all colours are style-sheet variables, so that light and dark are one file. What a run did not
//! write has no section.
//!
//! A further section is one function that returns [`page::Section`]s, made of the blocks
//! [`plot::Figure`], [`map::Heatmap`], [`lanes::Lanes`] and [`table::Table`].

pub mod axis;
pub mod bars;
mod canvas;
mod html;
pub mod image;
pub mod lanes;
pub mod map;
pub mod page;
pub mod palette;
pub mod plot;
mod sections;
pub mod source;
mod standalone;
pub mod table;

use crate::ablate;
use crate::cost;
use crate::reproduce;
use crate::stability;
use page::Page;
use run::error::RunError;
use run::results::write::replace;
use source::Results;
use std::path::{Path, PathBuf};

/// Name of the page in a result directory.
pub const FILE: &str = "report.html";

/// Makes the page about what is in a folder.
type PageOf = fn(&Path) -> Result<Page, RunError>;

/// Every kind of study: the file that it leaves in its folder, and the page about it.
const STUDIES: [(&str, PageOf); 4] = [
    (cost::FILE, cost::page),
    (ablate::FILE, ablate::page),
    (stability::FILE, stability::page),
    (reproduce::FILE, reproduce::page),
];

/// Writes the report about what is in this folder, a study or a run; its path.
///
/// # Errors
/// [`RunError::Usage`] if neither has been written into the folder; the file system.
pub fn write(folder: &Path) -> Result<PathBuf, RunError> {
    let study = STUDIES.iter().find(|(file, _)| folder.join(file).is_file());
    let page = match study {
        Some((_, page)) => page(folder)?,
        None => page(&Results::read(folder)?),
    };
    let path = folder.join(FILE);
    replace(&path, page.to_string().as_bytes())?;
    Ok(path)
}

/// The page about these results.
#[must_use]
pub fn page(results: &Results) -> Page {
    let mut page = sections::opening(results);
    page.sections.extend(sections::all(results));
    page
}
