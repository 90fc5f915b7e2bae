//! The study as a page.

use super::runs::{all, name, quantities, table, verdicts};
use super::study::{Run, Study};
use crate::study::output::Shown;
use contract::figure::Measure;
use pages::bars::Bars;
use pages::page::{Block, Mood, Page, Section};
use run::error::RunError;
use run::format::sentence;
use std::path::Path;

impl Shown for Study {
    fn page(&self, _: &Path) -> Result<Page, RunError> {
        Ok(of(self))
    }
}

fn of(study: &Study) -> Page {
    let failed = study.without.iter().any(|run| run.failed.is_some());
    let surprised = study.advice.iter().any(|one| !one.agrees);
    let (table, runs) = (table(study), all(study));
    let remarks = table.remarks(&runs).map(|why| Block::Text(sentence(&why)));
    let blocks = std::iter::once(Block::Table(table.page(&runs))).chain(remarks).collect();
    let verdicts: Vec<Block> = verdicts(study).map(Block::Text).collect();
    let sections = [
        changes(study),
        Section::of("Runs", blocks),
        Section::of("Advice against measurement", verdicts),
    ];
    Page {
        name: format!("Effects of {}", study.case),
        title: study.title.clone().unwrap_or_default(),
        status: format!("{} effects", study.without.len()),
        mood: if failed || surprised { Mood::Open } else { Mood::Good },
        reason: match study.with.len() {
            0 => format!("each switched off in turn in `{}`", study.file),
            more => format!(
                "each switched off in turn in `{}`, and {more} that are advised added",
                study.file
            ),
        },
        sections: sections.into_iter().flatten().collect(),
    }
}

/// For each quantity the change that every effect makes, and the time it takes.
fn changes(study: &Study) -> Option<Section> {
    let whole = study.whole.cost.solve_s;
    let change_of = |key: &str, unit: f64| {
        let change = |run: &Run| Some((name(study, run), run.changes.get(key)? / unit));
        study.without.iter().chain(&study.with).filter_map(change).collect::<Vec<_>>()
    };
    let figures = quantities(study).map(|one| {
        let (label, unit) = match one.measure {
            Measure::Relative => ("change [%]", 0.01),
            Measure::Absolute | Measure::Itself => ("difference", 1.0),
        };
        Bars { title: one.name.clone(), label: label.to_owned(), bars: change_of(&one.key, unit) }
    });
    let made = study.without.iter().chain(&study.with).filter(|run| run.failed.is_none());
    let time = |run: &Run| (name(study, run), 100.0 * (run.cost.solve_s - whole) / whole);
    let times = Bars {
        title: "solving time".to_owned(),
        label: "change of the solving time [%]".to_owned(),
        bars: made.map(time).collect(),
    };
    let all = figures.chain([times]).filter(|bars| !bars.bars.is_empty());
    Section::of("What each effect changes", all.map(Block::Bars).collect())
}
