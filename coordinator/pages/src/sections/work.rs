//! Which process worked when, and where the time went.

use crate::lanes::{Lane, Lanes};
use crate::page::{Block, Section};
use crate::source::{Results, Table};
use crate::table::Table as Figures;
use run::format::{Scale, words};
use std::ops::Range;

/// Most pieces of a lane; more are put together.
const PIECES: usize = 400;

/// The lanes of the windows, and the parts of the wall time.
pub(super) fn section(results: &Results) -> Option<Section> {
    let mut blocks = Vec::new();
    blocks.extend(lanes(results).map(Block::Lanes));
    blocks.extend(costs(results).map(|table| Block::Card("cost".to_owned(), table)));
    Section::of("Time line and cost", blocks)
}

/// The rows of each window: of a window that was solved again the last time counts.
pub(super) fn windows(table: &Table) -> Vec<Range<usize>> {
    let (Some(window), Some(iteration)) = (table.column("window"), table.column("iteration"))
    else {
        return Vec::new();
    };
    let mut found: Vec<Range<usize>> = Vec::new();
    for row in 0..table.len() {
        match found.last_mut() {
            Some(last) if window[last.start] == window[row] && iteration[row] != 1.0 => {
                last.end = row + 1;
            }
            Some(last) if window[last.start] == window[row] => *last = row..row + 1,
            _ => found.push(row..row + 1),
        }
    }
    found
}

/// The iterations as they follow each other: in a serial scheme one participant after the other, in a
/// parallel one all at once, and the coupling after them.
fn lanes(results: &Results) -> Option<Lanes> {
    let table = &results.iterations;
    let roles: Vec<&str> = table.ending("_work").collect();
    let spent = |name: &str| table.column(&format!("{name}_s"));
    let times: Vec<Vec<f64>> = roles.iter().filter_map(|role| spent(role)).collect();
    let coupling = spent("coupling")?;
    if table.is_empty() || times.len() != roles.len() {
        return None;
    }
    let serial = !results.word("/coupling/scheme").starts_with("parallel");
    let group = table.len().div_ceil(PIECES);
    let names = roles.iter().copied().chain(["coupling"]);
    let mut lanes: Vec<Lane> =
        names.map(|name| Lane { name: words(name), bars: Vec::new() }).collect();
    let mut now = 0.0;
    for first in (0..table.len()).step_by(group) {
        let rows = first..(first + group).min(table.len());
        let sum = |of: &Vec<f64>| of[rows.clone()].iter().filter(|s| s.is_finite()).sum::<f64>();
        let mut end = now;
        for (lane, time) in lanes.iter_mut().zip(&times) {
            let from = if serial { end } else { now };
            lane.bars.push([from, from + sum(time)]);
            end = end.max(from + sum(time));
        }
        let whole = end + sum(&coupling);
        lanes.last_mut()?.bars.push([end, whole]);
        now = whole;
    }
    let note = note(serial, group);
    Some(Lanes { title: "work of the processes".to_owned(), lanes, note })
}

fn note(serial: bool, group: usize) -> String {
    let order = match serial {
        true => "one after the other, the coupling last",
        false => "side by side, the coupling after them",
    };
    let pieces = match group {
        1 => "one bar an iteration".to_owned(),
        many => format!("one bar for {many} iterations"),
    };
    format!("Durations are measured, {pieces}; within it they are drawn {order}.")
}

/// The parts of the wall time, the resident memory, the bytes.
fn costs(results: &Results) -> Option<Figures> {
    let section = results.summary.get("cost")?.as_object()?;
    let wall = results.quantity("/cost/wall_s")?;
    let mut table = Figures::new(["part", "time", "of the wall time"], 1);
    for (key, value) in section {
        let (Some(name), Some(seconds)) = (key.strip_suffix("_s"), value.as_f64()) else {
            continue;
        };
        let part = format!("{:.1}\u{a0}%", 100.0 * seconds / wall);
        table.row([words(name), Scale::of("s", seconds).show(seconds, 4), part]);
    }
    for (key, value) in section {
        let name = key.strip_suffix("_peak_rss_bytes").map(|role| format!("{role}: most memory"));
        let name = name.or_else(|| (key == "bytes_exchanged").then(|| "exchanged".to_owned()));
        if let (Some(name), Some(bytes)) = (name, value.as_f64()) {
            table.row([words(&name), Scale::of("byte", bytes).show(bytes, 4), String::new()]);
        }
    }
    Some(table)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_window_that_is_solved_again_counts_once() {
        let table = Table::parse("window,iteration\n0,1\n0,2\n0,1\n1,1\n1,2\n1,3\n2,1");
        assert_eq!(windows(&table), [2..3, 3..6, 6..7]);
    }

    fn results(scheme: &str) -> Results {
        let rows = "coupling_s,mech_s,mech_work,thermal_s,thermal_work\n1,2,0,4,0\n1,2,0,4,0";
        Results {
            iterations: Table::parse(rows),
            summary: serde_json::json!({"coupling": {"scheme": scheme}}),
            ..Results::default()
        }
    }

    #[test]
    fn lanes_follow_the_scheme() {
        let bars = |scheme: &str| -> Vec<Vec<[f64; 2]>> {
            lanes(&results(scheme)).unwrap().lanes.into_iter().map(|lane| lane.bars).collect()
        };
        let serial =
            [[[0.0, 2.0], [7.0, 9.0]], [[2.0, 6.0], [9.0, 13.0]], [[6.0, 7.0], [13.0, 14.0]]];
        assert_eq!(bars("serial-implicit"), serial.map(|lane| lane.to_vec()));
        let parallel =
            [[[0.0, 2.0], [5.0, 7.0]], [[0.0, 4.0], [5.0, 9.0]], [[4.0, 5.0], [9.0, 10.0]]];
        assert_eq!(bars("parallel-implicit"), parallel.map(|lane| lane.to_vec()));
    }
}
