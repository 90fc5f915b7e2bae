//! `coordinator check`: every error of a case at once, each with its place, reason and fix.

use clap::Args;
use console::case_arguments::CaseArguments;
use console::command::{Command, Context, Group};
use console::output::print;
use contract::text::json;
use run::error::RunError;
use run::fleet::Fleet;
use run::warnings::Warning;
use serde_json::{Value, json};

/// Options of `coordinator check`.
#[derive(Debug, Args)]
pub(crate) struct CheckCommand {
    #[command(flatten)]
    case: CaseArguments,
    /// Start no program: check only the coordinator's own keys.
    #[arg(long)]
    no_start: bool,
    /// Print JSON: errors and warnings, each with key, place, reason and fix.
    #[arg(long, conflicts_with = "no_start")]
    json: bool,
}

impl Command for CheckCommand {
    const NAME: &'static str = "check";
    const GROUP: Group = Group::Run;
    const ABOUT: &'static str = "Report every error of a case, with place and fix. Starts the programs that the case names, because only they know their keys";
    const EXAMPLES: &'static [&'static str] =
        &["coordinator check CASE", "coordinator check --no-start from-elsewhere.toml"];

    fn run(&self, context: &Context<'_>) -> Result<(), RunError> {
        if self.json {
            return check_as_json(&self.case);
        }
        let shown = self.case.shown();
        if self.no_start {
            let rest = self.case.alone()?.not_judged_text();
            return context.print(&format!("{shown}: no errors in what was checked\n{rest}"));
        }
        let planned = self.case.plan(&mut Fleet::for_one_run())?;
        let warnings = planned.plan.warnings.iter();
        let warnings: String = warnings.map(|warning| format!("warning: {warning}\n")).collect();
        context.print(&format!("{warnings}{shown}: no errors\n"))
    }
}

/// Prints the errors or the warnings of a case. Errors of the case are errors of the command.
fn check_as_json(asked: &CaseArguments) -> Result<(), RunError> {
    let planned = asked.plan(&mut Fleet::for_one_run());
    let problem = |one: &case::Problem| json!({"key": one.key, "place": one.place.to_string(), "reason": one.reason, "fix": one.fix});
    let (errors, warnings) = match &planned {
        Ok(planned) => (Vec::new(), planned.plan.warnings.clone()),
        Err(RunError::Case(problems)) => {
            (problems.list().iter().map(problem).collect(), Vec::new())
        }
        Err(other) => {
            let nowhere = json!({"key": "", "place": "", "reason": other.to_string(), "fix": ""});
            (vec![nowhere], Vec::new())
        }
    };
    let warnings: Vec<Value> = warnings.iter().map(warning_as_json).collect();
    print(&json(&json!({"case": asked.case, "errors": errors, "warnings": warnings})))?;
    planned.map(drop)
}

/// Adds the entries of an error to those of a warning.
fn warning_as_json(warning: &Warning) -> Value {
    let mut entries = json!(warning);
    let usual = [("place", String::new()), ("reason", warning.to_string()), ("fix", String::new())];
    for (name, value) in usual {
        if entries.get(name).is_none() {
            entries[name] = value.into();
        }
    }
    entries
}
