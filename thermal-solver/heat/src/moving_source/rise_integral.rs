//! Temperature rise integrated over depth, which determines the thermal displacement of the
//! surface.
//!
//! The traction-free surface of a half-space with a warm interior rises by 2(1 + ν)α W, with the
//! coefficient of thermal expansion α, Poisson's ratio ν and, for the wave number k along the
//! surface,
//!
//! Ŵ(k) = ∫₀^∞ ϑ̂(k, z) e^{−kz} dz.
//!
//! Heat that the surface received an age τ ago adds q̂ erfc(k√(κτ))/(ρc) to it: lateral spreading
//! and the weight of the depth combine to one function. By Craig's form of this function,
//!
//! erfc(x) = (2/π) ∫₀^∞ e^{−x²(1+v²)} dv/(1 + v²),
//!
//! W is a sum over bodies with the diffusivities κ(1 + v²), of the heat spread along their
//! surfaces, with equal weight at all ages:
//!
//! W = (2/π)/(ρc) ∫₀^∞ dv/(1 + v²) ∫₀^∞ dτ ∬ q(x', y') g((x' − x − Vτ)/s) g((y' − y)/s) dx' dy'/s²,
//! s² = 4κ(1 + v²)τ,
//!
//! each of which is [`super::half_space`] with another weight. For a uniformly heated surface, W is
//! the heat over the heat capacity ρc.
//!
//! Sources: Barber, *Elasticity* (2010), thermoelastic displacement potentials, for the
//! displacement of the surface; Craig, Proc. IEEE MILCOM (1991) 571-575, for the function. Errors:
//! the rule over v leaves some 1e-8. Windows whose material has left the grid are dropped
//! ([`crate::columns::history`]).

use super::ages::PastInterval;
use super::half_space::{HalfSpace, Influence, convolution};
use crate::Material;
use crate::columns::reconstruction::Flux;
use grids::Structured;
use numerics::convolution::Convolution;
use numerics::quadrature::points;
use std::f64::consts::FRAC_2_PI;

/// Ends of the panels of the rule over ln v; below the first end the variable is v itself.
const PANELS: [f64; 5] = [0.0, 2.25, 4.5, 6.75, 9.0];

/// Iterates over the nodes v and weights of the rule.
fn rule() -> impl Iterator<Item = (f64, f64)> {
    let far = PANELS.windows(2).flat_map(|panel| points(panel[0], panel[1]));
    let far = far.map(|(log, weight)| (log.exp(), log.exp() * weight));
    points(0.0, PANELS[0].exp()).chain(far)
}

/// Integrals of a body's rise on a grid.
pub struct RiseIntegral {
    grid: Structured,
    material: Material,
    convolution: Convolution,
    fields: [Vec<f64>; 3],
    /// Contribution of an interval.
    part: Vec<f64>,
    /// Influences of the intervals of the last evaluation, and of the one before during an
    /// evaluation.
    known: Vec<(PastInterval, Influence)>,
    before: Vec<(PastInterval, Influence)>,
}

impl RiseIntegral {
    /// Prepares the rise integral of a body of this material.
    #[must_use]
    pub fn new(grid: &Structured, material: Material) -> Self {
        Self {
            grid: *grid,
            material,
            convolution: convolution(grid),
            fields: Default::default(),
            part: vec![0.0; grid.points()],
            known: Vec::new(),
            before: Vec::new(),
        }
    }

    /// Computes the integrals W [K·m] of intervals of the past, with the flux of each and the share
    /// of it that the body received. Returns the number of multiply-adds.
    pub fn of<'a>(
        &mut self,
        past: impl Iterator<Item = (PastInterval, f64, &'a Flux)>,
        integral: &mut [f64],
    ) -> u64 {
        integral.fill(0.0);
        let mut work = 0;
        std::mem::swap(&mut self.known, &mut self.before);
        for (stretch, share, flux) in past {
            let influence = match self.before.iter().position(|(of, _)| *of == stretch) {
                Some(at) => self.before.swap_remove(at).1,
                None => {
                    let influence = self.influence(stretch);
                    work += influence.work();
                    influence
                }
            };
            self.part.fill(0.0);
            influence.add(flux, &mut self.convolution, &mut self.fields, &mut self.part);
            integral.iter_mut().zip(&self.part).for_each(|(sum, part)| *sum += share * part);
            work += integral.len() as u64;
            self.known.push((stretch, influence));
        }
        self.before.clear();
        work
    }

