//! The grid over the rails' surfaces that holds the patches of all rows.
//!
//! Along x and along the tape of one rail it is that of [`wheel_rail::developed`]. Both rails lie on it side by side, each on a lane of its own: y is the tape distance
//! of the left rail plus a shift, and that of the right one less the same shift, by which [`APART`] lies free between the lanes.

use super::case::{Case, Position};
use super::interface::FrictionInterface;
use crate::terms::Place;
use proto::configuration::{Configuration, Refusal};
use proto::grid::Structured;
use proto::model::StepError;
use wheel_rail::balance::{Balanced, Given};
use wheel_rail::developed::Developed;
use wheel_rail::patch::Patch;
use wheel_rail::rail::Side;
use wheel_rail::settings::{Normal, PatchSurface};

/// How much larger elements are by which the patches of a history are looked for.
const COARSER: f64 = 3.0;
/// Free elements round the patches, of those that they were looked for with.
const MARGIN: usize = 2;
/// The same where a patch may jump from element to element, and with it the force.
const MARGIN_OF_JUMPS: usize = 5;
/// The same of patches on curved surfaces, which are looked for in planes.
const MARGIN_OF_CURVED: usize = 8;
/// Between the lanes of both rails [m]: farther than heat goes while it matters.
const APART: f64 = 5e-3;

/// Elements by their numbers along x and along the tape; element (0, 0) is at the origin.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Plane {
    /// First column, and the one behind the last.
    columns: [i64; 2],
    /// The rails on which there are patches, from left to right.
    lanes: Vec<Lane>,
    sides: [f64; 2],
    /// Elements of the patches of a position, at most and about.
    pub(super) elements: f64,
    /// Half length and half width of the patch that carries most [m].
    semi_axes: [f64; 2],
    /// The highest pressure of all patches [Pa].
    pressure: Peak,
    /// The highest friction power of all patches [W/m²].
    power: Peak,
}

/// The largest value of a field over all patches, and where it is.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Peak {
    value: f64,
    side: Side,
    /// Along the tape of the rail on that side [m].
    y: f64,
}

impl Peak {
    fn higher(self, other: Self) -> Self {
        if other.value > self.value { other } else { self }
    }

    /// The largest of these values of a patch on a rail.
    fn of(values: &[f64], patch: &Patch, side: Side) -> Self {
        let fields = &patch.fields;
        let highest = values.iter().enumerate().max_by(|a, b| a.1.total_cmp(b.1));
        let (at, value) = highest.map_or((0, 0.0), |(at, value)| (at, *value));
        let row = fields.first[1] + (at / fields.counts[0].max(1)) as i64;
        Self { value, side, y: row as f64 * fields.sides[1] }
    }

    /// The largest of all patches on a rail; zero without patches.
    fn of_all(patches: &[Patch], side: Side, values: impl Fn(&Patch) -> &[f64]) -> Self {
        let none = Self { value: 0.0, side, y: 0.0 };
        patches.iter().map(|patch| Self::of(values(patch), patch, side)).fold(none, Self::higher)
    }
}

/// Half length and half width of what is in contact [m].
fn half_sizes(patch: &Patch) -> [f64; 2] {
    let fields = &patch.fields;
    let mut ranges = [[usize::MAX, 0]; 2];
    for (at, _) in fields.pressure.iter().enumerate().filter(|(_, p)| **p > 0.0) {
        for (range, place) in ranges.iter_mut().zip([at % fields.counts[0], at / fields.counts[0]])
        {
            *range = [range[0].min(place), range[1].max(place)];
        }
    }
    [0, 1].map(|k| {
        let [first, last] = ranges[k];
        0.5 * (last + 1).saturating_sub(first) as f64 * fields.sides[k]
    })
}

/// The rows of a rail.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Lane {
    side: Side,
    /// First row along its tape, and the one behind the last.
    rows: [i64; 2],
    /// Rows by which it is shifted.
    shift: i64,
}

impl Plane {
    /// That of a configuration: of its position, or of all rows.
    ///
    /// # Errors
    /// No position has a contact.
    pub(super) fn of(configuration: &Configuration, case: &Case) -> Result<Self, Refusal> {
        let rows = configuration.histories.as_ref().map_or(1, |histories| histories.times.len());
        let coarser = if rows > 1 { COARSER } else { 1.0 };
        let margin = match (case.settings.normal, case.settings.patch_surface) {
            (Normal::HalfSpace, PatchSurface::Plane) => MARGIN,
            (Normal::HalfSpace, PatchSurface::Curved) => MARGIN_OF_CURVED,
            (Normal::Kpec | Normal::Analyn, _) => MARGIN_OF_JUMPS,
        };
        let mut wheelset = case.wheelset_on_track(coarser, PatchSurface::Plane)?;
        let mut params = configuration.case.clone();
        let (mut found, mut failed): (Option<Self>, _) = (None, None);
        for row in 0..rows {
            if let Some(histories) = &configuration.histories {
                histories.put_row(&mut params, row);
            }
            let position = case.position(&params)?;
            let Position { motion, deviation, given, .. } = &position;
            let between = FrictionInterface { case, position: &position, solving: None };
            // Patches hardly move with the angular velocity that a torque finds.
            let given = Given { torque: None, ..*given };
            match wheelset.solve(motion, deviation, &given, &between) {
                Ok(balanced) => {
                    if let Some(own) = Self::around(&balanced, coarser, margin) {
                        found = Some(found.map_or(own.clone(), |other| other.and(&own)));
                    }
                }
                Err(error) => failed = Some(error),
            }
        }
        let plane = found.ok_or_else(|| {
            let apart = || "the bodies do not touch".to_owned();
            let reason = failed.map_or_else(apart, |error| error.to_string());
            let fix = "check the dimensions of track and wheelset, and the load";
            Refusal::new("wheelset", reason, fix)
        })?;
        Ok(Self { sides: case.settings.sides, ..plane }.shifted())
    }

