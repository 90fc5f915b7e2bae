//! The language in which a run is driven: one JSON object a line, each way. Numbers are exact: the shortest
//! decimals that give the same double.

use run::error::RunError;
use run::perform::{Accepted, Fault};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Version of the language.
pub(super) const VERSION: u32 = 1;

/// What is asked for.
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
        /// Where the window ends [s]; of a steady case the time of its row.
        end: Option<f64>,
        /// Its fields are written.
        #[serde(default)]
        observe: bool,
    },
    /// Keep the state after the last window.
    Save {},
    /// Go back to a state, which stays.
    Restore { state: u64 },
    /// Forget a state.
    Free { state: u64 },
    /// End the run, and begin it again with the same participants.
    Reset {},
    /// End the run.
    Finish {},
}

impl Request {
    /// Reads a line.
    ///
    /// # Errors
    /// It is none of this language, in words.
    pub(super) fn read(line: &str) -> Result<Self, String> {
        serde_json::from_str(line).map_err(|error| {
            format!("the line is no request: {error}; write one as {{\"do\": \"step\"}}")
        })
    }
}

/// A value that may be set.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(super) struct LiveKey<'a> {
    pub(super) key: &'a str,
    pub(super) unit: &'a str,
    pub(super) at: f64,
    pub(super) from: f64,
    pub(super) to: f64,
}

/// What is answered.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub(super) enum Answer<'a> {
    /// At the beginning of a run, before anything is asked for.
    Ready {
        /// Version of this language.
        ready: u32,
        case: &'a str,
        /// Length of a window [s]; `null` where windows have none.
        window: Option<f64>,
        live: Vec<LiveKey<'a>>,
        /// Keys of the figures that every step gives.
        figures: Vec<&'a str>,
        /// Why no state can be saved; `null` if it can.
        one_way: Option<&'a str>,
    },
    /// A window has been solved and accepted.
    Stepped {
        window: u64,
        start: f64,
        end: f64,
        status: &'a str,
        iterations: u32,
        /// In the order of `figures` of the first line; `null` for what there is not.
        figures: Vec<Option<f64>>,
    },
    /// A state is kept under this number.
    Saved { state: u64 },
    /// What was asked for is done.
    Done { done: bool },
    /// It is not done.
    Failed {
        error: String,
        /// `refused`: nothing has changed; `no-answer`: the window has none, the state is that before it;
        /// `ended`: the run is over.
        kind: &'static str,
    },
}

impl Answer<'_> {
    pub(super) const DONE: Self = Self::Done { done: true };

    pub(super) fn refused(error: String) -> Self {
        Self::Failed { error, kind: "refused" }
    }

    /// The answer to what did not succeed, and what ends the run.
    pub(super) fn of_fault(fault: Fault) -> (Self, Option<RunError>) {
        match fault {
            Fault::Refused(error) => (Self::refused(error), None),
            Fault::NoAnswer(error) => {
                (Self::Failed { error: error.to_string(), kind: "no-answer" }, None)
            }
            Fault::Ended(error) => {
                (Self::Failed { error: error.to_string(), kind: "ended" }, Some(error))
            }
        }
    }

    pub(super) fn stepped(accepted: Accepted) -> Self {
        let Accepted { step, status, iterations, figures } = accepted;
        let (window, start, end) = (step.window, step.start, step.end);
        Self::Stepped { window, start, end, status, iterations, figures }
    }

    /// As one line.
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
