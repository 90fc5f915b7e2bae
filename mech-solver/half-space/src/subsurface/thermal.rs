//! Thermal stresses inside a half-space that moves steadily past a heat source and is free of
//! tractions.
//!
//! Frame of [`super`]: z is the depth, and the material moves towards −x at the speed V. The rise ϑ
//! satisfies −V ∂ϑ/∂x = κ ∇²ϑ, so that its wave e^{i(k_x x + k_y y)} decays as e^{−γz},
//!
//! γ² = k² − i k_x V/κ, k² = k_x² + k_y²,
//!
//! and follows from the integral Ŵ = ∫ϑ̂ e^{−kz} dz as ϑ̂ = (γ + k) Ŵ e^{−γz}. The same integral
//! determines the thermal displacement of the surface. Goodier's potential of the displacement,
//! ∇²φ = m ϑ with m = α(1 + ν)/(1 − ν), is chosen to vanish at the surface, φ̂ = m F:
//!
//! F = Ŵ (e^{−γz} − e^{−kz})/(γ − k).
//!
//! This potential leaves a surface shear σ_nz = −i k Ŵ S, S = Eα/(1 − ν), along the direction n of
//! the wave, and no pressure. Airy's function −S Ŵ z e^{−kz} cancels the shear. With H = F + Ŵ z
//! e^{−kz} and t across the wave the sum is
//!
//! | stress over S | |
//! |---|---|
//! | σ_nn | −ϑ̂ + 2kŴe^{−kz} − k²H |
//! | σ_tt | −ϑ̂ + 2νkŴe^{−kz} |
//! | σ_zz | k²H |
//! | σ_nz | −ik(γH − (γ − k)Ŵ z e^{−kz}) |
//!
//! In a skin that is thin against the waves σ_nn = σ_tt = −Sϑ. At rest H = 0, and a steady
//! temperature leaves only the stress σ_tt.
//!
//! The integrals Ŵ come from the elements of a grid. Along x all waves that the grid resolves are
//! integrated over k_x; a series would add periodic images whose wake reaches the contact. Behind
//! the grid W continues as a wake that decays over fifty times the length of the grid, since fast
//! material keeps the heat. Across, the grid repeats with as much free space again. Waves near the
//! surface are exact within the means over elements: variations of the rise within an element are
//! smoothed.
//!
//! Source: J. N. Goodier, Phil. Mag. 23 (1937) 1017–1032; J. R. Barber, *Elasticity* (2010), ch. 22
//! and 23. Deviation: the rise is expressed by W. Assumes steady motion and uniform diffusivity.

use elastic::Stress;
use grids::Structured;
use numerics::convolution::{Complex64, smooth_size};
use numerics::fourier::{Fft, Real};
use numerics::quadrature::GAUSS_8;
use std::f64::consts::{PI, TAU};
use std::sync::Arc;

/// Heated body in motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WarmBody {
    /// Young's modulus E [Pa].
    pub youngs_modulus: f64,
    /// Poisson's ratio ν [-].
    pub poisson_ratio: f64,
    /// Coefficient of thermal expansion α [1/K].
    pub expansion: f64,
    /// Diffusivity κ [m²/s].
    pub diffusivity: f64,
    /// Speed V of the material, towards −x [m/s].
    pub speed: f64,
}

/// Integrals W of the temperature rise over the depth, one for each element of a grid [K·m].
#[derive(Clone, Copy, Debug)]
pub struct RiseIntegral<'a> {
    /// Grid, along x in i and along y in j.
    pub grid: &'a Structured,
    /// One value for each element.
    pub values: &'a [f64],
}

/// Length over which W falls to 1/e in the wake, over the length of the grid.
const WAKE: f64 = 50.0;

/// Width of a quadrature panel in k_x, times the largest distance between a heated point and a
/// point of the section.
const PHASE: f64 = 10.0;

/// Number of panels towards k_x = 0, each a quarter of the previous one: waves vary like √k_x
/// there.
const FINER: i32 = 12;

/// Relative difference below which spacings of depths count as equal.
const EQUAL: f64 = 1e-12;

/// Exponent of the decay beyond which a wave is neglected.
const FAINT: f64 = 36.0;

impl WarmBody {
    /// Thermal stress per kelvin Eα/(1 − ν) of a plate whose expansion is prevented [Pa/K].
    #[must_use]
    pub fn stress_per_kelvin(&self) -> f64 {
        self.youngs_modulus * self.expansion / (1.0 - self.poisson_ratio)
    }

