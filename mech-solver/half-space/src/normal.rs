//! Normal contact of two elastic half-spaces by bound-constrained conjugate gradients.
//!
//! The unknowns are the pressures p of the elements; h is the undeformed distance of the surfaces
//! at the elements' centres [m], u = A p the elastic displacement difference with the influence
//! numbers A [m/Pa] of [`super::influence`], δ the approach. With the gap e = h + u − δ,
//!
//! p ≥ 0, e ≥ 0, p·e = 0 in every element,
//!
//! and either δ is given, or the load N = Σ p dx dy, which then determines δ. The solution
//! minimises ½ pᵀA p + (h − δ)ᵀp over p ≥ 0.
//!
//! The elements in contact, C, have the residual r = δ − h − u. A step goes along d = z + β d with
//! z = M r and β = max(0, zᵀ(r − r')/z'ᵀr') (Polak–Ribière; primes: previous step), by the length
//! dᵀr/dᵀA d. Negative pressures are then cut to zero and leave C, and elements that interpenetrate
//! without pressure join C. M is the inverse of A's symbol on the padded grid, cut to C. As A is
//! 2E*/|k| for long waves, the number of iterations hardly grows with the resolution. Under a given
//! load δ is chosen in every step so that Σ z = 0, with w = M 1 on C: z = M(−h − u) + δ w. Steps
//! thus keep the load; after a cut, scaling p restores it. M is in single precision and acts on
//! the residual at the mean of h + u, weighted with p.
//!
//! The pressure may have an upper bound p̂, [`NormalSolver::pressure_bound`], at which e ≤ 0: the
//! remaining interpenetration is the depth to which the bodies have yielded. Elements at the bound
//! leave C like those without pressure, and return when they open. A given load is then found by
//! iterating on the approach ([`mod@bounded`]), unless the pressure stays below the bound.
//!
//! Source: E. A. H. Vollebregt, The bound-constrained conjugate gradient method for non-negative
//! matrices, J. Optim. Theory Appl. 162 (2014) 931; I. A. Polonsky and L. M. Keer, Wear 231 (1999)
//! 206, for the given load. Deviation: the load is held by the preconditioned projection above
//! rather than by removing the mean of r.
//!
//! Accuracy on a Hertz contact, a/b = 1.33, square elements, load given; relative errors:
//!
//! | elements per a | p_0 | δ | a | b | area of C | iterations |
//! |---|---|---|---|---|---|---|
//! | 10 | 5.5e-4 | −6.1e-4 | 6.4e-4 | 3.7e-3 | 4.5e-2 | 7 |
//! | 20 | 2.2e-4 | −7.2e-5 | 1.4e-4 | 4.1e-4 | 1.9e-2 | 9 |
//! | 40 | 4.8e-5 | −2.5e-5 | 4.8e-5 | 1.0e-4 | 9.5e-3 | 10 |
//! | 80 | 1.0e-5 | −7.9e-6 | 1.1e-5 | 3.3e-5 | 4.3e-3 | 12 |
//! | 160 | 2.3e-6 | −2.2e-6 | 3.0e-6 | 8.6e-6 | 2.2e-3 | 14 |
//!
//! a and b are those of [`super::extent::Moments`]. Elements cut by the edge of the contact carry
//! pressure too, so the number of elements in C has a positive first-order error.

mod bounded;
mod error;
mod interior_point;
mod point;
mod preconditioner;
mod workspace;

pub use super::prescribed::Prescribed;
pub use error::NormalError;

use super::influence::{EvenOffsetTable, Influence};
use super::initial_pressure;
use super::viscoelastic::{Bodies, RollingInfluenceNumbers};
use numerics::convolution::{Complex64, Convolution, EvenSpectrum, Spectrum};
use numerics::rows::{Kernel, Rows};
use numerics::vector::dot;
use point::InteriorPoint;
use preconditioner::Preconditioner;
use std::f64::consts::TAU;
use workspace::Workspace;

/// Result of a normal contact; the pressure is in the caller's field.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NormalContact {
    /// Approach δ [m]; the smallest distance when nothing touches under a load of zero.
    pub approach: f64,
    /// Load Σ p dx dy [N].
    pub normal_force: f64,
    /// Number of elements in contact.
    pub contact_elements: usize,
    /// An element at the edge of the grid is in contact, so the grid may be too small. Under a
    /// bound of the pressure such a contact may carry less than a given load. Always false for a
    /// contact that repeats.
    pub touches_edge: bool,
    /// Iterations, each with one convolution by A and one by M.
    pub iterations: usize,
    /// Total number of convolutions, a count of the work.
    pub convolutions: usize,
    /// Root mean square of the gap over C, relative to the mean elastic displacement [-].
    pub residual: f64,
}

