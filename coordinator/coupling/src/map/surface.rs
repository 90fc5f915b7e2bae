//! A grid as a surface: elements, their neighbours, and the nearest point to a given point.
//!
//! Two elements are neighbours across a side if they, and no third element, have both of its ends.
//! A side without a neighbour is part of the border. The surface through the element centres is the
//! dual mesh. It has a patch around every inner vertex, with the centres of the elements there as
//! corners. Where the grid is only one element wide, it consists of the segments between
//! neighbouring centres. An element without neighbours is represented by its centre.

use super::nodes::{Foot, Nodes, Span};
use super::patch::{COINCIDENT, Patch, Vector, nearest_of};
use contract::grid::{Grid, Quadrilaterals, Shape};
use rstar::RTree;

/// Fraction of the largest extent of a stencil below which an extent counts as zero: elements may
/// have any aspect ratio.
const FLAT: f64 = 1e-6;

/// Marks a missing neighbour.
const NONE: u32 = u32::MAX;

/// Elements prepared for mappings.
#[derive(Debug)]
pub(super) struct Surface {
    /// Element centres [m].
    pub(super) centres: Vec<Vector>,
    /// Element areas [m²].
    pub(super) areas: Vec<f64>,
    /// Search tree of the elements.
    pub(super) tree: RTree<Patch>,
    shape: Quadrilaterals,
    /// The element across each side, from corner k to k + 1.
    neighbours: Vec<[u32; 4]>,
    /// Elements at vertex v: `at_vertex[starts[v]..starts[v + 1]]`.
    at_vertex: Vec<u32>,
    starts: Vec<usize>,
}

impl Surface {
    /// Creates the surface of a grid that has passed its check; `None` for all
    /// other grids.
    pub(super) fn of(grid: &Grid) -> Option<Self> {
        let shape = match &grid.shape {
            Shape::Structured(structured) => Quadrilaterals::from(structured),
            Shape::Quadrilaterals(shape) => shape.clone(),
            Shape::Vertices(_) | Shape::Volume(_) | Shape::Points(_) => return None,
        };
        let count = grid.points();
        let patch = |element: usize| {
            Patch::new(shape.corners(element).map(Vector::from).into(), [element as u32].into())
        };
        let tree = RTree::bulk_load((0..count).map(patch).collect());
        let (starts, at_vertex) = elements_at_vertices(&shape);
        Some(Self {
            centres: (0..count).map(|n| grid.centre(n).into()).collect(),
            areas: grid.areas(),
            tree,
            neighbours: neighbours(&shape.elements),
            at_vertex,
            starts,
            shape,
        })
    }

    /// Corners of an element [m].
    pub(super) fn corners(&self, element: usize) -> [Vector; 4] {
        self.shape.corners(element).map(Vector::from)
    }

    /// Returns the elements at a foot: several where the foot is on a side or a vertex.
    pub(super) fn at(&self, foot: &Foot) -> impl Iterator<Item = u32> {
        let reach = COINCIDENT * self.size(foot.node);
        let here = self.tree.locate_within_distance(foot.point.into(), reach * reach);
        here.map(|patch| patch.nodes[0])
    }

    fn at_vertex(&self, vertex: u32) -> &[u32] {
        let vertex = vertex as usize;
        &self.at_vertex[self.starts[vertex]..self.starts[vertex + 1]]
    }

    /// Returns the elements around a vertex, in order; `None` on the border.
    fn round(&self, vertex: u32) -> Option<Vec<u32>> {
        let &first = self.at_vertex(vertex).first()?;
        let mut round = vec![first];
        let mut element = first;
        let mut before = NONE;
        loop {
            let corner = self.shape.elements[element as usize].iter().position(|v| *v == vertex)?;
            let sides = [corner, (corner + 3) % 4];
            let [one, other] = sides.map(|side| self.neighbours[element as usize][side]);
            let next = if one == before { other } else { one };
            if one == NONE || other == NONE || round.len() > self.at_vertex(vertex).len() {
                return None;
            }
            if next == first && round.len() > 1 {
                return (round.len() > 2).then_some(round);
            }
            round.push(next);
            (before, element) = (element, next);
        }
    }
}

impl Nodes for Surface {
    fn places(&self) -> &[Vector] {
        &self.centres
    }

    fn size(&self, element: usize) -> f64 {
        self.areas[element].sqrt()
    }

