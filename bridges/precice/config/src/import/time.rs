//! Table `[time]`: windows and the end of the run.

use super::source::Source;
use super::tables::{Tables, number, text};
use crate::notes::NoteKind;
use crate::scheme::{CouplingScheme, Window};

/// Number of windows if the configuration leaves their length to a participant.
const WINDOWS: f64 = 100.0;

/// Writes the table.
pub(super) fn write(source: &mut Source<'_>, tables: &mut Tables) {
    let scheme = source.leading;
    tables.open_apart("time");
    tables.key("mode", text("transient"));
    match scheme.window.value {
        Window::Fixed(window) => fixed(source, window, tables),
        Window::FirstParticipant => of_first_participant(source, tables),
    }
    for other in source.configuration.schemes.iter().filter(|other| *other != scheme) {
        if (other.window.value, end(other)) != (scheme.window.value, end(scheme)) {
            let reason = "another scheme has other windows or another end, and a case has one";
            source.notes.add(NoteKind::Missing, other.window.line, "time-window-size", reason);
        }
    }
}

fn fixed(source: &mut Source<'_>, window: f64, tables: &mut Tables) {
    let scheme = source.leading;
    let end = end(scheme);
    tables.key("window", number(end.map_or(window, |end| end.min(window))));
    let Some(end) = end else { return };
    let windows = scheme.max_time_windows.filter(|_| scheme.max_time.is_none_or(|t| t.value > end));
    match windows {
        Some(windows) => {
            let count = if windows.value == 1 { "window" } else { "windows" };
            tables.explained("end", number(end), &format!("{} {count}", windows.value));
        }
        None => tables.key("end", number(end)),
    }
    if end < window {
        let reason = "the run ends within its first window, which is as long as the run";
        source.notes.add(NoteKind::Changed, scheme.window.line, "max-time", reason);
    }
}

/// Writes windows whose length the first participant chooses in the configuration. An explicit
/// scheme cannot repeat a window, so that its windows are fixed.
fn of_first_participant(source: &mut Source<'_>, tables: &mut Tables) {
    let scheme = source.leading;
    let line = scheme.window.line;
    let is_adaptive = scheme.kind.is_implicit();
    let end = scheme.max_time.map(|end| end.value);
    let element = "time-window-size";
    if is_adaptive {
        let reason = "the coordinator chooses the windows by the error, not the first participant";
        let instead = Some("set time.window, time.window_min and time.window_max");
        source.notes.advise(NoteKind::Changed, line, element, reason, instead);
    } else {
        let reason = "the windows are fixed, and their length is a guess";
        let instead = Some("set time.window to the time step of the first participant");
        source.notes.advise(NoteKind::Todo, line, element, reason, instead);
    }
    let end = end.unwrap_or_else(|| {
        let reason = "a number of windows of unknown length gives no end";
        let instead = Some("set time.end");
        source.notes.advise(NoteKind::Todo, line, "max-time-windows", reason, instead);
        1.0
    });
    if is_adaptive {
        tables.key("control", text("adaptive"));
    }
    tables.explained("window", number(rounded(end / WINDOWS)), "a guess; see the notes");
    tables.key("end", number(end));
}

/// Returns the end of a scheme with fixed windows: the earlier one of two.
fn end(scheme: &CouplingScheme) -> Option<f64> {
    let time = scheme.max_time.map(|end| end.value);
    let windows = match (scheme.max_time_windows, scheme.window.value) {
        #[allow(clippy::cast_precision_loss)] // Counts are far below 2^53.
        (Some(count), Window::Fixed(window)) => Some(rounded(count.value as f64 * window)),
        _ => None,
    };
    match (time, windows) {
        (Some(time), Some(windows)) => Some(time.min(windows)),
        (time, windows) => time.or(windows),
    }
}

/// Returns the value with fifteen digits, so that three windows of 0.1 s end at 0.3 s.
fn rounded(value: f64) -> f64 {
    format!("{value:.14e}").parse().unwrap_or(value)
}
