//! A body: rows of elements along the motion, their state, and a step in time.
//!
//! Either the first and last column, both sides and the bottom are fixed, or the body is free. The
//! state consists of w = u + βv and v. Elements resist w, so that damping has no extra cost, and
//! u = w − βv.

use super::frequency;
use super::kernel::{Energy, Flow, Forces, LANES, PLASTIC, Row, Rows, Stiffness};
use super::section::Section;
use super::shape::Shape;
use pulp::{Arch, NullaryFnOnce};

/// Nodes of a row beyond its elements: one node, and padding for vector access.
const PADDING: usize = 2 * LANES;
/// Share of an element that counts as rounding.
const ROUNDING: f64 = 1e-9;
/// Share of the shear modulus that resists hourglass modes. For steel it is 0.05 of the wave
/// modulus (the measure of Flanagan & Belytschko). It stays bounded towards a Poisson's ratio of
/// 0.5, where shapes change by shear alone.
const HOURGLASS: f64 = 0.175;

/// Calls a kernel specialised by constants: whether elements are curved, flow plastically, and are
/// softer than their row.
macro_rules! of_facts {
    ($facts:expr, $kernel:ident $fields:tt, |$it:ident| $use:expr) => {
        match $facts {
            [false, false, false] => of_facts!(@ $kernel [false, false, false] $fields, $it, $use),
            [true, false, false] => of_facts!(@ $kernel [true, false, false] $fields, $it, $use),
            [false, true, false] => of_facts!(@ $kernel [false, true, false] $fields, $it, $use),
            [true, true, false] => of_facts!(@ $kernel [true, true, false] $fields, $it, $use),
            [false, false, true] => of_facts!(@ $kernel [false, false, true] $fields, $it, $use),
            [true, false, true] => of_facts!(@ $kernel [true, false, true] $fields, $it, $use),
            [false, true, true] => of_facts!(@ $kernel [false, true, true] $fields, $it, $use),
            [true, true, true] => of_facts!(@ $kernel [true, true, true] $fields, $it, $use),
        }
    };
    (@ $kernel:ident [$curved:tt, $flows:tt, $softer:tt] { $($field:ident),* }, $it:ident, $use:expr) => {{
        let $it = $kernel::<$curved, $flows, $softer> { $($field),* };
        $use
    }};
}

/// Material of a body, and its rolling radius.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Solid {
    /// Lamé's constants λ and μ [Pa].
    pub lame: [f64; 2],
    /// Density [kg/m³].
    pub density: f64,
    /// Plastic flow, if any.
    pub flow: Option<Flow>,
    /// Rolling radius [m]; infinite for a straight body.
    pub radius: f64,
}

/// Part of a body that is fixed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Support {
    /// All faces except the surface.
    Faces,
    /// Nothing.
    Nothing,
}

/// Body of explicit elements.
pub struct Block {
    arch: Arch,
    /// Numbers of elements along, across and in depth.
    pub counts: [usize; 3],
    /// Number of nodes from one row to the next.
    pub stride: usize,
    /// Length of an element along the surface [m].
    pub length: f64,
    /// Material of the body.
    pub solid: Solid,
    /// Cross-section.
    pub section: Section,
    stiffness: Vec<Stiffness>,
    held: Support,
    /// 1/M of the nodes of a row [1/kg]; 0 for fixed nodes. A node at a free end has half of M.
    pub inverse_mass: Vec<f64>,
    /// w = u + βv [m] by component: node after node along a row, row after row across, plane after
    /// plane in depth.
    pub damped: [Vec<f64>; 3],
    /// v [m/s].
    pub velocity: [Vec<f64>; 3],
    /// Plastic strains and κ of a material that flows: row of elements after row, strain after
    /// strain within a row.
    pub plastic: Vec<f64>,
    /// β [s].
    pub damping: f64,
    /// Distance of the columns behind their nominal positions [m], less than an element.
    pub behind: f64,
    /// Thermal expansion, if any.
    expansion: Option<Expansion>,
    /// Thermal softening, if any.
    softening: Option<Softening>,
    /// Forces on planes of nodes: from the layer above the current plane, from the layer below it,
    /// and on the next plane.
    planes: [[Vec<f64>; 3]; 3],
}

