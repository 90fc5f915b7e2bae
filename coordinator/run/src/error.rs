//! How a command can end badly, and the exit code that goes with it.

use crate::format::percent;
use crate::program::Program;
use crate::results::dir::shown;
use case::Problems;
use contract::configuration::Refusal;
use contract::input_file::InputFileError;
use coupling::NotConverged;
use coupling::converge::Why;

/// Why a command of the coordinator did not succeed.
#[derive(Debug, thiserror::Error)]
pub enum RunError {
    /// The command line asks for what cannot be; nothing was started.
    #[error("{0}")]
    Usage(String),
    /// The case is wrong; nothing was started.
    #[error("{0}")]
    Case(#[from] Problems),
    /// A participant refused the case. Becomes [`RunError::Case`] where the case is at hand.
    #[error("{role} refuses the case: {refusal}")]
    Refused {
        /// Role that refused.
        role: String,
        /// Key, reason and fix.
        refusal: Refusal,
    },
    /// A program that the case names, or needs, is not there. Becomes [`RunError::Case`] where the
    /// case is at hand.
    #[error("{role}: there is no program `{}`", program.command_line())]
    NoProgram {
        /// Role that the program was to play.
        role: String,
        /// What was looked for.
        program: Program,
    },
    /// A participant or the machine failed.
    #[error(transparent)]
    Failed(#[from] Failure),
    /// A window did not converge, and the case is strict.
    #[error("{not_converged}; {fix}", not_converged = .0, fix = fix(.0))]
    NotConverged(#[from] NotConverged),
    /// The finest grid that was tried misses the target of accuracy.
    #[error(
        "the estimated error of {quantity} is {:.2} %, above the requested {} %; {fix}",
        100.0 * estimated, percent(*target)
    )]
    Inaccurate {
        /// Key of the quantity.
        quantity: String,
        /// Its estimated relative error.
        estimated: f64,
        /// The error that was asked for.
        target: f64,
        /// What to do.
        fix: String,
    },
    /// A replayed participant does not send what was recorded.
    #[error("the replay differs from the recording: {0}")]
    Differs(String),
    /// A text that is kept does not say what a reproduction says.
    #[error("stale: {0}")]
    Stale(String),
    /// Stopped by the user.
    #[error("interrupted by {signal} {when}; every participant was shut down")]
    Interrupted {
        /// Name of the signal.
        signal: &'static str,
        /// What was going on.
        when: String,
    },
    /// A participant's summary holds a quantity that is not a number.
    #[error("{role} reported a quantity that is not finite: {key}")]
    NotFinite {
        /// Role that reported it.
        role: String,
        /// Dotted key of the quantity.
        key: String,
    },
    /// One error, and a second one while the first was dealt with.
    #[error("{first}\nerror: {second}")]
    Both {
        /// What ended the run.
        first: Box<RunError>,
        /// What went wrong then.
        second: Box<RunError>,
    },
}

/// What failed, when, how, and what to do about it.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{who} failed {when}: {what}; {fix}")]
pub struct Failure {
    /// Role and program, or a part of the machine.
    pub who: String,
    /// What was going on: a phase, or window and iteration.
    pub when: String,
    /// What happened.
    pub what: String,
    /// What to do.
    pub fix: String,
}

impl RunError {
    /// The exit code: 1 a solver or the machine failed, 2 bad usage or case, 3 not converged, 4 a replay
    /// differs, or a text that is kept is stale, 128 and the number of the signal that has stopped it.
    #[must_use]
    pub fn exit_code(&self) -> u8 {
        match self {
            Self::Usage(_) | Self::Case(_) | Self::Refused { .. } | Self::NoProgram { .. } => 2,
            Self::Failed(_) | Self::NotFinite { .. } => 1,
            Self::NotConverged(_) | Self::Inaccurate { .. } => 3,
            Self::Differs(_) | Self::Stale(_) => 4,
            Self::Interrupted { signal: "SIGHUP", .. } => 129,
            Self::Interrupted { signal: "SIGTERM", .. } => 143,
            Self::Interrupted { .. } => 130,
            Self::Both { first, .. } => first.exit_code(),
        }
    }

    /// The user has stopped it.
    #[must_use]
    pub fn is_interrupt(&self) -> bool {
        match self {
            Self::Interrupted { .. } => true,
            Self::Both { first, .. } => first.is_interrupt(),
            _ => false,
        }
    }

    /// This error, and what went wrong after it, if anything.
    #[must_use]
    pub fn and(self, then: Result<(), RunError>) -> Self {
        match then {
            Ok(()) => self,
            Err(second) => Self::Both { first: Box::new(self), second: Box::new(second) },
        }
    }
}

/// What to do about a window that did not converge.
fn fix(of: &NotConverged) -> String {
    let other = of.advice;
    match of.why {
        Why::Diverged => format!("{other}, lower coupling.relaxation, or shorten time.window"),
        Why::Stagnated => format!(
            "{other}, or loosen coupling.relative: the participants may not be more precise"
        ),
        Why::OutOfIterations => {
            format!(
                "raise coupling.max_iterations, {other}, lower coupling.relaxation, or shorten time.window"
            )
        }
    }
}

/// An error of the file system as a failure of the machine.
pub fn file_failure(path: &std::path::Path, error: &std::io::Error) -> RunError {
    let when = format!("at {}", shown(path).display());
    let fix = "check the path, its permissions and the free space";
    machine_failure("the file system", &when, error, fix)
}

/// A file that a user names and that cannot be used.
#[must_use]
pub fn input_failure(path: &std::path::Path, error: &InputFileError) -> RunError {
    match error {
        InputFileError::System(error) => file_failure(path, error),
        error => RunError::Usage(format!("{} {error}", shown(path).display())),
    }
}

/// An error of a part of the machine.
pub fn machine_failure(
    who: &str,
    when: &str,
    error: &dyn std::fmt::Display,
    fix: &str,
) -> RunError {
    RunError::Failed(Failure {
        who: who.to_owned(),
        when: when.to_owned(),
        what: error.to_string(),
        fix: fix.to_owned(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_of_two_errors_decides() {
        let first = || RunError::Usage("the first".to_owned());
        let second = || file_failure(std::path::Path::new("x"), &std::io::Error::other("full"));
        let both = first().and(Err(second()));
        assert_eq!(both.exit_code(), 2);
        let text = both.to_string();
        assert!(text.starts_with("the first\nerror: ") && text.contains("full"), "{text}");
        assert_eq!(first().and(Ok(())).to_string(), "the first");
        assert_eq!(second().and(Err(first())).exit_code(), 1);
    }

    #[test]
    fn an_interrupt_has_the_code_of_its_signal() {
        for (signal, code) in [("Ctrl-C", 130), ("SIGTERM", 143), ("SIGHUP", 129)] {
            let stopped = RunError::Interrupted { signal, when: "in window 3".to_owned() };
            let and_more = stopped.and(Err(RunError::Usage("more".to_owned())));
            assert_eq!((and_more.exit_code(), and_more.is_interrupt()), (code, true));
        }
    }
}
