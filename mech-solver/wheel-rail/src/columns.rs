//! Nearest places of a wheel that is not round or a rail that varies, found in cuts across the
//! rail.
//!
//! A rail with the same profile everywhere is a prism, and the silhouette of the wheel tells where
//! they touch ([`super::silhouette`]). If the rail is not a prism, or the wheel not a surface of
//! revolution, both are cut at columns of the same x. With the track's x-axis c in wheelset axes,
//! the angle θ forwards from the lowest point and the radius r at the mark θ + pitch, a circle of
//! the wheel's profile meets the column where c_y y + c_x r sin θ = x. The gap of a row at a column
//! is the height of the wheel above the rail along the normal of the row ([`super::gap`]).
//!
//! *Columns.* Coarse columns, [`COARSE`] apart over the range in which a wheel may touch, tell how
//! far the wheel must be lowered to touch at each. Fine columns, [`FINE`] apart, are laid where the
//! wheel would touch at the depth of interest. A penetration between two neighbouring columns is
//! missed: rail and wheel must be smooth over 2 mm.

use super::gap::{Gap, OPEN, lowest};
use super::rail::Rail;
use super::rows::{Intersection, Rows, least_above};
use super::wheelset::{Motion, Pose, Wheel};
use nalgebra::Vector3;

/// Spacing of the coarse columns that locate the contact, and of the fine ones where gaps are
/// measured [m].
const COARSE: f64 = 4e-3;
const FINE: f64 = 1e-3;
/// Range ahead and behind in which a wheel may touch, relative to its radius.
const REACH: f64 = 0.2;
/// Spacing of profile points in coarse and in fine columns [m].
const STEPS: [f64; 2] = [1e-3, 2e-4];
/// Least depth below touching for which columns are laid [m].
const DEPTH: f64 = 5e-4;
/// Iterations that find the angle of a point.
const ROUNDS: usize = 4;

/// A cut across wheel and rail.
#[derive(Clone, Debug)]
struct Column {
    x: f64,
    /// Points of the wheel, y and z from the middle of the wheelset [m].
    wheel: Vec<[f64; 2]>,
    /// Points of the rail [m]; empty if the rail is a prism.
    rail: Vec<[f64; 2]>,
}

/// Wheel and rail at a position, cut across the rail.
#[derive(Clone, Debug, Default)]
pub struct Columns {
    columns: Vec<Column>,
    /// Distance by which the wheel must be lowered from z = 0 of its middle until it touches [m].
    touching: Option<f64>,
    /// Position of the first touch along the track [m].
    first: f64,
    /// Depth below touching for which columns are laid [m].
    depth: f64,
    /// Scratch buffers: intersections of rows with a curve, and the gaps of all columns, row by
    /// row.
    met: [Vec<Option<Intersection>>; 2],
    gaps: Vec<f64>,
}

/// Rail and wheel, and their positions.
#[derive(Clone, Copy, Debug)]
pub struct PlacedProfile<'a> {
    /// Rail.
    pub rail: &'a Rail,
    /// Rows of the rail.
    pub rows: &'a Rows,
    /// Wheel.
    pub wheel: &'a Wheel,
    /// Position and orientation of the wheelset; its height does not matter.
    pub pose: &'a Pose,
    /// Motion of the wheelset.
    pub motion: &'a Motion,
}

impl Columns {
    /// Cuts the bodies at a new position.
    pub fn go_to(&mut self, bodies: &PlacedProfile<'_>) {
        self.lay(bodies, DEPTH);
    }

    /// Lays more columns if the wheel, with its middle at this height [m], is deeper than the
    /// present columns allow for.
    pub fn deepen(&mut self, bodies: &PlacedProfile<'_>, height: f64) {
        let depth = self.touching.map_or(0.0, |touching| -height - touching);
        if depth > self.depth {
            self.lay(bodies, 2.0 * depth);
        }
    }

    /// Distance by which a wheel with its middle at this height must be lowered until it touches
    /// [m]. Negative if the wheel penetrates already; `None` if it is beside the rail.
    #[must_use]
    pub fn clearance(&self, height: f64) -> Option<f64> {
        Some(self.touching? + height)
    }

    /// Position along the track at which a lowered wheel touches first [m].
    #[must_use]
    pub fn first_touch(&self) -> f64 {
        self.first
    }

