//! The silhouette of a wheel along a rail: the points whose normal is perpendicular to x, as a
//! curve in the plane y, z.
//!
//! A straight rail is a prism along x. Among all points of a wheel on a line along x, a prism first
//! touches the one whose normal has no component along x. A point of the profile at y and radius r
//! in wheelset axes moves on a circle, with the angle θ forwards from the lowest point. Its outward
//! normal is
//!
//! n_y e_y + n_r (sin θ e_x − cos θ e_z).
//!
//! The normal has no component along the track's x-axis, c in wheelset axes, where n_y c_y + n_r
//! (c_x sin θ − c_z cos θ) = 0. For R = R_x(roll) R_z(yaw), c_z is 0 and
//!
//! sin θ = −(n_y c_y)/(n_r c_x) = (n_y/n_r) tan(yaw):
//!
//! a flange touches ahead of the axle or behind it by r tan(δ) yaw to first order, with the angle δ
//! of the flank.
//!
//! Source: this is the locus of possible contacts of the wheel–rail literature; the formula is the
//! scalar product above.

use super::wheelset::{Pose, Wheel};

/// Spacing of the points of a profile whose circles are used [m]. A chord of this length is off an
/// arc of 13 mm by 0.1 µm.
const STEP: f64 = 1e-4;

/// Point of a profile.
#[derive(Clone, Copy, Debug)]
struct Sample {
    s: f64,
    y: f64,
    radius: f64,
    /// n_y/n_r.
    steepness: f64,
}

/// Sampled profile of a wheel, at equal spacing.
#[derive(Clone, Debug)]
pub struct Circles(Vec<Sample>);

impl Circles {
    /// Samples a wheel's profile; overhanging parts are omitted.
    #[must_use]
    pub fn of(wheel: &Wheel) -> Self {
        let [from, to] = wheel.outline.range();
        let count = ((to - from) / STEP).ceil() as usize;
        let sample = |k: usize| {
            let s = from + (to - from) * k as f64 / count as f64;
            let place = wheel.outline.at(s);
            let [along, up] = place.tangent;
            let [y, z] = place.position;
            (along > 0.0 && z < 0.0).then(|| Sample { s, y, radius: -z, steepness: up / along })
        };
        Self((0..=count).filter_map(sample).collect())
    }
}

/// Point of the silhouette, relative to the middle of the wheelset, in track axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SilhouettePoint {
    /// x, y and z [m].
    pub place: [f64; 3],
    /// s on the wheel's profile [m].
    pub s: f64,
    /// Radius of curvature of the wheel along x, in the normal plane [m].
    pub radius: f64,
}

/// Computes the silhouette of a wheel at a pose, y rising; the longest part without a gap is kept.
pub fn shadow(circles: &Circles, pose: &Pose, points: &mut Vec<SilhouettePoint>) {
    points.clear();
    let forward = pose.rotation.matrix().row(0).transpose();
    let across = -forward.y / forward.x;
    let (mut longest, mut start) = (0..0, 0);
    for sample in &circles.0 {
        let sine = sample.steepness * across;
        if sine.abs() >= 1.0 {
            // The part after the gap may be longer.
            if points.len() - start > longest.len() {
                longest = start..points.len();
            }
            start = points.len();
            continue;
        }
        let (along, down) = (sample.radius * sine, sample.radius * (1.0 - sine * sine).sqrt());
        let place = pose.rotation * nalgebra::Vector3::new(along, sample.y, -down);
        let radius = sample.radius * (1.0 + sample.steepness * sample.steepness).sqrt();
        points.push(SilhouettePoint { place: place.into(), s: sample.s, radius });
    }
    if points.len() - start > longest.len() {
        longest = start..points.len();
    }
    points.truncate(longest.end);
    points.drain(..longest.start);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rail::Side;
    use crate::standard::wheel_s1002;
    use crate::wheelset::{Motion, Wheelset};

    fn points(side: Side, yaw: f64) -> Vec<SilhouettePoint> {
        let shape = Wheelset {
            flange_back_distance: 1.36,
            flange_back_position: -0.07,
            nominal_radius: 0.46,
        };
        let wheel = Wheel::placed(&wheel_s1002().unwrap().into(), side, &shape);
        let pose = Pose::of(&Motion { yaw, ..Motion::default() }, &shape);
        let mut points = Vec::new();
        shadow(&Circles::of(&wheel), &pose, &mut points);
        points
    }

    /// Silhouette without and with yaw. Without yaw it is the profile, below the axle. With yaw,
    /// the flank of 70° touches ahead of the axle by r tan 70° yaw on the left; the turn of the
    /// axle itself moves it back by y yaw.
    #[test]
    fn the_flank_touches_ahead_or_behind() {
        let straight = points(Side::Left, 0.0);
        assert!(straight.iter().all(|point| point.place[0] == 0.0));
        let yaw = 1e-3;
        for side in [Side::Left, Side::Right] {
            let turned = points(side, yaw);
            let by_flank = |point: &&SilhouettePoint| (point.place[1].abs() - 0.7109).abs() < 1e-4;
            let flank = turned.iter().find(by_flank).unwrap();
            let (radius, slope) = (-flank.place[2], side.sign() * 70.0_f64.to_radians().tan());
            let expected = radius * slope * yaw - flank.place[1] * yaw;
            assert!((flank.place[0] / expected - 1.0).abs() < 1e-3, "{flank:?} {expected}");
        }
    }

    /// No point of the wheel is below its silhouette; brute force over the circles, at a large yaw
    /// and roll.
    #[test]
    fn the_shadow_is_the_lowest_of_all_points() {
        let turned = points(Side::Left, 0.05);
        let profile = wheel_s1002().unwrap();
        let (sin, cos) = 0.05_f64.sin_cos();
        for k in 300..900 {
            let place = profile.at(-60e-3 + 1e-4 * f64::from(k));
            let [y, z] = [place.position[0] + 0.75, place.position[1] - 0.46];
            for step in -50..=50 {
                let theta = 4e-3 * f64::from(step);
                let (x, z) = (-z * theta.sin(), z * theta.cos());
                let across = sin * x + cos * y;
                let at = turned.partition_point(|point| point.place[1] < across).max(1);
                let Some(next) = turned.get(at) else { continue };
                let last = &turned[at - 1];
                let share = (across - last.place[1]) / (next.place[1] - last.place[1]);
                let low = last.place[2] + share * (next.place[2] - last.place[2]);
                assert!(z > low - 3e-7, "{across} {z} {low}");
            }
        }
    }
}
