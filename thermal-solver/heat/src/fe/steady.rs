//! Steady temperatures in the moving frame: finite elements across and in depth, exact along.
//!
//! In the modes of the mesh across and in depth ([`super::modes`]), κ∇²T + V ∂T/∂x = 0 with the
//! flux q on the surface becomes an equation along ξ = −x, downstream, for each pair of modes,
//!
//! κ b″ − V b′ − κ m b + q_l/(ρc) = 0,  m = μ_l + μ_m,
//!
//! whose solution is exact: with r± = (V ± √(V² + 4κ²m))/2κ
//!
//! b(ξ) = G/(ρc) [∫_{ξ′<ξ} q_l e^{r₋(ξ−ξ′)} dξ′ + ∫_{ξ′>ξ} q_l e^{−r₊(ξ′−ξ)} dξ′],
//! G = 1/√(V² + 4κ²m).
//!
//! Both integrals are marched from element to element, downstream and upstream; the flux in an
//! element is the parabola of [`crate::columns::reconstruction`]. Along x only the flux is
//! approximated: there is no numerical diffusion or oscillation at any Péclet number, no end of the
//! mesh along x, and no linear system. At high speed the upstream part vanishes; at rest both parts
//! are alike. If the same material has passed before, n − 1 times at a distance D apart, the
//! remainder of b from those passages is added at the leading edge: b of one passage beyond the
//! trailing edge, which falls as e^{r₋ξ}, summed over kD. b is the amplitude over φ_m(0): the
//! surface is T_l = Σ_m φ_m(0)² b_m, depth z_k has φ_m(0) φ_m(z_k).

use super::basis::{Basis, LANES, padded};
use super::block::Passages;
use crate::Material;
use crate::columns::reconstruction::{Flux, FluxRow};
use pulp::{Arch, NullaryFnOnce};

/// Decay below which heat that flows upstream past an element is neglected.
const NOTHING: f64 = 1e-20;

/// A body in steady motion, prepared for its speed.
pub struct SteadyMotion {
    columns: usize,
    marches: Vec<March>,
    arch: Arch,
}

/// Data of a mode across: values over the modes in depth, padded to [`LANES`].
struct March {
    /// Downstream step: e^{r₋h}, and the contributions of the parabola's coefficients.
    down: Step,
    up: Option<Step>,
    /// Ratio of the amplitude that earlier passages bring to the leading edge to that of one
    /// passage at the trailing edge.
    again: Option<Vec<f64>>,
    /// Contribution of the element's own halves at its middle, of all modes: near, middle and far
    /// coefficient.
    own: [[f64; 3]; 2],
    /// Contribution of the element's own halves, mode by mode.
    halves: [[Vec<f64>; 3]; 2],
    /// G/(ρc).
    gain: Vec<f64>,
}

struct Step {
    decay: Vec<f64>,
    /// Decay over half an element.
    half: Vec<f64>,
    /// Weights of the coefficients nearest, middle and farthest.
    weights: [Vec<f64>; 3],
    /// φ_m(0)² G/(ρc) times the decay over half an element.
    seen: Vec<f64>,
}

/// Working memory of a solve.
#[derive(Clone, Default)]
pub struct Scratch {
    /// Middle coefficients of the flux in a mode across.
    pub middle: Vec<f64>,
    /// Edge values of the flux in a mode across.
    pub edge: Vec<f64>,
    amplitude: Vec<f64>,
    lanes: Vec<[f64; LANES]>,
}

impl SteadyMotion {
    /// Prepares a body on `columns` elements of the length `h` [m] along, at a speed [m/s].
    #[must_use]
    pub fn new(
        basis: &Basis,
        material: &Material,
        columns: usize,
        h: f64,
        speed: f64,
        passages: Option<Passages>,
    ) -> Self {
        let again = passages.map(|p| (p.count - 1, p.distance / h, columns as f64));
        let make = |rate: &f64| March::new(h, speed, material, *rate, basis, again);
        Self { columns, marches: basis.across.rates.iter().map(make).collect(), arch: Arch::new() }
    }

