//! Normal contact of viscoelastic bodies, whose influence numbers K are not symmetric.
//!
//! The contact is not the minimum of an energy. K + Kᵀ is still positive definite, so there is one
//! solution, and points with p > 0, e > 0 and p·e = μ in every element lead to it as μ → 0. A
//! Newton step from (p, e, δ) towards the target μ solves
//!
//! (K + e/p) dp − dδ = −(h + K p − δ) + μ/p,   Σ dp = 0,   de = (μ − p e − e dp)/p,
//!
//! where dδ and the sum apply under a given load only. The step is cut where p or e would become
//! negative, and the longer it was, the more μ is reduced. The first δ is below all h + K p, so
//! that only μ has to be reduced.
//!
//! Rows are weighted by w = K₀/(K₀ + e/p), with K₀ the number of an element on itself, because e/p
//! is unbounded outside the contact. GMRES is preconditioned by the inverse of K's symbol, cut to
//! the elements with e/p < K₀, and by 1/(K₀ + e/p) elsewhere; dδ is chosen so that the sum holds.
//!
//! An active-set method, which guesses the elements in contact and corrects the guess, would cost
//! half as much. It cycles if the delayed compliance is ten times the instantaneous one, since the
//! surface then yields more behind the load than under it.
//!
//! Sources: M. Kojima, N. Megiddo, T. Noma and A. Yoshise, *A Unified Approach to Interior Point
//! Algorithms for Linear Complementarity Problems* (1991); Keller, Gould and Wathen, SIAM J. Matrix
//! Anal. Appl. 21 (2000) 1300, for the constraint in the preconditioner.
//!
//! Round contacts at a/10 to a/30 take 30 to 210 products with K, for f from 0.1 to 100 and l/a
//! from 10⁻³ to 10³ (at a/16 in the test `a_memory_of_any_length`); elastic contacts take 6. A line
//! of 200 elements takes 70 for f ≤ 1, and 740 in the worst case of f = 100.

use super::point::InteriorPoint;
use super::preconditioner::Preconditioner;
use super::{
    Flexibility, NormalContact, NormalError, NormalSolver, Prescribed, Progress, dot, restore_load,
};
use numerics::gmres::Preconditioned;

/// Limit of Newton steps.
const MOST_STEPS: usize = 100;
/// Smallest pressure at the start, over the mean.
const FIRST_PRESSURE: f64 = 0.03;
/// Smallest gap at the start, over the mean displacement.
const FIRST_GAP: f64 = 0.1;
/// Reduction of the linear residual in GMRES.
const REDUCTION: f64 = 0.1;
/// Share of the way to the nearest bound that a step may go.
const NEAR: f64 = 0.98;

impl NormalSolver {
    /// Solves, starting from this pressure.
    pub(super) fn interior_point(
        &mut self,
        distance: &[f64],
        prescribed: Prescribed,
        pressure: &mut [f64],
        point: &mut InteriorPoint,
    ) -> Result<NormalContact, NormalError> {
        self.start(distance, prescribed, pressure);
        let mut progress = Progress::start();
        let mean = self.first_point(distance, prescribed, pressure, point, &mut progress);
        let scale = self.mean_displacement(pressure, 1.0);
        let mut aim = 0.1;
        for _ in 0..MOST_STEPS {
            let product = dot(pressure, &point.gap) / pressure.len() as f64;
            progress.residual =
                self.linearise(distance, pressure, point, progress.approach, aim * product) / scale;
            let apart = product / (mean * scale);
            if progress.residual <= self.tolerance && apart <= self.tolerance.powi(2) {
                self.finish(prescribed, pressure, point, &mut progress);
                return Ok(self.result(pressure, &progress));
            }
            if !progress.residual.is_finite() {
                break;
            }
            self.find_step(prescribed, point, &mut progress);
            let length = point.advance(pressure, aim * product);
            progress.approach += length * point.step.get(pressure.len()).unwrap_or(&0.0);
            self.flexibility.apply(pressure, &mut self.work.displacement);
            progress.convolutions += 1;
            aim = if length > 0.9 {
                0.05
            } else if length > 0.5 {
                0.2
            } else {
                0.5
            };
        }
        Err(NormalError::NotConverged {
            iterations: progress.iterations,
            residual: progress.residual,
            tolerance: self.tolerance,
        })
    }

    /// Lifts pressures and gaps off their bounds; returns the mean pressure of the contact [Pa].
    fn first_point(
        &mut self,
        distance: &[f64],
        prescribed: Prescribed,
        pressure: &mut [f64],
        point: &mut InteriorPoint,
        progress: &mut Progress,
    ) -> f64 {
        let loaded = pressure.iter().filter(|p| **p > 0.0).count();
        let mean = pressure.iter().sum::<f64>() / loaded as f64;
        pressure.iter_mut().for_each(|p| *p = p.max(FIRST_PRESSURE * mean));
        restore_load(prescribed, self.area, pressure);
        self.flexibility.apply(pressure, &mut self.work.displacement);
        progress.convolutions += 1;
        let least = FIRST_GAP * self.mean_displacement(pressure, 1.0);
        let closed = |at: usize| distance[at] + self.work.displacement[at];
        progress.approach = match prescribed {
            Prescribed::Approach(approach) => approach,
            Prescribed::Load(_) => {
                (0..pressure.len()).map(closed).fold(f64::INFINITY, f64::min) - least
            }
        };
        for (at, gap) in point.gap.iter_mut().enumerate() {
            *gap = (closed(at) - progress.approach).max(least);
        }
        mean
    }

