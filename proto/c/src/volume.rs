//! Volumes, as announced by C.

use crate::fault::Fault;
use crate::grid::name_of;
use proto::grid::{Grid, Hexahedra};
use std::ffi::{c_char, c_int};

/// Kind of a volume: ni x nj x nk boxes between the nodes of three axes.
pub const COSIM_RECTILINEAR: c_int = 3;
/// Kind of a volume: ni x nj x nk hexahedra with vertices at any position.
pub const COSIM_STRUCTURED_HEXAHEDRA: c_int = 4;
/// Kind of a volume: hexahedra over shared vertices.
pub const COSIM_UNSTRUCTURED_HEXAHEDRA: c_int = 5;

/// A volume: hexahedra for output fields only. Element (i, j, k) has index (k nj + j) ni + i.
///
/// The geometry goes into the buffer of cosim_geometry(): vectors of three components [m],
/// component-major (all first components, then all second, then all third). Rectilinear: the n-th
/// nodes of the axes x, y and z, as many as the longest axis has; 0 beyond the end of a shorter
/// axis. Structured: the (ni + 1) (nj + 1) (nk + 1) vertices, i fastest, then j. Unstructured: the
/// vertices, followed for each element by its corners a to h, vertex numbers from 0, as (a, b, c),
/// (d, e, f) and (g, h, 0). Corners are in VTK's order, with a positive volume.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CosimVolume {
    /// Name, unique among the program's grids: letters, digits, `_` and `-`.
    pub name: [c_char; 32],
    /// COSIM_RECTILINEAR, COSIM_STRUCTURED_HEXAHEDRA or COSIM_UNSTRUCTURED_HEXAHEDRA.
    pub kind: c_int,
    /// Number of elements in i; unused for unstructured hexahedra, like nj and nk.
    pub ni: usize,
    /// Number of elements in j.
    pub nj: usize,
    /// Number of elements in k.
    pub nk: usize,
    /// Unstructured: number of vertices.
    pub vertices: usize,
    /// Unstructured: number of elements.
    pub elements: usize,
}

impl CosimVolume {
    /// Returns the announced grid, checked.
    pub(crate) fn announced(&self) -> Result<Grid, Fault> {
        let Self { ni, nj, nk, vertices, elements, .. } = *self;
        let hexahedra = match self.kind {
            COSIM_RECTILINEAR => Hexahedra::Rectilinear { ni, nj, nk },
            COSIM_STRUCTURED_HEXAHEDRA => Hexahedra::Structured { ni, nj, nk },
            COSIM_UNSTRUCTURED_HEXAHEDRA => Hexahedra::Unstructured { vertices, elements },
            kind => return Err(Fault::Misused(format!("the volume has the kind {kind}"))),
        };
        let grid = Grid::volume(&name_of(&self.name), hexahedra);
        grid.check().map_err(Fault::Misused)?;
        Ok(grid)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn volume(kind: c_int) -> CosimVolume {
        let mut name = [0; 32];
        name[0] = b'v' as c_char;
        CosimVolume { name, kind, ni: 3, nj: 2, nk: 1, vertices: 9, elements: 1 }
    }

    #[test]
    fn every_kind_is_announced_with_its_counts() {
        for (kind, hexahedra) in [
            (COSIM_RECTILINEAR, Hexahedra::Rectilinear { ni: 3, nj: 2, nk: 1 }),
            (COSIM_STRUCTURED_HEXAHEDRA, Hexahedra::Structured { ni: 3, nj: 2, nk: 1 }),
            (COSIM_UNSTRUCTURED_HEXAHEDRA, Hexahedra::Unstructured { vertices: 9, elements: 1 }),
        ] {
            assert_eq!(volume(kind).announced(), Ok(Grid::volume("v", hexahedra)));
        }
    }

    #[test]
    fn what_cannot_be_is_reported() {
        let good = volume(COSIM_RECTILINEAR);
        for (volume, why) in [
            (CosimVolume { kind: 0, ..good }, "the kind 0"),
            (CosimVolume { ni: 0, ..good }, "it has 0 elements"),
            (CosimVolume { name: [0; 32], ..good }, "grid name"),
            (CosimVolume { vertices: 7, ..volume(COSIM_UNSTRUCTURED_HEXAHEDRA) }, "7 vertices"),
        ] {
            let fault = volume.announced().unwrap_err().to_string();
            assert!(fault.contains(why), "{fault}");
        }
    }
}
