//! Keys of `[coupling]` for the acceleration.

use super::source::Source;
use super::tables::{Tables, number, text};
use crate::acceleration::{
    Acceleration, AccelerationKind, FilterKind, Preconditioner, PreconditionerKind,
};
use crate::notes::{NoteKind, Notes};
use crate::scheme::Setting;

/// Comment behind a value that the configuration leaves out.
const DEFAULT: &str = "default of preCICE";

/// Defaults of a method in preCICE.
struct Defaults {
    relaxation: f64,
    /// Columns and earlier windows of a quasi-Newton method.
    columns: Option<(u64, u64)>,
}

impl Defaults {
    fn of(kind: AccelerationKind) -> Self {
        match kind {
            AccelerationKind::Constant | AccelerationKind::Aitken => {
                Self { relaxation: 0.5, columns: None }
            }
            AccelerationKind::IqnIls => Self { relaxation: 0.1, columns: Some((100, 10)) },
            AccelerationKind::IqnImvj => Self { relaxation: 0.1, columns: Some((20, 0)) },
        }
    }
}

/// Writes the keys.
pub(super) fn write(source: &mut Source<'_>, tables: &mut Tables) {
    let Some(acceleration) = &source.leading.acceleration else {
        return tables.key("acceleration", text("none"));
    };
    let defaults = Defaults::of(acceleration.kind);
    let word = match acceleration.kind {
        AccelerationKind::Constant => "constant",
        AccelerationKind::Aitken => "aitken",
        AccelerationKind::IqnIls => "iqn-ils",
        AccelerationKind::IqnImvj => "iqn-imvj",
    };
    tables.key("acceleration", text(word));
    relaxation(acceleration, &defaults, tables, &mut source.notes);
    if let Some((columns, windows)) = defaults.columns {
        let (used, reused) = (acceleration.max_used_iterations, acceleration.time_windows_reused);
        let most = Count { key: "max_columns", element: "max-used-iterations", most: 1000 };
        most.write(used, columns, tables, &mut source.notes);
        let most = Count { key: "reuse_windows", element: "time-windows-reused", most: 1_000_000 };
        most.write(reused, windows, tables, &mut source.notes);
        filter(acceleration, tables, &mut source.notes);
        if let Some(preconditioner) = &acceleration.preconditioner {
            weights(preconditioner, tables, &mut source.notes);
        }
    }
    data(source, acceleration);
    options(acceleration, &mut source.notes);
}

fn relaxation(
    acceleration: &Acceleration,
    defaults: &Defaults,
    tables: &mut Tables,
    notes: &mut Notes,
) {
    const MOST: f64 = 2.0;
    match acceleration.relaxation {
        None => tables.explained("relaxation", number(defaults.relaxation), DEFAULT),
        Some(given) => {
            tables.key("relaxation", number(given.value.min(MOST)));
            if given.value > MOST {
                let reason = format!("at most {}", number(MOST));
                notes.add(NoteKind::Changed, given.line, "relaxation", reason);
            }
        }
    }
    if acceleration.enforce_initial {
        let line = acceleration.relaxation.map_or(acceleration.line, |given| given.line);
        let reason = "windows after the first begin with the columns of earlier windows";
        let element = "initial-relaxation, enforce";
        let instead = Some("coupling.reuse_windows = 0 forgets them");
        notes.advise(NoteKind::Missing, line, element, reason, instead);
    }
}

/// A count of the configuration, and the largest value of its key.
struct Count {
    key: &'static str,
    element: &'static str,
    most: u64,
}

impl Count {
    fn write(
        &self,
        given: Option<Setting<u64>>,
        default: u64,
        tables: &mut Tables,
        notes: &mut Notes,
    ) {
        let Some(given) = given else {
            return tables.explained(self.key, default.to_string(), DEFAULT);
        };
        tables.key(self.key, given.value.min(self.most).to_string());
        if given.value > self.most {
            notes.add(
                NoteKind::Changed,
                given.line,
                self.element,
                format!("at most {}", self.most),
            );
        }
    }
}

