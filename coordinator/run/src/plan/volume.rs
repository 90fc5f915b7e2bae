//! Check of fields on volumes and at points: they can be written, but a case in which a participant
//! consumes one is refused.

use super::contents::{Participant, Plan};
use case::{Case, Problem};
use contract::configuration::Layout;
use coupling::ParticipantIndex;

/// Returns a problem for each consumed field of a participant that is on a volume or at points in
/// its layout.
pub(super) fn consumed(
    case: &Case,
    plan: &Plan,
    producer: ParticipantIndex,
    layout: &Layout,
) -> Vec<Problem> {
    let role = &plan.participants[producer].role;
    let sent = plan.fields.iter().filter(|field| field.producer == producer);
    let problems = sent.flat_map(|field| {
        let name = &field.kind.name;
        let unfit = layout.grid_of(name).filter(|grid| grid.only_written());
        let on_it = unfit.into_iter();
        on_it.flat_map(|grid| field.consumers.iter().map(move |one| (*one, grid))).map(
            move |(one, grid)| {
                let consumer = &plan.participants[one];
                let (kind, on) = match grid.is_volume() {
                    true => ("volume", "on volumes"),
                    false => ("grid of points", "at points"),
                };
                let reason = format!(
                    "`{}` consumes `{name}` of `{role}`, which is on the {kind} `{}`: fields {on} are \
                     only written out",
                    consumer.role, grid.name
                );
                let fix = format!(
                    "choose a model of `{role}` that provides `{name}` on a surface, or one of `{}` \
                     that does not need it",
                    consumer.role
                );
                case.problem_at(&asking(case, consumer, name), reason, fix)
            },
        )
    });
    problems.collect()
}

/// Returns the key of the case that makes a participant consume a field: an effect, or its model.
fn asking(case: &Case, consumer: &Participant, field: &str) -> String {
    let effects = &consumer.description.effects;
    let mut active = effects.iter().filter(|effect| case.effects.contains(&effect.name));
    match active.find(|effect| effect.consumes.iter().any(|name| name == field)) {
        Some(effect) => format!("effects.{}", effect.name),
        None => format!("{}.model", consumer.role),
    }
}
