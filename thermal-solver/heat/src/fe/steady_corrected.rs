//! Solver of a body in steady motion whose properties depend on temperature, or whose free surface
//! exchanges heat: the march downstream, corrected by its error for constant properties.
//!
//! With the rises T of the march, T° of the march for constant properties and an insulated free
//! surface, and T* of the modes of the mesh for the latter, the heat content of a node is corrected
//! to H(T) + ρc (T* − T°), with ρc at the initial temperature. Both T* and T° hold the heat that
//! was supplied, so that heat is conserved. The modes are exact along the motion
//! ([`super::steady`]); the march has one step for an element. Without the correction, a cooling of
//! no importance would move a peak below a narrow flux by a percent. What remains is the error of
//! the march in the effect of the properties and of the cooling.

use super::body_properties::BodyProperties;
use super::body_solver::{BodySolver, Rises, SolverInput};
use super::conductor::Surroundings;
use super::error::SolveError;
use super::law::Law;
use super::section::Interpolation;
use super::steady_marching::SteadyMarching;
use super::steady_modal::SteadyModal;
use crate::columns::reconstruction::Flux;
use crate::window::Stage;
use std::io::{self, Read, Write};

/// Largest number of steps to a given heat content.
const MOST_STEPS: usize = 60;
/// Error of a heat content over the correction.
const SOLVED: f64 = 1e-12;

/// Solver of one body.
pub struct SteadyCorrected {
    march: SteadyMarching,
    /// March for constant properties and an insulated free surface; `None` if these are the
    /// properties of the body.
    plain: Option<SteadyMarching>,
    /// Modes for constant properties and an insulated free surface.
    exact: SteadyModal,
    law: Law,
    /// Heat capacity at the initial temperature [J/(m³·K)].
    capacity: f64,
    /// Number of nodes in depth.
    layers: usize,
    /// Surface rises of the exact and of the plain solution [K].
    surfaces: [Vec<f64>; 2],
}

impl SteadyCorrected {
    /// Creates the solver of a cold body.
    #[must_use]
    pub fn new(given: SolverInput) -> Self {
        let constant = BodyProperties {
            points: Vec::new(),
            surroundings: Surroundings::default(),
            ..given.nature.clone()
        };
        let plain = SolverInput { nature: &constant, ..given };
        let zeros = vec![0.0; given.grid.points()];
        Self {
            march: SteadyMarching::new(given),
            plain: (constant != *given.nature).then(|| SteadyMarching::new(plain)),
            exact: SteadyModal::new(plain),
            law: given.nature.law(),
            capacity: given.nature.material.density * given.nature.material.specific_heat,
            layers: given.block.depth.len(),
            surfaces: [zeros.clone(), zeros],
        }
    }

    /// Returns the corrected rise of a node [K].
    fn corrected(&self, march: f64, plain: f64, exact: f64) -> f64 {
        let correction = self.capacity * (exact - plain);
        if correction == 0.0 {
            return march;
        }
        let from = self.law.potential(march);
        let heat = self.law.held(from).heat + correction;
        self.law.rise(at_heat(&self.law, heat, from, SOLVED * correction.abs()))
    }
}

/// Returns Θ at a heat content [J/m³], to a tolerance: Newton's method from a start, within the
/// interval that is known to hold the solution. The heat content grows with Θ.
fn at_heat(law: &Law, heat: f64, from: f64, tolerance: f64) -> f64 {
    let (mut low, mut high, mut at) = (f64::NEG_INFINITY, f64::INFINITY, from);
    for _ in 0..MOST_STEPS {
        let held = law.held(at);
        let excess = held.heat - heat;
        if excess.abs() <= tolerance {
            break;
        }
        (low, high) = if excess > 0.0 { (low, at) } else { (at, high) };
        let next = at - excess / held.rate;
        at = if next > low && next < high { next } else { 0.5 * (low + high) };
        if !at.is_finite() {
            return next;
        }
    }
    at
}

impl BodySolver for SteadyCorrected {
    fn pass(&mut self, duration: f64, speed: f64) -> Result<(), SolveError> {
        self.march.pass(duration, speed)?;
        self.plain.iter_mut().try_for_each(|plain| plain.pass(duration, speed))?;
        self.exact.pass(duration, speed)
    }

    fn warm(&mut self) -> Result<u64, SolveError> {
        let mut work = self.march.warm()?;
        if let Some(plain) = &mut self.plain {
            plain.flux().copy_from(self.march.flux());
            work += plain.warm()?;
        }
        self.exact.flux().copy_from(self.march.flux());
        Ok(work + self.exact.warm()?)
    }

    fn show(&mut self, between: Interpolation, rise: &mut [f64]) {
        self.march.show(between, rise);
        let Self { plain, exact, surfaces: [of_exact, of_plain], .. } = self;
        exact.show(between, of_exact);
        match plain {
            Some(plain) => plain.show(between, of_plain),
            None => of_plain.copy_from_slice(rise),
        }
        for (at, rise) in rise.iter_mut().enumerate() {
            *rise = self.corrected(*rise, self.surfaces[1][at], self.surfaces[0][at]);
        }
    }

