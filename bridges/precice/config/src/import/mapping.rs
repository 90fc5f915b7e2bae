//! Table `[mapping]`: methods by field.

use super::source::Source;
use super::tables::{Tables, text};
use crate::notes::{NoteKind, Notes};
use crate::participant::{Constraint, Mapping, MappingKind};

/// A method of a case for one field.
struct Choice {
    field: String,
    method: &'static str,
}

/// Writes the table.
pub(super) fn write(source: &mut Source<'_>, tables: &mut Tables) {
    let mut choices: Vec<Choice> = Vec::new();
    for data in &source.configuration.data {
        for mapping in source.configuration.mappings_of(&data.name) {
            choose(source, &data.name, mapping, &mut choices);
        }
    }
    let participants = &source.configuration.participants;
    for mapping in participants.iter().flat_map(|participant| &participant.mappings) {
        note(mapping, &mut source.notes);
    }
    let Some(first) = choices.first() else { return };
    if choices.iter().all(|choice| choice.method == first.method) {
        tables.open("mapping");
        return tables.key("method", text(first.method));
    }
    for choice in &choices {
        tables.open(&format!("mapping.fields.{}", choice.field));
        tables.key("method", text(choice.method));
    }
}

/// Adds the method of a mapping for the fields that it moves.
fn choose(source: &mut Source<'_>, data: &str, mapping: &Mapping, choices: &mut Vec<Choice>) {
    let Some(method) = method(mapping.kind) else { return };
    let exchanged = source.exchanges().filter(|exchange| exchange.data == data);
    let on = |mesh: &str| [&mapping.from, &mapping.to].into_iter().flatten().any(|m| m == mesh);
    let moved = exchanged.filter(|exchange| on(&exchange.mesh));
    let fields: Vec<String> =
        moved.filter_map(|exchange| source.field(exchange).map(str::to_owned)).collect();
    for field in fields {
        match choices.iter().find(|choice| choice.field == field) {
            None => choices.push(Choice { field, method }),
            Some(choice) if choice.method == method => {}
            Some(choice) => {
                let reason = format!(
                    "`{data}` is mapped by {} already, and a field has one method",
                    choice.method
                );
                let element = format!("mapping:{}", mapping.kind.word());
                source.notes.add(NoteKind::Missing, mapping.line, element, reason);
            }
        }
    }
}

/// Returns the method of a case.
fn method(kind: MappingKind) -> Option<&'static str> {
    use MappingKind as Kind;
    match kind {
        Kind::NearestNeighbor => Some("nearest-neighbour"),
        Kind::NearestProjection | Kind::NearestNeighborGradient | Kind::LinearCellInterpolation => {
            Some("nearest-projection")
        }
        Kind::Rbf | Kind::RbfGlobalDirect | Kind::RbfGlobalIterative | Kind::RbfPumDirect => {
            Some("radial-basis")
        }
        Kind::CoarseGraining | Kind::AxialGeometricMultiscale | Kind::RadialGeometricMultiscale => {
            None
        }
    }
}

/// Notes differences of the method.
fn note(mapping: &Mapping, notes: &mut Notes) {
    let (kind, line) = (mapping.kind, mapping.line);
    let element = format!("mapping:{}", kind.word());
    if kind.is_radial() {
        let basis = mapping.basis.as_ref().map_or("basis functions", |basis| basis.name.as_str());
        let reason = format!("a local stencil without a support radius, in place of {basis}");
        notes.add(NoteKind::Changed, line, &element, reason);
        for (option, value) in &mapping.options {
            let reason = format!("no counterpart of \"{value}\"");
            notes.add(NoteKind::Changed, line, format!("{element}, {option}"), reason);
        }
    }
    match kind {
        MappingKind::NearestNeighborGradient | MappingKind::LinearCellInterpolation => {
            let reason = "replaced by nearest-projection";
            notes.add(NoteKind::Changed, line, &element, reason);
        }
        _ if method(kind).is_none() => {
            let instead = Some("map in the program");
            notes.advise(NoteKind::Missing, line, &element, "no such method", instead);
        }
        _ => {}
    }
    if mapping.from.is_none() || mapping.to.is_none() {
        let reason = "mapping to places that the program names at run time";
        let instead = Some("define a mesh of these places");
        notes.advise(NoteKind::Missing, line, &element, reason, instead);
    }
    if matches!(
        mapping.constraint,
        Constraint::ScaledConsistentSurface | Constraint::ScaledConsistentVolume
    ) {
        let reason = "consistent, without scaling to the integral";
        let element = format!("{element}, {}", mapping.constraint.word());
        notes.add(NoteKind::Changed, line, element, reason);
    }
}
