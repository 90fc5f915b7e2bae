//! Table `[coupling]`: scheme, iterations and tolerances.

use super::acceleration;
use super::source::Source;
use super::tables::{Tables, number, text};
use crate::notes::NoteKind;
use crate::scheme::{ConvergenceMeasure, CouplingScheme, Exchange, Limit, SchemeKind};
use std::collections::BTreeMap;

/// Writes the table, and those of single fields.
pub(super) fn write(source: &mut Source<'_>, tables: &mut Tables) {
    let scheme = source.leading;
    tables.open("coupling");
    // A multi scheme is a parallel one of any number of participants.
    let word = match scheme.kind {
        SchemeKind::Multi => SchemeKind::ParallelImplicit.word(),
        kind => kind.word(),
    };
    tables.key("scheme", text(word));
    others(source);
    interpolation(source, tables);
    if !scheme.kind.is_implicit() {
        return;
    }
    acceleration::write(source, tables);
    iterations(source, tables);
    let tolerances = Tolerances::read(source);
    tolerances.write(tables);
}

/// Notes further schemes, and options of the scheme without a counterpart.
fn others(source: &mut Source<'_>) {
    let leading = source.leading;
    for other in source.configuration.schemes.iter().filter(|other| *other != leading) {
        let element = format!("coupling-scheme:{}", other.kind.word());
        if other.kind != leading.kind {
            let mut reason = format!("a case has one scheme, here {}", leading.kind.word());
            if leading.kind.is_implicit() && !other.kind.is_implicit() {
                reason += ": these participants repeat windows, too, and need checkpoints";
            }
            source.notes.add(NoteKind::Missing, other.line, &element, reason);
        }
        if other.acceleration != leading.acceleration && other.acceleration.is_some() {
            let reason = "a case has one acceleration, that of the first implicit scheme";
            source.notes.add(NoteKind::Missing, other.line, &element, reason);
        }
    }
    if leading.controller.is_some() {
        let reason = "the coordinator controls the iteration";
        let element = "participant, control";
        source.notes.add(NoteKind::Unneeded, leading.line, element, reason);
    }
    let unsent: Vec<&Exchange> =
        source.exchanges().filter(|exchange| source.field(exchange).is_none()).collect();
    for exchange in unsent {
        let Exchange { data, from, line, .. } = exchange;
        let reason = format!("{from} does not write `{data}`, so that nothing is sent");
        source.notes.add(NoteKind::Missing, *line, "exchange", reason);
    }
    for exchange in source.exchanges().filter(|exchange| exchange.substeps == Some(true)) {
        let reason = "the values at both ends of a window are exchanged, those within are not";
        let element = "exchange, substeps";
        source.notes.add(NoteKind::Missing, exchange.line, element, reason);
    }
}

/// Writes the interpolation in time.
fn interpolation(source: &mut Source<'_>, tables: &mut Tables) {
    let configuration = source.configuration;
    let exchanged: Vec<_> = configuration
        .data
        .iter()
        .filter(|data| source.exchanges().any(|exchange| exchange.data == data.name))
        .collect();
    let linear = exchanged.iter().any(|data| data.waveform_degree > 0);
    for data in &exchanged {
        let reason = match data.waveform_degree {
            2.. => "interpolated linearly within a window",
            ..=0 if linear => "interpolated linearly within a window, as the other data",
            _ => continue,
        };
        source.notes.add(NoteKind::Changed, data.line, "data, waveform-degree", reason);
    }
    // In an explicit parallel scheme both participants know the start of the window only.
    if !linear || source.leading.kind == SchemeKind::ParallelExplicit {
        return;
    }
    tables.explained("interpolation", text("linear"), "of values within a window");
    for data in exchanged.iter().filter(|data| configuration.is_conservative(&data.name)) {
        let reason = "conservative fields are constant within a window";
        source.notes.add(NoteKind::Changed, data.line, "data", reason);
    }
}

fn iterations(source: &mut Source<'_>, tables: &mut Tables) {
    const MOST: u64 = 1_000_000;
    let scheme = source.leading;
    let counts =
        [("min-iterations", scheme.min_iterations), ("max-iterations", scheme.max_iterations)];
    for (element, count) in counts {
        if let Some(count) = count.filter(|count| count.value > MOST) {
            source.notes.add(NoteKind::Changed, count.line, element, format!("at most {MOST}"));
        }
    }
    let most = scheme.max_iterations.map(|most| most.value.min(MOST));
    if let Some(least) = scheme.min_iterations {
        tables.key("min_iterations", least.value.min(MOST).to_string());
    }
    match most {
        Some(most) => tables.key("max_iterations", most.to_string()),
        None => {
            let reason = "without a limit; windows have at most 100 iterations";
            let instead = Some("raise coupling.max_iterations");
            let element = format!("coupling-scheme:{}", scheme.kind.word());
            source.notes.advise(NoteKind::Changed, scheme.line, element, reason, instead);
        }
    }
    if !scheme.measures.iter().any(|measure| measure.strict) {
        tables.explained("strict", "false", "a window that does not converge is accepted");
    }
}

/// Tolerances of one field.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Tolerance {
    absolute: Option<f64>,
    relative: Option<f64>,
    residual_relative: Option<f64>,
}

