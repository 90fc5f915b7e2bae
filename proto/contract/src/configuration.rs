//! Messages exchanged before a run: the configuration of a participant and its answer, as JSON.

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

/// Time dependence of a case.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Mode {
    /// A single window without duration.
    Steady,
    /// Consecutive windows of coupling time from 0.
    Transient,
}

/// Windows of a transient case, as expected before the run.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Windows {
    /// Shortest window [s]: a run with adaptive windows begins with it.
    pub shortest: f64,
    /// Usual window [s].
    pub usual: f64,
    /// End of the last window [s]; `None` if whoever drives the run chooses it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub end: Option<f64>,
}

/// Configuration of a participant, sent with `Configure` and on standard input of `--estimate`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Configuration {
    /// Role of the participant.
    pub role: String,
    /// Name of the chosen model, from the description.
    pub model: String,
    /// Steady or transient case.
    pub mode: Mode,
    /// Windows of a transient case; `None` in a steady case.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub windows: Option<Windows>,
    /// Case values that this participant reads, in SI units, with defaults filled in, nested by
    /// table. `effects` holds one table for each active effect that this participant claims, and no
    /// other.
    pub case: Params,
    /// Varying case values; `case` holds the values of their first row.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub histories: Option<Histories>,
    /// Received fields, in the order of [`crate::message::Command::expected`].
    pub inputs: Vec<Input>,
    /// Names of the fields to publish in every iteration.
    pub outputs: Vec<String>,
    /// Names of the fields to publish when an accepted window is observed.
    pub observed: Vec<String>,
    /// Number of threads to compute on. Results must be independent of this number.
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
    /// Role of the producer.
    pub producer: String,
    /// Grid on which the field arrives; `None` while unknown.
    pub grid: Option<Grid>,
    /// The grid may move between windows. A participant that cannot follow a moving grid requests
    /// the input on a grid of its own ([`Layout::inputs`]), or refuses the case.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub moves: bool,
    /// Expected place of the largest value [m], see [`Layout::peaks`].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub peak: Option<[f64; 3]>,
    /// Expected half lengths along x and y of the region where the field is not zero [m], see
    /// [`Layout::extents`].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub extent: Option<[f64; 2]>,
}

impl Configuration {
    /// Returns true if an effect is active and claimed by this participant.
    #[must_use]
    pub fn has_effect(&self, name: &str) -> bool {
        self.case.has(&format!("effects.{name}"))
    }

    /// Returns the case in a window, with varying values at the row or time of the window.
    #[must_use]
    pub fn case_at(&self, step: &Step) -> Cow<'_, Params> {
        match &self.histories {
            Some(histories) => Cow::Owned(histories.at(&self.case, step)),
            None => Cow::Borrowed(&self.case),
        }
    }

    /// Returns the grid on which an input arrives.
    #[must_use]
    pub fn input_grid(&self, field: &str) -> Option<&Grid> {
        self.inputs.iter().find(|i| i.field.name == field).and_then(|i| i.grid.as_ref())
    }
}

/// Answer to `Configure` and to `--estimate`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Layout {
    /// Grids of the outputs, and requested grids of inputs.
    pub grids: Vec<Grid>,
    /// Grid of each output and observed field.
    pub fields: Vec<FieldOnGrid>,
    /// Requested grids of inputs; the coordinator maps an input there from the producer's grid.
    /// Inputs without a request arrive on the grid of their producer.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub inputs: Vec<FieldOnGrid>,
    /// Names of grids that may move when a window is accepted, see `moved_grids` of a model.
    /// Volumes need not be listed.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub moving: Vec<String>,
    /// Expected place of the largest value of a field [m], by field name, where known before the
    /// first solve. Consumers can refine their grids there.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub peaks: BTreeMap<String, [f64; 3]>,
    /// Expected half lengths along x and y of the region where a field is not zero [m], by field
    /// name, where known before the first solve. The grid of the field usually is larger.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub extents: BTreeMap<String, [f64; 2]>,
    /// Expected processor seconds of one solve.
    pub solve_seconds: f64,
    /// Expected additional processor seconds of a solve per second of its window [s/s], for models
    /// with time steps of their own.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub seconds_per_second: f64,
    /// Expected processor seconds of work done once per run, independent of the number of solves.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub build_seconds: f64,
    /// Expected memory of the participant's own arrays [byte].
    pub memory_bytes: u64,
    /// Remarks for `plan` on the model's view of the case, one line each.
    #[serde(default)]
    pub remarks: Vec<String>,
    /// Warnings about the case, in the form of refusals; the run continues.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub warnings: Vec<Refusal>,
    /// Simplifications in this particular case, in addition to those of the description.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub left_out: Vec<Simplification>,
    /// Quantities of the summary with a closed form in this case, by dotted key. Studies compare
    /// all models with these reference values.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub closed_forms: BTreeMap<String, f64>,
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "the signature that serde asks for")]
fn is_zero(value: &f64) -> bool {
    *value == 0.0
}

/// A field and the grid of its values.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FieldOnGrid {
    /// Name of the field.
    pub field: String,
    /// Name of the grid.
    pub grid: String,
}

impl Layout {
    /// Checks a layout received from another process.
    ///
    /// # Errors
    /// Fails if [`Grid::check`] refuses a grid, if two grids have the same name, or if a text has
    /// more than one line. Fails if an input is requested twice, on a volume, on points, or on a
    /// grid that the layout lacks. Fails if a moving grid is unknown or listed twice.
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
                return Err(format!("the moving grid `{name}` is unknown or listed twice"));
            }
        }
        Ok(())
    }

    /// Returns true if the geometry of a grid travels: the grid may move, or is a volume.
    #[must_use]
    pub fn moves(&self, grid: &Grid) -> bool {
        grid.is_volume() || self.moving.contains(&grid.name)
    }

    /// Returns true if the geometry of the grid of a field travels.
    #[must_use]
    pub fn moves_under(&self, field: &str) -> bool {
        self.grid_of(field).is_some_and(|grid| self.moves(grid))
    }

    /// Returns the grid of a field.
    #[must_use]
    pub fn grid_of(&self, field: &str) -> Option<&Grid> {
        self.among(&self.fields, field)
    }

    /// Returns the requested grid of an input; `None` if the producer's grid is used.
    #[must_use]
    pub fn input_grid(&self, field: &str) -> Option<&Grid> {
        self.among(&self.inputs, field)
    }

    fn among(&self, placed: &[FieldOnGrid], field: &str) -> Option<&Grid> {
        let name = &placed.iter().find(|f| f.field == field)?.grid;
        self.grids.iter().find(|g| &g.name == name)
    }
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

    /// A participant that requests no grids writes and reads the same text as before requests
    /// existed.
    #[test]
    fn a_layout_without_wishes_is_written_as_before() {
        let text = serde_json::to_string(&wanting(&[])).unwrap();
        assert!(!text.contains("inputs") && !text.contains("moving"), "{text}");
        assert_eq!(serde_json::from_str::<Layout>(&text).unwrap(), wanting(&[]));
    }

    /// An input on a fixed grid is written as before moving grids existed.
    #[test]
    fn an_input_whose_grid_stays_is_written_as_before() {
        let field = crate::field::PRESSURE.kind();
        let input = Input {
            field,
            producer: "mech".to_owned(),
            grid: None,
            moves: false,
            peak: None,
            extent: None,
        };
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
            assert!(moving(wrong).check().unwrap_err().contains("is unknown or listed twice"));
        }
    }
}
