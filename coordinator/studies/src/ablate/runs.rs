//! The runs as a table: each effect in a row, what the answer is without it, and what it costs.

use super::study::{Run, Study};
use crate::advise::percent;
use crate::study::quantity::{Quantity, show_change};
use crate::study::table::{Cell, Column, Failure, Table};
use contract::figure::Measure;
use run::format::{number, of_key};

/// Quantities that have a column; all of them are in the file.
const COLUMNS: usize = 6;

/// The study on the terminal.
pub(super) fn text(study: &Study) -> String {
    let title = study.title.as_ref().map(|title| format!(" · {title}")).unwrap_or_default();
    let table = table(study).terminal(&all(study));
    let advice: String = verdicts(study).map(|line| format!("  {line}\n")).collect();
    let head = if advice.is_empty() { "" } else { "\nadvice against measurement\n" };
    format!("effects of {}{title}\n{table}{head}{advice}", study.case)
}

/// Where what was advised agrees with what was measured, a line an effect.
pub(super) fn verdicts(study: &Study) -> impl Iterator<Item = String> {
    study.advice.iter().map(|one| {
        let verdict = if one.agrees { "agree" } else { "DISAGREE" };
        if one.figure.is_empty() {
            let measured = if one.agrees { "none" } else { "one" };
            let effect = &one.effect;
            return format!(
                "{effect:22} advised that there is no answer, measured {measured}: {verdict}"
            );
        }
        let name = study.quantities.iter().find(|known| known.key == one.figure);
        let name = name.map_or(one.figure.as_str(), |known| known.name.as_str());
        let show = |change: Option<f64>, none: &str| change.map_or(none.to_owned(), percent);
        let advised = show(one.advised, "only with it");
        let measured = match (one.measured, one.agrees) {
            (None, true) => "only with it".to_owned(),
            (change, _) => show(change, "not there"),
        };
        format!("{:22} {name}: advised {advised}, measured {measured}: {verdict}", one.effect)
    })
}

/// The case as it is, then without each of its effects, then with each that is advised.
pub(super) fn all(study: &Study) -> Vec<&Run> {
    std::iter::once(&study.whole).chain(&study.without).chain(&study.with).collect()
}

/// The quantities that have a column.
pub(super) fn quantities(study: &Study) -> impl Iterator<Item = &Quantity> {
    study.quantities.iter().filter(|one| one.measure != Measure::Itself).take(COLUMNS)
}

/// The table of runs.
pub(super) fn table(study: &Study) -> Table<'_, Run> {
    let name = |run: &Run| name(study, run);
    let mut columns = vec![Column::text("", name).naming().on_page("run")];
    columns.extend(quantities(study).map(|one| {
        Column::quantity(one.name.clone(), move |run: &Run| Cell::text(figure(one, run)))
    }));
    columns.push(Column::quantity("solve", |run: &Run| Cell::seconds(run.cost.solve_s)));
    columns.push(Column::quantity("of the whole", |run: &Run| {
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

/// What a run is called.
pub(super) fn name(study: &Study, run: &Run) -> String {
    match run.effect.as_str() {
        "" => "the case as it is".to_owned(),
        effect if study.with.iter().any(|added| added.effect == effect) => format!("with {effect}"),
        effect => format!("without {effect}"),
    }
}

/// A quantity, or its change against the case as it is.
fn figure(one: &Quantity, run: &Run) -> String {
    match (run.values.get(&one.key), run.changes.get(&one.key)) {
        (None, _) => "-".to_owned(),
        (Some(_), Some(change)) => show_change(one.measure, *change),
        (Some(value), None) => of_key(&one.key, *value).show(*value, 5),
    }
}
