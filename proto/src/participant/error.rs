//! What can be wrong with the samples of a participant.

use crate::transport::TransportError;

/// What is wrong with a sample that arrived, or did not.
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
    #[error("the live value `{key}` comes as {values:?}, not as one finite number")]
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
        "output `{field}` was not written at index {index}, and would have sent old data: write \
         every value of what `Outputs::get` gives, in every call"
    )]
    Unwritten { field: String, index: usize },
    #[error("output `{field}` cannot be restored from {path}: {reason}")]
    Restore { field: String, path: std::path::PathBuf, reason: String },
}
