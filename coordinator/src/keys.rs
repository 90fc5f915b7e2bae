//! `coordinator keys`: every key that a case may have: unit, range, default, and who reads it.
//!
//! The keys are those of the coordinator's own table and of what the installed programs describe; docs/case.md and
//! docs/case.schema.json are written from them.

mod schema;

use crate::installed::installed;
use case::schema::ROLE;
use clap::Args;
use console::command::{Command, Context, Group};
use console::keys::{Key, all, facts, kind, need, range, section};
use console::listing::Listing;
use console::output::print;
use contract::text::json;
use run::error::RunError;
use run::wrap;
use std::fmt::Write as _;

/// Options of `coordinator keys`.
#[derive(Debug, Args)]
pub(crate) struct KeysCommand {
    #[command(flatten)]
    of: Listing,
    /// Print a JSON Schema of cases, with which editors complete and check.
    #[arg(long, conflicts_with_all = ["json", "markdown", "pattern"])]
    schema: bool,
}

impl Command for KeysCommand {
    const NAME: &'static str = "keys";
    const GROUP: Group = Group::Reference;
    const ABOUT: &'static str =
        "Show every key that a case may have: unit, range, default, and who reads it";

    fn run(&self, _: &Context<'_>) -> Result<(), RunError> {
        let described = &installed()?;
        let keys = self.of.pick(all(described), |key| [&key.spec.path, &key.spec.help])?;
        print(&match (self.of.json, self.of.markdown, self.schema) {
            (true, ..) => json(&keys),
            (_, true, _) => markdown(&keys),
            (.., true) => json(&schema::schema(&keys, described)),
            _ => keys.iter().map(terminal).collect(),
        })
    }
}

fn terminal(key: &Key) -> String {
    wrap::columns(&format!(
        "{}  [{}]\n    {}\n    read by {}\n",
        key.spec.path,
        facts(key),
        key.spec.help,
        key.read_by.join(", ")
    ))
}

/// The page docs/case.md.
fn markdown(keys: &[Key]) -> String {
    let mut text = format!(
        "# Keys of a case\n\nEvery key that the coordinator and the installed programs read, as `coordinator keys --markdown` writes \
         them; `coordinator keys PATTERN` shows some. A quantity is a number in the unit given, or a text with another one (`\"134 kN\"`); \
         `*` stands for any name, `{ROLE}` for the name of a participant. A key that may vary takes a column of a table, \
         `{{ file = \"run.csv\", column = \"N\" }}`, or is given from outside as the run goes, \
         `{{ at = \"134 kN\", from = \"60 kN\", to = \"140 kN\" }}` (docs/fmi.md).\n"
    );
    let mut last = "";
    for key in keys {
        if section(key) != last {
            last = section(key);
            let _ = write!(
                text,
                "\n## {last}\n\n| key | unit, type | range | | what | read by |\n| --- | --- | --- | --- | --- | --- |\n"
            );
        }
        let cells = [kind(key), range(&key.spec), need(&key.spec), key.spec.help.clone()];
        let cells = cells.map(|cell| cell.replace('|', "\\|"));
        let _ = writeln!(
            text,
            "| `{}` | {} | {} |",
            key.spec.path,
            cells.join(" | "),
            key.read_by.join(", ")
        );
    }
    text
}
