//! A case that was judged without starting a program, as a person reads it.

use super::make::windows;
use super::show::in_time;
use crate::case::{Alone, RawParticipant};
use crate::programs::Program;
use std::fmt::{Display, Formatter, Result};

impl Display for Alone {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        let title = self.title.as_ref().map(|title| format!(" · {title}")).unwrap_or_default();
        writeln!(f, "{}{title}", self.name)?;
        writeln!(f, "\ntime       {}", in_time(windows(self.timing)))?;
        writeln!(f, "scheme     {}", self.coupling.scheme.word())?;
        writeln!(f, "\nprocesses  coordinator")?;
        for one in &self.participants {
            let model = one.model.as_deref().unwrap_or("?");
            writeln!(f, "           {:10} {model:14} {}", one.role, how(one))?;
        }
        write!(f, "\n{}", not_judged(self))
    }
}

/// How a participant would come to the run.
fn how(one: &RawParticipant) -> String {
    let program = Program::of_role(&one.role, one.command.as_deref());
    let line = match &one.command {
        Some(words) => words.join(" "),
        None => program.name(),
    };
    match (one.attach, &one.command) {
        (true, _) => "would be started by hand".to_owned(),
        (false, Some(_)) => format!("would start, as the case says: {line}"),
        (false, None) => format!("would start: {line}"),
    }
}

/// What was not judged of a case, and why.
#[must_use]
pub fn not_judged(alone: &Alone) -> String {
    let roles: Vec<&str> = alone.participants.iter().map(|one| one.role.as_str()).collect();
    let mut text = format!(
        "not checked, as no program was started: models, effects and fields, which the programs of \
         {} describe, and the scheme that follows from them",
        roles.join(", ")
    );
    if !alone.not_judged.is_empty() {
        text += &format!("; the keys {}", alone.not_judged.join(", "));
    }
    text + "\n"
}
