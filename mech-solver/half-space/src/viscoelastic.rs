//! Influence numbers of viscoelastic half-spaces in steady rolling.
//!
//! Each body is a standard linear solid with a constant Poisson's ratio: under a constant stress
//! its compliance grows from the instantaneous J to (1 + f) J,
//!
//! J(t) = J [1 + f (1 − e^{−t/τ})],
//!
//! with the delayed compliance f over the instantaneous one [-] and the retardation time τ [s].
//! Kelvin's solid is the limit of a large f with a stiff instantaneous response, Maxwell's fluid
//! that of f and τ → ∞ with τ/f kept, in which the approach grows without bound.
//!
//! Stresses of a half-space under given tractions do not depend on J (correspondence principle),
//! and displacements follow by superposition in time. In a frame that moves with the contact, a
//! particle now at x was at x + s before it rolled the distance s. With A of [`super::influence`]
//! for the body's share, the number of an element is therefore
//!
//! K(x, y) = A(x, y) + f T(x, y),   T(x, y) = ∫₀^∞ A(x + s, y) e^{−s/l} ds/l,   l = V τ,
//!
//! summed over both bodies. K is not symmetric: behind the contact, x < 0, the surface is still low
//! where it was loaded. For l → 0 the body is elastic with (1 + f) J, for l → ∞ with J.
//!
//! A line of contact (a single row) is the middle of an element of finite width here, and not plane
//! strain: in a half-plane the displacement does not vanish far away, so a long memory would have
//! no end. Both differ by the square of the contact's length over the width.
//!
//! **Integration.** T(x) = e^{−h} T(x + Δx) + ∫₀^{Δx} A(x + s) e^{−s/l} ds/l with h = Δx/l,
//! starting at the farthest element ahead, whose integral uses panels that grow with the distance.
//! On a panel A is interpolated at ten Gauss points and the polynomial integrated with the
//! exponential, for any h. Along x, A has branch points abreast of the element's corners. Panels
//! are halved until their length is at most half the distance to the nearest branch point. Relative
//! errors are below 1e-9 (test `numbers_against_quadrature`).
//!
//! Sources: S. C. Hunter, J. Appl. Mech. 28 (1961) 611, for the steady state; G. Wang and K.
//! Knothe, J. Appl. Mech. 60 (1993) 310, for its discretisation in elements. The recursion is this
//! project's.

use super::influence::Influence;
use elastic::Elasticity;
use elastic::Material;
use numerics::convolution::Complex64;
use numerics::quadrature::GAUSS_10;

const POINTS: usize = GAUSS_10.len();
/// Limit of halvings of an element's side: the remaining part at the branch point is below
/// rounding.
const MOST_HALVINGS: usize = 16;
/// Exponent of the decay beyond which the memory has vanished.
const FORGOTTEN: f64 = 40.0;
/// Longest panel of the tail, in lengths of the memory.
const LONGEST: f64 = 8.0;

/// Growth of the compliance of a material.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Retardation {
    /// Delayed compliance f over the instantaneous one [-].
    pub ratio: f64,
    /// Retardation time τ [s].
    pub time: f64,
}

/// Delayed compliance of a body.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Delayed {
    /// Elastic constants of the delayed compliance f J; zero for an elastic body.
    pub elasticity: Elasticity,
    /// Distance l = V τ rolled in the retardation time [m].
    pub length: f64,
}

/// Two half-spaces in rolling.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Bodies {
    /// Elastic constants of the instantaneous response.
    pub instantaneous: Elasticity,
    /// Delayed compliance of each body.
    pub delayed: [Delayed; 2],
}

impl From<Elasticity> for Bodies {
    fn from(instantaneous: Elasticity) -> Self {
        Self { instantaneous, ..Self::default() }
    }
}

impl From<&Bodies> for Bodies {
    fn from(bodies: &Bodies) -> Self {
        *bodies
    }
}

impl Bodies {
    /// Body 1 on body 2, of these materials, rolling at this speed [m/s].
    #[must_use]
    pub fn rolling(
        materials: &[Material; 2],
        retardation: &[Option<Retardation>; 2],
        speed: f64,
    ) -> Self {
        let shares = Elasticity::of_bodies(materials);
        let delayed = |body: usize| {
            let of = |Retardation { ratio, time }| Delayed {
                elasticity: shares[body].scaled(ratio),
                length: speed * time,
            };
            retardation[body].map(of).unwrap_or_default()
        };
        let [upper, lower] = materials;
        Self { instantaneous: Elasticity::of_pair(upper, lower), delayed: [delayed(0), delayed(1)] }
    }

