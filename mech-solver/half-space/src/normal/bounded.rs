//! Normal contact whose pressure has an upper bound p̂.
//!
//! Under a given approach the iteration enforces both bounds. The load N(δ) is continuous and grows
//! with the approach, so one δ carries the given load. Secants between two approaches find it, with
//! half weight for an end that stays (Illinois); each solve starts from the previous pressure. If
//! the pressure of the contact without a bound stays below p̂, it is the solution.
//!
//! No grid carries more than p̂ times its area. On a grid that ends, a contact that reaches the
//! edge is returned with the load it has, and a larger grid carries the rest. A contact that
//! repeats has no larger grid, and the load is refused.

use super::{NormalContact, NormalError, NormalSolver, Prescribed};

/// Error allowed in the load, over the load: that of the iteration.
const TOLERANCE: f64 = 1e-9;
/// Limit of approaches tried.
const MOST_STEPS: usize = 80;
/// Least growth of the penetration while the load is too small.
const GROWTH: f64 = 1.05;

impl NormalSolver {
    /// Solves with the upper bound of the pressure.
    pub(super) fn bounded(
        &mut self,
        distance: &[f64],
        prescribed: Prescribed,
        pressure: &mut [f64],
    ) -> Result<NormalContact, NormalError> {
        let Prescribed::Load(load) = prescribed else {
            return self.run(distance, prescribed, pressure);
        };
        let (bound, most) = (self.pressure_bound, self.most());
        if !self.ends && load >= most {
            return Err(NormalError::Bound { load, bound, most });
        }
        self.pressure_bound = f64::INFINITY;
        let free = self.run(distance, prescribed, pressure);
        self.pressure_bound = bound;
        let free = free?;
        match pressure.iter().all(|value| *value <= bound) {
            true => Ok(free),
            false => self.search(distance, load, pressure, &free),
        }
    }

    /// Load of the grid at the bound of the pressure everywhere [N].
    fn most(&self) -> f64 {
        self.pressure_bound * self.area * self.work.image.len() as f64
    }

    /// Finds the approach that carries the load, starting from the approach without a bound.
    fn search(
        &mut self,
        distance: &[f64],
        load: f64,
        pressure: &mut [f64],
        free: &NormalContact,
    ) -> Result<NormalContact, NormalError> {
        let closest = distance.iter().copied().fold(f64::INFINITY, f64::min);
        let (mut iterations, mut convolutions) = (free.iterations, free.convolutions);
        let [mut low, mut high]: [Option<(f64, f64)>; 2] = [None, None];
        let (mut penetration, mut side) = (free.approach - closest, 0);
        let mut residual = f64::INFINITY;
        for _ in 0..MOST_STEPS {
            let approach = Prescribed::Approach(closest + penetration);
            let found = self.run(distance, approach, pressure)?;
            iterations += found.iterations;
            convolutions += found.convolutions;
            let missing = load - found.normal_force;
            residual = missing.abs() / load;
            // A contact that has outgrown a grid that ends needs a larger one.
            if residual <= TOLERANCE || (found.touches_edge && missing > 0.0) {
                return Ok(NormalContact { iterations, convolutions, ..found });
            }
            let (end, other) =
                if missing > 0.0 { (&mut low, &mut high) } else { (&mut high, &mut low) };
            *end = Some((penetration, missing));
            if let Some((_, other)) = other.as_mut().filter(|_| side * missing.signum() as i32 > 0)
            {
                *other *= 0.5;
            }
            side = missing.signum() as i32;
            penetration = match (low, high) {
                (Some((a, below)), Some((b, above))) => a + (b - a) * (below / (below - above)),
                _ => penetration * (load / found.normal_force).max(GROWTH),
            };
        }
        Err(NormalError::NotConverged { iterations, residual, tolerance: TOLERANCE })
    }
}
