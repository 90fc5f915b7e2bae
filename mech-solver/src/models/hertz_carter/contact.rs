//! The contact as a whole: ellipse, forces and creepage, all in closed form.

use crate::effects::partial_slip;
use crate::reference::{carter, hertz};
use crate::scene::{Drive, GivenPatch, Scene};
use crate::slip::Slip;
use proto::configuration::Refusal;
use serde_json::{Value, json};
use std::f64::consts::PI;
use std::fmt;

/// The creep laws; see [`carter`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum CreepLaw {
    /// A = f a/R_wheel.
    Radius,
    /// A = 2 f p_0 E*.
    Pressure,
}

/// Everything about the contact that is one number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Contact {
    /// Semi-axis a along x [m].
    pub(super) semi_axis_a: f64,
    /// Semi-axis b along y [m].
    pub(super) semi_axis_b: f64,
    /// Pressure at the centre [Pa].
    pub(super) max_pressure: f64,
    /// Approach of the bodies, unknown for a given ellipse [m].
    approach: Option<f64>,
    /// Normal force that the ellipse carries [N].
    pub(super) normal_force: f64,
    /// Friction coefficient [-].
    friction_coefficient: f64,
    /// Rolling speed V [m/s].
    pub(super) rolling_speed: f64,
    /// Sign of the force on the wheel: 1 driving, −1 braking, 0 neither.
    pub(super) direction: f64,
    /// Where the contact slips.
    pub(super) slip: Slip,
}

impl Contact {
    /// Solves the normal contact, or takes the given ellipse, and then the tangential one.
    pub(super) fn solve(
        scene: &Scene,
        given: Option<GivenPatch>,
        law: CreepLaw,
        partial: bool,
    ) -> Result<Self, Refusal> {
        let mut contact = match given {
            Some(patch) => Self::of_given_patch(scene, patch),
            None => Self::of_hertz(scene)?,
        };
        contact.refuse_beyond_floating_point()?;
        let prefactor = contact.prefactor(scene, law);
        let amount =
            Amount::of(&scene.drive, contact.friction_bound(), scene.friction_coefficient)?;
        contact.slip = amount.slip(prefactor, partial);
        contact.direction = if contact.slip == Slip::Adhesion { 0.0 } else { amount.direction() };
        Ok(contact)
    }

    fn refuse_beyond_floating_point(&self) -> Result<(), Refusal> {
        let size = [self.semi_axis_a, self.semi_axis_b, self.max_pressure, self.normal_force];
        if size.iter().all(|value| value.is_normal()) {
            return Ok(());
        }
        Err(Refusal::new(
            "load.normal_force",
            format!("gives a contact whose size or pressure is no number: {self}"),
            "check the units of load, radii and materials",
        ))
    }

    /// Prefactor A of the creep law [-].
    fn prefactor(&self, scene: &Scene, law: CreepLaw) -> f64 {
        let friction = self.friction_coefficient;
        match law {
            CreepLaw::Radius => {
                carter::prefactor_by_radius(friction, self.semi_axis_a, scene.wheel_radius)
            }
            CreepLaw::Pressure => {
                let compliance = scene.contact_compliance();
                carter::prefactor_by_pressure(friction, self.max_pressure, compliance)
            }
        }
    }

    fn of_given_patch(scene: &Scene, patch: GivenPatch) -> Self {
        let GivenPatch { semi_axis_a, semi_axis_b, max_pressure } = patch;
        Self {
            semi_axis_a,
            semi_axis_b,
            max_pressure,
            approach: None,
            normal_force: hertz::normal_force(semi_axis_a, semi_axis_b, max_pressure),
            friction_coefficient: scene.friction_coefficient,
            rolling_speed: scene.rolling_speed,
            direction: 0.0,
            slip: Slip::Adhesion,
        }
    }

    fn of_hertz(scene: &Scene) -> Result<Self, Refusal> {
        let (gap_x, gap_y) = (scene.gap_coefficient_x(), scene.gap_coefficient_y());
        refuse_open_ellipse(scene, gap_x, gap_y)?;
        let solution =
            hertz::elliptic_contact(gap_x, gap_y, scene.normal_force, scene.contact_compliance());
        let patch = GivenPatch {
            semi_axis_a: solution.semi_axis_a,
            semi_axis_b: solution.semi_axis_b,
            max_pressure: solution.max_pressure,
        };
        let (approach, normal_force) = (Some(solution.approach), scene.normal_force);
        Ok(Self { approach, normal_force, ..Self::of_given_patch(scene, patch) })
    }

    /// f N [N].
    fn friction_bound(&self) -> f64 {
        self.friction_coefficient * self.normal_force
    }

    /// Friction bound f p_0 at the centre [Pa].
    pub(super) fn largest_bound(&self) -> f64 {
        self.friction_coefficient * self.max_pressure
    }

    /// Longitudinal force on the wheel [N].
    pub(super) fn creep_force(&self) -> f64 {
        self.direction * self.slip.force_ratio() * self.friction_bound()
    }

    /// Longitudinal creepage, negative when driving [-].
    pub(super) fn creepage_xi(&self) -> f64 {
        // Adding zero turns −0 into 0.
        -self.direction * self.slip.creep() + 0.0
    }

