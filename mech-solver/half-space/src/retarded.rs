//! Viscoelastic half-spaces that are pressed and shifted in place, step by step.
//!
//! Each body is the standard linear solid of [`super::viscoelastic`] with the compliance
//! J(t) = J [1 + f (1 − e^{−t/τ})]. Stresses of a half-space under given tractions do not depend on
//! the compliance, and displacements follow by superposition in time. With A of both bodies'
//! instantaneous response and f A_b of the delayed response of body b,
//!
//! u(t) = A p(t) + Σ f A_b r_b(t),   τ_b dr_b/dt = p − r_b,
//!
//! for the pressure and both tractions, element by element. r is the *retarded* load, which the
//! Kelvin–Voigt element of the body has followed. If p is linear over a step of the duration h,
//!
//! r' = e r + α p + β p',   e = e^{−h/τ},   β = 1 − (1 − e) τ/h,   α = 1 − e − β,
//!
//! is exact (primes: the end of the step). Within a step the bodies are elastic, with
//! A + Σ f β A_b, on top of the displacements f A_b (e r + α p) by the earlier loads.
//!
//! **Energy.** ½ p·A p + Σ ½ r·f A_b r is stored. The rest of the work done by the loads is
//! dissipated in the bodies.
//!
//! Source: E. H. Lee and J. R. M. Radok, J. Appl. Mech. 27 (1960) 438, for contacts that grow. The
//! recursion is the exponential integration of the rate equation.

use super::aligned::AlignedGrid;
use super::coupling::Coupling;
use super::difference::Stencil;
use super::influence::Influence;
use super::slip_operator::{Accuracy, Displacement, RowInfluence};
use super::viscoelastic::Retardation;
use elastic::Elasticity;
use elastic::Material;
use grids::Structured;
use numerics::convolution::{Convolution, Spectrum};

/// Value of h/τ below which β is taken from its series.
const SHORT: f64 = 1e-4;

/// Pressure and tractions along x and y [Pa], or the displacements by them [m], element by element.
pub type Field3 = [Vec<f64>; 3];

/// Retarded compliance of a body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Delay {
    /// Elastic constants of the delayed compliance f J.
    pub elasticity: Elasticity,
    /// Retardation time τ [s].
    pub time: f64,
}

impl Delay {
    /// Returns the retarded compliances of two bodies, merged if their retardation times are equal.
    #[must_use]
    pub fn of(materials: &[Material; 2], retardation: &[Option<Retardation>; 2]) -> Vec<Self> {
        let mut found: Vec<Self> = Vec::new();
        for (share, body) in Elasticity::of_bodies(materials).iter().zip(retardation) {
            let Some(Retardation { ratio, time }) = *body else { continue };
            let elasticity = share.scaled(ratio);
            match found.iter_mut().find(|one| one.time == time) {
                Some(one) => one.elasticity = one.elasticity.plus(&elasticity),
                None => found.push(Self { elasticity, time }),
            }
        }
        found
    }
}

/// Shares e, α and β of the retarded load at the end of a step; `h` is the duration over τ.
fn shares(h: f64) -> [f64; 3] {
    let decay = (-h).exp();
    let end = if h < SHORT { h * (0.5 - h / 6.0) } else { 1.0 + (-h).exp_m1() / h };
    [decay, -(-h).exp_m1() - end, end]
}

/// Elastic constants of the response within a step of this duration [s].
#[must_use]
pub fn within_step(at_once: Elasticity, delays: &[Delay], duration: f64) -> Elasticity {
    delays.iter().fold(at_once, |sum, Delay { elasticity, time }| {
        let [.., end] = shares(duration / time);
        sum.plus(&elasticity.scaled(end))
    })
}

/// Displacement operators for the loads of one [`Delay`].
#[derive(Debug)]
struct Flexibility {
    normal: (Convolution, Spectrum),
    tangential: Displacement,
    coupling: Option<Coupling>,
    part: [Vec<f64>; 2],
}

impl Flexibility {
    fn new(grid: &Structured, elasticity: Elasticity) -> Self {
        let influence = Influence::of_grid(grid, elasticity);
        let (nx, ny) = (grid.ni, grid.nj);
        let mut convolution = Convolution::new(nx, ny);
        let spectrum = convolution.spectrum(|i, j| influence.zz(i, j));
        let rows = AlignedGrid::regular(*grid);
        let zeros = || vec![0.0; grid.points()];
        Self {
            normal: (convolution, spectrum),
            tangential: RowInfluence::new(&rows, &elasticity.into(), 0.0, Accuracy::Full).into(),
            coupling: elasticity
                .is_coupled()
                .then(|| Coupling::new(&influence, nx, ny, Stencil::DISPLACEMENT)),
            part: [zeros(), zeros()],
        }
    }

    /// Sets displacement = A load.
    fn apply(&mut self, load: &Field3, displacement: &mut Field3) {
        let [pressure, px, py] = load;
        let [along_z, along_x, along_y] = displacement;
        let Self { normal: (convolution, spectrum), tangential, coupling, part } = self;
        convolution.apply(spectrum, pressure, along_z);
        tangential.apply([px, py], [&mut *along_x, &mut *along_y]);
        let Some(coupling) = coupling else { return };
        let [one, other] = part;
        coupling.slip_by_pressure(pressure, [&mut *one, &mut *other]);
        add(along_x, one);
        add(along_y, other);
        coupling.distance_by_traction([px, py], one);
        add(along_z, one);
    }
}

