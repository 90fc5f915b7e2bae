//! The meshed block of a body: its extent behind the contact, across and in depth, and its
//! resolution.
//!
//! The extents in depth and sideways follow from the distance that heat spreads while the material
//! passes, s = √(4κ(L + w)/V) with half the length L of the heat flux's grid and the wake w. They
//! are 3.5 s, where the effect of a step of heat has fallen to 1e-6. If this exceeds [`FAR`] times
//! L, at low speed or at rest, the block ends there. The far field then conducts heat like a
//! half-space that is heated at its centre: T falls like 1/r, so that ∂T/∂n = −T/r.

use super::mesh::{Axis, surroundings};
use super::scheme::Scheme;
use super::transient::Columns;
use crate::Material;
use grids::Structured;
use std::f64::consts::PI;
use tables::readable::{number, quantity};

/// Extent of a block in depth and sideways, in distances that heat spreads.
const SPREADS: f64 = 3.5;
/// Largest extent of a block, in half lengths of the heat flux's grid.
pub const FAR: f64 = 100.0;
/// Extent in front, and least extent behind, of slow transient cases, in half lengths of the grid.
const FAR_ALONG: f64 = 5.0;
/// Growth ratio of elements beside the rows of the heat flux.
const GROWTH: f64 = 1.3;
/// Number of first layers in a penetration depth.
const LAYERS: f64 = 20.0;
/// Number of first layers in the depth √(κt) that heat reaches in the shortest time t of heating
/// ([`Elements::shortest_heating`]).
const LAYERS_OF_A_HEATING: f64 = 8.0;
/// First layer over the depth √(κt) of a heating, and the share of the rise that is missing at its
/// end. Solutions of the equations of the layers in depth, with a ratio of 1.2 and exact in time.
const MISSING: [[f64; 2]; 6] =
    [[0.125, 0.0], [0.25, 0.003], [0.5, 0.013], [1.0, 0.058], [2.0, 0.264], [4.0, 0.564]];
/// Number of layers of a sheet if all were as thick as the first.
const LAYERS_OF_A_SHEET: f64 = 8.0;
/// Largest number of columns of elements behind the heat flux's grid.
pub const MOST_BEHIND: f64 = 1e6;
/// Largest number of layers of elements in depth.
pub const MOST_LAYERS: f64 = 2000.0;
/// Growth ratio of the layers in depth.
pub const RATIO: f64 = 1.2;
/// Extent in front of the contact, in diffusion lengths along.
const AHEAD: f64 = 10.0;

/// Solver of the finite-element equations.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Solver {
    /// Modes of the mesh for constant properties, iterations otherwise.
    #[default]
    Auto,
    /// By Newton's method and conjugate gradients.
    Iterative,
    /// By Newton's method and a sparse factorisation.
    Direct,
}

/// Passages of the same place of a body through the contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Passages {
    /// Number of passages, this one included.
    pub count: usize,
    /// Distance between two passages [m].
    pub distance: f64,
}

/// Back surface of a body of finite thickness.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Back {
    /// Insulated, or the mid-plane of a body that is heated from both sides.
    Insulated,
    /// Held at the initial temperature.
    Fixed,
}

/// A body of finite thickness.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sheet {
    /// Thickness [m].
    pub thickness: f64,
    /// Back surface.
    pub back: Back,
}

/// Settings of the finite elements.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Elements {
    /// Thickness of the first layer [m].
    pub first_layer: Option<f64>,
    /// Ratio of the thickness of a layer to that of the layer above.
    pub ratio: f64,
    /// Depth of the block [m].
    pub depth: Option<f64>,
    /// Length of the block behind the middle of the heat flux's grid [m].
    pub wake: Option<f64>,
    /// Highest expected speed, if it is above the speed that the block is laid out for [m/s].
    pub fastest: f64,
    /// Shortest window at the end of which the surface must be resolved [s]; infinite in steady
    /// motion.
    pub window: f64,
    /// Scheme in time.
    pub scheme: Scheme,
    /// Longest step [s].
    pub step: f64,
    /// Solver of the equations.
    pub solver: Solver,
    /// Earlier passages of this body.
    pub passages: Option<Passages>,
    /// Thickness and back of a finite body.
    pub sheet: Option<Sheet>,
}

impl Default for Elements {
    fn default() -> Self {
        Self {
            first_layer: None,
            ratio: RATIO,
            depth: None,
            wake: None,
            fastest: 0.0,
            window: f64::INFINITY,
            scheme: Scheme::CrankNicolson,
            step: f64::INFINITY,
            solver: Solver::Auto,
            passages: None,
            sheet: None,
        }
    }
}

