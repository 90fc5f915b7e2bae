//! Vertices with values of their own, and optionally edges and triangles between them.
//!
//! The value of a field belongs to its point. A plane mesh has z = 0. Whether a point has an area,
//! and which, depends on [`Measure`]: an integral over the grid is Σ_i A_i u_i. Nodal areas share
//! every triangle equally among its three corners, and every edge, of unit thickness, among its two
//! ends. They integrate a field that is linear on each triangle or edge exactly.

use super::sum::{blocked_sum, pairwise_sum};
use super::vector::{cross, difference, displaced, length};
use serde::{Deserialize, Serialize};

/// Maximum number of points, edges and triangles each.
const MOST: usize = 1 << 31;

/// Points that carry values, with optional connectivity.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Vertices {
    /// Coordinates of the points \[m\].
    pub points: Vec<[f64; 3]>,
    /// The two ends of each edge; may be empty.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub edges: Vec<[u32; 2]>,
    /// The three corners of each triangle; may be empty.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub triangles: Vec<[u32; 3]>,
    /// Meaning of a conservative field's values.
    pub measure: Measure,
}

/// Meaning of the values of a conservative field at vertices.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Measure {
    /// A value is the total of its point, such as a nodal force or power. The area of every point
    /// is 1, so that the integral is the sum.
    PerPoint,
    /// A value is a density. The area of a point is a third of its triangles or, in a grid without
    /// triangles, half of its edges in unit thickness.
    PerArea,
    /// A value is a density at points of unknown area. The area of every point is 0: the field has
    /// no integral that could be kept.
    Unknown,
}

impl Vertices {
    /// Returns the area of the point whose value stands at `index` \[m²\], or 1 or 0 according to
    /// the measure. Visits all triangles or edges; [`Vertices::areas`] returns all areas at once.
    #[must_use]
    pub fn area(&self, index: usize) -> f64 {
        let at = |corners: &[u32]| corners.iter().any(|corner| *corner as usize == index);
        match self.measure {
            Measure::PerPoint => 1.0,
            Measure::Unknown => 0.0,
            Measure::PerArea => {
                let elements = (0..self.elements()).filter(|element| at(self.corners(*element)));
                elements.map(|element| self.share(element)).sum()
            }
        }
    }

    /// Returns the areas of all points, see [`Vertices::area`].
    #[must_use]
    pub fn areas(&self) -> Vec<f64> {
        let alike = |area| vec![area; self.points.len()];
        match self.measure {
            Measure::PerPoint => alike(1.0),
            Measure::Unknown => alike(0.0),
            Measure::PerArea => {
                let mut areas = alike(0.0);
                for element in 0..self.elements() {
                    let share = self.share(element);
                    self.corners(element).iter().for_each(|n| areas[*n as usize] += share);
                }
                areas
            }
        }
    }

    /// Returns whether the grid has edges or triangles.
    #[must_use]
    pub fn is_connected(&self) -> bool {
        !self.edges.is_empty() || !self.triangles.is_empty()
    }

    /// Returns Σ_i A_i u_i of one-component values u.
    pub(super) fn integrate(&self, values: &[f64]) -> f64 {
        match self.measure {
            Measure::PerPoint => blocked_sum(values),
            Measure::Unknown => 0.0,
            Measure::PerArea => pairwise_sum(0..self.elements(), &|element| {
                let corners = self.corners(element).iter().map(|corner| values[*corner as usize]);
                self.share(element) * corners.sum::<f64>()
            }),
        }
    }

    /// Returns the grid with every point moved by `displacement` \[m\]: all x, then all y, then all
    /// z.
    ///
    /// # Errors
    /// Fails if the length is not three values per point, or if the moved grid is invalid.
    pub fn displaced(&self, displacement: &[f64]) -> Result<Self, String> {
        let moved = self.with_points(displaced(&self.points, displacement)?);
        moved.check().map(|()| moved)
    }

    /// Returns the grid with other points and the same connectivity.
    pub(super) fn with_points(&self, points: Vec<[f64; 3]>) -> Self {
        let (edges, triangles) = (self.edges.clone(), self.triangles.clone());
        Self { points, edges, triangles, measure: self.measure }
    }

    /// Returns true if both grids have the same connectivity and measure.
    pub(super) fn has_elements_of(&self, other: &Self) -> bool {
        self.points.len() == other.points.len()
            && self.edges == other.edges
            && self.triangles == other.triangles
            && self.measure == other.measure
    }

