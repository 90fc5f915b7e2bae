//! Conduction in a block whose properties depend on temperature, in time steps or to the steady
//! state.
//!
//! For the transform Θ of every node ([`super::law`]), with the heat H(Θ), the control volume v of
//! the node, the conductance K between nodes and the surface loss E(T) = h(T − T∞) + εσ(T⁴ − T∞⁴),
//!
//! v (a₀ H(Θ) − a₁ H(Θ₁) − a₂ H(Θ₂))/Δt + θ [KΘ + E] + (1 − θ) [KΘ₁ + E₁] = Q,
//!
//! with the coefficients of [`super::scheme`]. Only H and E are nonlinear. The solver is Newton's
//! method with conjugate gradients on the symmetric matrix, whose preconditioner solves every line
//! of nodes in depth exactly. If the material passes an element in a step, the matrix consists
//! almost of those lines, and two iterations suffice. Heat is conserved up to the residual: the sum
//! of the residual is the missing heat.
//!
//! **Steps of the heat capacity.** H and E grow with Θ, and K is symmetric and positive. The
//! residual is therefore the downward gradient of a strictly convex energy, and the solution is its
//! only minimum. A full step of Newton's method is kept if it halves the smallest residual so far,
//! or if the energy still falls at its end. Otherwise a line search shortens the step until the
//! slope of the energy along it lies between zero and half of the slope at its start. Each step
//! then lowers the energy in proportion to the square of the residual, so that the method converges
//! from any start, for any steepness or width of a peak of the heat capacity (Nocedal & Wright,
//! Numerical Optimization, 2nd ed., section 3.2). Smooth laws never need the search.

use super::basis::LANES;
use super::direct::Direct;
use super::law::Law;
use super::mesh::Axis;
use super::scheme::Coefficients;
use numerics::vector::{add_scaled, dot};
use pulp::{Arch, NullaryFnOnce};

/// Stefan–Boltzmann constant [W/(m²·K⁴)].
const BOLTZMANN: f64 = 5.670_374_419e-8;
/// Residual, relative to the known terms of the equation, at which a step is solved.
const SOLVED: f64 = 1e-10;
/// Largest number of Newton steps. A latent heat of 500 times the heat capacity over a kelvin takes
/// 20.
const MOST_NEWTON: usize = 100;
/// Reduction of the smallest residual so far at which a full Newton step is kept without a check of
/// the energy.
const HALVED: f64 = 0.5;
/// Ratio of the slope of the energy to that at the start of a step, below which a line search ends.
const FLAT: f64 = 0.5;
/// Largest number of trials of a line search. Every trial shortens the bracket by a twentieth or
/// more.
const MOST_TRIALS: usize = 60;
/// Smallest distance of a trial from either end of the bracket, as a fraction of the bracket.
const MARGIN: f64 = 0.05;
/// Largest number of iterations of conjugate gradients.
const MOST_ITERATIONS: usize = 500;
/// Reduction of the residual by conjugate gradients in a Newton step.
const REDUCTION: f64 = 1e-8;

/// Exchange of a free surface with its surroundings.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Surroundings {
    /// Coefficient of convection h [W/(m²·K)], and the temperature of the air [K].
    pub convection: [f64; 2],
    /// Emissivity ε [-], and the temperature of the surroundings [K].
    pub radiation: [f64; 2],
}

impl Surroundings {
    /// Returns whether the surface exchanges no heat.
    #[must_use]
    pub fn is_none(&self) -> bool {
        self.convection[0] == 0.0 && self.radiation[0] == 0.0
    }

