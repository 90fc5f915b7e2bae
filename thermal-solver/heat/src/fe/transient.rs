//! Time steps on a mesh that moves with the material.
//!
//! The nodes of a body are fixed in its material: nothing is transported between nodes, so there is
//! no numerical diffusion at any Péclet number and no limit on the speed. In the moving frame the
//! mesh is advected towards −x by V Δt a step. After each whole element the rearmost column is
//! dropped and a column of fresh material is added in front, which only shifts indices in the next
//! step. If steps are whole elements, nothing is interpolated. Otherwise the flux is averaged over
//! the width of each node in the middle of the step, which conserves it. The surface is
//! interpolated for output only, which no later step uses.
//!
//! In the modes of the mesh ([`super::basis`]) a step is a tridiagonal system along the mesh for
//! every pair of modes. It is solved by elimination, without iterations and their errors.

use super::basis::{Basis, LANES};
use super::mesh_advection::Step;
use super::scheme::Coefficients;
use crate::Material;
use pulp::{Arch, NullaryFnOnce};

/// The columns of a body's mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Columns {
    /// Distance between two columns [m].
    pub h: f64,
    /// Number of columns of the heat flux.
    pub heated: usize,
    /// Number of columns behind the heat flux.
    pub behind: usize,
    /// Number of columns in front of the heat flux.
    pub front: usize,
    /// Conductances beyond both ends over the conductivity [1/m].
    pub ends: [f64; 2],
}

impl Columns {
    /// Returns the total number of columns.
    #[must_use]
    pub fn count(&self) -> usize {
        self.behind + self.heated + self.front
    }
}

/// The state of a mode across, column after column.
#[derive(Debug)]
pub struct ModeState<'a> {
    /// Amplitudes.
    pub now: &'a mut [f64],
    /// Amplitudes one step before, for a scheme that needs them; otherwise empty.
    pub before: &'a mut [f64],
    /// Flux at the columns in the last step [W/m²], for a scheme that needs it.
    pub flux: &'a mut [f64],
}

/// Working memory of a mode across.
#[derive(Clone, Default)]
pub struct Scratch {
    old: Vec<f64>,
    before: Vec<f64>,
    /// Mean fluxes at the columns, and their combination by the scheme.
    means: Vec<f64>,
    flux: Vec<f64>,
    factors: Vec<[f64; LANES]>,
    lanes: Vec<[f64; LANES]>,
}

/// A body's mesh.
#[derive(Clone, Debug)]
pub struct Mesh {
    /// Modes across and in depth.
    pub basis: Basis,
    /// Columns along.
    pub columns: Columns,
    diffusivity: f64,
    capacity: f64,
    arch: Arch,
}

/// The flux of a window in a mode across: middle and edge coefficients of parabolas
/// ([`crate::columns::reconstruction`]).
#[derive(Clone, Copy, Debug)]
pub struct ModeFlux<'a> {
    /// Middle coefficients [W/m²].
    pub middle: &'a [f64],
    /// Edge values [W/m²], one more than middle coefficients.
    pub edge: &'a [f64],
}

impl ModeFlux<'_> {
    /// Returns ∫ from 0 to θ over an element; 0 outside the flux.
    #[inline(always)]
    fn until(&self, element: isize, theta: f64) -> f64 {
        let Some(i) = usize::try_from(element).ok().filter(|i| *i + 1 < self.edge.len()) else {
            return 0.0;
        };
        let (l, m, r) = (self.edge[i], self.middle[i], self.edge[i + 1]);
        let (first, second) = (m - l, l - 2.0 * m + r);
        theta * (l + theta * (first + theta * second / 3.0))
    }

    /// Computes means over elements that are `front` ahead of their nominal positions, beginning
    /// `behind` columns behind the flux.
    pub fn means(&self, front: f64, behind: usize, means: &mut [f64]) {
        let whole = front.floor();
        let theta = front - whole;
        let first = whole as isize - behind as isize;
        for (means, element) in means.iter_mut().zip(first..) {
            let rest = self.until(element, 1.0) - self.until(element, theta);
            *means = rest + self.until(element + 1, theta);
        }
    }
}

impl Mesh {
    /// Creates the mesh of a body.
    #[must_use]
    pub fn new(basis: Basis, columns: Columns, material: &Material) -> Self {
        let capacity = material.density * material.specific_heat;
        Self { basis, columns, diffusivity: material.diffusivity(), capacity, arch: Arch::new() }
    }

    /// Returns the number of amplitudes of a mode across, over all columns.
    #[must_use]
    pub fn mode_size(&self) -> usize {
        self.columns.count() * self.basis.size()
    }

    /// Advances a mode across through the steps of a window, and writes its final values on the
    /// surface, column after column.
    pub fn window(
        &self,
        mode: usize,
        steps: &[Step],
        flux: ModeFlux,
        state: ModeState,
        scratch: &mut Scratch,
        surface: &mut [f64],
    ) {
        let count = self.columns.count();
        scratch.factors.resize(count, [0.0; LANES]);
        scratch.means.resize(count, 0.0);
        scratch.flux.resize(count, 0.0);
        let mut place = f64::NAN;
        for step in steps {
            if step.middle != place {
                place = step.middle;
                flux.means(place, self.columns.behind, &mut scratch.means);
            }
            step.receive(&scratch.means, state.flux, &mut scratch.flux);
            scratch.lanes.clear();
            scratch.lanes.resize(count, [0.0; LANES]);
            scratch.old.clear();
            scratch.old.extend_from_slice(state.now);
            scratch.before.clear();
            scratch.before.extend_from_slice(state.before);
            self.arch.dispatch(Advance { mesh: self, mode, step, new: state.now, scratch });
            if !state.before.is_empty() {
                state.before.copy_from_slice(&scratch.old);
            }
        }
        for (surface, lanes) in surface.iter_mut().zip(&scratch.lanes) {
            *surface = lanes.iter().sum();
        }
    }

