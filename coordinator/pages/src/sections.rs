//! Sections of the report about a run.

mod coupling;
mod fields;
mod results;
mod setup;

pub(crate) use coupling::lanes;

use super::page::{Page, RunStatus, Section};
use super::source::Results;

/// The page with its head, without sections.
pub(super) fn opening(results: &Results) -> Page {
    let (status, reason, mood) = match &results.summary {
        None => (
            "no end".to_owned(),
            "there is no summary: the run was killed or is still running; this page shows what has \
             been written so far"
                .to_owned(),
            RunStatus::Open,
        ),
        Some(summary) => {
            let mood = if results.failed() { RunStatus::Bad } else { RunStatus::Good };
            (summary.status.word().to_owned(), summary.reason.clone(), mood)
        }
    };
    let case: toml::Table = toml::from_str(&results.case).unwrap_or_default();
    let of = |key: &str| case.get("case").and_then(|c| c.get(key)).and_then(|v| v.as_str());
    let name = match results.name() {
        "" => of("name").unwrap_or("a run"),
        name => name,
    };
    let title = of("title").unwrap_or_default().to_owned();
    Page { name: name.to_owned(), title, status, mood, reason, sections: Vec::new() }
}

/// All sections with contents.
pub(super) fn all(results: &Results) -> Vec<Section> {
    let sections = [
        setup::warnings(results),
        results::headlines(results),
        results::over_time(results),
        results::diagrams(results),
        fields::maps(results),
        fields::lines(results),
        coupling::convergence_and_energy(results),
        coupling::work(results),
        setup::plan(results),
        setup::versions(results),
        setup::case(results),
        setup::log(results),
        results::everything(results),
    ];
    sections.into_iter().flatten().collect()
}
