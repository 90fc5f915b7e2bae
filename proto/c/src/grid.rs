//! Grids, as seen from C.

use crate::fault::Fault;
use proto::grid::{Grid, Quadrilaterals, Shape, Structured};
use std::ffi::{c_char, c_int};

/// Kind of a grid: a plane patch of ni x nj equal elements.
pub const COSIM_STRUCTURED: c_int = 1;
/// Kind of a grid: a surface of quadrilaterals.
pub const COSIM_QUADRILATERALS: c_int = 2;
/// Kind of a grid: vertices that carry values. Such a grid is only received.
pub const COSIM_VERTICES: c_int = 3;

/// A surface grid. Values belong to element centres or, on vertices, to the vertices.
///
/// Structured: the centre of element (i, j) is origin + i step_i + j step_j, and its value stands
/// at j ni + i. In the contact plane, step_i points along x, the rolling direction, and step_j
/// along y, to the left. Quadrilaterals: element n has the corners elements[4n] to elements[4n+3],
/// in order around the element; vertex v stands at vertices[3v] to vertices[3v+2]. Vertices: vertex
/// v stands there too, and its value at v.
///
/// In a grid obtained from the library, the library owns the pointers; they are valid until the
/// callback returns. Members of the other kind are 0.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CosimGrid {
    /// Name, unique within the program that owns the grid: letters, digits, `_` and `-`.
    pub name: [c_char; 32],
    /// Increases by one whenever the geometry changes; starts at 1, and 0 is read as 1.
    pub revision: u64,
    /// COSIM_STRUCTURED, COSIM_QUADRILATERALS or COSIM_VERTICES.
    pub kind: c_int,
    /// Number of elements or vertices with values; unused for a structured grid passed to the
    /// library.
    pub points: usize,
    /// Structured: centre of element (0, 0) [m].
    pub origin: [f64; 3],
    /// Structured: vector from one element to the next in i [m].
    pub step_i: [f64; 3],
    /// Structured: vector from one element to the next in j [m].
    pub step_j: [f64; 3],
    /// Structured: number of elements in i.
    pub ni: usize,
    /// Structured: number of elements in j.
    pub nj: usize,
    /// Quadrilaterals and vertices: number of vertices.
    pub vertex_count: usize,
    /// Quadrilaterals and vertices: three coordinates of each vertex [m].
    pub vertices: *const f64,
    /// Quadrilaterals: four vertices of each element, numbered from 0.
    pub elements: *const u32,
}

/// Returns the name in a C array, up to its first zero.
pub(crate) fn name_of(text: &[c_char; 32]) -> String {
    let bytes: Vec<u8> = text.iter().take_while(|c| **c != 0).map(|c| *c as u8).collect();
    String::from_utf8_lossy(&bytes).into_owned()
}

impl CosimGrid {
    /// Returns a view of a grid.
    pub(crate) fn of(grid: &Grid) -> Self {
        let mut name = [0; 32];
        // The last byte stays 0, because `Grid::check` has limited the length of every name.
        for (to, from) in name[..31].iter_mut().zip(grid.name.bytes()) {
            *to = from as c_char;
        }
        let mut view = Self {
            name,
            revision: grid.revision,
            kind: COSIM_STRUCTURED,
            points: grid.points(),
            origin: [0.0; 3],
            step_i: [0.0; 3],
            step_j: [0.0; 3],
            ni: 0,
            nj: 0,
            vertex_count: 0,
            vertices: std::ptr::null(),
            elements: std::ptr::null(),
        };
        match &grid.shape {
            Shape::Structured(s) => {
                (view.origin, view.step_i, view.step_j) = (s.origin, s.step_i, s.step_j);
                (view.ni, view.nj) = (s.ni, s.nj);
            }
            Shape::Quadrilaterals(q) => {
                view.kind = COSIM_QUADRILATERALS;
                view.vertex_count = q.points.len();
                view.vertices = q.points.as_flattened().as_ptr();
                view.elements = q.elements.as_flattened().as_ptr();
            }
            Shape::Vertices(v) => {
                view.kind = COSIM_VERTICES;
                view.vertex_count = v.points.len();
                view.vertices = v.points.as_flattened().as_ptr();
            }
            // Unreachable: an input is never on a volume or at points. Kind 0 is invalid.
            Shape::Volume(_) | Shape::Points(_) => view.kind = 0,
        }
        view
    }