    /// Round patches of elements so many times larger; `None` without any.
    fn around(balanced: &Balanced, coarser: f64, margin: usize) -> Option<Self> {
        let finer = |at: i64| (coarser * at as f64).round() as i64;
        let of = |patch: &Patch| (patch.fields.counts[0] * patch.fields.counts[1]) as f64;
        let load = |patch: &&Patch| patch.load.force[2];
        let mut found: Option<Self> = None;
        for (side, solved) in &balanced.wheels {
            let patches = &solved.patches;
            let Developed { first, counts, .. } = Developed::of(patches, margin);
            if counts[0] == 0 {
                continue;
            }
            let [columns, rows] =
                [0, 1].map(|k| [finer(first[k]), finer(first[k] + counts[k] as i64)]);
            let most = patches.iter().max_by(|a, b| load(a).total_cmp(&load(b)));
            let own = Self {
                columns,
                lanes: vec![Lane { side: *side, rows, shift: 0 }],
                sides: [0.0; 2],
                elements: coarser * coarser * patches.iter().map(of).sum::<f64>(),
                semi_axes: most.map_or([0.0; 2], half_sizes),
                pressure: Peak::of_all(patches, *side, |patch| &patch.fields.pressure),
                power: Peak::of_all(patches, *side, |patch| &patch.fields.friction_power),
            };
            found = Some(found.map_or(own.clone(), |other| {
                let elements = own.elements + other.elements;
                Self { elements, ..other.and(&own) }
            }));
        }
        found
    }

    fn and(&self, other: &Self) -> Self {
        let both = |one: [i64; 2], other: [i64; 2]| [one[0].min(other[0]), one[1].max(other[1])];
        let of = |side| {
            let rows = |plane: &Self| Some(plane.lane(side)?.rows);
            let rows = match (rows(self), rows(other)) {
                (Some(one), Some(other)) => both(one, other),
                (one, other) => one.or(other)?,
            };
            Some(Lane { side, rows, shift: 0 })
        };
        Self {
            columns: both(self.columns, other.columns),
            lanes: [Side::Left, Side::Right].into_iter().filter_map(of).collect(),
            sides: self.sides,
            elements: self.elements.max(other.elements),
            semi_axes: [0, 1].map(|k| self.semi_axes[k].max(other.semi_axes[k])),
            pressure: self.pressure.higher(other.pressure),
            power: self.power.higher(other.power),
        }
    }

    /// Its lanes side by side.
    fn shifted(mut self) -> Self {
        if let [left, right] = self.lanes.as_mut_slice() {
            let between = (APART / self.sides[1]).ceil() as i64;
            let overlap = right.rows[1] + between - left.rows[0];
            let shift = ((overlap + 1) / 2).max(0);
            (left.shift, right.shift) = (shift, -shift);
        }
        self
    }

    fn lane(&self, side: Side) -> Option<&Lane> {
        self.lanes.iter().find(|lane| lane.side == side)
    }

    /// y on the grid less the tape distance of a rail [m].
    pub(super) fn shift(&self, side: Side) -> f64 {
        self.lane(side).map_or(0.0, |lane| lane.shift as f64 * self.sides[1])
    }

    /// Where stresses are looked for, of one rail.
    pub(super) fn place(&self) -> Place {
        Place { grid: self.grid(), semi_axes: self.semi_axes, peak_y: self.pressure.y }
    }

    /// y on the grid of the highest friction power, of the patch that has it [m]; `None` without any.
    pub(super) fn hottest_y(&self) -> Option<f64> {
        let Peak { value, side, y } = self.power;
        (value > 0.0).then(|| y + self.shift(side))
    }

    /// First element on the grid.
    fn first(&self) -> [i64; 2] {
        let rows = self.lanes.iter().map(|lane| lane.rows[0] + lane.shift);
        [self.columns[0], rows.min().unwrap_or(0)]
    }

    fn counts(&self) -> [usize; 2] {
        let [_, first] = self.first();
        let rows = self.lanes.iter().map(|lane| lane.rows[1] + lane.shift - first);
        [self.columns[1] - self.columns[0], rows.max().unwrap_or(0)]
            .map(|count| usize::try_from(count).unwrap_or(0))
    }

    /// The grid of the fields.
    pub(super) fn grid(&self) -> Structured {
        let ([dx, dy], [ni, nj]) = (self.sides, self.counts());
        let first = self.first();
        let [x0, y0] = [0, 1].map(|k| first[k] as f64 * self.sides[k]);
        Structured::contact_plane(x0, y0, dx, dy, ni, nj)
    }

    /// The fields of patches on it.
    ///
    /// # Errors
    /// A patch reaches beyond it.
    pub(super) fn fields(&self, balanced: &Balanced) -> Result<Developed, StepError> {
        let mut fields = Developed::empty(self.first(), self.counts());
        for (side, solved) in
            balanced.wheels.iter().filter(|(_, solved)| !solved.patches.is_empty())
        {
            let Developed { first, counts, .. } = Developed::of(&solved.patches, 0);
            let inside = |k: usize, [from, end]: [i64; 2]| {
                first[k] >= from && first[k] + counts[k] as i64 <= end
            };
            match self.lane(*side) {
                Some(lane) if inside(0, self.columns) && inside(1, lane.rows) => {
                    fields.take(&solved.patches, lane.shift);
                }
                _ => {
                    let reason =
                        "a patch reaches beyond the grid that was laid for the rows of the history";
                    return Err(StepError::NoSolution(reason.to_owned()));
                }
            }
        }
        Ok(fields)
    }
}