impl Block {
    /// Creates a body without displacements, with at least this number of columns of elements of a
    /// length [m].
    #[must_use]
    pub fn new(columns: usize, length: f64, section: Section, solid: Solid, held: Support) -> Self {
        let columns = columns.next_multiple_of(LANES);
        let [across, deep] = section.counts;
        let of_row = |row: usize| {
            let shape =
                Shape::new(section.corners(row % across, row / across), length, solid.radius);
            Stiffness::new(shape, solid.lame, HOURGLASS, solid.flow)
        };
        let stiffness: Vec<Stiffness> = (0..across * deep).map(of_row).collect();
        let rows = across + 1;
        let mut mass = vec![0.0; rows * (deep + 1)];
        for (row, of) in stiffness.iter().enumerate() {
            let first = row / across * rows + row % across;
            for node in [first, first + 1, first + rows, first + rows + 1] {
                mass[node] += 0.25 * solid.density * of.shape.volume;
            }
        }
        let is_held = |row: usize| {
            let face = row / rows == deep || row.is_multiple_of(rows) || row % rows == across;
            face && held == Support::Faces
        };
        let inverse = |(row, mass): (usize, &f64)| if is_held(row) { 0.0 } else { 1.0 / mass };
        let stride = columns + PADDING;
        let nodes = |planes: usize| -> [Vec<f64>; 3] {
            std::array::from_fn(|_| vec![0.0; planes * rows * stride])
        };
        Self {
            arch: Arch::new(),
            counts: [columns, across, deep],
            stride,
            length,
            solid,
            held,
            inverse_mass: mass.iter().enumerate().map(inverse).collect(),
            section,
            stiffness,
            damped: nodes(deep + 1),
            velocity: nodes(deep + 1),
            plastic: vec![0.0; solid.flow.map_or(0, |_| PLASTIC * across * deep * columns)],
            damping: 0.0,
            behind: 0.0,
            expansion: None,
            softening: None,
            planes: std::array::from_fn(|_| nodes(1)),
        }
    }

    /// State on which the next step depends, except the distance behind.
    pub fn state(&mut self) -> [&mut [f64]; 7] {
        let Self { damped: [x, y, z], velocity: [vx, vy, vz], plastic, .. } = self;
        [x, y, z, vx, vy, vz, plastic].map(Vec::as_mut_slice)
    }

    /// Number of elements.
    #[must_use]
    pub fn elements(&self) -> usize {
        self.counts.iter().product()
    }

    /// Position of a column along the surface, from the middle of the block [m].
    #[must_use]
    pub fn place(&self, column: usize) -> f64 {
        (column as f64 - 0.5 * self.counts[0] as f64) * self.length - self.behind
    }

    /// Component of a node's displacement [m].
    #[must_use]
    pub fn displacement(&self, node: usize, component: usize) -> f64 {
        self.damped[component][node] - self.damping * self.velocity[component][node]
    }

    /// Adds a velocity [m/s] to a node of the surface, for a step [s] already taken.
    pub fn push(&mut self, node: usize, velocity: [f64; 3], step: f64) {
        for (k, more) in velocity.into_iter().enumerate() {
            self.velocity[k][node] += more;
            self.damped[k][node] += (step + self.damping) * more;
        }
    }

    /// Applies thermal expansion to the first layer. `stretch` is the stress-free strain integrated
    /// over the depth [m] at a position (x, y) [m] of the contact. It stays there while the
    /// material moves back. Softening must be applied before.
    pub fn expand(&mut self, stretch: impl Fn(f64, f64) -> f64) {
        let ([columns, across, _], stride) = (self.counts, self.stride);
        let [lambda, mu] = self.solid.lame;
        let zeros = || std::array::from_fn(|_| vec![0.0; (across + 1) * stride]);
        let mut forces: [[Vec<f64>; 3]; 2] = [zeros(), zeros()];
        let first = -0.5 * columns as f64 * self.length;
        for row in 0..across {
            let [[y0, _], [y1, _], ..] = self.section.corners(row, 0);
            let area = self.length * (y1 - y0);
            let divergence = self.stiffness[row].shape.divergence();
            for column in 0..columns {
                let x = first + (column as f64 + 0.5) * self.length;
                let share = self
                    .softening
                    .as_ref()
                    .map_or(1.0, |softening| softening.shares[0][row * columns + column]);
                let push = -share * (3.0 * lambda + 2.0 * mu) * area * stretch(x, 0.5 * (y0 + y1));
                for (end, of_end) in divergence.iter().enumerate() {
                    for (corner, weights) in of_end.iter().enumerate() {
                        let at = (row + corner % 2) * stride + column + end;
                        for (force, weight) in forces[corner / 2].iter_mut().zip(weights) {
                            force[at] += push * weight;
                        }
                    }
                }
            }
        }
        self.expansion = Some(Expansion { forces });
    }

