//! A grid of vertices: its triangles and edges, and the nearest point to a given point.
//!
//! The surface consists of the triangles, of the edges that are no side of a triangle, and of the
//! points that belong to neither. A side of one triangle alone, and an end of one edge alone, is
//! part of the border. Without any connectivity a cloud has no border and no surface: the foot of a
//! point is the point itself, and the stencil of an interpolant consists of the [`NEAREST`] nearest
//! points, further ones at the same distance, and no two at the same place.

use super::nodes::{Foot, Nodes, Span};
use super::patch::{COINCIDENT, Patch, Vector, nearest_of};
use contract::grid::{Grid, Shape, Vertices};
use rstar::{PointDistance, RTree};
use std::collections::HashSet;

/// Number of points in the stencil of a grid without connectivity.
const NEAREST: usize = 25;

/// Limit of a stencil with points at the same distance.
const MOST_NEAREST: usize = 2 * NEAREST;

/// Fraction of the largest extent of a stencil below which it is a line or a surface. Half a disc
/// and half a ball, the stencils at a border, have 0.53 and 0.54.
const THIN: f64 = 0.1;

/// Fraction of an extent below which sides of triangles of any aspect ratio are on a line.
const FLAT: f64 = 1e-6;

/// Weight of a corner below which a foot is on the opposite side.
const ON_SIDE: f64 = 1e-9;

/// Vertices prepared for mappings.
#[derive(Debug)]
pub(super) struct Cloud {
    places: Vec<Vector>,
    /// Typical distance of neighbours [m].
    size: f64,
    /// Search tree of triangles, edges and single points, with vertices as nodes.
    tree: RTree<Patch>,
    connectivity: Connectivity,
    /// Neighbours of vertex v: `neighbours[starts[v]..starts[v + 1]]`.
    starts: Vec<usize>,
    neighbours: Vec<u32>,
    /// Sides of one triangle alone.
    border: HashSet<[u32; 2]>,
    /// Whether a vertex is on the border.
    on_border: Vec<bool>,
}

/// Highest dimension of the elements between vertices.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Connectivity {
    None,
    Edges,
    Triangles,
}

impl Cloud {
    /// Prepares a grid that has passed its check; `None` if it is no grid of vertices.
    pub(super) fn of(grid: &Grid) -> Option<Self> {
        let Shape::Vertices(vertices) = &grid.shape else { return None };
        let places: Vec<Vector> = vertices.points.iter().map(|point| (*point).into()).collect();
        let low = places.iter().fold(places[0], |low, place| low.inf(place));
        let high = places.iter().fold(places[0], |high, place| high.sup(place));
        let connectivity = match (vertices.triangles.is_empty(), vertices.edges.is_empty()) {
            (false, _) => Connectivity::Triangles,
            (true, false) => Connectivity::Edges,
            (true, true) => Connectivity::None,
        };
        let sides = sides(vertices);
        let (starts, neighbours) = neighbours(places.len(), &sides);
        let mut cloud = Self {
            size: (high - low).norm() / (places.len() as f64).sqrt(),
            tree: RTree::new(),
            connectivity,
            starts,
            neighbours,
            border: HashSet::new(),
            on_border: vec![false; places.len()],
            places,
        };
        cloud.mark_border(&sides);
        cloud.tree = RTree::bulk_load(cloud.elements(vertices, &sides));
        Some(cloud)
    }

    fn mark_border(&mut self, sides: &[(Side, usize)]) {
        for &(side, triangles) in sides {
            if triangles == 1 {
                self.border.insert(side);
                side.iter().for_each(|end| self.on_border[*end as usize] = true);
            }
        }
        for (side, _) in sides.iter().filter(|(_, triangles)| *triangles == 0) {
            for end in side.map(|end| end as usize) {
                self.on_border[end] |= self.starts[end + 1] - self.starts[end] == 1;
            }
        }
    }

    /// Returns the patches of triangles, of edges without triangles, and of single points.
    fn elements(&self, vertices: &Vertices, sides: &[(Side, usize)]) -> Vec<Patch> {
        let patch = |nodes: &[u32]| {
            let corners = nodes.iter().map(|node| self.places[*node as usize]).collect();
            Patch::new(corners, nodes.into())
        };
        let edges = sides.iter().filter(|(_, triangles)| *triangles == 0);
        let single = (0..self.places.len()).filter(|n| self.starts[*n] == self.starts[n + 1]);
        let triangles = vertices.triangles.iter().map(|corners| patch(corners));
        let edges = edges.map(|(side, _)| patch(side));
        triangles.chain(edges).chain(single.map(|n| patch(&[n as u32]))).collect()
    }

