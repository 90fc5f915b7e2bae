//! Effect `friction_heat`, the mechanics' part: the friction power that becomes heat.
//!
//! Friction power density q_f = −p_t · v = |p_t| |v| [W/m²], with the traction p_t [Pa] on the
//! upper body and its velocity v [m/s] relative to the lower one. It is given as element means
//! of the product, so that its sum over the elements is V s F, the power of the creep force F over
//! the creep s, at every resolution. The product of element means would fall short of it.
//!
//! In the slip zone of a strip, with u = 1 + X ∈ [0, 2m] and the fraction m that slips, Carter's
//! traction and slip give (2 − u) √(u(2m − u)), in units of f p_0 √(1 − y²/b²) and V A. With
//! u = m(1 + τ) its integral from the trailing edge is
//! m² [(2 − m)(½(τ√(1 − τ²) + asin τ) + π/4) + m/3 (1 − τ²)^{3/2}], in all π/2 m²(2 − m).
//!
//! `fastsim` sums the product of a cell's mean traction and mean slip, which its march makes exact.
//!
//! Source: Naeimi et al., eq. 1, and [`crate::reference::carter`].

use crate::models::names::{FASTSIM, HALF_SPACE, HERTZ_CARTER};
use crate::slip::Slip;
use crate::strips::semi_ellipse::segment_area;
use crate::strips::{Lateral, StripDensity, StripField, Strips};
use proto::description::{EffectSpec, names};
use proto::field::{FRICTION_POWER, SURFACE_SPEED};

/// Name in the case file.
pub const NAME: &str = "friction_heat";

/// What the description says of this effect.
#[must_use]
pub fn spec() -> EffectSpec {
    EffectSpec {
        name: NAME.to_owned(),
        law: "friction power density q_f = |p_t| |v|, traction times slip velocity".to_owned(),
        source:
            "Naeimi et al., flash temperature at the wheel-rail contact, eq. 1; Ertz & Knothe, \
                 Wear 253 (2002) 498-508"
                .to_owned(),
        models: [HERTZ_CARTER, FASTSIM, HALF_SPACE].map(str::to_owned).to_vec(),
        consumes: Vec::new(),
        provides: names(&[&FRICTION_POWER, &SURFACE_SPEED]),
        keys: Vec::new(),
    }
}

/// Friction power density −p_t · v of a traction and a slip velocity, both means over one element
/// of a solution that makes their product exact.
pub(crate) fn power_density(traction: [f64; 2], slip_velocity: [f64; 2]) -> f64 {
    // Subtracting from zero turns −0 into 0.
    0.0 - (traction[0] * slip_velocity[0] + traction[1] * slip_velocity[1])
}

/// Writes the element means of the friction power density [W/m²]; `amplitude` is f p_0 V [W/m²].
pub(crate) fn write_power(strips: &Strips, slip: &Slip, amplitude: f64, means: &mut [f64]) {
    let lateral = Lateral::Elliptic;
    match *slip {
        Slip::Adhesion => means.fill(0.0),
        Slip::Partial { fraction, prefactor } => {
            let (density, amplitude) = (CarterPower { fraction }, amplitude * prefactor);
            strips.write_means(&StripField { density, amplitude, lateral }, means);
        }
        Slip::Sliding { creep, gradient } => {
            let density = SlidingPower { creep, gradient };
            strips.write_means(&StripField { density, amplitude, lateral }, means);
        }
    }
}

/// Friction power of a strip with a stick zone.
struct CarterPower {
    /// Fraction m of the strip that slips, in (0, 1).
    fraction: f64,
}

impl StripDensity for CarterPower {
    fn cumulative(&self, u: f64) -> f64 {
        let m = self.fraction;
        let v = (u / m).min(2.0);
        let root = (v * (2.0 - v)).sqrt();
        m * m * ((2.0 - m) * segment_area(v) + m / 3.0 * root.powi(3))
    }

    fn kink(&self) -> Option<f64> {
        Some((2.0 * self.fraction - 1.0).abs())
    }
}

/// Friction power (s + A ξ) √(1 − ξ²) of a contact that slides everywhere.
struct SlidingPower {
    /// Mean slip s [-].
    creep: f64,
    /// Gradient A [-].
    gradient: f64,
}

impl StripDensity for SlidingPower {
    fn cumulative(&self, u: f64) -> f64 {
        let root = (u * (2.0 - u)).sqrt();
        self.creep * segment_area(u) + self.gradient * root.powi(3) / 3.0
    }
}