    /// Checks vertices received from another process.
    ///
    /// # Errors
    /// Fails without points, with too many of them, and for a point that is not finite. Fails for
    /// an edge or a triangle that names a point that does not exist, or that has no length or area.
    /// Fails if a measure per area leaves a point without one.
    pub(super) fn check(&self) -> Result<(), String> {
        let counts = [self.points.len(), self.edges.len(), self.triangles.len()];
        if counts[0] == 0 || counts.iter().any(|count| *count > MOST) {
            let [points, edges, triangles] = counts;
            return Err(format!("it has {points} points, {edges} edges and {triangles} triangles"));
        }
        if let Some(n) = self.points.iter().position(|p| p.iter().any(|v| !v.is_finite())) {
            return Err(format!("point {n} is not finite"));
        }
        let edges = self.edges.iter().map(<[u32; 2]>::as_slice).enumerate();
        let triangles = self.triangles.iter().map(<[u32; 3]>::as_slice).enumerate();
        edges.into_iter().try_for_each(|(n, corners)| self.check_element("edge", n, corners))?;
        triangles.into_iter().try_for_each(|(n, c)| self.check_element("triangle", n, c))?;
        if self.measure != Measure::PerArea {
            return Ok(());
        }
        let areas = self.areas();
        match areas.iter().position(|area| *area <= 0.0 || !area.is_finite()) {
            None => Ok(()),
            Some(n) => Err(format!(
                "point {n} has the area {}, but the values are per area: make it a corner of a \
                 triangle or, without triangles, of an edge, or use the measure `per-point` or \
                 `unknown`",
                areas[n]
            )),
        }
    }

    fn check_element(&self, kind: &str, n: usize, corners: &[u32]) -> Result<(), String> {
        let count = self.points.len();
        if let Some(corner) = corners.iter().find(|corner| **corner as usize >= count) {
            return Err(format!("{kind} {n} names point {corner} of {count}"));
        }
        let size = self.size(corners);
        if size > 0.0 && size.is_finite() {
            return Ok(());
        }
        let extent = if corners.len() == 2 { "length" } else { "area" };
        Err(format!("{kind} {n}, between the points {corners:?}, has the {extent} {size}"))
    }

    /// Returns the number of elements that give the points their areas.
    fn elements(&self) -> usize {
        if self.triangles.is_empty() { self.edges.len() } else { self.triangles.len() }
    }

    /// Returns the corners of an element that gives the points their areas.
    fn corners(&self, element: usize) -> &[u32] {
        if self.triangles.is_empty() { &self.edges[element] } else { &self.triangles[element] }
    }

    /// Returns the share of each corner in the area of an element.
    fn share(&self, element: usize) -> f64 {
        let corners = self.corners(element);
        self.size(corners) / corners.len() as f64
    }

