//! The points of a sweep in a file that only grows: a line of JSON for each, and one for each quantity before the
//! first point that has it. What has a line is never run again, however the sweep ends; a last line that is
//! not whole is run again.

use super::study::{Row, Study};
use crate::study::folder::StudyFolder;
use crate::study::output::{Kept, read_file};
use crate::study::quantity::Quantity;
use run::error::{RunError, file_failure};
use run::results::write::fresh;
use rustix::fs::OFlags;
use serde::{Deserialize, Serialize};
use std::fs::File;
use std::io::{self, BufRead, BufReader, Seek, SeekFrom, Write};
use std::os::unix::fs::OpenOptionsExt;
use std::path::{Path, PathBuf};

/// Name of the file.
pub(super) const FILE: &str = "points.jsonl";

/// What a line says.
#[derive(Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
enum Line<Q, R> {
    /// The next column is of this quantity.
    Quantity(Q),
    Point(R),
}

impl Kept for Study {
    const COMMAND: &'static str = "sweep";
    const FILE: &'static str = "sweep.json";
    const SCHEMA: u32 = 2;

    fn read(folder: &Path) -> Result<Self, RunError> {
        let mut study: Self = read_file(folder)?;
        read(&mut study, &folder.join(FILE))?;
        study.rows.sort_by(|a, b| a.at.cmp(&b.at));
        Ok(study)
    }
}

/// Adds the points of a file to a sweep; the length of its whole lines \[byte\].
///
/// # Errors
/// The file cannot be read, or a line is not one of this sweep.
pub(super) fn read(study: &mut Study, path: &Path) -> Result<u64, RunError> {
    let failed = |error: io::Error| file_failure(path, &error);
    let mut file = BufReader::new(File::open(path).map_err(failed)?);
    let (mut line, mut columns, mut bytes) = (Vec::new(), Vec::new(), 0);
    for number in 1.. {
        line.clear();
        let length = file.read_until(b'\n', &mut line).map_err(failed)?;
        if line.last() != Some(&b'\n') {
            break;
        }
        take(study, &line, &mut columns).map_err(|why| {
            let fix = "remove it and what follows, or replace the sweep with --replace";
            RunError::Usage(format!("{}, line {number}: {why}; {fix}", path.display()))
        })?;
        bytes += length as u64;
    }
    Ok(bytes)
}

fn take(study: &mut Study, line: &[u8], columns: &mut Vec<usize>) -> Result<(), String> {
    match serde_json::from_slice(line).map_err(|error| error.to_string())? {
        Line::<Quantity, Row>::Quantity(one) => columns.push(study.learn(&one)),
        Line::Point(row) if row.values.len() > columns.len() => {
            return Err(format!("{} values of {} quantities", row.values.len(), columns.len()));
        }
        Line::Point(row) => drop(study.add(row.placed(columns))?),
    }
    Ok(())
}

/// A sweep that is being made: what it finds is in its file at once.
#[derive(Debug)]
pub(super) struct Growing {
    /// The sweep.
    pub study: Study,
    file: File,
    path: PathBuf,
    /// Length of the file \[byte\].
    bytes: u64,
    /// Quantities that the file has.
    known: usize,
}

impl Growing {
    /// Begins a file.
    ///
    /// # Errors
    /// The file system.
    pub(super) fn begin(study: Study, folder: &StudyFolder) -> Result<Self, RunError> {
        let path = folder.open()?.join(FILE);
        let file = fresh(&path).map_err(|error| file_failure(&path, &error))?;
        Ok(Self { study, file, path, bytes: 0, known: 0 })
    }

    /// Goes on with the file of a sweep that was stopped.
    ///
    /// # Errors
    /// The file system, or a line that is not one of this sweep.
    pub(super) fn again(mut study: Study, folder: &StudyFolder) -> Result<Self, RunError> {
        let path = folder.open()?.join(FILE);
        if !path.exists() {
            return Self::begin(study, folder);
        }
        study.quantities.clear();
        let bytes = read(&mut study, &path)?;
        let open = || {
            let no_link = OFlags::NOFOLLOW.bits().cast_signed();
            let mut file = File::options().write(true).custom_flags(no_link).open(&path)?;
            file.set_len(bytes)?;
            file.seek(SeekFrom::End(0))?;
            Ok(file)
        };
        let file = open().map_err(|error| file_failure(&path, &error))?;
        let known = study.quantities.len();
        Ok(Self { study, file, path, bytes, known })
    }

    /// Adds a row, unless its point has been run.
    ///
    /// # Errors
    /// There is no such point, or the file system.
    pub(super) fn add(&mut self, row: Row) -> Result<(), RunError> {
        if !self.study.add(row).map_err(RunError::Usage)? {
            return Ok(());
        }
        let mut lines = Vec::new();
        let new = self.study.quantities[self.known..].iter().map(Line::<_, &Row>::Quantity);
        let rows = self.study.rows.last().map(Line::<&Quantity, _>::Point);
        new.chain(rows).for_each(|line| {
            serde_json::to_writer(&mut lines, &line).expect("plain data");
            lines.push(b'\n');
        });
        self.file.write_all(&lines).map_err(|error| {
            let _ = self.file.set_len(self.bytes);
            file_failure(&self.path, &error)
        })?;
        self.known = self.study.quantities.len();
        self.bytes += lines.len() as u64;
        Ok(())
    }