    /// Applies thermal softening to the first layer. `shares` are those of the stiffness and of the
    /// yield stress, above 0 and at most 1, at a position (x, y) [m] of the contact with this depth
    /// of the layer [m]. They stay there while the material moves back.
    ///
    /// # Errors
    /// Passes on errors of `shares`.
    pub fn soften<E>(
        &mut self,
        mut shares: impl FnMut(f64, f64, f64) -> Result<[f64; 2], E>,
    ) -> Result<(), E> {
        let [columns, across, _] = self.counts;
        let mut all = [0, 1].map(|_| Vec::with_capacity(across * columns));
        let first = -0.5 * columns as f64 * self.length;
        for row in 0..across {
            let [[y0, z0], [y1, z1], [_, z2], [_, z3]] = self.section.corners(row, 0);
            let depth = 0.5 * (z2 - z0 + z3 - z1);
            for column in 0..columns {
                let x = first + (column as f64 + 0.5) * self.length;
                let of_element = shares(x, 0.5 * (y0 + y1), depth)?;
                all.iter_mut().zip(of_element).for_each(|(all, share)| all.push(share));
            }
        }
        let now = all.clone();
        self.softening = Some(Softening { shares: all, now });
        Ok(())
    }

    /// Adds the forces of the expansion on a plane of nodes.
    fn add_expansion(&mut self, plane: usize, to: usize) {
        let Some(Expansion { forces }) = &self.expansion else { return };
        let part = self.behind / self.length;
        for (forces, from) in self.planes[to].iter_mut().zip(&forces[plane]) {
            forces[0] += (1.0 - part) * from[0];
            for (force, pair) in forces[1..].iter_mut().zip(from.windows(2)) {
                *force += part * pair[0] + (1.0 - part) * pair[1];
            }
        }
    }

    /// Takes a step in time [s], as if nothing touched the surface.
    pub fn step(&mut self, step: f64) {
        let deep = self.counts[2];
        for force in &mut self.planes[0] {
            force.fill(0.0);
        }
        self.add_expansion(0, 0);
        if let Some(softening) = &mut self.softening {
            softening.follow(self.counts[0], self.behind / self.length);
        }
        for layer in 0..deep {
            self.resist(layer);
            if layer == 0 {
                self.add_expansion(1, 2);
            }
            self.advance(layer, step);
            let [above, _, below] = &mut self.planes;
            std::mem::swap(above, below);
        }
        if self.held == Support::Nothing {
            self.planes[1].iter_mut().for_each(|force| force.fill(0.0));
            self.advance(deep, step);
        }
    }

    /// Updates velocities and displacements of a plane of nodes under the forces from above and
    /// below.
    fn advance(&mut self, plane: usize, step: f64) {
        let Self { planes: [above, own, _], damped, velocity, inverse_mass, stride, .. } = self;
        let (last, rows, damping) = (self.counts[0], self.counts[1] + 1, self.damping);
        let ends = usize::from(self.held == Support::Faces);
        for row in 0..rows {
            let inverse = inverse_mass[plane * rows + row];
            if inverse == 0.0 {
                continue;
            }
            let free = |start: usize| start + ends..start + last + 1 - ends;
            let (at, node) = (row * *stride, (plane * rows + row) * *stride);
            for k in 0..3 {
                if self.held == Support::Nothing {
                    for end in [at, at + last] {
                        above[k][end] *= 2.0;
                        own[k][end] *= 2.0;
                    }
                }
                self.arch.dispatch(Advance {
                    forces: [&above[k][free(at)], &own[k][free(at)]],
                    velocity: &mut velocity[k][free(node)],
                    damped: &mut damped[k][free(node)],
                    push: step * inverse,
                    steps: [step + damping, damping],
                });
            }
        }
    }

