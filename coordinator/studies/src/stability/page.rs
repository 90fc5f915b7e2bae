//! The page about a suite.

use super::report::{CaseReport, Report, RunResult, SweepReport};
use super::rows::{self, OTHERWISE, course, factor};
use crate::study::output::Shown;
use pages::page::{Block, Headline, Mood, Page, Section};
use pages::plot::Figure;
use pages::table::Table;
use run::error::RunError;
use run::format::number;
use std::path::Path;

/// From this ratio of the largest to the least value on they are drawn by decades.
const DECADES: f64 = 20.0;

impl Shown for Report {
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
        title: format!("the hard cases of {}", report.suite),
        status: if good { "as expected" } else { "did not meet expectations" }.to_owned(),
        mood: if good { Mood::Good } else { Mood::Bad },
        reason: reason(report),
        sections,
    }
}

fn reason(report: &Report) -> String {
    let other = report.cases.iter().filter(|case| !case.as_expected());
    let names: Vec<String> = other.map(|case| format!("`{}`", case.name)).collect();
    match names.is_empty() {
        true => "every case and every edge is where the suite says".to_owned(),
        false => format!("look at {}", names.join(", ")),
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
            "sweeps; the others hold to their last value".to_owned(),
        ),
        headline("Runs", report.runs().to_string(), format!("in {:.1} s", report.wall_s)),
    ];
    all.extend(worst_energy.map(|imbalance| {
        headline("Largest heat imbalance", number(imbalance, 2), "of all answers".to_owned())
    }));
    Section { title: "Results".to_owned(), blocks: vec![Block::Headlines(all)] }
}

fn cases(report: &Report) -> Section {
    let table = rows::cases().page(&report.cases.iter().collect::<Vec<_>>());
    let text = "The margin is the least ratio of bound to quantity: 2× means that the quantity is \
                half of its bound.";
    Section {
        title: "Cases".to_owned(),
        blocks: vec![Block::Text(text.to_owned()), Block::Table(table)],
    }
}

fn edges(report: &Report) -> Option<Section> {
    let mut table = Table::new(["case", "parameter", "values", "why"], 4);
    for case in &report.cases {
        for sweep in &case.sweeps {
            let course = unless(sweep.as_expected(), course(sweep));
            table.row([case.name.clone(), sweep.parameter.clone(), course, sweep.why.clone()]);
        }
    }
    let text =
        "The bar stands between the last value that went as before and the first that did not.";
    let blocks = vec![Block::Text(text.to_owned()), Block::Table(table)];
    Section::of("Edges", blocks).filter(|_| report.cases.iter().any(|case| !case.sweeps.is_empty()))
}

/// A case with its bounds, and every run of its sweeps.
fn details(case: &CaseReport) -> Section {
    let mut blocks = vec![
        Block::Text(format!("{}. Expected: {}.", case.title, case.expected)),
        Block::Table(findings(case)),
    ];
    if let Some((_, message)) = &case.row.error {
        blocks.push(Block::Verbatim("It ended with".to_owned(), message.trim_end().to_owned()));
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

/// What each quantity takes of its bound over the values of a sweep; `None` where fewer than three are
/// numbers with an answer.
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
    let mut figure = Figure::new(&sweep.parameter, &sweep.parameter, "part of the bound");
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
        Some(edge) => format!("1 is the bound. From {edge} on: {}.", beyond(sweep)),
        None => "1 is the bound; every value keeps it.".to_owned(),
    };
    Some(figure.with("bound", vec![[least, 1.0], [most, 1.0]]))
}

/// What is beyond the edge of a sweep, in words.
fn beyond(sweep: &SweepReport) -> &str {
    sweep.beyond.as_deref().unwrap_or("it goes otherwise than before")
}

fn findings(case: &CaseReport) -> Table {
    let mut table = Table::new(["quantity", "value", "bound", "margin", "because"], 5);
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

/// The words, marked where something is otherwise than expected.
fn unless(as_expected: bool, words: String) -> String {
    if as_expected { words } else { format!("{OTHERWISE} {words}") }
}
