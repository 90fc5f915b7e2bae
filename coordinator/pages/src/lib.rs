//! Self-contained HTML pages about runs and studies, and their drawings as picture files.
//!
//! The pages are built in steps: a result directory is read ([`source::Results`]), converted to
//! sections ([`page::Section`]) and written as `report.html`. A page loads no other resources.
//! Plots are inline SVG, surface maps are small embedded images, and all colours are style-sheet
//! variables, so one file serves light and dark. The script `page.js` adds interaction: values
//! under the pointer, zoom, logarithmic axes and downloads. The script reads the values from the
//! drawings, which also serve as picture and printout. A plotting library would draw everything a
//! second time, weigh ten times (uPlot: lines only) to a hundred times (Plotly: maps) as much, and
//! print worse. Quantities that a run did not write have no section.
//!
//! A new section is one function that returns [`page::Section`]s, built from the blocks
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
pub mod picture;
pub mod plot;
mod sections;
pub mod sheet;
pub mod source;
pub mod table;

use lanes::Lanes;
use page::Page;
use run::error::RunError;
use run::results::write::replace;
use source::{Columns, Results};
use std::path::{Path, PathBuf};

/// Name of the page in a result directory.
pub const FILE: &str = "report.html";

/// Writes a page into a folder and returns the path.
///
/// # Errors
/// The file cannot be written.
pub fn write(page: &Page, folder: &Path) -> Result<PathBuf, RunError> {
    let path = folder.join(FILE);
    replace(&path, page.to_string().as_bytes())?;
    Ok(path)
}

/// Builds the page about the run in a folder.
///
/// # Errors
/// [`RunError::Usage`] if the folder holds no results; an input error if a file cannot be read.
pub fn of_run(folder: &Path) -> Result<Page, RunError> {
    Ok(page(&Results::read(folder)?))
}

/// Builds the page about these results.
#[must_use]
pub fn page(results: &Results) -> Page {
    let mut page = sections::opening(results);
    page.sections.extend(sections::all(results));
    page
}

/// Draws the work of the participants in rows of `iterations.csv`, under a coupling scheme. `None`
/// without rows, or without the times of every participant.
#[must_use]
pub fn work(iterations: &Columns, scheme: &str) -> Option<Lanes> {
    sections::lanes(iterations, scheme)
}
