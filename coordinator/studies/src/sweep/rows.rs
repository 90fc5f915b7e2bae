//! The points of a sweep in an append-only file: one line of JSON for each point, and one for each
//! quantity before the first point that contains the quantity. A point with a complete line is
//! never run again. An incomplete last line is ignored, and its point repeated.

use super::study::{Row, Study};
use crate::study::folder::StudyFolder;
use crate::study::output::{StudyFile, read_file};
use crate::study::quantity::Quantity;
use contract::input_file;
use run::error::{RunError, file_failure, input_failure};
use serde::{Deserialize, Serialize};
use std::collections::HashMap;
use std::fs::File;
use std::io::{self, BufRead, BufReader, Write};
use std::path::{Path, PathBuf};

pub(super) const FILE: &str = "points.jsonl";

/// Content of a line.
#[derive(Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
enum Line<Q, R> {
    /// Quantity of the next column.
    Quantity(Q),
    Point(R),
}

impl StudyFile for Study {
    const COMMAND: &'static str = "sweep";
    const FILE: &'static str = "sweep.json";
    const SCHEMA: u32 = 3;

    fn read(folder: &Path) -> Result<Self, RunError> {
        let mut study: Self = read_file(folder)?;
        read(&mut study, &folder.join(FILE), folder)?;
        study.rows.sort_by(|a, b| a.at.cmp(&b.at));
        Ok(study)
    }
}

/// Adds the points of a file to a sweep and returns the length of the complete lines \[byte\].
/// Messages name the sweep by `folder`.
///
/// # Errors
/// The file cannot be read, or a line does not belong to this sweep.
pub(super) fn read(study: &mut Study, path: &Path, folder: &Path) -> Result<u64, RunError> {
    let shown = folder.join(FILE);
    let failed = |error: io::Error| file_failure(&shown, &error);
    let file = input_file::open(path).map_err(|error| input_failure(&shown, &error))?;
    let mut file = BufReader::new(file);
    let (mut line, mut columns, mut bytes) = (Vec::new(), Vec::new(), 0);
    for number in 1.. {
        line.clear();
        let length = file.read_until(b'\n', &mut line).map_err(failed)?;
        if line.last() != Some(&b'\n') {
            break;
        }
        take(study, &line, &mut columns).map_err(|why| {
            let fix = "remove this line and all following ones, or start again with --replace";
            RunError::Usage(format!("{}, line {number}: {why}; {fix}", shown.display()))
        })?;
        bytes += length as u64;
    }
    Ok(bytes)
}

fn take(study: &mut Study, line: &[u8], columns: &mut Vec<usize>) -> Result<(), String> {
    match serde_json::from_slice(line).map_err(|error| error.to_string())? {
        Line::<Quantity, Row>::Quantity(one) => columns.push(study.learn(&one)),
        // A row must have a value or null for each quantity known so far. A missing value would
        // shift the others to wrong names.
        Line::Point(row) if row.failed.is_none() && row.values.len() != columns.len() => {
            return Err(format!("{} values for {} quantities", row.values.len(), columns.len()));
        }
        Line::Point(row) if row.failed.is_some() && !row.values.is_empty() => {
            return Err("a failed point has values".to_owned());
        }
        Line::Point(row) => drop(study.add(row.placed(columns))?),
    }
    Ok(())
}

/// A sweep in progress, whose results are written to the file immediately.
#[derive(Debug)]
pub(super) struct SweepInProgress {
    pub study: Study,
    file: File,
    /// Path of the file, for messages.
    path: PathBuf,
    /// Length of the file \[byte\].
    bytes: u64,
    /// Number of quantities in the file.
    known: usize,
}

impl SweepInProgress {
    /// Begins a new file.
    ///
    /// # Errors
    /// The file cannot be created.
    pub(super) fn begin(study: Study, folder: &StudyFolder) -> Result<Self, RunError> {
        let (file, path) = (folder.grow(FILE, 0)?, folder.path().join(FILE));
        Ok(Self { study, file, path, bytes: 0, known: 0 })
    }

    /// Resumes the file of an interrupted sweep.
    ///
    /// # Errors
    /// The file cannot be read or opened, or a line does not belong to this sweep.
    pub(super) fn again(mut study: Study, folder: &StudyFolder) -> Result<Self, RunError> {
        let (place, path) = (folder.open()?.join(FILE), folder.path().join(FILE));
        if !place.exists() {
            return Self::begin(study, folder);
        }
        study.quantities.clear();
        let bytes = read(&mut study, &place, folder.path())?;
        let (file, known) = (folder.grow(FILE, bytes)?, study.quantities.len());
        Ok(Self { study, file, path, bytes, known })
    }

