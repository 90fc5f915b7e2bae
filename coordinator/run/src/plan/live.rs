//! Live values: their providers and readers, and errors in their fields.

use super::contents::{Field, LiveValue};
use super::route::Candidate;
use crate::peers::COORDINATOR;
use case::{Case, LiveKey, Problem};
use contract::configuration::Input;
use contract::field::Mapping;
use contract::live::Live;
use coupling::ParticipantIndex;
use typed_index_collections::TiSlice;

/// Returns the live values of a case that any participant reads.
pub(super) fn values(
    case: &Case,
    running: &TiSlice<ParticipantIndex, Candidate>,
    fields: &[Field],
) -> Vec<LiveValue> {
    let value = |live: &LiveKey| {
        let name = &live.field.name;
        let field = fields.iter().find(|field| field.kind.name == *name);
        let reads = |(one, candidate): (ParticipantIndex, &Candidate)| {
            candidate.live.contains(&name.as_str()).then_some(one)
        };
        LiveValue {
            kind: live.field.clone(),
            first: live.first,
            limits: live.limits,
            provider: field.map(|field| field.producer),
            readers: running.iter_enumerated().filter_map(reads).collect(),
        }
    };
    case.live.iter().map(value).filter(|live| !live.readers.is_empty()).collect()
}

/// Returns a problem for each live value whose provider does not send one number in the unit of the
/// key.
pub(super) fn misfits(case: &Case, fields: &[Field]) -> Vec<Problem> {
    let problem = |live: &LiveKey| {
        let found = &fields.iter().find(|field| field.kind.name == live.field.name)?.kind;
        let fits = found.unit == live.field.unit
            && found.components == 1
            && found.mapping == Mapping::Consistent;
        let (unit, components) = (&found.unit, found.components);
        let reason = format!(
            "comes as a field in {unit} with {components} component(s), but must be one number in {}",
            live.field.unit
        );
        let fix =
            "let its participant describe a consistent field of one component in the key's unit";
        (!fits).then(|| case.problem_at(&live.field.name, reason, fix))
    };
    case.live.iter().filter_map(problem).collect()
}

/// Returns the inputs of a participant that the coordinator sends.
pub(super) fn inputs(live: &[LiveValue], one: ParticipantIndex) -> impl Iterator<Item = Input> {
    let own =
        live.iter().filter(move |live| live.provider.is_none() && live.readers.contains(&one));
    own.map(|live| Input {
        field: live.kind.clone(),
        producer: COORDINATOR.to_owned(),
        grid: Some(Live::grid()),
        moves: false,
        peak: None,
        extent: None,
    })
}