/// Error for meshes that do not fit into memory.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum TooManyElements {
    /// Too many columns behind the contact.
    #[error("{columns} columns of elements, {length} long, are behind the contact", columns = number(*.columns, 4), length = quantity(*.length, "m", 4))]
    Behind {
        /// Columns of elements.
        columns: f64,
        /// Length of an element [m].
        length: f64,
        /// Longest wake that is allowed [m].
        most_wake: f64,
    },
    /// Too many layers in depth.
    #[error(
        "{layers} layers of elements reach from {first} to {deep} of depth, each {ratio} times \
         as thick as the one above it", layers = number(*.layers, 4), first = quantity(*.first, "m", 4), deep = quantity(*.deep, "m", 4))]
    InDepth {
        /// Number of layers of elements.
        layers: f64,
        /// Thickness of the first layer [m].
        first: f64,
        /// Depth of the block [m].
        deep: f64,
        /// Ratio of the thickness of a layer to that of the layer above.
        ratio: f64,
    },
}

impl Elements {
    /// Returns the length of the block behind the middle of a grid [m].
    fn wake(&self, grid: &Structured) -> f64 {
        self.wake.unwrap_or(5.0 * half_length(grid))
    }

    /// Returns the number of columns behind those of a grid.
    #[must_use]
    pub fn behind(&self, grid: &Structured) -> usize {
        self.columns_behind(grid) as usize
    }

    fn columns_behind(&self, grid: &Structured) -> f64 {
        let more = (self.wake(grid) - half_length(grid)) / grid.dx();
        (more * (1.0 - 1e-12)).ceil().max(2.0)
    }

    /// Refuses meshes that do not fit into memory, before anything is allocated. The arguments are
    /// those of [`Block::new`].
    ///
    /// # Errors
    /// Columns behind the contact or layers in depth are too many.
    pub fn check_size(
        &self,
        grid: &Structured,
        material: &Material,
        speed: f64,
    ) -> Result<(), TooManyElements> {
        let columns = self.columns_behind(grid);
        if columns > MOST_BEHIND {
            let most_wake = half_length(grid) + MOST_BEHIND * grid.dx();
            return Err(TooManyElements::Behind { columns, length: grid.dx(), most_wake });
        }
        let Layering { first, deep, .. } = self.layering(grid, material, speed);
        let layers = Axis::layers(first, self.ratio, deep);
        if layers > MOST_LAYERS {
            return Err(TooManyElements::InDepth { layers, first, deep, ratio: self.ratio });
        }
        Ok(())
    }

    /// Returns the shortest time [s] for which a place of the surface is heated before its rise is
    /// needed: the passage of an element at the highest speed, or the shortest window. Infinite for
    /// a body at rest in a steady state.
    #[must_use]
    pub fn shortest_heating(&self, grid: &Structured, speed: f64) -> f64 {
        (grid.dx() / self.fastest.max(speed)).min(self.window)
    }

    /// Returns the share of the rise after the shortest heating that a first layer thicker than
    /// the depth of this heat does not show. The arguments are those of [`Block::new`].
    #[must_use]
    pub fn missing_share(&self, grid: &Structured, material: &Material, speed: f64) -> f64 {
        let depth = (material.diffusivity() * self.shortest_heating(grid, speed)).sqrt();
        missing_share(self.layering(grid, material, speed).first / depth)
    }

    fn layering(&self, grid: &Structured, material: &Material, speed: f64) -> Layering {
        let half = half_length(grid);
        let kappa = material.diffusivity();
        let earlier = self.passages.map_or(0.0, |p| (p.count - 1) as f64 * p.distance);
        let passing = (half + self.wake(grid) + earlier) / speed;
        let spread = SPREADS * (4.0 * kappa * passing).sqrt();
        let (reach, far) = (spread.min(FAR * half), spread > FAR * half);
        let penetration = (2.0 * kappa * half / self.fastest.max(speed)).sqrt().min(half);
        let heated = self.shortest_heating(grid, speed);
        let reached = (kappa * heated).sqrt().min(2.0 * grid.dx());
        let first = (penetration / LAYERS).min(reached / LAYERS_OF_A_HEATING);
        Layering {
            first: self.first_layer.unwrap_or(first),
            deep: self.depth.unwrap_or(reach),
            reach,
            far,
        }
    }
}