/// Solver of normal contacts on one grid for one pair of bodies.
///
/// Keeps plans, spectra and working memory; [`NormalSolver::solve`] allocates nothing.
#[derive(Debug)]
pub struct NormalSolver {
    /// Residual at which the iteration ends [-].
    pub tolerance: f64,
    /// Limit of iterations.
    pub iteration_limit: usize,
    /// Largest pressure p̂ that the bodies carry [Pa]; infinite by default.
    pub pressure_bound: f64,
    /// True if the grid ends; a contact that repeats has no edge.
    ends: bool,
    /// Operator A.
    flexibility: Flexibility,
    /// M.
    preconditioner: Preconditioner,
    shape: (usize, usize),
    area: f64,
    compliance: f64,
    /// Working memory for viscoelastic bodies.
    point: Option<InteriorPoint>,
    work: Workspace,
}

/// Operator A of elastic or viscoelastic half-spaces, or of bodies with a curved surface.
#[derive(Debug)]
enum Flexibility {
    Elastic(Convolution, EvenSpectrum),
    Viscoelastic(Convolution, Spectrum),
    Curved(Rows, Kernel),
}

impl Flexibility {
    fn apply(&mut self, pressure: &[f64], displacement: &mut [f64]) {
        match self {
            Self::Elastic(convolution, spectrum) => {
                convolution.apply_even(spectrum, pressure, displacement);
            }
            Self::Viscoelastic(convolution, spectrum) => {
                convolution.apply(spectrum, pressure, displacement);
            }
            Self::Curved(rows, kernel) => rows.apply(&[(kernel, pressure)], displacement),
        }
    }
}

/// Scalars of the iteration.
struct Progress {
    approach: f64,
    iterations: usize,
    convolutions: usize,
    contact_elements: usize,
    residual: f64,
    /// zᵀr of the previous step.
    last_product: f64,
    /// The displacement u has to be recomputed.
    stale: bool,
    /// C has changed since w was computed.
    new_contact: bool,
}

impl NormalSolver {
    /// Default tolerance of the residual: far below the error of any grid.
    pub const TOLERANCE: f64 = 1e-9;
    /// Default limit of iterations.
    pub const ITERATION_LIMIT: usize = 500;

    /// Creates a solver for grids of nx × ny elements.
    #[must_use]
    pub fn new(nx: usize, ny: usize, influence: &Influence) -> Self {
        let quarter = EvenOffsetTable::new(nx, ny, |i, j| influence.zz(i, j));
        let mut convolution = Convolution::new(nx, ny);
        let flexibility = convolution.spectrum(|i, j| quarter.value(i, j)).even();
        Self::with(
            Flexibility::Elastic(convolution, flexibility),
            Preconditioner::new(nx, ny, |i, j| quarter.value(i, j)),
            [nx, ny],
            [influence.dx, influence.dy],
            influence.elasticity.contact_compliance(),
        )
    }

    /// Creates a solver for bodies with a curved surface, from the symmetric influence numbers of a
    /// kernel. `influence` holds the numbers of similar half-spaces. A single column is a line
    /// across, with half-spaces in plane strain.
    #[must_use]
    pub fn curved(rows: Rows, kernel: Kernel, influence: &Influence) -> Self {
        let (nx, ny) = match rows.shape() {
            (1, ny) => (ny, 1),
            shape => shape,
        };
        let half_spaces = Self::new(nx, ny, influence);
        Self { flexibility: Flexibility::Curved(rows, kernel), ..half_spaces }
    }

    /// Creates a solver on grids of nx × ny elements dx × dy [m]. Viscoelastic bodies are taken in
    /// steady rolling ([`mod@interior_point`]), without a bound of the pressure.
    #[must_use]
    pub fn of_bodies(nx: usize, ny: usize, [dx, dy]: [f64; 2], bodies: &Bodies) -> Self {
        let mut at_once = Influence::of_elements([dx, dy], bodies.instantaneous);
        if !bodies.remember() {
            at_once.plane_strain = ny == 1;
            return Self::new(nx, ny, &at_once);
        }
        let numbers =
            RollingInfluenceNumbers::new([nx, ny], [dx, dy], bodies, |of, x, y| [of.zz_at(x, y)]);
        let mut convolution = Convolution::new(nx, ny);
        let flexibility = convolution.spectrum(|i, j| numbers.value(i, j)[0]);
        let preconditioner = Preconditioner::new(nx, ny, |i, j| at_once.zz(i, j))
            .with_factors(|upstream| bodies.growth(upstream, dx).inv());
        let flexibility = Flexibility::Viscoelastic(convolution, flexibility);
        let point = InteriorPoint::new(numbers.value(0, 0)[0], nx * ny);
        let compliance = bodies.relaxed().contact_compliance();
        let solver = Self::with(flexibility, preconditioner, [nx, ny], [dx, dy], compliance);
        Self { point: Some(point), ..solver }
    }

