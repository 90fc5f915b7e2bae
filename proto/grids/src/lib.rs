//! Grids, on which fields have their values.
//!
//! A structured grid is a plane patch of equal elements; an unstructured grid is a surface of
//! quadrilaterals. Values belong to element centres. The value of element (i, j) of a structured
//! grid stands at index `j * ni + i` (i runs fastest). In the contact plane, `step_i` points along
//! x, the rolling direction, and `step_j` along y, to the left. On a grid of vertices values belong
//! to the points. Fields on volumes of hexahedra and at points in blocks are output only. [`state`]
//! writes values to a file and reads them back.

#![forbid(unsafe_code)]

mod geometry;
mod hexahedron;
mod points;
mod quadrilaterals;
pub mod state;
mod structured;
mod sum;
mod vector;
mod vertices;
mod volume;

pub use points::{Block, Places, Points};
pub use quadrilaterals::Quadrilaterals;
pub use structured::Structured;
pub use sum::{blocked_sum, pairwise_sum};
pub use vertices::{Measure, Vertices};
pub use volume::{Hexahedra, Volume};

use serde::{Deserialize, Serialize};

/// Maximum number of points: a field on more would not fit into any machine.
const MOST_POINTS: usize = 1 << 36;

/// Checks a name that is used in labels and file names: a plain word.
///
/// # Errors
/// Fails if the name is empty, longer than 31 bytes, or has characters other than letters, digits,
/// `_` and `-`.
pub fn check_name(what: &str, name: &str) -> Result<(), String> {
    let plain = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '-';
    if (1..=31).contains(&name.len()) && name.chars().all(plain) {
        return Ok(());
    }
    let shown: String = name.chars().take(40).collect();
    Err(format!("the {what} name {shown:?} is not 1 to 31 letters, digits, `_` or `-`"))
}

/// Checks the name of a field: a name as in [`check_name`], or several separated by dots, like the
/// key of a case value.
///
/// # Errors
/// Fails if a part is not such a name, or if the whole is longer than 31 bytes.
pub fn check_dotted(what: &str, name: &str) -> Result<(), String> {
    let parts = name.split('.').try_for_each(|part| check_name(what, part));
    if parts.is_ok() && name.len() <= 31 { Ok(()) } else { check_name(what, name) }
}

/// A named grid with a revision that increases whenever its geometry changes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Grid {
    /// Name, unique within the participant that owns the grid; at most 31 bytes of ASCII.
    pub name: String,
    /// Revision, from 1; increases by one whenever the geometry changes. Revision 0 is an announced
    /// volume without geometry.
    pub revision: u64,
    /// Geometry.
    #[serde(flatten)]
    pub shape: Shape,
}

/// Geometry of a grid.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum Shape {
    /// Plane patch of equal parallelogram elements.
    Structured(Structured),
    /// Surface of quadrilateral elements.
    Quadrilaterals(Quadrilaterals),
    /// Points that carry values, with optional edges and triangles.
    Vertices(Vertices),
    /// Hexahedral elements, for output fields only.
    Volume(Volume),
    /// Points in named blocks, for output fields only.
    Points(Points),
}

impl From<Structured> for Shape {
    fn from(shape: Structured) -> Self {
        Self::Structured(shape)
    }
}

impl Grid {
    /// Returns a structured grid of revision 1.
    #[must_use]
    pub fn structured(name: &str, shape: Structured) -> Self {
        Self { name: name.to_owned(), revision: 1, shape: Shape::Structured(shape) }
    }

    /// Returns an unstructured grid of revision 1.
    #[must_use]
    pub fn quadrilaterals(name: &str, shape: Quadrilaterals) -> Self {
        Self { name: name.to_owned(), revision: 1, shape: Shape::Quadrilaterals(shape) }
    }

    /// Returns a grid of vertices of revision 1.
    #[must_use]
    pub fn vertices(name: &str, shape: Vertices) -> Self {
        Self { name: name.to_owned(), revision: 1, shape: Shape::Vertices(shape) }
    }

    /// Returns a volume: announced in revision 0, or with its geometry in revision 1.
    #[must_use]
    pub fn volume(name: &str, shape: impl Into<Volume>) -> Self {
        let shape = shape.into();
        let revision = u64::from(!shape.is_announced());
        Self { name: name.to_owned(), revision, shape: Shape::Volume(shape) }
    }

    /// Returns the grid as declared in a layout: for a volume only the elements, because its
    /// geometry follows later.
    #[must_use]
    pub fn announced(&self) -> Self {
        match &self.shape {
            Shape::Volume(volume) => Self::volume(&self.name, volume.hexahedra()),
            _ => self.clone(),
        }
    }

    /// Returns true for a volume, whose geometry travels on a topic of its own.
    #[must_use]
    pub fn is_volume(&self) -> bool {
        matches!(self.shape, Shape::Volume(_))
    }

