//! `iterations.csv`: one row for each iteration, written during the run.
//!
//! | column | |
//! |---|---|
//! | `window`, `iteration` | from 0, from 1 |
//! | `start_s`, `end_s` | the window |
//! | `residual`, `residual_FIELD` | ‖r‖/‖x̃‖ of the coupling data: the largest, and each |
//! | `relaxation`, `columns`, `dropped` | choice of the next iterate; empty in the last iteration |
//! | `coupling_s` | time of the iteration in which no model computed |
//! | `heat_sent_w`, `heat_received_w` | mean power through conservative fields |
//! | `ROLE_s`, `ROLE_work`, ... | report of each participant on its solve |
//!
//! A window that is solved again with another end keeps its number.
//!
//! An explicit scheme has no residuals of fields and no choice of iterates, so their columns are
//! absent.

use super::rows::{Rows, cell, push};
use crate::error::RunError;
use crate::session::{Balance, SolveRecord};
use contract::step::Step;
use coupling::accelerate::AccelerationStats;
use std::path::Path;

/// Content of a row.
#[derive(Clone, Copy, Debug)]
pub struct IterationRecord<'a> {
    /// Window and iteration.
    pub step: &'a Step,
    /// Largest relative residual.
    pub residual: Option<f64>,
    /// Relative residual of every field of the coupling data.
    pub residuals: &'a [f64],
    /// Choice of the next iterate.
    pub taken: &'a AccelerationStats,
    /// Seconds in which no model computed.
    pub coupling_seconds: f64,
    /// Balance of the conservative fields.
    pub balance: &'a Balance,
    /// Reports of the participants.
    pub solved: &'a [SolveRecord],
}

/// Writer of the table.
#[derive(Debug)]
pub struct IterationTable {
    pub(crate) rows: Rows,
}

impl IterationTable {
    /// Creates the file and writes its header, for participants of these roles and coupling data of
    /// these names.
    pub fn create(path: &Path, roles: &[&str], fields: &[String]) -> Result<Self, RunError> {
        let mut text = Vec::new();
        head(&mut text, roles, fields);
        Ok(Self { rows: Rows::create(path, text)? })
    }

    /// Opens the table of a resumed run, and discards the content after the first `bytes` bytes.
    ///
    /// # Errors
    /// The file is shorter, or cannot be opened.
    pub fn resume(path: &Path, bytes: u64) -> Result<Self, RunError> {
        Ok(Self { rows: Rows::resume(path, bytes)? })
    }

    /// Adds the row of an iteration. The row reaches the disk within about a second, with a later
    /// row.
    pub fn row(&mut self, row: &IterationRecord<'_>) -> Result<(), RunError> {
        self.rows.add(|out| write_row(out, row))
    }
}

fn head(out: &mut Vec<u8>, roles: &[&str], fields: &[String]) {
    push(out, format_args!("window,iteration,start_s,end_s,residual"));
    for field in fields {
        push(out, format_args!(",residual_{field}"));
    }
    if !fields.is_empty() {
        push(out, format_args!(",relaxation,columns,dropped"));
    }
    push(out, format_args!(",coupling_s,heat_sent_w,heat_received_w"));
    for role in roles {
        let of_role = format_args!(",{role}_s,{role}_work,{role}_substeps,{role}_inner_iterations");
        push(out, of_role);
    }
    out.push(b'\n');
}

fn write_row(out: &mut Vec<u8>, row: &IterationRecord<'_>) {
    let Step { window, iteration, start, end } = row.step;
    push(out, format_args!("{window},{iteration},{start},{end}"));
    cell(out, row.residual);
    for residual in row.residuals {
        cell(out, Some(*residual));
    }
    if !row.residuals.is_empty() {
        cell(out, row.taken.relaxation);
        match row.taken.columns {
            Some(columns) => push(out, format_args!(",{columns},{}", row.taken.dropped)),
            None => push(out, format_args!(",,")),
        }
    }
    push(out, format_args!(",{:.9}", row.coupling_seconds));
    cell(out, row.balance.sent);
    cell(out, row.balance.received);
    for SolveRecord { model_seconds, work, substeps, inner_iterations, .. } in row.solved {
        push(out, format_args!(",{model_seconds:.9},{work},{substeps},{inner_iterations}"));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the header and one row, with these fields as coupling data.
    fn table(fields: &[String], residuals: &[f64], taken: AccelerationStats) -> Vec<String> {
        let mut text = Vec::new();
        head(&mut text, &["mech", "thermal"], fields);
        let row = IterationRecord {
            step: &Step::STEADY,
            residual: residuals.first().copied(),
            residuals,
            taken: &taken,
            coupling_seconds: 0.25,
            balance: &Balance { sent: Some(1.5), ..Balance::default() },
            solved: &[SolveRecord::default(); 2],
        };
        write_row(&mut text, &row);
        let text = String::from_utf8(text).unwrap();
        let columns: Vec<usize> = text.lines().map(|l| l.split(',').count()).collect();
        assert_eq!(columns[0], columns[1], "{text}");
        text.lines().map(str::to_owned).collect()
    }

    #[test]
    fn an_explicit_scheme_has_no_columns_for_iterates() {
        let lines = table(&[], &[], AccelerationStats::default());
        let head = "window,iteration,start_s,end_s,residual,coupling_s,heat_sent_w,heat_received_w";
        assert!(lines[0].starts_with(&format!("{head},mech_s,mech_work,")), "{}", lines[0]);
        assert!(lines[1].starts_with("0,1,0,0,,0.250000000,1.5e0,,0.000000000,0,0,0,"));
    }

    #[test]
    fn an_implicit_scheme_tells_how_it_goes_on() {
        let taken = AccelerationStats { relaxation: None, columns: Some(7), dropped: 1 };
        let lines = table(&["rail_temperature".to_owned(), "x".to_owned()], &[2.0, 1e-7], taken);
        let part = "residual,residual_rail_temperature,residual_x,relaxation,columns,dropped,";
        assert!(lines[0].contains(part), "{}", lines[0]);
        assert!(lines[1].starts_with("0,1,0,0,2e0,2e0,1e-7,,7,1,0.25"), "{}", lines[1]);
        let done = table(&["x".to_owned()], &[1e-7], AccelerationStats::default());
        assert!(done[1].starts_with("0,1,0,0,1e-7,1e-7,,,,0.25"), "{}", done[1]);
    }
}
