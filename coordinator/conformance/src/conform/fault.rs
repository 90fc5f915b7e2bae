//! Findings of a check, and faults of a participant.

use proto::transport::TransportError;

/// Finding of a check that did not fail: the participant meets the demand, or the demand does not
/// apply.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Finding {
    /// The participant meets the demand.
    Kept(String),
    /// The demand does not concern the participant.
    Inapplicable(String),
}

impl Finding {
    pub(super) fn kept(what: impl Into<String>) -> Result<Self, CheckFailure> {
        Ok(Self::Kept(what.into()))
    }

    pub(super) fn inapplicable(why: impl Into<String>) -> Result<Self, CheckFailure> {
        Ok(Self::Inapplicable(why.into()))
    }
}

/// Reason why a check failed.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum CheckFailure {
    /// The participant violates the contract.
    Broken(String),
    /// The participant took too long, or the machine is busy.
    Late(String),
    /// The user has interrupted the command.
    Interrupted(&'static str),
}

impl CheckFailure {
    /// Prepends the place of the fault.
    pub(super) fn at(self, place: &str) -> Self {
        match self {
            Self::Broken(what) => Self::Broken(format!("{place}: {what}")),
            Self::Late(what) => Self::Late(format!("{place}: {what}")),
            interrupted @ Self::Interrupted(_) => interrupted,
        }
    }
}

/// Returns a fault of this description.
pub(super) fn broken<T>(what: impl Into<String>) -> Result<T, CheckFailure> {
    Err(CheckFailure::Broken(what.into()))
}

/// Returns a delay of this description.
pub(super) fn late<T>(what: impl Into<String>) -> Result<T, CheckFailure> {
    Err(CheckFailure::Late(what.into()))
}

impl From<String> for CheckFailure {
    fn from(what: String) -> Self {
        Self::Broken(what)
    }
}

impl From<TransportError> for CheckFailure {
    fn from(error: TransportError) -> Self {
        Self::Broken(error.to_string())
    }
}

impl From<std::io::Error> for CheckFailure {
    fn from(error: std::io::Error) -> Self {
        Self::Broken(error.to_string())
    }
}