    fn influence(&mut self, stretch: PastInterval) -> Influence {
        let Self { grid, material, convolution, .. } = self;
        let capacity = material.density * material.specific_heat;
        let bodies = rule().map(|(v, weight)| {
            let wider = 1.0 + v * v;
            let factor = FRAC_2_PI / capacity * weight / wider;
            HalfSpace::ageless(grid, wider * material.diffusivity(), factor, stretch)
        });
        Influence::of(grid, bodies, convolution)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const STEEL: Material = Material { density: 7850.0, specific_heat: 419.5, conductivity: 50.0 };

    fn flux(grid: &Structured, at: impl Fn(f64, f64) -> f64) -> Flux {
        let means: Vec<f64> = (0..grid.points())
            .map(|index| at(grid.x(index % grid.ni), grid.y(index / grid.ni)))
            .collect();
        let mut flux = Flux::zero(grid.ni, grid.nj);
        flux.reconstruct(&means);
        flux
    }

    /// The heat of a flux in waves along x, at rest: ∫ erfc(k√(κτ)) dτ over the heat capacity, in
    /// the middle of many waves. Tolerance: the finite number of waves, and element means of a flux
    /// in waves (3e-4 at 40 elements a wave).
    #[test]
    fn waves_at_rest() {
        let (wave, columns) = (1e-3, 401);
        let grid = Structured::contact_plane(-5e-3, -5e-3, 2.5e-5, 1e-3, columns, 11);
        let k = std::f64::consts::TAU / wave;
        let of = flux(&grid, |x, _| 1e6 * (k * x).cos());
        for over in [0.05_f64, 0.5, 3.0] {
            let duration = over / (k * k * STEEL.diffusivity());
            let stretch = PastInterval { from: 0.0, to: duration, way: 0.0, speed: 0.0 };
            let mut integral = vec![0.0; grid.points()];
            RiseIntegral::new(&grid, STEEL).of(std::iter::once((stretch, 1.0, &of)), &mut integral);
            // Integration variable r = √τ.
            let root = duration.sqrt();
            let heard: f64 = (0..40)
                .flat_map(|panel| {
                    points(root * f64::from(panel) / 40.0, root * f64::from(panel + 1) / 40.0)
                })
                .map(|(r, weight)| {
                    2.0 * r * weight * libm::erfc(k * r * STEEL.diffusivity().sqrt())
                })
                .sum();
            let expected = 1e6 * heard / (STEEL.density * STEEL.specific_heat);
            let found = integral[5 * columns + columns / 2];
            assert!((found / expected - 1.0).abs() < 2e-3, "{over}: {found} {expected}");
        }
    }

    /// At rest, far from a small heated place, W is that of Poisson's kernel z/2πr³ with the mean
    /// depth of the heat: Q (2/3)√(κt)/(ρc π^1.5 r³). Tolerance: of second order in √(κt)/r and in
    /// the size over r.
    #[test]
    fn far_away() {
        let grid = Structured::contact_plane(-1e-4, 0.0, 1e-4, 1e-4, 61, 3);
        let of = flux(&grid, |x, y| if x.abs() < 5e-5 && y.abs() < 5e-5 { 1e8 } else { 0.0 });
        let duration = 4e-4;
        let stretch = PastInterval { from: 0.0, to: duration, way: 0.0, speed: 0.0 };
        let mut integral = vec![0.0; grid.points()];
        RiseIntegral::new(&grid, STEEL).of(std::iter::once((stretch, 1.0, &of)), &mut integral);
        let spread = (STEEL.diffusivity() * duration).sqrt();
        let heat = 1e8 * grid.element_area() * duration;
        let r = 59.0 * grid.dx();
        let expected = heat * 2.0 / 3.0 * spread
            / (STEEL.density * STEEL.specific_heat * std::f64::consts::PI.powf(1.5) * r.powi(3));
        assert!((integral[60] / expected - 1.0).abs() < 2e-3, "{} {expected}", integral[60]);
    }

    /// Fast steady motion: W is the received heat over the heat capacity. The
    /// deviation due to heat in depth is of the order of the depth over the length.
    #[test]
    fn fast() {
        let grid = Structured::contact_plane(-1e-2, -1e-2, 5e-4, 5e-4, 41, 41);
        let of = flux(&grid, |x, y| if x.abs() < 5.2e-3 && y.abs() < 8e-3 { 1e8 } else { 0.0 });
        let mut integral = vec![0.0; grid.points()];
        let stretch = PastInterval::steady(40.0);
        RiseIntegral::new(&grid, STEEL).of(std::iter::once((stretch, 1.0, &of)), &mut integral);
        let whole = 1e8 * 21.0 * 5e-4 / 40.0 / (STEEL.density * STEEL.specific_heat);
        let behind = integral[20 * 41 + 4];
        let depth = (STEEL.diffusivity() * 1e-2 / 40.0_f64).sqrt();
        assert!(behind < whole && behind > whole * (1.0 - 2.0 * depth / 5e-3), "{behind} {whole}");
        assert!(integral[20 * 41 + 38].abs() < whole * depth / 5e-3, "{}", integral[20 * 41 + 38]);
    }
}