    /// Creates a solver for a contact that repeats every nx × ny elements dx × dy [m], nx even. A
    /// wave of the pressure with the wave number k displaces the surfaces by 2c p/k (Johnson,
    /// Contact Mechanics (1985), 13.2), with the normal compliance c of the pair [1/Pa]. The mean
    /// displacement of infinite bodies is undefined, and the displacement of the longest wave takes
    /// its place. The approach thus counts from a plane in which a mean pressure p̄ leaves 2c p̄/k.
    ///
    /// # Panics
    /// If nx is odd.
    #[must_use]
    pub fn repeating(nx: usize, ny: usize, [dx, dy]: [f64; 2], compliance: f64) -> Self {
        let convolution = Convolution::cyclic(nx, ny);
        let sides = [nx as f64 * dx, ny as f64 * dy];
        let longest = if ny > 1 { sides[0].max(sides[1]) } else { sides[0] };
        let wave_number = |k: i32, l: i32| {
            let numbers = [f64::from(k) / sides[0], f64::from(l) / sides[1]];
            TAU * if (k, l) == (0, 0) { longest.recip() } else { numbers[0].hypot(numbers[1]) }
        };
        let factor = |k, l| Complex64::new(2.0 * compliance / wave_number(k, l), 0.0);
        let flexibility = convolution.factors(factor);
        let inverse = flexibility.map(|value| Complex64::new(1.0 / value.re, 0.0));
        let preconditioner = Preconditioner::of(Convolution::cyclic(nx, ny), &inverse.even());
        let flexibility = Flexibility::Elastic(convolution, flexibility.even());
        let solver = Self::with(flexibility, preconditioner, [nx, ny], [dx, dy], compliance);
        Self { ends: false, ..solver }
    }

    fn with(
        flexibility: Flexibility,
        preconditioner: Preconditioner,
        [nx, ny]: [usize; 2],
        [dx, dy]: [f64; 2],
        compliance: f64,
    ) -> Self {
        Self {
            tolerance: Self::TOLERANCE,
            iteration_limit: Self::ITERATION_LIMIT,
            pressure_bound: f64::INFINITY,
            ends: true,
            flexibility,
            preconditioner,
            shape: (nx, ny),
            area: dx * dy,
            compliance,
            point: None,
            work: Workspace::new(nx * ny),
        }
    }

    /// Number of elements along x and along y.
    #[must_use]
    pub fn shape(&self) -> (usize, usize) {
        self.shape
    }

    /// Displacement u = A p of the latest pressure [m].
    #[must_use]
    pub fn displacement(&self) -> &[f64] {
        &self.work.displacement
    }

    /// Solves for the pressure [Pa] at the undeformed distance h [m] of every element.
    ///
    /// `pressure` is the first guess on entry. If it is zero everywhere, a guess is made from
    /// `distance` and the prescribed value. Negative values count as zero.
    ///
    /// # Errors
    /// The load is negative, a value is not finite, the iteration does not converge, or a contact
    /// that repeats cannot carry the load under the bound of the pressure.
    ///
    /// # Panics
    /// If a field does not have the size of the grid.
    pub fn solve(
        &mut self,
        distance: &[f64],
        prescribed: Prescribed,
        pressure: &mut [f64],
    ) -> Result<NormalContact, NormalError> {
        let len = self.work.image.len();
        assert!(distance.len() == len && pressure.len() == len, "{len} values are expected");
        error::check(distance, prescribed)?;
        let closest = distance.iter().copied().fold(f64::INFINITY, f64::min);
        let nothing = match prescribed {
            Prescribed::Load(load) => load == 0.0,
            Prescribed::Approach(approach) => approach <= closest,
        };
        if nothing {
            pressure.fill(0.0);
            return Ok(separated(prescribed, closest));
        }
        if let Some(mut point) = self.point.take() {
            let found = self.interior_point(distance, prescribed, pressure, &mut point);
            self.point = Some(point);
            return found;
        }
        if self.pressure_bound < f64::INFINITY {
            return self.bounded(distance, prescribed, pressure);
        }
        self.run(distance, prescribed, pressure)
    }