    /// Returns the flux that leaves a surface with a rise over an initial temperature [W/m²], and
    /// its slope [W/(m²·K)]. Differences use the rise: differences of temperatures would lose the
    /// digits of a small rise.
    fn lost(&self, initial: f64, rise: f64) -> [f64; 2] {
        let ([h, air], [emissivity, round]) = (self.convection, self.radiation);
        // An iterate below absolute zero radiates nothing, so the loss never falls with rising
        // temperature.
        let warm = rise.max(-initial);
        let (black, temperature) = (emissivity * BOLTZMANN, initial + warm);
        // T⁴ − T∞⁴.
        let over = warm + (initial - round);
        let powers = over * (temperature + round) * (temperature * temperature + round * round);
        let slope = h + 4.0 * black * temperature.powi(3);
        [h * (rise + (initial - air)) + black * powers, slope]
    }
}

/// A conducting block of nodes.
#[derive(Clone, Debug)]
pub struct Conductor {
    /// Nodes along, across and in depth.
    pub counts: [usize; 3],
    widths: [Vec<f64>; 3],
    /// Conductances between neighbouring nodes over the conductivity, both ends included.
    between: [Vec<f64>; 3],
    /// Θ beyond the ends of the axes [W/m].
    pub beyond: [[f64; 2]; 3],
    /// The material.
    pub law: Law,
    /// Exchange of the surface where it is free.
    pub surroundings: Surroundings,
    arch: Arch,
}

/// Input of a step.
#[derive(Clone, Copy, Debug)]
pub struct Request<'a> {
    /// Duration [s]; infinite for the steady state.
    pub duration: f64,
    /// Coefficients of the scheme.
    pub by: Coefficients,
    /// Heat that enters the surface nodes, along and across [W].
    pub surface: &'a [f64],
    /// Surface nodes that exchange heat with the surroundings.
    pub free: &'a [bool],
    /// Heat that enters every node [W]; empty for none.
    pub inside: &'a [f64],
}

/// Effort of a step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct NewtonStats {
    /// Steps of Newton's method.
    pub newton: usize,
    /// Iterations of conjugate gradients.
    pub iterations: usize,
    /// Residual over the known terms.
    pub residual: f64,
    /// Whether conjugate gradients ended before they reached their reduction.
    pub stopped: bool,
}

impl NewtonStats {
    /// Returns whether the equation is solved to its tolerance.
    #[must_use]
    pub fn is_solved(&self) -> bool {
        self.residual <= SOLVED
    }

    /// Adds the effort of another step.
    pub fn add(&mut self, other: Self) {
        self.newton += other.newton;
        self.iterations += other.iterations;
        self.stopped |= other.stopped;
        // Keeps a NaN.
        if other.residual.is_nan() || other.residual > self.residual {
            self.residual = other.residual;
        }
    }
}

/// Working memory of a step.
#[derive(Default)]
pub struct Workspace {
    right: Vec<f64>,
    /// Slope of the stored and lost heat of a node over Θ.
    diagonal: Vec<f64>,
    /// Factors of the lines in depth.
    gain: Vec<f64>,
    factor: Vec<f64>,
    residual: Vec<f64>,
    preconditioned: Vec<f64>,
    direction: Vec<f64>,
    image: Vec<f64>,
    correction: Vec<f64>,
    row: Vec<f64>,
    /// Direct factorisation; `None` for conjugate gradients.
    pub direct: Option<Direct>,
}

impl Workspace {
    /// Creates working memory for elimination, or for iterations without `direct`.
    #[must_use]
    pub fn with(direct: Option<Direct>) -> Self {
        Self { direct, ..Self::default() }
    }
}

impl Conductor {
    /// Creates a block from its axes along, across and in depth.
    #[must_use]
    pub fn new(axes: [&Axis; 3], law: Law) -> Self {
        Self {
            counts: axes.map(Axis::len),
            widths: axes.map(|axis| axis.widths.clone()),
            between: axes.map(Axis::conductances),
            beyond: [[0.0; 2]; 3],
            law,
            surroundings: Surroundings::default(),
            arch: Arch::new(),
        }
    }

    /// Returns the number of nodes.
    #[must_use]
    pub fn nodes(&self) -> usize {
        self.counts.iter().product()
    }

