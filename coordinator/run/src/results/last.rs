//! `fields/last.bin`: the last written fields on structured grids, and the names of all series. The
//! report draws these fields; the VTK files are written for ParaView.

use super::read::read_file;
use super::vtk::{FieldLabel, FieldOutput, read_collection};
use super::write::replace;
use crate::error::{RunError, file_failure};
use crate::sealed::{self, Magic};
use contract::grid::Structured;
use contract::input_file::InputFileError;
use proto::binary;
use serde::{Deserialize, Serialize};
use std::borrow::Cow;
use std::fs;
use std::io;
use std::path::Path;

/// Name of the file.
pub const FILE: &str = "last.bin";

const MAGIC: &Magic = b"COSIMLF3";

/// Content of the file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LastFields<'a> {
    /// Last accepted window.
    pub window: u64,
    /// End of that window [s].
    pub time: f64,
    /// Names of the series of all grids.
    pub series: Vec<String>,
    /// Fields. Those of one grid have the order of its VTK files.
    pub fields: Vec<LastField<'a>>,
}

/// Last values of a field.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LastField<'a> {
    /// Name of the series.
    pub series: String,
    /// Grid of the field.
    pub grid: Structured,
    /// Name, unit, components, body.
    pub kind: Cow<'a, FieldLabel>,
    /// Values, component-major.
    pub values: Cow<'a, [f64]>,
}

impl<'a> LastFields<'a> {
    /// Returns the content of the file for these fields.
    #[must_use]
    pub fn of(shown: &'a [FieldOutput<'a>], series: Vec<String>, window: u64, time: f64) -> Self {
        let field = |one: &'a FieldOutput<'a>| {
            let grid = *one.grid.as_structured().filter(|grid| grid.points() > 1)?;
            let (kind, values) = (Cow::Borrowed(&one.kind), Cow::Borrowed(one.values));
            Some(LastField { series: one.series.clone(), grid, kind, values })
        };
        let fields = shown.iter().filter_map(field).collect();
        Self { window, time, series, fields }
    }

    /// Writes the file into the folder of the fields.
    pub fn write(&self, folder: &Path) -> Result<(), RunError> {
        let path = folder.join(FILE);
        let bytes = sealed::seal(MAGIC, self);
        let bytes = bytes.map_err(|why| file_failure(&path, &io::Error::other(why)))?;
        replace(&path, &bytes)
    }
}

impl LastFields<'static> {
    /// Reads the file of a folder of fields; `None` if it does not exist.
    ///
    /// # Errors
    /// The file is damaged or cannot be read; the message names the reason.
    pub fn read(folder: &Path) -> Result<Option<Self>, String> {
        let path = folder.join(FILE);
        let fail = |why: &dyn std::fmt::Display| format!("{FILE}: {why}");
        match fs::symlink_metadata(&path) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
            Err(error) => return Err(fail(&error)),
            Ok(found) if !found.is_file() || found.len() > binary::LONGEST as u64 => {
                return Err(fail(&format!("not a file of fields: {} bytes", found.len())));
            }
            Ok(_) => {}
        }
        let bytes = fs::read(&path).map_err(|error| fail(&error))?;
        Self::parse(&bytes).map(Some).map_err(|why| fail(&why))
    }

    fn parse(bytes: &[u8]) -> Result<Self, String> {
        let read: Self = sealed::open(MAGIC, bytes).map_err(|broken| broken.to_string())?;
        if let Some(name) = read.series.iter().find(|name| name.contains('/')) {
            return Err(format!("it names {name:?}, which is not a series of the folder"));
        }
        match read.fields.iter().find(|field| !field.fits()) {
            Some(field) => Err(format!("`{}` does not fit its grid", field.kind.name)),
            None => Ok(read),
        }
    }
}

