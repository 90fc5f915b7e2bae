//! Geometry of a grid as the values of a field, for sending moving grids and volumes through shared
//! memory.
//!
//! The field is `geometry`: three components in metres, component-major, so that component c of
//! vector n stands at `c * count + n`. The vectors are
//!
//! | grid | count | vectors |
//! |---|---|---|
//! | structured | 4 | centre of element (0, 0), step in i, step in j, counts (ni, nj, 1) [-] |
//! | quadrilaterals | vertices | vertices in order |
//! | vertices | points | points in order |
//! | volume | see `volume.rs` | |
//! | points | points | points; these never move |
//!
//! A structured grid may move, turn, stretch and grow, but stays structured. Quadrilaterals,
//! vertices and volumes move only their points; the connectivity is fixed for the run. A volume is
//! announced in revision 0 and receives its geometry as if it had moved.

use super::{Grid, Quadrilaterals, Shape, Structured};

/// Number of components of a vector in space.
const COMPONENTS: usize = 3;
/// Number of vectors of a structured grid.
const VECTORS: usize = 4;

impl Grid {
    /// Returns the number of vectors of the geometry; each has three values.
    #[must_use]
    pub fn geometry_points(&self) -> usize {
        match &self.shape {
            Shape::Structured(_) => VECTORS,
            Shape::Quadrilaterals(q) => q.points.len(),
            Shape::Vertices(v) => v.points.len(),
            Shape::Volume(v) => v.hexahedra().vectors(),
            Shape::Points(p) => p.count(),
        }
    }

    /// Writes the geometry [m], component-major.
    ///
    /// # Panics
    /// Panics if `values` does not hold three values for each of [`Grid::geometry_points`], or for
    /// an announced volume.
    pub fn encode_geometry(&self, values: &mut [f64]) {
        let count = self.geometry_points();
        assert_eq!(values.len(), COMPONENTS * count, "three values for each vector");
        let mut put = |vectors: &[[f64; 3]]| {
            for (component, values) in values.chunks_exact_mut(count).enumerate() {
                values.iter_mut().zip(vectors).for_each(|(value, v)| *value = v[component]);
            }
        };
        match &self.shape {
            Shape::Structured(s) => {
                put(&[s.origin, s.step_i, s.step_j, [s.ni as f64, s.nj as f64, 1.0]]);
            }
            Shape::Quadrilaterals(q) => put(&q.points),
            Shape::Vertices(v) => put(&v.points),
            Shape::Volume(v) => values.copy_from_slice(v.geometry()),
            Shape::Points(p) => {
                put(&(0..count).map(|index| p.point(index)).collect::<Vec<_>>());
            }
        }
    }

    /// Returns this grid with the geometry from [`Grid::encode_geometry`] and its revision.
    ///
    /// # Errors
    /// Fails for a revision that is not above the present one, a wrong number of values, counts
    /// that are not whole, a changed connectivity, or a grid that [`Grid::check`] refuses.
    pub fn with_geometry(&self, values: &[f64], revision: u64) -> Result<Self, String> {
        let (name, count) = (&self.name, self.geometry_points());
        if revision <= self.revision {
            let last = self.revision;
            return Err(format!("grid `{name}` has revision {revision} after {last}"));
        }
        if values.len() != COMPONENTS * count {
            let (found, expected) = (values.len(), COMPONENTS * count);
            return Err(format!(
                "the geometry of grid `{name}` has {found} values, not {expected}"
            ));
        }
        let vector = |n: usize| -> [f64; 3] { std::array::from_fn(|c| values[c * count + n]) };
        let shape = match &self.shape {
            Shape::Structured(_) => Shape::Structured(structured(vector).map_err(|fault| {
                format!("the geometry of grid `{name}`, revision {revision}: {fault}")
            })?),
            Shape::Quadrilaterals(q) => Shape::Quadrilaterals(Quadrilaterals {
                points: (0..count).map(vector).collect(),
                elements: q.elements.clone(),
            }),
            Shape::Vertices(v) => Shape::Vertices(v.with_points((0..count).map(vector).collect())),
            Shape::Volume(v) => Shape::Volume(v.with_geometry(values)),
            Shape::Points(_) => {
                return Err(format!("grid `{name}` is of points, which do not move"));
            }
        };
        let moved = Self { name: name.clone(), revision, shape };
        moved.check().map_err(|fault| format!("{fault}, in revision {revision}"))?;
        match self.has_elements_of(&moved) {
            true => Ok(moved),
            false => Err(format!("the elements of `{name}` have other vertices than before")),
        }
    }