    /// Returns the widths of the nodes in depth [m].
    #[must_use]
    pub fn widths_in_depth(&self) -> &[f64] {
        &self.widths[2]
    }

    /// Returns the heat content of a state [J].
    #[must_use]
    pub fn heat(&self, potentials: &[f64]) -> f64 {
        let [nx, _, nz] = self.counts;
        let line = |(row, line): (usize, &[f64])| {
            let area = self.widths[1][row / nz] * self.widths[2][row % nz];
            let held = line.iter().zip(&self.widths[0]);
            area * held.map(|(value, width)| width * self.law.held(*value).heat).sum::<f64>()
        };
        potentials.chunks_exact(nx).enumerate().map(line).sum()
    }

    /// Returns the heat that leaves a state through the ends of the axes, and through the free
    /// surface [W].
    #[must_use]
    pub fn lost(&self, potentials: &[f64], free: &[bool]) -> [f64; 2] {
        let [nx, ny, nz] = self.counts;
        let mut lost = [0.0; 2];
        for (at, value) in potentials.iter().enumerate() {
            let place = [at % nx, at / (nx * nz), at / nx % nz];
            for axis in 0..3 {
                let area: f64 = (0..3)
                    .filter(|other| *other != axis)
                    .map(|o| self.widths[o][place[o]])
                    .product();
                for (end, last) in [(0, 0), (1, self.counts[axis] - 1)] {
                    if place[axis] == last {
                        let gap = if end == 0 { 0 } else { last + 1 };
                        let conductance = self.between[axis][gap];
                        lost[0] += area * conductance * (value - self.beyond[axis][end]);
                    }
                }
            }
            if place[2] == 0 && free.get(place[1] * nx + place[0]).copied().unwrap_or(false) {
                let area = self.widths[0][place[0]] * self.widths[1][place[1]];
                let rise = self.law.rise(*value);
                lost[1] += area * self.surroundings.lost(self.law.initial(), rise)[0];
            }
        }
        debug_assert_eq!(potentials.len(), nx * ny * nz);
        lost
    }

    /// Solves for the next state, from a nearby guess, the state before and, for a scheme that
    /// needs it, the state two steps before.
    pub fn step(
        &self,
        request: &Request,
        now: &mut [f64],
        earlier: [&[f64]; 2],
        memory: &mut Workspace,
    ) -> NewtonStats {
        let size = self.nodes();
        for values in [
            &mut memory.right,
            &mut memory.diagonal,
            &mut memory.gain,
            &mut memory.factor,
            &mut memory.residual,
            &mut memory.preconditioned,
            &mut memory.direction,
            &mut memory.image,
            &mut memory.correction,
        ] {
            values.resize(size, 0.0);
        }
        memory.row.resize(self.counts[0], 0.0);
        self.arch.dispatch(Solve { block: self, request, now, earlier, memory })
    }

    /// Computes the right-hand side: all known terms of the equation.
    #[inline(always)]
    fn right(&self, request: &Request, [last, before]: [&[f64]; 2], memory: &mut Workspace) {
        let Request { duration, by: Coefficients { a, theta }, .. } = *request;
        let Workspace { right, row, .. } = memory;
        let [nx, ny, nz] = self.counts;
        for j in 0..ny {
            for k in 0..nz {
                let start = (j * nz + k) * nx;
                let volume = self.widths[1][j] * self.widths[2][k] / duration;
                let (out, last_row) = (&mut right[start..start + nx], &last[start..start + nx]);
                if theta < 1.0 {
                    self.conduct_row(theta - 1.0, last, [j, k], row);
                } else {
                    row[..nx].fill(0.0);
                }
                let row = &row[..nx];
                out.copy_from_slice(row);
                self.hold(a[1] * volume, last_row, out);
                if a[2] != 0.0 {
                    self.hold(a[2] * volume, &before[start..start + nx], out);
                }
                if k == 0 {
                    let surface = &request.surface[j * nx..(j + 1) * nx];
                    out.iter_mut().zip(surface).for_each(|(out, heat)| *out += heat);
                }
            }
        }
        if theta < 1.0 {
            self.exchange(theta - 1.0, request.free, last, right, None);
        }
        self.enter(right);
        for (right, inside) in right.iter_mut().zip(request.inside) {
            *right += inside;
        }
    }