/// Operators of the delayed displacements on one grid.
#[derive(Debug)]
pub struct RetardedOperators {
    delays: Vec<(Delay, Flexibility)>,
    load: Field3,
    image: Field3,
}

impl RetardedOperators {
    /// Creates the operators of these delayed compliances.
    #[must_use]
    pub fn new(grid: &Structured, delays: &[Delay]) -> Self {
        let operator = |delay: &Delay| (*delay, Flexibility::new(grid, delay.elasticity));
        let delays = delays.iter().map(operator).collect();
        Self { delays, load: zeros(grid.points()), image: zeros(grid.points()) }
    }

    /// Retarded loads of bodies that have never been loaded.
    #[must_use]
    pub fn fresh(&self) -> Vec<Field3> {
        self.delays.iter().map(|_| zeros(self.load[0].len())).collect()
    }

    /// Displacement at the end of a step of this duration [s] by the retarded loads and the loads
    /// before the step [m].
    pub fn recall(
        &mut self,
        retarded: &[Field3],
        before: [&[f64]; 3],
        duration: f64,
        displaced: &mut Field3,
    ) {
        let Self { delays, load, image } = self;
        displaced.iter_mut().for_each(|one| one.fill(0.0));
        for ((Delay { time, .. }, flexibility), retarded) in delays.iter_mut().zip(retarded) {
            let [decay, start, _] = shares(duration / *time);
            for ((load, retarded), before) in load.iter_mut().zip(retarded).zip(before) {
                for ((load, r), p) in load.iter_mut().zip(retarded).zip(before) {
                    *load = decay * r + start * p;
                }
            }
            flexibility.apply(load, image);
            displaced.iter_mut().zip(&*image).for_each(|(sum, part)| add(sum, part));
        }
    }

    /// Advances the retarded loads over a step from the loads `before` to the loads `after`.
    pub fn follow(
        &self,
        retarded: &mut [Field3],
        before: [&[f64]; 3],
        after: [&[f64]; 3],
        duration: f64,
    ) {
        for ((Delay { time, .. }, _), retarded) in self.delays.iter().zip(retarded) {
            let [decay, start, end] = shares(duration / time);
            for ((retarded, before), after) in retarded.iter_mut().zip(before).zip(after) {
                for ((r, p), q) in retarded.iter_mut().zip(before).zip(after) {
                    *r = decay * *r + start * p + end * q;
                }
            }
        }
    }

    /// Stored energy over the area of an element [Pa m], along the normal and in the plane, for
    /// loads with these displacements [m].
    pub fn stored(
        &mut self,
        retarded: &[Field3],
        load: [&[f64]; 3],
        displacement: [&[f64]; 3],
    ) -> [f64; 2] {
        let product = |one: [&[f64]; 3], other: [&[f64]; 3]| {
            let of = |k: usize| one[k].iter().zip(other[k]).map(|(p, u)| p * u).sum::<f64>();
            [of(0), of(1) + of(2)]
        };
        let mut twice = product(load, displacement);
        for ((_, flexibility), retarded) in self.delays.iter_mut().zip(retarded) {
            flexibility.apply(retarded, &mut self.image);
            let image = self.image.each_ref().map(Vec::as_slice);
            let own = product(retarded.each_ref().map(Vec::as_slice), image);
            let with = product(load, image);
            (0..2).for_each(|k| twice[k] += own[k] - with[k]);
        }
        twice.map(|value| 0.5 * value)
    }
}

fn zeros(count: usize) -> Field3 {
    [0, 1, 2].map(|_| vec![0.0; count])
}

fn add(sum: &mut [f64], more: &[f64]) {
    sum.iter_mut().zip(more).for_each(|(sum, more)| *sum += more);
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The shares over any duration, and on both sides of the series, against small steps of
    /// τ r' = p − r.
    #[test]
    fn shares_of_a_step() {
        for h in [1e-9, 0.99 * SHORT, 1.01 * SHORT, 0.3, 2.0, 50.0] {
            let [decay, start, end] = shares(h);
            assert!((decay + start + end - 1.0).abs() < 1e-15, "a constant load is followed: {h}");
            let steps = 20_000;
            let (mut from_start, mut from_end) = (0.0, 0.0);
            for k in 0..steps {
                let at = (f64::from(k) + 0.5) / f64::from(steps);
                let weight = h / f64::from(steps) * (-h * (1.0 - at)).exp();
                from_start += weight * (1.0 - at);
                from_end += weight * at;
            }
            // Tolerance: the midpoint rule of so many steps, and rounding ε/h of
            // 1 + (e^{−h} − 1)/h.
            for (found, expected) in [(start, from_start), (end, from_end)] {
                assert!(
                    (found - expected).abs() <= 2e-5 * expected + 1e-15,
                    "{h}: {found} {expected}"
                );
            }
        }
    }
}
