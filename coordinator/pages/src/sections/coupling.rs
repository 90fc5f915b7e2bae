//! Sections about the coupling: convergence, heat audit, time line and cost.

use crate::axis::label;
use crate::lanes::{Lane, Lanes};
use crate::page::{Block, Section};
use crate::plot::Figure;
use crate::source::{Columns, Results};
use crate::table::Table;
use run::format::{Scale, number, words};
use std::ops::Range;

/// Convergence of the coupling, and audit of the exchanged heat.
pub(super) fn convergence_and_energy(results: &Results) -> Option<Section> {
    let figures = convergence(results).into_iter().map(Block::Figure);
    let blocks = figures.chain(energy(results)).collect();
    Section::of("Convergence and energy", blocks)
}

/// Residuals over all iterations, and iterations per window; empty for an explicit scheme.
fn convergence(results: &Results) -> Vec<Figure> {
    match residuals(results) {
        Some(residuals) => [residuals].into_iter().chain(iterations(results)).collect(),
        None => Vec::new(),
    }
}

fn residuals(results: &Results) -> Option<Figure> {
    let table = &results.iterations;
    let fields: Vec<&str> = table.names().filter(|name| name.starts_with("residual_")).collect();
    if fields.is_empty() || table.is_empty() {
        return None;
    }
    let windows = windows(table).len();
    let mut figure = Figure::new("relative residuals", "iteration", "‖r‖ / ‖x̃‖");
    (figure.decades, figure.whole) = (true, true);
    for field in fields {
        let values = table.column(field)?;
        let points = gapped(&values, &table.column("iteration")?);
        let name = field.trim_start_matches("residual_");
        figure = figure.with(words(name), points);
    }
    figure.note = match windows {
        1 => "One line per field of the coupling data.".to_owned(),
        many => format!("One line per field of the coupling data; {many} windows in sequence."),
    };
    figure.has_points().then_some(figure)
}

/// Values over the row number, counted from 1, with a gap before every window.
fn gapped(values: &[f64], iterations: &[f64]) -> Vec<[f64; 2]> {
    let mut points = Vec::with_capacity(values.len());
    for (n, (value, iteration)) in values.iter().zip(iterations).enumerate() {
        if n > 0 && *iteration == 1.0 {
            points.push([n as f64 + 0.5, f64::NAN]);
        }
        points.push([n as f64 + 1.0, *value]);
    }
    points
}

/// Iterations per window, if there are several windows.
fn iterations(results: &Results) -> Option<Figure> {
    let windows = windows(&results.iterations);
    let points: Vec<[f64; 2]> =
        windows.iter().enumerate().map(|(n, rows)| [n as f64, rows.len() as f64]).collect();
    let mut figure = Figure::new("iterations per window", "window", "iterations");
    figure.whole = true;
    (points.len() > 1).then(|| figure.with("iterations", points))
}

/// Heat sent and heat received: totals, and values per window.
fn energy(results: &Results) -> Vec<Block> {
    let Some(audit) = Audit::of(results) else { return Vec::new() };
    let mut blocks = vec![Block::Card("energy audit".to_owned(), audit.table(results))];
    if audit.windows.len() > 1 {
        blocks.push(Block::Figure(audit.figure()));
    }
    blocks
}

/// An accepted window: end and duration \[s\], power sent and received \[W\].
struct Window {
    end: f64,
    seconds: f64,
    sent: f64,
    received: f64,
}

struct Audit {
    windows: Vec<Window>,
}

impl Audit {
    fn of(results: &Results) -> Option<Self> {
        let table = &results.iterations;
        let column = |name: &str| table.column(name);
        let (start, end) = (column("start_s")?, column("end_s")?);
        let (sent, received) = (column("heat_sent_w")?, column("heat_received_w")?);
        // The last iteration of a window is the accepted one. In a failed run, the last window was
        // not accepted.
        let coupling = results.summary.as_ref().map(|summary| &summary.coupling);
        let accepted = coupling.map_or(usize::MAX, |coupling| coupling.windows as usize);
        let last = windows(table).into_iter().take(accepted).filter_map(|rows| rows.last());
        let window = |row: usize| Window {
            end: end[row],
            seconds: end[row] - start[row],
            sent: sent[row],
            received: received[row],
        };
        let known = |w: &Window| w.sent.is_finite() && w.received.is_finite();
        let windows: Vec<Window> = last.map(window).filter(known).collect();
        (!windows.is_empty()).then_some(Self { windows })
    }

    /// Table of energies for a transient run, and of powers for a steady one.
    fn table(&self, results: &Results) -> Table {
        let time: f64 = self.windows.iter().map(|w| w.seconds).sum();
        let weight = |w: &Window| if time > 0.0 { w.seconds } else { 1.0 };
        let sum =
            |of: fn(&Window) -> f64| self.windows.iter().map(|w| weight(w) * of(w)).sum::<f64>();
        let (sent, received) = (sum(|w| w.sent), sum(|w| w.received));
        let si = if time > 0.0 { "J" } else { "W" };
        let scale = Scale::of(si, sent.abs());
        let what = if time > 0.0 { "energy" } else { "power" };
        let mut table = Table::new(["heat across the interface", what], 1);
        table.row(["sent".to_owned(), scale.show(sent, 7)]);
        table.row(["received".to_owned(), scale.show(received, 7)]);
        let difference = match received == sent {
            true => "none".to_owned(),
            false => format!("{}\u{a0}{si}", number(received - sent, 2)),
        };
        table.row(["difference".to_owned(), difference]);
        let coupling = results.summary.as_ref().map(|summary| &summary.coupling);
        if let Some(worst) = coupling.and_then(|coupling| coupling.energy_imbalance) {
            table.row(["largest relative difference of a window".to_owned(), number(worst, 2)]);
        }
        table
    }

