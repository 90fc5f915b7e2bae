//! Meshes that the program sets, before they are sent to the launcher.

use super::error::CallError;
use crate::protocol::{Mesh, MeshInfo};

/// Maximum number of vertices of a mesh; their numbers are C integers.
const MOST: usize = i32::MAX as usize;

/// A mesh in preparation.
#[derive(Debug)]
pub(super) struct OwnMesh {
    pub(super) info: MeshInfo,
    pub(super) mesh: Mesh,
}

impl OwnMesh {
    pub(super) fn new(info: MeshInfo) -> Self {
        Self { info, mesh: Mesh::default() }
    }

    /// Number of vertices.
    pub(super) fn size(&self) -> usize {
        self.mesh.points.len()
    }

    /// Adds vertices; returns the number of the first.
    pub(super) fn add_vertices(&mut self, coordinates: &[f64]) -> Result<usize, CallError> {
        let dimensions = self.info.dimensions;
        if let Some(index) = coordinates.iter().position(|value| !value.is_finite()) {
            let value = coordinates[index];
            return Err(CallError::NotFinite { what: "coordinate", index, value });
        }
        let (first, count) = (self.size(), coordinates.len() / dimensions);
        if count > MOST - first {
            return Err(CallError::Count {
                what: "vertices",
                found: first + count,
                expected: MOST,
            });
        }
        self.mesh.points.extend(coordinates.chunks_exact(dimensions).map(|vertex| {
            let mut point = [0.0; 3];
            point[..dimensions].copy_from_slice(vertex);
            point
        }));
        Ok(first)
    }

    /// Adds edges, given by two vertices each.
    pub(super) fn add_edges(&mut self, ids: &[i32]) -> Result<(), CallError> {
        let edges = self.groups(ids)?;
        self.mesh.edges.extend(edges);
        Ok(())
    }

    /// Adds triangles, given by three vertices each.
    pub(super) fn add_triangles(&mut self, ids: &[i32]) -> Result<(), CallError> {
        let triangles = self.groups(ids)?;
        self.mesh.triangles.extend(triangles);
        Ok(())
    }

    /// Adds quadrilaterals, given by four vertices each in any order, as two triangles along the
    /// shorter diagonal.
    pub(super) fn add_quads(&mut self, ids: &[i32]) -> Result<(), CallError> {
        let halves = |quad| self.halves(quad);
        let triangles: Vec<[[u32; 3]; 2]> =
            self.groups(ids)?.into_iter().map(halves).collect::<Result<_, _>>()?;
        self.mesh.triangles.extend(triangles.as_flattened());
        Ok(())
    }

    /// Cuts a quadrilateral along the shorter diagonal. The diagonals of a convex quadrilateral are
    /// together longer than each pair of opposite sides.
    fn halves(&self, [a, b, c, d]: [u32; 4]) -> Result<[[u32; 3]; 2], CallError> {
        let at = |vertex: u32| self.mesh.points[vertex as usize];
        let edge = |[p, q]: [u32; 2]| difference(at(q), at(p));
        let length = |pair| dot(edge(pair), edge(pair)).sqrt();
        let pairs = [[[a, c], [b, d]], [[a, b], [c, d]], [[a, d], [b, c]]];
        let lengths = pairs.map(|[one, other]| length(one) + length(other));
        let longest = (1..3).fold(0, |best, k| if lengths[k] > lengths[best] { k } else { best });
        let [one, other] = pairs[longest];
        let crosses = |[p, q]: [u32; 2], [r, s]: [u32; 2]| {
            let sides = [r, s].map(|end| cross(edge([p, q]), edge([p, end])));
            dot(sides[0], sides[1]) <= 0.0
        };
        if !(crosses(one, other) && crosses(other, one)) {
            let mesh = self.info.name.clone();
            return Err(CallError::NotConvex { mesh, vertices: [a, b, c, d] });
        }
        let [[p, q], [r, s]] =
            if length(one) <= length(other) { [one, other] } else { [other, one] };
        Ok([[p, q, r], [p, q, s]])
    }

    /// Checks tetrahedra, which no mapping of surfaces uses.
    pub(super) fn check_tetrahedra(&self, ids: &[i32]) -> Result<(), CallError> {
        self.groups::<4>(ids).map(|_| ())
    }