    fn foot(&self, from: Vector) -> Foot {
        let (patch, nearest) = nearest_of(&self.tree, from).expect("a checked grid has elements");
        let element = patch.nodes[0] as usize;
        let [a, b, c, d] = self.corners(element);
        let normal = (c - a).cross(&(d - b)).normalize();
        let offset = from - nearest.point;
        let tangential = (offset - offset.dot(&normal) * normal).norm();
        // The foot is on side k, from corner k to k + 1, if the other two corners have no weight.
        let mut weights = [0.0; 4];
        nearest.weights.iter().for_each(|(corner, weight)| weights[*corner] += weight);
        let on_side = |k: usize| weights[(k + 2) % 4] + weights[(k + 3) % 4] < 1e-9;
        let border = (0..4).any(|k| on_side(k) && self.neighbours[element][k] == NONE);
        let outside = if border { tangential } else { 0.0 };
        Foot { node: element, point: nearest.point, outside }
    }

    fn seeds(&self, foot: &Foot, stencil: &mut Vec<u32>) {
        stencil.extend(self.at(foot));
    }

    /// Adds the elements that share a vertex with this one.
    fn ring(&self, element: u32, ring: &mut Vec<u32>) {
        let vertices = self.shape.elements[element as usize];
        vertices.into_iter().for_each(|vertex| ring.extend(self.at_vertex(vertex)));
    }

    fn span(&self) -> Span {
        Span { directions: 2, flat: FLAT, bounded: false }
    }

    /// Returns the patches of the dual mesh.
    fn patches(&self) -> Option<Vec<Patch>> {
        let patch = |nodes: Vec<u32>| {
            let corners = nodes.iter().map(|node| self.centres[*node as usize]).collect();
            Patch::new(corners, nodes.into())
        };
        let mut inside = vec![false; self.starts.len() - 1];
        let mut patches = Vec::new();
        for (vertex, inside) in inside.iter_mut().enumerate() {
            let round = self.round(vertex as u32);
            *inside = round.is_some();
            patches.extend(round.map(patch));
        }
        for (element, neighbours) in self.neighbours.iter().enumerate() {
            let vertices = self.shape.elements[element];
            if neighbours.iter().all(|neighbour| *neighbour == NONE) {
                patches.push(patch(vec![element as u32]));
            }
            for (side, &other) in neighbours.iter().enumerate() {
                let ends = [vertices[side], vertices[(side + 1) % 4]];
                let bare = ends.iter().all(|vertex| !inside[*vertex as usize]);
                if other != NONE && (element as u32) < other && bare {
                    patches.push(patch(vec![element as u32, other]));
                }
            }
        }
        Some(patches)
    }
}

/// Finds the element across each side.
fn neighbours(elements: &[[u32; 4]]) -> Vec<[u32; 4]> {
    let mut sides: Vec<([u32; 2], u32, u8)> = Vec::with_capacity(4 * elements.len());
    for (element, vertices) in elements.iter().enumerate() {
        for side in 0..4_u8 {
            let (a, b) = (vertices[side as usize], vertices[(side as usize + 1) % 4]);
            sides.push(([a.min(b), a.max(b)], element as u32, side));
        }
    }
    sides.sort_unstable();
    let mut neighbours = vec![[NONE; 4]; elements.len()];
    for shared in sides.chunk_by(|a, b| a.0 == b.0) {
        if let [(_, one, side), (_, other, other_side)] = *shared {
            neighbours[one as usize][side as usize] = other;
            neighbours[other as usize][other_side as usize] = one;
        }
    }
    neighbours
}

fn elements_at_vertices(shape: &Quadrilaterals) -> (Vec<usize>, Vec<u32>) {
    let mut starts = vec![0; shape.points.len() + 1];
    for vertex in shape.elements.as_flattened() {
        starts[*vertex as usize + 1] += 1;
    }
    for vertex in 0..shape.points.len() {
        starts[vertex + 1] += starts[vertex];
    }
    let mut next = starts.clone();
    let mut at_vertex = vec![0; 4 * shape.elements.len()];
    for (element, vertices) in shape.elements.iter().enumerate() {
        for vertex in vertices {
            at_vertex[next[*vertex as usize]] = element as u32;
            next[*vertex as usize] += 1;
        }
    }
    (starts, at_vertex)
}
