//! The audit of the heat that crosses.

use super::work::windows;
use crate::page::Block;
use crate::places::label;
use crate::plot::Figure;
use crate::source::Results;
use crate::table::Table;
use run::format::{Scale, number};

/// Heat sent against heat received: in sums, and window by window.
pub(super) fn blocks(results: &Results) -> Vec<Block> {
    let Some(audit) = Audit::of(results) else { return Vec::new() };
    let mut blocks = vec![Block::Card("energy audit".to_owned(), audit.table(results))];
    if audit.windows.len() > 1 {
        blocks.push(Block::Figure(audit.figure()));
    }
    blocks
}

/// One accepted window: its duration \[s\], and the power sent and received \[W\].
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
        // The last iteration of a window is what was accepted; in a run that failed the last window
        // was not.
        let accepted = results.quantity("/coupling/windows").map_or(usize::MAX, |n| n as usize);
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

    /// Energies of a transient run, powers of a steady one.
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
        if let Some(worst) = results.quantity("/coupling/energy_imbalance") {
            table.row(["largest, relative, of a window".to_owned(), number(worst, 2)]);
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
