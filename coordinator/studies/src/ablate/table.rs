//! The runs of an ablation as a table, one row per effect with its influence and cost, and as a
//! page.

use super::study::{Run, Study};
use crate::advise::percent;
use crate::study::output::StudyPage;
use crate::study::quantity::{Quantity, show_change};
use crate::study::table::{Cell, Column, Failure, Table};
use contract::figure::Measure;
use pages::bars::Bars;
use pages::page::{Block, Page, RunStatus, Section};
use run::error::RunError;
use run::format::{number, of_key, sentence};
use std::path::Path;

/// Number of quantities with a column; the file contains all.
const COLUMNS: usize = 6;

/// Renders the study for the terminal.
pub(super) fn text(study: &Study) -> String {
    let title = study.title.as_ref().map(|title| format!(" · {title}")).unwrap_or_default();
    let table = table(study).terminal(&all(study));
    let advice: String = verdicts(study).map(|line| format!("  {line}\n")).collect();
    let head = if advice.is_empty() { "" } else { "\nadvice compared with measurement\n" };
    format!("effects of {}{title}\n{table}{head}{advice}", study.case)
}

/// Compares advice and measurement, one line per effect.
fn verdicts(study: &Study) -> impl Iterator<Item = String> {
    study.advice.iter().map(|one| {
        let verdict = if one.agrees { "agree" } else { "DISAGREE" };
        if one.figure.is_empty() {
            let measured = if one.agrees { "none" } else { "a result" };
            let effect = &one.effect;
            return format!("{effect:22} advised: no result, measured: {measured}: {verdict}");
        }
        let name = study.quantities.iter().find(|known| known.key == one.figure);
        let name = name.map_or(one.figure.as_str(), |known| known.name.as_str());
        let show = |change: Option<f64>, none: &str| change.map_or(none.to_owned(), percent);
        let advised = show(one.advised, "exists only with the effect");
        let measured = match (one.measured, one.agrees) {
            (None, true) => "exists only with the effect".to_owned(),
            (change, _) => show(change, "missing"),
        };
        format!("{:22} {name}: advised {advised}, measured {measured}: {verdict}", one.effect)
    })
}

/// Lists the unmodified case, then the runs without and with effects.
fn all(study: &Study) -> Vec<&Run> {
    std::iter::once(&study.whole).chain(&study.without).chain(&study.with).collect()
}

/// Quantities that have a column.
fn quantities(study: &Study) -> impl Iterator<Item = &Quantity> {
    study.quantities.iter().filter(|one| one.measure != Measure::Itself).take(COLUMNS)
}

/// Table of the runs.
fn table(study: &Study) -> Table<'_, Run> {
    let name = |run: &Run| name(study, run);
    let mut columns = vec![Column::text("", name).naming().on_page("run")];
    columns.extend(quantities(study).map(|one| {
        Column::quantity(one.name.clone(), move |run: &Run| Cell::text(figure(one, run)))
    }));
    columns.push(Column::quantity("solve", |run: &Run| Cell::seconds(run.cost.solve_s)));
    columns.push(Column::quantity("of unmodified", |run: &Run| {
        let share = 100.0 * run.cost.solve_s / study.whole.cost.solve_s;
        Cell::number(share, format!("{} %", number(share, 2)))
    }));
    let iterations = Column::quantity("iter", |run: &Run| Cell::text(run.cost.iterations));
    columns.push(iterations.on_page("iterations"));
    Table::new(columns).failure(move |run| {
        let why = run.failed.as_ref()?;
        Some(Failure { word: "cannot run", remark: format!("{}: {why}", name(run)) })
    })
}

/// Name of a run.
fn name(study: &Study, run: &Run) -> String {
    match run.effect.as_str() {
        "" => "unmodified case".to_owned(),
        effect if study.with.iter().any(|added| added.effect == effect) => format!("with {effect}"),
        effect => format!("without {effect}"),
    }
}

/// Formats a quantity, or its change relative to the unmodified case.
fn figure(one: &Quantity, run: &Run) -> String {
    match (run.values.get(&one.key), run.changes.get(&one.key)) {
        (None, _) => "-".to_owned(),
        (Some(_), Some(change)) => show_change(one.measure, *change),
        (Some(value), None) => of_key(&one.key, *value).show(*value, 5),
    }
}

impl StudyPage for Study {
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
        Section::of("Advice compared with measurement", verdicts),
    ];
    Page {
        name: format!("Effects of {}", study.case),
        title: study.title.clone().unwrap_or_default(),
        status: format!("{} effects", study.without.len()),
        mood: if failed || surprised { RunStatus::Open } else { RunStatus::Good },
        reason: match study.with.len() {
            0 => format!("each switched off in turn in `{}`", study.file),
            more => format!(
                "each switched off in turn in `{}`, and {more} advised ones added",
                study.file
            ),
        },
        sections: sections.into_iter().flatten().collect(),
    }
}

/// Bar charts: change of every quantity by each effect, and change of the solving time.
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
    Section::of("Influence of each effect", all.map(Block::Bars).collect())
}