    /// Returns true if either body is viscoelastic.
    #[must_use]
    pub fn remember(&self) -> bool {
        self.delayed.iter().any(|body| body.elasticity != Elasticity::default())
    }

    /// Memories of the bodies; equal lengths are merged into one.
    fn memories(&self) -> impl Iterator<Item = Delayed> {
        let [mut one, mut other] = self.delayed;
        if one.length == other.length {
            one.elasticity = one.elasticity.plus(&other.elasticity);
            other = Delayed::default();
        }
        [one, other].into_iter().filter(|body| body.elasticity != Elasticity::default())
    }

    /// Returns true if normal and tangential displacements are coupled.
    #[must_use]
    pub fn are_coupled(&self) -> bool {
        let delayed = self.memories().any(|body| body.elasticity.is_coupled());
        self.instantaneous.is_coupled() || delayed
    }

    /// Approximate ratio of K to A for a wave, 1 + Σ f/(1 − ikl) with the shares of the bodies. The
    /// exponential memory acts on a displacement that is linear between elements of side `dx` [m].
    /// `upstream` is the symbol of the shift to the upstream element.
    #[must_use]
    pub fn growth(&self, upstream: Complex64, dx: f64) -> Complex64 {
        self.memories().fold(Complex64::new(1.0, 0.0), |sum, Delayed { elasticity, length }| {
            let h = dx / length;
            let (decay, mean) = ((-h).exp(), -(-h).exp_m1() / h);
            let factor = elasticity.contact_compliance() / self.instantaneous.contact_compliance();
            let memory = (upstream * (mean - decay) + (1.0 - mean)) / (1.0 - upstream * decay);
            sum + memory * factor
        })
    }

    /// Elastic constants after an infinite time under load.
    #[must_use]
    pub fn relaxed(&self) -> Elasticity {
        self.delayed.iter().fold(self.instantaneous, |sum, body| sum.plus(&body.elasticity))
    }
}

/// Numbers K of some components at the offsets of a grid: up to nx elements downstream and nx + 1
/// upstream, ny − 1 across.
#[derive(Clone, Debug)]
pub struct RollingInfluenceNumbers<const N: usize> {
    nx: i32,
    width: usize,
    values: Vec<[f64; N]>,
}

impl<const N: usize> RollingInfluenceNumbers<N> {
    /// Evaluates the numbers for elements dx × dy; `kernel` returns the components of A at (x, y)
    /// [m/Pa].
    #[must_use]
    pub fn new(
        [nx, ny]: [usize; 2],
        [dx, dy]: [f64; 2],
        bodies: &Bodies,
        kernel: impl Fn(&Influence, f64, f64) -> [f64; N],
    ) -> Self {
        let width = 2 * nx + 2;
        let mut values = vec![[0.0; N]; width * ny];
        let at_once = Influence::of_elements([dx, dy], bodies.instantaneous);
        let place = |column: usize| (column as f64 - nx as f64) * dx;
        for (j, row) in values.chunks_exact_mut(width).enumerate() {
            let y = j as f64 * dy;
            for (column, value) in row.iter_mut().enumerate() {
                *value = kernel(&at_once, place(column), y);
            }
        }
        for Delayed { elasticity, length } in bodies.memories() {
            let influence = Influence::of_elements([dx, dy], elasticity);
            let memory = InternalVariables::new(dx, length);
            for (j, row) in values.chunks_exact_mut(width).enumerate() {
                let y = j as f64 * dy;
                let line = Line {
                    half: 0.5 * dx,
                    abreast: (y - 0.5 * dy).max(0.0),
                    kernel: |x: f64| kernel(&influence, x, y),
                };
                let mut sum = memory.tail(&line, place(width - 1));
                for (column, value) in row.iter_mut().enumerate().rev() {
                    if column + 1 < width {
                        sum = add(
                            sum.map(|one| memory.decay * one),
                            memory.step(&line, place(column)),
                        );
                    }
                    *value = add(*value, sum);
                }
            }
        }
        Self { nx: nx as i32, width, values }
    }

    /// Numbers at an offset of (i, |j|) elements [m/Pa].
    #[must_use]
    pub fn value(&self, i: i32, j: i32) -> [f64; N] {
        self.values[j.unsigned_abs() as usize * self.width + (i + self.nx) as usize]
    }
}

fn add<const N: usize>(one: [f64; N], other: [f64; N]) -> [f64; N] {
    std::array::from_fn(|k| one[k] + other[k])
}

