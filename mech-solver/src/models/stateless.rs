//! Models without a state.

use proto::model::{StateBlob, StateError};

/// Restores a model that has no state.
pub(super) fn restore_nothing(name: &str, from: &StateBlob) -> Result<(), StateError> {
    match from.0.len() {
        0 => Ok(()),
        bytes => Err(StateError(format!("{name} has no state, but there are {bytes} bytes"))),
    }
}
