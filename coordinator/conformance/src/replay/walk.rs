//! Walking through a replay by hand.

use console::output::print;
use contract::message::{Command, CommandKind};
use run::error::{RunError, file_failure};
use std::io::{self, BufRead};
use std::path::Path;

/// What the person at the keyboard wants.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Answer {
    Go,
    Stop,
}

/// Asks before each command, until asked to continue without.
#[derive(Debug)]
pub(super) struct Walk {
    asking: bool,
}

impl Walk {
    pub(super) fn new(asking: bool) -> Result<Self, RunError> {
        if asking {
            print("Enter: do it · c: go on without asking · q: stop here\n")?;
        }
        Ok(Self { asking })
    }

    pub(super) fn ask(&mut self, role: &str, command: &Command) -> Result<Answer, RunError> {
        if !self.asking {
            return Ok(Answer::Go);
        }
        let kind = CommandKind::from_number(command.kind);
        let what = kind.map_or_else(|| "?".to_owned(), |kind| format!("{kind:?}"));
        let place = match kind {
            Some(CommandKind::Solve) => format!(
                " window {}, iteration {}, {} s to {} s",
                command.window, command.iteration, command.start, command.end
            ),
            Some(CommandKind::Accept | CommandKind::Save | CommandKind::Restore) => {
                format!(" window {}", command.window)
            }
            _ => String::new(),
        };
        print(&format!("{role}: {what}{place} > "))?;
        let mut line = String::new();
        let failed = |error| file_failure(Path::new("standard input"), &error);
        let read = io::stdin().lock().read_line(&mut line).map_err(failed)?;
        match line.trim() {
            "q" => return Ok(Answer::Stop),
            "c" => self.asking = false,
            // Nobody is there to ask any more.
            _ if read == 0 => self.asking = false,
            _ => {}
        }
        Ok(Answer::Go)
    }
}
