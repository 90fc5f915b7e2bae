//! The subcommand.

use super::{Request, difference, replay, text};
use crate::inspect::unreadable;
use crate::output::print;
use clap::Args;
use contract::text::json;
use run::error::RunError;
use run::programs::Program;
use std::path::PathBuf;

/// What `coordinator replay` is asked.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// The recording.
    recording: PathBuf,
    /// Role of the participant to drive.
    #[arg(long, value_name = "ROLE")]
    only: String,
    /// The program to drive, with its arguments [default: ROLE-solver].
    #[arg(long, num_args = 1.., value_name = "COMMAND", conflicts_with = "serve")]
    command: Vec<String>,
    /// Largest difference that passes, relative to the largest value of a sample [default: none,
    /// bit-identical].
    #[arg(long, value_name = "RELATIVE")]
    tolerance: Option<f64>,
    /// Begin with this window, from a recorded state.
    #[arg(long, value_name = "WINDOW")]
    from: Option<u64>,
    /// End with this window.
    #[arg(long, value_name = "WINDOW")]
    until: Option<u64>,
    /// Change a value of the recorded configuration: dotted name and SI number, or text.
    #[arg(long, value_name = "KEY=VALUE")]
    set: Vec<String>,
    /// Ask before every command.
    #[arg(long)]
    step: bool,
    /// Wait for a solver that is started by hand, in a debugger say; nothing has a deadline.
    #[arg(long)]
    serve: bool,
    /// Print JSON.
    #[arg(long)]
    json: bool,
}

/// Drives a participant and prints what it did otherwise.
///
/// # Errors
/// Those of the replay; it did something else.
pub(crate) fn main(asked: &Arguments, quiet: bool) -> Result<(), RunError> {
    if asked.tolerance.is_some_and(|t| t.is_nan() || t < 0.0) {
        return Err(RunError::Usage("--tolerance must be a number of at least 0".to_owned()));
    }
    let words = words(&asked.command)?;
    let program = (!words.is_empty()).then(|| Program::of_role(&asked.only, Some(&words)));
    let request = Request {
        recording: asked.recording.clone(),
        only: asked.only.clone(),
        program,
        serve: asked.serve,
        tolerance: asked.tolerance,
        from: asked.from,
        until: asked.until,
        set: asked.set.iter().map(|option| assignment(option)).collect::<Result<_, _>>()?,
        step: asked.step,
    };
    let replay = replay(&request)?;
    if asked.json {
        print(&json(&replay))?;
    } else if !quiet {
        print(&text(&replay, &request))?;
    }
    let compared = &replay.comparison;
    let first = compared.first.as_ref().map(difference);
    match (first.or_else(|| compared.other.clone()), &replay.damage) {
        (Some(difference), _) => Err(RunError::Differs(difference)),
        (None, Some(damage)) => Err(unreadable(&asked.recording, damage)),
        (None, None) if compared.samples == 0 => {
            Err(RunError::Usage("there was nothing to compare in these windows".to_owned()))
        }
        (None, None) => Ok(()),
    }
}

/// A program and its arguments; one text with spaces is a command line, quoted as in a shell.
fn words(command: &[String]) -> Result<Vec<String>, RunError> {
    let [line] = command else { return Ok(command.to_vec()) };
    let open = || RunError::Usage(format!("--command has a quote that is not closed: {line}"));
    shlex::split(line).ok_or_else(open)
}

/// A key and a value: a number, true or false, or a text.
fn assignment(option: &str) -> Result<(String, serde_json::Value), RunError> {
    let (key, value) = option
        .split_once('=')
        .filter(|(key, _)| !key.is_empty())
        .ok_or_else(|| RunError::Usage(format!("`--set {option}` is not KEY=VALUE")))?;
    let value = serde_json::from_str(value).unwrap_or_else(|_| value.into());
    Ok((key.to_owned(), value))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_text_is_a_command_line() {
        let split = |command: &[&str]| {
            words(&command.iter().map(|word| (*word).to_owned()).collect::<Vec<_>>())
        };
        assert_eq!(split(&["a 'b c' d\\ e"]).unwrap(), ["a", "b c", "d e"]);
        assert_eq!(split(&["a b", "c"]).unwrap(), ["a b", "c"]);
        assert!(split(&["a 'b"]).unwrap_err().to_string().contains("quote"));
    }
}
