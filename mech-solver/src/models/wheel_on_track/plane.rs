//! Grid on the developed rail surfaces that holds the patches of all rows.
//!
//! Along x and along the tape of one rail it is the grid of [`wheel_rail::developed`]. Both rails
//! lie side by side, each on its own lane. y is the tape distance plus a shift for the left rail,
//! and minus the same shift for the right rail, such that a width of [`APART`] stays free between
//! the lanes.

use super::case::{Case, Position};
use super::interface::FrictionInterface;
use crate::terms::Place;
use proto::configuration::{Configuration, Refusal};
use proto::grid::Structured;
use proto::model::StepError;
use wheel_rail::balance::{WheelsetLoads, WheelsetSolution};
use wheel_rail::developed::Developed;
use wheel_rail::patch::Patch;
use wheel_rail::rail::Side;
use wheel_rail::settings::{Normal, PatchSurface};

/// Coarsening factor of the elements in the search for the patches of a history.
const COARSER: f64 = 3.0;
/// Free elements around the patches, counted in elements of the search grid.
const MARGIN: usize = 2;
/// Free elements if a patch, and with it the force, may jump from element to element.
const MARGIN_OF_JUMPS: usize = 5;
/// Free elements for patches on curved surfaces, which are searched in planes.
const MARGIN_OF_CURVED: usize = 8;
/// Width between the lanes of both rails [m], larger than the distance over which heat diffuses in
/// the relevant time.
const APART: f64 = 5e-3;

/// Grid with elements numbered along x and along the tape; element (0, 0) is at the origin.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Plane {
    /// First column, and the column after the last.
    columns: [i64; 2],
    /// Lanes of the rails that have patches.
    lanes: Vec<Lane>,
    sides: [f64; 2],
    /// Approximate largest number of elements of the patches in any position.
    pub(super) elements: f64,
    /// Half length and half width of the patch with the largest load [m].
    semi_axes: [f64; 2],
    /// Peak of the pressure over all patches [Pa].
    pressure: Peak,
    /// Peak of the friction power over all patches [W/m²].
    power: Peak,
}

/// Largest value of a field over all patches, and its position.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Peak {
    value: f64,
    side: Side,
    /// Tape distance on the rail of that side [m].
    y: f64,
}

impl Peak {
    fn higher(self, other: Self) -> Self {
        if other.value > self.value { other } else { self }
    }

    /// Finds the largest of these values of a patch on a rail.
    fn of(values: &[f64], patch: &Patch, side: Side) -> Self {
        let fields = &patch.fields;
        let highest = values.iter().enumerate().max_by(|a, b| a.1.total_cmp(b.1));
        let (at, value) = highest.map_or((0, 0.0), |(at, value)| (at, *value));
        let row = fields.first[1] + (at / fields.counts[0].max(1)) as i64;
        Self { value, side, y: row as f64 * fields.sides[1] }
    }

    /// Finds the largest value over all patches on a rail; zero without patches.
    fn of_all(patches: &[Patch], side: Side, values: impl Fn(&Patch) -> &[f64]) -> Self {
        let none = Self { value: 0.0, side, y: 0.0 };
        patches.iter().map(|patch| Self::of(values(patch), patch, side)).fold(none, Self::higher)
    }
}

/// Half length and half width of the elements in contact [m].
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

/// Rows of the grid that belong to a rail.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Lane {
    side: Side,
    /// First row along the tape, and the row after the last.
    rows: [i64; 2],
    /// Number of rows by which the lane is shifted.
    shift: i64,
}

impl Plane {
    /// Finds the grid that holds the patches of all rows, or of the single position of a case
    /// without histories.
    ///
    /// # Errors
    /// Positions without any contact.
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
            // Patches hardly depend on the angular velocity that follows from a torque.
            let given = WheelsetLoads { torque: None, ..*given };
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

    /// Returns the grid around patches whose elements are `coarser` times larger; `None` without
    /// patches.
    fn around(balanced: &WheelsetSolution, coarser: f64, margin: usize) -> Option<Self> {
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

    /// Shifts the lanes so that they lie side by side.
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

    /// Difference between y on the grid and the tape distance of a rail [m].
    pub(super) fn shift(&self, side: Side) -> f64 {
        self.lane(side).map_or(0.0, |lane| lane.shift as f64 * self.sides[1])
    }

    /// Region in which stresses are evaluated, for a single rail.
    pub(super) fn place(&self) -> Place {
        Place { grid: self.grid(), semi_axes: self.semi_axes, peak_y: self.pressure.y }
    }

    /// y on the grid of the highest friction power [m]; `None` without friction power.
    pub(super) fn hottest_y(&self) -> Option<f64> {
        let Peak { value, side, y } = self.power;
        (value > 0.0).then(|| y + self.shift(side))
    }

    /// First element of the grid.
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

    /// Grid of the fields.
    pub(super) fn grid(&self) -> Structured {
        let ([dx, dy], [ni, nj]) = (self.sides, self.counts());
        let first = self.first();
        let [x0, y0] = [0, 1].map(|k| first[k] as f64 * self.sides[k]);
        Structured::contact_plane(x0, y0, dx, dy, ni, nj)
    }

    /// Returns the fields of the patches on this grid.
    ///
    /// # Errors
    /// A patch that reaches beyond the grid.
    pub(super) fn fields(&self, balanced: &WheelsetSolution) -> Result<Developed, StepError> {
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
                    let reason = "a patch reaches beyond the grid made for the rows of the history";
                    return Err(StepError::NoSolution(reason.to_owned()));
                }
            }
        }
        Ok(fields)
    }
}
