//! `iterations.csv`: one row an iteration, written as the run goes.
//!
//! | column | |
//! |---|---|
//! | `window`, `iteration` | from 0, from 1 |
//! | `start_s`, `end_s` | the window |
//! | `residual`, `residual_FIELD` | ‖r‖/‖x̃‖ of the coupling data: the largest, and each |
//! | `relaxation`, `columns`, `dropped` | how the next iterate was chosen; empty in the last one |
//! | `coupling_s` | time of the iteration in which no model computed |
//! | `heat_sent_w`, `heat_received_w` | mean power through conservative fields |
//! | `ROLE_s`, `ROLE_work`, ... | what each participant reports of its solve |
//!
//! A window that is solved again, with another end, has its number again.
//!
//! What an explicit scheme does not have, residuals of fields and the choice of iterates, has no
//! column.

use crate::error::{RunError, file_failure};
use crate::results::dir::shown;
use crate::results::write::fresh;
use crate::session::{HeatBalance, SolveRecord};
use contract::step::Step;
use coupling::accelerate::StepTaken;
use rustix::fs::OFlags;
use std::fs::File;
use std::io::{self, Seek, SeekFrom, Write};
use std::os::unix::fs::OpenOptionsExt;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Longest time for which rows stay in memory while more are written.
const UNWRITTEN: Duration = Duration::from_secs(1);

/// What there is to tell of an iteration.
#[derive(Clone, Copy, Debug)]
pub struct IterationRecord<'a> {
    /// Window and iteration.
    pub step: &'a Step,
    /// The largest relative residual.
    pub residual: Option<f64>,
    /// That of every field of the coupling data.
    pub residuals: &'a [f64],
    /// How the next iterate was chosen.
    pub taken: &'a StepTaken,
    /// Seconds in which no model computed.
    pub coupling_seconds: f64,
    /// Heat across the interface.
    pub heat: &'a HeatBalance,
    /// What the participants report.
    pub solved: &'a [SolveRecord],
}

/// The table being written.
#[derive(Debug)]
pub struct IterationTable {
    file: File,
    path: PathBuf,
    /// Rows that are not in the file yet.
    rows: Vec<u8>,
    /// Length of the file \[byte\].
    bytes: u64,
    flushed: Instant,
}

impl IterationTable {
    /// Creates the file and writes its head, for participants of these roles and fields of these
    /// names in the coupling data.
    pub fn create(path: &Path, roles: &[&str], fields: &[String]) -> Result<Self, RunError> {
        let file = fresh(path).map_err(|error| file_failure(path, &error))?;
        let mut table = Self::in_file(file, path, 0);
        head(&mut table.rows, roles, fields).map_err(|error| file_failure(path, &error))?;
        table.flush()?;
        Ok(table)
    }

    fn in_file(file: File, path: &Path, bytes: u64) -> Self {
        Self { file, path: path.to_owned(), rows: Vec::new(), bytes, flushed: Instant::now() }
    }

    /// Opens the table of a run that is resumed, and forgets what comes after its first `bytes`
    /// bytes.
    ///
    /// # Errors
    /// The file is shorter, or cannot be opened.
    pub fn resume(path: &Path, bytes: u64) -> Result<Self, RunError> {
        let failed = |error| file_failure(path, &error);
        let no_link = OFlags::NOFOLLOW.bits().cast_signed();
        let open = File::options().write(true).custom_flags(no_link).open(path);
        let mut file = open.map_err(failed)?;
        let found = file.metadata().map_err(failed)?.len();
        if found < bytes {
            let shown = shown(path);
            let shown = shown.display();
            return Err(RunError::Usage(format!(
                "{shown} has {found} bytes, and had {bytes} at the checkpoint; the run cannot be \
                 resumed without them"
            )));
        }
        file.set_len(bytes).and_then(|()| file.seek(SeekFrom::End(0))).map_err(failed)?;
        Ok(Self::in_file(file, path, bytes))
    }

    /// Flushes everything to the disk; the length of the file \[byte\].
    pub fn seal(&mut self) -> Result<u64, RunError> {
        self.flush()?;
        self.file.sync_data().map_err(|error| file_failure(&self.path, &error))?;
        Ok(self.bytes)
    }

    /// Writes the row of an iteration; it is on disk a second later, if the run goes on.
    pub fn row(&mut self, row: &IterationRecord<'_>) -> Result<(), RunError> {
        write_row(&mut self.rows, row).map_err(|error| file_failure(&self.path, &error))?;
        if self.flushed.elapsed() >= UNWRITTEN { self.flush() } else { Ok(()) }
    }

