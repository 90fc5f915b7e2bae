//! `iterations.csv`: one row an iteration, written as the run goes.

use crate::error::{RunError, file_failure};
use crate::session::{HeatBalance, SolveRecord};
use proto::model::Step;
use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Longest time for which rows stay in memory while more are written.
const UNWRITTEN: Duration = Duration::from_secs(1);

/// The table being written.
#[derive(Debug)]
pub struct IterationTable {
    out: BufWriter<File>,
    path: PathBuf,
    flushed: Instant,
}

impl IterationTable {
    /// Creates the file and writes its head.
    pub fn create(path: &Path, roles: &[&str]) -> Result<Self, RunError> {
        let failed = |error| file_failure(path, &error);
        let mut out = BufWriter::new(File::create(path).map_err(failed)?);
        head(&mut out, roles).map_err(failed)?;
        out.flush().map_err(failed)?;
        Ok(Self { out, path: path.to_owned(), flushed: Instant::now() })
    }

    /// Writes the row of an iteration; it is on disk a second later, if the run goes on.
    pub fn row(
        &mut self,
        step: &Step,
        residual: Option<f64>,
        heat: &HeatBalance,
        solved: &[SolveRecord],
    ) -> Result<(), RunError> {
        write_row(&mut self.out, step, residual, heat, solved)
            .map_err(|error| file_failure(&self.path, &error))?;
        if self.flushed.elapsed() >= UNWRITTEN { self.flush() } else { Ok(()) }
    }

    /// Writes what is still buffered.
    pub fn flush(&mut self) -> Result<(), RunError> {
        self.flushed = Instant::now();
        self.out.flush().map_err(|error| file_failure(&self.path, &error))
    }
}

fn head(out: &mut impl Write, roles: &[&str]) -> io::Result<()> {
    write!(out, "window,iteration,start_s,end_s,residual,heat_sent_w,heat_received_w")?;
    for role in roles {
        write!(out, ",{role}_s,{role}_work,{role}_substeps,{role}_inner_iterations")?;
    }
    writeln!(out)
}

fn write_row(
    out: &mut impl Write,
    step: &Step,
    residual: Option<f64>,
    heat: &HeatBalance,
    solved: &[SolveRecord],
) -> io::Result<()> {
    write!(out, "{},{},{},{}", step.window, step.iteration, step.start, step.end)?;
    for value in [residual, heat.sent, heat.received] {
        match value {
            Some(value) => write!(out, ",{value:e}")?,
            None => write!(out, ",")?,
        }
    }
    for s in solved {
        write!(out, ",{:.9},{},{},{}", s.model_seconds, s.work, s.substeps, s.inner_iterations)?;
    }
    writeln!(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn head_and_rows_have_the_same_columns() {
        let mut text = Vec::new();
        head(&mut text, &["mech", "thermal"]).unwrap();
        let heat = HeatBalance { sent: Some(1.5), received: None };
        write_row(&mut text, &Step::STEADY, None, &heat, &[SolveRecord::default(); 2]).unwrap();
        let text = String::from_utf8(text).unwrap();
        let columns: Vec<usize> = text.lines().map(|l| l.split(',').count()).collect();
        assert_eq!(columns, [15, 15]);
        assert!(text.contains("\n0,1,0,0,,1.5e0,,0.000000000,0,0,0,"));
    }
}
