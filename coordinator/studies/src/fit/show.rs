//! A surrogate on the terminal.

use super::make::Made;
use crate::study::table::{Cell, Column, Table};
use run::format::{counted, number, of_key};
use surrogate::{FittedFigure, Key, Measure, Scale};

/// A relative error that is nothing but rounding.
const ROUNDING: f64 = 1e-10;

/// The box, the figures with their errors, and what was left out.
pub(super) fn text(made: &Made) -> String {
    let document = &made.document;
    let keys: String =
        document.keys.iter().map(|one| format!("  {:40}  {}\n", one.key, interval(one))).collect();
    let quotients = document.coordinates.iter().filter_map(|one| {
        let name = format!("{}/{}", one.key, one.per.as_ref()?);
        Some(format!("  {name:40}  {} to {}\n", one.from, one.to))
    });
    let figures: Vec<&FittedFigure> = document.figures.iter().collect();
    let left_out = made.left_out.iter().map(|(key, why)| format!("  not fitted: {key}: {why}\n"));
    format!(
        "surrogate of {}, {}\n{keys}{}{}{}{}",
        document.origin.case,
        counted(made.samples.points as u64, "point"),
        quotients.collect::<String>(),
        without_answer(made),
        table().terminal(&figures),
        left_out.collect::<String>()
    )
}

fn interval(one: &Key) -> String {
    let unit = if matches!(one.unit.as_str(), "" | "1") { "" } else { &one.unit };
    format!("{} to {} {unit}", one.from, one.to).trim_end().to_owned()
}

/// What the box is smaller for.
fn without_answer(made: &Made) -> String {
    let [failed, cut] = [made.samples.failed, made.samples.cut].map(|count| count as u64);
    match (failed, cut) {
        (0, _) => String::new(),
        (_, 0) => format!("  {} without an answer, outside of the box\n", counted(failed, "point")),
        _ => format!(
            "  {} without an answer; the box is smaller for them, and {} with one lie outside\n",
            counted(failed, "point"),
            counted(cut, "point")
        ),
    }
}

fn table<'a>() -> Table<'a, FittedFigure> {
    let error = |one: &FittedFigure, error: f64| match one.held.measure {
        Measure::Relative if error < ROUNDING => Cell::text("rounding"),
        Measure::Relative => Cell::text(format!("{} %", number(100.0 * error, 2))),
        Measure::Absolute => Cell::text(of_key(&one.key, error).show(error, 2)),
    };
    Table::new(vec![
        Column::text("figure", |one: &FittedFigure| one.key.clone()).naming(),
        Column::quantity("largest error", move |one: &FittedFigure| error(one, one.held.largest)),
        Column::quantity("rms", move |one: &FittedFigure| error(one, one.held.rms)),
        Column::quantity("terms", |one: &FittedFigure| Cell::text(one.degrees.len())),
        Column::text("scales", |one: &FittedFigure| {
            let word = |scale: &Scale| if *scale == Scale::Log { "log" } else { "lin" };
            let of: Vec<&str> = one.scales.iter().map(word).collect();
            format!("{}({})", word(&one.scale), of.join(","))
        }),
    ])
}
