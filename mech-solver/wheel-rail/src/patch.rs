//! Results of a patch, and of all patches of a wheel.

use super::creepage::Rolling;
use super::fields::{Fields, Load};
use super::local::Frame;
use super::pressed::NormalPatch;
use super::rail::Rail;
use super::springs::TractionSolution;
use super::wheelset::{Pose, Wheel};
use nalgebra::Vector3;

/// Solution of a contact patch.
#[derive(Clone, Debug, PartialEq)]
pub struct Patch {
    /// Axes and reference of the patch; their origin is the middle of an element.
    pub frame: Frame,
    /// Tape distance of the reference [m].
    pub tape: f64,
    /// Reference in the axes of the rail's profile, y and z [m].
    pub in_rail: [f64; 2],
    /// Reference in the axes of the wheel's profile, x, y and z [m].
    pub in_wheel: [f64; 3],
    /// Approach: penetration of the undeformed bodies along the normal [m].
    pub approach: f64,
    /// Area of the contact [m²].
    pub area: f64,
    /// Largest pressure [Pa].
    pub max_pressure: f64,
    /// Forces and moments on the wheel about the origin of the patch's axes, in these axes.
    pub load: Load,
    /// Ratio of tangential to normal force, as in [`NormalPatch::leaning`] [-].
    pub(super) leaning: f64,
    /// Creepages at the origin, and rolling speed.
    pub rolling: Rolling,
    /// Friction power [W].
    pub friction_power: f64,
    /// Part of the friction power that is due to rigid slip off the plane [W].
    pub power_off_plane: f64,
    /// Slipping area over the area of the contact, by elements [-].
    pub slip_area_ratio: f64,
    /// True if the region of penetration reaches an end of a profile.
    pub at_end: bool,
    /// Fields of the patch.
    pub fields: Fields,
}

/// Solution of a wheel on a rail.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Solved {
    /// Height of the wheelset [m], as in [`super::wheelset::Motion`].
    pub z: f64,
    /// Patches from right to left.
    pub patches: Vec<Patch>,
    /// Force on the wheel in track axes [N].
    pub force: [f64; 3],
    /// Force on the wheel in wheelset axes [N].
    pub force_wheelset: [f64; 3],
    /// Moment on the wheel about the middle of the wheelset, in track axes [N m].
    pub moment: [f64; 3],
    /// Moment on the wheel about the middle of the wheelset, in wheelset axes [N m]; its y
    /// component turns the axle.
    pub moment_wheelset: [f64; 3],
    /// Work counters of the solution.
    pub work: SolveStats,
}

/// Work counters of a solution.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SolveStats {
    /// Number of normal contacts solved.
    pub normal_contacts: usize,
    /// Iterations of the normal contacts.
    pub normal_iterations: usize,
    /// Number of tangential contacts solved.
    pub tangential_contacts: usize,
    /// Newton steps of the tangential contacts, on all grids.
    pub newton_steps: usize,
}

impl SolveStats {
    /// Adds two sets of counters.
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
    /// Evaluates the figures of a patch from its fields.
    pub(super) fn of(
        pressed: &NormalPatch,
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

    /// Replaces loads, power and slip by those of the springs. The elements hold only means of the
    /// springs.
    pub(super) fn sliding(mut self, slid: &TractionSolution) -> Self {
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
    /// Sums forces and moments over the patches.
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
