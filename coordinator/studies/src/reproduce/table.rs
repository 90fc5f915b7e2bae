//! Tables: families by rows, figures by columns, printed values beside them.

use super::study::{Column, RowSpec, Study, TableSpec};
use super::text::{ABSENT, cell};
use super::values::Values;
use pages::table::Table;
use run::error::RunError;
use std::sync::Arc;

/// A row with its name and the family that it shows.
struct TableRow<'a> {
    name: String,
    family: Option<&'a str>,
    spec: &'a RowSpec,
}

/// A column of the table, for one value of its axis.
struct Place<'a> {
    head: String,
    value: Option<String>,
    spec: &'a Column,
}

/// Fills a table.
///
/// # Errors
/// [`RunError::Usage`]: a template that cannot be filled, or cells that are too few or many.
pub(super) fn table(
    study: &Study,
    spec: &TableSpec,
    values: &Arc<Values>,
) -> Result<Table, RunError> {
    let places: Vec<Place<'_>> =
        spec.columns.iter().flat_map(|column| columns(study, column)).collect();
    let head = std::iter::once(spec.head.clone());
    let head = head.chain(places.iter().map(|place| place.head.clone())).collect();
    let mut table = Table { head, rows: Vec::new(), figures_from: 1 };
    for row in spec.rows.iter().flat_map(|row| rows(study, row)) {
        let mut cells = vec![row.name.clone()];
        match &row.spec.cells {
            Some(printed) => cells.extend(printed.iter().cloned()),
            None => {
                for place in &places {
                    cells.push(filled(spec, &row, place, values)?);
                }
            }
        }
        if cells.len() != table.head.len() {
            let [wanted, found] = [table.head.len() - 1, cells.len() - 1];
            let place = format!("table `{}`, row `{}`", spec.id, row.name);
            return Err(RunError::Usage(format!("{place}: {found} cells for {wanted} columns")));
        }
        table.rows.push(cells);
    }
    Ok(table)
}

fn rows<'a>(study: &'a Study, spec: &'a RowSpec) -> Vec<TableRow<'a>> {
    let titles = match (&spec.group, &spec.run) {
        (Some(group), _) => study.titles(Some(group)).collect(),
        (None, Some(run)) => study.titles(None).filter(|(name, _)| name == run).collect(),
        (None, None) => Vec::new(),
    };
    if titles.is_empty() {
        // One run of a family, or a row without any.
        let name = spec.name.clone().unwrap_or_default();
        return vec![TableRow { name, family: spec.run.as_deref(), spec }];
    }
    let row = |(name, title): (&'a str, &'a str)| TableRow {
        name: spec.name.clone().unwrap_or_else(|| title.to_owned()),
        family: Some(name),
        spec,
    };
    titles.into_iter().map(row).collect()
}

fn columns<'a>(study: &Study, spec: &'a Column) -> Vec<Place<'a>> {
    let Some(axis) = &spec.over else {
        return vec![Place { head: spec.head.clone(), value: spec.at.clone(), spec }];
    };
    let place = |value: &String| Place {
        head: spec.head.replace(&format!("{{{axis}}}"), value),
        value: Some(value.clone()),
        spec,
    };
    study.axes.get(axis).into_iter().flatten().map(place).collect()
}

fn filled(
    table: &TableSpec,
    row: &TableRow<'_>,
    column: &Place<'_>,
    values: &Arc<Values>,
) -> Result<String, RunError> {
    let run = row.family.map(|family| match &column.value {
        Some(value) => format!("{family}/{value}"),
        None => family.to_owned(),
    });
    let place = format!("table `{}`, column `{}`", table.id, column.head);
    let text = cell(&place, &column.spec.cell, run, &row.spec.printed, values)?;
    // Nothing but dashes is one absence.
    let has_digits = text.chars().any(|c| c.is_ascii_digit());
    Ok(if has_digits || !text.contains(ABSENT) { text } else { ABSENT.to_owned() })
}