/// Returns the missing share of the rise for a first layer over the depth of a heating.
fn missing_share(over: f64) -> f64 {
    let next = MISSING.partition_point(|[known, _]| *known <= over);
    match (next.checked_sub(1).map(|at| MISSING[at]), MISSING.get(next)) {
        (None, _) => 0.0,
        (Some([from, low]), Some([to, high])) => {
            low + (high - low) * (over / from).ln() / (to / from).ln()
        }
        // The first node takes up all the heat: its rise is 2qt/(ρch₀) instead of 2q√(t/π)/β.
        (Some(_), None) => 1.0 - PI.sqrt() / over,
    }
}

/// Layers of a body in depth.
struct Layering {
    /// Thickness of the first layer [m].
    first: f64,
    /// Depth of the block [m].
    deep: f64,
    /// Depth that heat reaches [m].
    reach: f64,
    /// Whether the heat reaches further than the block.
    far: bool,
}

/// The mesh of a body, axis by axis.
#[derive(Clone, Debug, PartialEq)]
pub struct Block {
    /// Axis across.
    pub across: Axis,
    /// Node across of the first row of the heat flux.
    pub first_row: usize,
    /// Axis in depth.
    pub depth: Axis,
    /// Depth of the fixed temperature below the last node, if any [m].
    pub fixed: Option<f64>,
    /// Columns along.
    pub columns: Columns,
}

impl Block {
    /// Creates the block of a body below a grid of the heat flux, for an expected speed [m/s]; 0 at
    /// rest.
    #[must_use]
    pub fn new(grid: &Structured, material: &Material, speed: f64, elements: &Elements) -> Self {
        let Layering { first, deep, reach, far } = elements.layering(grid, material, speed);
        let beyond = |distance: f64| if far { 1.0 / distance } else { 0.0 };
        let sheet = elements.sheet.filter(|sheet| sheet.thickness <= deep);
        let (depth, fixed) = match sheet {
            Some(Sheet { thickness, back }) => {
                let first = first.min(thickness / LAYERS_OF_A_SHEET);
                let depth = Axis::graded_to(first, elements.ratio, thickness);
                match back {
                    Back::Insulated => (depth, None),
                    Back::Fixed => (depth.fixed(), Some(thickness)),
                }
            }
            None => {
                let depth = Axis::graded(first, elements.ratio, deep);
                let bottom = beyond(depth.places[depth.len() - 1]);
                (depth.ending([0.0, bottom]), None)
            }
        };
        let beside = surroundings(grid.dy(), GROWTH, reach);
        let half_width = 0.5 * grid.nj as f64 * grid.dy();
        let side = beyond(half_width + beside.iter().sum::<f64>());
        let rows = std::iter::repeat_n(grid.dy(), grid.nj);
        let widths = beside.iter().rev().copied().chain(rows).chain(beside.iter().copied());
        let edge = grid.y(0) - 0.5 * grid.dy() - beside.iter().sum::<f64>();
        Self {
            across: Axis::middles(edge, widths.collect()).ending([side; 2]),
            first_row: beside.len(),
            depth,
            fixed,
            columns: columns(grid, material.diffusivity(), speed, elements),
        }
    }

    /// Returns the depths of the nodes, and of the fixed temperature below them [m].
    #[must_use]
    pub fn depths(&self) -> Vec<f64> {
        self.depth.places.iter().copied().chain(self.fixed).collect()
    }

    /// Returns the depths of the faces between the nodes' control volumes [m].
    #[must_use]
    pub fn faces(&self) -> Vec<f64> {
        let below = self.depth.widths.iter().scan(0.0, |depth, width| {
            *depth += width;
            Some(*depth)
        });
        std::iter::once(0.0).chain(below).chain(self.fixed).collect()
    }

    /// Returns the number of nodes.
    #[must_use]
    pub fn nodes(&self) -> usize {
        self.columns.count() * self.across.len() * self.depth.len()
    }
}

fn columns(grid: &Structured, kappa: f64, speed: f64, elements: &Elements) -> Columns {
    let (half, h) = (half_length(grid), grid.dx());
    let far = (FAR_ALONG * half / h).ceil();
    let front = (AHEAD * kappa / (speed * h)).ceil() + 2.0;
    let slow = front > far;
    let behind = elements.behind(grid) as f64;
    let [behind, front] = if slow { [behind.max(far), far] } else { [behind, front] };
    let beyond = |columns: f64| if slow { 1.0 / (half + columns * h) } else { 0.0 };
    Columns {
        h,
        heated: grid.ni,
        behind: behind as usize,
        front: front as usize,
        ends: [beyond(behind), beyond(front)],
    }
}

fn half_length(grid: &Structured) -> f64 {
    0.5 * grid.ni as f64 * grid.dx()
}