    /// Returns the norm of the known terms, to which the residual is compared: the right-hand side,
    /// and the surface exchange at the initial temperature. If only warmer or colder surroundings
    /// drive a body, the exchange is the only known term.
    fn scale(&self, request: &Request, memory: &mut Workspace) -> f64 {
        let Workspace { right, residual, image, .. } = memory;
        image.fill(0.0);
        residual.fill(0.0);
        self.exchange(request.by.theta, request.free, image, residual, None);
        dot(right, right).max(dot(residual, residual)).sqrt()
    }

    /// out += s H w of a row of nodes.
    #[inline(always)]
    fn hold(&self, s: f64, row: &[f64], out: &mut [f64]) {
        let widths = &self.widths[0][..row.len()];
        let blocks = out.chunks_exact_mut(LANES).zip(row.chunks_exact(LANES));
        for ((out, row), widths) in blocks.zip(widths.chunks_exact(LANES)) {
            for m in 0..LANES {
                out[m] += s * widths[m] * self.law.held(row[m]).heat;
            }
        }
        for i in row.len() / LANES * LANES..row.len() {
            out[i] += s * widths[i] * self.law.held(row[i]).heat;
        }
    }

    /// Adds the heat that enters through the ends.
    fn enter(&self, right: &mut [f64]) {
        let [nx, ny, nz] = self.counts;
        for axis in 0..3 {
            for end in 0..2 {
                let conductance = self.between[axis][if end == 0 { 0 } else { self.counts[axis] }];
                let drive = conductance * self.beyond[axis][end];
                if drive == 0.0 {
                    continue;
                }
                let fixed = if end == 0 { 0 } else { self.counts[axis] - 1 };
                let ranges: [_; 3] = std::array::from_fn(|other| {
                    if other == axis { fixed..fixed + 1 } else { 0..self.counts[other] }
                });
                for j in ranges[1].clone() {
                    for k in ranges[2].clone() {
                        for i in ranges[0].clone() {
                            let place = [i, j, k];
                            let others = (0..3).filter(|other| *other != axis);
                            let area: f64 = others.map(|o| self.widths[o][place[o]]).product();
                            right[(j * nz + k) * nx + i] += area * drive;
                        }
                    }
                }
            }
        }
        debug_assert_eq!(right.len(), nx * ny * nz);
    }

    /// Computes s K x in a row of nodes.
    #[inline(always)]
    fn conduct_row(&self, s: f64, x: &[f64], [j, k]: [usize; 2], out: &mut [f64]) {
        let [nx, ny, nz] = self.counts;
        let [_, wy, wz] = &self.widths;
        let [gx, gy, gz] = &self.between;
        let start = (j * nz + k) * nx;
        // A missing neighbour is replaced by the node itself; the ends have their own conductance.
        let line = |there: bool, from: usize| {
            let from = if there { from } else { start };
            &x[from..from + nx]
        };
        let ends = if j == 0 { gy[0] } else { 0.0 } + if j + 1 == ny { gy[ny] } else { 0.0 };
        let deep = if k == 0 { gz[0] } else { 0.0 } + if k + 1 == nz { gz[nz] } else { 0.0 };
        let (across, depth) = (s * wz[k], s * wy[j]);
        let stencil = Stencil {
            own: line(true, start),
            beside: [
                line(j > 0, start.wrapping_sub(nx * nz)),
                line(j + 1 < ny, start + nx * nz),
                line(k > 0, start.wrapping_sub(nx)),
                line(k + 1 < nz, start + nx),
            ],
            by: [across * gy[j], across * gy[j + 1], depth * gz[k], depth * gz[k + 1]],
            end: across * ends + depth * deep,
            widths: &self.widths[0][..nx],
            along: &gx[..nx + 1],
            scale: s * wy[j] * wz[k],
        };
        stencil.apply(&mut out[..nx]);
    }

