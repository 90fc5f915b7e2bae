//! Renders a report as a page, and its edges as the page of limits.

use super::report::{CaseReport, Report, RunResult, SweepReport};
use super::rows::{self, OTHERWISE, course, factor};
use crate::study::output::StudyPage;
use pages::page::{Block, Headline, Page, RunStatus, Section};
use pages::plot::Figure;
use pages::table::Table;
use run::error::RunError;
use run::format::number;
use std::fmt::Write as _;
use std::path::Path;

/// Ratio of the largest to the smallest value above which an axis is logarithmic.
const DECADES: f64 = 20.0;

impl StudyPage for Report {
    fn page(&self, _: &Path) -> Result<Page, RunError> {
        Ok(of(self))
    }
}

fn of(report: &Report) -> Page {
    let good = report.as_expected();
    let sections = [Some(overview(report)), Some(cases(report)), edges(report)];
    let mut sections: Vec<Section> = sections.into_iter().flatten().collect();
    sections.extend(report.cases.iter().map(details));
    Page {
        name: "stability".to_owned(),
        title: format!("hard cases of {}", report.suite),
        status: if good { "as expected" } else { "did not meet expectations" }.to_owned(),
        mood: if good { RunStatus::Good } else { RunStatus::Bad },
        reason: reason(report),
        sections,
    }
}

fn reason(report: &Report) -> String {
    let other = report.cases.iter().filter(|case| !case.as_expected());
    let names: Vec<String> = other.map(|case| format!("`{}`", case.name)).collect();
    match names.is_empty() {
        true => "every case and every edge is as the suite expects".to_owned(),
        false => format!("unexpected: {}", names.join(", ")),
    }
}

fn overview(report: &Report) -> Section {
    let headline =
        |name: &str, value: String, more: String| Headline { name: name.into(), value, more };
    let good = report.cases.iter().filter(|case| case.as_expected()).count();
    let sweeps: Vec<&SweepReport> = report.cases.iter().flat_map(|case| &case.sweeps).collect();
    let edges = sweeps.iter().filter(|sweep| sweep.edge().is_some()).count();
    let answers = report.cases.iter().flat_map(CaseReport::runs).filter(|(_, row)| row.answers());
    let worst_energy = answers.filter_map(|(_, row)| row.energy_imbalance).reduce(f64::max);
    let mut all = vec![
        headline("Cases as expected", format!("{good} of {}", report.cases.len()), String::new()),
        headline(
            "Edges found",
            format!("{edges} of {}", sweeps.len()),
            "sweeps; the others stay within bounds up to their last value".to_owned(),
        ),
        headline("Runs", report.runs().to_string(), format!("in {:.1} s", report.wall_s)),
    ];
    all.extend(worst_energy.map(|imbalance| {
        headline("Largest heat imbalance", number(imbalance, 2), "of all results".to_owned())
    }));
    Section { title: "Results".to_owned(), blocks: vec![Block::Headlines(all)] }
}

fn cases(report: &Report) -> Section {
    let table = rows::cases().page(&report.cases.iter().collect::<Vec<_>>());
    let text = "The margin is the smallest ratio of bound to quantity: 2× means that the \
                quantity is half of its bound.";
    Section {
        title: "Cases".to_owned(),
        blocks: vec![Block::Text(text.to_owned()), Block::Table(table)],
    }
}

fn edges(report: &Report) -> Option<Section> {
    let mut table = Table::new(["case", "parameter", "values", "reason"], 4);
    for case in &report.cases {
        for sweep in &case.sweeps {
            let course = unless(sweep.as_expected(), course(sweep));
            table.row([case.name.clone(), sweep.parameter.clone(), course, sweep.why.clone()]);
        }
    }
    let text =
        "The bar separates the last value that behaves as before from the first that does not.";
    let blocks = vec![Block::Text(text.to_owned()), Block::Table(table)];
    Section::of("Edges", blocks).filter(|_| report.cases.iter().any(|case| !case.sweeps.is_empty()))
}

/// Renders a case with its bounds and all runs of its sweeps.
fn details(case: &CaseReport) -> Section {
    let mut blocks = vec![
        Block::Text(format!("{}. Expected: {}.", case.title, case.expected)),
        Block::Table(findings(case)),
    ];
    if let Some((_, message)) = &case.row.error {
        blocks.push(Block::Verbatim("Error message".to_owned(), message.trim_end().to_owned()));
    }
    blocks.extend(case.sweeps.iter().filter_map(plot).map(Block::Figure));
    blocks.extend(case.sweeps.iter().map(|sweep| {
        Block::Folded(
            format!("{}: {} runs", sweep.parameter, sweep.rows.len()),
            rows::values(sweep).page(&sweep.rows.iter().collect::<Vec<_>>()),
        )
    }));
    Section { title: format!("{}. {}", case.number, case.name), blocks }
}