    /// Computes the values of a mode across on the surface, column after column.
    pub fn surface(
        &self,
        basis: &Basis,
        mode: usize,
        flux: &Flux,
        scratch: &mut Scratch,
        out: &mut [f64],
    ) {
        scratch.project(basis, mode, flux);
        let march = &self.marches[mode];
        let Scratch { middle, edge, amplitude, lanes } = scratch;
        amplitude.clear();
        amplitude.resize(basis.size(), 0.0);
        lanes.clear();
        lanes.resize(self.columns, [0.0; LANES]);
        self.arch.dispatch(Pass { march, middle, edge, amplitude, lanes, out });
        for (out, lanes) in out.iter_mut().zip(lanes) {
            *out += lanes.iter().sum::<f64>();
        }
    }

    /// Returns the amplitudes below a row of the flux, summed over the modes across. Elements begin
    /// with the `behind` elements behind the flux; each has a value at its downstream edge, then at
    /// its middle.
    #[must_use]
    pub fn below(&self, basis: &Basis, flux: &Flux, row: usize, behind: usize) -> Vec<f64> {
        let columns = behind + self.columns;
        let mut sums = vec![0.0; 2 * columns * basis.size()];
        let mut scratch = Scratch::default();
        for (mode, march) in self.marches.iter().enumerate() {
            scratch.project(basis, mode, flux);
            let Scratch { middle, edge, .. } = &scratch;
            let at = |i: usize| match i.checked_sub(behind) {
                Some(i) => [edge[i], middle[i], edge[i + 1]],
                None => [0.0; 3],
            };
            let shape = basis.shape(mode, row);
            march.below([behind, columns], shape, at, &mut sums);
        }
        sums
    }
}

impl Scratch {
    /// Projects the flux onto a mode across: middle and edge coefficients.
    pub fn project(&mut self, basis: &Basis, mode: usize, flux: &Flux) {
        for values in [&mut self.middle, &mut self.edge] {
            values.clear();
            values.resize(flux.columns() + 1, 0.0);
        }
        for row in 0..basis.rows {
            let part = basis.part(mode, row);
            let FluxRow { middle, edge, support: (first, end) } = flux.row(row);
            // The edges of an element without flux are zero.
            let edges = first..end + usize::from(end > first);
            for (to, from, span) in
                [(&mut self.middle, middle, first..end), (&mut self.edge, edge, edges)]
            {
                to[span.clone()].iter_mut().zip(&from[span]).for_each(|(to, q)| *to += part * q);
            }
        }
    }
}

/// Both marches of a mode across over the elements with heat.
struct Pass<'a> {
    march: &'a March,
    middle: &'a [f64],
    edge: &'a [f64],
    amplitude: &'a mut [f64],
    lanes: &'a mut [[f64; LANES]],
    out: &'a mut [f64],
}

impl NullaryFnOnce for Pass<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Self { march, middle, edge, amplitude, lanes, out } = self;
        let own =
            |[near, middle, far]: [f64; 3], [a, b, c]: [f64; 3]| near * a + middle * b + far * c;
        for (i, out) in out.iter_mut().enumerate() {
            let (l, m, r) = (edge[i], middle[i], edge[i + 1]);
            let centre = 0.25 * (l + 2.0 * m + r);
            *out = own(march.own[0], [centre, 0.5 * (m + r), r])
                + own(march.own[1], [centre, 0.5 * (l + m), l]);
        }
        march.enter(amplitude, (0..lanes.len()).map(|i| [edge[i], middle[i], edge[i + 1]]));
        for (i, lanes) in lanes.iter_mut().enumerate().rev() {
            march.down.pass(amplitude, lanes, [edge[i], middle[i], edge[i + 1]]);
        }
        if let Some(up) = &march.up {
            amplitude.fill(0.0);
            for (i, lanes) in lanes.iter_mut().enumerate() {
                up.pass(amplitude, lanes, [edge[i + 1], middle[i], edge[i]]);
            }
        }
    }
}

