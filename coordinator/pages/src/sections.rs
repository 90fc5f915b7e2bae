//! What a report says, section by section.

mod convergence;
mod diagrams;
mod energy;
mod fields;
mod headlines;
mod history;
mod setup;
mod temperature;
mod warnings;
mod work;

use super::page::{Block, Mood, Page, Section};
use super::source::Results;

/// The head of the page, without sections.
pub(super) fn opening(results: &Results) -> Page {
    let said = |pointer: &str| results.word(pointer).to_owned();
    let (status, reason, mood) = match results.summary.is_null() {
        true => (
            "no end".to_owned(),
            "there is no summary: the run was killed or is still running; this is what it has \
             written so far"
                .to_owned(),
            Mood::Open,
        ),
        false if results.failed() => (said("/status"), said("/reason"), Mood::Bad),
        false => (said("/status"), said("/reason"), Mood::Good),
    };
    let case: toml::Table = toml::from_str(&results.case).unwrap_or_default();
    let of = |key: &str| case.get("case").and_then(|c| c.get(key)).and_then(|v| v.as_str());
    let name = match results.word("/case") {
        "" => of("name").unwrap_or("a run"),
        name => name,
    };
    let title = of("title").unwrap_or_default().to_owned();
    Page { name: name.to_owned(), title, status, mood, reason, sections: Vec::new() }
}

/// How the coupling converged, and what became of the heat.
fn coupling(results: &Results) -> Option<Section> {
    let figures = convergence::figures(results).into_iter().map(Block::Figure);
    let blocks = figures.chain(energy::blocks(results)).collect();
    Section::of("Convergence and energy", blocks)
}

/// Every section for which there is something to say.
pub(super) fn all(results: &Results) -> Vec<Section> {
    let sections = [
        warnings::section(results),
        headlines::section(results),
        history::section(results),
        diagrams::section(results),
        fields::maps(results),
        fields::lines(results),
        coupling(results),
        work::section(results),
        setup::plan(results),
        setup::versions(results),
        setup::case(results),
        setup::log(results),
        headlines::everything(results),
    ];
    sections.into_iter().flatten().collect()
}