    /// Computes the gaps of all rows with the middle of the wheelset at (y, z).
    pub(super) fn gaps(&mut self, rows: &Rows, middle: [f64; 2], found: &mut Vec<Gap>) {
        let (count, wide) = (rows.rows.len(), self.columns.len());
        self.gaps.clear();
        self.gaps.resize(count * wide, f64::INFINITY);
        let [met, met_rail] = &mut self.met;
        for (i, column) in self.columns.iter().enumerate() {
            let wheel = |k: usize| [0, 1].map(|part| column.wheel[k][part] + middle[part]);
            rows.meet(column.wheel.len(), &wheel, met);
            if column.rail.is_empty() {
                met_rail.clear();
            } else {
                rows.meet(column.rail.len(), &|k: usize| column.rail[k], met_rail);
            }
            for (j, met) in met.iter().enumerate() {
                let rail = match met_rail.get(j) {
                    None => Some(0.0),
                    Some(met) => met.map(|met| met.height),
                };
                if let (Some(met), Some(rail)) = (met, rail) {
                    self.gaps[j * wide + i] = met.height - rail;
                }
            }
        }
        let first = self.columns.first().map_or(0.0, |column| column.x);
        found.clear();
        match wide {
            0 => found.resize(count, OPEN),
            _ => found.extend(self.gaps.chunks_exact(wide).map(|row| Gap::along(first, FINE, row))),
        }
    }

    /// Lays columns wherever the wheel touches at this depth below first touch [m].
    fn lay(&mut self, bodies: &PlacedProfile<'_>, depth: f64) {
        let reach = REACH * bodies.wheel.origin[1].abs();
        let far = (reach / COARSE).ceil() as i64;
        let coarse = (-far..=far).map(|k| Column::cut(bodies, COARSE * k as f64, STEPS[0]));
        let clear: Vec<(f64, Option<f64>)> =
            coarse.map(|column| (column.x, column.clearance(bodies))).collect();
        let least = clear.iter().filter_map(|(_, clear)| *clear).fold(f64::INFINITY, f64::min);
        (self.depth, self.touching) = (depth, None);
        self.columns.clear();
        let near = |clear: &Option<f64>| clear.is_some_and(|clear| clear <= least + depth);
        let mut near = clear.iter().filter(|(_, clear)| near(clear)).map(|(x, _)| *x);
        let Some(from) = near.next() else { return };
        let to = near.next_back().unwrap_or(from);
        let [from, to] = [(from - COARSE) / FINE, (to + COARSE) / FINE].map(|at| at.round() as i64);
        self.columns.extend((from..=to).map(|k| Column::cut(bodies, FINE * k as f64, STEPS[1])));
        let clear = |column: &Column| column.clearance(bodies).unwrap_or(f64::INFINITY);
        let clear: Vec<f64> = self.columns.iter().map(clear).collect();
        let touching = lowest(FINE * from as f64, FINE, &clear);
        self.touching = touching.map(|[_, clear]| clear);
        self.first = touching.map_or(0.0, |[x, _]| x);
    }
}

impl Column {
    /// Cuts the bodies at x, at profile points about `step` apart [m].
    fn cut(bodies: &PlacedProfile<'_>, x: f64, step: f64) -> Self {
        let PlacedProfile { rail, wheel, pose, motion, .. } = bodies;
        let forward = pose.rotation.matrix().row(0).transpose();
        let places = |[from, to]: [f64; 2]| {
            let count = ((to - from) / step).ceil() as usize;
            (0..=count).map(move |k| from + (to - from) * k as f64 / count as f64)
        };
        let (mut near, mut angle) = (0, 0.0_f64);
        let on_wheel = |s: f64| {
            let mut found = None;
            for _ in 0..ROUNDS {
                let place = wheel.surface.place(angle + motion.pitch, s, &mut near);
                let [y, z] = place.position;
                let sine = (x - forward.y * y) / (-forward.x * z);
                if !(place.tangent[0] > 0.0 && z < 0.0 && sine.abs() < 1.0) {
                    return None;
                }
                angle = sine.asin();
                found = Some([y, z]);
            }
            let [y, z] = found?;
            let (sin, cos) = angle.sin_cos();
            let place = pose.rotation * Vector3::new(-z * sin, y, z * cos);
            Some([place.y, place.z])
        };
        let on_wheel = places(wheel.surface.range()).filter_map(on_wheel).collect();
        let mut near = 0;
        let on_rail = |s: f64| rail.surface.place(rail.way + x, s, &mut near).position;
        let on_rail = match rail.surface.constant() {
            Some(_) => Vec::new(),
            None => places(rail.surface.range()).map(on_rail).collect(),
        };
        Self { x, wheel: on_wheel, rail: on_rail }
    }

    /// Distance by which the wheel must be lowered from z = 0 of its middle until it touches in
    /// this column [m].
    fn clearance(&self, bodies: &PlacedProfile<'_>) -> Option<f64> {
        let shift = bodies.pose.middle.y;
        let wheel = |k: usize| [self.wheel[k][0] + shift, self.wheel[k][1]];
        match self.rail.is_empty() {
            true => least_above(bodies.rows.standing(), self.wheel.len(), &wheel),
            false => least_above(self.rising(), self.wheel.len(), &wheel),
        }
    }

    /// Points of the rail on which a wheel can stand.
    fn rising(&self) -> impl Iterator<Item = [f64; 2]> + '_ {
        let rises = |pair: &&[[f64; 2]]| pair[1][0] > pair[0][0];
        self.rail.windows(2).filter(rises).map(|pair| pair[0])
    }
}