    /// out += s E of the free surface; adds its slope over Θ to the diagonal.
    fn exchange(
        &self,
        s: f64,
        free: &[bool],
        x: &[f64],
        out: &mut [f64],
        mut diagonal: Option<&mut [f64]>,
    ) {
        if self.surroundings.is_none() {
            return;
        }
        let [nx, ny, nz] = self.counts;
        for j in 0..ny {
            for i in 0..nx {
                if free.get(j * nx + i) != Some(&true) {
                    continue;
                }
                let at = j * nz * nx + i;
                let area = s * self.widths[0][i] * self.widths[1][j];
                let rise = self.law.rise(x[at]);
                let [lost, slope] = self.surroundings.lost(self.law.initial(), rise);
                out[at] += area * lost;
                if let Some(diagonal) = &mut diagonal {
                    diagonal[at] += area.abs() * slope * self.law.resistivity(x[at]);
                }
            }
        }
    }

    /// Factorises the lines in depth of the matrix, with the full diagonal.
    #[inline(always)]
    fn factor(&self, theta: f64, memory: &mut Workspace) {
        let [nx, _, nz] = self.counts;
        let [_, across, layers] = &self.widths;
        let [gx, gy, gz] = &self.between;
        let (wx, gx) = (&self.widths[0][..nx], &gx[..nx + 1]);
        let Workspace { diagonal, gain, factor, .. } = memory;
        for (j, wy) in across.iter().enumerate() {
            for (k, wz) in layers.iter().enumerate() {
                let start = (j * nz + k) * nx;
                let beside = theta * (wz * (gy[j] + gy[j + 1]) + wy * (gz[k] + gz[k + 1]));
                let along = theta * wy * wz;
                let up = if k > 0 { theta * wy * gz[k] } else { 0.0 };
                let down = if k + 1 < nz { theta * wy * gz[k + 1] } else { 0.0 };
                let (done, own) = factor.split_at_mut(start);
                let (above, own) = (&done[start - if k > 0 { nx } else { 0 }..], &mut own[..nx]);
                let (diagonal, gain) = (&diagonal[start..start + nx], &mut gain[start..start + nx]);
                if k == 0 {
                    for i in 0..nx {
                        let all = diagonal[i] + wx[i] * beside + along * (gx[i] + gx[i + 1]);
                        gain[i] = 1.0 / all;
                        own[i] = down * wx[i] * gain[i];
                    }
                    continue;
                }
                let above = &above[..nx];
                for i in 0..nx {
                    let all = diagonal[i] + wx[i] * beside + along * (gx[i] + gx[i + 1]);
                    gain[i] = 1.0 / (all - up * wx[i] * above[i]);
                    own[i] = down * wx[i] * gain[i];
                }
            }
        }
    }

    /// Solves the lines: out = P⁻¹ r.
    #[inline(always)]
    fn solve_lines(&self, theta: f64, memory: &mut Workspace) {
        let [nx, _, nz] = self.counts;
        let (wx, wy, gz) = (&self.widths[0][..nx], &self.widths[1], &self.between[2]);
        let Workspace { gain, factor, residual, preconditioned: out, .. } = memory;
        for (j, wy) in wy.iter().enumerate() {
            for (k, gz) in gz[..nz].iter().enumerate() {
                let start = (j * nz + k) * nx;
                let up = if k > 0 { theta * wy * gz } else { 0.0 };
                let (done, own) = out.split_at_mut(start);
                let (own, residual) = (&mut own[..nx], &residual[start..start + nx]);
                let above = if k > 0 { &done[start - nx..start] } else { residual };
                let gain = &gain[start..start + nx];
                for i in 0..nx {
                    own[i] = (residual[i] + up * wx[i] * above[i]) * gain[i];
                }
            }
            for k in (0..nz - 1).rev() {
                let start = (j * nz + k) * nx;
                let (own, below) = out[start..start + 2 * nx].split_at_mut(nx);
                let (factor, below) = (&factor[start..start + nx], &below[..nx]);
                for i in 0..nx {
                    own[i] += factor[i] * below[i];
                }
            }
        }
    }
}