    /// Writes what is not in the file yet; on a disk that is full the file ends with the last row that is
    /// there as a whole.
    pub fn flush(&mut self) -> Result<(), RunError> {
        self.flushed = Instant::now();
        let written = self.file.write_all(&self.rows);
        if written.is_ok() {
            self.bytes += self.rows.len() as u64;
        }
        self.rows.clear();
        written.map_err(|error| {
            let _ = self.file.set_len(self.bytes);
            file_failure(&self.path, &error)
        })
    }
}

fn head(out: &mut impl Write, roles: &[&str], fields: &[String]) -> io::Result<()> {
    write!(out, "window,iteration,start_s,end_s,residual")?;
    for field in fields {
        write!(out, ",residual_{field}")?;
    }
    if !fields.is_empty() {
        write!(out, ",relaxation,columns,dropped")?;
    }
    write!(out, ",coupling_s,heat_sent_w,heat_received_w")?;
    for role in roles {
        write!(out, ",{role}_s,{role}_work,{role}_substeps,{role}_inner_iterations")?;
    }
    writeln!(out)
}

fn write_row(out: &mut impl Write, row: &IterationRecord<'_>) -> io::Result<()> {
    let step = row.step;
    write!(out, "{},{},{},{}", step.window, step.iteration, step.start, step.end)?;
    cell(out, row.residual)?;
    for residual in row.residuals {
        cell(out, Some(*residual))?;
    }
    if !row.residuals.is_empty() {
        cell(out, row.taken.relaxation)?;
        match row.taken.columns {
            Some(columns) => write!(out, ",{columns},{}", row.taken.dropped)?,
            None => write!(out, ",,")?,
        }
    }
    write!(out, ",{:.9}", row.coupling_seconds)?;
    cell(out, row.heat.sent)?;
    cell(out, row.heat.received)?;
    for s in row.solved {
        write!(out, ",{:.9},{},{},{}", s.model_seconds, s.work, s.substeps, s.inner_iterations)?;
    }
    writeln!(out)
}

/// A number, or nothing.
fn cell(out: &mut impl Write, value: Option<f64>) -> io::Result<()> {
    match value {
        Some(value) => write!(out, ",{value:e}"),
        None => write!(out, ","),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Head and one row, with these fields as coupling data.
    fn table(fields: &[String], residuals: &[f64], taken: StepTaken) -> Vec<String> {
        let mut text = Vec::new();
        head(&mut text, &["mech", "thermal"], fields).unwrap();
        let row = IterationRecord {
            step: &Step::STEADY,
            residual: residuals.first().copied(),
            residuals,
            taken: &taken,
            coupling_seconds: 0.25,
            heat: &HeatBalance { sent: Some(1.5), ..HeatBalance::default() },
            solved: &[SolveRecord::default(); 2],
        };
        write_row(&mut text, &row).unwrap();
        let text = String::from_utf8(text).unwrap();
        let columns: Vec<usize> = text.lines().map(|l| l.split(',').count()).collect();
        assert_eq!(columns[0], columns[1], "{text}");
        text.lines().map(str::to_owned).collect()
    }

    #[test]
    fn an_explicit_scheme_has_no_columns_for_iterates() {
        let lines = table(&[], &[], StepTaken::default());
        let head = "window,iteration,start_s,end_s,residual,coupling_s,heat_sent_w,heat_received_w";
        assert!(lines[0].starts_with(&format!("{head},mech_s,mech_work,")), "{}", lines[0]);
        assert!(lines[1].starts_with("0,1,0,0,,0.250000000,1.5e0,,0.000000000,0,0,0,"));
    }

    #[test]
    fn an_implicit_scheme_tells_how_it_goes_on() {
        let taken = StepTaken { relaxation: None, columns: Some(7), dropped: 1 };
        let lines = table(&["rail_temperature".to_owned(), "x".to_owned()], &[2.0, 1e-7], taken);
        let part = "residual,residual_rail_temperature,residual_x,relaxation,columns,dropped,";
        assert!(lines[0].contains(part), "{}", lines[0]);
        assert!(lines[1].starts_with("0,1,0,0,2e0,2e0,1e-7,,7,1,0.25"), "{}", lines[1]);
        let done = table(&["x".to_owned()], &[1e-7], StepTaken::default());
        assert!(done[1].starts_with("0,1,0,0,1e-7,1e-7,,,,0.25"), "{}", done[1]);
    }
}
