//! Renders the study for the terminal.

use super::runs::{COLUMNS, of_level, table};
use super::study::{Compared, Study};
use run::format::{counted, of_key, seconds};
use std::fmt::Write as _;

/// Largest number of skipped runs on the terminal.
const SKIPPED: usize = 6;

/// Renders the complete study.
pub(super) fn text(study: &Study) -> String {
    let mut out = format!("cost of {}", study.case);
    if let Some(title) = &study.title {
        let _ = write!(out, " · {title}");
    }
    out += "\n";
    for one in study.quantities.iter().take(COLUMNS) {
        out += &reference(one);
    }
    if let Some(text) = study.missing_models() {
        let _ = writeln!(out, "  {text}");
    }
    for (number, level) in study.levels.iter().enumerate() {
        let _ = writeln!(out, "\n{}", level.name);
        for what in &level.left_out {
            let _ = writeln!(out, "  leaves out: {}", what.what);
        }
        out += &runs(study, number);
        if let Some(orders) = orders(study, number) {
            let _ = writeln!(out, "  order       {orders}");
        }
        if let Some(why) = &level.stops_paying {
            let _ = writeln!(out, "  further refinement does not pay {why}");
        }
    }
    for (name, why) in &study.refused {
        let _ = writeln!(out, "\n{name}\n  cannot run this case: {why}");
    }
    for (what, why) in study.left_out.iter().take(SKIPPED) {
        let _ = writeln!(out, "  skipped: {what}: {why}");
    }
    let more = study.left_out.len().saturating_sub(SKIPPED) as u64;
    if more > 0 {
        let _ = writeln!(out, "  and {} more skipped, see cost.json", counted(more, "run"));
    }
    out += "\n";
    out + &picks(study)
}

fn reference(one: &Compared) -> String {
    let Some(reference) = &one.reference else { return String::new() };
    let within = match reference.uncertainty {
        Some(0.0) => String::new(),
        Some(off) => format!(" ± {}", one.show_error(off)),
        None => " ± ?".to_owned(),
    };
    format!(
        "  {:15} {}{within}   {}\n",
        one.name,
        of_key(&one.key, reference.value).show(reference.value, 7),
        reference.source
    )
}

fn runs(study: &Study, level: usize) -> String {
    match of_level(study, level) {
        (runs, _) if runs.is_empty() => "  no runs\n".to_owned(),
        (runs, settings) => table(study, &settings).terminal(&runs),
    }
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
        "recommended runs for {} (* Pareto-optimal: no run is both cheaper and more accurate)\n",
        first.name
    );
    for pick in &study.picks {
        let target = first.show_error(pick.target);
        let Some(run) = pick.run.map(|index| &study.runs[index]) else {
            let _ = writeln!(out, "  {target:>6}  no run");
            continue;
        };
        let options = run.options.join(" ");
        let _ = writeln!(
            out,
            "  {target:>6}  {:12} {:>8}   {options}",
            seconds(run.cost.solve_s),
            first.show_error(run.errors[&first.key]),
        );
    }
    let known = match first.reference.as_ref().map(|reference| reference.uncertainty) {
        None | Some(Some(0.0)) => return out,
        Some(Some(off)) => format!("known to within {}", first.show_error(off)),
        Some(None) => "from a single grid: its error is unknown".to_owned(),
    };
    let _ = writeln!(out, "  the reference itself is {known}");
    out
}
