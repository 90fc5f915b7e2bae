//! `open.py`: a state for ParaView that opens every series in its folder.

use super::shown::{Fields, array_name};
use crate::error::{RunError, file_failure};
use crate::results::write::replace;
use contract::input_file;
use std::collections::BTreeMap;
use std::io::{self, Read};
use std::path::Path;

/// Name of the file.
pub(in crate::results) const FILE: &str = "open.py";

/// Script without series.
const SCRIPT: &str = include_str!("open.py");

/// Place of the series in the script.
const NO_SERIES: &str = "SERIES = {}";

/// First bytes of every such file.
const HEAD: &[u8] = b"# Opens the series beside this file in ParaView";

/// Array by which each series is coloured.
#[derive(Debug, Default)]
pub(super) struct Scene {
    arrays: BTreeMap<String, String>,
    written: bool,
}

impl Scene {
    /// Adds a series with its fields. The first scalar field, or else the first field, gives the
    /// colours.
    pub(super) fn add(&mut self, series: &str, fields: &Fields) {
        let scalar = fields.iter().find(|(kind, _)| kind.components == 1);
        let Some((kind, _)) = scalar.or(fields.first()) else { return };
        if !self.arrays.contains_key(series) {
            self.arrays.insert(series.to_owned(), array_name(kind));
            self.written = false;
        }
    }

    /// Writes the file if its content has changed. A file of other origin under this name stays.
    pub(super) fn write(&mut self, folder: &Path) -> Result<(), RunError> {
        if self.written {
            return Ok(());
        }
        self.written = true;
        let path = folder.join(FILE);
        if path.symlink_metadata().is_ok() && !is_scene(&path) {
            let path = path.display();
            tracing::warn!(%path, "this file was not written by a run, so the ParaView state is not written");
            return Ok(());
        }
        // A JSON object of strings is also a Python dictionary.
        let series = serde_json::to_string_pretty(&self.arrays)
            .map_err(|error| file_failure(&path, &io::Error::from(error)))?;
        replace(&path, SCRIPT.replace(NO_SERIES, &format!("SERIES = {series}")).as_bytes())
    }
}

/// Returns whether the coordinator has written this file.
pub(in crate::results) fn is_scene(path: &Path) -> bool {
    let mut head = [0; HEAD.len()];
    input_file::open(path).is_ok_and(|mut file| file.read_exact(&mut head).is_ok()) && head == HEAD
}

#[cfg(test)]
mod tests {
    use super::super::shown::FieldLabel;
    use super::*;
    use contract::field::{PRESSURE, TRACTION};
    use std::fs;

    #[test]
    fn the_script_has_a_place_for_the_series() {
        assert_eq!(SCRIPT.matches(NO_SERIES).count(), 1);
        assert!(SCRIPT.as_bytes().starts_with(HEAD));
    }

    #[test]
    fn a_series_is_coloured_by_its_first_scalar() {
        let place = tempfile::tempdir().unwrap();
        let (pressure, traction) =
            (FieldLabel::of(&PRESSURE.kind(), None), FieldLabel::of(&TRACTION.kind(), None));
        let mut scene = Scene::default();
        scene.add("b", &[(&traction, &[]), (&pressure, &[])]);
        scene.add("a", &[(&traction, &[])]);
        scene.write(place.path()).unwrap();
        let path = place.path().join(FILE);
        let text = fs::read_to_string(&path).unwrap();
        let series = "SERIES = {\n  \"a\": \"traction [Pa]\",\n  \"b\": \"pressure [Pa]\"\n}\n";
        assert!(text.contains(series), "{text}");
        assert!(is_scene(&path));
    }

    #[test]
    fn a_foreign_file_stays() {
        let place = tempfile::tempdir().unwrap();
        let path = place.path().join(FILE);
        fs::write(&path, "mine").unwrap();
        let mut scene = Scene::default();
        scene.add("a", &[(&FieldLabel::of(&PRESSURE.kind(), None), &[])]);
        scene.write(place.path()).unwrap();
        assert_eq!(fs::read_to_string(path).unwrap(), "mine");
    }
}