    fn groups<const N: usize>(&self, ids: &[i32]) -> Result<Vec<[u32; N]>, CallError> {
        let checked: Vec<u32> =
            ids.iter().map(|&id| self.vertex(id).map(|at| at as u32)).collect::<Result<_, _>>()?;
        let groups = checked.chunks_exact(N);
        Ok(groups.map(|group| std::array::from_fn(|k| group[k])).collect())
    }

    /// Returns the index of a vertex.
    pub(super) fn vertex(&self, id: i32) -> Result<usize, CallError> {
        let count = self.size();
        usize::try_from(id)
            .ok()
            .filter(|&index| index < count)
            .ok_or_else(|| CallError::UnknownVertex { mesh: self.info.name.clone(), id, count })
    }
}

fn difference(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|k| a[k] - b[k])
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|k| a[k] * b[k]).sum()
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square() -> OwnMesh {
        let mut mesh =
            OwnMesh::new(MeshInfo { name: "Wall".to_owned(), dimensions: 2, connected: true });
        assert_eq!(mesh.add_vertices(&[0.0, 0.0, 2.0, 0.0, 3.0, 1.0, 0.0, 1.0]).unwrap(), 0);
        mesh
    }

    #[test]
    fn plane_vertices_have_no_height() {
        let mut mesh = square();
        assert_eq!(mesh.mesh.points[2], [3.0, 1.0, 0.0]);
        assert_eq!(mesh.add_vertices(&[5.0, 5.0]).unwrap(), 4);
        assert!(mesh.add_vertices(&[f64::NAN, 0.0]).is_err());
    }

    #[test]
    fn a_quadrilateral_is_cut_along_its_shorter_diagonal() {
        let mut mesh = square();
        mesh.add_quads(&[0, 1, 2, 3]).unwrap();
        assert_eq!(mesh.mesh.triangles, [[1, 3, 0], [1, 3, 2]]);
    }

    /// Whatever the order of the vertices, the triangles cover the quadrilateral: its area is that
    /// of its coordinates, 2.5, and both triangles share the shorter diagonal.
    #[test]
    fn the_order_of_the_vertices_of_a_quadrilateral_does_not_matter() {
        let mut orders = Vec::new();
        for n in 0..256_i32 {
            let order = [n & 3, (n >> 2) & 3, (n >> 4) & 3, n >> 6];
            let all = (0..4).all(|vertex| order.contains(&vertex));
            orders.extend(all.then_some(order));
        }
        assert_eq!(orders.len(), 24);
        for order in orders {
            let mut mesh = square();
            mesh.add_quads(&order).unwrap();
            let Mesh { points, triangles, .. } = &mesh.mesh;
            let area = |[a, b, c]: &[u32; 3]| {
                let at = |vertex: &u32| points[*vertex as usize];
                let normal = cross(difference(at(b), at(a)), difference(at(c), at(a)));
                dot(normal, normal).sqrt() / 2.0
            };
            assert_eq!(triangles.iter().map(area).sum::<f64>(), 2.5, "{order:?}: {triangles:?}");
            assert!(triangles.iter().all(|one| one.contains(&1) && one.contains(&3)), "{order:?}");
        }
    }

    #[test]
    fn a_quadrilateral_that_is_not_convex_is_refused() {
        let mut mesh = square();
        mesh.add_vertices(&[1.0, 0.3]).unwrap();
        let error = mesh.add_quads(&[0, 1, 3, 4]).unwrap_err().to_string();
        assert!(error.contains("vertices 0, 1, 3, 4 of mesh `Wall`"), "{error}");
    }

    #[test]
    fn a_vertex_that_does_not_exist_is_named() {
        let mut mesh = square();
        let error = mesh.add_edges(&[0, 4]).unwrap_err().to_string();
        assert!(
            error.contains("vertex 4 of mesh `Wall`") && error.contains("4 vertices"),
            "{error}"
        );
        assert!(mesh.add_triangles(&[0, 1, -1]).is_err());
        assert!(mesh.mesh.edges.is_empty() && mesh.mesh.triangles.is_empty());
    }
}
