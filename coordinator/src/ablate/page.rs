//! The study as a page.

use super::show::{quantities, row};
use super::{FILE, Study};
use crate::report::bars::Bars;
use crate::report::page::{Block, Mood, Page, Section};
use crate::report::table::Table;
use crate::study::quantity::Measure;
use run::error::{RunError, file_failure};
use std::path::Path;

/// The page about the study in a folder.
///
/// # Errors
/// A file that cannot be read, or holds no study of this version.
pub fn page(folder: &Path) -> Result<Page, RunError> {
    let path = folder.join(FILE);
    let text = std::fs::read(&path).map_err(|error| file_failure(&path, &error))?;
    let study: Study = serde_json::from_slice(&text).map_err(|fault| {
        let fix = "run `coordinator ablate` again";
        RunError::Usage(format!("{} contains no study: {fault}; {fix}", path.display()))
    })?;
    Ok(of(&study))
}

fn of(study: &Study) -> Page {
    let failed = study.without.iter().any(|run| run.failed.is_some());
    let mut blocks = vec![Block::Table(runs(study))];
    let why = |run: &super::Run| {
        Some(Block::Text(format!("Without {}: {}", run.effect, run.failed.as_ref()?)))
    };
    blocks.extend(study.without.iter().filter_map(why));
    let sections = [changes(study), Section::of("Runs", blocks)];
    Page {
        name: format!("Effects of {}", study.case),
        title: study.title.clone().unwrap_or_default(),
        status: format!("{} effects", study.without.len()),
        mood: if failed { Mood::Open } else { Mood::Good },
        reason: format!("each switched off in turn in `{}`", study.file),
        sections: sections.into_iter().flatten().collect(),
    }
}

/// For each quantity the change that every effect makes, and the time it takes.
fn changes(study: &Study) -> Option<Section> {
    let whole = study.whole.cost.solve_s;
    let change_of = |key: &str, unit: f64| {
        let change = |run: &super::Run| Some((run.effect.clone(), run.changes.get(key)? / unit));
        study.without.iter().filter_map(change).collect::<Vec<_>>()
    };
    let figures = quantities(study).map(|one| {
        let (label, unit) = match one.measure {
            Measure::Relative => ("change [%]", 0.01),
            Measure::Absolute | Measure::Itself => ("difference", 1.0),
        };
        Bars {
            title: format!("{} without an effect", one.name),
            label: label.to_owned(),
            bars: change_of(&one.key, unit),
        }
    });
    let made = study.without.iter().filter(|run| run.failed.is_none());
    let time = |run: &super::Run| (run.effect.clone(), 100.0 * (run.cost.solve_s - whole) / whole);
    let times = Bars {
        title: "time without an effect".to_owned(),
        label: "change of the solving time [%]".to_owned(),
        bars: made.map(time).collect(),
    };
    let all = figures.chain([times]).filter(|bars| !bars.bars.is_empty());
    Section::of("What each effect changes", all.map(Block::Bars).collect())
}

fn runs(study: &Study) -> Table {
    let mut head = vec!["run".to_owned()];
    head.extend(quantities(study).map(|one| one.name));
    head.extend(["solve", "of the whole", "iterations"].map(str::to_owned));
    let width = head.len();
    let all = std::iter::once(&study.whole).chain(&study.without);
    let padded = |run| {
        let mut cells = row(study, run);
        cells.resize(width, String::new());
        cells
    };
    Table { rows: all.map(padded).collect(), head, figures_from: 1 }
}