    /// Returns true if fields on the grid are output only.
    #[must_use]
    pub fn only_written(&self) -> bool {
        matches!(self.shape, Shape::Volume(_) | Shape::Points(_))
    }

    /// Returns true for a volume whose geometry is to follow.
    #[must_use]
    pub fn is_announced(&self) -> bool {
        matches!(&self.shape, Shape::Volume(volume) if volume.is_announced())
    }

    /// Returns the number of values of a one-component field, that is, of elements or points.
    #[must_use]
    pub fn points(&self) -> usize {
        match &self.shape {
            Shape::Structured(s) => s.points(),
            Shape::Quadrilaterals(q) => q.elements.len(),
            Shape::Vertices(v) => v.points.len(),
            Shape::Volume(v) => v.hexahedra().elements(),
            Shape::Points(p) => p.count(),
        }
    }

    /// Returns the place of the value at `index` [m]: the centre of its element, or its point.
    ///
    /// # Panics
    /// Panics for an announced volume.
    #[must_use]
    pub fn centre(&self, index: usize) -> [f64; 3] {
        match &self.shape {
            Shape::Structured(s) => s.centre(index % s.ni, index / s.ni),
            Shape::Quadrilaterals(q) => q.centre(index),
            Shape::Vertices(v) => v.points[index],
            Shape::Volume(v) => v.centre(index),
            Shape::Points(p) => p.point(index),
        }
    }

    /// Returns the area of the element whose value stands at `index` [m²]: for a volume element its
    /// volume [m³], for a vertex [`Vertices::area`], for a point in a block 0. On vertices
    /// [`Grid::areas`] is the faster way to all areas.
    ///
    /// # Panics
    /// Panics for an announced volume.
    #[must_use]
    pub fn area(&self, index: usize) -> f64 {
        match &self.shape {
            Shape::Structured(s) => s.element_area(),
            Shape::Quadrilaterals(q) => q.area(index),
            Shape::Vertices(v) => v.area(index),
            Shape::Volume(v) => v.volume(index),
            Shape::Points(_) => 0.0,
        }
    }

    /// Returns the areas of all elements or points, see [`Grid::area`].
    ///
    /// # Panics
    /// Panics for an announced volume.
    #[must_use]
    pub fn areas(&self) -> Vec<f64> {
        match &self.shape {
            Shape::Vertices(v) => v.areas(),
            _ => (0..self.points()).map(|index| self.area(index)).collect(),
        }
    }

    /// Returns true if a field on the grid has an integral: false for points in blocks, and for
    /// vertices of unknown measure.
    #[must_use]
    pub fn has_areas(&self) -> bool {
        match &self.shape {
            Shape::Structured(_) | Shape::Quadrilaterals(_) | Shape::Volume(_) => true,
            Shape::Vertices(v) => v.measure != Measure::Unknown,
            Shape::Points(_) => false,
        }
    }

    /// Returns the grid in the next revision with its vertices moved by `displacement` [m] (all x,
    /// then all y, then all z). A structured grid becomes an unstructured grid of the same
    /// elements, with vertex (i, j) at `j * (ni + 1) + i`.
    ///
    /// # Errors
    /// Fails if the length is not three values per vertex, if moved elements are invalid, and for
    /// points in blocks and volumes; a volume moves only by [`Grid::with_geometry`].
    pub fn displaced(&self, displacement: &[f64]) -> Result<Self, String> {
        let moved = match &self.shape {
            Shape::Structured(s) => {
                Quadrilaterals::from(s).displaced(displacement).map(Shape::Quadrilaterals)
            }
            Shape::Quadrilaterals(q) => q.displaced(displacement).map(Shape::Quadrilaterals),
            Shape::Vertices(v) => v.displaced(displacement).map(Shape::Vertices),
            Shape::Volume(_) => Err("it is a volume".to_owned()),
            Shape::Points(_) => Err("points do not move".to_owned()),
        };
        let shape = moved.map_err(|why| format!("grid `{}`, moved: {why}", self.name))?;
        Ok(Self { name: self.name.clone(), revision: self.revision + 1, shape })
    }