/// One step of a block.
struct Solve<'a> {
    block: &'a Conductor,
    request: &'a Request<'a>,
    now: &'a mut [f64],
    earlier: [&'a [f64]; 2],
    memory: &'a mut Workspace,
}

impl NullaryFnOnce for Solve<'_> {
    type Output = NewtonStats;

    #[inline(always)]
    fn call(self) -> NewtonStats {
        let Self { block, request, now, earlier, memory } = self;
        block.right(request, earlier, memory);
        let scale = block.scale(request, memory);
        let mut took = NewtonStats::default();
        if scale == 0.0 {
            // No heat enters or is held: the body stays at its initial temperature.
            now.fill(0.0);
            return took;
        }
        let theta = request.by.theta;
        let mut smallest = f64::INFINITY;
        block.residual(request, now, memory);
        loop {
            let left = dot(&memory.residual, &memory.residual).sqrt();
            took.residual = left / scale;
            if took.is_solved() || took.newton == MOST_NEWTON || left.is_nan() {
                return took;
            }
            smallest = smallest.min(left);
            took.newton += 1;
            if memory.direct.is_some() {
                block.eliminate(theta, memory);
            } else {
                block.factor(theta, memory);
                let reduction = REDUCTION.max(0.3 * SOLVED * scale / left);
                let iterations = block.correct(theta, reduction, memory);
                took.iterations += iterations;
                took.stopped |= iterations == MOST_ITERATIONS;
            }
            block.advance(request, now, HALVED * smallest, memory);
        }
    }
}

impl Conductor {
    /// Adds the correction to a state, or a fraction of it that lowers the energy, and computes the
    /// residual there. The full correction is kept if the residual is at most `enough`.
    #[inline(always)]
    fn advance(&self, request: &Request, now: &mut [f64], enough: f64, memory: &mut Workspace) {
        add_scaled(now, &memory.correction, 1.0);
        self.residual(request, now, memory);
        // Downward slope of the energy along the correction.
        let mut slope = dot(&memory.residual, &memory.correction);
        if slope >= 0.0 || dot(&memory.residual, &memory.residual) <= enough * enough {
            return;
        }
        let (mut place, mut high) = (1.0, [1.0, slope]);
        let (mut low, mut flat) = ([0.0, f64::INFINITY], 0.0);
        for trial in 0..MOST_TRIALS {
            // The first trial finds the slope at the start, where conjugate gradients have consumed
            // the residual.
            let next = if trial == 0 { 0.0 } else { false_position(low, high) };
            add_scaled(now, &memory.correction, next - place);
            self.residual(request, now, memory);
            (place, slope) = (next, dot(&memory.residual, &memory.correction));
            if trial == 0 {
                flat = FLAT * slope;
            } else if (0.0..=flat).contains(&slope) {
                return;
            }
            if slope > 0.0 {
                low = [place, slope];
            } else {
                high = [place, slope];
            }
        }
    }

