//! Stresses at arbitrary points: one by one, and on lattices of points.
//!
//! The corner sums of all elements are one sum over the nodes of the grid. With F the
//! antiderivatives of [`super`] and f the load,
//!
//! σ(x, y, z) = Σ_n w_n F(x − X_n, y − Y_n, z), w_n = f₋₋ − f₊₋ − f₋₊ + f₊₊ of the four elements
//! around node n with the signs of their corners:
//!
//! with one evaluation per node at which the load changes in both directions; nodes inside and
//! along the edges of uniform loads have no weight.
//!
//! On a lattice x × y × depths the points are processed layer by layer. Points of a layer at the
//! same position in their elements share one kernel. Their stresses are a convolution of the kernel
//! with the loads, by Fourier transforms. A lattice with the spacing of the elements, or a whole
//! multiple of it, is one such set; a lattice with half the spacing has four. Sets of too few
//! points, as with any other spacing, are summed over the nodes.
//!
//! Accuracy: both methods are right to about 1e-13 of the largest traction, and no better far from
//! the contact. [`SurfaceLoad::stresses_at`] keeps its relative accuracy there.

use super::{Element, SurfaceLoad, UnitStresses};
use elastic::Stress;
use grids::Structured;
use numerics::convolution::Convolution;

/// Difference of positions within elements that counts as zero, in elements over their number:
/// rounding of coordinates.
const ALIKE: f64 = 1e-12;

/// Cost of an element of a convolution, in evaluations at a node: four corners of the kernel, and a
/// share of the transforms.
const CONVOLUTION: usize = 16;

/// Nodes of the grid where the load changes, with their weights for p, q_x, q_y [Pa].
#[derive(Debug)]
pub struct Nodes {
    element: Element,
    nodes: Vec<([f64; 2], [f64; 3])>,
}

impl Nodes {
    /// Collects the nodes of a load on a body of this Poisson's ratio [-].
    #[must_use]
    pub fn of(load: &SurfaceLoad<'_>, poisson_ratio: f64) -> Self {
        let grid = load.grid;
        let element = Element { dx: grid.dx(), dy: grid.dy(), poisson_ratio };
        let at = |i: usize, j: usize| match (i.checked_sub(1), j.checked_sub(1)) {
            (Some(i), Some(j)) if i < grid.ni && j < grid.nj => load.on_element(j * grid.ni + i),
            _ => [0.0; 3],
        };
        let mut nodes = Vec::new();
        for j in 0..=grid.nj {
            for i in 0..=grid.ni {
                let around = [at(i + 1, j + 1), at(i, j + 1), at(i + 1, j), at(i, j)];
                let [own, left, low, both] = around;
                let weight: [f64; 3] =
                    std::array::from_fn(|k| (own[k] - left[k]) - (low[k] - both[k]));
                if weight != [0.0; 3] {
                    let x = grid.x(0) + (i as f64 - 0.5) * grid.dx();
                    let y = grid.y(0) + (j as f64 - 0.5) * grid.dy();
                    nodes.push(([x, y], weight));
                }
            }
        }
        Self { element, nodes }
    }

    /// Number of nodes.
    #[must_use]
    pub fn count(&self) -> usize {
        self.nodes.len()
    }

    /// Stress at a point (x, y, depth) [m].
    ///
    /// # Panics
    /// If the depth is negative.
    #[must_use]
    pub fn stress(&self, [x, y, depth]: [f64; 3]) -> Stress {
        assert!(depth >= 0.0, "a depth of {depth} m is outside the body");
        let by = |([at_x, at_y], [pressure, along_x, along_y]): &([f64; 2], [f64; 3])| {
            let corner = self.element.corner(x - at_x, y - at_y, depth);
            corner.under(*pressure, [*along_x, *along_y])
        };
        self.nodes.iter().map(by).sum()
    }
}