fn filter(acceleration: &Acceleration, tables: &mut Tables, notes: &mut Notes) {
    const BOUNDS: (f64, f64) = (1e-7, 0.9);
    let Some(filter) = &acceleration.filter else {
        return tables.explained("filter", number(1e-2), DEFAULT);
    };
    let limit = filter.limit.clamp(BOUNDS.0, BOUNDS.1);
    tables.key("filter", number(limit));
    if filter.kind != FilterKind::Qr2 {
        let reason = format!("the filter is QR2, in place of {}", filter.kind.word());
        notes.add(NoteKind::Changed, filter.line, "filter, type", reason);
    }
    if limit != filter.limit {
        let (least, most) = (number(BOUNDS.0), number(BOUNDS.1));
        let reason = format!("{} is outside {least} to {most}", number(filter.limit));
        notes.add(NoteKind::Changed, filter.line, "filter, limit", reason);
    }
}

fn weights(preconditioner: &Preconditioner, tables: &mut Tables, notes: &mut Notes) {
    let line = preconditioner.line;
    match preconditioner.kind {
        PreconditionerKind::Constant => {
            let reason = "weights follow from the residuals";
            notes.add(NoteKind::Changed, line, "preconditioner, constant", reason);
        }
        kind => tables.key("preconditioner", text(kind.word())),
    }
    if preconditioner.freeze_after >= 0 {
        let reason = "weights change during the whole run";
        notes.add(NoteKind::Changed, line, "preconditioner, freeze-after", reason);
    }
    if !preconditioner.update_on_threshold {
        let reason = "no such choice";
        notes.add(NoteKind::Changed, line, "preconditioner, update-on-threshold", reason);
    }
}

/// Notes coupling data that the configuration leaves out of the acceleration.
fn data(source: &mut Source<'_>, acceleration: &Acceleration) {
    if acceleration.data.is_empty() {
        // All coupling data are relaxed.
        return;
    }
    let serial = source.leading.kind.is_serial();
    let listed = |data: &str| acceleration.data.iter().any(|one| one.of.data == data);
    for exchange in &source.leading.exchanges {
        let back = source.place(&exchange.from) > source.place(&exchange.to);
        if (back || !serial) && !listed(&exchange.data) {
            let reason = format!("`{}` enters the acceleration, too", exchange.data);
            let element = "acceleration, data";
            source.notes.add(NoteKind::Changed, acceleration.line, element, reason);
        }
    }
    let constant = acceleration.preconditioner.as_ref();
    if constant.is_some_and(|one| one.kind == PreconditionerKind::Constant) {
        for scaled in acceleration.data.iter().filter(|data| data.scaling != 1.0) {
            let reason = "weights follow from the residuals";
            let element = "acceleration, scaling";
            source.notes.add(NoteKind::Changed, scaled.of.line, element, reason);
        }
    }
}

/// Notes options of the method.
fn options(acceleration: &Acceleration, notes: &mut Notes) {
    let element = format!("acceleration:{}", acceleration.kind.word());
    if let Some(restart) = &acceleration.restart {
        let reason = "the Jacobian has no restart";
        notes.add(NoteKind::Missing, restart.line, "imvj-restart-mode", reason);
    }
    let neutral = [
        ("always-build-jacobian", "false"),
        ("reduced-time-grid", "true"),
        ("on-bound-violation", "ignore"),
    ];
    for (option, value) in &acceleration.options {
        let usual =
            neutral.iter().any(|(name, word)| (name, word) == (&option.as_str(), &value.as_str()));
        if !usual {
            let element = format!("{element}, {option}");
            let reason = format!("no counterpart of \"{value}\"");
            notes.add(NoteKind::Missing, acceleration.line, element, reason);
        }
    }
}