    /// Computes the residual of the equation, b − F(Θ), and the slope of the nonlinear terms.
    #[inline(always)]
    fn residual(&self, request: &Request, now: &[f64], memory: &mut Workspace) {
        let Request { duration, by: Coefficients { a, theta }, .. } = *request;
        let Workspace { residual, diagonal, right, row, .. } = memory;
        let [nx, ny, nz] = self.counts;
        let widths = &self.widths[0][..nx];
        for j in 0..ny {
            for k in 0..nz {
                self.conduct_row(theta, now, [j, k], row);
                let start = (j * nz + k) * nx;
                let volume = a[0] * self.widths[1][j] * self.widths[2][k] / duration;
                let of = start..start + nx;
                let (row, now, right) = (&row[..nx], &now[of.clone()], &right[of.clone()]);
                let (residual, diagonal) = (&mut residual[of.clone()], &mut diagonal[of]);
                let mut i = 0;
                while i + LANES <= nx {
                    let (now, widths) = (lanes::<LANES>(now, i), lanes::<LANES>(widths, i));
                    let (right, row) = (lanes::<LANES>(right, i), lanes::<LANES>(row, i));
                    let (mut left, mut slope) = ([0.0; LANES], [0.0; LANES]);
                    for m in 0..LANES {
                        let (held, volume) = (self.law.held(now[m]), volume * widths[m]);
                        left[m] = right[m] - row[m] - volume * held.heat;
                        slope[m] = volume * held.rate;
                    }
                    residual[i..i + LANES].copy_from_slice(&left);
                    diagonal[i..i + LANES].copy_from_slice(&slope);
                    i += LANES;
                }
                for i in i..nx {
                    let (held, volume) = (self.law.held(now[i]), volume * widths[i]);
                    residual[i] = right[i] - row[i] - volume * held.heat;
                    diagonal[i] = volume * held.rate;
                }
            }
        }
        self.exchange(-theta, request.free, now, residual, Some(diagonal));
    }

    /// Computes the correction by elimination.
    fn eliminate(&self, theta: f64, memory: &mut Workspace) {
        let [nx, _, nz] = self.counts;
        let [wx, wy, wz] = &self.widths;
        let [gx, gy, gz] = &self.between;
        let Workspace { direct, diagonal, residual, correction, .. } = memory;
        let direct = direct.as_mut().expect("elimination has a factorisation");
        for (node, own) in diagonal.iter().enumerate() {
            let [i, j, k] = [node % nx, node / (nx * nz), node / nx % nz];
            let areas = [wy[j] * wz[k], wx[i] * wz[k], wx[i] * wy[j]];
            let ends = [[gx[i], gx[i + 1]], [gy[j], gy[j + 1]], [gz[k], gz[k + 1]]];
            let part = |axis: usize| theta * areas[axis] * (ends[axis][0] + ends[axis][1]);
            let next = |axis: usize| theta * areas[axis] * ends[axis][1];
            let own = own + part(0) + part(1) + part(2);
            direct.set(node, own, [next(0), next(1), next(2)]);
        }
        direct.solve(residual, correction);
    }

    /// Multiplies the direction by the matrix.
    #[inline(always)]
    fn multiply(&self, theta: f64, memory: &mut Workspace) {
        let Workspace { image, direction, diagonal, row, .. } = memory;
        let [nx, ny, nz] = self.counts;
        for j in 0..ny {
            for k in 0..nz {
                self.conduct_row(theta, direction, [j, k], row);
                let of = (j * nz + k) * nx..(j * nz + k + 1) * nx;
                let (direction, diagonal) = (&direction[of.clone()], &diagonal[of.clone()]);
                let (image, row) = (&mut image[of], &row[..nx]);
                for i in 0..nx {
                    image[i] = row[i] + diagonal[i] * direction[i];
                }
            }
        }
    }

    /// Computes the correction by conjugate gradients. Returns the number of iterations.
    #[inline(always)]
    fn correct(&self, theta: f64, reduction: f64, memory: &mut Workspace) -> usize {
        memory.correction.fill(0.0);
        self.solve_lines(theta, memory);
        memory.direction.copy_from_slice(&memory.preconditioned);
        let mut product = dot(&memory.residual, &memory.preconditioned);
        let target = reduction * reduction * dot(&memory.residual, &memory.residual);
        for iteration in 1..=MOST_ITERATIONS {
            self.multiply(theta, memory);
            let step = product / dot(&memory.direction, &memory.image);
            let Workspace { correction, residual, direction, image, .. } = &mut *memory;
            let both = correction.iter_mut().zip(residual);
            for ((x, r), (p, q)) in both.zip(direction.iter().zip(&*image)) {
                *x += step * p;
                *r -= step * q;
            }
            if dot(&memory.residual, &memory.residual) <= target {
                return iteration;
            }
            self.solve_lines(theta, memory);
            let next = dot(&memory.residual, &memory.preconditioned);
            let again = next / product;
            product = next;
            for (p, z) in memory.direction.iter_mut().zip(&memory.preconditioned) {
                *p = z + again * *p;
            }
        }
        MOST_ITERATIONS
    }
}

