//! Undeformed distance of a wheel that is not round, or a rail that varies, on the elements of a
//! patch.
//!
//! The distance is n_w − n_r along the normal of the patch, as in [`super::local`], but between the
//! true surfaces and at every column. The rail is met where O + x e_x + t t + n n lies on its
//! surface r(u, s), at the distance u along the rail:
//!
//! (r(u, s) − O)·t = t.
//!
//! On the wheel, q = Rᵀ(· − M) are wheelset axes, θ is the angle of q forwards from the lowest
//! point, and the surface is (y_w, −r_w) at the mark θ + pitch and s:
//!
//! q_y(n) = y_w(θ(n) + pitch, s) and √(q_x² + q_z²) = r_w(θ(n) + pitch, s).
//!
//! Newton's method solves these two equations for n and s, starting from the neighbouring element;
//! θ changes with n.
//!
//! The normal of the patch is perpendicular to x. On a rail that rises by the slope β the distance
//! is too large by 1/cos β: 0.5 % at 1:10.

use super::local::{EXACT, Frame, NOTHING, STEEPEST, STEPS, Window};
use super::rail::Rail;
use super::surface::Surface;
use super::wheelset::{Pose, Wheel};
use nalgebra::Vector3;

/// Change of an iterate below which it has converged where rounding is not reached, as at a kink
/// [m].
const SETTLED: f64 = 1e-9;

/// Returns the undeformed distance of the elements of a window [m], and for every row the height of
/// the rail over the plane at the least distance [m], zero in a row without rail. The wheel is
/// turned by `pitch` [rad].
#[must_use]
pub fn distance_of_surfaces(
    frame: &Frame,
    window: &Window,
    (rail, wheel, pose): (&Rail, &Wheel, &Pose),
    pitch: f64,
) -> [Vec<f64>; 2] {
    let [nx, ny] = window.counts();
    let (mut distance, mut heights) = (vec![NOTHING; nx * ny], vec![0.0; ny]);
    let mut rail = RailSurface { rail, frame, near: 0 };
    let mut wheel = WheelSurface::new(frame, wheel, pose, pitch);
    let start = wheel.start(rail.start());
    let middle = window.half[0];
    let mut sweep = |rows: &mut dyn Iterator<Item = usize>| {
        let mut first = start;
        for j in rows {
            let along = window.along(1, j);
            let mut least = NOTHING;
            let right: &mut dyn Iterator<Item = usize> = &mut (middle..nx);
            let left: &mut dyn Iterator<Item = usize> = &mut (0..middle).rev();
            let mut begin = first;
            for side in [right, left] {
                let mut guess = begin;
                for i in side {
                    let x = window.along(0, i);
                    let (Some(down), Some(up)) =
                        (rail.meet(x, along, &mut guess.rail), wheel.meet(x, along, &mut guess))
                    else {
                        continue;
                    };
                    if i == middle {
                        begin = guess;
                    }
                    let found = up - down;
                    distance[j * nx + i] = found;
                    if found < least {
                        (least, heights[j]) = (found, down);
                    }
                }
            }
            first = begin;
        }
    };
    sweep(&mut (window.half[1]..ny));
    sweep(&mut (0..window.half[1]).rev());
    [distance, heights]
}

/// Moves the reference of a frame from the rail's profile at the cut onto the rail at its own
/// position along the track. On a rail that rises the rolling radius differs.
#[must_use]
pub fn on_rail(frame: &Frame, rail: &Rail) -> Frame {
    let [_, tangent, up] = frame.axes();
    let from_origin = frame.reference - frame.origin;
    let mut surface = RailSurface { rail, frame, near: 0 };
    let mut s = surface.start();
    let height = surface.meet(from_origin.x, tangent.dot(&from_origin), &mut s);
    let shift = up * height.unwrap_or(0.0);
    Frame { origin: frame.origin + shift, reference: frame.reference + shift, ..*frame }
}

/// Starting values at an element: where the previous normal met the surfaces.
#[derive(Clone, Copy, Debug)]
struct Guess {
    /// s on the rail [m].
    rail: f64,
    /// s on the wheel, and the height of the wheel over the plane [m].
    wheel: f64,
    height: f64,
}