    fn flux(&mut self) -> &mut Flux {
        self.march.flux()
    }

    fn accept(&mut self) {
        self.march.accept();
        self.plain.iter_mut().for_each(BodySolver::accept);
        self.exact.accept();
    }

    /// The columns are those of the modes, two in an element. The marches are linear between their
    /// columns, which are at the middles of elements.
    fn below(&self, stage: Stage, row: usize) -> Rises {
        let march = self.march.below(stage, row).values;
        let plain = self.plain.as_ref().map(|plain| plain.below(stage, row).values);
        let plain = plain.as_ref().unwrap_or(&march);
        let mut exact = self.exact.below(stage, row);
        let (coarse, fine) = (march.len() / self.layers, exact.values.len() / self.layers);
        for (k, exact) in exact.values.chunks_exact_mut(fine).enumerate() {
            for (column, exact) in exact.iter_mut().enumerate() {
                let next = (column / 2).min(coarse - 1);
                let behind = (column.saturating_sub(1) / 2).min(next);
                let between = |rises: &[f64]| {
                    let rises = &rises[k * coarse..(k + 1) * coarse];
                    0.5 * (rises[behind] + rises[next])
                };
                *exact = self.corrected(between(&march), between(plain), *exact);
            }
        }
        exact
    }

    /// Always false: rises below zero are errors of the iterations, not rounding.
    fn is_heated(&self, _: Stage) -> bool {
        false
    }

    fn save(&self, into: &mut dyn Write) -> io::Result<()> {
        self.march.save(into)?;
        self.plain.iter().try_for_each(|plain| plain.save(into))?;
        self.exact.save(into)
    }

    fn read(&mut self, from: &mut dyn Read) -> io::Result<()> {
        self.march.read(from)?;
        self.plain.iter_mut().try_for_each(|plain| plain.read(from))?;
        self.exact.read(from)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Material;
    use crate::fe::block::{Block, Elements};
    use grids::Structured;

    /// Returns the largest difference of the march from the modes over the largest rise, under a
    /// parabola of heat on this many columns.
    fn difference(columns: usize) -> f64 {
        let side = 10e-3 / columns as f64;
        let grid = Structured::contact_plane(0.5 * side - 5e-3, -1e-3, side, 1e-3, columns, 3);
        let material = Material { density: 7850.0, specific_heat: 419.5, conductivity: 50.0 };
        let nature = BodyProperties {
            material,
            points: Vec::new(),
            initial: 293.15,
            clamps: false,
            surroundings: Surroundings::default(),
        };
        let elements = Elements::default();
        let block = Block::new(&grid, &material, 20.0, &elements);
        let given =
            SolverInput { grid: &grid, nature: &nature, block: &block, elements: &elements };
        let parabola = |at: usize| 1e8 * (1.0 - (grid.x(at % columns) / 5e-3).powi(2));
        let means: Vec<f64> = (0..grid.points()).map(parabola).collect();
        let (mut march, mut modes) = (SteadyMarching::new(given), SteadyModal::new(given));
        let [march, modes] = [&mut march as &mut dyn BodySolver, &mut modes].map(|solver| {
            solver.flux().reconstruct(&means);
            solver.pass(f64::INFINITY, 20.0).expect("fast enough");
            solver.warm().expect("solved");
            let mut rise = vec![0.0; grid.points()];
            solver.show(Interpolation::Bounded, &mut rise);
            rise
        });
        let apart = march.iter().zip(&modes).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        apart / modes.iter().copied().fold(0.0, f64::max)
    }

    /// The march, with one step for an element, converges to the modes.
    #[test]
    fn the_march_converges_to_the_modes() {
        let differences = [20, 40, 80].map(difference);
        println!("{differences:?}");
        assert!(differences[0] < 2.5e-2, "{differences:?}");
        assert!(differences.is_sorted_by(|a, b| *a > 1.9 * b), "{differences:?}");
    }

    /// Θ at a heat content beyond a step of the heat capacity. Tolerance: that of the search.
    #[test]
    fn heat_contents_are_found() {
        let point = |temperature, capacity| crate::fe::law::Point {
            temperature,
            conductivity: 50.0,
            capacity,
        };
        let points = [point(200.0, 3e6), point(400.0, 3e6), point(401.0, 8e7), point(2000.0, 8e7)];
        let law = Law::new(&points, 293.15);
        for (from, to) in [(0.0, 300.0), (500.0, 5.0), (106.0, 108.5), (-20.0, 107.2)] {
            let heat = law.held(law.potential(to)).heat;
            let found = law.rise(at_heat(&law, heat, law.potential(from), 1e-3));
            assert!((found - to).abs() < 1e-6, "{from} {to} {found}");
        }
    }
}
