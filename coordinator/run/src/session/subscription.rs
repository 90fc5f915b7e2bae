//! Which participant subscribes to which topic.

use super::tap::Consumer;
use crate::plan::{Field, Plan, non_matching};
use contract::configuration::{Input, Layout};
use contract::grid::Grid;
use coupling::ParticipantIndex;
use typed_index_collections::TiSlice;

/// Where a consumer gets a field from.
#[derive(Debug, PartialEq)]
pub(super) enum Subscription<'a> {
    Producer,
    /// The coordinator, on the producer's grid.
    Iterates,
    /// The coordinator, on the grid that the consumer wants, maybe iterates too.
    Mapped(&'a Grid),
}

/// Where one of a field's consumers gets it from.
pub(super) fn subscription<'a>(
    field: &Field,
    one: ParticipantIndex,
    layouts: &'a TiSlice<ParticipantIndex, Layout>,
) -> Subscription<'a> {
    match non_matching(field, one, |index| layouts.get(index)) {
        Some([_, wanted]) => Subscription::Mapped(wanted),
        None if field.fed_back.contains(&one) => Subscription::Iterates,
        None => Subscription::Producer,
    }
}

/// The consumers of a field that subscribe to it like this.
pub(super) fn readers<'a>(
    field: &'a Field,
    layouts: &'a TiSlice<ParticipantIndex, Layout>,
    like: &'a Subscription<'a>,
) -> impl Iterator<Item = ParticipantIndex> + 'a {
    field.consumers.iter().copied().filter(move |&one| subscription(field, one, layouts) == *like)
}

/// A consumer of a field, and where that is among its inputs.
pub(super) fn consumer(plan: &Plan, field: &Field, participant: ParticipantIndex) -> Consumer {
    position(plan, &field.kind.name, participant)
}

/// A participant that has a field among its inputs, and where.
pub(super) fn position(plan: &Plan, name: &str, participant: ParticipantIndex) -> Consumer {
    let inputs = &plan.participants[participant].configuration.inputs;
    let slot = inputs.iter().position(|i| i.field.name == name);
    Consumer { participant, slot: slot.expect("a consumer has the field as an input") }
}

/// What a participant is informed of, when the layouts of those before it are known: whether the
/// grid of one of its inputs may move. Of later ones the estimate says it.
pub(super) fn is_informed(
    plan: &Plan,
    layouts: &TiSlice<ParticipantIndex, Layout>,
    input: &Input,
) -> bool {
    let producer = plan.participants.position(|p| p.role == input.producer);
    let layout = producer.and_then(|index| {
        layouts.get(index).or_else(|| plan.participants[index].estimate.as_ref())
    });
    layout.is_some_and(|layout| layout.moves_under(&input.field.name))
}