/// Reads the time [s] and the name of every file of a series; none if the series has no file yet.
///
/// # Errors
/// The list of the files cannot be read; the message names the reason.
pub fn files_of(folder: &Path, series: &str) -> Result<Vec<(f64, String)>, String> {
    let name = format!("{series}.pvd");
    match read_file(&folder.join(&name)) {
        Ok(text) => read_collection(&String::from_utf8_lossy(&text)),
        Err(InputFileError::System(error)) if error.kind() == io::ErrorKind::NotFound => {
            Ok(Vec::new())
        }
        Err(error) => Err(error.to_string()),
    }
    .map_err(|why| format!("{name}: {why}"))
}

impl LastField<'_> {
    /// Returns whether there is a value of every component for every point.
    fn fits(&self) -> bool {
        let points = self.grid.ni.checked_mul(self.grid.nj);
        let values = points.and_then(|points| points.checked_mul(self.kind.components as usize));
        !self.values.is_empty() && values == Some(self.values.len())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use contract::field::TABLE;
    use contract::grid::Grid;
    use proptest::prelude::*;

    /// Writes two fields, changes the bytes, and reads them back.
    fn changed(change: impl FnOnce(&mut Vec<u8>)) -> Result<LastFields<'static>, String> {
        let grid = Grid::structured("g", Structured::contact_plane(-0.25, 0.5, 0.5, 1.0, 3, 2));
        let values: Vec<f64> = (0..12).map(|k| f64::from(k) / 3.0).collect();
        let [one, two] = [1, 2].map(|n| TABLE.iter().find(|spec| spec.components == n).unwrap());
        let kinds = [one.kind(), two.kind()];
        let shown = |kind, values| FieldOutput::new("p", &grid, kind, values, None);
        let fields = [shown(&kinds[0], &values[..6]), shown(&kinds[1], &values[..])];
        let last = LastFields::of(&fields, vec!["p_g".to_owned()], 7, 0.5);
        let mut bytes = sealed::seal(MAGIC, &last).unwrap();
        assert_eq!(LastFields::parse(&bytes).unwrap(), last, "read back bit-identically");
        change(&mut bytes);
        LastFields::parse(&bytes)
    }

    #[test]
    fn what_is_wrong_is_named() {
        assert_eq!(changed(|bytes| bytes[7] += 1).unwrap_err(), "not of this version");
        assert_eq!(changed(|bytes| bytes.truncate(12)).unwrap_err(), "not of this version");
        assert!(changed(|bytes| bytes.truncate(80)).unwrap_err().contains("in 80 bytes"));
        let grid = Structured::contact_plane(0.0, 0.0, 1.0, 1.0, usize::MAX, 2);
        let kind = Cow::Owned(FieldLabel::of(&TABLE[0].kind(), None));
        let field = LastField { series: String::new(), grid, kind, values: Cow::Owned(vec![0.0]) };
        let whole = LastFields { window: 0, time: 0.0, series: vec![], fields: vec![field] };
        let read = |last: &LastFields| LastFields::parse(&sealed::seal(MAGIC, last).unwrap());
        assert_eq!(read(&whole).unwrap_err(), "`geometry` does not fit its grid");
        let outside = LastFields { series: vec!["../b".to_owned()], fields: vec![], ..whole };
        assert!(read(&outside).unwrap_err().contains("not a series of the folder"));
    }

    proptest! {
        #![proptest_config(crate::fuzz_config())]

        /// Reading arbitrary bytes, with or without a valid checksum before them, never panics.
        #[test]
        fn arbitrary_bytes_are_refused(bytes in prop::collection::vec(any::<u8>(), 0..400)) {
            prop_assert!(LastFields::parse(&bytes).is_err());
            let whole = [MAGIC.as_slice(), &sealed::sum(&bytes).to_le_bytes(), &bytes];
            let _ = LastFields::parse(&whole.concat());
        }

        /// Every change of a byte is detected.
        #[test]
        fn every_change_is_seen(at in any::<prop::sample::Index>(), by in 1..=u8::MAX) {
            let result = changed(|bytes| {
                let at = at.index(bytes.len());
                bytes[at] = bytes[at].wrapping_add(by);
            });
            prop_assert!(result.is_err());
        }
    }
}
