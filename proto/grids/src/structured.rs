//! Plane patches of equal elements.

use super::vector::{cross, length};
use serde::{Deserialize, Serialize};

/// Plane patch of `ni` × `nj` equal elements.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Structured {
    /// Centre of element (0, 0) [m].
    pub origin: [f64; 3],
    /// Vector from one element to the next in i [m].
    pub step_i: [f64; 3],
    /// Vector from one element to the next in j [m].
    pub step_j: [f64; 3],
    /// Number of elements in i.
    pub ni: usize,
    /// Number of elements in j.
    pub nj: usize,
}

impl Structured {
    /// Returns a grid in the contact plane z = 0 with its first element centred on (x0, y0) [m].
    #[must_use]
    pub fn contact_plane(x0: f64, y0: f64, dx: f64, dy: f64, nx: usize, ny: usize) -> Self {
        Self {
            origin: [x0, y0, 0.0],
            step_i: [dx, 0.0, 0.0],
            step_j: [0.0, dy, 0.0],
            ni: nx,
            nj: ny,
        }
    }

    /// Returns the number of elements; [`usize::MAX`] on overflow.
    #[must_use]
    pub fn points(&self) -> usize {
        self.ni.saturating_mul(self.nj)
    }

    /// Returns the centre of element (i, j) [m].
    #[must_use]
    pub fn centre(&self, i: usize, j: usize) -> [f64; 3] {
        let (i, j) = (i as f64, j as f64);
        std::array::from_fn(|k| self.origin[k] + i * self.step_i[k] + j * self.step_j[k])
    }

    /// Returns x of column i [m].
    #[must_use]
    pub fn x(&self, i: usize) -> f64 {
        self.centre(i, 0)[0]
    }

    /// Returns y of row j [m].
    #[must_use]
    pub fn y(&self, j: usize) -> f64 {
        self.centre(0, j)[1]
    }

    /// Returns the element length along x of a contact-plane grid [m].
    #[must_use]
    pub fn dx(&self) -> f64 {
        self.step_i[0]
    }

    /// Returns the element length along y of a contact-plane grid [m].
    #[must_use]
    pub fn dy(&self) -> f64 {
        self.step_j[1]
    }

    /// Returns the area of one element [m²].
    #[must_use]
    pub fn element_area(&self) -> f64 {
        length(cross(self.step_i, self.step_j))
    }
}
