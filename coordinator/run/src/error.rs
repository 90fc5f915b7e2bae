//! Errors of a command, with their exit codes.

use crate::format::percent;
use crate::program::Program;
use crate::results::dir::shown;
use case::Problems;
use contract::configuration::Refusal;
use contract::input_file::InputFileError;
use coupling::NotConverged;
use coupling::converge::NonConvergence;

/// Reason why a command of the coordinator did not succeed.
#[derive(Debug, thiserror::Error)]
pub enum RunError {
    /// The command line is invalid; nothing was started.
    #[error("{0}")]
    Usage(String),
    /// The case is invalid; nothing was started.
    #[error("{0}")]
    Case(#[from] Problems),
    /// A participant refused the case. Becomes [`RunError::Case`] where the case is available.
    #[error("{role} refuses the case: {refusal}")]
    Refused {
        /// Role that refused.
        role: String,
        /// Key, reason and fix.
        refusal: Refusal,
    },
    /// A program that the case needs does not exist. Becomes [`RunError::Case`] where the case is
    /// available.
    #[error("{role}: there is no program `{}`", program.command_line())]
    NoProgram {
        /// Role that the program was to play.
        role: String,
        /// The missing program.
        program: Program,
    },
    /// A participant or the machine failed.
    #[error(transparent)]
    Failed(#[from] Failure),
    /// A window did not converge, and the case is strict.
    #[error("{not_converged}; {fix}", not_converged = .0, fix = fix(.0))]
    NotConverged(#[from] NotConverged),
    /// The finest grid tried misses the target accuracy.
    #[error(
        "the estimated error of {quantity} is {:.2} %, above the requested {} %; {fix}",
        100.0 * estimated, percent(*target)
    )]
    Inaccurate {
        /// Key of the quantity.
        quantity: String,
        /// Estimated relative error of the quantity.
        estimated: f64,
        /// Requested relative error.
        target: f64,
        /// Advice to the user.
        fix: String,
    },
    /// The run has finished, and `--strict` makes its warnings an error.
    #[error(
        "the run has finished, and its results are complete, but --strict refuses {}; change the \
         case, or leave out --strict",
        warnings.join("; ")
    )]
    Warned {
        /// The warnings, as text.
        warnings: Vec<String>,
    },
    /// Values differ from those of a recording.
    #[error("{0}")]
    Differs(String),
    /// A generated file is out of date.
    #[error("stale: {0}")]
    Stale(String),
    /// Stopped by the user.
    #[error("interrupted by {signal} {when}; every participant was shut down")]
    Interrupted {
        /// Name of the signal.
        signal: &'static str,
        /// The phase in which it happened.
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
    /// Two errors: one that ended the run, and one from handling it.
    #[error("{first}\nerror: {second}")]
    Both {
        /// The error that ended the run.
        first: Box<RunError>,
        /// The error that followed.
        second: Box<RunError>,
    },
}

/// A failure: who failed, when and how, and how to fix it.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{who} failed {when}: {what}; {fix}")]
pub struct Failure {
    /// Role and program, or a part of the machine.
    pub who: String,
    /// The phase, or window and iteration.
    pub when: String,
    /// Description of the failure.
    pub what: String,
    /// Advice to the user.
    pub fix: String,
}

impl RunError {
    /// Returns the exit code:
    ///
    /// - 1: a solver or the machine failed,
    /// - 2: invalid usage or case,
    /// - 3: not converged,
    /// - 4: a replay differs, or a generated file is out of date,
    /// - 5: the run has finished with warnings, and `--strict` makes them errors,
    /// - 128 plus the number of the signal that stopped the command.
    #[must_use]
    pub fn exit_code(&self) -> u8 {
        match self {
            Self::Usage(_) | Self::Case(_) | Self::Refused { .. } | Self::NoProgram { .. } => 2,
            Self::Failed(_) | Self::NotFinite { .. } => 1,
            Self::NotConverged(_) | Self::Inaccurate { .. } => 3,
            Self::Differs(_) | Self::Stale(_) => 4,
            Self::Warned { .. } => 5,
            Self::Interrupted { signal: "SIGHUP", .. } => 129,
            Self::Interrupted { signal: "SIGTERM", .. } => 143,
            Self::Interrupted { .. } => 130,
            Self::Both { first, .. } => first.exit_code(),
        }
    }

    /// Returns whether the user has stopped the command.
    #[must_use]
    pub fn is_interrupt(&self) -> bool {
        match self {
            Self::Interrupted { .. } => true,
            Self::Both { first, .. } => first.is_interrupt(),
            _ => false,
        }
    }

    /// Returns this error, joined with an error that followed, if any.
    #[must_use]
    pub fn and(self, then: Result<(), RunError>) -> Self {
        match then {
            Ok(()) => self,
            Err(second) => Self::Both { first: Box::new(self), second: Box::new(second) },
        }
    }
}

/// Returns advice about a window that did not converge.
fn fix(of: &NotConverged) -> String {
    let other = of.advice;
    match of.why {
        NonConvergence::Diverged => {
            format!("{other}, lower coupling.relaxation, or shorten time.window")
        }
        NonConvergence::Stagnated => format!(
            "{other}, or loosen coupling.relative: the participants may not be more precise"
        ),
        NonConvergence::OutOfIterations => {
            format!(
                "raise coupling.max_iterations, {other}, lower coupling.relaxation, or shorten time.window"
            )
        }
    }
}

/// Returns an error of the file system as a failure of the machine.
pub fn file_failure(path: &std::path::Path, error: &std::io::Error) -> RunError {
    let when = format!("at {}", shown(path).display());
    let fix = "check the path, its permissions and the free space";
    machine_failure("the file system", &when, error, fix)
}

/// Returns the error for a file that a user names and that cannot be used.
#[must_use]
pub fn input_failure(path: &std::path::Path, error: &InputFileError) -> RunError {
    match error {
        InputFileError::System(error) => file_failure(path, error),
        error => RunError::Usage(format!("{} {error}", shown(path).display())),
    }
}

/// Returns an error of a part of the machine.
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
    fn a_finished_run_with_a_warning_is_no_wrong_usage() {
        let error = RunError::Warned { warnings: vec!["a.b is 7".to_owned()] };
        assert_eq!(error.exit_code(), 5);
        let expected = "the run has finished, and its results are complete, but --strict refuses \
                        a.b is 7; change the case, or leave out --strict";
        assert_eq!(error.to_string(), expected);
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