    /// Takes the points that another sweep has found, of the same points or of a part of them.
    ///
    /// # Errors
    /// The file system, or a line that is not one of this sweep.
    pub(super) fn collect(&mut self, mut other: Study, file: &Path) -> Result<(), RunError> {
        other.quantities.clear();
        read(&mut other, file)?;
        let columns: Vec<usize> =
            other.quantities.iter().map(|one| self.study.learn(one)).collect();
        other.rows.into_iter().try_for_each(|row| self.add(row.placed(&columns)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::axis::Axis;
    use contract::figure::Measure;
    use proptest::prelude::*;

    fn study() -> Study {
        let vary = [Axis::read("a=1,2,3").unwrap(), Axis::read("b=x,y").unwrap()];
        let text = serde_json::json!({
            "schema": 2, "complete": false, "case": "c", "title": null, "file": "c.toml", "options": [],
            "vary": vary, "drawn": [], "quantities": [], "wall_s": 0.0
        });
        serde_json::from_value(text).unwrap()
    }

    fn quantity(key: &str) -> Quantity {
        Quantity { key: key.to_owned(), name: key.to_owned(), measure: Measure::Relative }
    }

    fn row(at: [usize; 2], values: &[f64]) -> Row {
        let failed = values.is_empty().then(|| "no \"answer\"\nhere".to_owned());
        Row { at: at.to_vec(), values: values.to_vec(), failed, wall_s: 0.1 + 0.2 }
    }

    /// A file with two quantities, the second of which only the last of three points has.
    fn written() -> Vec<u8> {
        let place = tempfile::tempdir().unwrap();
        let path = place.path().join(FILE);
        let file = File::create(&path).unwrap();
        let mut growing = Growing { study: study(), file, path: path.clone(), bytes: 0, known: 0 };
        growing.study.learn(&quantity("heat.rise_k"));
        growing.add(row([2, 1], &[1.0 / 3.0])).unwrap();
        growing.add(row([0, 0], &[])).unwrap();
        growing.study.learn(&quantity("load.force_n"));
        growing.add(row([1, 0], &[f64::NAN, -1e-300])).unwrap();
        growing.add(row([1, 0], &[5.0, 5.0])).unwrap();
        std::fs::read(path).unwrap()
    }

    fn reread(text: &[u8]) -> Result<(Study, u64), String> {
        let place = tempfile::tempdir().unwrap();
        let path = place.path().join(FILE);
        std::fs::write(&path, text).unwrap();
        let mut study = study();
        let bytes = read(&mut study, &path).map_err(|error| error.to_string())?;
        Ok((study, bytes))
    }

    #[test]
    fn what_is_written_is_read_to_the_bit() {
        let text = written();
        let (study, bytes) = reread(&text).unwrap();
        assert_eq!(bytes, text.len() as u64);
        assert_eq!(study.rows[..2], [row([2, 1], &[1.0 / 3.0]), row([0, 0], &[])]);
        assert_eq!(study.rows.len(), 3, "a point that is run is not added again");
        assert_eq!([0, 1].map(|column| study.rows[2].value(column)), [None, Some(-1e-300)]);
        assert_eq!(study.missing(), [1, 3, 4]);
    }

    /// Cut anywhere, the whole lines are there.
    #[test]
    fn a_cut_costs_the_line_that_it_is_in() {
        let text = written();
        for cut in 0..=text.len() {
            let (study, bytes) = reread(&text[..cut]).unwrap();
            let points = text[..bytes as usize]
                .split(|c| *c == b'\n')
                .filter(|l| l.starts_with(b"{\"point"));
            assert_eq!(study.rows.len(), points.count(), "cut at {cut}");
            assert!(bytes <= cut as u64);
        }
    }

    #[test]
    fn lines_of_another_sweep_are_refused() {
        for (line, why) in [
            (
                "{\"point\":{\"at\":[3,0],\"wall_s\":1}}",
                "line 1: there is no point [3, 0]; remove it",
            ),
            ("{\"point\":{\"at\":[0],\"wall_s\":1}}", "there is no point [0]"),
            ("{\"point\":{\"at\":[0,0],\"values\":[1],\"wall_s\":1}}", "1 values of 0 quantities"),
            ("{\"other\":1}", "unknown variant `other`"),
            ("[", "line 1: expected value"),
        ] {
            let error = reread(format!("{line}\n").as_bytes()).unwrap_err();
            assert!(error.contains(why), "{line}: {error}");
        }
    }

    proptest! {
        /// Whatever a byte becomes, it is read or refused; what is read are points of the sweep.
        #[test]
        fn a_damaged_file_is_read_or_refused(at in 0usize..600, byte in any::<u8>()) {
            let mut text = written();
            let at = at % text.len();
            text[at] = byte;
            if let Ok((study, _)) = reread(&text) {
                prop_assert!(study.rows.iter().all(|row| row.at[0] < 3 && row.at[1] < 2));
                prop_assert!(study.rows.iter().all(|row| row.values.len() <= study.quantities.len()));
            }
        }
    }
}
