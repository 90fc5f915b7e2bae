//! Renders the study as a page: work-precision plots, tables and recommended runs.

use super::runs::{COLUMNS, of_level, table};
use super::study::{Compared, Recommendation, Run, Study};
use crate::study::output::StudyPage;
use contract::figure::Measure;
use pages::page::{Block, Headline, Page, RunStatus, Section};
use pages::plot::Figure;
use pages::table::Table;
use run::error::RunError;
use run::format::{of_key, seconds};
use std::collections::BTreeMap;
use std::path::Path;

impl StudyPage for Study {
    fn page(&self, _: &Path) -> Result<Page, RunError> {
        Ok(of(self))
    }
}

fn of(study: &Study) -> Page {
    let made = study.runs.iter().filter(|run| run.failed.is_none()).count();
    let sections = [picks(study), plots(study), references(study), levels(study), notes(study)];
    Page {
        name: format!("Cost of {}", study.case),
        title: study.title.clone().unwrap_or_default(),
        status: format!("{made} runs"),
        mood: if made == study.runs.len() { RunStatus::Good } else { RunStatus::Open },
        reason: format!(
            "accuracy against run time, over the models and resolutions of `{}`",
            study.file
        ),
        sections: sections.into_iter().flatten().collect(),
    }
}

fn picks(study: &Study) -> Option<Section> {
    let first = study.quantities.first()?;
    let headline = |pick: &Recommendation| {
        let name = format!("{} to {}", first.name, first.show_error(pick.target));
        match pick.run.map(|index| &study.runs[index]) {
            None => Headline {
                name,
                value: "none of the runs".to_owned(),
                more: "refine further".to_owned(),
            },
            Some(run) => Headline {
                name,
                value: seconds(run.cost.solve_s),
                more: format!(
                    "{}, {}; error {}",
                    study.levels[run.level].name,
                    run.settings_text(),
                    first.show_error(run.errors[&first.key])
                ),
            },
        }
    };
    let all = study.picks.iter().map(headline).collect();
    Section::of("Recommended runs", vec![Block::Headlines(all)])
}

/// Plots of error over time, for every quantity with a reference.
fn plots(study: &Study) -> Option<Section> {
    let shown = study.quantities.iter().take(COLUMNS);
    let figures = shown.filter_map(|one| work_precision(study, one)).map(Block::Figure);
    Section::of("Accuracy against run time", figures.collect())
}

/// Plot of error over time for a quantity, one line per combination of models; `None` without data.
pub(super) fn work_precision(study: &Study, one: &Compared) -> Option<Figure> {
    let reference = one.reference.as_ref()?;
    let measured = if one.measure == Measure::Relative { "relative error" } else { "error" };
    let title = format!("{}: error over time", one.name);
    let mut figure = Figure::new(title, "time in solvers and coupling [s]", measured);
    (figure.decades, figure.decades_x) = (true, true);
    for (number, level) in study.levels.iter().enumerate() {
        let mut lines: BTreeMap<String, Vec<[f64; 2]>> = BTreeMap::new();
        for run in study.runs.iter().filter(|run| run.level == number) {
            if let Some(error) = run.errors.get(&one.key).filter(|error| **error > 0.0) {
                let point = [run.cost.solve_s, *error];
                lines.entry(line(&level.name, run)).or_default().push(point);
            }
        }
        for (name, points) in lines {
            figure = figure.with(name, points);
        }
    }
    let known = match reference.uncertainty {
        Some(0.0) => String::new(),
        Some(off) => format!(", which has an uncertainty of {}", one.show_error(off)),
        None => ", whose uncertainty is unknown".to_owned(),
    };
    figure.note = format!("Reference: {}{known}.", reference.source);
    figure.has_points().then_some(figure)
}

/// Line that a run belongs to: its models and any settings that are words, because a line cannot
/// run along words.
fn line(models: &str, run: &Run) -> String {
    let is_word = |value: &&str| value.starts_with(|first: char| first.is_ascii_alphabetic());
    let values = run.settings.iter().map(|(_, value)| value.trim_matches('"')).filter(is_word);
    std::iter::once(models).chain(values).collect::<Vec<_>>().join(", ")
}

fn references(study: &Study) -> Option<Section> {
    let mut table = Table::new(["quantity", "source", "reference", "uncertainty"], 2);
    for one in &study.quantities {
        let Some(reference) = &one.reference else { continue };
        let known = match reference.uncertainty {
            Some(0.0) => "exact".to_owned(),
            Some(off) => one.show_error(off),
            None => "unknown".to_owned(),
        };
        let from = reference.source.clone();
        let value = of_key(&one.key, reference.value).show(reference.value, 7);
        table.row([one.name.clone(), from, value, known]);
    }
    Section::of("References", vec![Block::Table(table)])
}

fn levels(study: &Study) -> Option<Section> {
    let mut blocks = Vec::new();
    for (number, level) in study.levels.iter().enumerate() {
        blocks.push(Block::Card(level.name.clone(), runs(study, number)));
        let mut remarks: Vec<String> =
            level.left_out.iter().map(|what| format!("Leaves out: {}.", what.what)).collect();
        remarks.extend(
            level.stops_paying.iter().map(|why| format!("Further refinement does not pay {why}.")),
        );
        if !remarks.is_empty() {
            blocks.push(Block::Text(format!("{}: {}", level.name, remarks.join(" "))));
        }
    }
    Section::of("Runs", blocks)
}

/// Table of the runs of a level, with the observed orders.
fn runs(study: &Study, level: usize) -> Table {
    let (runs, settings) = of_level(study, level);
    let mut table = table(study, &settings).page(&runs);
    let orders = study.quantities.iter().map(|one| {
        let shows = study.levels[level].shows.get(&one.key);
        shows.and_then(|shows| shows.order).map(|order| format!("{order:.2}")).unwrap_or_default()
    });
    let blanks = table.head.len() - study.quantities.len() - 1;
    let mut last = vec!["order".to_owned()];
    last.extend(std::iter::repeat_n(String::new(), blanks));
    last.extend(orders);
    table.rows.push(last);
    table
}

/// Table of cases and runs that were not run, with the reason.
fn notes(study: &Study) -> Option<Section> {
    let mut table = Table::new(["not run", "reason"], 2);
    for (what, why) in study.refused.iter().chain(&study.left_out) {
        table.row([what.clone(), why.clone()]);
    }
    for run in &study.runs {
        if let Some(why) = &run.failed {
            let name = &study.levels[run.level].name;
            table.row([format!("{name}, {}", run.settings_text()), format!("failed: {why}")]);
        }
    }
    let there = !table.rows.is_empty();
    let remark = study.missing_models().map(Block::Text);
    let blocks = remark.into_iter().chain(there.then_some(Block::Table(table)));
    Section::of("Not run", blocks.collect())
}
