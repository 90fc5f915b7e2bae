//! `coordinator plan`: the programs, models, effects and fields of a run, and its expected cost.

use clap::Args;
use console::case_arguments::CaseArguments;
use console::command::{Command, Context, Group};
use console::output::print;
use contract::text::json;
use run::error::RunError;
use run::fleet::Fleet;
use run::plan::CaseOverview;
use run::plan_file::PlanFile;
use studies::advise;
use studies::study::bench::Bench;

/// Options of `coordinator plan`.
#[derive(Debug, Args)]
pub(crate) struct PlanCommand {
    #[command(flatten)]
    case: CaseArguments,
    /// Start no program: show the case, and the programs that it would start.
    #[arg(long)]
    no_start: bool,
    /// Show the laws of all effects, also of those that are off.
    #[arg(long, conflicts_with = "no_start")]
    all: bool,
    /// Estimate the change and the cost of every effect, in the case or not.
    #[arg(long, conflicts_with = "no_start")]
    advise: bool,
    /// Print JSON, as in plan.json.
    #[arg(long, conflicts_with_all = ["no_start", "all", "advise"])]
    json: bool,
}

impl Command for PlanCommand {
    const NAME: &'static str = "plan";
    const GROUP: Group = Group::Run;
    const ABOUT: &'static str = "Show what a case will run, and at what cost. Starts the programs that the case names, because only they know what they offer";
    const EXAMPLES: &'static [&'static str] =
        &["coordinator plan CASE", "coordinator plan CASE --advise"];

    fn run(&self, context: &Context<'_>) -> Result<(), RunError> {
        // The plan is the answer: --quiet does not hide it.
        let context = Context { quiet: false, ..*context };
        if self.no_start {
            return context.print_lines(&CaseOverview(&self.case.alone()?).to_string());
        }
        let mut bench = Bench::new(Fleet::for_one_run());
        let planned = self.case.plan(&mut bench.fleet)?;
        if self.json {
            return print(&json(&PlanFile::of(&planned.plan)));
        }
        let mut text = match self.all {
            true => format!("{:#}", planned.plan),
            false => planned.plan.to_string(),
        };
        if self.advise {
            let advice = advise::advise(&self.case.case, &self.case.changes, &planned, &mut bench)?;
            text += &advise::text(&advice, &planned);
        }
        context.print_lines(&text)
    }
}
