//! `coordinator compare A B`: what differs between two results in case, figures, fields and time.

mod difference;
mod fields;
mod flat;
mod show;

use clap::Args;
use console::command::{Command, Context, Group};
use console::output::print;
use contract::text::json;
use difference::Comparison;
use pages::source::Results;
use run::error::RunError;
use run::signals;
use std::path::PathBuf;

/// Two results.
#[derive(Debug, Args)]
pub(crate) struct CompareCommand {
    /// A result directory.
    #[arg(value_name = "A")]
    a: PathBuf,
    /// Another one.
    #[arg(value_name = "B")]
    b: PathBuf,
    /// Print JSON.
    #[arg(long)]
    json: bool,
}

impl Command for CompareCommand {
    const NAME: &'static str = "compare";
    const GROUP: Group = Group::Look;
    const ABOUT: &'static str =
        "Say what differs between two results: case, figures, fields and time";

    fn run(&self, context: &Context<'_>) -> Result<(), RunError> {
        let _reading = signals::end_at_once();
        let [a, b] = [Results::read(&self.a)?, Results::read(&self.b)?];
        let comparison = Comparison::of(&a, &b);
        if self.json {
            return print(&json(&comparison));
        }
        context.print(&show::text(&comparison, [&self.a, &self.b]))
    }
}