impl SurfaceLoad<'_> {
    /// Stresses [Pa] at the points of a lattice of x, y and depths [m], x fastest, then y.
    ///
    /// # Panics
    /// If a depth is negative.
    #[must_use]
    pub fn on_lattice(&self, poisson_ratio: f64, [xs, ys, depths]: [&[f64]; 3]) -> Vec<Stress> {
        let nodes = Nodes::of(self, poisson_ratio);
        let layer = xs.len() * ys.len();
        let mut stresses = vec![Stress::default(); layer * depths.len()];
        let Some(loaded) = Loaded::of(self) else { return stresses };
        let alike = |values: &[f64], first: f64, side: f64| -> Vec<CoordinateClass> {
            CoordinateClass::sets(values.iter().map(|value| (value - first) / side))
        };
        let columns = alike(xs, loaded.origin[0], nodes.element.dx);
        let rows = alike(ys, loaded.origin[1], nodes.element.dy);
        for row in &rows {
            for column in &columns {
                let set = Set { column, row };
                let mut sum = set.convolution(&loaded, nodes.count());
                for (depth, stresses) in depths.iter().zip(stresses.chunks_exact_mut(layer)) {
                    let mut store =
                        |i: usize, j: usize, stress| stresses[j * xs.len() + i] = stress;
                    if let Some(sum) = &mut sum {
                        sum.layer(&nodes.element, &set, *depth, &mut store);
                        continue;
                    }
                    for (j, _) in &row.members {
                        for (i, _) in &column.members {
                            store(*i, *j, nodes.stress([xs[*i], ys[*j], *depth]));
                        }
                    }
                }
            }
        }
        stresses
    }
}

/// Smallest rectangle of elements that contains all loads.
struct Loaded {
    /// Centre of the first element [m].
    origin: [f64; 2],
    /// Elements along x and along y.
    counts: [usize; 2],
    /// Fields p, q_x, q_y [Pa]; empty if zero everywhere.
    fields: [Vec<f64>; 3],
}

impl Loaded {
    fn of(load: &SurfaceLoad<'_>) -> Option<Self> {
        let grid: &Structured = load.grid;
        let mut ranges = [[usize::MAX, 0]; 2];
        for at in (0..grid.points()).filter(|at| load.on_element(*at) != [0.0; 3]) {
            for (range, place) in ranges.iter_mut().zip([at % grid.ni, at / grid.ni]) {
                *range = [range[0].min(place), range[1].max(place)];
            }
        }
        let [columns, rows] = ranges;
        let counts = ranges.map(|[first, last]| (last + 1).saturating_sub(first));
        let fields = [0, 1, 2].map(|kind| {
            let of_row = |j| (columns[0]..=columns[1]).map(move |i| j * grid.ni + i);
            let elements = (rows[0]..=rows[1]).flat_map(of_row);
            let values: Vec<f64> = elements.map(|at| load.on_element(at)[kind]).collect();
            if values.iter().all(|value| *value == 0.0) { Vec::new() } else { values }
        });
        let loaded = counts.iter().all(|count| *count > 0);
        loaded.then(|| Self { origin: [grid.x(columns[0]), grid.y(rows[0])], counts, fields })
    }
}

/// Coordinates at the same position within their elements.
struct CoordinateClass {
    /// Distance beyond the middle of the element, in elements.
    beyond: f64,
    /// Index in the axis, and number of the element counted from the first loaded one.
    members: Vec<(usize, i32)>,
}

impl CoordinateClass {
    fn sets(values: impl Iterator<Item = f64>) -> Vec<Self> {
        let mut sets: Vec<Self> = Vec::new();
        for (place, value) in values.enumerate() {
            // Half an element is always rounded to the same side, whatever its own rounding.
            let element = (value - ALIKE.sqrt()).round();
            let beyond = value - element;
            let near = ALIKE * value.abs().max(1.0);
            let member = (place, element.clamp(-1e9, 1e9) as i32);
            match sets.iter_mut().find(|set| (set.beyond - beyond).abs() <= near) {
                Some(set) => set.members.push(member),
                None => sets.push(Self { beyond, members: vec![member] }),
            }
        }
        sets
    }

    /// First and last element of the points and loads together.
    fn range(&self, loaded: usize) -> [i32; 2] {
        let last = i32::try_from(loaded).expect("a grid in memory has fewer elements") - 1;
        let all = || self.members.iter().map(|(_, element)| *element);
        [all().min().unwrap_or(0).min(0), all().max().unwrap_or(0).max(last)]
    }
}

/// Points of a layer that share one kernel.
struct Set<'a> {
    column: &'a CoordinateClass,
    row: &'a CoordinateClass,
}

