//! A case that was judged without starting a program, as a person reads it.

use super::make::windows;
use super::show::in_time;
use crate::programs::Program;
use case::{Alone, RawParticipant};
use std::fmt::{Display, Formatter, Result};

/// A case that was judged alone, as a person reads it.
#[derive(Clone, Copy, Debug)]
pub struct Shown<'a>(pub &'a Alone);

impl Display for Shown<'_> {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        let Self(alone) = self;
        let title = alone.title.as_ref().map(|title| format!(" · {title}")).unwrap_or_default();
        writeln!(f, "{}{title}", alone.name)?;
        writeln!(f, "\ntime       {}", in_time(&windows(alone.timing, None)))?;
        writeln!(f, "scheme     {}", alone.coupling.scheme.word())?;
        writeln!(f, "\nprocesses  coordinator")?;
        for one in &alone.participants {
            let model = one.model.as_deref().unwrap_or("?");
            writeln!(f, "           {:10} {model:14} {}", one.role, how(one))?;
        }
        write!(f, "\n{}", alone.not_judged_text())
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