/// Conduction to the six neighbours of a row of nodes.
struct Stencil<'a> {
    own: &'a [f64],
    beside: [&'a [f64]; 4],
    /// Conductances to the four neighbours across and in depth.
    by: [f64; 4],
    /// Conductance of the ends across and in depth.
    end: f64,
    widths: &'a [f64],
    /// Conductances along, over `scale`.
    along: &'a [f64],
    scale: f64,
}

impl Stencil<'_> {
    #[inline(always)]
    fn apply(&self, out: &mut [f64]) {
        let count = out.len();
        let mut i = 1;
        while i + LANES < count {
            self.part::<LANES>(i, out);
            i += LANES;
        }
        while i + 1 < count {
            self.part::<1>(i, out);
            i += 1;
        }
        for i in [0, count - 1].into_iter().take(count.min(2)) {
            let neighbour = |to: usize| self.own.get(to).copied().unwrap_or(0.0);
            let (before, after) = (neighbour(i.wrapping_sub(1)), neighbour(i + 1));
            let row =
                self.along[i] * (self.own[i] - before) + self.along[i + 1] * (self.own[i] - after);
            out[i] = self.others::<1>(i)[0] + self.scale * row;
        }
    }

    /// Computes N nodes between the ends.
    #[inline(always)]
    fn part<const N: usize>(&self, i: usize, out: &mut [f64]) {
        let (own, before, after) =
            (lanes::<N>(self.own, i), lanes::<N>(self.own, i - 1), lanes::<N>(self.own, i + 1));
        let (left, right) = (lanes::<N>(self.along, i), lanes::<N>(self.along, i + 1));
        let others = self.others::<N>(i);
        let mut all = [0.0; N];
        for m in 0..N {
            let row = left[m] * (own[m] - before[m]) + right[m] * (own[m] - after[m]);
            all[m] = others[m] + self.scale * row;
        }
        out[i..i + N].copy_from_slice(&all);
    }

    #[inline(always)]
    fn others<const N: usize>(&self, i: usize) -> [f64; N] {
        let (own, widths) = (lanes::<N>(self.own, i), lanes::<N>(self.widths, i));
        let [a, b, c, d] = self.beside;
        let (a, b) = (lanes::<N>(a, i), lanes::<N>(b, i));
        let (c, d) = (lanes::<N>(c, i), lanes::<N>(d, i));
        let [by_a, by_b, by_c, by_d] = self.by;
        let mut all = [0.0; N];
        for m in 0..N {
            let sides = by_a * (own[m] - a[m]) + by_b * (own[m] - b[m]);
            let layers = by_c * (own[m] - c[m]) + by_d * (own[m] - d[m]);
            all[m] = widths[m] * (sides + layers + self.end * own[m]);
        }
        all
    }
}

#[inline(always)]
fn lanes<const N: usize>(values: &[f64], i: usize) -> [f64; N] {
    values[i..i + N].try_into().expect("as many as lanes")
}

/// Returns the zero of the straight line between two points with slopes of opposite sign, kept away
/// from both ends.
#[inline(always)]
fn false_position([low, above]: [f64; 2], [high, below]: [f64; 2]) -> f64 {
    let part = above / (above - below);
    // A slope at the start that is not positive is rounding.
    let part = if part.is_finite() { part } else { 0.5 };
    low + (high - low) * part.clamp(MARGIN, 1.0 - MARGIN)
}
