//! Phase of a run, for messages.

use contract::message::{Command, CommandKind};
use contract::step::Step;

/// Phase of a run, for messages.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Phase {
    /// Processes start and join.
    Starting,
    /// `Describe`, `Advise` and `Configure`.
    Configuring,
    /// `Connect`.
    Connecting,
    /// `Initialise`.
    Initialising,
    /// `Solve`.
    Solving(Step),
    /// `Accept`.
    Accepting(Step),
    /// `Save`.
    Saving(Step),
    /// `Restore`.
    Restoring(Step),
    /// `Finish`.
    Finishing,
}

impl std::fmt::Display for Phase {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Starting => f.write_str("while starting"),
            Self::Configuring => f.write_str("while being configured"),
            Self::Connecting => f.write_str("while connecting"),
            Self::Initialising => f.write_str("while building its model"),
            Self::Solving(s) => write!(f, "in window {}, iteration {}", s.window, s.iteration),
            Self::Accepting(s) => write!(f, "while accepting window {}", s.window),
            Self::Saving(s) => write!(f, "while saving its state after window {}", s.window),
            Self::Restoring(s) => write!(f, "while restoring its state after window {}", s.window),
            Self::Finishing => f.write_str("while finishing"),
        }
    }
}

impl Phase {
    /// Returns the activity of a participant in this phase, in one word.
    #[must_use]
    pub fn doing(self) -> &'static str {
        match self {
            Self::Starting => "starting",
            Self::Configuring => "configuring",
            Self::Connecting => "connecting",
            Self::Initialising => "building",
            Self::Solving(_) => "solving",
            Self::Accepting(_) => "accepting",
            Self::Saving(_) => "saving",
            Self::Restoring(_) => "restoring",
            Self::Finishing => "finishing",
        }
    }

    /// Returns the phase in which a command is sent.
    #[must_use]
    pub fn of(command: &Command) -> Self {
        let step = command.step();
        match CommandKind::from_number(command.kind) {
            None => Self::Starting,
            Some(CommandKind::Describe | CommandKind::Advise | CommandKind::Configure) => {
                Self::Configuring
            }
            Some(CommandKind::Connect) => Self::Connecting,
            Some(CommandKind::Initialise) => Self::Initialising,
            Some(CommandKind::Solve) => Self::Solving(step),
            Some(CommandKind::Accept) => Self::Accepting(step),
            Some(CommandKind::Save) => Self::Saving(step),
            Some(CommandKind::Restore) => Self::Restoring(step),
            Some(CommandKind::Finish) => Self::Finishing,
        }
    }
}
