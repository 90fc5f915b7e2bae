//! Errors of a participant: while joining a run, and in samples of its fields.

use crate::transport::TransportError;

/// Reason why a participant could not complete a run.
#[derive(Debug, thiserror::Error)]
pub enum JoinError {
    /// The folder of the run does not exist or is not ours, or the role is taken.
    #[error(transparent)]
    Folder(#[from] std::io::Error),
    /// The shared memory of the run cannot be used.
    #[error(transparent)]
    Transport(#[from] TransportError),
}

/// Fault of a received or missing sample.
#[derive(Debug, thiserror::Error)]
pub(super) enum PortError {
    #[error(transparent)]
    Transport(#[from] TransportError),
    #[error(
        "input `{field}` has sequence number {found}, expected {expected}: a sample is missing"
    )]
    Sequence { field: String, found: u64, expected: u64 },
    #[error("input `{field}` from `{producer}` has {found} values, expected {expected}")]
    Length { field: String, producer: String, found: usize, expected: usize },
    #[error(
        "input `{field}` is on revision {revision} of grid `{grid}`, whose geometry is known in \
         revision {known}"
    )]
    Revision { field: String, grid: String, revision: u64, known: u64 },
    #[error("the live value `{key}` has the values {values:?}; expected one finite number")]
    Live { key: String, values: Vec<f64> },
    #[error("{0}")]
    Geometry(String),
    #[error(
        "input `{field}` cannot be interpolated linearly from {before} values to {now}: its grid \
         has grown; set coupling.interpolation to \"constant\""
    )]
    Grown { field: String, before: usize, now: usize },
    #[error("the topic of `{expected}` carries `{found}`")]
    Label { expected: String, found: String },
    #[error("more than one sample of output `{0}` at a time")]
    Loan(String),
    #[error(
        "output `{field}` was not written at index {index} and would contain old data: write \
         all values of the slice from `Outputs::get` in every call"
    )]
    Unwritten { field: String, index: usize },
    #[error("output `{field}` cannot be restored from {path}: {reason}")]
    Restore { field: String, path: std::path::PathBuf, reason: String },
}