    /// Checks a grid received from another process.
    ///
    /// # Errors
    /// Fails for an invalid name, too few or too many points, and coordinates or steps that are not
    /// finite. Fails for elements that lack vertices, are not convex, or have no positive length,
    /// area or volume. Fails for duplicate block names, axes that do not increase, and a volume
    /// that has geometry in revision 0 or lacks geometry in a later one.
    pub fn check(&self) -> Result<(), String> {
        check_name("grid", &self.name)?;
        let name = &self.name;
        let s = match &self.shape {
            Shape::Structured(s) => s,
            Shape::Quadrilaterals(q) => {
                return q.check().map_err(|why| format!("grid `{name}`: {why}"));
            }
            Shape::Vertices(v) => {
                return v.check().map_err(|why| format!("grid `{name}`: {why}"));
            }
            Shape::Volume(v) if v.is_announced() != (self.revision == 0) => {
                let revision = self.revision;
                return Err(format!(
                    "volume `{name}` has revision {revision}: it is announced in revision 0, and its \
                     geometry follows with revision 1"
                ));
            }
            Shape::Volume(v) => return v.check().map_err(|why| format!("volume `{name}`: {why}")),
            Shape::Points(p) => {
                p.blocks.iter().try_for_each(|block| check_name("block", &block.name))?;
                return p.check().map_err(|why| format!("points `{name}`: {why}"));
            }
        };
        match s.ni.checked_mul(s.nj) {
            Some(points) if (1..=MOST_POINTS).contains(&points) => {}
            _ => return Err(format!("grid `{name}` has {} x {} points", s.ni, s.nj)),
        }
        let finite = [s.origin, s.step_i, s.step_j].as_flattened().iter().all(|v| v.is_finite());
        if !finite || s.element_area() <= 0.0 {
            return Err(format!("grid `{name}` has elements without an area"));
        }
        Ok(())
    }

    /// Returns the structured geometry, if the grid is structured.
    #[must_use]
    pub fn as_structured(&self) -> Option<&Structured> {
        match &self.shape {
            Shape::Structured(s) => Some(s),
            _ => None,
        }
    }

    /// Returns the surface integral of a one-component field given at the points [unit·m²]; for a
    /// volume the volume integral [unit·m³], for points in blocks 0. On vertices the [`Measure`]
    /// decides.
    ///
    /// # Panics
    /// Panics for an announced volume.
    #[must_use]
    pub fn integrate(&self, values: &[f64]) -> f64 {
        match &self.shape {
            Shape::Structured(s) => s.element_area() * blocked_sum(values),
            Shape::Quadrilaterals(q) => pairwise_sum(0..values.len(), &|n| q.area(n) * values[n]),
            Shape::Vertices(v) => v.integrate(values),
            Shape::Volume(v) => pairwise_sum(0..values.len(), &|n| v.volume(n) * values[n]),
            Shape::Points(_) => 0.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn json_round_trip_keeps_every_bit() {
        let shape = Structured::contact_plane(-0.1 / 3.0, 1e-17, 0.2 / 7.0, 1.0 / 3.0, 5, 3);
        let grid = Grid::structured("contact", shape);
        let text = serde_json::to_string(&grid).unwrap();
        assert_eq!(serde_json::from_str::<Grid>(&text).unwrap(), grid);
    }

    #[test]
    fn grids_from_outside_are_checked() {
        let grid = |name: &str, ni, nj, dx| {
            Grid::structured(name, Structured::contact_plane(0.0, 0.0, dx, 1.0, ni, nj)).check()
        };
        assert_eq!(grid("contact", 3, 2, 1.0), Ok(()));
        let wrong = [
            grid("../evil", 3, 2, 1.0),
            grid("", 3, 2, 1.0),
            grid("contact", 0, 2, 1.0),
            grid("contact", (1 << 63) + 1, 2, 1.0),
            grid("contact", 3, 2, 0.0),
            grid("contact", 3, 2, f64::NAN),
        ];
        assert!(wrong.iter().all(Result::is_err), "{wrong:?}");
    }

    #[test]
    fn a_volume_is_announced_before_its_geometry_comes() {
        let axis = [0.0, 1.0, 3.0];
        let grid = Grid::volume("body", Volume::rectilinear([&axis; 3]));
        assert_eq!((grid.check(), grid.revision, grid.points()), (Ok(()), 1, 8));
        assert_eq!((grid.centre(1), grid.area(1)), ([2.0, 0.5, 0.5], 2.0));
        assert_eq!(grid.integrate(&[0.5; 8]), 13.5);
        let announced = grid.announced();
        assert_eq!((announced.check(), announced.revision), (Ok(()), 0));
        let text = serde_json::to_string(&announced).unwrap();
        let expected = r#"{"name":"body","revision":0,"kind":"volume","hexahedra":"rectilinear","ni":2,"nj":2,"nk":2}"#;
        assert_eq!(text, expected);
        assert_eq!(serde_json::from_str::<Grid>(&text).unwrap(), announced);
        for wrong in [Grid { revision: 0, ..grid }, Grid { revision: 1, ..announced }] {
            let fault = wrong.check().unwrap_err();
            assert!(fault.contains("it is announced in revision 0"), "{fault}");
        }
    }

    #[test]
    fn area_and_centres() {
        let shape = Structured::contact_plane(-1.0, -2.0, 0.5, 0.25, 4, 2);
        assert_eq!(shape.element_area(), 0.125);
        assert_eq!(shape.centre(3, 1), [0.5, -1.75, 0.0]);
        assert_eq!(Grid::structured("g", shape).integrate(&[2.0; 8]), 2.0);
    }
}
