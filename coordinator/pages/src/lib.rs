//! Pages about runs and studies, each one file that needs nothing but itself, and their drawings as
//! pictures.
//!
//! A result directory → [`source::Results`] → [`page::Section`]s → `report.html`. The page asks for
//! nothing: plots are inline SVG, surface maps are small images within it, and all colours are
//! style-sheet variables, so that light and dark are one file. A script of its own (`page.js`) adds
//! what paper cannot: values under the pointer, details, decades, files. It reads them off the drawings
//! that the page, a picture and a printout share; a library of plots would draw everything a second
//! time, weigh ten (uPlot: lines alone) to a hundred times as much (Plotly: maps) and print worse.
//! Quantities that a run did not write have no section.
//!
//! A further section is one function that returns [`page::Section`]s, made of the blocks
//! [`plot::Figure`], [`map::Heatmap`], [`lanes::Lanes`] and [`table::Table`].

pub mod axis;
pub mod bars;
mod canvas;
pub mod html;
pub mod image;
pub mod lanes;
pub mod map;
pub mod maps;
pub mod page;
pub mod palette;
pub mod picture;
mod places;
pub mod plot;
mod sections;
pub mod sheet;
pub mod source;
mod standalone;
pub mod table;

use page::Page;
use run::error::RunError;
use run::results::write::replace;
use source::Results;
use std::path::{Path, PathBuf};

/// Name of the page in a result directory.
pub const FILE: &str = "report.html";

/// Writes a page into a folder; its path.
///
/// # Errors
/// The file system.
pub fn write(page: &Page, folder: &Path) -> Result<PathBuf, RunError> {
    let path = folder.join(FILE);
    replace(&path, page.to_string().as_bytes())?;
    Ok(path)
}

/// The page about the run in a folder.
///
/// # Errors
/// [`RunError::Usage`] if no run has written into it; the file system.
pub fn of_run(folder: &Path) -> Result<Page, RunError> {
    Ok(page(&Results::read(folder)?))
}

/// The page about these results.
#[must_use]
pub fn page(results: &Results) -> Page {
    let mut page = sections::opening(results);
    page.sections.extend(sections::all(results));
    page
}
