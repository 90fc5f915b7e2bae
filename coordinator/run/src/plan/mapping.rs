//! Which fields are mapped for which consumer, and how well the grids cover each other.

use super::contents::{Field, Plan, sample_bytes};
use contract::configuration::Layout;
use contract::field::Mapping;
use contract::grid::Grid;
use coupling::ParticipantIndex;
use coupling::map::{GridMapping, Method};
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

impl Plan {
    /// The consumers for which a field is mapped, with its grids, as far as these are known.
    pub(super) fn mapped(&self, field: &Field) -> Vec<(ParticipantIndex, [&Grid; 2])> {
        let layout = |index: ParticipantIndex| self.participants[index].estimate.as_ref();
        let grids = |&one: &ParticipantIndex| Some((one, non_matching(field, one, layout)?));
        field.consumers.iter().filter_map(grids).collect()
    }

    /// Bytes of one mapped sample for each consumer that needs one.
    pub(super) fn mapped_bytes(&self, field: &Field) -> u64 {
        let bytes = |(_, [_, wanted]): &(ParticipantIndex, [&Grid; 2])| {
            sample_bytes(wanted.points(), field.kind.components)
        };
        self.mapped(field).iter().map(bytes).sum()
    }

    pub(super) fn show_mappings(&self, f: &mut String) -> Result {
        let mut head = "mapping";
        for field in &self.fields {
            for (one, grids) in self.mapped(field) {
                let role = |index: ParticipantIndex| self.participants[index].role.as_str();
                let route = format!("{} -> {}", role(field.producer), role(one));
                let (form, method) = (form(field.kind.mapping), field.method.name());
                let name = &field.kind.name;
                if !head.is_empty() {
                    writeln!(f)?;
                }
                writeln!(f, "{head:10} {name:26} {route:24} {method}, {form}")?;
                show_quality(f, field, grids)?;
                head = "";
            }
        }
        Ok(())
    }
}

fn form(preserves: Mapping) -> &'static str {
    match preserves {
        Mapping::Consistent => "consistent",
        Mapping::Conservative => "conservative",
    }
}

/// The mapping is made to see what it covers.
fn show_quality(f: &mut String, field: &Field, [source, wanted]: [&Grid; 2]) -> Result {
    let mut line = |text: &str| writeln!(f, "{:10} {:26} {text}", "", "");
    let sizes = format!("{} to {} elements", source.points(), wanted.points());
    match GridMapping::between(source, wanted, field.method, field.kind.mapping) {
        Ok(mapping) => {
            let coverage = mapping.coverage();
            let head = if coverage.is_poor() { "warning: " } else { "" };
            line(&format!("{sizes}; {head}{coverage}"))?;
        }
        Err(error) => line(&format!("{sizes}; refused: {error}"))?,
    }
    if field.kind.mapping == Mapping::Conservative && field.method != Method::Intersection {
        line(
            "warning: this conserves the integral but does not bound the density; \
              \"intersection\" does both",
        )?;
    }
    Ok(())
}