/// Plots the share of each bound that a quantity uses, over the values of a sweep. `None` if fewer
/// than three values are numbers with a result.
fn plot(sweep: &SweepReport) -> Option<Figure> {
    let answers = sweep.rows.iter().filter(|(_, row)| row.error.is_none());
    let numbers = answers.filter_map(|(value, row)| Some((value.parse::<f64>().ok()?, row)));
    let mut rows: Vec<(f64, &RunResult)> = numbers.collect();
    rows.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (least, most) = (rows.first()?.0, rows.last()?.0);
    let mut names: Vec<&str> = Vec::new();
    for finding in rows.iter().flat_map(|(_, row)| &row.findings) {
        if !names.contains(&finding.name.as_str()) {
            names.push(&finding.name);
        }
    }
    let mut figure = Figure::new(&sweep.parameter, &sweep.parameter, "share of the bound");
    figure.decades = true;
    figure.decades_x = least > 0.0 && most > DECADES * least;
    for name in names {
        let share = |row: &RunResult| row.findings.iter().find(|f| f.name == name)?.share;
        let points = rows.iter().filter_map(|(value, row)| Some([*value, share(row)?]));
        figure = figure.with(name, points.filter(|point| point[1] > 0.0).collect());
    }
    figure.lines.retain(|line| line.points.len() > 2);
    if figure.lines.is_empty() {
        return None;
    }
    figure.note = match sweep.edge().map(|n| sweep.rows[n].0.as_str()) {
        Some(edge) => format!("1 is the bound. From {edge} onwards: {}.", beyond(sweep)),
        None => "1 is the bound; all values stay within it.".to_owned(),
    };
    Some(figure.with("bound", vec![[least, 1.0], [most, 1.0]]))
}

/// Describes the behaviour beyond the edge of a sweep.
fn beyond(sweep: &SweepReport) -> &str {
    sweep.beyond.as_deref().unwrap_or("the behaviour changes")
}

fn findings(case: &CaseReport) -> Table {
    let mut table = Table::new(["quantity", "value", "bound", "margin", "reason"], 5);
    for finding in &case.row.findings {
        let because = case.bounds.iter().find(|[name, ..]| *name == finding.name);
        table.row([
            finding.name.clone(),
            finding.value.map_or_else(|| "none".to_owned(), |value| number(value, 4)),
            finding.bound.clone(),
            unless(finding.holds(), factor(finding)),
            because.map_or_else(String::new, |[_, _, because]| because.clone()),
        ]);
    }
    table
}

/// Marks words where the outcome is unexpected.
fn unless(as_expected: bool, words: String) -> String {
    if as_expected { words } else { format!("{OTHERWISE} {words}") }
}

const OPENING: &str = "\
# Limits

The edges at which the results of this program end, and the behaviour there. Every line is the
outcome of a run of `coordinator stability`, which wrote this file (`--write-limits
docs/limits.md`); the nightly tests repeat the runs and compare. The cases and the reasons for their
bounds are in [cases/hard/suite.toml](../cases/hard/suite.toml); a new case or sweep is one more
entry there. The numbers in headings refer to the list of hard cases.

The *edge* lies between the last value that behaves as before and the first that does not; values
beyond the edge were run as well. A refusal ends the command with the given exit code and a message
that contains the quoted words, the place and the fix. In every case, within the tolerances of the
suite, the fields are finite, the heat sent equals the heat received, and temperatures and friction
power are not negative. The recording can be read up to the end of the run, however the run ends.
";

/// Renders the page of limits.
pub(super) fn text(report: &Report) -> String {
    let mut text = OPENING.to_owned();
    for case in &report.cases {
        section(&mut text, case);
    }
    text
}

fn section(text: &mut String, case: &CaseReport) {
    let _ = writeln!(text, "\n## {}. {}: {}\n", case.number, case.name, case.title);
    let _ = writeln!(text, "Expected: {}.", case.expected.replace('\n', " "));
    *text += &table(["check", "bound", "reason"], case.bounds.iter().cloned());
    let head = ["parameter", "before the edge", "edge", "beyond the edge", "reason"];
    *text += &table(head, case.sweeps.iter().map(edge));
}

/// Renders a table; empty without rows.
fn table<const N: usize>(head: [&str; N], rows: impl Iterator<Item = [String; N]>) -> String {
    let mut table = Table::new(head, N);
    rows.for_each(|row| table.row(row));
    match table.rows.is_empty() {
        true => String::new(),
        false => format!("\n{}\n", table.markdown()),
    }
}

fn edge(sweep: &SweepReport) -> [String; 5] {
    let SweepReport { parameter, before, beyond, why, rows } = sweep;
    let first = rows.first().map_or("", |(value, _)| value);
    let last = rows.last().map_or("", |(value, _)| value);
    let (place, beyond) = match (sweep.edge(), beyond) {
        (Some(at), Some(beyond)) => {
            (format!("{} | {}, from {first}", rows[at - 1].0, rows[at].0), beyond.as_str())
        }
        _ => (format!("none from {first} to {last}"), "–"),
    };
    [parameter.clone(), before.clone(), place, beyond.to_owned(), why.clone()]
}