    /// Wave number k and decay constant γ of a wave [1/m].
    pub(super) fn decay(&self, [kx, ky]: [f64; 2]) -> (f64, Complex64) {
        let k = kx.hypot(ky);
        (k, Complex64::new(k * k, -kx * self.speed / self.diffusivity).sqrt())
    }

    /// Stresses over Eα/(1 − ν) by a wave Ŵ = 1 at a depth z, where the decays are e^{−kz} and
    /// e^{−γz}.
    pub(super) fn wave(
        &self,
        (k, gamma): (f64, Complex64),
        z: f64,
        (fade, skin): (f64, Complex64),
    ) -> Wave {
        let apart = (gamma - k) * z;
        let potential = match apart.norm() < 1e-3 {
            true => (apart * (apart * (apart / 24.0 - 1.0 / 6.0) + 0.5) - 1.0) * (z * fade),
            false => (skin - fade) / (gamma - k),
        };
        let free = potential + z * fade;
        let rise = (gamma + k) * skin;
        let shear = gamma * free - (gamma - k) * (z * fade);
        Wave {
            along: 2.0 * k * fade - rise - k * k * free,
            across: 2.0 * self.poisson_ratio * k * fade - rise,
            down: k * k * free,
            shear: Complex64::new(k * shear.im, -k * shear.re),
        }
    }

    /// Stresses [Pa] in a section at `y` [m] below the points `xs` [m], at `depths` > 0 [m], depth
    /// after depth.
    ///
    /// # Panics
    /// If a length does not match the grid.
    #[must_use]
    pub fn stresses(
        &self,
        heat: &RiseIntegral<'_>,
        xs: &[f64],
        y: f64,
        depths: &[f64],
    ) -> Vec<Stress> {
        let sources = Sources::new(heat, y);
        let mut stresses = vec![[0.0; 6]; xs.len() * depths.len()];
        let mut sums = vec![[Complex64::default(); 6]; depths.len()];
        let shallowest = depths.iter().copied().fold(f64::INFINITY, f64::min);
        let finest = (PI / heat.grid.dx()).min(FAINT / shallowest);
        let mut rows = sources.room();
        for (kx, weight) in rule(sources.reach(xs), finest) {
            sources.along(kx, &mut rows);
            sums.fill([Complex64::default(); 6]);
            for (ky, even, odd) in sources.waves(&rows) {
                if kx.hypot(ky) * shallowest > FAINT {
                    break;
                }
                self.add([kx, ky], [even, odd], depths, &mut sums);
            }
            for (i, x) in xs.iter().enumerate() {
                let phase = Complex64::from_polar(weight * self.stress_per_kelvin() / PI, kx * x);
                for (sum, stress) in sums.iter().zip(stresses[i..].iter_mut().step_by(xs.len())) {
                    for (stress, part) in stress.iter_mut().zip(sum) {
                        *stress += part.re * phase.re - part.im * phase.im;
                    }
                }
            }
        }
        let tensor = |[xx, yy, zz, yz, xz, xy]: [f64; 6]| Stress { xx, yy, zz, yz, xz, xy };
        stresses.into_iter().map(tensor).collect()
    }

    /// Adds the stresses by the waves at ±k_y; `even` and `odd` are their sum and difference.
    fn add(
        &self,
        [kx, ky]: [f64; 2],
        [even, odd]: [Complex64; 2],
        depths: &[f64],
        sums: &mut [[Complex64; 6]],
    ) {
        let (k, gamma) = self.decay([kx, ky]);
        let (cx, cy) = (kx / k, ky / k);
        let decays = |z: f64| ((-k * z).exp(), (-gamma * z).exp());
        // Decays are reused, as depths mostly have equal spacing.
        let (mut last, mut there) = (0.0, (1.0, Complex64::ONE));
        let (mut step, mut over) = (0.0, there);
        for (&z, [xx, yy, zz, yz, xz, xy]) in depths.iter().zip(sums) {
            if (z - last - step).abs() > EQUAL * z {
                step = z - last;
                over = decays(step);
            }
            there = (there.0 * over.0, there.1 * over.1);
            last = z;
            if k * z > FAINT {
                continue;
            }
            let Wave { along, across, down, shear } = self.wave((k, gamma), z, there);
            *xx += even * (along * (cx * cx) + across * (cy * cy));
            *yy += even * (along * (cy * cy) + across * (cx * cx));
            *zz += even * down;
            *yz += odd * shear * cy;
            *xz += even * shear * cx;
            *xy += odd * (along - across) * (cx * cy);
        }
    }
}