    fn figure(&self) -> Figure {
        let largest = self.windows.iter().map(|w| w.sent.abs()).fold(0.0, f64::max);
        let last = self.windows.last().map_or(0.0, |w| w.end);
        let (power, time) = (Scale::of("W", largest), Scale::of("s", last));
        let line = |of: fn(&Window) -> f64| -> Vec<[f64; 2]> {
            let point = |w: &Window| [w.end / time.factor, of(w) / power.factor];
            self.windows.iter().map(point).collect()
        };
        let x_label = label("time", &time.unit);
        let figure = Figure::new("heat sent and received", x_label, label("", &power.unit));
        figure.with("sent", line(|w| w.sent)).with("received", line(|w| w.received))
    }
}

/// Maximum number of pieces per lane; more are merged.
const PIECES: usize = 400;

/// Lanes of the processes, and the composition of the wall-clock time.
pub(super) fn work(results: &Results) -> Option<Section> {
    let mut blocks = Vec::new();
    blocks.extend(lanes(&results.iterations, &results.scheme).map(Block::Lanes));
    blocks.extend(costs(results).map(|table| Block::Card("cost".to_owned(), table)));
    Section::of("Time line and cost", blocks)
}

/// Rows of each window; of a window that was solved again, only the last attempt.
fn windows(table: &Columns) -> Vec<Range<usize>> {
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

/// Lanes of the iterations: in a serial scheme the participants follow each other, in a parallel
/// scheme they work simultaneously; the coupling comes last.
pub(crate) fn lanes(table: &Columns, scheme: &str) -> Option<Lanes> {
    let roles: Vec<&str> = table.ending("_work").collect();
    let spent = |name: &str| table.column(&format!("{name}_s"));
    let times: Vec<Vec<f64>> = roles.iter().filter_map(|role| spent(role)).collect();
    let coupling = spent("coupling")?;
    if table.is_empty() || times.len() != roles.len() {
        return None;
    }
    let serial = !scheme.starts_with("parallel");
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
        false => "simultaneously, followed by the coupling",
    };
    let pieces = match group {
        1 => "one bar per iteration".to_owned(),
        many => format!("one bar per {many} iterations"),
    };
    format!(
        "Durations are measured, with {pieces}; within a bar the participants are drawn {order}."
    )
}

/// Composition of the wall-clock time, resident memory and exchanged bytes.
fn costs(results: &Results) -> Option<Table> {
    let cost = &results.summary.as_ref()?.cost;
    let mut table = Table::new(["part", "time", "share of wall time"], 1);
    for (name, seconds) in cost.times() {
        let part = format!("{:.1}\u{a0}%", 100.0 * seconds / cost.wall_s);
        table.row([words(&name), Scale::of("s", seconds).show(seconds, 4), part]);
    }
    let memory = cost
        .participants
        .iter()
        .filter_map(|one| Some((format!("{}: peak memory", one.role), one.peak_rss_bytes?)));
    for (name, bytes) in memory.chain([("exchanged".to_owned(), cost.bytes_exchanged)]) {
        let bytes = bytes as f64;
        table.row([words(&name), Scale::of("byte", bytes).show(bytes, 4), String::new()]);
    }
    Some(table)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_window_that_is_solved_again_counts_once() {
        let table = Columns::parse("window,iteration\n0,1\n0,2\n0,1\n1,1\n1,2\n1,3\n2,1");
        assert_eq!(windows(&table), [2..3, 3..6, 6..7]);
    }

    #[test]
    fn lanes_follow_the_scheme() {
        let rows = "coupling_s,mech_s,mech_work,thermal_s,thermal_work\n1,2,0,4,0\n1,2,0,4,0";
        let table = Columns::parse(rows);
        let bars = |scheme: &str| -> Vec<Vec<[f64; 2]>> {
            lanes(&table, scheme).unwrap().lanes.into_iter().map(|lane| lane.bars).collect()
        };
        let serial =
            [[[0.0, 2.0], [7.0, 9.0]], [[2.0, 6.0], [9.0, 13.0]], [[6.0, 7.0], [13.0, 14.0]]];
        assert_eq!(bars("serial-implicit"), serial.map(|lane| lane.to_vec()));
        let parallel =
            [[[0.0, 2.0], [5.0, 7.0]], [[0.0, 4.0], [5.0, 9.0]], [[4.0, 5.0], [9.0, 10.0]]];
        assert_eq!(bars("parallel-implicit"), parallel.map(|lane| lane.to_vec()));
    }
}
