//! A contact that slides everywhere, for runs without terms of adhesion.
//!
//! The traction is f p_n, with Hertz's pressure, against the rigid slip (ξ − φ y, η + φ x); the
//! springs have no influence. On a strip the mean of the bound over a cell is exact. Its sum over
//! the strips of a lattice is made exact by a factor 1 + O(n⁻⁴), so that pure sliding carries f N.
//! The friction power is −(ξ F_x + η F_y + φ M_z) to rounding, with the slip and its moment at the
//! middle of each cell. Local friction bounds are evaluated there too.

use elastic::fastsim::bound::Bound;
use elastic::fastsim::flexibility::Creepage;
use elastic::fastsim::integration::{Cell, Lattice, Strip, norm};
use elastic::strips::semi_ellipse::segment_area;

/// A contact that slides everywhere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Sliding {
    lattice: Lattice,
    creepage: Creepage,
    /// Traction bound at the centre, including the factor that makes the sum exact [Pa].
    amplitude: f64,
}

impl Sliding {
    /// Creates a sliding contact with the friction bound f N [N].
    pub(super) fn new(lattice: Lattice, creepage: Creepage, friction_bound: f64) -> Self {
        let amplitude = friction_bound / lattice.half_ellipsoid();
        // Cells have equal length.
        let lattice = Lattice { bound: Bound::Parabolic, ..lattice };
        Self { lattice, creepage, amplitude }
    }

    /// Visits the cells of a strip from the leading to the trailing edge, under the bounds of
    /// [`elastic::fastsim::integration::StripIntegration::strip`].
    pub(super) fn strip(
        &self,
        strip: &Strip,
        limit: impl Fn(f64, f64) -> f64,
        mut visit: impl FnMut(&Cell),
    ) {
        let cells = self.lattice.cells;
        // ∫ √(1 − X²) dX from the node to the leading edge.
        let ahead = |index: usize| segment_area(2.0 * index as f64 / cells as f64);
        let scale = 0.5 * self.amplitude * strip.eta * cells as f64;
        let [xi, eta, phi] = self.creepage;
        for index in 0..cells {
            let ends = [self.lattice.node(strip, index + 1), self.lattice.node(strip, index)];
            let mut cell = Cell { ends, ..Cell::default() };
            let bound = limit(cell.middle(), scale * (ahead(index + 1) - ahead(index)));
            cell.slip = [xi - phi * strip.y, eta + phi * cell.middle()];
            let size = norm(cell.slip);
            if size > 0.0 {
                cell.traction = cell.slip.map(|component| -bound * (component / size));
                cell.slips = true;
                cell.largest_traction = bound;
            }
            visit(&cell);
        }
    }
}
