//! A patch in its own plane: its axes, and the undeformed distance of the bodies along its normal.
//!
//! **Axes of a patch**: x along the track, the tangent t = (0, cos α, sin α) to the left, the
//! normal n = (0, −sin α, cos α) up into the wheel, with the angle α of the patch. The plane of x
//! and t goes through the point P of the rail, the reference of the search. The origin O is the
//! point of the plane with the tape distance j₀ Δs and x = i₀ Δx, where i₀ and j₀ are the whole
//! numbers nearest to P. The elements of all patches therefore belong to one grid over x and the
//! tape distance. Element (i, j) is at (i Δx, j Δs), and in the plane at (x − x_P, s − s_P) from P.
//! Over a patch that turns by ±γ the tape is longer than the plane by γ²/6.
//!
//! **Undeformed distance** of element (x, t): h = n_w − n_r, where the line O + x e_x + t t + n n
//! meets the rail at n_r and the wheel at n_w. On the rail, with its outline r(s), (r(s) −
//! O)·t = t. On the wheel, with q = Rᵀ(· − M) in wheelset axes and the outline (y_w(s), −r_w(s)),
//!
//! q_y(n) = y_w(s) and √(q_x² + q_z²) = r_w(s).
//!
//! Newton's method solves these two equations for n and s, starting from the neighbouring element.
//! Yaw and roll are exact. In a row every fourth column is solved. Cubics interpolate between
//! these; on a circle of the radius R their error is below (4Δx)⁴/8R³. Beyond the end of a profile
//! there is no body, and the distance is [`NOTHING`].

use super::outline::Outline;
use super::rail::Rail;
use super::region::Region;
use super::wheelset::{Pose, Wheel};
use nalgebra::Vector3;

/// Distance where one of the bodies is missing [m].
pub const NOTHING: f64 = 1.0;
/// Residual at the level of rounding [m].
pub(super) const EXACT: f64 = 1e-14;
/// Most Newton steps.
pub(super) const STEPS: usize = 12;
/// Every EVERY-th column is solved: along the rail a round wheel is as smooth as a circle.
const EVERY: usize = 4;
/// Cosine of the steepest surface that is resolved in a plane.
pub(super) const STEEPEST: f64 = 0.05;

/// Axes of a patch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// i₀ and j₀ of the origin.
    pub element: [i64; 2],
    /// Origin in track axes [m].
    pub origin: Vector3<f64>,
    /// Reference point on the rail, in track axes [m].
    pub reference: Vector3<f64>,
    /// Angle from the y-axis to the tangent [rad].
    pub angle: f64,
}

/// Elements of a patch: rectangles of the grid around the origin of its frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Window {
    /// Elements on either side of the origin, along x and along the tape.
    pub half: [usize; 2],
    /// Sides of an element [m].
    pub sides: [f64; 2],
}

impl Frame {
    /// Creates the axes at the reference of a region; `sides` are those of the elements [m].
    #[must_use]
    pub fn at(region: &Region, rail: &Rail, sides: [f64; 2]) -> Self {
        let element = [region.x / sides[0], region.s / sides[1]].map(|at| at.round() as i64);
        let [y, z] = rail.outline.at(region.s).position;
        let reference = Vector3::new(region.x, y, z);
        let (sin, cos) = region.angle.sin_cos();
        let back = element[1] as f64 * sides[1] - region.s;
        let origin = Vector3::new(element[0] as f64 * sides[0], y + back * cos, z + back * sin);
        Self { element, origin, reference, angle: region.angle }
    }

    /// Unit vectors e_x, t and n in track axes.
    #[must_use]
    pub fn axes(&self) -> [Vector3<f64>; 3] {
        let (sin, cos) = self.angle.sin_cos();
        [Vector3::x(), Vector3::new(0.0, cos, sin), Vector3::new(0.0, -sin, cos)]
    }

    /// Converts components along these axes to a vector in track axes.
    #[must_use]
    pub fn track_axes(&self, components: [f64; 3]) -> Vector3<f64> {
        let axes = self.axes();
        (0..3).map(|k| axes[k] * components[k]).sum()
    }
}

impl Window {
    /// Number of elements along x and along the tape.
    #[must_use]
    pub fn counts(&self) -> [usize; 2] {
        self.half.map(|half| 2 * half + 1)
    }

