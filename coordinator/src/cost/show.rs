//! The study on the terminal.

use super::{Compared, Run, Study};
use crate::study::quantity::Measure;
use comfy_table::{CellAlignment, Table, presets};
use run::format::{bytes, number, of_key, seconds};
use std::fmt::Write as _;

/// Quantities that have a column; all of them are in the files.
pub(super) const COLUMNS: usize = 7;

/// Everything that a person wants to see of a study.
pub(super) fn text(study: &Study) -> String {
    let mut out = format!("cost of {}", study.case);
    if let Some(title) = &study.title {
        let _ = write!(out, " · {title}");
    }
    out += "\n";
    for one in study.quantities.iter().take(COLUMNS) {
        out += &reference(one);
    }
    for (number, level) in study.levels.iter().enumerate() {
        let _ = writeln!(out, "\n{}", level.name);
        for what in &level.left_out {
            let _ = writeln!(out, "  leaves out: {}", what.what);
        }
        out += &table(study, number);
        if let Some(orders) = orders(study, number) {
            let _ = writeln!(out, "  order       {orders}");
        }
        if let Some(why) = &level.stops_paying {
            let _ = writeln!(out, "  refining does not pay {why}");
        }
    }
    for (name, why) in &study.refused {
        let _ = writeln!(out, "\n{name}\n  cannot run this case: {why}");
    }
    for (what, why) in &study.left_out {
        let _ = writeln!(out, "  left out: {what}: {why}");
    }
    out += "\n";
    out + &picks(study)
}

fn reference(one: &Compared) -> String {
    let Some(reference) = &one.reference else { return String::new() };
    let within = match reference.uncertainty {
        Some(0.0) => String::new(),
        Some(off) => format!(" ± {}", error(one.measure, off)),
        None => " ± ?".to_owned(),
    };
    format!(
        "  {:15} {}{within}   {}\n",
        one.name,
        of_key(&one.key, reference.value).show(reference.value, 7),
        reference.source
    )
}

/// An error as it is measured: in per cent, or as it is.
pub(super) fn error(measure: Measure, value: f64) -> String {
    match measure {
        Measure::Relative => format!("{} %", number(100.0 * value, 2)),
        Measure::Absolute | Measure::Itself => number(value, 2),
    }
}

fn table(study: &Study, level: usize) -> String {
    let runs: Vec<&Run> = study.runs.iter().filter(|run| run.level == level).collect();
    let Some(first) = runs.first() else { return "  no run\n".to_owned() };
    let mut head: Vec<String> = vec![String::new()];
    head.extend(first.settings.iter().map(|(key, _)| key.clone()));
    head.extend(["solve", "wall", "cpu", "memory", "iter"].map(str::to_owned));
    let shown = || study.quantities.iter().take(COLUMNS);
    for (n, one) in shown().enumerate() {
        if n == 0 {
            head.push(one.name.clone());
        }
        head.push(if n == 0 { "error".to_owned() } else { one.name.clone() });
    }
    let settings = |run: &Run| -> Vec<String> {
        run.settings.iter().map(|(key, value)| format!("{key} {value}")).collect()
    };
    let why = |run: &&Run| {
        Some(format!("  {} failed: {}\n", settings(run).join(", "), run.failed.as_ref()?))
    };
    let reasons: Vec<String> = runs.iter().filter_map(why).collect();
    let mut table = Table::new();
    table.load_preset(presets::NOTHING).set_header(head);
    for run in runs {
        table.add_row(row(run, shown()));
    }
    for (n, column) in table.column_iter_mut().enumerate() {
        column.set_padding((if n == 0 { 1 } else { 0 }, 2));
        if n > 0 {
            column.set_cell_alignment(CellAlignment::Right);
        }
    }
    let lines = table.lines().map(|line| format!("{}\n", line.trim_end()));
    lines.chain(reasons).collect()
}

fn row<'a>(run: &Run, quantities: impl Iterator<Item = &'a Compared>) -> Vec<String> {
    let mut row = vec![if run.pareto { "*".to_owned() } else { String::new() }];
    row.extend(run.settings.iter().map(|(_, value)| value.clone()));
    if run.failed.is_some() {
        row.push("failed".to_owned());
        return row;
    }
    let cost = &run.cost;
    row.push(seconds(cost.solve_s));
    row.push(seconds(cost.wall_s));
    row.push(seconds(cost.cpu_s.values().sum()));
    row.push(bytes(cost.peak_rss_bytes.values().sum()));
    row.push(cost.iterations.to_string());
    for (n, one) in quantities.enumerate() {
        if n == 0 {
            row.push(run.values.get(&one.key).map(|v| number(*v, 6)).unwrap_or_default());
        }
        row.push(run.errors.get(&one.key).map(|v| error(one.measure, *v)).unwrap_or_default());
    }
    row
}

fn orders(study: &Study, level: usize) -> Option<String> {
    let shows = &study.levels[level].shows;
    let seen = study.quantities.iter().filter_map(|one| {
        let order = shows.get(&one.key)?.order?;
        Some(format!("{} {order:.2}", one.name))
    });
    let seen: Vec<String> = seen.collect();
    (!seen.is_empty()).then(|| seen.join(", "))
}

fn picks(study: &Study) -> String {
    let Some(first) = study.quantities.first() else { return String::new() };
    let mut out = format!(
        "what to run for {} (* Pareto-optimal: none is both cheaper and more accurate)\n",
        first.name
    );
    for pick in &study.picks {
        let target = error(first.measure, pick.target);
        let Some(run) = pick.run.map(|index| &study.runs[index]) else {
            let _ = writeln!(out, "  {target:>6}  none of these runs");
            continue;
        };
        let options = run.options.join(" ");
        let _ = writeln!(
            out,
            "  {target:>6}  {:12} {:>8}   {options}",
            seconds(run.cost.solve_s),
            error(first.measure, run.errors[&first.key]),
        );
    }
    let known = match first.reference.as_ref().map(|reference| reference.uncertainty) {
        None | Some(Some(0.0)) => return out,
        Some(Some(off)) => format!("known to {}", error(first.measure, off)),
        Some(None) => "from a single grid: its error is not known".to_owned(),
    };
    let _ = writeln!(out, "  the reference itself is {known}");
    out
}