/// Stresses over Eα/(1 − ν) at a depth by a wave Ŵ = 1.
#[derive(Clone, Copy, Debug)]
pub(super) struct Wave {
    /// Normal stress along the wave.
    pub(super) along: Complex64,
    /// Normal stress across the wave, parallel to the surface.
    pub(super) across: Complex64,
    /// Normal stress along the depth.
    pub(super) down: Complex64,
    /// Shear stress between the wave and the depth.
    pub(super) shear: Complex64,
}

/// Nodes and weights over 0 < k_x < `finest`, for distances up to `reach`.
fn rule(reach: f64, finest: f64) -> impl Iterator<Item = (f64, f64)> {
    let width = PHASE / reach;
    let count = (finest / width).ceil().max(1.0);
    let width = finest / count;
    let small = (0..FINER).map(move |n| {
        let end = width * 0.25_f64.powi(n);
        (if n + 1 == FINER { 0.0 } else { 0.25 * end }, end)
    });
    let panels = (1..count as usize).map(move |n| (n as f64 * width, (n + 1) as f64 * width));
    small.chain(panels).flat_map(|(from, to)| {
        let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
        GAUSS_8.into_iter().map(move |(node, weight)| (middle + half * node, half * weight))
    })
}

/// Integrals W as waves.
struct Sources<'a> {
    heat: &'a RiseIntegral<'a>,
    /// Number of rows, including the empty rows that separate the repetitions.
    rows: usize,
    /// Distance of the section from the first row [m].
    from_first: f64,
    transform: Arc<dyn Fft<f64>>,
}

impl<'a> Sources<'a> {
    fn new(heat: &'a RiseIntegral<'a>, y: f64) -> Self {
        let grid = heat.grid;
        assert_eq!(heat.values.len(), grid.points(), "integrals on the grid");
        // A single row represents a load that is uniform across.
        let rows = if grid.nj == 1 { 1 } else { smooth_size(2 * grid.nj) };
        let [transform, _] = f64::complex(rows);
        Self { heat, rows, from_first: y - grid.y(0), transform }
    }

    fn room(&self) -> Vec<Complex64> {
        vec![Complex64::default(); self.rows]
    }

    /// Largest distance along x between a heated point and a point of the section [m].
    fn reach(&self, xs: &[f64]) -> f64 {
        let grid = self.heat.grid;
        let ends = [grid.x(0), grid.x(grid.ni - 1)];
        xs.iter().flat_map(|x| ends.map(|end| (x - end).abs())).fold(grid.dx(), f64::max)
    }

    /// Waves with the wave number k_x along x, one for each wave l across, with the origin in the
    /// first row.
    fn along(&self, kx: f64, rows: &mut [Complex64]) {
        let grid = self.heat.grid;
        let step = Complex64::from_polar(1.0, -kx * grid.dx());
        let first = Complex64::from_polar(grid.dx(), -kx * grid.x(0));
        let mut phases = vec![first; grid.ni];
        for column in 1..grid.ni {
            phases[column] = phases[column - 1] * step;
        }
        // The first column also carries the wake behind the grid, a geometric series.
        phases[0] = first / (1.0 - step.conj() * (-1.0 / (WAKE * grid.ni as f64)).exp());
        rows.fill(Complex64::default());
        for (row, values) in rows.iter_mut().zip(self.heat.values.chunks_exact(grid.ni)) {
            *row = values.iter().zip(&phases).map(|(value, phase)| phase * value).sum();
        }
        self.transform.process(rows);
    }

    /// Waves across, k_y ≥ 0, each with the sum and the difference of the waves at k_y and −k_y in
    /// the section.
    fn waves<'b>(
        &'b self,
        rows: &'b [Complex64],
    ) -> impl Iterator<Item = (f64, Complex64, Complex64)> + 'b {
        let scale = (self.rows as f64).recip();
        let spacing = TAU / (self.rows as f64 * self.heat.grid.dy());
        let none = Complex64::default();
        let pairs = (1..self.rows.div_ceil(2)).map(move |l| {
            let ky = spacing * l as f64;
            let phase = Complex64::from_polar(scale, ky * self.from_first);
            let (one, other) = (rows[l] * phase, rows[self.rows - l] * phase.conj());
            (ky, one + other, one - other)
        });
        std::iter::once((0.0, rows[0] * scale, none)).chain(pairs)
    }
}
