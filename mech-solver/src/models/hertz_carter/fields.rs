//! Fields of the contact as element means.

use super::contact::CarterContact;
use crate::models::precomputed::points;
use crate::terms::Terms;
use elastic::slip::Slip;
use elastic::strips::carter::{CarterPower, CarterSlip, CarterTraction};
use elastic::strips::semi_ellipse::SemiEllipse;
use elastic::strips::sliding::{SlidingPower, SlidingSlip};
use elastic::strips::{Lateral, StripField, Strips};
use proto::field::{self, FieldSpec};
use proto::grid::Structured;

/// Writes the values of a field that the model or one of its effects provides, component-major.
pub(super) fn write(
    spec: &FieldSpec,
    contact: &CarterContact,
    grid: Structured,
    terms: &Terms,
    values: &mut [f64],
) {
    let strips = contact.ellipse.strips(grid);
    values.fill(0.0);
    // The longitudinal component of a vector comes first; the lateral one is zero.
    let first = &mut values[..points(spec, &grid)];
    match *spec {
        field::PRESSURE => contact.ellipse.write_pressure(grid, first),
        field::TRACTION => write_traction(&strips, contact, first),
        field::SLIP_VELOCITY => write_slip_velocity(&strips, contact, first),
        field::FRICTION_POWER => {
            let amplitude = contact.largest_bound() * contact.speeds.rolling;
            write_power(&strips, &contact.slip, amplitude, first);
            terms.keep_heat(first);
        }
        field::SURFACE_SPEED => {
            values.copy_from_slice(&contact.speeds.of_surfaces(contact.creepage_xi()));
        }
        field::CONTACT_FORCE => {
            values.copy_from_slice(&[contact.creep_force(), 0.0, contact.ellipse.normal_force]);
        }
        _ => unreachable!("a field without provider is refused earlier: {}", spec.name),
    }
}

/// Writes the longitudinal traction on the upper body [Pa].
fn write_traction(strips: &Strips, contact: &CarterContact, means: &mut [f64]) {
    let (amplitude, lateral) = (contact.direction * contact.largest_bound(), Lateral::Elliptic);
    match contact.slip {
        Slip::Adhesion => {}
        Slip::Partial { fraction, .. } => {
            let density = CarterTraction::new(fraction);
            strips.write_means(&StripField { density, amplitude, lateral }, means);
        }
        Slip::Sliding { .. } => {
            strips.write_means(&StripField { density: SemiEllipse, amplitude, lateral }, means);
        }
    }
}

/// Writes the longitudinal velocity of the upper body relative to the lower one [m/s], opposite to
/// the traction.
fn write_slip_velocity(strips: &Strips, contact: &CarterContact, means: &mut [f64]) {
    let (amplitude, lateral) = (-contact.direction * contact.speeds.rolling, Lateral::Constant);
    match contact.slip {
        Slip::Adhesion => {}
        Slip::Partial { fraction, prefactor } => {
            let (density, amplitude) = (CarterSlip::new(fraction), amplitude * prefactor);
            strips.write_means(&StripField { density, amplitude, lateral }, means);
        }
        Slip::Sliding { creep, gradient } => {
            let density = SlidingSlip { creep, gradient };
            strips.write_means(&StripField { density, amplitude, lateral }, means);
        }
    }
}

/// Writes the element means of the friction power density [W/m²]; `amplitude` is f p_0 V [W/m²].
fn write_power(strips: &Strips, slip: &Slip, amplitude: f64, means: &mut [f64]) {
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
