//! Layouts of the participants, asked for along the flow of data: each participant is configured
//! with the grids of its inputs.

use contract::configuration::{Configuration, Input, Layout};
use coupling::ParticipantIndex;
use typed_index_collections::{TiSlice, TiVec};

/// Layouts of participants, as far as they are known.
pub(crate) type Layouts = TiVec<ParticipantIndex, Option<Layout>>;

/// Asks the participants for their layouts, and completes their configurations. Participants with
/// an input on a moving grid are asked again, if the grid was found to move only afterwards. `ask`
/// returns no layout if a participant is to be asked later.
pub(crate) fn layouts<E>(
    configurations: &mut TiSlice<ParticipantIndex, Configuration>,
    mut ask: impl FnMut(ParticipantIndex, &Configuration) -> Result<Option<Layout>, E>,
) -> Result<Layouts, E> {
    let mut layouts: Layouts = configurations.iter().map(|_| None).collect();
    let roles: Vec<String> = configurations.iter().map(|of| of.role.clone()).collect();
    let place = |input: &Input| roles.iter().position(|role| *role == input.producer);
    for one in configurations.keys() {
        for input in &mut configurations[one].inputs {
            if let Some(layout) = place(input).and_then(|at| layouts.raw[at].as_ref()) {
                input.grid = layout.grid_of(&input.field.name).cloned();
                input.peak = layout.peaks.get(&input.field.name).copied();
                input.extent = layout.extents.get(&input.field.name).copied();
                input.moves = layout.moves_under(&input.field.name);
            }
        }
        // A participant that needs the grid of one that is asked later is asked later, too.
        let before = |at: &usize| *at < usize::from(one) && layouts.raw[*at].is_none();
        if configurations[one].inputs.iter().filter_map(&place).any(|at| before(&at)) {
            continue;
        }
        layouts[one] = ask(one, &configurations[one])?;
    }
    for one in configurations.keys() {
        let mut news = false;
        for input in &mut configurations[one].inputs {
            let layout = place(input).and_then(|at| layouts.raw[at].as_ref());
            let moves = layout.is_some_and(|layout| layout.moves_under(&input.field.name));
            news |= moves != input.moves;
            input.moves |= moves;
        }
        if news {
            layouts[one] = ask(one, &configurations[one])?;
        }
    }
    Ok(layouts)
}

#[cfg(test)]
mod tests {
    use super::*;
    use contract::configuration::{FieldOnGrid, Mode};
    use contract::field;
    use contract::grid::{Grid, Shape, Structured};

    fn configuration(role: &str, consumes: (&str, &str)) -> Configuration {
        let (field, producer) = consumes;
        let kind = field::find(field).unwrap().kind();
        Configuration {
            role: role.to_owned(),
            model: "law".to_owned(),
            mode: Mode::Steady,
            windows: None,
            case: Default::default(),
            histories: None,
            threads: 1,
            inputs: vec![Input {
                field: kind,
                producer: producer.to_owned(),
                grid: None,
                moves: false,
                peak: None,
                extent: None,
            }],
            outputs: Vec::new(),
            observed: Vec::new(),
        }
    }

    fn layout(field: &str, moves: bool) -> Layout {
        let shape = Shape::Structured(Structured::contact_plane(0.0, 0.0, 1.0, 1.0, 3, 2));
        Layout {
            grids: vec![Grid { name: "contact".to_owned(), revision: 1, shape }],
            fields: vec![FieldOnGrid { field: field.to_owned(), grid: "contact".to_owned() }],
            moving: if moves { vec!["contact".to_owned()] } else { Vec::new() },
            ..Layout::default()
        }
    }

    /// Two participants consume a field of each other. The second one knows the grid of its input;
    /// the first one is asked again only if the grid of its input moves.
    #[test]
    fn a_loop_is_configured_along_the_flow_of_data() {
        for moves in [false, true] {
            let mut both: TiVec<ParticipantIndex, Configuration> = TiVec::from(vec![
                configuration("mech", ("lower_temperature", "thermal")),
                configuration("thermal", ("friction_power", "mech")),
            ]);
            let mut asked = Vec::new();
            let found = layouts(&mut both, |one, of| {
                asked.push((usize::from(one), of.inputs[0].grid.is_some(), of.inputs[0].moves));
                Ok::<_, ()>(Some(match usize::from(one) {
                    0 => layout("friction_power", false),
                    _ => layout("lower_temperature", moves),
                }))
            });
            assert!(found.unwrap().iter().all(Option::is_some));
            let again = moves.then_some((0, false, true));
            let expected: Vec<_> =
                [(0, false, false), (1, true, false)].into_iter().chain(again).collect();
            assert_eq!(asked, expected);
        }
    }
}
