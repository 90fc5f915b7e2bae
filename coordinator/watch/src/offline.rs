//! The page as one file, with the drawings of as many steps as fit.

use crate::index::Step;
use crate::server::{CONTROLS, SCRIPT, STYLE};
use crate::steps::Move;
use crate::view::{Against, Request};
use crate::watched::{State, Watched};
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use flate2::Compression;
use flate2::write::DeflateEncoder;
use pages::page::{Addition, Section};
use run::error::RunError;
use run::format::counted;
use run::results::write::replace;
use serde::Serialize;
use std::collections::BTreeMap;
use std::io::Write as _;
use std::path::Path;

/// Approximate limit of the drawings in a file \[byte\].
const MOST_BYTES: usize = 48 << 20;
/// Content of the file for the script of the page.
#[derive(Serialize)]
struct Stored {
    state: State,
    /// Numbers of the steps in the file.
    steps: Vec<usize>,
    /// Window of each of them.
    windows: Vec<u64>,
    /// Views, by series and position in the list of steps, then by comparison: compressed JSON.
    views: BTreeMap<String, BTreeMap<&'static str, String>>,
}

/// Writes the page, and returns a line about it.
///
/// # Errors
/// The recording is damaged, the file exists, or it cannot be written.
pub(crate) fn write(mut watched: Watched, file: &Path, replaces: bool) -> Result<String, RunError> {
    if file.exists() && !replaces {
        let shown = file.display();
        return Err(RunError::Usage(format!("{shown} exists; replace it with --replace")));
    }
    watched.read_all();
    let state = watched.state();
    let fields: Vec<usize> = state.fields.iter().map(|(number, _)| *number).collect();
    let all = watched.steps().to_vec();
    // The last step tells how many bytes one needs.
    let mut needed = 1;
    for series in &fields {
        let request = Request { series: *series, go: Move::Last, ..Request::default() };
        needed += compressed(&watched.view(request)?).len();
    }
    let steps = chosen(&all, MOST_BYTES / needed);
    let mut comparisons = vec![Against::Nothing, Against::Iteration, Against::Window];
    comparisons.extend(state.other.then_some(Against::Other));
    let mut views: BTreeMap<String, BTreeMap<&'static str, String>> = BTreeMap::new();
    let mut bytes = 0;
    // First every step without a comparison, then the comparisons as far as there is room.
    for against in comparisons {
        for (position, step) in steps.iter().enumerate() {
            if bytes > MOST_BYTES && against != Against::Nothing {
                break;
            }
            for series in &fields {
                let request = Request { series: *series, step: *step, go: Move::Stay, against };
                let view = compressed(&watched.view(request)?);
                bytes += view.len();
                let of_place = views.entry(format!("{series}/{position}")).or_default();
                of_place.insert(against.word(), view);
            }
        }
    }
    let windows = steps.iter().map(|step| all[*step].window).collect();
    let note = match steps.len() == all.len() {
        true => counted(steps.len() as u64, "step"),
        false => format!("{} of {}", steps.len(), counted(all.len() as u64, "step")),
    };
    let stored = Stored { state, steps, windows, views };
    let json = serde_json::to_string(&stored).expect("views are plain data");
    // The text of an element ends at its end tag; JSON may write the sign otherwise.
    let json = json.replace('<', "\\u003c");
    let sections: String = watched.page().sections.iter().map(Section::html).collect();
    let body = format!(
        "{CONTROLS}<script type=\"application/json\" id=\"stored\">{json}</script>\n\
         <div id=\"report\">{sections}</div>\n"
    );
    let addition = Addition { body: &body, style: STYLE, script: SCRIPT, requests: false };
    let mut page = watched.page().clone();
    page.sections.clear();
    let text = page.with(&addition);
    replace(file, text.as_bytes())?;
    Ok(format!("{}: {note}, {:.1} MB", file.display(), 1e-6 * text.len() as f64))
}

/// Returns the steps of a file: all of them or, if there are too many, the last iterations of
/// windows at equal distances.
fn chosen(all: &[Step], room: usize) -> Vec<usize> {
    if all.len() <= room {
        return (0..all.len()).collect();
    }
    let is_last = |at: &usize| all.get(at + 1).is_none_or(|next| next.window != all[*at].window);
    let ends: Vec<usize> = (0..all.len()).filter(is_last).collect();
    let count = room.clamp(1, ends.len());
    let place = |n: usize| ends[(n * (ends.len() - 1)).div_ceil((count - 1).max(1))];
    let mut steps: Vec<usize> = (0..count).map(place).collect();
    steps.dedup();
    steps
}

fn compressed(of: &impl Serialize) -> String {
    let json = serde_json::to_vec(of).expect("a view is plain data");
    let mut encoder = DeflateEncoder::new(Vec::new(), Compression::default());
    let written = encoder.write_all(&json).and_then(|()| encoder.finish());
    STANDARD.encode(written.expect("memory can be written"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn many_steps_are_thinned_to_the_ends_of_windows() {
        let step = |window: u64| Step {
            window,
            iteration: 1,
            interval: [0.0; 2],
            residual: None,
            nanoseconds: 0,
        };
        let all: Vec<Step> = (0..300).map(|n| step(n / 3)).collect();
        assert_eq!(chosen(&all, 300).len(), 300);
        let few = chosen(&all, 11);
        assert_eq!((few.len(), few[0], few[10]), (11, 2, 299));
        assert!(few.iter().all(|step| step % 3 == 2), "{few:?}");
        assert_eq!(chosen(&all, 1), [2]);
        assert!(chosen(&[], 5).is_empty());
    }
}