impl Set<'_> {
    /// Prepares the convolution if it is cheaper than sums over `nodes` nodes.
    fn convolution(&self, loaded: &Loaded, nodes: usize) -> Option<LayerConvolution> {
        let ranges = [self.column.range(loaded.counts[0]), self.row.range(loaded.counts[1])];
        let counts = ranges.map(|[first, last]| last.abs_diff(first) as usize + 1);
        let points = self.column.members.len() * self.row.members.len();
        let cost = counts[0].saturating_mul(counts[1]).saturating_mul(CONVOLUTION);
        (points.saturating_mul(nodes) > cost).then(|| LayerConvolution::new(loaded, ranges, counts))
    }
}

/// Working memory of a set for all layers.
struct LayerConvolution {
    plan: Convolution,
    counts: [usize; 2],
    /// Element of the first value.
    first: [i32; 2],
    /// Fields p, q_x, q_y on the elements of points and loads together; empty if zero everywhere.
    fields: [Vec<f64>; 3],
    sums: [Vec<f64>; 6],
    part: Vec<f64>,
}

impl LayerConvolution {
    fn new(loaded: &Loaded, ranges: [[i32; 2]; 2], counts: [usize; 2]) -> Self {
        let first = ranges.map(|[first, _]| first);
        let [skip_x, skip_y] = first.map(|first| first.unsigned_abs() as usize);
        let size = counts[0] * counts[1];
        let fields = loaded.fields.each_ref().map(|field| {
            let mut wide = vec![0.0; if field.is_empty() { 0 } else { size }];
            for (j, row) in field.chunks_exact(loaded.counts[0]).enumerate() {
                let at = (j + skip_y) * counts[0] + skip_x;
                wide[at..at + row.len()].copy_from_slice(row);
            }
            wide
        });
        Self {
            plan: Convolution::new(counts[0], counts[1]),
            counts,
            first,
            fields,
            sums: std::array::from_fn(|_| vec![0.0; size]),
            part: vec![0.0; size],
        }
    }

    /// Computes and stores the stresses of a layer.
    fn layer(
        &mut self,
        element: &Element,
        set: &Set<'_>,
        depth: f64,
        store: &mut impl FnMut(usize, usize, Stress),
    ) {
        let Self { plan, counts, first, fields, sums, part } = self;
        let [across, down] = counts.map(|count| 2 * count - 1);
        let units = unit_stresses(element, [set.column.beyond, set.row.beyond], *counts, depth);
        let at = |di: i32, dj: i32| {
            let place = |by: i32, count: usize| (by as isize + count as isize - 1) as usize;
            place(dj, counts[1]) * across + place(di, counts[0])
        };
        debug_assert_eq!(units.len(), across * down);
        for (component, sum) in sums.iter_mut().enumerate() {
            sum.fill(0.0);
            for (kind, field) in fields.iter().enumerate().filter(|(_, field)| !field.is_empty()) {
                let kernel = plan.spectrum(|di, dj| units[at(di, dj)][kind][component]);
                plan.apply(&kernel, field, part);
                sum.iter_mut().zip(part.iter()).for_each(|(sum, part)| *sum += part);
            }
        }
        for (j, row) in &set.row.members {
            for (i, column) in &set.column.members {
                let at = (row - first[1]) as usize * counts[0] + (column - first[0]) as usize;
                let [xx, yy, zz, yz, xz, xy] = sums.each_ref().map(|sum| sum[at]);
                store(*i, *j, Stress { xx, yy, zz, yz, xz, xy });
            }
        }
    }
}

/// Stresses by unit loads p, q_x and q_y at all offsets between elements, row after row from the
/// most negative offsets; components as in [`Stress::components`].
fn unit_stresses(
    element: &Element,
    beyond: [f64; 2],
    counts: [usize; 2],
    depth: f64,
) -> Vec<[[f64; 6]; 3]> {
    let place = |node: usize, axis: usize, side: f64| {
        (node as f64 - counts[axis] as f64 + 0.5 + beyond[axis]) * side
    };
    let line = |node: usize| -> Vec<UnitStresses> {
        let y = place(node, 1, element.dy);
        let xs = (0..2 * counts[0]).map(|node| place(node, 0, element.dx));
        xs.map(|x| element.corner(x, y, depth)).collect()
    };
    let mut units = Vec::with_capacity((2 * counts[0] - 1) * (2 * counts[1] - 1));
    let mut low = line(0);
    for node in 1..2 * counts[1] {
        let high = line(node);
        units.extend(low.windows(2).zip(high.windows(2)).map(|(low, high)| {
            let [left, right] = [0, 1].map(|end| high[end].plus(-1.0, &low[end]));
            right.plus(-1.0, &left).components()
        }));
        low = high;
    }
    units
}