/// The rail in the axes of a patch.
struct RailSurface<'a> {
    rail: &'a Rail,
    frame: &'a Frame,
    near: usize,
}

impl RailSurface<'_> {
    /// s of the point of the rail nearest to the plane's origin.
    fn start(&self) -> f64 {
        let Self { rail, frame, .. } = self;
        let at = rail.way + frame.origin.x;
        nearest(&rail.surface, at, [frame.origin.y, frame.origin.z])
    }

    /// Height of the rail above the plane at (x, t) [m]. `s` is the starting value of the tape
    /// distance and receives the solution.
    fn meet(&mut self, x: f64, along: f64, s: &mut f64) -> Option<f64> {
        let Self { rail, frame, near } = self;
        let (sin, cos) = frame.angle.sin_cos();
        let (at, [from, to]) = (rail.way + frame.origin.x + x, rail.surface.range());
        let mut found = *s;
        for step in 1..=STEPS {
            let place = rail.surface.place(at, found, near);
            let [y, z] = place.position;
            let [y, z] = [y - frame.origin.y, z - frame.origin.z];
            let slope = place.tangent[0] * cos + place.tangent[1] * sin;
            let off = along - (y * cos + z * sin);
            if slope < STEEPEST {
                return None;
            }
            if off.abs() < EXACT || (step == STEPS && off.abs() < SETTLED) {
                *s = found;
                return (from..=to).contains(&found).then_some(z * cos - y * sin);
            }
            found += off / slope;
        }
        None
    }
}

/// The wheel in the axes of a patch.
struct WheelSurface<'a> {
    surface: &'a Surface,
    pitch: f64,
    /// Origin of the plane, and e_x, t and n, in wheelset axes.
    origin: Vector3<f64>,
    axes: [Vector3<f64>; 3],
    near: usize,
}

impl<'a> WheelSurface<'a> {
    fn new(frame: &Frame, wheel: &'a Wheel, pose: &Pose, pitch: f64) -> Self {
        let axes = frame.axes().map(|axis| pose.rotation.inverse() * axis);
        let origin = pose.wheelset_axes(frame.origin);
        Self { surface: &wheel.surface, pitch, origin, axes, near: 0 }
    }

    /// Starting values at the point of the wheel nearest to the plane's origin.
    fn start(&self, rail: f64) -> Guess {
        let [x, y, z] = self.origin.into();
        let at = x.atan2(-z) + self.pitch;
        let wheel = nearest(self.surface, at, [y, -x.hypot(z)]);
        Guess { rail, wheel, height: 0.0 }
    }

    /// Height of the wheel above the plane at (x, t) [m].
    fn meet(&mut self, x: f64, along: f64, guess: &mut Guess) -> Option<f64> {
        let at = self.origin + self.axes[0] * x + self.axes[1] * along;
        let normal = self.axes[2];
        let [from, to] = self.surface.range();
        let (mut height, mut s) = (guess.height, guess.wheel);
        for step in 1..=STEPS {
            let q = at + normal * height;
            let squared = q.x * q.x + q.z * q.z;
            let radius = squared.sqrt();
            let spot = self.surface.at(q.x.atan2(-q.z) + self.pitch, s, &mut self.near);
            let [y, z] = spot.place.position;
            let off = [q.y - y, radius + z];
            let turn = (q.x * normal.z - q.z * normal.x) / squared;
            // d(off)/d(height) and −d(off)/ds.
            let by_height = [
                normal.y - spot.along[0] * turn,
                (q.x * normal.x + q.z * normal.z) / radius + spot.along[1] * turn,
            ];
            let by_s = [spot.place.tangent[0], -spot.place.tangent[1]];
            let determinant = by_height[1] * by_s[0] - by_height[0] * by_s[1];
            if determinant.abs() < STEEPEST {
                return None;
            }
            let rise = (off[0] * by_s[1] - off[1] * by_s[0]) / determinant;
            let run = (off[0] * by_height[1] - off[1] * by_height[0]) / determinant;
            let far = rise.abs().max(run.abs());
            if far < EXACT || (step == STEPS && far < SETTLED) {
                (guess.height, guess.wheel) = (height, s);
                return (from..=to).contains(&s).then_some(height);
            }
            height += rise;
            s += run;
        }
        None
    }
}

