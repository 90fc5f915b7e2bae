//! `coordinator plan`: what a case will run and what not, and why.

use clap::Args;
use console::case_arguments::CaseArguments;
use console::command::{Command, Context, Group};
use console::output::print;
use contract::text::json;
use run::error::RunError;
use run::plan::Shown;
use run::plan_file::PlanFile;
use run::signals;
use studies::advise;
use studies::study::Variant;

/// Options of `coordinator plan`.
#[derive(Debug, Args)]
pub(crate) struct PlanCommand {
    #[command(flatten)]
    case: CaseArguments,
    /// Start no program: show what a case from elsewhere says, and what it would start.
    #[arg(long)]
    no_start: bool,
    /// Say of every effect, in the case or not, whether it matters, by about how much, and what it costs.
    #[arg(long, conflicts_with = "no_start")]
    advise: bool,
    /// Print JSON, as plan.json has it.
    #[arg(long, conflicts_with_all = ["no_start", "advise"])]
    json: bool,
}

impl Command for PlanCommand {
    const NAME: &'static str = "plan";
    const GROUP: Group = Group::Run;
    const ABOUT: &'static str = "Show what a case will run and what not, and why. Starts the programs \
        that the case names, to ask them what they offer";

    fn run(&self, context: &Context<'_>) -> Result<(), RunError> {
        let _asking = signals::end_at_once();
        // What was asked for is printed, --quiet or not.
        let context = Context { quiet: false, ..*context };
        if self.no_start {
            return context.print_lines(&Shown(&self.case.alone()?).to_string());
        }
        let planned = self.case.plan()?;
        match (self.json, self.advise) {
            (true, _) => print(&json(&PlanFile::of(&planned.plan))),
            (_, false) => context.print_lines(&planned.plan.to_string()),
            (_, true) => {
                let of = &self.case;
                let base = Variant { set: of.set.clone(), unset: of.unset.clone() };
                let all = advise::advise(&of.case, &base, &planned)?;
                context.print_lines(&format!("{}{}", planned.plan, advise::text(&all, &planned)))
            }
        }
    }
}