    /// Returns the distance beyond the border along a patch, whose nearest point has these weights
    /// and this offset from the given point.
    fn outside(&self, nodes: &[u32], weights: &[f64; 3], offset: Vector) -> f64 {
        let place = |corner: usize| self.places[nodes[corner] as usize];
        let count = nodes.len();
        let at_vertex = (0..count).find(|n| weights[*n] > 1.0 - ON_SIDE);
        let beyond = match at_vertex {
            Some(corner) => self.on_border[nodes[corner] as usize],
            None if count == 3 => (0..3).any(|n| {
                let side = sorted([nodes[n], nodes[(n + 1) % 3]]);
                weights[(n + 2) % 3] < ON_SIDE && self.border.contains(&side)
            }),
            None => false,
        };
        match count {
            _ if !beyond => 0.0,
            3 => {
                let normal = (place(1) - place(0)).cross(&(place(2) - place(0))).normalize();
                (offset - offset.dot(&normal) * normal).norm()
            }
            2 => offset.dot(&(place(1) - place(0)).normalize()).abs(),
            _ => 0.0,
        }
    }
}

impl Nodes for Cloud {
    fn places(&self) -> &[Vector] {
        &self.places
    }

    fn size(&self, _: usize) -> f64 {
        self.size
    }

    fn foot(&self, from: Vector) -> Foot {
        let (patch, nearest) = nearest_of(&self.tree, from).expect("a checked grid has points");
        let mut weights = [0.0; 3];
        nearest.weights.iter().for_each(|(corner, weight)| {
            if *weight > 0.0 {
                weights[*corner] += weight;
            }
        });
        let heaviest = (0..3).max_by(|a, b| weights[*a].total_cmp(&weights[*b])).unwrap_or(0);
        let node = patch.nodes[heaviest] as usize;
        match self.connectivity {
            Connectivity::None => Foot { node, point: from, outside: 0.0 },
            _ => {
                let outside = self.outside(&patch.nodes, &weights, from - nearest.point);
                Foot { node, point: nearest.point, outside }
            }
        }
    }

    fn seeds(&self, foot: &Foot, stencil: &mut Vec<u32>) {
        if self.connectivity != Connectivity::None {
            let patch = nearest_of(&self.tree, foot.point).map(|(patch, _)| &patch.nodes);
            stencil.extend(patch.into_iter().flatten());
            return;
        }
        let from: [f64; 3] = foot.point.into();
        let mut reach = 0.0;
        for patch in self.tree.nearest_neighbor_iter(from) {
            let distance_2 = patch.distance_2(&from);
            let further = distance_2 > reach * (1.0 + COINCIDENT);
            if stencil.len() >= MOST_NEAREST || (stencil.len() >= NEAREST && further) {
                break;
            }
            let place = |node: u32| self.places[node as usize];
            let node = patch.nodes[0];
            // Points at one place are equally far: they follow each other.
            let same = stencil.iter().rev().take_while(|other| {
                (place(**other) - foot.point).norm_squared() >= distance_2 * (1.0 - COINCIDENT)
            });
            if same.into_iter().all(|other| place(*other) != place(node)) {
                stencil.push(node);
                reach = distance_2;
            }
        }
        stencil.sort_unstable();
    }

    fn ring(&self, node: u32, ring: &mut Vec<u32>) {
        let node = node as usize;
        ring.extend(&self.neighbours[self.starts[node]..self.starts[node + 1]]);
    }

    fn span(&self) -> Span {
        match self.connectivity {
            Connectivity::None => Span { directions: 3, flat: THIN, bounded: true },
            Connectivity::Edges => Span { directions: 2, flat: THIN, bounded: true },
            Connectivity::Triangles => Span { directions: 2, flat: FLAT, bounded: true },
        }
    }

    fn patches(&self) -> Option<Vec<Patch>> {
        let connected = self.connectivity != Connectivity::None;
        connected.then(|| self.tree.iter().cloned().collect())
    }
}

/// Two vertices, the lower number first.
type Side = [u32; 2];

fn sorted([a, b]: [u32; 2]) -> Side {
    [a.min(b), a.max(b)]
}

/// Returns every edge and every side of a triangle once, with the number of its triangles.
fn sides(vertices: &Vertices) -> Vec<(Side, usize)> {
    let of_triangles = vertices.triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
    let of_triangles = of_triangles.map(|side| (sorted(side), 1));
    let edges = vertices.edges.iter().map(|edge| (sorted(*edge), 0));
    let mut sides: Vec<(Side, usize)> = of_triangles.chain(edges).collect();
    sides.sort_unstable();
    sides.dedup_by(|next, kept| {
        let same = next.0 == kept.0;
        if same {
            kept.1 += next.1;
        }
        same
    });
    sides
}

/// Returns the neighbours of all vertices, with the start of each.
fn neighbours(count: usize, sides: &[(Side, usize)]) -> (Vec<usize>, Vec<u32>) {
    let mut starts = vec![0; count + 1];
    for end in sides.iter().flat_map(|(side, _)| side) {
        starts[*end as usize + 1] += 1;
    }
    for vertex in 0..count {
        starts[vertex + 1] += starts[vertex];
    }
    let mut next = starts.clone();
    let mut neighbours = vec![0; 2 * sides.len()];
    for ([a, b], _) in sides {
        for (vertex, other) in [(*a, *b), (*b, *a)] {
            neighbours[next[vertex as usize]] = other;
            next[vertex as usize] += 1;
        }
    }
    (starts, neighbours)
}
