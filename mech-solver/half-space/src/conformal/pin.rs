//! A pin in a hole in plane strain, without friction.
//!
//! Pin and hole are circles; the radius of the pin is smaller by ΔR ≪ R. The pin is held at its
//! centre and pressed by a force Q per length into the hole of an infinite body. At the angle φ
//! from the force the gap is ΔR − (ΔR + δ) cos φ + (A p)(φ), with the approach δ and the
//! flexibility A of both bodies by boundary elements ([`super::boundary`]).
//!
//! Source: A. Persson, On the Stress Distribution of Cylindrical Elastic Bodies in Contact
//! (Chalmers, 1964), for the problem.

use super::boundary::Body;
use super::kernel::ElasticConstants;
use super::outline::Outline;
use crate::influence::Influence;
use crate::normal::{NormalError, NormalSolver, Prescribed};
use elastic::Elasticity;
use elastic::Material;
use numerics::rows::{Parity, Rows};

/// Solution for a pin pressed into a hole.
#[derive(Clone, Debug, PartialEq)]
pub struct Pin {
    /// Angle φ of every element [rad].
    pub angle: Vec<f64>,
    /// Pressure [Pa].
    pub pressure: Vec<f64>,
    /// Force Q per length [N/m].
    pub force: f64,
}

/// Presses a pin (body 1) of this radius [m] by an approach [m] into a hole whose radius is larger
/// by `clearance` [m]. `count` is the number of elements round the circle.
///
/// # Errors
/// The normal contact does not converge.
pub fn press(
    materials: &[Material; 2],
    radius: f64,
    clearance: f64,
    approach: f64,
    count: usize,
) -> Result<Pin, NormalError> {
    // Elements whose surfaces face each other: all but a few.
    let contact = count - 3;
    let outline = Outline::circle(1.0 / radius, count, contact);
    let length = outline.elements[0].length;
    let [pin, hole] = [(0, -1.0), (1, 1.0)].map(|(body, outward)| {
        let material = ElasticConstants::of(&materials[body]);
        Body { material, outline: outline.clone(), outward }.flexibility(0.0)
    });
    let numbers = |t: usize, q: usize| {
        let of = |t: usize, q: usize| pin[(3 * t + 2, 3 * q + 2)] + hole[(3 * t + 2, 3 * q + 2)];
        0.5 * (of(t, q) + of(q, t))
    };
    let mut rows = Rows::new(1, contact);
    let kernel = rows.kernel(Parity::Even, |_, t, q| numbers(t, q));
    let elasticity = Elasticity::of_pair(&materials[0], &materials[1]);
    // Wide enough to make the influence numbers of half-planes positive round the circle.
    let width = 20.0 * radius;
    let influence = Influence { dx: length, dy: width, elasticity, plane_strain: true };
    let mut solver = NormalSolver::curved(rows, kernel, &influence);
    let middle = 0.5 * (contact as f64 - 1.0);
    let angle: Vec<f64> = (0..contact).map(|j| (j as f64 - middle) * length / radius).collect();
    let gap: Vec<f64> =
        angle.iter().map(|phi| clearance - (clearance + approach) * phi.cos()).collect();
    let mut pressure = vec![0.0; contact];
    solver.solve(&gap, Prescribed::Approach(0.0), &mut pressure)?;
    let force = angle.iter().zip(&pressure).map(|(phi, p)| p * phi.cos() * length).sum();
    Ok(Pin { angle, pressure, force })
}

#[cfg(test)]
mod tests {
    use super::*;
    use numerics::search::root_between;
    use std::f64::consts::PI;

    /// Persson's clearance over load, E' ΔR/Q, and his pressure p R/Q at the angle φ with
    /// t = tan φ/2. The contact extends to tan(φ/2) = b. For bodies of the same material,
    /// E' = E/(1 − ν²).
    fn persson(b: f64) -> (f64, impl Fn(f64) -> f64) {
        let logarithm = move |t: f64| {
            let (whole, part) = ((b * b + 1.0).sqrt(), (b * b - t * t).max(0.0).sqrt());
            ((whole + part) / (whole - part)).ln()
        };
        // Substituting t = b sin u removes the singular ends.
        let steps = 2000;
        let integral: f64 = (0..steps)
            .map(|n| {
                let u = PI * ((f64::from(n) + 0.5) / f64::from(steps) - 0.5);
                let t = b * u.sin();
                logarithm(t) / (1.0 + t * t) * b * u.cos() * PI / f64::from(steps)
            })
            .sum();
        let square = b * b;
        let load =
            2.0 * (1.0 - square) / (PI * square) - integral / (PI * PI * square * (1.0 + square));
        let pressure = move |t: f64| {
            let part = (square - t * t).max(0.0).sqrt();
            2.0 / (PI * (square + 1.0).sqrt()) * part / (1.0 + t * t)
                + logarithm(t) / (2.0 * PI * square * (1.0 + square))
        };
        (load, pressure)
    }

    /// Checks the closed form, which was written from memory, for balance of forces.
    #[test]
    fn the_closed_form_carries_its_load() {
        let b = 0.6;
        let (_, pressure) = persson(b);
        let steps = 4000;
        let reach = 2.0 * f64::atan(b);
        let carried: f64 = (0..steps)
            .map(|n| {
                let phi = reach * ((f64::from(n) + 0.5) / f64::from(steps) * 2.0 - 1.0);
                pressure((0.5 * phi).tan()) * phi.cos() * 2.0 * reach / f64::from(steps)
            })
            .sum();
        assert!((carried - 1.0).abs() < 1e-4, "{carried}");
    }

    /// From a shallow contact to one over most of the half circle, with elements of 1.1°. The
    /// extent of the closed form is the one that carries the load.
    #[test]
    fn pins_press_as_persson_has_it() {
        let material = Material { youngs_modulus: 210e9, poisson_ratio: 0.3 };
        let (radius, clearance) = (20e-3, 20e-6);
        let stiffness = material.youngs_modulus / (1.0 - material.poisson_ratio.powi(2));
        for (approach, tolerance) in [(2e-6, 3e-3), (20e-6, 6e-4), (100e-6, 2e-4), (400e-6, 1e-4)] {
            let pin = press(&[material; 2], radius, clearance, approach, 320).unwrap();
            let wanted = stiffness * clearance / pin.force;
            let extent = root_between([1e-3, 0.999], |b| persson(b).0 - wanted).unwrap();
            let (_, exact) = persson(extent);
            let largest = pin.pressure.iter().copied().fold(0.0, f64::max);
            let scale = pin.force / radius;
            for (phi, p) in pin.angle.iter().zip(&pin.pressure) {
                let error = (p - scale * exact((0.5 * phi).tan())) / largest;
                // Elements cut by the edge have a larger error.
                let near = ((0.5 * phi.abs()).tan() - extent).abs() < 0.03;
                assert!(error.abs() < if near { 0.1 } else { 0.01 }, "{approach}: {phi} {error}");
            }
            let error = largest / (scale * exact(0.0)) - 1.0;
            // The shallow contact has few elements.
            assert!(error.abs() < tolerance, "{approach}: {error}");
        }
    }
}
