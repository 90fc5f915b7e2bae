//! Unstructured surfaces of quadrilaterals.
//!
//! An element is the bilinear patch through its four corners. Its centre is the mean of the corners
//! (ξ = η = 0). Its area is ½|d₁ × d₂| with the diagonals d₁ and d₂: exact for coplanar corners,
//! otherwise the magnitude of the vector area. A structured grid and the same grid written as
//! quadrilaterals therefore have the same centres and areas within rounding.

use super::structured::Structured;
use super::vector::{cross, difference, displaced, length};
use serde::{Deserialize, Serialize};

/// Quadrilateral elements over shared vertices.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Quadrilaterals {
    /// Vertices [m].
    pub points: Vec<[f64; 3]>,
    /// The four vertices of each element, in order around the element.
    pub elements: Vec<[u32; 4]>,
}

impl Quadrilaterals {
    /// Returns the corners of an element [m], in order around the element.
    #[must_use]
    pub fn corners(&self, element: usize) -> [[f64; 3]; 4] {
        self.elements[element].map(|vertex| self.points[vertex as usize])
    }

    /// Returns the centre of an element, the mean of its corners [m].
    #[must_use]
    pub fn centre(&self, element: usize) -> [f64; 3] {
        let [a, b, c, d] = self.corners(element);
        std::array::from_fn(|k| 0.25 * ((a[k] + c[k]) + (b[k] + d[k])))
    }

    /// Returns the area of an element [m²].
    #[must_use]
    pub fn area(&self, element: usize) -> f64 {
        length(vector_area(&self.corners(element)))
    }

    /// Returns the surface with every vertex moved by `displacement` [m]: all x, then all y, then
    /// all z.
    ///
    /// # Errors
    /// Fails if the length is not three values per vertex, or if a moved element is not convex.
    pub fn displaced(&self, displacement: &[f64]) -> Result<Self, String> {
        let points = displaced(&self.points, displacement)?;
        let moved = Self { points, elements: self.elements.clone() };
        moved.check().map(|()| moved)
    }

    /// Checks a surface received from another process.
    ///
    /// # Errors
    /// Fails without elements, for a vertex that is not finite or does not exist, and for an
    /// element that is not convex.
    pub(super) fn check(&self) -> Result<(), String> {
        if self.elements.is_empty() {
            return Err("it has no elements".to_owned());
        }
        if let Some(n) = self.points.iter().position(|p| p.iter().any(|v| !v.is_finite())) {
            return Err(format!("vertex {n} is not finite"));
        }
        let count = self.points.len();
        for (n, element) in self.elements.iter().enumerate() {
            if let Some(vertex) = element.iter().find(|vertex| **vertex as usize >= count) {
                return Err(format!("element {n} names vertex {vertex} of {count}"));
            }
            if !convex(&self.corners(n)) {
                return Err(format!("element {n} is not a convex quadrilateral with an area"));
            }
        }
        Ok(())
    }
}

impl From<&Structured> for Quadrilaterals {
    /// Keeps the elements and their order; vertex (i, j) stands at `j * (ni + 1) + i`.
    fn from(grid: &Structured) -> Self {
        let (ni, nj) = (grid.ni, grid.nj);
        let vertex = |i: usize, j: usize| -> [f64; 3] {
            let (i, j) = (i as f64 - 0.5, j as f64 - 0.5);
            std::array::from_fn(|k| grid.origin[k] + i * grid.step_i[k] + j * grid.step_j[k])
        };
        let index = |i: usize, j: usize| {
            u32::try_from(j * (ni + 1) + i).expect("fewer vertices than 32 bits can count")
        };
        let element = |i, j| [index(i, j), index(i + 1, j), index(i + 1, j + 1), index(i, j + 1)];
        Self {
            points: (0..=nj).flat_map(|j| (0..=ni).map(move |i| vertex(i, j))).collect(),
            elements: (0..nj).flat_map(|j| (0..ni).map(move |i| element(i, j))).collect(),
        }
    }
}

/// Returns true if all four corners turn the same way, seen along the element's normal.
fn convex(corners: &[[f64; 3]; 4]) -> bool {
    let normal = vector_area(corners);
    (0..4).all(|n| {
        let [a, b, c] = [n, n + 1, n + 2].map(|k| corners[k % 4]);
        let turn = cross(difference(b, a), difference(c, b));
        turn.iter().zip(&normal).map(|(t, n)| t * n).sum::<f64>() > 0.0
    })
}