    /// Computes the weighted right side for the target p·e = `product` [Pa m]. Returns the weighted
    /// root mean square of the difference between the gaps and those under the pressures [m].
    fn linearise(
        &self,
        distance: &[f64],
        pressure: &[f64],
        point: &mut InteriorPoint,
        approach: f64,
        product: f64,
    ) -> f64 {
        let (mut squares, mut weights) = (0.0, 0.0);
        for (at, p) in pressure.iter().enumerate() {
            let true_gap = distance[at] + self.work.displacement[at] - approach;
            point.stiffness[at] = point.gap[at] / p;
            let weight = point.own / (point.own + point.stiffness[at]);
            squares += (weight * (true_gap - point.gap[at])).powi(2);
            weights += weight;
            point.right[at] = weight * (product / p - true_gap);
        }
        (squares / weights).sqrt()
    }

    /// Solves for dp, and for dδ under a given load.
    fn find_step(
        &mut self,
        prescribed: Prescribed,
        point: &mut InteriorPoint,
        progress: &mut Progress,
    ) {
        let InteriorPoint { gmres, own, stiffness, right, punch, step, .. } = point;
        let bordered = matches!(prescribed, Prescribed::Load(_));
        let mut system = System {
            flexibility: &mut self.flexibility,
            preconditioner: &mut self.preconditioner,
            field: &mut self.work.direction,
            image: &mut self.work.image,
            own: *own,
            stiffness,
            punch: &[],
        };
        step.clear();
        step.resize(right.len(), 0.0);
        if bordered {
            system.approximate(|_| 1.0, punch);
            progress.convolutions += 1;
            system.punch = punch;
            step.push(0.0);
        }
        let achieved = gmres.solve(&mut system, right, REDUCTION, step);
        progress.iterations += achieved.steps;
        progress.convolutions += 2 * achieved.steps;
    }

    /// Sets the pressure of elements outside the contact to zero.
    fn finish(
        &mut self,
        prescribed: Prescribed,
        pressure: &mut [f64],
        point: &InteriorPoint,
        progress: &mut Progress,
    ) {
        for (p, gap) in pressure.iter_mut().zip(&point.gap) {
            if *gap > point.own * *p {
                *p = 0.0;
            }
        }
        restore_load(prescribed, self.area, pressure);
        self.flexibility.apply(pressure, &mut self.work.displacement);
        progress.convolutions += 1;
    }
}

impl InteriorPoint {
    /// Takes the step towards p·e = `product`, as far as pressures and gaps stay positive; returns
    /// the share taken.
    fn advance(&mut self, pressure: &mut [f64], product: f64) -> f64 {
        let mut most = f64::INFINITY;
        for (at, p) in pressure.iter().enumerate() {
            let (gap, by) = (self.gap[at], self.step[at]);
            let opens = (product - gap * by) / p - gap;
            self.right[at] = opens;
            for (value, by) in [(*p, by), (gap, opens)] {
                if by < 0.0 {
                    most = most.min(-value / by);
                }
            }
        }
        let length = (NEAR * most).min(1.0);
        for (at, p) in pressure.iter_mut().enumerate() {
            *p += length * self.step[at];
            self.gap[at] += length * self.right[at];
        }
        length
    }
}

/// Linear system of a Newton step.
struct System<'a> {
    flexibility: &'a mut Flexibility,
    preconditioner: &'a mut Preconditioner,
    field: &'a mut [f64],
    image: &'a mut [f64],
    own: f64,
    stiffness: &'a [f64],
    /// Empty where the approach is given.
    punch: &'a [f64],
}

impl System<'_> {
    /// Sets out ≈ (K + e/p)⁻¹ x.
    fn approximate(&mut self, x: impl Fn(usize) -> f64, out: &mut [f64]) {
        let touches = |at: usize| self.stiffness[at] < self.own;
        for (at, value) in self.field.iter_mut().enumerate() {
            *value = if touches(at) { x(at) } else { 0.0 };
        }
        self.preconditioner.apply(self.field, self.image);
        for (at, out) in out.iter_mut().enumerate() {
            *out = match touches(at) {
                true => self.image[at],
                false => x(at) / (self.own + self.stiffness[at]),
            };
        }
    }
}

impl Preconditioned for System<'_> {
    fn operate(&mut self, x: &[f64], out: &mut [f64]) {
        let (steps, approach) = x.split_at(self.stiffness.len());
        self.flexibility.apply(steps, self.image);
        let approach = approach.first().unwrap_or(&0.0);
        for (at, out) in out.iter_mut().enumerate() {
            let stiffness = self.stiffness[at];
            let weight = self.own / (self.own + stiffness);
            *out = weight * (self.image[at] + stiffness * steps[at] - approach);
        }
    }

    fn precondition(&mut self, x: &[f64], out: &mut [f64]) {
        let (steps, approach) = out.split_at_mut(self.stiffness.len());
        let (own, stiffness) = (self.own, self.stiffness);
        self.approximate(|at| x[at] * (own + stiffness[at]) / own, steps);
        if let Some(approach) = approach.first_mut() {
            *approach = -steps.iter().sum::<f64>() / self.punch.iter().sum::<f64>();
            steps.iter_mut().zip(self.punch).for_each(|(step, w)| *step += *approach * w);
        }
    }
}
