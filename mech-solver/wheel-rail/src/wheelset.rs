//! Position and motion of a wheelset and its wheels.
//!
//! **Wheelset axes**: from its middle, x forward, y along the axle to the left, z up. In track axes
//! the middle is at (0, y, R₀ + z), with the nominal radius R₀. The axes are turned by
//! R = R_x(roll) R_z(yaw): yaw is about the axis z that roll has turned. The origin of a wheel's
//! profile is R₀ below the axle; its distance from the middle is half the flange back distance
//! minus the position of the flange back in the profile. The profile is revolved about the axle.
//!
//! A point at r in wheelset axes, on a body that also turns about its axle, has the velocity
//!
//! v + ω × R r, ω = φ̇ e_x + ψ̇ R e_z + Ω R e_y,
//!
//! with v, roll rate φ̇, yaw rate ψ̇ and angular velocity Ω, positive where the wheelset rolls
//! forward.
//!
//! CONTACT has y to the right and z down: y, z, yaw, their rates and Ω have the opposite sign
//! there. CONTACT applies φ̇ along R e_x. Source for the definitions: its user guide, ch. 4.

use super::outline::Outline;
use super::rail::Side;
use super::surface::Surface;
use nalgebra::{Rotation3, Vector3};

/// Dimensions of a wheelset.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wheelset {
    /// Distance of the flange backs [m].
    pub flange_back_distance: f64,
    /// y of the flange back in the axes of the profile [m], usually −0.07.
    pub flange_back_position: f64,
    /// Radius at z = 0 of the profile [m].
    pub nominal_radius: f64,
}

/// Position and velocities of a wheelset, in track axes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Motion {
    /// Distance of the middle along the track [m]; matters where the rail or friction varies.
    pub way: f64,
    /// Angle of rotation about the axle, rolling forward [rad]; matters for wheels that are not
    /// round.
    pub pitch: f64,
    /// Shift to the left [m].
    pub y: f64,
    /// Height above the position in which circles of the nominal radius touch z = 0 [m].
    pub z: f64,
    /// Roll, from y to z [rad].
    pub roll: f64,
    /// Yaw, from x to y [rad].
    pub yaw: f64,
    /// Velocity of the middle [m/s].
    pub velocity: [f64; 3],
    /// Rate of roll [rad/s].
    pub roll_rate: f64,
    /// Rate of yaw [rad/s].
    pub yaw_rate: f64,
    /// Angular velocity about the axle [rad/s], positive when rolling forward.
    pub angular_velocity: f64,
}

/// Position and orientation of a wheelset.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// Middle in track axes [m].
    pub middle: Vector3<f64>,
    /// Rotation from wheelset axes to track axes.
    pub rotation: Rotation3<f64>,
}

impl Pose {
    /// Creates the pose of a wheelset of these dimensions in a motion.
    #[must_use]
    pub fn of(motion: &Motion, wheelset: &Wheelset) -> Self {
        let roll = Rotation3::from_axis_angle(&Vector3::x_axis(), motion.roll);
        let yaw = Rotation3::from_axis_angle(&Vector3::z_axis(), motion.yaw);
        let middle = Vector3::new(0.0, motion.y, wheelset.nominal_radius + motion.z);
        Self { middle, rotation: roll * yaw }
    }

    /// Angular velocity in track axes [rad/s].
    #[must_use]
    pub fn angular_velocity(&self, motion: &Motion) -> Vector3<f64> {
        let turning = Vector3::new(0.0, motion.angular_velocity, motion.yaw_rate);
        Vector3::x() * motion.roll_rate + self.rotation * turning
    }

    /// Converts a point from track axes to wheelset axes [m].
    #[must_use]
    pub fn wheelset_axes(&self, place: Vector3<f64>) -> Vector3<f64> {
        self.rotation.inverse() * (place - self.middle)
    }
}

/// A wheel of a wheelset.
#[derive(Clone, Debug, PartialEq)]
pub struct Wheel {
    /// Profile at the mark in wheelset axes, y and z, s rising to the left; −z is the radius.
    pub outline: Outline,
    /// Surface over the angle from the mark, in the axes of the outline.
    pub surface: Surface,
    /// y and z of the profile's origin in wheelset axes [m].
    pub origin: [f64; 2],
}

impl Wheel {
    /// Places a wheel with this surface, its profiles in the axes of [`super::profile`], on one
    /// side of a wheelset.
    #[must_use]
    pub fn placed(surface: &Surface, side: Side, wheelset: &Wheelset) -> Self {
        let y = 0.5 * wheelset.flange_back_distance - wheelset.flange_back_position;
        let z = -wheelset.nominal_radius;
        let surface = side.of(surface.placed(0.0, [y, z]));
        Self { outline: surface.smooth_section(0.0), surface, origin: [side.sign() * y, z] }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::standard::wheel_s1002;

    const SHAPE: Wheelset =
        Wheelset { flange_back_distance: 1.36, flange_back_position: -0.07, nominal_radius: 0.46 };

    #[test]
    fn tape_circles_and_flanges_are_where_they_belong() {
        let profile = wheel_s1002().unwrap().into();
        for side in [Side::Left, Side::Right] {
            let wheel = Wheel::placed(&profile, side, &SHAPE);
            let [y, z] = wheel.outline.at(0.0).position;
            assert!((y - side.sign() * 0.75).abs() < 1e-12 && (z + 0.46).abs() < 1e-12);
            let [from, to] = wheel.outline.range();
            let back = wheel.outline.at(if side == Side::Left { from } else { to }).position[0];
            assert!((back - side.sign() * 0.68).abs() < 1e-12);
        }
    }

    /// Yaw turns forward to the left, roll lifts the left wheel, and in rolling forward the lowest
    /// point moves backwards relative to the middle.
    #[test]
    fn signs_of_turns_and_rates() {
        let motion = Motion { yaw: 0.1, roll: 0.02, angular_velocity: 3.0, ..Motion::default() };
        let pose = Pose::of(&motion, &SHAPE);
        assert!((pose.rotation * Vector3::x()).y > 0.09);
        assert!((pose.rotation * Vector3::y()).z > 0.019);
        let lowest =
            pose.angular_velocity(&motion).cross(&(pose.rotation * Vector3::new(0.0, 0.0, -0.46)));
        assert!(lowest.x < -1.3 && lowest.x > -1.38, "{lowest}");
        let place = Vector3::new(0.1, 0.7, 0.3);
        let back = pose.rotation * pose.wheelset_axes(place) + pose.middle;
        assert!((back - place).norm() < 1e-15);
    }
}