    /// Computes the forces of a layer on the planes of nodes above and below it.
    fn resist(&mut self, layer: usize) {
        let [elements, across, _] = self.counts;
        let plane = (across + 1) * self.stride;
        let Self {
            planes: [_, own, below],
            damped,
            stiffness,
            stride,
            plastic,
            softening,
            solid,
            arch,
            ..
        } = self;
        let softening = softening.as_ref().filter(|_| layer == 0);
        let of_row = if plastic.is_empty() { 0 } else { PLASTIC * elements };
        own.iter_mut().chain(below.iter_mut()).for_each(|force| force.fill(0.0));
        let [ox, oy, oz] = own;
        let [bx, by, bz] = below;
        for row in 0..across {
            let start = row * *stride;
            let displacement = rows_of(damped, layer * plane + start, plane, *stride);
            let [(x0, x1), (y0, y1), (z0, z1)] =
                [&mut *ox, oy, oz].map(|force| two_rows(force, start, *stride));
            let [(x2, x3), (y2, y3), (z2, z3)] =
                [&mut *bx, by, bz].map(|force| two_rows(force, start, *stride));
            let force = [[x0, y0, z0], [x1, y1, z1], [x2, y2, z2], [x3, y3, z3]];
            let at = layer * across + row;
            let plastic = &mut plastic[at * of_row..(at + 1) * of_row];
            let shares = softening.map_or([&[][..]; 2], |softer| softer.of_row(row, elements));
            let row = Row { elements, stiffness: &stiffness[at], displacement, shares };
            let facts = [solid.radius.is_finite(), solid.flow.is_some(), softening.is_some()];
            of_facts!(facts, Forces { row, force, plastic }, |forces| arch.dispatch(forces));
        }
    }

    /// Elastic energy of u + βv [J]: of the strains, and of the hourglass modes.
    #[must_use]
    pub fn elastic_energy(&self) -> [f64; 2] {
        let [elements, across, _] = self.counts;
        let plane = (across + 1) * self.stride;
        let mut sums = [0.0; 2];
        let of_row = if self.plastic.is_empty() { 0 } else { PLASTIC * elements };
        for (row, stiffness) in self.stiffness.iter().enumerate() {
            let plastic = &self.plastic[row * of_row..(row + 1) * of_row];
            let start = row / across * plane + row % across * self.stride;
            let displacement = rows_of(&self.damped, start, plane, self.stride);
            let softening = self.softening.as_ref().filter(|_| row < across);
            let shares = softening.map_or([&[][..]; 2], |softer| softer.of_row(row, elements));
            let row = Row { elements, stiffness, displacement, shares };
            let solid = &self.solid;
            let facts = [solid.radius.is_finite(), solid.flow.is_some(), softening.is_some()];
            let energy =
                of_facts!(facts, Energy { row, plastic }, |energy| self.arch.dispatch(energy));
            sums.iter_mut().zip(energy).for_each(|(sum, energy)| *sum += energy);
        }
        sums
    }

    /// Plastic work done in the elements of a column [J], and the largest κ in them.
    #[must_use]
    pub fn plastic_work(&self, column: usize) -> [f64; 2] {
        let (Some(flow), elements) = (self.solid.flow, self.counts[0]) else { return [0.0; 2] };
        let Flow { yield_stress, hardening: [isotropic, kinematic] } = flow;
        let (mut work, mut largest) = (0.0, 0.0_f64);
        for (row, stiffness) in self.plastic.chunks_exact(PLASTIC * elements).zip(&self.stiffness) {
            let [xx, yy, xy, yz, xz, grown] = std::array::from_fn(|k| row[k * elements + column]);
            let normals = xx * xx + yy * yy + (xx + yy) * (xx + yy);
            let squares = normals + 2.0 * (xy * xy + yz * yz + xz * xz);
            let isotropic = grown * (yield_stress + 0.5 * isotropic * grown);
            work += stiffness.shape.volume * (isotropic + kinematic * squares / 3.0);
            largest = largest.max(grown);
        }
        [work, largest]
    }