    /// Checks that `moved` is this grid after a motion.
    ///
    /// # Errors
    /// Fails for another grid, a lower revision, the same revision with a different geometry, or a
    /// changed connectivity.
    pub fn check_moved(&self, moved: &Self) -> Result<(), String> {
        let (name, revision, last) = (&self.name, moved.revision, self.revision);
        if moved.name == *name && revision == last && self.shape == moved.shape {
            return Ok(());
        }
        if moved.name != *name || !self.has_elements_of(moved) {
            return Err(format!("`{}` is not the grid `{name}`, moved", moved.name));
        }
        if revision < last {
            return Err(format!("grid `{name}` has revision {revision} after {last}"));
        }
        if revision == last {
            return Err(format!("grid `{name}` has moved and still has revision {revision}"));
        }
        moved.check()
    }

    /// Returns true if both grids have the same connectivity.
    fn has_elements_of(&self, other: &Self) -> bool {
        match (&self.shape, &other.shape) {
            (Shape::Structured(_), Shape::Structured(_)) => true,
            (Shape::Quadrilaterals(a), Shape::Quadrilaterals(b)) => {
                a.elements == b.elements && a.points.len() == b.points.len()
            }
            (Shape::Vertices(a), Shape::Vertices(b)) => a.has_elements_of(b),
            (Shape::Volume(a), Shape::Volume(b)) => a.has_elements_of(b),
            _ => false,
        }
    }
}