    /// Returns a checked copy for Rust.
    ///
    /// # Safety
    /// The pointers of quadrilaterals must hold as many numbers as the counts state.
    pub(crate) unsafe fn copied(&self) -> Result<Grid, Fault> {
        let shape = match self.kind {
            COSIM_STRUCTURED => Shape::Structured(Structured {
                origin: self.origin,
                step_i: self.step_i,
                step_j: self.step_j,
                ni: self.ni,
                nj: self.nj,
            }),
            // SAFETY: guaranteed by the caller.
            COSIM_QUADRILATERALS => Shape::Quadrilaterals(unsafe { self.surface() }?),
            COSIM_VERTICES => {
                return Err(Fault::Misused("grids of vertices are only received".to_owned()));
            }
            kind => return Err(Fault::Misused(format!("the grid has the kind {kind}"))),
        };
        let name = name_of(&self.name);
        let grid = Grid { name, revision: self.revision.max(1), shape };
        grid.check().map_err(Fault::Misused)?;
        Ok(grid)
    }

    unsafe fn surface(&self) -> Result<Quadrilaterals, Fault> {
        if self.vertices.is_null() || self.elements.is_null() {
            return Err(Fault::Misused("`vertices` or `elements` is NULL".to_owned()));
        }
        // SAFETY: not NULL; the caller guarantees the counts.
        let (points, elements) = unsafe {
            (
                std::slice::from_raw_parts(self.vertices.cast::<[f64; 3]>(), self.vertex_count),
                std::slice::from_raw_parts(self.elements.cast::<[u32; 4]>(), self.points),
            )
        };
        Ok(Quadrilaterals { points: points.to_vec(), elements: elements.to_vec() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proto::grid::{Measure, Vertices};

    fn structured() -> Grid {
        let shape = Structured::contact_plane(-0.1, 0.2, 0.3, 0.4, 5, 3);
        Grid::structured("contact_plane-of-31-letters_abc", shape)
    }

    #[test]
    fn there_and_back() {
        let Shape::Structured(shape) = structured().shape else { unreachable!() };
        let mut surface = Grid::quadrilaterals("rail", Quadrilaterals::from(&shape));
        surface.revision = 7;
        for grid in [structured(), surface] {
            let view = CosimGrid::of(&grid);
            assert_eq!((view.points, view.revision), (15, grid.revision));
            assert_eq!(unsafe { view.copied() }, Ok(grid));
        }
    }

    #[test]
    fn vertices_are_received() {
        let points = vec![[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]];
        let (edges, triangles, measure) = (vec![[0, 1]], Vec::new(), Measure::PerArea);
        let grid = Grid::vertices("mesh", Vertices { points, edges, triangles, measure });
        let view = CosimGrid::of(&grid);
        assert_eq!((view.kind, view.points, view.vertex_count), (COSIM_VERTICES, 2, 2));
        let coordinates = unsafe { std::slice::from_raw_parts(view.vertices, 6) };
        assert_eq!(coordinates, [1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
        assert!(view.elements.is_null());
    }

    #[test]
    fn what_cannot_be_is_reported() {
        let good = CosimGrid::of(&structured());
        let name = [b'x' as c_char; 32];
        let surface = CosimGrid { kind: COSIM_QUADRILATERALS, ..good };
        for (grid, why) in [
            (CosimGrid { kind: 0, ..good }, "the kind 0"),
            (CosimGrid { kind: COSIM_VERTICES, ..good }, "only received"),
            (CosimGrid { ni: 0, ..good }, "0 x 3 points"),
            (CosimGrid { name: [0; 32], ..good }, "grid name"),
            (CosimGrid { name, ..good }, "grid name"),
            (surface, "is NULL"),
        ] {
            let fault = unsafe { grid.copied() }.unwrap_err().to_string();
            assert!(fault.contains(why), "{fault}");
        }
        assert_eq!(unsafe { CosimGrid { revision: 0, ..good }.copied() }, Ok(structured()));
    }
}
