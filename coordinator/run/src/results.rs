//! The result directory: `summary.json`, `iterations.csv`, `history.csv`, `fields/`, the case as
//! run, `log.jsonl`.

pub mod cells;
pub mod claim;
mod clear;
pub mod cost;
pub mod counts;
pub mod derived;
pub mod dir;
pub mod extremes;
pub mod figures;
mod folder;
pub mod history;
pub mod iterations;
pub mod last;
mod line;
pub mod place;
mod read;
mod rows;
pub mod show;
pub mod stated;
pub mod summary;
pub mod vtk;
pub mod write;

pub use claim::Existing;
pub use folder::ResultFolder;
pub use read::read_file;