    /// Returns the amplitudes below a row of the flux, summed over the modes across, column after
    /// column.
    #[must_use]
    pub fn below(&self, amplitudes: &[f64], row: usize) -> Vec<f64> {
        let mut sums = vec![0.0; self.mode_size()];
        for (mode, amplitudes) in amplitudes.chunks_exact(self.mode_size()).enumerate() {
            let shape = self.basis.shape(mode, row);
            sums.iter_mut().zip(amplitudes).for_each(|(sum, a)| *sum += shape * a);
        }
        sums
    }

    #[inline(always)]
    fn step(&self, mode: usize, step: &Step, new: &mut [f64], scratch: &mut Scratch) {
        let rate = self.diffusivity * step.duration;
        let size = self.basis.size();
        for block in (0..size).step_by(LANES) {
            let decay = |m: usize| {
                let depth = self.basis.depth.rates.get(block + m).copied().unwrap_or(0.0);
                rate * (self.basis.across.rates[mode] + depth)
            };
            let line = Line {
                step,
                decay: std::array::from_fn(decay),
                seen: std::array::from_fn(|m| self.basis.top[block + m].powi(2)),
                fourier: rate / (self.columns.h * self.columns.h),
                heat: step.duration / self.capacity,
                ends: self.columns.ends.map(|end| end * self.columns.h),
                size,
                block,
            };
            line.solve(new, scratch);
        }
    }
}

/// A step of a mode across.
struct Advance<'a> {
    mesh: &'a Mesh,
    mode: usize,
    step: &'a Step,
    new: &'a mut [f64],
    scratch: &'a mut Scratch,
}

impl NullaryFnOnce for Advance<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        self.mesh.step(self.mode, self.step, self.new, self.scratch);
    }
}

/// The system along the mesh of [`LANES`] modes in depth.
struct Line<'a> {
    step: &'a Step,
    /// κ Δt m.
    decay: [f64; LANES],
    /// φ_m(0)².
    seen: [f64; LANES],
    /// κ Δt/h².
    fourier: f64,
    /// Δt/(ρc).
    heat: f64,
    ends: [f64; 2],
    size: usize,
    block: usize,
}

impl Line<'_> {
    /// Returns the lanes of a column; zero beyond the mesh, where the material is fresh.
    #[inline(always)]
    fn at(&self, values: &[f64], column: usize) -> [f64; LANES] {
        let start = column * self.size + self.block;
        let lanes = values.get(start..start + LANES).and_then(|lanes| lanes.try_into().ok());
        lanes.unwrap_or([0.0; LANES])
    }

    #[inline(always)]
    fn solve(&self, new: &mut [f64], scratch: &mut Scratch) {
        let Scratch { old, before, flux, factors, lanes, .. } = scratch;
        let Step { shifts: [shift, shift_before], by: Coefficients { a, theta }, .. } = *self.step;
        let last = flux.len() - 1;
        let (implicit, explicit) = (theta * self.fourier, (1.0 - theta) * self.fourier);
        let (mut factor, mut value) = ([0.0; LANES], [0.0; LANES]);
        let mut previous = [0.0; LANES];
        let mut current = self.at(old, shift);
        let [own, gone]: [[f64; LANES]; 2] = [
            std::array::from_fn(|m| a[1] - (1.0 - theta) * self.decay[m]),
            std::array::from_fn(|m| a[0] + theta * self.decay[m]),
        ];
        if shift > 0 {
            previous = self.at(old, shift - 1);
        }
        for i in 0..=last {
            let next = self.at(old, i + shift + 1);
            // Conductances to the neighbours, and at the ends to the far field.
            let (to_last, to_next) = (f64::from(i > 0), f64::from(i < last));
            let beyond = [1.0 - to_last, 1.0 - to_next];
            let all = to_last + to_next + beyond[0] * self.ends[0] + beyond[1] * self.ends[1];
            let source = self.heat * flux[i];
            let start = i * self.size + self.block;
            let new = &mut new[start..start + LANES];
            for m in 0..LANES {
                let conduction = all * current[m] - to_last * previous[m] - to_next * next[m];
                value[m] =
                    own[m] * current[m] - explicit * conduction + source + implicit * value[m];
            }
            if a[2] != 0.0 {
                let two = self.at(before, i + shift_before);
                for m in 0..LANES {
                    value[m] += a[2] * two[m];
                }
            }
            for m in 0..LANES {
                let gain = 1.0 / (gone[m] + implicit * (all - factor[m]));
                value[m] *= gain;
                factor[m] = implicit * gain;
                new[m] = value[m];
            }
            factors[i] = factor;
            (previous, current) = (current, next);
        }
        let mut value = [0.0; LANES];
        for i in (0..=last).rev() {
            let start = i * self.size + self.block;
            let new = &mut new[start..start + LANES];
            for m in 0..LANES {
                value[m] = new[m] + factors[i][m] * value[m];
                new[m] = value[m];
                lanes[i][m] += self.seen[m] * value[m];
            }
        }
    }
}
