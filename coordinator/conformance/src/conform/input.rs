//! Inputs of a participant under test: smooth positive fields of a typical magnitude, or recorded
//! ones.

use crate::recording_file;
use contract::configuration::Configuration;
use contract::field::{FieldKind, SURFACE_SPEED};
use contract::grid::{Grid, Structured};
use contract::message::{CommandKind, Topics};
use proto::recording::{Event, Item};
use run::error::RunError;
use std::path::Path;

/// Half length of the default patch, for an input whose producer does not describe its grid [m].
const HALF_PATCH: f64 = 8e-3;
/// Numbers of elements along the sides of the default patch.
const ELEMENTS: [usize; 2] = [24, 16];

/// Source of the values of an input.
#[derive(Clone, Debug)]
pub(super) struct InputSource {
    pub(super) kind: FieldKind,
    /// Largest value of the artificial field, in the unit of the field.
    magnitude: f64,
    /// Recorded values, which replace the artificial ones.
    pub(super) recorded: Option<Vec<f64>>,
}

impl InputSource {
    /// Returns the artificial source of an input of a configuration.
    pub(super) fn new(kind: &FieldKind, configuration: &Configuration) -> Self {
        let speed = configuration.case.number("motion.speed");
        let magnitude = match kind.unit.as_str() {
            "W/m2" | "Pa" => 1e8,
            "K" => 100.0,
            "m/s" => speed.ok().filter(|speed| *speed > 0.0).unwrap_or(1.0),
            "m" => 1e-4,
            _ => 1.0,
        };
        Self { kind: kind.clone(), magnitude, recorded: None }
    }

    /// Returns `components * points` values, component-major. Variation 0 is the field itself; each
    /// further one is stronger by a quarter of it, in every value.
    ///
    /// The artificial field is m (1/20 + 19/20 √(1 − ξ² − η²)) with the magnitude m. The
    /// coordinates ξ and η run from −1 to 1 over the extent of the grid, and the root is 0 outside
    /// of the ellipse.
    pub(super) fn values(&self, grid: &Grid, variation: u32) -> Vec<f64> {
        let scale = 1.0 + 0.25 * f64::from(variation);
        let length = grid.points() * self.kind.components as usize;
        if let Some(recorded) = self.recorded.as_ref().filter(|values| values.len() == length) {
            return recorded.iter().map(|value| scale * value).collect();
        }
        let extent = [0, 1].map(|axis| {
            let along = (0..grid.points()).map(|point| grid.centre(point)[axis]);
            along.fold((f64::MAX, f64::MIN), |(low, high), x| (low.min(x), high.max(x)))
        });
        let shape = |point: usize| {
            let centre = grid.centre(point);
            let squares = [0, 1].map(|axis| {
                let (low, high) = extent[axis];
                if high > low {
                    ((2.0 * centre[axis] - low - high) / (high - low)).powi(2)
                } else {
                    0.0
                }
            });
            0.05 + 0.95 * (1.0 - squares[0] - squares[1]).max(0.0).sqrt()
        };
        let one: Vec<f64> =
            (0..grid.points()).map(|point| scale * self.magnitude * shape(point)).collect();
        one.repeat(self.kind.components as usize)
    }
}

/// Returns the grid of an input whose producer does not describe its grid.
pub(super) fn default_grid(kind: &FieldKind) -> Grid {
    let [ni, nj] = if kind.name == SURFACE_SPEED.name { [1, 1] } else { ELEMENTS };
    Grid::structured("given", patch([-HALF_PATCH; 2], [HALF_PATCH; 2], [ni, nj]))
}

/// Returns a grid over the same patch with other numbers of elements. Returns `None` for a single
/// element or an unstructured grid.
pub(super) fn resized(grid: &Grid, elements: [usize; 2]) -> Option<Grid> {
    let old = grid.as_structured().filter(|shape| shape.points() > 1)?;
    let steps = [(old.step_i, old.ni, elements[0]), (old.step_j, old.nj, elements[1])];
    let mut origin = old.origin;
    let [step_i, step_j] = steps.map(|(step, had, has)| {
        let new = step.map(|component| component * had as f64 / has as f64);
        for axis in 0..3 {
            origin[axis] += 0.5 * (new[axis] - step[axis]);
        }
        new
    });
    let shape = Structured { origin, step_i, step_j, ni: elements[0], nj: elements[1] };
    let mut resized = Grid::structured(&grid.name, shape);
    resized.revision = grid.revision;
    Some(resized)
}

fn patch(low: [f64; 2], high: [f64; 2], [ni, nj]: [usize; 2]) -> Structured {
    let [dx, dy] = [(high[0] - low[0]) / ni as f64, (high[1] - low[1]) / nj as f64];
    Structured::contact_plane(low[0] + 0.5 * dx, low[1] + 0.5 * dy, dx, dy, ni, nj)
}

