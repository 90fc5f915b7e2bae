//! The states as a table, on the terminal and as a page.

use super::study::{State, Study};
use crate::study::output::Shown;
use crate::study::table::{Cell, Column, Table};
use pages::page::{Block, Mood, Page, Section};
use run::error::RunError;
use run::format::{counted, number, of_key};
use std::path::Path;

/// Quantities that have a column; all of them are in the file.
const COLUMNS: usize = 6;

impl Shown for Study {
    fn page(&self, _: &Path) -> Result<Page, RunError> {
        let states: Vec<&State> = self.states.iter().collect();
        let remarks = failures(self).map(Block::Text);
        let blocks = std::iter::once(Block::Table(table(self).page(&states))).chain(remarks);
        let varied = &self.starts;
        Ok(Page {
            name: format!("Steady states of {}", self.case),
            title: self.title.clone().unwrap_or_default(),
            status: counted(self.states.len() as u64, "state"),
            mood: if self.failed.is_empty() { Mood::Good } else { Mood::Open },
            reason: format!(
                "{} from {} to {} in {} runs of `{}`",
                varied.key,
                varied.values.first().map_or("", String::as_str),
                varied.values.last().map_or("", String::as_str),
                varied.values.len(),
                self.file
            ),
            sections: Section::of("States", blocks.collect()).into_iter().collect(),
        })
    }
}

/// The study on the terminal.
pub(super) fn text(study: &Study) -> String {
    let title = study.title.as_ref().map(|title| format!(" · {title}")).unwrap_or_default();
    let states: Vec<&State> = study.states.iter().collect();
    let table = table(study).terminal(&states);
    let failed: String = failures(study).map(|line| format!("  {line}\n")).collect();
    format!("steady states of {}{title}\n{table}{failed}", study.case)
}

fn failures(study: &Study) -> impl Iterator<Item = String> {
    study.failed.iter().map(|(start, why)| format!("from {} = {start}: {why}", study.starts.key))
}

fn table(study: &Study) -> Table<'_, State> {
    let mut columns = vec![
        Column::text("state", |state: &State| {
            match state.stable {
                Some(true) => "stable",
                Some(false) => "unstable",
                None => "unknown",
            }
            .to_owned()
        })
        .naming(),
        Column::quantity("loop gain", |state: &State| {
            Cell::optional(state.loop_gain.as_ref(), |gain| number(gain, 4))
        }),
    ];
    columns.extend(study.quantities.iter().take(COLUMNS).map(|one| {
        Column::quantity(one.name.clone(), move |state: &State| {
            Cell::optional(state.values.get(&one.key), |value| {
                of_key(&one.key, value).show(value, 5)
            })
        })
    }));
    columns.push(Column::text("from", |state: &State| {
        let [first, last] = [state.starts.first(), state.starts.last()];
        let show = |start: Option<&f64>| start.map_or(String::new(), |start| number(*start, 3));
        if first == last { show(first) } else { format!("{} to {}", show(first), show(last)) }
    }));
    Table::new(columns)
}