impl March {
    fn new(
        h: f64,
        speed: f64,
        material: &Material,
        across: f64,
        basis: &Basis,
        again: Option<(usize, f64, f64)>,
    ) -> Self {
        let (depth, top) = (&basis.depth.rates, &basis.top);
        let (kappa, capacity) = (material.diffusivity(), material.density * material.specific_heat);
        let rates = depth.iter().map(|rate| rate + across);
        let root = |m: f64| (speed * speed + 4.0 * kappa * kappa * m).sqrt();
        let gain: Vec<f64> = rates.clone().map(|m| 1.0 / (root(m) * capacity)).collect();
        let downstream: Vec<f64> =
            rates.clone().map(|m| h * 2.0 * kappa * m / (speed + root(m))).collect();
        let upstream: Vec<f64> = rates.map(|m| h * (speed + root(m)) / (2.0 * kappa)).collect();
        let up = upstream.iter().any(|rate| (-rate).exp() > NOTHING);
        let halves = [&downstream, &upstream].map(|rates| {
            let weights: Vec<_> = rates.iter().map(|rate| parabola(0.5 * rate)).collect();
            [0, 1, 2].map(|p| padded(&weights.iter().map(|w| 0.5 * h * w[p]).collect::<Vec<_>>()))
        });
        let all = |values: &Vec<f64>| -> f64 {
            (0..gain.len()).map(|m| top[m] * top[m] * gain[m] * values[m]).sum()
        };
        Self {
            own: [0, 1].map(|side| [0, 1, 2].map(|p| all(&halves[side][p]))),
            halves,
            down: Step::new(h, &downstream, top, &gain),
            up: up.then(|| Step::new(h, &upstream, top, &gain)),
            again: again.map(|(count, distance, columns)| {
                let all = |rate: &f64| {
                    (-rate * (distance - columns)).exp() * passed(rate * distance, count)
                };
                padded(&downstream.iter().map(all).collect::<Vec<_>>())
            }),
            gain: padded(&gain),
        }
    }

    /// Sets the amplitudes at the leading edge left by earlier passages of the same elements,
    /// downstream first.
    #[inline(always)]
    fn enter(&self, amplitude: &mut [f64], elements: impl DoubleEndedIterator<Item = [f64; 3]>) {
        let Some(again) = &self.again else { return };
        elements.rev().for_each(|element| self.down.advance(amplitude, element));
        amplitude.iter_mut().zip(again).for_each(|(amplitude, again)| *amplitude *= again);
    }

    /// Adds `shape` times the amplitudes at the downstream edge and in the middle of each element
    /// to `sums`.
    fn below(
        &self,
        [behind, columns]: [usize; 2],
        shape: f64,
        at: impl Fn(usize) -> [f64; 3],
        sums: &mut [f64],
    ) {
        let size = self.gain.len();
        let mut amplitude = vec![0.0; size];
        self.enter(&mut amplitude, (behind..columns).map(&at));
        for i in (0..columns).rev() {
            let [l, m, r] = at(i);
            let centre = 0.25 * (l + 2.0 * m + r);
            let own = [[centre, 0.5 * (m + r), r], [centre, 0.5 * (l + m), l]];
            let (edge, middle) = sums[2 * i * size..2 * (i + 1) * size].split_at_mut(size);
            for (mode, sum) in middle.iter_mut().enumerate() {
                let mut value = self.down.half[mode] * amplitude[mode];
                for (halves, own) in self.halves.iter().zip(own) {
                    for (weight, own) in halves.iter().zip(own) {
                        value += weight[mode] * own;
                    }
                }
                *sum += shape * self.gain[mode] * value;
            }
            self.down.advance(&mut amplitude, [l, m, r]);
            for (mode, sum) in edge.iter_mut().enumerate() {
                *sum += shape * self.gain[mode] * amplitude[mode];
            }
        }
        let Some(up) = &self.up else { return };
        amplitude.fill(0.0);
        for i in 0..columns {
            let [l, m, r] = at(i);
            let (edge, middle) = sums[2 * i * size..2 * (i + 1) * size].split_at_mut(size);
            for (mode, (edge, middle)) in edge.iter_mut().zip(middle).enumerate() {
                let part = shape * self.gain[mode] * amplitude[mode];
                *edge += part;
                *middle += up.half[mode] * part;
            }
            up.advance(&mut amplitude, [r, m, l]);
        }
    }
}