/// Newest sample of each input, with its grid.
#[derive(Clone, Debug, Default)]
pub(super) struct RecordedInputs(Vec<RecordedInput>);

/// Newest sample of an input; without values if there is none.
#[derive(Clone, Debug)]
struct RecordedInput {
    field: String,
    service: String,
    grid: Grid,
    values: Option<Vec<f64>>,
}

impl RecordedInputs {
    /// Reads the inputs of the participant of this role.
    ///
    /// # Errors
    /// The recording cannot be read, or no participant in it has the role.
    pub(super) fn read(path: &Path, role: &str) -> Result<Self, RunError> {
        let mut recording = recording_file::open(path)?;
        let participants = &recording.head().participants;
        let index = participants.iter().position(|p| p.role == role).ok_or_else(|| {
            RunError::Usage(format!("no participant in {} plays `{role}`", path.display()))
        })?;
        let mut recorded = Self::default();
        while let Some(entry) =
            recording.read().map_err(|error| recording_file::failed(path, &error))?
        {
            match entry.item {
                Item::Event(Event::Command { participant, command, body })
                    if usize::from(participant) == index
                        && command.kind == CommandKind::Connect as u32 =>
                {
                    recorded =
                        serde_json::from_slice::<Topics>(&body).map(Self::of).unwrap_or_default();
                }
                Item::Sample { service, values, .. } => recorded.take(service, values),
                _ => {}
            }
        }
        Ok(recorded)
    }

    fn of(topics: Topics) -> Self {
        let input = |topic: contract::message::Topic| RecordedInput {
            field: topic.field,
            service: topic.service,
            grid: topic.grid,
            values: None,
        };
        Self(topics.inputs.into_iter().map(input).collect())
    }

    fn take(&mut self, service: &str, values: &[f64]) {
        for input in self.0.iter_mut().filter(|input| input.service == service) {
            input.values = Some(values.to_vec());
        }
    }

    /// Returns grid and values of a field.
    pub(super) fn field(&self, name: &str) -> Option<(&Grid, &[f64])> {
        let input = self.0.iter().find(|input| input.field == name)?;
        Some((&input.grid, input.values.as_deref()?))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use contract::field::{FRICTION_POWER, TRACTION};

    fn source(kind: FieldKind) -> InputSource {
        InputSource { kind, magnitude: 2.0, recorded: None }
    }

    #[test]
    fn made_up_fields_are_positive_and_differ_in_every_value() {
        let power = source(FRICTION_POWER.kind());
        let on = default_grid(&power.kind);
        let (first, second) = (power.values(&on, 0), power.values(&on, 1));
        assert_eq!(first.len(), 24 * 16);
        assert!(first.iter().all(|value| *value >= 0.1 && *value <= 2.0));
        assert!(first.iter().zip(&second).all(|(a, b)| a < b));
        assert_eq!(source(TRACTION.kind()).values(&on, 0).len(), 2 * 24 * 16);
        let speeds = source(SURFACE_SPEED.kind());
        assert_eq!(speeds.values(&default_grid(&speeds.kind), 0), [2.0, 2.0]);
    }

    /// Area and centre of the patch stay the same, within rounding.
    #[test]
    fn a_resized_grid_covers_the_same_patch() {
        let old = default_grid(&FRICTION_POWER.kind());
        let new = resized(&old, [7, 50]).unwrap();
        let measure = |grid: &Grid| {
            let ones = vec![1.0; grid.points()];
            let x: Vec<f64> = (0..grid.points()).map(|n| 1.0 + grid.centre(n)[0]).collect();
            (grid.integrate(&ones), grid.integrate(&x))
        };
        let ((area, moment), (area_before, moment_before)) = (measure(&new), measure(&old));
        assert!((area / area_before - 1.0).abs() < 1e-13);
        assert!((moment / moment_before - 1.0).abs() < 1e-13);
        assert_eq!(resized(&default_grid(&SURFACE_SPEED.kind()), [7, 50]), None);
    }

    #[test]
    fn recorded_values_are_used_where_they_fit() {
        let mut power = source(FRICTION_POWER.kind());
        let on = Grid::structured("given", patch([0.0; 2], [1.0; 2], [2, 1]));
        power.recorded = Some(vec![4.0, 8.0]);
        assert_eq!(power.values(&on, 0), [4.0, 8.0]);
        assert_eq!(power.values(&on, 1), [5.0, 10.0]);
        assert_eq!(power.values(&default_grid(&power.kind), 0).len(), 24 * 16);
    }
}
