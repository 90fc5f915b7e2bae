//! Requests and answers of a driven run: one JSON object per line. Numbers are exact: the shortest
//! decimals that give the same double.

use run::error::RunError;
use run::perform::{Accepted, DriverError};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Version of the protocol.
pub(super) const VERSION: u32 = 1;

/// A request on standard input.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(tag = "do", rename_all = "kebab-case", deny_unknown_fields)]
pub(super) enum Request {
    /// Values of live keys, from the next window on.
    Set { values: BTreeMap<String, f64> },
    /// The next window.
    Step {
        /// Values of live keys, from this window on.
        #[serde(default)]
        set: BTreeMap<String, f64>,
        /// End of the window [s]; of a steady case the time of its row.
        end: Option<f64>,
        /// True if the fields of the window are written.
        #[serde(default)]
        observe: bool,
    },
    /// Keep the state after the last window.
    Save {},
    /// Return to a state, which stays available.
    Restore { state: u64 },
    /// Discard a state.
    Free { state: u64 },
    /// End the run, and start it again with the same participants.
    Reset {},
    /// End the run.
    Finish {},
}

impl Request {
    /// Parses a line.
    ///
    /// # Errors
    /// Describes why the line is not a request.
    pub(super) fn read(line: &str) -> Result<Self, String> {
        serde_json::from_str(line).map_err(|error| {
            format!("the line is no request: {error}; write one as {{\"do\": \"step\"}}")
        })
    }
}

/// A value of a live key.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(super) struct LiveKey<'a> {
    pub(super) key: &'a str,
    pub(super) unit: &'a str,
    pub(super) at: f64,
    pub(super) from: f64,
    pub(super) to: f64,
}

/// An answer on standard output.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub(super) enum Answer<'a> {
    /// First line of a run, before any request.
    Ready {
        /// Version of the protocol.
        ready: u32,
        case: &'a str,
        /// Length of a window [s]; `null` if windows have no fixed length.
        window: Option<f64>,
        live: Vec<LiveKey<'a>>,
        /// Keys of the figures of every step.
        figures: Vec<&'a str>,
        /// Reason why no state can be saved, or `null`.
        one_way: Option<&'a str>,
    },
    /// A window has been solved and accepted.
    Stepped {
        window: u64,
        start: f64,
        end: f64,
        status: &'a str,
        iterations: u32,
        /// Figures, in the order of the first line; `null` for missing ones.
        figures: Vec<Option<f64>>,
    },
    /// A state is kept under this number.
    Saved { state: u64 },
    /// The request has succeeded.
    Done { done: bool },
    /// The request has failed.
    Failed {
        error: String,
        /// `refused`: nothing has changed; `no-answer`: the window has no answer, and the state
        /// before it stays; `ended`: the run is over.
        kind: &'static str,
    },
}

impl Answer<'_> {
    pub(super) const DONE: Self = Self::Done { done: true };

    pub(super) fn refused(error: String) -> Self {
        Self::Failed { error, kind: "refused" }
    }

    /// Returns the answer to a failed request, and the error that ends the run, if any.
    pub(super) fn of_fault(fault: DriverError) -> (Self, Option<RunError>) {
        match fault {
            DriverError::Refused(error) => (Self::refused(error), None),
            DriverError::NoAnswer(error) => {
                (Self::Failed { error: error.to_string(), kind: "no-answer" }, None)
            }
            DriverError::Ended(error) => {
                (Self::Failed { error: error.to_string(), kind: "ended" }, Some(error))
            }
        }
    }

    pub(super) fn stepped(accepted: Accepted) -> Self {
        let Accepted { step, status, iterations, figures } = accepted;
        let (window, start, end) = (step.window, step.start, step.end);
        Self::Stepped { window, start, end, status, iterations, figures }
    }

    /// Writes the answer as one line.
    pub(super) fn line(&self) -> String {
        serde_json::to_string(self).expect("an answer is plain data") + "\n"
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn requests_are_read_and_nothing_else() {
        let read = |line: &str| Request::read(line);
        assert_eq!(
            read(r#"{"do":"step","set":{"load.normal_force":1.5e5},"end":0.1}"#),
            Ok(Request::Step {
                set: [("load.normal_force".to_owned(), 1.5e5)].into(),
                end: Some(0.1),
                observe: false
            })
        );
        assert_eq!(read(r#"{"do":"save"}"#), Ok(Request::Save {}));
        for wrong in [
            "",
            "step",
            "{}",
            r#"{"do":"jump"}"#,
            r#"{"do":"step","endd":1}"#,
            r#"{"do":"step","end":1e999}"#,
            r#"{"do":"restore","state":-1}"#,
            r#"{"do":"set"}"#,
            r#"{"do":"save"} {"do":"save"}"#,
        ] {
            assert!(read(wrong).unwrap_err().contains("no request"), "{wrong}");
        }
    }

    proptest! {
        #[test]
        fn any_line(line in ".{0,200}") {
            let _ = Request::read(&line);
        }

        #[test]
        fn any_object(key in "[a-z]{1,8}", word in "set|step|save|restore|free|finish|x", value in "[0-9eE.+\\-\\[\\]{}\":]{0,20}") {
            let _ = Request::read(&format!("{{\"do\":\"{word}\",\"{key}\":{value}}}"));
        }

        #[test]
        fn numbers_survive(bits in any::<u64>()) {
            let value = f64::from_bits(bits);
            prop_assume!(value.is_finite());
            let line = format!("{{\"do\":\"step\",\"end\":{}}}", serde_json::to_string(&value).unwrap());
            let Ok(Request::Step { end: Some(end), .. }) = Request::read(&line) else { panic!("{line}") };
            prop_assert_eq!(end.to_bits(), bits);
        }
    }
}