    /// V s |F| [W].
    fn friction_power(&self) -> f64 {
        self.rolling_speed * self.slip.creep() * self.slip.force_ratio() * self.friction_bound()
    }

    /// The section `contact` of `summary.json`. The spin moment is not known to this model.
    pub(super) fn summary(&self) -> Value {
        let force = self.creep_force();
        let mut contact = json!({
            "semi_axis_a_m": self.semi_axis_a,
            "semi_axis_b_m": self.semi_axis_b,
            "area_m2": PI * self.semi_axis_a * self.semi_axis_b,
            "max_pressure_pa": self.max_pressure,
            "normal_force_n": self.normal_force,
            "creep_force_x_n": force,
            "creep_force_y_n": 0.0,
            "traction_coefficient": force / self.normal_force,
            "creepage_xi": self.creepage_xi(),
            "creepage_eta": 0.0,
            "creepage_phi_per_m": 0.0,
            "slip_area_ratio": self.slip.area_ratio(),
            "max_slip_velocity_m_per_s": self.rolling_speed * self.slip.largest_velocity(),
            "max_traction_pa": self.largest_bound() * self.slip.largest_traction(),
            "friction_power_w": self.friction_power(),
        });
        if let Some(approach) = self.approach {
            contact["approach_m"] = approach.into();
        }
        json!({ "contact": contact })
    }
}

impl fmt::Display for Contact {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "contact ellipse a = {:.4} mm, b = {:.4} mm, p0 = {:.2} MPa; creepage xi = {:.5}, \
             slip on {:.1} % of its area",
            1e3 * self.semi_axis_a,
            1e3 * self.semi_axis_b,
            1e-6 * self.max_pressure,
            self.creepage_xi(),
            1e2 * self.slip.area_ratio(),
        )
    }
}

/// Refuses bodies that touch along a line or all around instead of over an ellipse.
fn refuse_open_ellipse(scene: &Scene, gap_x: f64, gap_y: f64) -> Result<(), Refusal> {
    // Semi-axes in a ratio of about a million.
    const FLATTEST: f64 = 1e-12;
    let crown = scene.rail_crown_radius;
    if gap_y <= FLATTEST * gap_x && scene.tread_curvature < 0.0 {
        let reason = "the tread is as hollow as the rail crown is round, so that no elliptic \
                      contact closes";
        let fix = format!("write a value below -{crown} m, or above 0 m");
        return Err(Refusal::new("wheel.tread_radius", reason, fix));
    }
    let line = "makes the contact a line, not an ellipse";
    let fix = "write a radius of the size of the other bodies' radii";
    if gap_y <= FLATTEST * gap_x {
        return Err(Refusal::new("rail.crown_radius", line, fix));
    }
    if gap_x <= FLATTEST * gap_y {
        return Err(Refusal::new("wheel.radius", line, fix));
    }
    Ok(())
}

/// What is prescribed, with its sign: positive drives.
#[derive(Clone, Copy, Debug)]
enum Amount {
    /// Force over f N [-].
    ForceRatio(f64),
    /// Creep −ξ [-].
    Creep(f64),
}

impl Amount {
    fn of(drive: &Drive, friction_bound: f64, friction_coefficient: f64) -> Result<Self, Refusal> {
        let within = |key: &str, value: f64, limit: f64, unit: &str| {
            if value.abs() <= limit {
                return Ok(Self::ForceRatio(value / limit));
            }
            let reason = format!("{value}{unit} is beyond the friction limit of {limit}{unit}");
            Err(Refusal::new(key, reason, format!("write less than {limit}{unit} in magnitude")))
        };
        let longitudinal_only = |key: &str, value: f64| {
            if value == 0.0 {
                return Ok(());
            }
            let reason = format!("{} takes longitudinal creepage only", super::NAME);
            Err(Refusal::new(key, reason, "write 0, or remove the key"))
        };
        match *drive {
            Drive::TractionCoefficient(value) => {
                within("motion.traction_coefficient", value, friction_coefficient, "")
            }
            Drive::TangentialForce(value) => {
                within("motion.tangential_force", value, friction_bound, " N")
            }
            Drive::Creepage { xi, eta, phi } => {
                longitudinal_only("motion.creepage.eta", eta)?;
                longitudinal_only("motion.creepage.phi", phi)?;
                Ok(Self::Creep(-xi))
            }
        }
    }

    fn direction(self) -> f64 {
        let (Self::ForceRatio(value) | Self::Creep(value)) = self;
        value.signum()
    }

    /// With a stick zone after the creep law; else everything slides with the creep that is
    /// prescribed, or that the creep law gives at the prescribed force.
    fn slip(self, prefactor: f64, partial: bool) -> Slip {
        let (creep, with_stick) = match self {
            Self::ForceRatio(ratio) => {
                let ratio = ratio.abs();
                (carter::creep(prefactor, ratio), partial_slip::at_force_ratio(ratio, prefactor))
            }
            Self::Creep(creep) => (creep.abs(), partial_slip::at_creep(creep.abs(), prefactor)),
        };
        if partial {
            with_stick
        } else if creep == 0.0 {
            Slip::Adhesion
        } else {
            Slip::Sliding { creep, gradient: 0.0 }
        }
    }
}
