//! The files of a grid, instant by instant, and the collection that names them.

use serde::{Deserialize, Serialize};
use std::fmt::Write as _;

/// One grid of one participant through time.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FileSeries {
    /// Participant and grid.
    pub name: String,
    /// Time [s] and name of each file, the newest last.
    pub files: Vec<(f64, String)>,
}

/// A collection of files, each with its time [s].
pub(super) fn collection(files: &[(f64, String)]) -> String {
    let mut text = "<?xml version=\"1.0\"?>\n\
                    <VTKFile type=\"Collection\" version=\"1.0\">\n  <Collection>\n"
        .to_owned();
    for (time, file) in files {
        let _ = writeln!(text, "    <DataSet timestep=\"{time:e}\" file=\"{file}\"/>");
    }
    text + "  </Collection>\n</VTKFile>\n"
}
