//! Table `[mapping]`: methods by field.

use super::source::Source;
use super::tables::{Tables, number, text};
use crate::notes::{NoteKind, Notes};
use crate::participant::{BasisFunction, Constraint, Mapping, MappingKind};

/// A method of a case for one field.
struct Choice {
    field: String,
    method: Method,
}

/// A method of a case, with the keys that belong to it.
#[derive(Clone, Copy, PartialEq)]
struct Method {
    word: &'static str,
    basis: Option<Basis>,
}

/// A radial basis function of a case.
#[derive(Clone, Copy, PartialEq)]
struct Basis {
    word: &'static str,
    radius: Option<f64>,
}

impl Method {
    fn write(self, tables: &mut Tables) {
        tables.key("method", text(self.word));
        let Some(basis) = self.basis else { return };
        tables.key("basis", text(basis.word));
        basis.radius.iter().for_each(|radius| tables.key("radius", number(*radius)));
    }
}

/// Writes the table.
pub(super) fn write(source: &mut Source<'_>, tables: &mut Tables) {
    let mut choices: Vec<Choice> = Vec::new();
    let mut used: Vec<&Mapping> = Vec::new();
    for data in &source.configuration.data {
        for mapping in source.configuration.mappings_of(&data.name) {
            if choose(source, &data.name, mapping, &mut choices) {
                used.push(mapping);
            }
        }
    }
    let participants = &source.configuration.participants;
    for mapping in participants.iter().flat_map(|participant| &participant.mappings) {
        note(mapping, &mut source.notes);
        let is_used = used.iter().any(|one| std::ptr::eq(*one, mapping));
        if !is_used && word(mapping.kind).is_some() {
            let element = format!("mapping:{}", mapping.kind.word());
            let reason = "moves no data that are exchanged, and is left out";
            source.notes.add(NoteKind::Missing, mapping.line, element, reason);
        }
    }
    let Some(first) = choices.first() else { return };
    if choices.iter().all(|choice| choice.method == first.method) {
        tables.open("mapping");
        return first.method.write(tables);
    }
    for choice in &choices {
        tables.open(&format!("mapping.fields.{}", choice.field));
        choice.method.write(tables);
    }
}

/// Adds the method of a mapping for the fields that it moves; returns whether there are any.
fn choose(
    source: &mut Source<'_>,
    data: &str,
    mapping: &Mapping,
    choices: &mut Vec<Choice>,
) -> bool {
    let Some(word) = word(mapping.kind) else { return false };
    let method = Method { word, basis: basis(mapping) };
    let exchanged = source.exchanges().filter(|exchange| exchange.data == data);
    let on = |mesh: &str| [&mapping.from, &mapping.to].into_iter().flatten().any(|m| m == mesh);
    let moved = exchanged.filter(|exchange| on(&exchange.mesh));
    let fields: Vec<String> =
        moved.filter_map(|exchange| source.field(exchange).map(str::to_owned)).collect();
    let moves = !fields.is_empty();
    for field in fields {
        match choices.iter().find(|choice| choice.field == field) {
            None => choices.push(Choice { field, method }),
            Some(choice) if choice.method == method => {}
            Some(choice) => {
                let basis = choice.method.basis.map(|basis| format!(" with {}", basis.word));
                let reason = format!(
                    "`{data}` is mapped by {}{} already, and a field has one method",
                    choice.method.word,
                    basis.unwrap_or_default()
                );
                let element = format!("mapping:{}", mapping.kind.word());
                source.notes.add(NoteKind::Missing, mapping.line, element, reason);
            }
        }
    }
    moves
}

/// Returns the radial basis function of a mapping, as a case has it.
fn basis(mapping: &Mapping) -> Option<Basis> {
    let function = mapping.basis.as_ref().filter(|_| mapping.kind.is_radial())?;
    let BasisFunction { name, support_radius, shape_parameter, .. } = function;
    let within = |word| support_radius.map(|radius| Basis { word, radius: Some(radius) });
    let of = |word| shape_parameter.map(|radius| Basis { word, radius: Some(radius) });
    let plain = |word| Some(Basis { word, radius: None });
    match name.as_str() {
        "compact-polynomial-c0" => within("wendland-c0"),
        "compact-polynomial-c2" => within("wendland-c2"),
        "compact-polynomial-c4" => within("wendland-c4"),
        "compact-polynomial-c6" => within("wendland-c6"),
        "compact-polynomial-c8" => within("wendland-c8"),
        "compact-tps-c2" => within("compact-thin-plate-splines-c2"),
        "gaussian" => within("gaussian").or_else(|| {
            let radius =
                shape_parameter.map(|shape| (9.0 * std::f64::consts::LN_10).sqrt() / shape);
            radius.map(|radius| Basis { word: "gaussian", radius: Some(radius) })
        }),
        "multiquadrics" => of("multiquadrics"),
        "inverse-multiquadrics" => of("inverse-multiquadrics"),
        "thin-plate-splines" => plain("thin-plate-splines"),
        "volume-splines" => plain("volume-splines"),
        _ => None,
    }
}

/// Returns the word of the method of a case.
fn word(kind: MappingKind) -> Option<&'static str> {
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
        note_radial(mapping, &element, notes);
    }
    match kind {
        MappingKind::NearestNeighborGradient | MappingKind::LinearCellInterpolation => {
            let reason = "replaced by nearest-projection";
            notes.add(NoteKind::Changed, line, &element, reason);
        }
        _ if word(kind).is_none() => {
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

/// Notes differences of a mapping by radial basis functions.
fn note_radial(mapping: &Mapping, element: &str, notes: &mut Notes) {
    let (kind, line) = (mapping.kind, mapping.line);
    if basis(mapping).is_none() {
        let function = mapping.basis.as_ref();
        let function = function.map_or("basis functions", |basis| basis.name.as_str());
        let reason = format!("a local stencil without a support radius, in place of {function}");
        notes.add(NoteKind::Changed, line, element, reason);
    } else {
        let polynomial = mapping.options.iter().find(|(option, _)| option == "polynomial");
        let reason = match polynomial.map(|(_, value)| value.as_str()) {
            Some("on") => None,
            Some("off") => Some("a linear polynomial all the same"),
            _ => Some("a linear polynomial, solved together with the functions"),
        };
        let element_of_reason = format!("{element}, polynomial");
        reason.iter().for_each(|r| notes.add(NoteKind::Changed, line, &element_of_reason, r));
    }
    let shapes = mapping.basis.as_ref().filter(|basis| basis.name == "gaussian");
    if shapes.is_some_and(|one| one.support_radius.is_some() && one.shape_parameter.is_some()) {
        let reason = "the support radius alone: there the function has fallen to 1e-9";
        notes.add(NoteKind::Changed, line, format!("{element}, shape-parameter"), reason);
    }
    if matches!(kind, MappingKind::RbfGlobalDirect | MappingKind::RbfGlobalIterative) {
        let reason = "more than 2000 points are interpolated in overlapping clusters";
        notes.add(NoteKind::Changed, line, element, reason);
    }
    for (option, value) in mapping.options.iter().filter(|(option, _)| option != "polynomial") {
        let reason = format!("no counterpart of \"{value}\"");
        notes.add(NoteKind::Changed, line, format!("{element}, {option}"), reason);
    }
}
