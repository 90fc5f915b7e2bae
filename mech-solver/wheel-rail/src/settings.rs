//! What a wheel on a rail is solved with, and what it is asked for.

use super::region::Joining;
use elastic::Elasticity;
use elastic::Material;
use elastic::fastsim::flexibility::Kind;
use half_space::difference::Difference;

/// Tolerance of the pressure over that of the tractions.
const PRESSURE_SHARE: f64 = 1e-2;

/// Discretisation, bodies and accuracy.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Sides of an element along x and along the tape [m], of all patches.
    pub sides: [f64; 2],
    /// Elastic constants of wheel (body 1) and rail (body 2), of the same material.
    pub bodies: Elasticity,
    /// The same of each.
    pub materials: [Material; 2],
    /// Surfaces may stick; without it all of a contact slides.
    pub adhesion: bool,
    /// Tangential flexibility of a layer between the surfaces [m/Pa], 0 for none.
    pub layer: f64,
    /// When regions are of one patch.
    pub joining: Joining,
    /// Place at which the rigid slip is taken.
    pub rigid_slip: RigidSlip,
    /// Surface of a patch.
    pub patch_surface: PatchSurface,
    /// The pressure of a patch displaces the surfaces under the others.
    pub mutual: bool,
    /// Theory of the pressure.
    pub normal: Normal,
    /// Theory of the tractions.
    pub tangential: Tangential,
    /// Difference of displacements along x.
    pub difference: Difference,
    /// Most elements of a patch.
    pub limit: usize,
    /// Tractions have settled when they change by less than this share of the largest, a given force is met to
    /// this share of it.
    pub tolerance: f64,
}

impl Settings {
    /// Elements of these sides [m] on a wheel and a rail of these materials; the rest as usual.
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

/// Place at which the rigid slip of an element is taken.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum RigidSlip {
    /// In the plane of its patch: three creepages.
    #[default]
    Plane,
    /// On the surfaces, above the plane and below it: the rolling radius is that of every place.
    Surfaces,
}

/// Surface of a patch.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PatchSurface {
    /// A plane between half-spaces.
    #[default]
    Plane,
    /// A surface that turns with the bodies, which are prisms of their sections.
    Curved,
}

/// Theory of the pressure of a patch.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Normal {
    /// Half-spaces.
    #[default]
    HalfSpace,
    /// Virtual penetration, corrected by an equivalent ellipse: KPEC.
    Kpec,
    /// Hertz's theory row by row: ANALYN.
    Analyn,
}

/// Theory of the tractions of a patch that may stick.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Tangential {
    /// Half-spaces.
    #[default]
    HalfSpace,
    /// Springs, of these flexibilities of an equivalent ellipse: FASTSIM.
    Fastsim(Kind),
    /// The same where surfaces slip, strip theory where they stick: FASTRIP.
    Fastrip(Kind),
}

/// Springs that are asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AskedSprings {
    /// Their flexibilities.
    pub kind: Kind,
    /// Strip theory where strips stick.
    pub strip_theory: bool,
}

impl Settings {
    /// Tolerance of the pressure: a share of that of the tractions.
    pub(super) fn pressure_tolerance(&self) -> f64 {
        PRESSURE_SHARE * self.tolerance
    }

    /// The springs that give the tractions, if they do: a patch that cannot stick needs none.
    pub fn springs(&self) -> Option<AskedSprings> {
        let of = |kind, strip_theory| Some(AskedSprings { kind, strip_theory });
        match self.tangential {
            _ if !self.adhesion => None,
            Tangential::HalfSpace => None,
            Tangential::Fastsim(kind) => of(kind, false),
            Tangential::Fastrip(kind) => of(kind, true),
        }
    }
}

/// Height or vertical force of a wheel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Vertical {
    /// The height of the wheelset, as its motion has it.
    Height,
    /// The vertical force on the wheel in track axes [N], pressures and tractions together; the height is
    /// found, and that of the motion is where the search begins.
    Force(f64),
}