    /// Returns the length of an edge or the area of a triangle.
    fn size(&self, corners: &[u32]) -> f64 {
        let point = |corner: u32| self.points[corner as usize];
        match *corners {
            [a, b] => length(difference(point(b), point(a))),
            [a, b, c] => {
                let [a, b, c] = [a, b, c].map(point);
                0.5 * length(cross(difference(b, a), difference(c, a)))
            }
            _ => 0.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Grid, Shape};
    use proptest::prelude::*;

    /// Unit square in two triangles, split along the diagonal from point 0 to point 2.
    fn square(measure: Measure) -> Vertices {
        Vertices {
            points: vec![[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]],
            edges: Vec::new(),
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            measure,
        }
    }

    /// Polyline of the lengths 5 and 2.
    fn line(measure: Measure) -> Vertices {
        let points = vec![[0.0; 3], [3.0, 4.0, 0.0], [3.0, 6.0, 0.0]];
        Vertices { points, edges: vec![[0, 1], [2, 1]], triangles: Vec::new(), measure }
    }

    #[test]
    fn areas_follow_the_measure() {
        let areas = |vertices: Vertices| {
            let grid = Grid::vertices("mesh", vertices);
            assert_eq!(grid.check(), Ok(()));
            let one_by_one: Vec<f64> = (0..grid.points()).map(|n| grid.area(n)).collect();
            assert_eq!(grid.areas(), one_by_one);
            one_by_one
        };
        assert_eq!(areas(square(Measure::PerArea)), [1.0 / 3.0, 0.5 / 3.0, 1.0 / 3.0, 0.5 / 3.0]);
        assert_eq!(areas(line(Measure::PerArea)), [2.5, 3.5, 1.0]);
        assert_eq!(areas(line(Measure::PerPoint)), [1.0; 3]);
        assert_eq!(areas(square(Measure::Unknown)), [0.0; 4]);
        let mixed = Vertices { edges: vec![[0, 1]], ..square(Measure::PerArea) };
        assert_eq!(areas(mixed), areas(square(Measure::PerArea)), "triangles alone count");
    }

    #[test]
    fn an_integral_weighs_values_with_areas() {
        let integral =
            |vertices, values: &[f64]| Grid::vertices("mesh", vertices).integrate(values);
        assert_eq!(integral(line(Measure::PerArea), &[1.0, 2.0, 4.0]), 2.5 + 7.0 + 4.0);
        assert_eq!(integral(line(Measure::PerPoint), &[1.0, 2.0, 4.0]), 7.0);
        assert_eq!(integral(line(Measure::Unknown), &[1.0, 2.0, 4.0]), 0.0);
        // ∫ x over the unit square, linear on both triangles.
        let x = integral(square(Measure::PerArea), &[0.0, 1.0, 1.0, 0.0]);
        assert!((x - 0.5).abs() < 1e-15, "rounding: {x}");
    }

    #[test]
    fn vertices_travel_and_move() {
        let grid = Grid::vertices("mesh", line(Measure::PerArea));
        let text = serde_json::to_string(&grid).unwrap();
        let expected = r#"{"name":"mesh","revision":1,"kind":"vertices","points":[[0.0,0.0,0.0],[3.0,4.0,0.0],[3.0,6.0,0.0]],"edges":[[0,1],[2,1]],"measure":"per-area"}"#;
        assert_eq!(text, expected);
        assert_eq!(serde_json::from_str::<Grid>(&text).unwrap(), grid);
        assert!(!grid.only_written() && grid.has_areas());
        assert!(!Grid::vertices("mesh", line(Measure::Unknown)).has_areas());

        let moved = grid.displaced(&[0.0, 0.0, 0.0, 0.0, 0.0, 3.0, 1.0, 1.0, 1.0]).unwrap();
        assert_eq!((moved.revision, moved.centre(2)), (2, [3.0, 9.0, 1.0]));
        assert_eq!((moved.area(2), grid.check_moved(&moved)), (2.5, Ok(())));
        let mut geometry = vec![f64::NAN; 9];
        moved.encode_geometry(&mut geometry);
        assert_eq!(grid.with_geometry(&geometry, 2), Ok(moved.clone()));
        let fault = grid.displaced(&[0.0; 8]).unwrap_err();
        assert!(fault.contains("8 displacements"), "{fault}");
        let collapse = grid.displaced(&[0.0, 0.0, 0.0, 0.0, 0.0, -2.0, 0.0, 0.0, 0.0]);
        assert!(collapse.unwrap_err().contains("edge 1"));
        let other = Grid { revision: 3, ..Grid::vertices("mesh", line(Measure::PerPoint)) };
        assert!(moved.check_moved(&other).is_err(), "another measure");
    }

    #[test]
    fn vertices_from_outside_are_checked() {
        let fault = |change: &dyn Fn(&mut Vertices)| {
            let mut vertices = square(Measure::PerArea);
            change(&mut vertices);
            Grid::vertices("mesh", vertices).check().unwrap_err()
        };
        for (fault, why) in [
            (fault(&|v| v.points.clear()), "0 points"),
            (fault(&|v| v.points[2][1] = f64::NAN), "point 2 is not finite"),
            (fault(&|v| v.edges.push([0, 4])), "edge 0 names point 4 of 4"),
            (fault(&|v| v.triangles[1][0] = u32::MAX), "triangle 1 names point 4294967295 of 4"),
            (fault(&|v| v.triangles[0] = [1, 2, 1]), "triangle 0"),
            (fault(&|v| v.edges.push([3, 3])), "has the length 0"),
            (fault(&|v| v.points[2] = [1e200; 3]), "has the area inf"),
            (fault(&|v| v.points.push([9.0; 3])), "point 4 has the area 0"),
            (fault(&|v| v.triangles.clear()), "use the measure `per-point`"),
        ] {
            assert!(fault.contains("`mesh`") && fault.contains(why), "{fault}");
        }
        for measure in [Measure::PerPoint, Measure::Unknown] {
            let mut cloud = square(measure);
            cloud.triangles.clear();
            assert_eq!(Grid::vertices("cloud", cloud).check(), Ok(()));
        }
        let text = r#"{"name":"m","revision":1,"kind":"vertices","points":[[0,0,0]]}"#;
        assert!(serde_json::from_str::<Grid>(text).unwrap_err().to_string().contains("measure"));
    }

    proptest! {
        /// No input makes a check panic, and a checked grid has one finite area a point.
        #[test]
        fn any_input_is_checked(
            points in prop::collection::vec(any::<[f64; 3]>(), 0..6),
            edges in prop::collection::vec(any::<[u8; 2]>(), 0..4),
            triangles in prop::collection::vec(any::<[u8; 3]>(), 0..4),
            measure in prop::sample::select(vec![
                Measure::PerPoint, Measure::PerArea, Measure::Unknown
            ]),
        ) {
            let edges = edges.into_iter().map(|edge| edge.map(|n| u32::from(n % 8))).collect();
            let triangles =
                triangles.into_iter().map(|corners| corners.map(|n| u32::from(n % 8))).collect();
            let vertices = Vertices { points, edges, triangles, measure };
            let grid = Grid::vertices("mesh", vertices);
            if grid.check().is_ok() {
                prop_assert!(matches!(&grid.shape, Shape::Vertices(v) if !v.points.is_empty()));
                prop_assert!(grid.areas().iter().all(|area| area.is_finite()));
            }
        }
    }
}