impl Tolerance {
    fn keys(&self) -> impl Iterator<Item = (&'static str, f64)> {
        let keys = [
            ("absolute", self.absolute),
            ("relative", self.relative),
            ("residual_relative", self.residual_relative),
        ];
        keys.into_iter().filter_map(|(key, value)| Some((key, value?)))
    }
}

/// Tolerances of all fields.
struct Tolerances {
    /// Limit of the fields without their own.
    relative: Option<f64>,
    /// Fields that are iterated; others are only tested.
    coupled: Vec<String>,
    fields: BTreeMap<String, Tolerance>,
}

impl Tolerances {
    fn read(source: &mut Source<'_>) -> Self {
        let mut fields: BTreeMap<String, Tolerance> = BTreeMap::new();
        let coupled = coupled(source);
        for scheme in source.configuration.schemes.iter().filter(|one| one.kind.is_implicit()) {
            for measure in &scheme.measures {
                match measured(source, scheme, measure) {
                    Some(field) => add(source, measure, fields.entry(field).or_default()),
                    None => {
                        let reason =
                            format!("nobody writes `{}`; the measure is left out", measure.of.data);
                        let element = "convergence-measure";
                        source.notes.add(NoteKind::Missing, measure.of.line, element, reason);
                    }
                }
            }
        }
        let limit = |of: &dyn Fn(&String) -> bool| {
            let limits = fields.iter().filter(|(field, _)| of(field));
            limits.filter_map(|(_, tolerance)| tolerance.relative).reduce(f64::max)
        };
        let relative = limit(&|field| coupled.contains(field)).or_else(|| limit(&|_| true));
        for field in coupled.iter().filter(|field| !fields.contains_key(*field)) {
            let limit = relative.unwrap_or(1e-6);
            let reason =
                format!("no measure of `{field}`; the relative limit is {}", number(limit));
            let element = format!("coupling-scheme:{}", source.leading.kind.word());
            source.notes.add(NoteKind::Changed, source.leading.line, element, reason);
        }
        Self { relative, coupled, fields }
    }

    fn write(&self, tables: &mut Tables) {
        if let Some(relative) = self.relative {
            tables.key("relative", number(relative));
        }
        let general = Tolerance { relative: self.relative, ..Tolerance::default() };
        let own =
            |field: &String, one: &Tolerance| *one != general || !self.coupled.contains(field);
        for (field, tolerance) in self.fields.iter().filter(|(field, one)| own(field, one)) {
            tables.open(&format!("coupling.fields.{field}"));
            tolerance.keys().for_each(|(key, value)| tables.key(key, number(value)));
        }
    }
}

/// Returns the fields that are iterated: all of a parallel scheme, and those from a later to an
/// earlier participant of a serial one.
fn coupled(source: &Source<'_>) -> Vec<String> {
    let mut fields = Vec::new();
    for exchange in source.exchanges() {
        let back = source.place(&exchange.from) > source.place(&exchange.to);
        let Some(field) = source.field(exchange) else { continue };
        let new = !fields.iter().any(|known| known == field);
        if new && (back || !source.leading.kind.is_serial()) {
            fields.push(field.to_owned());
        }
    }
    fields
}

/// Returns the field of a convergence measure.
fn measured(
    source: &Source<'_>,
    scheme: &CouplingScheme,
    measure: &ConvergenceMeasure,
) -> Option<String> {
    let mut exchanges = scheme.exchanges.iter();
    let of = exchanges.find(|one| one.data == measure.of.data && one.mesh == measure.of.mesh)?;
    source.field(of).map(str::to_owned)
}

/// Adds the limit of a measure to the tolerance of its field. Of two limits the smaller one holds.
fn add(source: &mut Source<'_>, measure: &ConvergenceMeasure, tolerance: &mut Tolerance) {
    let line = measure.of.line;
    let notes = &mut source.notes;
    let smaller = |known: &mut Option<f64>, limit: f64| {
        *known = Some(known.map_or(limit, |known| known.min(limit)));
    };
    let limit = match measure.limit {
        Limit::Absolute(limit)
        | Limit::Relative(limit)
        | Limit::ResidualRelative(limit)
        | Limit::AbsoluteOrRelative { relative: limit, .. } => limit,
    };
    if limit <= 0.0 {
        let reason = "a limit of a case is above 0; this one is left out";
        return notes.add(NoteKind::Missing, line, "convergence-measure", reason);
    }
    match measure.limit {
        Limit::Absolute(_) => smaller(&mut tolerance.absolute, limit),
        Limit::Relative(_) => smaller(&mut tolerance.relative, limit),
        Limit::ResidualRelative(_) => smaller(&mut tolerance.residual_relative, limit),
        Limit::AbsoluteOrRelative { absolute, .. } => {
            smaller(&mut tolerance.relative, limit);
            let reason = format!("the relative limit has to hold, also below {}", number(absolute));
            let element = "absolute-or-relative-convergence-measure";
            notes.add(NoteKind::Changed, line, element, reason);
        }
    }
    if measure.suffices {
        let reason = "every measure has to hold";
        notes.add(NoteKind::Missing, line, "convergence-measure, suffices", reason);
    }
}
