//! What is known of a patch, and of all patches of a wheel.

use super::creepage::Rolling;
use super::fields::{Fields, Load};
use super::local::Frame;
use super::pressed::Pressed;
use super::rail::Rail;
use super::springs::Slid;
use super::wheelset::{Pose, Wheel};
use nalgebra::Vector3;

/// A patch.
#[derive(Clone, Debug, PartialEq)]
pub struct Patch {
    /// Its axes, and its reference in track axes; their origin is the middle of an element.
    pub frame: Frame,
    /// Tape distance of the reference [m].
    pub tape: f64,
    /// The reference in the axes of the rail's profile, y and z [m].
    pub in_rail: [f64; 2],
    /// The reference in the axes of the wheel's profile, x, y and z [m].
    pub in_wheel: [f64; 3],
    /// Penetration of the undeformed bodies along the normal: the approach [m].
    pub approach: f64,
    /// Area of the contact [m²].
    pub area: f64,
    /// Largest pressure [Pa].
    pub max_pressure: f64,
    /// Forces and moments on the wheel in the patch's axes, about their origin.
    pub load: Load,
    /// Lean of its force by the tractions, as [`Pressed::leaning`] has it [-].
    pub(super) leaning: f64,
    /// Creepages at the origin, and the rolling speed.
    pub rolling: Rolling,
    /// Friction power [W].
    pub friction_power: f64,
    /// The part of it that rigid slip off the plane gives [W].
    pub power_off_plane: f64,
    /// Area that slips over the area of the contact, by elements [-].
    pub slip_area_ratio: f64,
    /// The region of penetration reaches an end of a profile.
    pub at_end: bool,
    /// Its fields.
    pub fields: Fields,
}

/// A wheel on a rail.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Solved {
    /// Height of the wheelset [m], as in [`super::wheelset::Motion`].
    pub z: f64,
    /// Its patches, from right to left.
    pub patches: Vec<Patch>,
    /// Force on the wheel in track axes [N].
    pub force: [f64; 3],
    /// The same in wheelset axes [N].
    pub force_wheelset: [f64; 3],
    /// Moment on the wheel about the middle of the wheelset, in track axes [N m].
    pub moment: [f64; 3],
    /// The same in wheelset axes [N m]; along y it turns the axle.
    pub moment_wheelset: [f64; 3],
    /// Work of the solution.
    pub work: SolveStats,
}

/// Work of a solution.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SolveStats {
    /// Normal contacts of patches that were solved.
    pub normal_contacts: usize,
    /// Their iterations.
    pub normal_iterations: usize,
    /// Tangential contacts of patches that were solved.
    pub tangential_contacts: usize,
    /// Their Newton steps, on all grids.
    pub newton_steps: usize,
}

impl SolveStats {
    /// Both together.
    #[must_use]
    pub fn and(&self, other: &Self) -> Self {
        Self {
            normal_contacts: self.normal_contacts + other.normal_contacts,
            normal_iterations: self.normal_iterations + other.normal_iterations,
            tangential_contacts: self.tangential_contacts + other.tangential_contacts,
            newton_steps: self.newton_steps + other.newton_steps,
        }
    }
}

impl Patch {
    /// The figures of fields.
    pub(super) fn of(
        pressed: &Pressed,
        fields: Fields,
        rolling: Rolling,
        power_off_plane: f64,
        (rail, wheel, pose): (&Rail, &Wheel, &Pose),
    ) -> Self {
        let region = &pressed.region;
        let place = pressed.frame.reference;
        let on_wheel = pose.wheelset_axes(place);
        let max_pressure = fields.pressure.iter().copied().fold(0.0, f64::max);
        Self {
            frame: pressed.frame,
            tape: region.s,
            in_rail: rail.profile_axes([place.y, place.z]),
            in_wheel: [on_wheel.x, on_wheel.y - wheel.origin[0], on_wheel.z - wheel.origin[1]],
            approach: pressed.approach(),
            area: pressed.area(&fields.grid()),
            max_pressure,
            leaning: pressed.leaning(&fields),
            load: pressed.load(&fields),
            rolling,
            friction_power: fields.total_power(),
            power_off_plane,
            slip_area_ratio: fields.slip_area_ratio(),
            at_end: region.at_end,
            fields,
        }
    }

    /// With the tractions' loads, power and slip as springs have them, which elements show as their means.
    pub(super) fn sliding(mut self, slid: &Slid) -> Self {
        self.load.force[..2].copy_from_slice(&slid.force);
        self.load.moment[2] = slid.moment;
        self.leaning = self.load.force[1] / self.load.force[2];
        self.slip_area_ratio = slid.slip_area_ratio;
        self
    }

    /// Force on the wheel in track axes [N].
    #[must_use]
    pub fn force(&self) -> Vector3<f64> {
        self.frame.track_axes(self.load.force)
    }
}

impl Solved {
    /// Sums of patches.
    pub(super) fn of(z: f64, patches: Vec<Patch>, pose: &Pose, work: SolveStats) -> Self {
        let mut force = Vector3::zeros();
        let mut moment = Vector3::zeros();
        for patch in &patches {
            let of_patch = patch.force();
            force += of_patch;
            moment += (patch.frame.origin - pose.middle).cross(&of_patch);
            moment += patch.frame.track_axes(patch.load.moment);
        }
        let back = pose.rotation.inverse();
        Self {
            z,
            patches,
            force: force.into(),
            force_wheelset: (back * force).into(),
            moment: moment.into(),
            moment_wheelset: (back * moment).into(),
            work,
        }
    }
}