    /// Kinetic energy [J].
    #[must_use]
    pub fn kinetic_energy(&self) -> f64 {
        let (stride, last) = (self.stride, self.counts[0]);
        let part = |column: usize| if column == 0 || column == last { 0.5 } else { 1.0 };
        let of_row = |(row, inverse): (usize, &f64)| {
            let square = |k: usize, column: usize| {
                part(column) * self.velocity[k][row * stride + column].powi(2)
            };
            let squares = (0..3).flat_map(|k| (0..=last).map(move |column| square(k, column)));
            if *inverse == 0.0 { 0.0 } else { 0.5 * squares.sum::<f64>() / inverse }
        };
        self.inverse_mass.iter().enumerate().map(of_row).sum()
    }

    /// Moves the material back by a distance [m], at most one element. Returns true if the columns
    /// were shifted.
    pub fn travel(&mut self, way: f64) -> bool {
        self.behind += way;
        if self.behind < self.length * (1.0 - ROUNDING) {
            return false;
        }
        self.behind -= self.length;
        if self.behind.abs() < ROUNDING * self.length {
            self.behind = 0.0;
        }
        let last = self.counts[0];
        for values in self.damped.iter_mut().chain(&mut self.velocity) {
            for row in values.chunks_exact_mut(self.stride) {
                row.copy_within(1..=last, 0);
                // The first column is fixed, and the last two enter without displacement.
                for node in [0, last - 1, last] {
                    row[node] = 0.0;
                }
            }
        }
        for values in self.plastic.chunks_exact_mut(last) {
            values.copy_within(1.., 0);
            values[last - 1] = 0.0;
        }
        true
    }

    /// Upper bound of the highest angular frequency of small vibrations [1/s] ([`frequency`]).
    #[must_use]
    pub fn highest_frequency(&self) -> f64 {
        let held = self.held == Support::Faces;
        frequency::highest(&self.stiffness, self.counts[1], self.solid.density, held)
    }
}

/// Nodal forces due to the expansion of the first layer.
struct Expansion {
    /// Forces on the first and the second plane of nodes [N], for columns at their nominal
    /// positions.
    forces: [[Vec<f64>; 3]; 2],
}

/// Shares of the stiffness and of the yield stress in the first layer: row of elements after row.
struct Softening {
    /// Shares for columns at their nominal positions.
    shares: [Vec<f64>; 2],
    /// Shares at the present positions of the columns.
    now: [Vec<f64>; 2],
}

impl Softening {
    /// Interpolates the shares for columns that are a part of an element behind their nominal
    /// positions.
    fn follow(&mut self, columns: usize, part: f64) {
        for (now, from) in self.now.iter_mut().zip(&self.shares) {
            for (now, from) in now.chunks_exact_mut(columns).zip(from.chunks_exact(columns)) {
                now[0] = from[0];
                for (now, pair) in now[1..].iter_mut().zip(from.windows(2)) {
                    *now = part * pair[0] + (1.0 - part) * pair[1];
                }
            }
        }
    }

    fn of_row(&self, row: usize, elements: usize) -> [&[f64]; 2] {
        self.now.each_ref().map(|now| &now[row * elements..(row + 1) * elements])
    }
}

/// Step of a row of nodes in one direction.
struct Advance<'a> {
    forces: [&'a [f64]; 2],
    velocity: &'a mut [f64],
    damped: &'a mut [f64],
    /// Δt/M.
    push: f64,
    /// Δt + β and β.
    steps: [f64; 2],
}

impl NullaryFnOnce for Advance<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Self { forces: [above, own], velocity, damped, push, steps: [new_way, old_way] } = self;
        let forces = above.iter().zip(own);
        for ((velocity, damped), (above, own)) in velocity.iter_mut().zip(damped).zip(forces) {
            let new = *velocity - push * (above + own);
            *damped += new_way * new - old_way * *velocity;
            *velocity = new;
        }
    }
}

/// The four rows of nodes round a row of elements.
fn rows_of(values: &[Vec<f64>; 3], start: usize, plane: usize, stride: usize) -> Rows<&[f64]> {
    [0, stride, plane, plane + stride].map(|more| {
        let row = start + more..start + more + stride;
        [&values[0][row.clone()], &values[1][row.clone()], &values[2][row]]
    })
}

/// Two consecutive rows of nodes.
fn two_rows(values: &mut [f64], start: usize, stride: usize) -> (&mut [f64], &mut [f64]) {
    values[start..start + 2 * stride].split_at_mut(stride)
}
