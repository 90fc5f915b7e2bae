//! The runs as a table: one level at a time for people, all runs for programs.

use super::study::{Run, Study};
use crate::study::table::{Cell, Column, Failure, Table};
use run::format::number;
use std::collections::BTreeSet;

/// Number of quantities with a column on the terminal; the files contain all.
pub(super) const COLUMNS: usize = 7;

/// Table of runs that differ in these settings.
pub(super) fn table<'a>(study: &'a Study, settings: &[&'a str]) -> Table<'a, Run> {
    let mut columns =
        vec![Column::csv_only("models", |run: &Run| study.levels[run.level].name.clone())];
    columns.extend(settings.iter().map(|key| setting(key)));
    columns.extend(cost(&study.runs));
    columns.extend(values(study));
    columns.extend(errors(study));
    columns.push(Column::csv_only("pareto", |run: &Run| run.pareto.to_string()));
    columns.push(Column::csv_only("failed", |run: &Run| run.failed.clone().unwrap_or_default()));
    let failure = |run: &Run| {
        let why = run.failed.as_ref()?;
        Some(Failure { word: "failed", remark: format!("{} failed: {why}", run.settings_text()) })
    };
    Table::new(columns).mark("*", |run: &Run| run.pareto).failure(failure)
}

/// Formats all runs as CSV: level and settings, cost, values and errors.
pub(super) fn csv(study: &Study) -> String {
    let keys = study.runs.iter().flat_map(|run| &run.settings).map(|(key, _)| key.as_str());
    let keys: BTreeSet<&str> = keys.collect();
    let runs: Vec<&Run> = study.runs.iter().collect();
    table(study, &keys.into_iter().collect::<Vec<_>>()).csv(&runs)
}

/// Runs of a level, and the settings in which they differ.
pub(super) fn of_level(study: &Study, level: usize) -> (Vec<&Run>, Vec<&str>) {
    let runs: Vec<&Run> = study.runs.iter().filter(|run| run.level == level).collect();
    let settings = runs.first().map(|run| &run.settings).into_iter().flatten();
    let settings = settings.map(|(key, _)| key.as_str()).collect();
    (runs, settings)
}

fn setting(key: &str) -> Column<'_, Run> {
    let value = move |run: &Run| {
        let found = run.settings.iter().find(|(own, _)| own == key);
        found.map(|(_, value)| Cell::text(value)).unwrap_or_default()
    };
    Column::quantity(key, value).naming().csv(key)
}

/// Columns for the cost of the runs: totals for people, single processes for programs.
fn cost<'a>(runs: &[Run]) -> Vec<Column<'a, Run>> {
    let text = |value: Option<String>| value.unwrap_or_default();
    let roles: BTreeSet<&String> = runs.iter().flat_map(|run| run.cost.cpu_s.keys()).collect();
    let resident: BTreeSet<&String> =
        runs.iter().flat_map(|run| run.cost.peak_rss_bytes.keys()).collect();
    let mut columns = vec![
        Column::csv_only("wall_s", |run: &Run| run.cost.wall_s.to_string()),
        Column::quantity("solve", |run: &Run| Cell::seconds(run.cost.solve_s)).csv("solve_s"),
        Column::quantity("wall", |run: &Run| Cell::seconds(run.cost.wall_s)),
        Column::quantity("cpu", |run: &Run| Cell::seconds(run.cost.cpu_s.values().sum())),
    ];
    columns.extend(roles.into_iter().cloned().map(|role| {
        Column::csv_only(format!("{role}_cpu_s"), move |run: &Run| {
            text(run.cost.cpu_s.get(&role).map(f64::to_string))
        })
    }));
    columns.push(
        Column::quantity("memory", |run: &Run| Cell::bytes(run.cost.peak_rss_bytes.values().sum()))
            .not_on_page(),
    );
    columns.extend(resident.into_iter().cloned().map(|role| {
        Column::csv_only(format!("{role}_peak_rss_bytes"), move |run: &Run| {
            text(run.cost.peak_rss_bytes.get(&role).map(u64::to_string))
        })
    }));
    let iterations = Column::quantity("iter", |run: &Run| Cell::text(run.cost.iterations));
    columns.push(iterations.on_page("iterations").csv("iterations"));
    columns
}

/// Columns for the values: the first quantity for people, all for programs.
fn values(study: &Study) -> impl Iterator<Item = Column<'_, Run>> {
    study.quantities.iter().enumerate().map(|(n, one)| {
        let value = |run: &Run| Cell::optional(run.values.get(&one.key), |v| number(v, 6));
        let column = Column::quantity(&one.name, value).csv(&one.key).not_on_page();
        if n == 0 { column } else { column.not_on_terminal() }
    })
}

fn errors(study: &Study) -> impl Iterator<Item = Column<'_, Run>> {
    study.quantities.iter().enumerate().map(|(n, one)| {
        let error = |run: &Run| Cell::optional(run.errors.get(&one.key), |v| one.show_error(v));
        let head = if n == 0 { "error" } else { &one.name };
        let column = Column::quantity(head, error)
            .on_page(format!("error of {}", one.name))
            .csv(format!("error of {}", one.key));
        if n < COLUMNS { column } else { column.not_on_terminal() }
    })
}