fn vector_area(corners: &[[f64; 3]; 4]) -> [f64; 3] {
    let [a, b, c, d] = *corners;
    cross(difference(c, a), difference(d, b)).map(|component| 0.5 * component)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Grid, Shape};

    fn wavy() -> Quadrilaterals {
        let mut surface =
            Quadrilaterals::from(&Structured::contact_plane(-1.0, 0.5, 0.25, 0.5, 4, 3));
        surface.points[6] = [-0.6, 0.8, 0.1];
        surface
    }

    #[test]
    fn a_structured_grid_keeps_its_centres_areas_and_integral() {
        let shape = Structured {
            origin: [1.0, 0.5, -0.2],
            step_i: [0.1, 0.02, 0.0],
            step_j: [0.03, 0.0, -0.2],
            ni: 5,
            nj: 3,
        };
        let structured = Grid::structured("g", shape);
        let surface = Grid::quadrilaterals("g", Quadrilaterals::from(&shape));
        assert_eq!(surface.points(), 15);
        for n in 0..15 {
            let (a, b) = (structured.centre(n), surface.centre(n));
            assert!((0..3).all(|k| (a[k] - b[k]).abs() < 1e-15), "rounding: {a:?} {b:?}");
            assert!((structured.area(n) / surface.area(n) - 1.0).abs() < 1e-14, "rounding");
        }
        let values: Vec<f64> = (0..15).map(f64::from).collect();
        let (a, b) = (structured.integrate(&values), surface.integrate(&values));
        assert!((a / b - 1.0).abs() < 1e-14, "rounding: {a} {b}");
    }

    #[test]
    fn area_of_a_trapezoid() {
        let points = vec![[0.0; 3], [4.0, 0.0, 0.0], [3.0, 2.0, 0.0], [1.0, 2.0, 0.0]];
        let trapezoid = Quadrilaterals { points, elements: vec![[0, 1, 2, 3]] };
        assert_eq!(trapezoid.area(0), 6.0);
        assert_eq!(trapezoid.centre(0), [2.0, 1.0, 0.0]);
    }

    #[test]
    fn json_round_trip_keeps_every_bit() {
        let grid = Grid::quadrilaterals("rail", wavy());
        let text = serde_json::to_string(&grid).unwrap();
        assert!(text.contains("\"kind\":\"quadrilaterals\""), "{text}");
        assert_eq!(serde_json::from_str::<Grid>(&text).unwrap(), grid);
    }

    #[test]
    fn a_displacement_moves_vertices_and_raises_the_revision() {
        let grid = Grid::quadrilaterals("rail", wavy());
        let count = wavy().points.len();
        let mut displacement = vec![0.0; 3 * count];
        displacement[..count].fill(0.25);
        displacement[2 * count..].fill(-1.0);
        let moved = grid.displaced(&displacement).unwrap();
        assert_eq!(moved.revision, 2);
        for n in 0..grid.points() {
            let (a, b) = (grid.centre(n), moved.centre(n));
            let moved_by: [f64; 3] = std::array::from_fn(|k| b[k] - a[k]);
            let error = length(difference(moved_by, [0.25, 0.0, -1.0]));
            assert!(error < 1e-15, "rounding: {moved_by:?}");
        }
        assert!(grid.displaced(&displacement[1..]).is_err());
        displacement[0] = 100.0;
        assert!(grid.displaced(&displacement).is_err(), "an element is turned inside out");
    }

    #[test]
    fn a_moved_structured_grid_becomes_unstructured() {
        let grid = Grid::structured("g", Structured::contact_plane(0.0, 0.0, 1.0, 1.0, 2, 1));
        let moved = grid.displaced(&[0.0; 18]).unwrap();
        assert!(matches!(&moved.shape, Shape::Quadrilaterals(q) if q.elements.len() == 2));
        assert_eq!(moved.centre(1), [1.0, 0.0, 0.0]);
    }

    #[test]
    fn surfaces_from_outside_are_checked() {
        let check = |change: &dyn Fn(&mut Quadrilaterals)| {
            let mut surface = wavy();
            change(&mut surface);
            Grid::quadrilaterals("rail", surface).check()
        };
        assert_eq!(check(&|_| ()), Ok(()));
        let wrong = [
            check(&|s| s.elements.clear()),
            check(&|s| s.elements[3][2] = 20),
            check(&|s| s.points[5][1] = f64::NAN),
            check(&|s| s.elements[0] = [0, 1, 1, 0]),
            check(&|s| s.elements[0].swap(0, 1)),
            check(&|s| s.points[6] = [-10.0, 0.0, 0.0]),
        ];
        assert!(wrong.iter().all(Result::is_err), "{wrong:?}");
    }
}