    /// Iterates, starting from this pressure.
    fn run(
        &mut self,
        distance: &[f64],
        prescribed: Prescribed,
        pressure: &mut [f64],
    ) -> Result<NormalContact, NormalError> {
        self.start(distance, prescribed, pressure);
        let mut progress = Progress::start();
        while !self.iterate(distance, prescribed, pressure, &mut progress) {
            if progress.iterations >= self.iteration_limit || !progress.residual.is_finite() {
                return Err(NormalError::NotConverged {
                    iterations: progress.iterations,
                    residual: progress.residual,
                    tolerance: self.tolerance,
                });
            }
        }
        Ok(self.result(pressure, &progress))
    }

    /// Makes the first pressure admissible for the iteration.
    fn start(&mut self, distance: &[f64], prescribed: Prescribed, pressure: &mut [f64]) {
        pressure.iter_mut().for_each(|value| *value = value.max(0.0));
        let load: f64 = pressure.iter().sum::<f64>() * self.area;
        if !(load > 0.0 && load.is_finite()) {
            initial_pressure::fill(distance, prescribed, self.area, self.compliance, pressure);
        }
        restore_load(prescribed, self.area, pressure);
        for (flag, value) in self.work.in_contact.iter_mut().zip(pressure.iter_mut()) {
            *value = value.min(self.pressure_bound);
            *flag = *value > 0.0 && *value < self.pressure_bound;
        }
        self.work.direction.fill(0.0);
        self.work.residual.fill(0.0);
    }

    /// Performs one iteration; returns true if the state before it is the solution.
    fn iterate(
        &mut self,
        distance: &[f64],
        prescribed: Prescribed,
        pressure: &mut [f64],
        progress: &mut Progress,
    ) -> bool {
        if progress.stale {
            self.flexibility.apply(pressure, &mut self.work.displacement);
            progress.convolutions += 1;
            progress.stale = false;
        }
        let violation = self.release(distance, prescribed, pressure, progress);
        self.precondition(distance, prescribed, progress);
        let residual = self.work.root_mean_square(progress.contact_elements);
        let scale = self.mean_displacement(pressure, residual);
        progress.residual = residual / scale;
        if progress.residual <= self.tolerance && violation <= self.tolerance * scale {
            return true;
        }
        progress.iterations += 1;
        self.choose_direction(prescribed, progress);
        self.advance(prescribed, pressure, progress);
        false
    }

    /// Adds elements without pressure that interpenetrate, and elements at the bound that open, to
    /// C, and estimates δ under a given load. Returns their largest violation.
    fn release(
        &mut self,
        distance: &[f64],
        prescribed: Prescribed,
        pressure: &[f64],
        progress: &mut Progress,
    ) -> f64 {
        let work = &mut self.work;
        let approach = match prescribed {
            Prescribed::Approach(approach) => approach,
            Prescribed::Load(_) => {
                let closed = distance.iter().zip(&work.displacement).map(|(h, u)| h + u);
                let weighted: f64 = pressure.iter().zip(closed).map(|(p, sum)| p * sum).sum();
                weighted / pressure.iter().sum::<f64>()
            }
        };
        progress.approach = approach;
        let (mut violation, mut count) = (0.0_f64, 0);
        for (at, flag) in work.in_contact.iter_mut().enumerate() {
            let penetration = approach - distance[at] - work.displacement[at];
            let wrong = if pressure[at] < self.pressure_bound { penetration } else { -penetration };
            if !*flag && wrong > 0.0 {
                *flag = true;
                progress.new_contact = true;
                violation = violation.max(wrong);
            }
            count += usize::from(*flag);
        }
        progress.contact_elements = count;
        violation
    }

    /// Computes δ, r, z and, on a new C, w.
    fn precondition(&mut self, distance: &[f64], prescribed: Prescribed, progress: &mut Progress) {
        let work = &mut self.work;
        std::mem::swap(&mut work.residual, &mut work.last_residual);
        // M is rounded to single precision, and so acts on residuals that vanish.
        let given = progress.approach;
        for (at, flag) in work.in_contact.iter().enumerate() {
            let open = given - distance[at] - work.displacement[at];
            work.residual[at] = if *flag { open } else { 0.0 };
        }
        self.preconditioner.apply(&work.residual, &mut work.step);
        progress.convolutions += 1;
        work.cut(|work| &mut work.step);
        if matches!(prescribed, Prescribed::Load(_)) {
            if progress.new_contact {
                for (value, flag) in work.image.iter_mut().zip(&work.in_contact) {
                    *value = f64::from(u8::from(*flag));
                }
                self.preconditioner.apply(&work.image, &mut work.punch);
                progress.convolutions += 1;
                work.cut(|work| &mut work.punch);
            }
            progress.approach += work.balance();
        }
        progress.new_contact = false;
    }