    /// Number of elements.
    #[must_use]
    pub fn points(&self) -> usize {
        let [nx, ny] = self.counts();
        nx * ny
    }

    /// Coordinate of a column or a row in the plane [m].
    #[must_use]
    pub fn along(&self, axis: usize, at: usize) -> f64 {
        (at as f64 - self.half[axis] as f64) * self.sides[axis]
    }
}

/// Returns the undeformed distance of the elements of a window [m], and the height of the rail over
/// the plane in every row [m], zero in a row without rail.
#[must_use]
pub fn undeformed_distance(
    frame: &Frame,
    window: &Window,
    (rail, wheel, pose): (&Rail, &Wheel, &Pose),
) -> [Vec<f64>; 2] {
    let [nx, ny] = window.counts();
    let (mut distance, mut heights) = (vec![NOTHING; nx * ny], vec![0.0; ny]);
    let mut surface = WheelSurface::new(frame, wheel, pose);
    let start = surface.start();
    for rows in outwards(window) {
        let mut guess = start;
        for_rail(frame, window, &rail.outline, rows, |j, height| {
            heights[j] = height;
            let row = &mut distance[j * nx..(j + 1) * nx];
            surface.row(window, window.along(1, j), height, &mut guess, row);
        });
    }
    [distance, heights]
}

/// Three distances of a row of a window.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct RowDistances {
    /// x of the middle distance, and the spacing of the three [m].
    pub(super) middle: f64,
    pub(super) reach: f64,
    /// Distances behind, in the middle and ahead [m].
    pub(super) distances: [f64; 3],
}

impl RowDistances {
    /// Parabola through the three distances, h = g + A (x − x₀)²: g and x₀ [m], and A [1/m]; `None`
    /// without a minimum.
    pub(super) fn parabola(&self) -> Option<[f64; 3]> {
        let [behind, middle, ahead] = self.distances;
        let slope = (ahead - behind) / (2.0 * self.reach);
        let bend = (ahead - 2.0 * middle + behind) / (2.0 * self.reach * self.reach);
        let off = -slope / (2.0 * bend);
        (bend > 0.0).then_some([middle + 0.5 * slope * off, self.middle + off, bend])
    }
}

/// Three undeformed distances of every row of a window around its minimum, spaced by half of the
/// window's half length; `None` where a body is missing. The second value is the height of the rail
/// as in [`undeformed_distance`].
pub(super) fn three_distances(
    frame: &Frame,
    window: &Window,
    (rail, wheel, pose): (&Rail, &Wheel, &Pose),
) -> (Vec<Option<RowDistances>>, Vec<f64>) {
    let [_, ny] = window.counts();
    let (mut three, mut heights) = (vec![None; ny], vec![0.0; ny]);
    let mut surface = WheelSurface::new(frame, wheel, pose);
    let start = surface.start();
    let reach = 0.5 * window.half[0] as f64 * window.sides[0];
    for rows in outwards(window) {
        let (mut guess, mut middle) = (start, 0.0);
        for_rail(frame, window, &rail.outline, rows, |j, height| {
            heights[j] = height;
            let along = window.along(1, j);
            let found = surface.three([middle, along], reach, height, &mut guess);
            three[j] = found;
            if let Some([_, place, _]) = found.and_then(|found| found.parabola()) {
                middle = place;
            }
        });
    }
    (three, heights)
}

/// Rows of a window from the middle outwards to either side, so that every row starts from its
/// neighbour.
fn outwards(window: &Window) -> [Box<dyn Iterator<Item = usize>>; 2] {
    let (middle, end) = (window.half[1], window.counts()[1]);
    [Box::new(middle..end), Box::new((0..middle).rev())]
}

/// Visits every row with a rail, and passes the rail's height over the plane.
fn for_rail(
    frame: &Frame,
    window: &Window,
    rail: &Outline,
    rows: impl Iterator<Item = usize>,
    mut visit: impl FnMut(usize, f64),
) {
    let mut tape = frame.element[1] as f64 * window.sides[1];
    for j in rows {
        if let Some(height) = rail_height(frame, rail, window.along(1, j), &mut tape) {
            visit(j, height);
        }
    }
}

