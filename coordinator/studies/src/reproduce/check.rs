//! Whether a study refers only to what it has, before anything of it runs.

use super::study::{FigureSpec, Study, TableSpec};
use run::error::RunError;
use std::collections::BTreeSet;
use std::path::Path;

/// Checks all references of the study in `file`.
///
/// # Errors
/// [`RunError::Usage`]: every reference that leads nowhere, with its place.
pub(super) fn check(study: &Study, file: &Path) -> Result<(), RunError> {
    let folder = file.parent().unwrap_or(Path::new(""));
    let mut wrong = Vec::new();
    if !folder.join(&study.text).is_file() {
        wrong.push(format!("text: there is no file {}", folder.join(&study.text).display()));
    }
    wrong.extend(repeated("run", study.titles(None).map(|(name, _)| name)));
    wrong.extend(repeated("table", study.tables.iter().map(|table| &*table.id)));
    wrong.extend(repeated("figure", study.figures.iter().map(|figure| &*figure.id)));
    wrong.extend(families(study, folder));
    wrong.extend(limits(study));
    study.tables.iter().for_each(|table| wrong.extend(rows(study, table)));
    study.figures.iter().for_each(|figure| wrong.extend(lines(study, figure)));
    if wrong.is_empty() {
        return Ok(());
    }
    let lines: Vec<String> =
        wrong.iter().map(|what| format!("{}: {what}", file.display())).collect();
    Err(RunError::Usage(lines.join("\n")))
}

fn repeated<'a>(what: &str, names: impl Iterator<Item = &'a str>) -> Vec<String> {
    let mut seen = BTreeSet::new();
    let twice = names.filter(|name| !seen.insert(*name));
    twice.map(|name| format!("{what} `{name}` is defined twice; rename one")).collect()
}

fn families(study: &Study, folder: &Path) -> Vec<String> {
    let mut wrong = Vec::new();
    for family in &study.families {
        let name = &family.name;
        let case = folder.join(&family.case);
        if !case.is_file() {
            wrong.push(format!("run `{name}`: there is no case file {}", case.display()));
        }
        match (&family.over, &family.at) {
            (Some(axis), _) => wrong.extend(no_axis(study, &format!("run `{name}`"), axis)),
            (None, Some(_)) => {
                wrong.push(format!("run `{name}`: `at` has no axis; name it with `over`"));
            }
            (None, None) => {}
        }
    }
    wrong
}

fn no_axis(study: &Study, place: &str, axis: &str) -> Option<String> {
    let known: Vec<&str> = study.axes.keys().map(String::as_str).collect();
    (!study.axes.contains_key(axis))
        .then(|| format!("{place}: there is no axis `{axis}`; there is {}", listed(&known)))
}

fn limits(study: &Study) -> Vec<String> {
    let mut wrong = Vec::new();
    for limit in &study.limits {
        for name in &limit.of {
            let place = format!("limit `{}`", limit.name);
            match study.families.iter().find(|family| family.name == *name) {
                None => wrong.push(no_run(study, &place, name)),
                Some(family) if family.fineness.is_none() => {
                    wrong.push(format!("{place}: run `{name}` has no `fineness`; add it"));
                }
                Some(_) => {}
            }
        }
    }
    wrong
}

fn rows(study: &Study, table: &TableSpec) -> Vec<String> {
    let place = format!("table `{}`", table.id);
    let mut wrong = Vec::new();
    for column in &table.columns {
        wrong.extend(column.over.as_ref().and_then(|axis| no_axis(study, &place, axis)));
    }
    for row in &table.rows {
        if let Some(run) = &row.run
            && study.members(run).is_none()
            && !study.limits.iter().any(|limit| limit.name == *run)
        {
            wrong.push(no_run(study, &place, run));
        }
        if let Some(group) = &row.group
            && study.titles(Some(group)).next().is_none()
        {
            wrong.push(format!("{place}: no run is of the group `{group}`"));
        }
    }
    wrong
}

fn lines(study: &Study, figure: &FigureSpec) -> Vec<String> {
    let lines = figure.plots.iter().flat_map(|plot| &plot.lines).filter_map(|line| line.run());
    let named = lines.chain(figure.maps.iter().map(|map| map.run.as_str()));
    let unknown = named.filter(|name| study.members(name).is_none());
    unknown.map(|name| no_run(study, &format!("figure `{}`", figure.id), name)).collect()
}

fn no_run(study: &Study, place: &str, name: &str) -> String {
    let known: Vec<&str> = study.families.iter().map(|family| family.name.as_str()).collect();
    format!("{place}: there is no run `{name}`; there is {}", listed(&known))
}

fn listed(names: &[&str]) -> String {
    if names.is_empty() { "none".to_owned() } else { names.join(", ") }
}
