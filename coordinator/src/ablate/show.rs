//! The study on the terminal.

use super::{Run, Study};
use crate::study::quantity::{Measure, Quantity};
use comfy_table::{CellAlignment, Table, presets};
use run::format::{number, of_key, seconds};

/// Quantities that have a column; all of them are in the file.
pub(super) const COLUMNS: usize = 6;

/// Each effect in a row: what the answer is without it, and what it costs.
pub(super) fn text(study: &Study) -> String {
    let mut head = vec![String::new()];
    head.extend(quantities(study).map(|one| one.name));
    head.extend(["solve", "of the whole", "iter"].map(str::to_owned));
    let mut table = Table::new();
    table.load_preset(presets::NOTHING).set_header(head);
    for run in std::iter::once(&study.whole).chain(&study.without) {
        table.add_row(row(study, run));
    }
    for (n, column) in table.column_iter_mut().enumerate() {
        column.set_padding((if n == 0 { 2 } else { 0 }, 2));
        if n > 0 {
            column.set_cell_alignment(CellAlignment::Right);
        }
    }
    let title = study.title.as_ref().map(|title| format!(" · {title}")).unwrap_or_default();
    let lines = table.lines().map(|line| format!("{}\n", line.trim_end()));
    let why = |run: &Run| Some(format!("  without {}: {}\n", run.effect, run.failed.as_ref()?));
    let reasons = study.without.iter().filter_map(why);
    format!("effects of {}{title}\n{}", study.case, lines.chain(reasons).collect::<String>())
}

/// The quantities that have a column.
pub(super) fn quantities(study: &Study) -> impl Iterator<Item = Quantity> {
    let compared = study.quantities.iter().map(|key| Quantity::of(key));
    compared.filter(|one| one.measure != Measure::Itself).take(COLUMNS)
}

/// The cells of a run: its quantities first, their changes for one without an effect.
pub(super) fn row(study: &Study, run: &Run) -> Vec<String> {
    let name = match run.effect.as_str() {
        "" => "all effects".to_owned(),
        effect => format!("without {effect}"),
    };
    let mut cells = vec![name];
    if run.failed.is_some() {
        cells.push("cannot run".to_owned());
        return cells;
    }
    cells.extend(quantities(study).map(|one| match run.values.get(&one.key) {
        None => "-".to_owned(),
        Some(value) if run.effect.is_empty() => of_key(&one.key, *value).show(*value, 5),
        Some(value) => match run.changes.get(&one.key) {
            Some(change) => shown(one.measure, *change),
            None => of_key(&one.key, *value).show(*value, 5),
        },
    }));
    cells.push(seconds(run.cost.solve_s));
    let share = 100.0 * run.cost.solve_s / study.whole.cost.solve_s;
    cells.push(format!("{} %", number(share, 2)));
    cells.push(run.cost.iterations.to_string());
    cells
}

/// A change with its sign, as it is measured.
fn shown(measure: Measure, change: f64) -> String {
    if change == 0.0 {
        return "same".to_owned();
    }
    let sign = if change > 0.0 { "+" } else { "" };
    match measure {
        Measure::Relative => format!("{sign}{} %", number(100.0 * change, 2)),
        Measure::Absolute | Measure::Itself => format!("{sign}{}", number(change, 2)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_change_has_its_sign() {
        assert_eq!(shown(Measure::Relative, 0.123), "+12 %");
        assert_eq!(shown(Measure::Relative, -0.004), "−0.40 %");
        assert_eq!(shown(Measure::Absolute, -0.2), "−0.20");
        assert_eq!(shown(Measure::Relative, 0.0), "same");
    }
}