/// Height of the rail above the plane at t [m]. `s` is the starting value of the tape distance and
/// receives the solution.
fn rail_height(frame: &Frame, rail: &Outline, along: f64, s: &mut f64) -> Option<f64> {
    let (sin, cos) = frame.angle.sin_cos();
    let [from, to] = rail.range();
    for _ in 0..STEPS {
        let place = rail.at(*s);
        let [y, z] = [place.position[0] - frame.origin.y, place.position[1] - frame.origin.z];
        let slope = place.tangent[0] * cos + place.tangent[1] * sin;
        let off = along - (y * cos + z * sin);
        if slope < STEEPEST {
            return None;
        }
        if off.abs() < EXACT {
            return (from..=to).contains(s).then_some(z * cos - y * sin);
        }
        *s += off / slope;
    }
    None
}

/// Place where the normal through the origin of a frame meets the wheel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct WheelAbove {
    /// s on the wheel's profile [m].
    pub(super) s: f64,
    /// Tape distance of the frame's element [m].
    tape: f64,
    /// Unit vector from the axle to the point, in wheelset axes.
    radial: Vector3<f64>,
    /// Inclination of the surface across the track, from the y-axis [rad].
    pub(super) angle: f64,
}

/// Place where the normal through the origin of a frame meets the wheel; `None` if it misses the
/// wheel.
pub(super) fn wheel_above(
    frame: &Frame,
    (wheel, pose): (&Wheel, &Pose),
    sides: [f64; 2],
) -> Option<WheelAbove> {
    let mut surface = WheelSurface::new(frame, wheel, pose);
    let Guess { height, s } = surface.meet(surface.origin, surface.start())?;
    let place = surface.origin + surface.axes[2] * height;
    let radial = Vector3::new(place.x, 0.0, place.z).normalize();
    let tape = frame.element[1] as f64 * sides[1];
    let mut above = WheelAbove { s, tape, radial, angle: 0.0 };
    above.angle = above.angle_at(tape, wheel, pose);
    Some(above)
}

impl WheelAbove {
    /// Inclination of the wheel's surface at a tape distance [m], counted along the profile from
    /// the point above the frame's origin [rad].
    pub(super) fn angle_at(&self, tape: f64, wheel: &Wheel, pose: &Pose) -> f64 {
        let [across, up] = wheel.outline.at(self.s + tape - self.tape).tangent;
        let tangent = pose.rotation * (Vector3::y() * across - self.radial * up);
        tangent.z.atan2(tangent.y)
    }
}

/// The wheel in the axes of a patch.
struct WheelSurface<'a> {
    outline: &'a Outline,
    range: [f64; 2],
    /// Origin of the plane, and e_x, t and n, in wheelset axes.
    origin: Vector3<f64>,
    axes: [Vector3<f64>; 3],
    near: usize,
    /// Distances of a row, from the middle to one side.
    heights: Vec<f64>,
}

/// Distance at a column, by a cubic through the four nearest solved columns; every [`EVERY`]th is
/// solved.
fn between(heights: &[f64], column: usize) -> f64 {
    let (left, part) = (column / EVERY, column % EVERY);
    let known = |at: usize| heights.get(at).copied().filter(|height| *height < NOTHING);
    if part == 0 {
        return known(left).unwrap_or(NOTHING);
    }
    let first = left.saturating_sub(1).min(heights.len().saturating_sub(4));
    let four = [0, 1, 2, 3].map(|k| known(first + k));
    let x = (column - first * EVERY) as f64 / EVERY as f64;
    match four {
        [Some(a), Some(b), Some(c), Some(d)] => {
            let [to_a, to_b, to_c, to_d] = [x, x - 1.0, x - 2.0, x - 3.0];
            let ends = to_b * to_c * (d * to_a - a * to_d) / 6.0;
            ends + to_a * to_d * (b * to_c - c * to_b) / 2.0
        }
        // Near an end of a profile.
        _ => match (known(left), known(left + 1)) {
            (Some(one), Some(next)) => one + (next - one) * part as f64 / EVERY as f64,
            _ => NOTHING,
        },
    }
}

/// Height above the plane, and s on the wheel's profile [m].
#[derive(Clone, Copy, Debug)]
struct Guess {
    height: f64,
    s: f64,
}

impl<'a> WheelSurface<'a> {
    fn new(frame: &Frame, wheel: &'a Wheel, pose: &Pose) -> Self {
        let axes = frame.axes().map(|axis| pose.rotation.inverse() * axis);
        let origin = pose.wheelset_axes(frame.origin);
        let range = wheel.outline.range();
        Self { outline: &wheel.outline, range, origin, axes, near: 0, heights: Vec::new() }
    }

