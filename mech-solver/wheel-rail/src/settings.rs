//! Settings of the solver of a wheel on a rail, and the condition along the vertical.

use super::region::Joining;
use elastic::Elasticity;
use elastic::Material;
use elastic::fastsim::flexibility::Kind;
use half_space::difference::Difference;

/// Ratio of the tolerance of the pressure to that of the tractions.
const PRESSURE_SHARE: f64 = 1e-2;

/// Discretisation, bodies and accuracy.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Sides of an element along x and along the tape [m], the same for all patches.
    pub sides: [f64; 2],
    /// Elastic constants of wheel (body 1) and rail (body 2), of the same material.
    pub bodies: Elasticity,
    /// Elastic constants of wheel and rail, each by itself.
    pub materials: [Material; 2],
    /// True if surfaces may stick; false if the whole contact slides.
    pub adhesion: bool,
    /// Tangential flexibility of a layer between the surfaces [m/Pa], 0 for none.
    pub layer: f64,
    /// Criterion for regions that belong to one patch.
    pub joining: Joining,
    /// Location at which the rigid slip is evaluated.
    pub rigid_slip: RigidSlip,
    /// Surface of a patch.
    pub patch_surface: PatchSurface,
    /// True if the pressure of a patch displaces the surfaces under the others.
    pub mutual: bool,
    /// Theory for the pressure.
    pub normal: Normal,
    /// Theory for the tractions.
    pub tangential: Tangential,
    /// Difference scheme for displacements along x.
    pub difference: Difference,
    /// Most elements of a patch.
    pub limit: usize,
    /// Tractions have converged when they change by less than this share of the largest. A given
    /// force is met to this share of it.
    pub tolerance: f64,
}

impl Settings {
    /// Creates settings for elements of these sides [m] on a wheel and a rail of these materials,
    /// with defaults for the rest.
    #[must_use]
    pub fn new(sides: [f64; 2], materials: [Material; 2]) -> Self {
        Self {
            sides,
            bodies: Elasticity::of_pair(&materials[0], &materials[1]),
            materials,
            adhesion: true,
            layer: 0.0,
            joining: Joining::default(),
            rigid_slip: RigidSlip::default(),
            patch_surface: PatchSurface::default(),
            mutual: false,
            normal: Normal::default(),
            tangential: Tangential::default(),
            difference: Difference::default(),
            limit: 400_000,
            tolerance: 1e-5,
        }
    }
}

/// Location at which the rigid slip of an element is evaluated.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum RigidSlip {
    /// Plane of the patch: three creepages.
    #[default]
    Plane,
    /// Surfaces above and below the plane: the rolling radius varies over the patch.
    Surfaces,
}

/// Surface of a patch.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PatchSurface {
    /// Plane between half-spaces.
    #[default]
    Plane,
    /// Curved surface that follows the bodies, which are prisms with their sections.
    Curved,
}

/// Theory for the pressure of a patch.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Normal {
    /// Half-spaces.
    #[default]
    HalfSpace,
    /// KPEC: virtual penetration, corrected by an equivalent ellipse.
    Kpec,
    /// ANALYN: Hertz's theory row by row.
    Analyn,
}

/// Theory for the tractions of a patch that may stick.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Tangential {
    /// Half-spaces.
    #[default]
    HalfSpace,
    /// FASTSIM: springs with these flexibilities of an equivalent ellipse.
    Fastsim(Kind),
    /// FASTRIP: springs where surfaces slip, strip theory where they stick.
    Fastrip(Kind),
}

/// Springs for the tangential contact.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SpringOptions {
    /// Kind of flexibilities.
    pub kind: Kind,
    /// True if strip theory applies where strips stick.
    pub strip_theory: bool,
}

impl Settings {
    /// Tolerance of the pressure, a share of that of the tractions.
    pub(super) fn pressure_tolerance(&self) -> f64 {
        PRESSURE_SHARE * self.tolerance
    }

    /// Springs that determine the tractions; `None` for half-spaces, and for a patch that cannot
    /// stick.
    pub fn springs(&self) -> Option<SpringOptions> {
        let of = |kind, strip_theory| Some(SpringOptions { kind, strip_theory });
        match self.tangential {
            _ if !self.adhesion => None,
            Tangential::HalfSpace => None,
            Tangential::Fastsim(kind) => of(kind, false),
            Tangential::Fastrip(kind) => of(kind, true),
        }
    }
}

/// Condition along the vertical of a wheel: height or force.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Vertical {
    /// Height of the wheelset as in its motion.
    Height,
    /// Vertical force on the wheel in track axes [N], of pressures and tractions together. The
    /// height is solved for, starting from that of the motion.
    Force(f64),
}
