//! Mappings of a plan: fields whose consumer has another grid, and how well the two grids cover
//! each other.

use super::contents::{Field, Plan, PlannedMapping, sample_bytes};
use crate::warnings::Warning;
use case::Case;
use contract::configuration::Layout;
use contract::field::Mapping;
use contract::grid::Grid;
use coupling::ParticipantIndex;
use coupling::map::{Coverage, GridMapping, Method};
use std::fmt::{Result, Write};

/// Returns the grids of a field's producer and consumer, if the field must be mapped between them.
/// Returns `None` if the grids match or are unknown. Two grids never match if one of them may move.
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

/// Returns the mappings of a plan. Each mapping is built to find its coverage.
pub(super) fn planned(plan: &Plan) -> Vec<PlannedMapping> {
    let layout = |index: ParticipantIndex| plan.participants[index].estimate.as_ref();
    let mut mappings = Vec::new();
    for (index, field) in plan.fields.iter().enumerate() {
        for &consumer in &field.consumers {
            let Some([source, wanted]) = non_matching(field, consumer, layout) else { continue };
            let preserves = field.kind.mapping;
            let suited = || Method::suited_to(preserves, source, wanted);
            let method = field.method.unwrap_or_else(suited);
            let mapping = GridMapping::between(source, wanted, method, preserves);
            let elements = [source.points(), wanted.points()];
            let coverage = mapping.map(|mapping| mapping.coverage());
            mappings.push(PlannedMapping { field: index, consumer, elements, method, coverage });
        }
    }
    mappings
}

impl Plan {
    /// Returns the size of all mapped samples of a field [byte].
    pub(super) fn mapped_bytes(&self, index: usize) -> u64 {
        let of_field = self.mappings.iter().filter(|mapping| mapping.field == index);
        let components = self.fields[index].kind.components;
        of_field.map(|mapping| sample_bytes(mapping.elements[1], components)).sum()
    }

    /// Returns warnings about mappings that cannot be built, about grids that do not cover each
    /// other, about methods that do not bound a density, and about grids without areas.
    pub(super) fn warn_of_mappings(&self, case: &Case) -> Vec<Warning> {
        let mut warnings = Vec::new();
        for mapping in &self.mappings {
            let (field, role) =
                (&self.fields[mapping.field], &self.participants[mapping.consumer].role);
            let name = &field.kind.name;
            let poor = mapping.coverage.as_ref().ok().filter(|coverage| coverage.is_poor());
            let poor = poor.map(|coverage| poorly_covered(name, role, coverage));
            let refused = mapping.coverage.as_ref().err().map(|error| {
                let reason = format!("`{name}` cannot be mapped for {role}: {error}");
                (reason, "change the method, or its function and radius")
            });
            let suited = self
                .grids(field, mapping.consumer)
                .map(|[source, wanted]| Method::suited_to(field.kind.mapping, source, wanted));
            let bounds = suited == Some(Method::Intersection);
            let unbounded = bounds && mapping.method != Method::Intersection;
            let unbounded = unbounded.then(|| {
                let reason = format!(
                    "`{name}` is mapped for {role} by {}, which conserves the integral but does not \
                     bound the density",
                    mapping.method
                );
                (reason, "set \"intersection\", which does both")
            });
            for (reason, fix) in refused.into_iter().chain(poor).chain(unbounded) {
                warnings.push(case.problem_at(METHOD, reason, fix).into());
            }
        }
        warnings.extend(self.missing_areas());
        warnings
    }

    /// Returns the grids of a field's producer and consumer, if the field must be mapped.
    fn grids(&self, field: &Field, consumer: ParticipantIndex) -> Option<[&Grid; 2]> {
        non_matching(field, consumer, |index| self.participants[index].estimate.as_ref())
    }

    /// Returns a warning for every grid without areas on which a conservative field is exchanged.
    fn missing_areas(&self) -> Vec<Warning> {
        let mut warnings: Vec<Warning> = Vec::new();
        for field in self.fields.iter().filter(|f| f.kind.mapping == Mapping::Conservative) {
            let name = &field.kind.name;
            let layout = |index: ParticipantIndex| self.participants[index].estimate.as_ref();
            for &consumer in &field.consumers {
                let sent = layout(field.producer).and_then(|layout| layout.grid_of(name));
                let wanted = layout(consumer).and_then(|layout| layout.input_grid(name));
                for grid in sent.into_iter().chain(wanted).filter(|grid| !grid.has_areas()) {
                    let warning = warn_of_missing_areas(name, &grid.name);
                    if warnings.iter().all(|other| !other.says_the_same(&warning)) {
                        warnings.push(warning);
                    }
                }
            }
        }
        warnings
    }

    pub(super) fn show_mappings(&self, f: &mut String) -> Result {
        let mut head = "mapping";
        for PlannedMapping { field, consumer, elements: [source, wanted], method, coverage } in
            &self.mappings
        {
            let field = &self.fields[*field];
            let role = |index: ParticipantIndex| self.participants[index].role.as_str();
            let route = format!("{} -> {}", role(field.producer), role(*consumer));
            let form = form(field.kind.mapping);
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

/// Key of the mapping method.
const METHOD: &str = "mapping.method";

/// Returns reason and fix of a warning about grids that do not cover each other.
fn poorly_covered(field: &str, role: &str, coverage: &Coverage) -> (String, &'static str) {
    let reason = format!("`{field}` mapped for {role}: {coverage}");
    (reason, "let the grids cover each other: values beyond are moved to the border")
}

/// Returns the warning about a conservative field on a grid without areas.
pub(crate) fn warn_of_missing_areas(field: &str, grid: &str) -> Warning {
    let reason = format!(
        "the grid `{grid}` has no areas: the integral of `{field}` cannot be checked, and a mapping \
         is consistent"
    );
    let fix = "give the grid edges or triangles, or totals per point";
    Warning::remark(METHOD, reason, fix)
}

/// Returns the warning of a run about grids that were unknown before, or that have moved apart.
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
