//! The result directory: `summary.json`, `iterations.csv`, `fields/`, the case as run, `log.jsonl`.

pub mod cells;
pub mod claim;
mod clear;
pub mod dir;
mod folder;
pub mod iterations;
pub mod last;
mod line;
pub mod place;
pub mod show;
pub mod summary;
pub mod vtk;
pub mod write;

pub use claim::Existing;
pub use folder::ResultFolder;
