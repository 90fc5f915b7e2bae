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

    /// Adds quadrilaterals, given by four vertices each, as two triangles along the shorter
    /// diagonal.
    pub(super) fn add_quads(&mut self, ids: &[i32]) -> Result<(), CallError> {
        let points = &self.mesh.points;
        let distance_2 = |[a, b]: [u32; 2]| {
            let (a, b) = (points[a as usize], points[b as usize]);
            (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>()
        };
        let halves = |[a, b, c, d]: [u32; 4]| match distance_2([a, c]) <= distance_2([b, d]) {
            true => [[a, b, c], [a, c, d]],
            false => [[a, b, d], [b, c, d]],
        };
        let triangles: Vec<_> = self.groups(ids)?.into_iter().flat_map(halves).collect();
        self.mesh.triangles.extend(triangles);
        Ok(())
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
        assert_eq!(mesh.mesh.triangles, [[0, 1, 3], [1, 2, 3]]);
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