    /// Starting values at the point of the profile nearest to the plane's origin.
    fn start(&self) -> Guess {
        let radius = self.origin.x.hypot(self.origin.z);
        let [from, to] = self.range;
        let places = (0..=400).map(|k| from + (to - from) * f64::from(k) / 400.0);
        let off = |s: &f64| {
            let [y, z] = self.outline.at(*s).position;
            (y - self.origin.y).hypot(z + radius)
        };
        let s = places.min_by(|a, b| off(a).total_cmp(&off(b))).unwrap_or(from);
        Guess { height: 0.0, s }
    }

    /// Distances of a row at t above a rail of this height, from the middle outwards. `guess`
    /// receives the solution in the middle.
    fn row(&mut self, window: &Window, along: f64, rail: f64, guess: &mut Guess, row: &mut [f64]) {
        let base = self.origin + self.axes[1] * along;
        let middle = window.half[0];
        let sections = (middle.div_ceil(EVERY) + 1).max(3);
        let mut first = *guess;
        for side in [1.0, -1.0] {
            self.heights.clear();
            let mut near = first;
            // Extrapolate the height with its first and second differences.
            let (mut change, mut bend) = (0.0, 0.0);
            for k in 0..=sections {
                let x = side * (EVERY * k) as f64 * window.sides[0];
                let guess = Guess { height: near.height + change + bend, s: near.s };
                let Some(found) = self.meet(base + self.axes[0] * x, guess) else { break };
                let last = std::mem::replace(&mut change, found.height - near.height);
                bend = if k > 1 { change - last } else { 0.0 };
                near = found;
                if k == 0 {
                    (first, change) = (near, 0.0);
                }
                let inside = (self.range[0]..=self.range[1]).contains(&near.s);
                self.heights.push(if inside { near.height - rail } else { NOTHING });
            }
            for i in 0..=middle {
                let at = if side > 0.0 { middle + i } else { middle - i };
                row[at] = between(&self.heights, i);
            }
        }
        *guess = first;
    }

    /// Distances around a point of the plane, above a rail of this height. `guess` receives the
    /// solution in the middle.
    fn three(
        &mut self,
        [middle, along]: [f64; 2],
        reach: f64,
        rail: f64,
        guess: &mut Guess,
    ) -> Option<RowDistances> {
        let base = self.origin + self.axes[1] * along;
        let own = self.meet(base + self.axes[0] * middle, *guess)?;
        *guess = own;
        let range = self.range[0]..=self.range[1];
        let mut distances = [own.height - rail; 3];
        for (side, distance) in [(-1.0, 0), (1.0, 2)] {
            let found = self.meet(base + self.axes[0] * (middle + side * reach), own)?;
            distances[distance] = found.height - rail;
        }
        range.contains(&own.s).then_some(RowDistances { middle, reach, distances })
    }

    /// Point where the normal through a point of the plane meets the wheel.
    fn meet(&mut self, at: Vector3<f64>, guess: Guess) -> Option<Guess> {
        let normal = self.axes[2];
        let Guess { mut height, mut s } = guess;
        for _ in 0..STEPS {
            let q = at + normal * height;
            let radius = (q.x * q.x + q.z * q.z).sqrt();
            let place = self.outline.at_near(s, &mut self.near);
            let off = [q.y - place.position[0], radius + place.position[1]];
            if off[0].abs() < EXACT && off[1].abs() < EXACT {
                return Some(Guess { height, s });
            }
            // d(off)/d(height) and −d(off)/ds.
            let by_height = [normal.y, (q.x * normal.x + q.z * normal.z) / radius];
            let by_s = [place.tangent[0], -place.tangent[1]];
            let determinant = by_height[1] * by_s[0] - by_height[0] * by_s[1];
            if determinant.abs() < STEEPEST {
                return None;
            }
            let (rise, run) = (
                (off[0] * by_s[1] - off[1] * by_s[0]) / determinant,
                (off[0] * by_height[1] - off[1] * by_height[0]) / determinant,
            );
            height += rise;
            s += run;
            if rise.abs() < EXACT && run.abs() < EXACT {
                return Some(Guess { height, s });
            }
        }
        None
    }
}
