//! What a check can see of a participant, and what can be wrong with it.

use proto::transport::TransportError;

/// What was seen of a participant that keeps the demand, or why there is nothing to keep.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Seen {
    /// It keeps it.
    Kept(String),
    /// The demand does not concern it.
    Inapplicable(String),
}

impl Seen {
    pub(super) fn kept(what: impl Into<String>) -> Result<Self, Fault> {
        Ok(Self::Kept(what.into()))
    }

    pub(super) fn inapplicable(why: impl Into<String>) -> Result<Self, Fault> {
        Ok(Self::Inapplicable(why.into()))
    }
}

/// Why a check did not go through.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Fault {
    /// The participant violates the contract.
    Broken(String),
    /// It took too long; or the machine is busy.
    Late(String),
    /// The user wants to stop.
    Interrupted(&'static str),
}

impl Fault {
    /// The same, with where it happened before it.
    pub(super) fn at(self, place: &str) -> Self {
        match self {
            Self::Broken(what) => Self::Broken(format!("{place}: {what}")),
            Self::Late(what) => Self::Late(format!("{place}: {what}")),
            interrupted @ Self::Interrupted(_) => interrupted,
        }
    }
}

/// The fault with these words.
pub(super) fn broken<T>(what: impl Into<String>) -> Result<T, Fault> {
    Err(Fault::Broken(what.into()))
}

/// Too late, in these words.
pub(super) fn late<T>(what: impl Into<String>) -> Result<T, Fault> {
    Err(Fault::Late(what.into()))
}

impl From<String> for Fault {
    fn from(what: String) -> Self {
        Self::Broken(what)
    }
}

impl From<TransportError> for Fault {
    fn from(error: TransportError) -> Self {
        Self::Broken(error.to_string())
    }
}

impl From<std::io::Error> for Fault {
    fn from(error: std::io::Error) -> Self {
        Self::Broken(error.to_string())
    }
}
