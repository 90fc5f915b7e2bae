//! Which fields are mapped for which consumer, and how well the grids cover each other.

use super::contents::{Field, Plan, PlannedMapping, sample_bytes};
use crate::warnings::Warning;
use case::Case;
use contract::configuration::Layout;
use contract::field::Mapping;
use contract::grid::Grid;
use coupling::ParticipantIndex;
use coupling::map::{Coverage, GridMapping, Method};
use std::fmt::{Result, Write};

/// The grids of a field's producer and of one of its consumers, if it has to be mapped from the one
/// to the other; `None` if they match, or are not known. Grids of which one may move do not match,
/// as they would not for long.
pub fn non_matching<'a>(
    field: &Field,
    consumer: ParticipantIndex,
    layout: impl Fn(ParticipantIndex) -> Option<&'a Layout>,
) -> Option<[&'a Grid; 2]> {
    let (theirs, own) = (layout(field.producer)?, layout(consumer)?);
    let source = theirs.grid_of(&field.kind.name)?;
    let wanted = own.input_grid(&field.kind.name)?;
    let apart = source.shape != wanted.shape || theirs.moves(source) || own.moves(wanted);
    apart.then_some([source, wanted])
}

/// The mappings of a plan. Each of them is made, to see what it covers.
pub(super) fn planned(plan: &Plan) -> Vec<PlannedMapping> {
    let layout = |index: ParticipantIndex| plan.participants[index].estimate.as_ref();
    let mut mappings = Vec::new();
    for (index, field) in plan.fields.iter().enumerate() {
        for &consumer in &field.consumers {
            let Some([source, wanted]) = non_matching(field, consumer, layout) else { continue };
            let mapping = GridMapping::between(source, wanted, field.method, field.kind.mapping);
            let elements = [source.points(), wanted.points()];
            let coverage = mapping.map(|mapping| mapping.coverage());
            mappings.push(PlannedMapping { field: index, consumer, elements, coverage });
        }
    }
    mappings
}

impl Plan {
    /// Bytes of one mapped sample for each consumer that needs one.
    pub(super) fn mapped_bytes(&self, index: usize) -> u64 {
        let of_field = self.mappings.iter().filter(|mapping| mapping.field == index);
        let components = self.fields[index].kind.components;
        of_field.map(|mapping| sample_bytes(mapping.elements[1], components)).sum()
    }

    /// Grids that do not cover each other, and methods that do not bound a density.
    pub(super) fn warn_of_mappings(&self, case: &Case) -> Vec<Warning> {
        let mut warnings = Vec::new();
        for mapping in &self.mappings {
            let (field, role) =
                (&self.fields[mapping.field], &self.participants[mapping.consumer].role);
            let name = &field.kind.name;
            let poor = mapping.coverage.as_ref().ok().filter(|coverage| coverage.is_poor());
            let poor = poor.map(|coverage| poorly_covered(name, role, coverage));
            let unbounded =
                field.kind.mapping == Mapping::Conservative && field.method != Method::Intersection;
            let unbounded = unbounded.then(|| {
                let reason = format!(
                    "`{name}` is mapped for {role} by {}, which conserves the integral but does not \
                     bound the density",
                    field.method.name()
                );
                (reason, "write \"intersection\", which does both")
            });
            for (reason, fix) in poor.into_iter().chain(unbounded) {
                warnings.push(case.problem_at(METHOD, reason, fix).into());
            }
        }
        warnings
    }

    pub(super) fn show_mappings(&self, f: &mut String) -> Result {
        let mut head = "mapping";
        for PlannedMapping { field, consumer, elements: [source, wanted], coverage } in
            &self.mappings
        {
            let field = &self.fields[*field];
            let role = |index: ParticipantIndex| self.participants[index].role.as_str();
            let route = format!("{} -> {}", role(field.producer), role(*consumer));
            let (form, method) = (form(field.kind.mapping), field.method.name());
            let name = &field.kind.name;
            if !head.is_empty() {
                writeln!(f)?;
            }
            writeln!(f, "{head:10} {name:26} {route:24} {method}, {form}")?;
            let covered = match coverage {
                Ok(coverage) => coverage.to_string(),
                Err(error) => format!("refused: {error}"),
            };
            writeln!(f, "{:10} {:26} {source} to {wanted} elements; {covered}", "", "")?;
            head = "";
        }
        Ok(())
    }
}

/// Key that chooses how fields are mapped.
const METHOD: &str = "mapping.method";

/// A warning of grids that do not cover each other: reason and fix.
fn poorly_covered(field: &str, role: &str, coverage: &Coverage) -> (String, &'static str) {
    let reason = format!("`{field}` mapped for {role}: {coverage}");
    (reason, "let the grids cover each other: what lies beyond is taken to the border")
}

/// The same warning of a run, about grids that were not known before or have moved apart.
pub(crate) fn warn_of_coverage(field: &str, role: &str, coverage: &Coverage) -> Warning {
    let (reason, fix) = poorly_covered(field, role, coverage);
    Warning::remark(METHOD, reason, fix)
}

fn form(preserves: Mapping) -> &'static str {
    match preserves {
        Mapping::Consistent => "consistent",
        Mapping::Conservative => "conservative",
    }
}