impl Step {
    fn new(h: f64, rates: &[f64], top: &[f64], gain: &[f64]) -> Self {
        let weights: Vec<_> = rates.iter().map(|rate| parabola(*rate)).collect();
        let half: Vec<f64> = rates.iter().map(|rate| (-0.5 * rate).exp()).collect();
        let seen: Vec<f64> =
            (0..rates.len()).map(|m| top[m] * top[m] * gain[m] * half[m]).collect();
        Self {
            decay: padded(&rates.iter().map(|rate| (-rate).exp()).collect::<Vec<_>>()),
            half: padded(&half),
            weights: [0, 1, 2]
                .map(|p| padded(&weights.iter().map(|w| h * w[p]).collect::<Vec<_>>())),
            seen: padded(&seen),
        }
    }

    /// Adds the rise at the middle of an element caused by the incoming heat, then passes the
    /// element. The coefficients of its flux are ordered by distance from the exit, nearest first.
    #[inline(always)]
    fn pass(&self, amplitude: &mut [f64], seen: &mut [f64; LANES], [a, b, c]: [f64; 3]) {
        let [near, middle, far] = &self.weights;
        let rows = amplitude
            .chunks_exact_mut(LANES)
            .zip(self.decay.chunks_exact(LANES).zip(self.seen.chunks_exact(LANES)))
            .zip(near.chunks_exact(LANES).zip(middle.chunks_exact(LANES)))
            .zip(far.chunks_exact(LANES));
        for (((amplitude, (decay, gain)), (near, middle)), far) in rows {
            for m in 0..LANES {
                seen[m] += gain[m] * amplitude[m];
                amplitude[m] = decay[m] * amplitude[m] + (near[m] * a + middle[m] * b + far[m] * c);
            }
        }
    }

    #[inline(always)]
    fn advance(&self, amplitude: &mut [f64], [a, b, c]: [f64; 3]) {
        let [near, middle, far] = &self.weights;
        for (mode, amplitude) in amplitude.iter_mut().enumerate() {
            *amplitude =
                self.decay[mode] * *amplitude + (near[mode] * a + middle[mode] * b + far[mode] * c);
        }
    }
}

/// Returns Σ e^{−αk} for k from 0 to `count` − 1.
fn passed(alpha: f64, count: usize) -> f64 {
    let rest = -(-alpha).exp_m1();
    if rest < 1e-12 { count as f64 } else { -(-alpha * count as f64).exp_m1() / rest }
}

/// Returns ∫₀¹ e^{−αθ} B(θ) dθ of the parabolas (1−θ)², 2θ(1−θ) and θ².
fn parabola(alpha: f64) -> [f64; 3] {
    let [j0, j1, j2] = if alpha < 1.0 { series(alpha) } else { closed(alpha) };
    [j0 - 2.0 * j1 + j2, 2.0 * (j1 - j2), j2]
}

/// Returns ∫₀¹ θᵖ e^{−αθ} dθ by the series of the exponential.
fn series(alpha: f64) -> [f64; 3] {
    let (mut sums, mut term) = ([0.0; 3], 1.0);
    for n in 0..20 {
        let n = f64::from(n);
        for (p, sum) in sums.iter_mut().enumerate() {
            *sum += term / (n + p as f64 + 1.0);
        }
        term *= -alpha / (n + 1.0);
    }
    sums
}

fn closed(alpha: f64) -> [f64; 3] {
    let gone = (-alpha).exp();
    let j0 = (1.0 - gone) / alpha;
    let j1 = (j0 - gone) / alpha;
    [j0, j1, (2.0 * j1 - gone) / alpha]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Both forms agree at their transition, and the weights sum to ∫ e^{−αθ} dθ. Tolerance:
    /// rounding.
    #[test]
    fn weights_of_a_parabola() {
        for alpha in [1e-9, 0.3, 0.999_999, 1.0, 30.0] {
            let sum: f64 = parabola(alpha).iter().sum();
            assert!(
                (sum - (1.0 - f64::exp(-alpha)) / alpha).abs()
                    < 1e-15 + 1e-7 * f64::from(alpha < 1e-6),
                "{alpha}"
            );
        }
        for (a, b) in series(1.0).iter().zip(closed(1.0)) {
            assert!((a - b).abs() < 1e-14);
        }
    }
}