/// s of the point of a surface, at a position along it, nearest to the point y, z [m].
fn nearest(surface: &Surface, position: f64, [y, z]: [f64; 2]) -> f64 {
    let [from, to] = surface.range();
    let mut near = 0;
    let mut off = |s: f64| {
        let place = surface.place(position, s, &mut near).position;
        (place[0] - y).hypot(place[1] - z)
    };
    let places = (0..=400).map(|k| from + (to - from) * f64::from(k) / 400.0);
    let far = places.map(|s| (s, off(s)));
    far.min_by(|a, b| a.1.total_cmp(&b.1)).map_or(from, |(s, _)| s)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::local::undeformed_distance;
    use crate::outline::Outline;
    use crate::rail::{Placing, Side, Track};
    use crate::slices::{Along, Slice, Slices};
    use crate::standard::{rail_60e1, wheel_s1002};
    use crate::wheelset::{Motion, Wheelset};
    use std::f64::consts::TAU;

    fn sliced(profile: &Outline, period: Option<f64>) -> Surface {
        let slice = |at: f64| Slice { at, outline: profile.clone(), features: Vec::new() };
        let slices: Vec<Slice> = [-0.4, 0.0, 0.1, 0.3].map(slice).to_vec();
        Slices::new(&slices, Along::Through, period).unwrap().into()
    }

    /// Equal slices have the same distance as their profile, on tread, throat and flank, with yaw
    /// and roll. Tolerances: rounding at every fourth column of the round wheel, and the cubics
    /// between these columns.
    #[test]
    fn equal_slices_have_the_distance_of_their_profile() {
        let placing = Placing::Gauge { width: 1.435, height: 14e-3 };
        let track = Track { placing, cant: 0.025, curvature: 0.0 };
        let shape = Wheelset {
            flange_back_distance: 1.36,
            flange_back_position: -0.07,
            nominal_radius: 0.46,
        };
        let (profile, of_rail) = (wheel_s1002().unwrap(), rail_60e1().unwrap());
        let rails: [Surface; 2] = [of_rail.clone().into(), sliced(&of_rail, None)];
        let wheels: [Surface; 2] = [profile.clone().into(), sliced(&profile, Some(TAU))];
        let rails = rails.map(|rail| Rail::placed(&rail, Side::Left, &track).unwrap());
        let wheels = wheels.map(|wheel| Wheel::placed(&wheel, Side::Left, &shape));
        let window = Window { half: [24, 12], sides: [3e-4, 3e-4] };
        for (y, s) in [(0.0, 2e-3), (5e-3, -20e-3), (9e-3, -38e-3)] {
            let motion = Motion { y, z: -1e-4, roll: 2e-3, yaw: 8e-3, ..Motion::default() };
            let pose = Pose::of(&motion, &shape);
            let element = [0, (s / 3e-4_f64).round() as i64];
            let place = rails[0].outline.at(element[1] as f64 * 3e-4);
            let origin = Vector3::new(0.0, place.position[0], place.position[1]);
            let frame = Frame { element, origin, reference: origin, angle: place.angle() };
            let bodies = (&rails[0], &wheels[0], &pose);
            let [expected, heights] = undeformed_distance(&frame, &window, bodies);
            for (rail, wheel) in [(0, 1), (1, 0), (1, 1)] {
                let bodies = (&rails[rail], &wheels[wheel], &pose);
                let [found, own] = distance_of_surfaces(&frame, &window, bodies, 1.3);
                for (at, (a, b)) in expected.iter().zip(&found).enumerate() {
                    let solved = (at % 49).abs_diff(24) % 4 == 0;
                    let tolerance = if solved { 1e-14 } else { 1e-10 };
                    assert!((a - b).abs() < tolerance, "{y} {at} {a} {b}");
                }
                for (a, b) in heights.iter().zip(&own) {
                    assert!((a - b).abs() < 1e-15, "{y} {a} {b}");
                }
            }
        }
    }
}
