//! The whole contact: ellipse, forces and creepage, all in closed form.

use crate::case::ellipse::{Ellipse, Prescribed};
use crate::case::scene::{Scene, Speeds};
use crate::figures::indicators::{SlipZone, add_slip_zone};
use crate::models::summary::extend;
use elastic::carter;
use elastic::slip::Slip;
use proto::configuration::Refusal;
use serde_json::{Value, json};
use std::f64::consts::PI;
use std::fmt;

/// Creep laws; see [`carter`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum CreepLaw {
    /// A = f a/R, with R the relative radius of the bodies along x.
    Radius,
    /// A = 2 f p_0 E*.
    Pressure,
}

/// A contact in closed form: ellipse, creepage and slip.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct CarterContact {
    /// Normal contact.
    pub(super) ellipse: Ellipse,
    /// Friction coefficient [-].
    friction_coefficient: f64,
    /// Speeds of rolling and of the surfaces.
    pub(super) speeds: Speeds,
    /// Sign of the force on the upper body: 1 driving, −1 braking, 0 neither.
    pub(super) direction: f64,
    /// Slip zone of the contact.
    pub(super) slip: Slip,
}

impl CarterContact {
    /// Solves the tangential contact on an ellipse with the scene's friction coefficient.
    pub(super) fn solve(
        scene: &Scene,
        ellipse: Ellipse,
        law: CreepLaw,
        partial: bool,
    ) -> Result<Self, Refusal> {
        let mut contact = Self {
            ellipse,
            friction_coefficient: scene.friction_coefficient,
            speeds: scene.speeds,
            direction: 0.0,
            slip: Slip::Adhesion,
        };
        let amount = Amount::of(scene, &ellipse)?;
        contact.slip = amount.slip(contact.prefactor(scene, law), partial);
        contact.direction = if contact.slip == Slip::Adhesion { 0.0 } else { amount.direction() };
        Ok(contact)
    }

    /// Prefactor A of the creep law [-].
    fn prefactor(&self, scene: &Scene, law: CreepLaw) -> f64 {
        let friction = self.friction_coefficient;
        match law {
            CreepLaw::Radius => {
                let radius = scene.relative_radius_x();
                carter::prefactor_by_radius(friction, self.ellipse.semi_axis_a, radius)
            }
            CreepLaw::Pressure => {
                let compliance = scene.contact_compliance();
                carter::prefactor_by_pressure(friction, self.ellipse.max_pressure, compliance)
            }
        }
    }

    /// Friction bound f N [N].
    fn friction_bound(&self) -> f64 {
        self.friction_coefficient * self.ellipse.normal_force
    }

    /// Friction bound f p_0 at the centre [Pa].
    pub(super) fn largest_bound(&self) -> f64 {
        self.friction_coefficient * self.ellipse.max_pressure
    }

    /// Longitudinal force on the upper body [N].
    pub(super) fn creep_force(&self) -> f64 {
        self.direction * self.slip.force_ratio() * self.friction_bound()
    }

    /// Longitudinal creepage, negative when driving [-].
    pub(super) fn creepage_xi(&self) -> f64 {
        // Adding zero turns −0 into 0.
        -self.direction * self.slip.creep() + 0.0
    }

    /// Friction power V s |F| [W].
    fn friction_power(&self) -> f64 {
        self.speeds.rolling * self.slip.creep() * self.slip.force_ratio() * self.friction_bound()
    }

    /// Width of the slip zone in elements of this length [m].
    fn slip_zone(&self, dx: f64) -> SlipZone {
        /// Mean half-length of the strips of an ellipse over a, weighted with their friction
        /// power, which grows with the square of the half-length: ∫ η³/∫ η², η = √(1 − y²/b²).
        const MEAN_STRIP: f64 = 9.0 * PI / 32.0;
        let mut zone = SlipZone::default();
        if let Slip::Partial { fraction, .. } = self.slip {
            let strip = if self.ellipse.line { 1.0 } else { MEAN_STRIP };
            zone.add_run(2.0 * self.ellipse.semi_axis_a * strip * fraction / dx, 1.0);
            zone.add_stick();
        }
        zone
    }

    /// Section `contact` of `summary.json`, for fields on elements of this length [m]. The spin
    /// moment is not known to this model.
    pub(super) fn summary(&self, dx: f64) -> Value {
        let force = self.creep_force();
        let mut contact = self.ellipse.summary();
        let creep = json!({
            "creep_force_x_n": force,
            "creep_force_y_n": 0.0,
            "traction_coefficient": force / self.ellipse.normal_force,
            "creepage_xi": self.creepage_xi(),
            "creepage_eta": 0.0,
            "creepage_phi_per_m": 0.0,
            "slip_area_ratio": self.slip.area_ratio(),
            "max_slip_velocity_m_per_s": self.speeds.rolling * self.slip.largest_velocity(),
            "max_traction_pa": self.largest_bound() * self.slip.largest_traction(),
            "friction_power_w": self.friction_power(),
        });
        extend(&mut contact, creep);
        add_slip_zone(&mut contact, &self.slip_zone(dx));
        self.ellipse.indicators.add_to(&mut contact);
        json!({ "contact": contact })
    }
}

impl fmt::Display for CarterContact {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{}; creepage xi = {:.5}, slip on {:.1} % of its area",
            self.ellipse,
            self.creepage_xi(),
            1e2 * self.slip.area_ratio(),
        )
    }
}

/// Prescribed force or creepage; positive values drive.
#[derive(Clone, Copy, Debug)]
enum Amount {
    /// Force over f N [-].
    ForceRatio(f64),
    /// Creep −ξ [-].
    Creep(f64),
}

impl Amount {
    fn of(scene: &Scene, ellipse: &Ellipse) -> Result<Self, Refusal> {
        let longitudinal_only = |key: &str, value: f64| {
            if value == 0.0 {
                return Ok(());
            }
            let reason = "hertz-carter supports longitudinal creepage only";
            Err(Refusal::new(key, reason, "write 0, or remove the key"))
        };
        match ellipse.prescribed(scene)? {
            Prescribed::ForceRatio(ratio) => Ok(Self::ForceRatio(ratio)),
            Prescribed::Creepage { xi, eta, phi } => {
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

    /// Slip at this force or creep. With adhesion, there is a stick zone after the creep law.
    /// Otherwise everything slides with the prescribed creep, or with the creep that the creep law
    /// gives at the prescribed force.
    fn slip(self, prefactor: f64, partial: bool) -> Slip {
        let (creep, with_stick) = match self {
            Self::ForceRatio(ratio) => {
                let ratio = ratio.abs();
                (carter::creep(prefactor, ratio), Slip::at_force_ratio(ratio, prefactor))
            }
            Self::Creep(creep) => (creep.abs(), Slip::at_creep(creep.abs(), prefactor)),
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
