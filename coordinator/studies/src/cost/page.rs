//! The study as a page: the work-precision plot, tables, what to pick.

use super::runs::{COLUMNS, of_level, table};
use super::study::{Compared, Pick, Run, Study};
use crate::study::output::Shown;
use contract::figure::Measure;
use pages::page::{Block, Headline, Mood, Page, Section};
use pages::plot::Figure;
use pages::table::Table;
use run::error::RunError;
use run::format::{of_key, seconds};
use std::collections::BTreeMap;
use std::path::Path;

impl Shown for Study {
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
        mood: if made == study.runs.len() { Mood::Good } else { Mood::Open },
        reason: format!(
            "what accuracy costs in time, over the models and resolutions of `{}`",
            study.file
        ),
        sections: sections.into_iter().flatten().collect(),
    }
}

fn picks(study: &Study) -> Option<Section> {
    let first = study.quantities.first()?;
    let headline = |pick: &Pick| {
        let name = format!("{} to {}", first.name, first.show_error(pick.target));
        match pick.run.map(|index| &study.runs[index]) {
            None => Headline {
                name,
                value: "none of these".to_owned(),
                more: "refine further".to_owned(),
            },
            Some(run) => Headline {
                name,
                value: seconds(run.cost.solve_s),
                more: format!(
                    "{}, {}; errs by {}",
                    study.levels[run.level].name,
                    run.settings_text(),
                    first.show_error(run.errors[&first.key])
                ),
            },
        }
    };
    let all = study.picks.iter().map(headline).collect();
    Section::of("What to run", vec![Block::Headlines(all)])
}

/// Error over time, for every quantity that has a reference.
fn plots(study: &Study) -> Option<Section> {
    let shown = study.quantities.iter().take(COLUMNS);
    let figures = shown.filter_map(|one| work_precision(study, one)).map(Block::Figure);
    Section::of("Work and precision", figures.collect())
}

/// Error of a quantity over time, one line a choice of models; `None` if there is nothing to
/// compare.
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
        Some(off) => format!(", itself known to {}", one.show_error(off)),
        None => ", of unknown error".to_owned(),
    };
    figure.note = format!("Against {}{known}.", reference.source);
    figure.has_points().then_some(figure)
}

/// The line of a run: its models, and the values that are words, which no line can lead along.
fn line(models: &str, run: &Run) -> String {
    let is_word = |value: &&str| value.starts_with(|first: char| first.is_ascii_alphabetic());
    let values = run.settings.iter().map(|(_, value)| value.trim_matches('"')).filter(is_word);
    std::iter::once(models).chain(values).collect::<Vec<_>>().join(", ")
}

fn references(study: &Study) -> Option<Section> {
    let mut table = Table::new(["quantity", "from", "reference", "known to"], 2);
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
        remarks
            .extend(level.stops_paying.iter().map(|why| format!("Refining does not pay {why}.")));
        if !remarks.is_empty() {
            blocks.push(Block::Text(format!("{}: {}", level.name, remarks.join(" "))));
        }
    }
    Section::of("Runs", blocks)
}

/// The runs of a level, and the orders that they show.
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

/// What was not run, and why.
fn notes(study: &Study) -> Option<Section> {
    let mut table = Table::new(["not run", "why"], 2);
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
    Section::of("Not run", there.then_some(Block::Table(table)).into_iter().collect())
}