fn structured(vector: impl Fn(usize) -> [f64; 3]) -> Result<Structured, String> {
    let [ni, nj, one] = vector(3);
    // Whole numbers up to 2⁵³ are exact.
    let whole = |v: f64| (1.0..9e15).contains(&v) && v.fract() == 0.0;
    if !whole(ni) || !whole(nj) || one != 1.0 {
        return Err(format!("its counts are ({ni}, {nj}, {one})"));
    }
    let (ni, nj) = (ni as usize, nj as usize);
    Ok(Structured { origin: vector(0), step_i: vector(1), step_j: vector(2), ni, nj })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Volume;
    use proptest::prelude::*;

    fn encoded(grid: &Grid) -> Vec<f64> {
        let mut values = vec![f64::NAN; 3 * grid.geometry_points()];
        grid.encode_geometry(&mut values);
        values
    }

    fn plane() -> Grid {
        Grid::structured("patch", Structured::contact_plane(-1.0, 2.0, 0.5, 0.25, 3, 2))
    }

    fn quadrilaterals() -> Grid {
        let shape = *plane().as_structured().unwrap();
        Grid::quadrilaterals("patch", Quadrilaterals::from(&shape))
    }

    /// Pins the layout, because other languages write and read it.
    #[test]
    fn golden_layout_of_a_geometry() {
        let expected = [-1.0, 0.5, 0.0, 3.0, 2.0, 0.0, 0.25, 2.0, 0.0, 0.0, 0.0, 1.0];
        assert_eq!(encoded(&plane()), expected);
        let values = encoded(&quadrilaterals());
        assert_eq!(values.len(), 3 * 12);
        assert_eq!(values[..4], [-1.25, -0.75, -0.25, 0.25], "x of the first row");
        assert_eq!(values[12..17], [1.875, 1.875, 1.875, 1.875, 2.125], "y");
    }

    #[test]
    fn geometries_from_outside_are_checked() {
        let with = |grid: &Grid, at: usize, value: f64| {
            let mut values = encoded(grid);
            values[at] = value;
            grid.with_geometry(&values, 2)
        };
        let (plane, surface) = (plane(), quadrilaterals());
        for (at, value) in [(3, 2.5), (3, 0.0), (3, f64::NAN), (3, 1e16), (7, -2.0), (11, 0.0)] {
            let fault = with(&plane, at, value).unwrap_err();
            assert!(fault.contains("counts are"), "{at}: {fault}");
        }
        for (at, value) in [(1, 0.0), (0, f64::INFINITY)] {
            assert!(with(&plane, at, value).unwrap_err().contains("without an area"));
        }
        assert!(with(&surface, 5, f64::NAN).unwrap_err().contains("vertex 5 is not finite"));
        assert!(with(&surface, 5, 9.0).unwrap_err().contains("convex"));
        let values = encoded(&plane);
        assert!(plane.with_geometry(&values[1..], 2).unwrap_err().contains("11 values, not 12"));
        for revision in [0, 1] {
            let fault = plane.with_geometry(&values, revision).unwrap_err();
            assert!(fault.contains(&format!("revision {revision} after 1")), "{fault}");
        }
    }

    #[test]
    fn what_a_model_calls_moved_is_checked() {
        let (plane, surface) = (plane(), quadrilaterals());
        let mut moved = plane.clone();
        assert_eq!(plane.check_moved(&moved), Ok(()));
        moved.revision = 2;
        assert!(moved.check_moved(&plane).unwrap_err().contains("revision 1 after 2"));
        moved.shape = Shape::Structured(Structured::contact_plane(0.0, 0.0, 1.0, 1.0, 9, 9));
        assert_eq!(plane.check_moved(&moved), Ok(()));
        moved.revision = 1;
        assert!(plane.check_moved(&moved).unwrap_err().contains("still has revision 1"));
        moved = Grid { revision: 2, ..surface.clone() };
        assert!(plane.check_moved(&moved).unwrap_err().contains("not the grid `patch`"));
        if let Shape::Quadrilaterals(q) = &mut moved.shape {
            q.elements[0].rotate_left(1);
        }
        assert!(surface.check_moved(&moved).is_err(), "other elements");
    }

    #[test]
    fn a_volume_comes_to_its_geometry_and_moves() {
        let corners = |height: f64| {
            let at = |n: usize| [(n & 1) as f64, (n >> 1 & 1) as f64, (n >> 2) as f64 * height];
            [0, 1, 2, 3, 4, 5, 6, 7].map(at)
        };
        let cube = |height, order| Volume::unstructured(&corners(height), &[order]);
        let order = [0, 1, 3, 2, 4, 5, 7, 6];
        let here = Grid::volume("body", cube(1.0, order));
        let announced = here.announced();
        assert_eq!(announced.check_moved(&here), Ok(()));
        assert_eq!(announced.with_geometry(&encoded(&here), 1), Ok(here.clone()));
        let there = Grid { revision: 2, ..Grid::volume("body", cube(2.0, order)) };
        assert_eq!(here.with_geometry(&encoded(&there), 2), Ok(there.clone()));
        assert_eq!(here.check_moved(&there), Ok(()));
        let turned =
            Grid { revision: 2, ..Grid::volume("body", cube(2.0, [1, 3, 2, 0, 5, 7, 6, 4])) };
        assert_eq!(turned.check(), Ok(()));
        let fault = here.with_geometry(&encoded(&turned), 2).unwrap_err();
        assert!(fault.contains("other vertices than before"), "{fault}");
        assert!(here.check_moved(&turned).unwrap_err().contains("not the grid `body`"));
        let mut values = encoded(&there);
        values[22..30].fill(0.0);
        let flat = announced.with_geometry(&values, 1).unwrap_err();
        assert!(flat.contains("has the volume 0") && flat.contains("in revision 1"), "{flat}");
    }

    proptest! {
        #[test]
        fn structured_geometry_round_trip(
            origin: [f64; 3], step in 1e-9..1e9_f64, counts in [1_usize..5000, 1..5000]
        ) {
            prop_assume!(origin.iter().all(|v| v.is_finite()));
            let shape = Structured {
                origin,
                step_i: [step, 0.25 * step, 0.0],
                step_j: [0.0, step / 3.0, -step],
                ni: counts[0],
                nj: counts[1],
            };
            let moved = Grid { revision: 7, ..Grid::structured("patch", shape) };
            prop_assert_eq!(plane().with_geometry(&encoded(&moved), 7), Ok(moved));
        }

        /// Vertices moved by less than a quarter of an element keep it convex.
        #[test]
        fn vertices_round_trip(moves in prop::collection::vec(-0.06..0.06_f64, 36)) {
            let moved = quadrilaterals().displaced(&moves).unwrap();
            let found = quadrilaterals().with_geometry(&encoded(&moved), moved.revision);
            prop_assert_eq!(found, Ok(moved));
        }
    }
}
