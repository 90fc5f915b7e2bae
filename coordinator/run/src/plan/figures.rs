//! Figures of a run: the figures that its participants describe, for the bodies of its case.

use super::contents::Participant;
use super::expected::instances;
use contract::bodies::{Bodies, LOWER, UPPER};
use contract::figure::FigureSpec;
use contract::params::Params;
use std::collections::BTreeSet;

/// Collects the figures of all participants and of their active effects in the order of the plan,
/// with the names of the bodies. Each participant is asked for the figures that it provides. If two
/// figures have the same key, the first one counts, as in the summary. Ranks become places in one
/// list.
pub(super) fn gather<'a>(
    participants: impl Iterator<Item = &'a mut Participant>,
    bodies: Option<&Bodies>,
) -> Vec<FigureSpec> {
    let (mut all, mut known) = (Vec::new(), BTreeSet::new());
    for participant in participants {
        let effects = participant.configuration.case.get("effects");
        let is_on = |name: &str| effects.is_some_and(|effects| effects.get(name).is_some());
        let active = participant.description.effects.iter().filter(|effect| is_on(&effect.name));
        let of_effects = active.flat_map(|effect| &effect.figures);
        let described = participant.description.figures.iter().chain(of_effects);
        let mut own: Vec<_> = described.flat_map(|figure| of_bodies(figure, bodies)).collect();
        own.retain(|(_, figure)| known.insert(figure.key.clone()));
        own.iter_mut().for_each(|(_, figure)| judge(figure, &participant.configuration.case));
        let given = own.iter().map(|(_, figure)| figure).filter(|figure| figure.is_given());
        participant.figures = given.map(|figure| figure.key.clone()).collect();
        all.extend(own);
    }
    rank(&mut all);
    all.into_iter().map(|(_, figure)| figure).collect()
}

/// Returns the figure of each body, the lower one first, or the figure itself if it belongs to no
/// body.
fn of_bodies(figure: &FigureSpec, bodies: Option<&Bodies>) -> Vec<(bool, FigureSpec)> {
    if !figure.is_of_a_body() {
        return vec![(false, figure.clone())];
    }
    let Some(Bodies(names)) = bodies else { return Vec::new() };
    [LOWER, UPPER].map(|body| (body == UPPER, figure.of_body(&names[body]))).to_vec()
}

/// Lifts the plausible range of a figure that the case sets itself.
fn judge(figure: &mut FigureSpec, case: &Params) {
    let given = |key: &String| !instances(case, key).is_empty();
    if figure.plausible_unless.as_ref().is_some_and(given) {
        figure.plausible = None;
    }
}

/// Sorts the ranked figures of the upper body behind all others.
fn rank(figures: &mut [(bool, FigureSpec)]) {
    let ranked = |(_, (upper, figure)): (usize, &(bool, FigureSpec))| Some((*upper, figure.rank?));
    let key = |index: usize| ranked((index, &figures[index]));
    let mut order: Vec<usize> = (0..figures.len()).filter(|&index| key(index).is_some()).collect();
    order.sort_by_key(|&index| key(index));
    for (place, index) in order.into_iter().enumerate() {
        figures[index].1.rank = Some(place);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn a_figure_that_the_case_sets_is_not_judged() {
        let figure = FigureSpec::new("contact.creepage_xi", "1", "creepage")
            .expected_below(0.05, "beyond that bodies slide")
            .unless_given("bodies.*.surface_speed");
        let judged = |case| {
            let mut figure = figure.clone();
            judge(&mut figure, &Params(case));
            figure.plausible.is_some()
        };
        assert!(judged(json!({"bodies": {"pin": {"radius_x": 1.0}}, "motion": {"speed": 3.0}})));
        assert!(!judged(json!({"bodies": {"disc": {}, "pin": {"surface_speed": 0.0}}})));
    }

    #[test]
    fn figures_of_the_upper_body_come_after_all_others() {
        let rise = FigureSpec::new("heat.*.rise_k", "K", "rise").rank(1);
        let power = FigureSpec::new("contact.power_w", "W", "power").rank(2);
        let other = FigureSpec::new("contact.area_m2", "m2", "area");
        let bodies = Bodies(["pin".to_owned(), "disc".to_owned()]);
        let described = [rise, power, other];
        let mut all: Vec<_> =
            described.iter().flat_map(|figure| of_bodies(figure, Some(&bodies))).collect();
        rank(&mut all);
        let ranks: Vec<_> =
            all.iter().map(|(_, figure)| (figure.key.as_str(), figure.rank)).collect();
        let expected = [
            ("heat.disc.rise_k", Some(0)),
            ("heat.pin.rise_k", Some(2)),
            ("contact.power_w", Some(1)),
            ("contact.area_m2", None),
        ];
        assert_eq!(ranks, expected);
        assert_eq!(of_bodies(&described[0], None), []);
    }
}
