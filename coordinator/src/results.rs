//! The result directory: `summary.json`, `iterations.csv`, `fields/`, the case as run, `log.jsonl`.

pub mod folder;
pub mod iterations;
mod line;
pub mod show;
pub mod summary;
pub mod vtk;

pub use folder::ResultFolder;