    /// Chooses the direction d.
    fn choose_direction(&mut self, prescribed: Prescribed, progress: &mut Progress) {
        let work = &mut self.work;
        let product = dot(&work.step, &work.residual);
        let change = product - dot(&work.step, &work.last_residual);
        let beta = if progress.last_product > 0.0 { change / progress.last_product } else { 0.0 };
        let beta = beta.max(0.0);
        progress.last_product = product;
        let direction = work.direction.iter_mut().zip(&work.step).zip(&work.in_contact);
        for ((value, step), flag) in direction {
            *value = if *flag { step + beta * *value } else { 0.0 };
        }
        if matches!(prescribed, Prescribed::Load(_)) {
            let excess = work.direction.iter().sum::<f64>() / work.punch.iter().sum::<f64>();
            for (value, punch) in work.direction.iter_mut().zip(&work.punch) {
                *value -= excess * punch;
            }
        }
    }

    /// Steps along d, cuts pressures that leave their bounds and restores the load.
    fn advance(&mut self, prescribed: Prescribed, pressure: &mut [f64], progress: &mut Progress) {
        let work = &mut self.work;
        self.flexibility.apply(&work.direction, &mut work.image);
        progress.convolutions += 1;
        let curvature = dot(&work.direction, &work.image);
        let length = dot(&work.direction, &work.residual) / curvature;
        let length = if curvature > 0.0 { length } else { 0.0 };
        for (at, value) in pressure.iter_mut().enumerate() {
            work.displacement[at] += length * work.image[at];
            *value += length * work.direction[at];
            if (*value <= 0.0 || *value >= self.pressure_bound) && work.in_contact[at] {
                *value = value.clamp(0.0, self.pressure_bound);
                work.in_contact[at] = false;
                progress.new_contact = true;
                progress.stale = true;
            }
        }
        if progress.stale {
            restore_load(prescribed, self.area, pressure);
        }
    }

    /// Mean of u, weighted with the pressure [m]; `residual` if there is no pressure.
    fn mean_displacement(&self, pressure: &[f64], residual: f64) -> f64 {
        let sum = pressure.iter().sum::<f64>();
        if sum > 0.0 { dot(pressure, &self.work.displacement) / sum } else { residual }
    }

    fn result(&self, pressure: &[f64], progress: &Progress) -> NormalContact {
        let (nx, ny) = self.shape;
        let on_edge = |at: usize| {
            let (i, j) = (at % nx, at / nx);
            let side = j == 0 || j == ny - 1;
            i == 0 || i == nx - 1 || (ny > 1 && side)
        };
        let loaded = || pressure.iter().enumerate().filter(|(_, value)| **value > 0.0);
        NormalContact {
            approach: progress.approach,
            normal_force: pressure.iter().sum::<f64>() * self.area,
            contact_elements: loaded().count(),
            touches_edge: self.ends && loaded().any(|(at, _)| on_edge(at)),
            iterations: progress.iterations,
            convolutions: progress.convolutions,
            residual: progress.residual,
        }
    }
}

impl Progress {
    fn start() -> Self {
        Self {
            approach: 0.0,
            iterations: 0,
            convolutions: 0,
            contact_elements: 0,
            residual: f64::INFINITY,
            last_product: 0.0,
            stale: true,
            new_contact: true,
        }
    }
}

/// Result for bodies that do not press on each other.
fn separated(prescribed: Prescribed, closest: f64) -> NormalContact {
    NormalContact {
        approach: match prescribed {
            Prescribed::Load(_) => closest,
            Prescribed::Approach(approach) => approach,
        },
        normal_force: 0.0,
        contact_elements: 0,
        touches_edge: false,
        iterations: 0,
        convolutions: 0,
        residual: 0.0,
    }
}

/// Scales the pressure to the load, if a load is given.
fn restore_load(prescribed: Prescribed, area: f64, pressure: &mut [f64]) {
    if let Prescribed::Load(load) = prescribed {
        let factor = load / (pressure.iter().sum::<f64>() * area);
        pressure.iter_mut().for_each(|value| *value *= factor);
    }
}

#[cfg(test)]
mod tests;
