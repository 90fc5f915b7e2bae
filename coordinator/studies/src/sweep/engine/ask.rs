//! Runs the programs of a scheduler with a deadline and returns their output.

use std::process::{Command, Stdio};
use std::time::Duration;
use tokio::time::timeout;

/// Time after which a program that has not answered is killed.
const DEADLINE: Duration = Duration::from_secs(60);

/// Returns the standard output of a program.
///
/// # Errors
/// The program does not exist, fails or does not answer in time. The error holds the name of the
/// program and its message.
pub(super) fn text_of(mut command: Command) -> Result<String, String> {
    use std::os::unix::process::CommandExt as _;
    let name = command.get_program().to_string_lossy().into_owned();
    let wrong = |why: &str| format!("{name}: {}", why.trim());
    // Ctrl-C must reach the coordinator only.
    command.process_group(0).stdin(Stdio::null());
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build();
    let ended = runtime.and_then(|runtime| {
        let mut command = tokio::process::Command::from(command);
        runtime.block_on(async {
            let output = timeout(DEADLINE, command.kill_on_drop(true).output());
            output.await.unwrap_or_else(|_| Err(std::io::Error::other("no answer in a minute")))
        })
    });
    let ended = ended.map_err(|error| wrong(&error.to_string()))?;
    match ended.status.success() {
        true => Ok(String::from_utf8_lossy(&ended.stdout).into_owned()),
        false => Err(wrong(&String::from_utf8_lossy(&ended.stderr))),
    }
}

/// Formats ascending numbers in the notation for arrays: 1-3,7.
pub(super) fn listed(numbers: &[usize]) -> String {
    let mut ranges: Vec<(usize, usize)> = Vec::new();
    for number in numbers {
        match ranges.last_mut() {
            Some((_, last)) if *last + 1 == *number => *last = *number,
            _ => ranges.push((*number, *number)),
        }
    }
    let each = ranges.iter().map(|(first, last)| match first == last {
        true => first.to_string(),
        false => format!("{first}-{last}"),
    });
    each.collect::<Vec<_>>().join(",")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_listed_as_ranges() {
        assert_eq!(listed(&[1, 2, 3, 7, 9, 10]), "1-3,7,9-10");
        assert_eq!(listed(&[4]), "4");
    }

    #[test]
    fn what_a_program_says_is_heard() {
        let sh = |script: &str| {
            let mut sh = Command::new("sh");
            sh.args(["-c", script]);
            text_of(sh)
        };
        assert_eq!(sh("echo 12"), Ok("12\n".to_owned()));
        assert_eq!(sh("echo no partition >&2; exit 1"), Err("sh: no partition".to_owned()));
        let none = text_of(Command::new("no-such-scheduler")).unwrap_err();
        assert!(none.starts_with("no-such-scheduler: No such file"), "{none}");
    }
}
