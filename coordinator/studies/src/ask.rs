//! `coordinator ask`: evaluates a surrogate at a point, or at the rows of a table.

mod file;
mod table;

pub use file::document;

use crate::fit::number;
use clap::Args;
use console::command::{Command, Context, Group};
use console::output::print;
use contract::text::json;
use file::{place, read};
use run::error::RunError;
use run::format::of_key;
use serde_json::{Map, Value, json};
use std::path::PathBuf;
use surrogate::{Figure, Measure, Surrogate};

/// Options of `coordinator ask`.
#[derive(Debug, Args)]
pub struct AskCommand {
    /// Surrogate file, or folder of a sweep that contains a surrogate.
    file: PathBuf,
    /// Point to evaluate: a value for each key, in SI units or with a unit.
    #[arg(value_name = "KEY=VALUE")]
    at: Vec<String>,
    /// Print only this figure; may be repeated.
    #[arg(long, value_name = "KEY")]
    figure: Vec<String>,
    /// Evaluate the rows of a CSV file, or of standard input for `-`: keys in the first line,
    /// values below. The output is CSV, with the figures in SI units.
    #[arg(long, value_name = "FILE", conflicts_with_all = ["at", "json"])]
    table: Option<PathBuf>,
    /// Print the value and error of each figure as JSON, in SI units.
    #[arg(long)]
    json: bool,
}

impl Command for AskCommand {
    const NAME: &'static str = "ask";
    const GROUP: Group = Group::Study;
    const ABOUT: &'static str = "Evaluate a surrogate at a point or over a table";
    const EXAMPLES: &'static [&'static str] = &["coordinator ask results/latest motion.speed=25"];

    fn run(&self, _: &Context<'_>) -> Result<(), RunError> {
        let surrogate = read(&self.file, &self.figure)?;
        if let Some(rows) = &self.table {
            return table::answer(&surrogate, rows);
        }
        let at = point(&surrogate, &self.at)?;
        let mut room = surrogate.room();
        let refused = |refused: surrogate::Refused| RunError::Usage(refused.to_string());
        let values = surrogate.ask(&at, &mut room).map_err(refused)?;
        let each = || surrogate.figures().iter().zip(values.iter().copied());
        print(&match self.json {
            true => json(&Value::Object(each().map(as_json).collect::<Map<_, _>>())),
            false => each().map(line).collect(),
        })
    }
}

/// Parses the values of the keys, in the order of the surrogate.
fn point(surrogate: &Surrogate, given: &[String]) -> Result<Vec<f64>, RunError> {
    let mut at: Vec<Option<f64>> = vec![None; surrogate.keys().len()];
    for option in given {
        let Some((key, text)) = option.split_once('=') else {
            return Err(RunError::Usage(format!("`{option}` is not KEY=VALUE")));
        };
        let n = place(surrogate, key.trim())?;
        let value = number(key.trim(), text, &surrogate.keys()[n].unit)?;
        if at[n].replace(value).is_some() {
            return Err(RunError::Usage(format!("{key} is given twice")));
        }
    }
    let named = surrogate.keys().iter().zip(&at);
    let missing: Vec<String> = named
        .filter(|(_, value)| value.is_none())
        .map(|(key, _)| format!("{} ({} to {} {})", key.key, key.from, key.to, key.unit))
        .collect();
    match missing.as_slice() {
        [] => Ok(at.into_iter().flatten().collect()),
        some => Err(RunError::Usage(format!(
            "missing values: {}; add KEY=VALUE for each",
            some.join(", ")
        ))),
    }
}

fn as_json((figure, value): (&Figure, f64)) -> (String, Value) {
    (figure.key.clone(), json!({"value": value, "error": figure.held.bound(value)}))
}

/// Formats a figure and its error in a suitable unit.
fn line((figure, value): (&Figure, f64)) -> String {
    let error = match figure.held.measure {
        Measure::Relative => format!("{} %", run::format::number(100.0 * figure.held.largest, 2)),
        Measure::Absolute => of_key(&figure.key, figure.held.largest).show(figure.held.largest, 2),
    };
    let value = of_key(&figure.key, value).show(value, 5);
    format!("  {:44} {value:>18}  ± {error}\n", figure.key)
}
