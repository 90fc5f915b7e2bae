//! Who hears what on which topic.

use super::tap::Consumer;
use crate::plan::{Field, Plan, non_matching};
use contract::configuration::{Input, Layout};
use contract::grid::Grid;

/// Whom a consumer hears.
#[derive(Debug, PartialEq)]
pub(super) enum Hears<'a> {
    Producer,
    /// The coordinator, on the producer's grid.
    Iterates,
    /// The coordinator, on the grid that the consumer wants, maybe iterates too.
    Mapped(&'a Grid),
}

/// Whom one of a field's consumers hears.
pub(super) fn hears<'a>(field: &Field, one: usize, layouts: &'a [Layout]) -> Hears<'a> {
    match non_matching(field, one, |index| layouts.get(index)) {
        Some([_, wanted]) => Hears::Mapped(wanted),
        None if field.fed_back.contains(&one) => Hears::Iterates,
        None => Hears::Producer,
    }
}

/// The consumers of a field that hear it like this.
pub(super) fn readers<'a>(
    field: &'a Field,
    layouts: &'a [Layout],
    like: &'a Hears<'a>,
) -> impl Iterator<Item = usize> + 'a {
    field.consumers.iter().copied().filter(move |&one| hears(field, one, layouts) == *like)
}

/// A consumer of a field, and where that is among its inputs.
pub(super) fn consumer(plan: &Plan, field: &Field, participant: usize) -> Consumer {
    let inputs = &plan.participants[participant].configuration.inputs;
    let slot = inputs.iter().position(|i| i.field.name == field.kind.name);
    Consumer { participant, slot: slot.expect("a consumer has the field as an input") }
}

/// What a participant is told, when the layouts of those before it are known: whether the grid of
/// one of its inputs may move. Of who comes later the estimate says it.
pub(super) fn is_told(plan: &Plan, layouts: &[Layout], input: &Input) -> bool {
    let producer = plan.participants.iter().position(|p| p.role == input.producer);
    let layout = producer.and_then(|index| {
        layouts.get(index).or_else(|| plan.participants[index].estimate.as_ref())
    });
    layout.is_some_and(|layout| layout.moves_under(&input.field.name))
}