    /// Adds a row, unless its point is already known.
    ///
    /// # Errors
    /// The point does not exist, or the file cannot be written.
    pub(super) fn add(&mut self, mut row: Row) -> Result<(), RunError> {
        if row.failed.is_none() {
            row.values.resize(self.study.quantities.len(), f64::NAN);
        }
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

    /// Adds the points of another sweep, which has the same points or a part of them.
    ///
    /// # Errors
    /// The files cannot be read or written, a line does not belong to the other sweep, or both
    /// sweeps have different results for a point.
    pub(super) fn collect(&mut self, mut other: Study, folder: &Path) -> Result<(), RunError> {
        other.quantities.clear();
        read(&mut other, &folder.join(FILE), folder)?;
        let columns: Vec<usize> =
            other.quantities.iter().map(|one| self.study.learn(one)).collect();
        let rows: Vec<Row> = other.rows.into_iter().map(|row| row.placed(&columns)).collect();
        let known: HashMap<&[usize], &Row> =
            self.study.rows.iter().map(|row| (&*row.at, row)).collect();
        let twice = rows.iter().filter_map(|row| Some((*known.get(&*row.at)?, row)));
        if let Some(what) =
            twice.filter_map(|(one, other)| self.study.contradiction(one, other)).next()
        {
            let fix = "leave out one of the two folders, or run the points again with --replace";
            let folder = folder.display();
            return Err(RunError::Usage(format!(
                "{folder} contradicts known results: {what}; {fix}"
            )));
        }
        rows.into_iter().try_for_each(|row| self.add(row))
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
            "schema": 3, "complete": false, "case": "c", "title": null, "file": "c.toml", "options": [],
            "identity": {"programs": {}, "values": {}, "files": {}},
            "vary": vary, "drawn": [], "quantities": [], "wall_s": 0.0
        });
        serde_json::from_value(text).unwrap()
    }

    fn quantity(key: &str) -> Quantity {
        Quantity::new(key, key, Measure::Relative)
    }

    fn row(at: [usize; 2], values: &[f64]) -> Row {
        let failed = values.is_empty().then(|| "no \"answer\"\nhere".to_owned());
        let warnings = Vec::new();
        Row { at: at.to_vec(), values: values.to_vec(), failed, warnings, wall_s: 0.1 + 0.2 }
    }

    /// A file with two quantities; only the last of the three points has the second one.
    fn written() -> Vec<u8> {
        let place = tempfile::tempdir().unwrap();
        let path = place.path().join(FILE);
        let file = File::create(&path).unwrap();
        let mut growing =
            SweepInProgress { study: study(), file, path: path.clone(), bytes: 0, known: 0 };
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
        let bytes = read(&mut study, &path, place.path()).map_err(|error| error.to_string())?;
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

    /// A file cut at any byte keeps its complete lines.
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
                "line 1: there is no point [3, 0]; remove this line",
            ),
            ("{\"point\":{\"at\":[0],\"wall_s\":1}}", "there is no point [0]"),
            ("{\"point\":{\"at\":[0,0],\"values\":[1],\"wall_s\":1}}", "1 values for 0 quantities"),
            (
                "{\"point\":{\"at\":[0,0],\"values\":[1],\"failed\":\"x\",\"wall_s\":1}}",
                "a failed point has values",
            ),
            ("{\"other\":1}", "unknown variant `other`"),
            ("[", "line 1: expected value"),
        ] {
            let error = reread(format!("{line}\n").as_bytes()).unwrap_err();
            assert!(error.contains(why), "{line}: {error}");
        }
    }

    /// A missing value would shift the following ones to wrong names.
    #[test]
    fn a_row_without_one_of_its_values_is_refused() {
        let text = String::from_utf8(written()).unwrap();
        assert!(text.contains("[null,-1e-300]"), "{text}");
        for (whole, cut) in [("[null,-1e-300]", "[-1e-300]"), ("[0.3333333333333333]", "[]")] {
            let error = reread(text.replace(whole, cut).as_bytes()).unwrap_err();
            assert!(error.contains(" values for "), "{cut}: {error}");
        }
    }

    /// Two sweeps with results for the same point must agree, or the conflict is reported.
    #[test]
    fn folders_that_contradict_each_other_are_refused() {
        let place = tempfile::tempdir().unwrap();
        let collected = |rise: f64| {
            let path = place.path().join("own");
            let file = File::create(&path).unwrap();
            let mut growing = SweepInProgress { study: study(), file, path, bytes: 0, known: 0 };
            growing.study.drawn = vec!["heat.rise_k".to_owned()];
            growing.study.learn(&quantity("heat.rise_k"));
            growing.add(row([2, 1], &[rise])).unwrap();
            std::fs::write(place.path().join(FILE), written()).unwrap();
            let ended = growing.collect(study(), place.path());
            ended.map(|()| growing.study.rows.len()).map_err(|error| error.to_string())
        };
        assert_eq!(collected(1.0 / 3.0), Ok(3));
        assert_eq!(collected(1.0 / 3.0 + 1e-9), Ok(3), "another machine may round differently");
        let error = collected(0.25).unwrap_err();
        assert!(error.contains("a = 3, b = y has heat.rise_k = 0.25"), "{error}");
    }

    proptest! {
        /// A file with one damaged byte is read or refused; points that are read belong to the
        /// sweep.
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
