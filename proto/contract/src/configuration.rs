//! What a participant is given before a run, and what it answers. All of it travels as JSON.

pub use crate::refusal::Refusal;

use crate::accuracy::Simplification;
use crate::field::FieldKind;
use crate::grid::Grid;
use crate::history::Histories;
use crate::params::Params;
use crate::step::Step;
use crate::text::check_lines;
use serde::{Deserialize, Serialize};
use std::borrow::Cow;
use std::collections::BTreeMap;

/// Steady or transient.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Mode {
    /// A single window without duration.
    Steady,
    /// Windows of coupling time from 0 on.
    Transient,
}

/// Sent with `Configure`, and on standard input of `--estimate`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Configuration {
    /// The role to play.
    pub role: String,
    /// The model chosen, one of the description's.
    pub model: String,
    /// Steady or transient.
    pub mode: Mode,
    /// The case values this participant reads, in SI units, defaults filled in, nested by table.
    /// `effects` holds a table for every active effect that this participant claims, no other.
    pub case: Params,
    /// Values of the case that vary; in `case` they have those of the first row.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub histories: Option<Histories>,
    /// Fields it will receive, in the order of [`crate::message::Command::expected`].
    pub inputs: Vec<Input>,
    /// Names of the fields it has to publish in every iteration.
    pub outputs: Vec<String>,
    /// Names of the fields it has to publish when an accepted window is observed.
    pub observed: Vec<String>,
    /// Threads that it may compute on at the same time. Its results do not depend on it.
    #[serde(default = "one")]
    pub threads: usize,
}

fn one() -> usize {
    1
}

/// A field that a participant receives.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Input {
    /// Kind of the field.
    pub field: FieldKind,
    /// Role of the participant that computes it.
    pub producer: String,
    /// The grid it arrives on; absent while that is not known yet.
    pub grid: Option<Grid>,
    /// That grid may move between windows. A participant that cannot follow it wants the input on a
    /// grid of its own ([`Layout::inputs`]), or refuses.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub moves: bool,
    /// Where its largest value is expected, see [`Layout::peaks`] [m].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub peak: Option<[f64; 3]>,
}

impl Configuration {
    /// An effect is active and claimed by this participant.
    #[must_use]
    pub fn has_effect(&self, name: &str) -> bool {
        self.case.has(&format!("effects.{name}"))
    }

    /// The case in a window: with the values of its row or instant, where any vary.
    #[must_use]
    pub fn case_at(&self, step: &Step) -> Cow<'_, Params> {
        match &self.histories {
            Some(histories) => Cow::Owned(histories.at(&self.case, step)),
            None => Cow::Borrowed(&self.case),
        }
    }

    /// The grid on which an input arrives.
    #[must_use]
    pub fn input_grid(&self, field: &str) -> Option<&Grid> {
        self.inputs.iter().find(|i| i.field.name == field).and_then(|i| i.grid.as_ref())
    }
}

/// Answer to `Configure` and to `--estimate`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Layout {
    /// The grids of the outputs, and those on which inputs are wanted.
    pub grids: Vec<Grid>,
    /// Which grid each output and observed field lives on.
    pub fields: Vec<FieldOnGrid>,
    /// Which grid each input is wanted on: the coordinator maps it there, if its producer's is
    /// another. An input without a wish arrives on its producer's grid.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub inputs: Vec<FieldOnGrid>,
    /// Names of those of the grids that may move when a window is accepted, see
    /// `moved_grids` of a model. A volume need not be named.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub moving: Vec<String>,
    /// Where the largest value of a field is expected, by its name, as far as that is known before
    /// the first solve [m]; for consumers that look at one place more closely than at others.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub peaks: BTreeMap<String, [f64; 3]>,
    /// Expected processor seconds of one solve.
    pub solve_seconds: f64,
    /// Expected processor seconds of a solve besides that for each second of its window, of a model that has
    /// time steps of its own [s/s].
    #[serde(default, skip_serializing_if = "is_nought")]
    pub seconds_per_second: f64,
    /// Expected processor seconds of what is done once, whatever the number of solves.
    #[serde(default, skip_serializing_if = "is_nought")]
    pub build_seconds: f64,
    /// Expected memory of the participant's own arrays [byte].
    pub memory_bytes: u64,
    /// Remarks for `plan`, one line each: what the model makes of the case.
    #[serde(default)]
    pub remarks: Vec<String>,
    /// Warnings about the case, in the form of refusals. The case is run all the same.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub warnings: Vec<Refusal>,
    /// What the model leaves out in this very case, besides what its description says.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub left_out: Vec<Simplification>,
    /// Quantities of the summary that have a closed form in this case, by dotted key: what a study
    /// compares the answers of all models with.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub closed_forms: BTreeMap<String, f64>,
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "the signature that serde asks for")]
fn is_nought(value: &f64) -> bool {
    *value == 0.0
}

/// A field and the grid it lives on.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FieldOnGrid {
    /// Name of the field.
    pub field: String,
    /// Name of the grid.
    pub grid: String,
}