/// A as a function along a line in the direction of rolling.
struct Line<F> {
    /// Distance of the branch points ahead of and behind the element's centre [m].
    half: f64,
    /// Distance of the branch points beside the line [m].
    abreast: f64,
    kernel: F,
}

impl<F> Line<F> {
    /// Distance of a panel from the nearest branch point [m].
    fn clearance(&self, from: f64, length: f64) -> f64 {
        let along = |at: f64| (from - at).max(at - from - length).max(0.0);
        along(self.half).min(along(-self.half)).hypot(self.abreast)
    }
}

/// An exponential memory.
struct InternalVariables {
    dx: f64,
    length: f64,
    /// Decay e^{−h} over an element's side.
    decay: f64,
    /// Quadrature weights of an element's side, of its half, its quarter and so on.
    weights: Vec<[f64; POINTS]>,
}

impl InternalVariables {
    fn new(dx: f64, length: f64) -> Self {
        let h = dx / length;
        let weights = (0..=MOST_HALVINGS).map(|k| weights(h / f64::from(1_u32 << k))).collect();
        Self { dx, length, decay: (-h).exp(), weights }
    }

    /// ∫₀^{Δx} A(x + s) e^{−s/l} ds/l.
    fn step<const N: usize>(&self, line: &Line<impl Fn(f64) -> [f64; N]>, x: f64) -> [f64; N] {
        let (mut sum, mut from, mut level) = ([0.0; N], 0.0, 0);
        while from < 1.0 {
            let mut share = 0.5_f64.powi(level as i32);
            // Panels begin at multiples of their length.
            while level > 0 && (from / (2.0 * share)).fract() == 0.0 {
                (level, share) = (level - 1, 2.0 * share);
            }
            while level < MOST_HALVINGS
                && 2.0 * share * self.dx > line.clearance(x + from * self.dx, share * self.dx)
            {
                (level, share) = (level + 1, 0.5 * share);
            }
            let start = (-from * self.dx / self.length).exp();
            let panel = panel(line, x + from * self.dx, share * self.dx, &self.weights[level]);
            sum = add(sum, panel.map(|one| start * one));
            from += share;
        }
        sum
    }

    /// ∫₀^∞ A(x + s) e^{−s/l} ds/l, ahead of the element.
    fn tail<const N: usize>(&self, line: &Line<impl Fn(f64) -> [f64; N]>, x: f64) -> [f64; N] {
        let (mut sum, mut from) = ([0.0; N], 0.0);
        while from < FORGOTTEN * self.length {
            let length = (0.5 * line.clearance(x + from, 0.0)).min(LONGEST * self.length);
            let start = (-from / self.length).exp();
            let panel = panel(line, x + from, length, &weights(length / self.length));
            sum = add(sum, panel.map(|one| start * one));
            from += length;
        }
        sum
    }
}

/// ∫ A(x + s) e^{−s/l} ds/l over a panel, with the panel's weights.
fn panel<const N: usize>(
    line: &Line<impl Fn(f64) -> [f64; N]>,
    x: f64,
    length: f64,
    weights: &[f64; POINTS],
) -> [f64; N] {
    let mut sum = [0.0; N];
    for ((t, _), weight) in rule().zip(weights) {
        sum = add(sum, (line.kernel)(x + t * length).map(|value| weight * value));
    }
    sum
}

/// Gauss points on (0, 1), and their weights.
fn rule() -> impl Iterator<Item = (f64, f64)> {
    GAUSS_10.into_iter().map(|(t, weight)| (0.5 * (1.0 + t), 0.5 * weight))
}

/// ∫₀¹ h e^{−ht} L_k(t) dt of the polynomials L_k that interpolate at the Gauss points.
fn weights(h: f64) -> [f64; POINTS] {
    let points: Vec<f64> = rule().map(|(t, _)| t).collect();
    let polynomial = |k: usize, t: f64| -> f64 {
        let others = (0..POINTS).filter(|other| *other != k);
        others.map(|other| (t - points[other]) / (points[k] - points[other])).product()
    };
    // Integrates in panels over which the exponential falls by e² at most, up to the end of the
    // memory.
    let reach = (FORGOTTEN / h).min(1.0);
    let panels = (0.5 * h * reach).ceil().max(1.0);
    let mut weights = [0.0; POINTS];
    for panel in 0..panels as usize {
        for (at, share) in rule() {
            let t = reach * (panel as f64 + at) / panels;
            let factor = share * h * (-h * t).exp() * reach / panels;
            for (k, weight) in weights.iter_mut().enumerate() {
                *weight += factor * polynomial(k, t);
            }
        }
    }
    weights
}

#[cfg(test)]
mod tests;