impl Layout {
    /// What is wrong with a layout that came from outside.
    ///
    /// # Errors
    /// A grid that [`Grid::check`] refuses, two of the same name, an input that is wanted twice or
    /// on a volume or on no grid of the layout, a name among those that move that is no grid or stands twice, or a
    /// text that is more than one line.
    pub fn check(&self) -> Result<(), String> {
        check_lines("layout", &(&self.remarks, &self.left_out, &self.closed_forms))?;
        for (index, grid) in self.grids.iter().enumerate() {
            grid.check()?;
            if self.grids[..index].iter().any(|other| other.name == grid.name) {
                return Err(format!("two grids are called `{}`", grid.name));
            }
        }
        for (index, FieldOnGrid { field, grid }) in self.inputs.iter().enumerate() {
            if self.inputs[..index].iter().any(|other| other.field == *field) {
                return Err(format!("the input `{field}` is wanted on two grids"));
            }
            let fault = match self.input_grid(field) {
                Some(wanted) if !wanted.only_written() => continue,
                Some(wanted) if wanted.is_volume() => {
                    "a volume: fields on volumes are only written out"
                }
                Some(_) => "of points: fields at points are only written out",
                None => "not a grid",
            };
            return Err(format!("the input `{field}` is wanted on `{grid}`, which is {fault}"));
        }
        for (index, name) in self.moving.iter().enumerate() {
            if self.moving[..index].contains(name) || self.grids.iter().all(|g| g.name != *name) {
                return Err(format!("`{name}` moves, which is not a grid or is listed twice"));
            }
        }
        Ok(())
    }

    /// The geometry of a grid of this layout travels: it may move, or is a volume.
    #[must_use]
    pub fn moves(&self, grid: &Grid) -> bool {
        grid.is_volume() || self.moving.contains(&grid.name)
    }

    /// The grid of a field may move.
    #[must_use]
    pub fn moves_under(&self, field: &str) -> bool {
        self.grid_of(field).is_some_and(|grid| self.moves(grid))
    }

    /// The grid of a field.
    #[must_use]
    pub fn grid_of(&self, field: &str) -> Option<&Grid> {
        self.among(&self.fields, field)
    }

    /// The grid on which an input is wanted; `None` if its producer's will do.
    #[must_use]
    pub fn input_grid(&self, field: &str) -> Option<&Grid> {
        self.among(&self.inputs, field)
    }

    fn among(&self, placed: &[FieldOnGrid], field: &str) -> Option<&Grid> {
        let name = &placed.iter().find(|f| f.field == field)?.grid;
        self.grids.iter().find(|g| &g.name == name)
    }
}

/// What `--estimate` prints.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Estimate {
    /// The case can be computed like this.
    Layout(Layout),
    /// The case is refused.
    Refused(Refusal),
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::{Hexahedra, Structured};

    fn wanting(inputs: &[(&str, &str)]) -> Layout {
        let shape = Structured::contact_plane(0.0, 0.0, 1.0, 1.0, 3, 2);
        let on = |(field, grid): &(&str, &str)| FieldOnGrid {
            field: (*field).to_owned(),
            grid: (*grid).to_owned(),
        };
        Layout {
            grids: vec![Grid::structured("fine", shape)],
            inputs: inputs.iter().map(on).collect(),
            ..Layout::default()
        }
    }

    #[test]
    fn wishes_are_found_and_checked() {
        let layout = wanting(&[("friction_power", "fine")]);
        assert_eq!(layout.check(), Ok(()));
        assert_eq!(layout.input_grid("friction_power"), layout.grids.first());
        assert_eq!((layout.input_grid("pressure"), layout.grid_of("friction_power")), (None, None));
        let nowhere = wanting(&[("x", "coarse")]).check();
        assert_eq!(nowhere, Err("the input `x` is wanted on `coarse`, which is not a grid".into()));
        let twice = wanting(&[("x", "fine"), ("y", "fine"), ("x", "fine")]).check();
        assert_eq!(twice, Err("the input `x` is wanted on two grids".into()));
    }

    #[test]
    fn no_input_is_wanted_on_a_volume() {
        let mut layout = wanting(&[("x", "body")]);
        let hexahedra = Hexahedra::Structured { ni: 2, nj: 1, nk: 1 };
        layout.grids.push(Grid::volume("body", hexahedra));
        let fault = layout.check().unwrap_err();
        assert!(fault.contains("`x` is wanted on `body`, which is a volume"), "{fault}");
        assert!(layout.moves(&layout.grids[1]) && !layout.moves(&layout.grids[0]));
    }

    /// A participant that knows of no wishes says and reads what it always did.
    #[test]
    fn a_layout_without_wishes_is_written_as_before() {
        let text = serde_json::to_string(&wanting(&[])).unwrap();
        assert!(!text.contains("inputs") && !text.contains("moving"), "{text}");
        assert_eq!(serde_json::from_str::<Layout>(&text).unwrap(), wanting(&[]));
    }

    /// Nor is one that no moving grid concerns informed of any.
    #[test]
    fn an_input_whose_grid_stays_is_written_as_before() {
        let field = crate::field::PRESSURE.kind();
        let input =
            Input { field, producer: "mech".to_owned(), grid: None, moves: false, peak: None };
        let text = serde_json::to_string(&input).unwrap();
        assert!(!text.contains("moves"), "{text}");
        assert_eq!(serde_json::from_str::<Input>(&text).unwrap(), input);
        let text = serde_json::to_string(&Input { moves: true, ..input }).unwrap();
        assert!(serde_json::from_str::<Input>(&text).unwrap().moves, "{text}");
    }

    #[test]
    fn moving_grids_are_checked() {
        let moving = |names: &[&str]| {
            let moving = names.iter().map(|name| (*name).to_owned()).collect();
            Layout { moving, ..wanting(&[]) }
        };
        let layout = moving(&["fine"]);
        assert_eq!(layout.check(), Ok(()));
        assert!(layout.moves(&layout.grids[0]) && !wanting(&[]).moves(&layout.grids[0]));
        for wrong in [["coarse"].as_slice(), &["fine", "fine"]] {
            assert!(moving(wrong).check().unwrap_err().contains("moves, which is not a grid"));
        }
    }
}
