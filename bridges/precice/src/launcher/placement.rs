//! Place of a program's meshes in the coordinates of the case.
//!
//! A program has coordinates of its own: x_case = o + v t + Σ_k s_k e_k x_k, with its axes s_k e_k,
//! the place o of its origin at t = 0 and a velocity v. So a plane program can lie in the vertical
//! plane, and a program that thinks in the frame of a body can pass below the contact.

use proto::grid::{Grid, Shape};

/// Names of the axes of the case.
const AXES: [&str; 3] = ["x", "y", "z"];

/// Reason why a placement cannot be used.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum PlacementError {
    /// The axes are malformed.
    #[error("`{0}` is not a list of two or three different axes such as \"x,-z\"")]
    Axes(String),
    /// A vector is malformed.
    #[error("`{0}` is not a list of three numbers such as \"0,0,0.01\"")]
    Vector(String),
}

/// An axis of the case, with a sign.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Axis {
    index: usize,
    sign: f64,
}

/// Place of a program's coordinates.
#[derive(Clone, Debug, PartialEq)]
pub struct Placement {
    axes: Vec<Axis>,
    origin: [f64; 3],
    velocity: [f64; 3],
}

impl Default for Placement {
    fn default() -> Self {
        let axes = (0..3).map(|index| Axis { index, sign: 1.0 }).collect();
        Self { axes, origin: [0.0; 3], velocity: [0.0; 3] }
    }
}

impl Placement {
    /// Parses a placement; absent parts are those of the case.
    ///
    /// # Errors
    /// Fails if a list is malformed or names an axis twice.
    pub fn parse(
        axes: Option<&str>,
        origin: Option<&str>,
        velocity: Option<&str>,
    ) -> Result<Self, PlacementError> {
        let own = Self::default();
        Ok(Self {
            axes: axes.map_or(Ok(own.axes), parse_axes)?,
            origin: origin.map_or(Ok(own.origin), parse_vector)?,
            velocity: velocity.map_or(Ok(own.velocity), parse_vector)?,
        })
    }

    /// Returns true if the program's axes are those of the case.
    #[must_use]
    pub fn keeps_axes(&self) -> bool {
        let kept = |(index, axis): (usize, &Axis)| axis.index == index && axis.sign > 0.0;
        self.axes.iter().enumerate().all(kept)
    }

    /// Returns the number of axes.
    #[must_use]
    pub fn dimensions(&self) -> usize {
        self.axes.len()
    }

    /// Returns true if the program moves in the coordinates of the case.
    #[must_use]
    pub fn moves(&self) -> bool {
        self.velocity != [0.0; 3]
    }

    /// Returns the place of a point at t = 0.
    #[must_use]
    pub fn place(&self, point: [f64; 3]) -> [f64; 3] {
        let mut placed = self.origin;
        for (axis, coordinate) in self.axes.iter().zip(point) {
            placed[axis.index] += axis.sign * coordinate;
        }
        placed
    }

    /// Returns a grid of vertices, given at t = 0, at a later time [s].
    #[must_use]
    pub fn at(&self, grid: &Grid, time: f64, revision: u64) -> Grid {
        let mut moved = Grid { revision, ..grid.clone() };
        if let Shape::Vertices(vertices) = &mut moved.shape {
            for point in &mut vertices.points {
                for (coordinate, velocity) in point.iter_mut().zip(self.velocity) {
                    *coordinate += velocity * time;
                }
            }
        }
        moved
    }
}

fn parse_axes(text: &str) -> Result<Vec<Axis>, PlacementError> {
    let malformed = || PlacementError::Axes(text.to_owned());
    let mut axes: Vec<Axis> = Vec::new();
    for word in text.split(',').map(str::trim) {
        let (name, sign) = word.strip_prefix('-').map_or((word, 1.0), |name| (name, -1.0));
        let index = AXES.iter().position(|axis| *axis == name).ok_or_else(malformed)?;
        if axes.iter().any(|other| other.index == index) {
            return Err(malformed());
        }
        axes.push(Axis { index, sign });
    }
    if axes.len() < 2 { Err(malformed()) } else { Ok(axes) }
}

fn parse_vector(text: &str) -> Result<[f64; 3], PlacementError> {
    let malformed = || PlacementError::Vector(text.to_owned());
    let number = |word: &str| word.trim().parse().ok().filter(|value: &f64| value.is_finite());
    let numbers: Option<Vec<f64>> = text.split(',').map(number).collect();
    numbers.and_then(|numbers| numbers.try_into().ok()).ok_or_else(malformed)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proto::grid::{Measure, Vertices};

    #[test]
    fn a_plane_program_lies_in_the_vertical_plane() {
        let placement = Placement::parse(Some("x, -z"), Some("0, 0.5, 1"), None).unwrap();
        assert_eq!(placement.place([2.0, 3.0, 0.0]), [2.0, 0.5, -2.0]);
        assert!(!placement.keeps_axes() && !placement.moves());
        assert!(Placement::default().keeps_axes());
    }

    #[test]
    fn a_program_moves_with_its_velocity() {
        let placement = Placement::parse(None, None, Some("-4,0,0")).unwrap();
        let points = vec![[1.0, 2.0, 0.0]];
        let (edges, triangles) = (Vec::new(), Vec::new());
        let measure = Measure::Unknown;
        let grid = Grid::vertices("wall", Vertices { points, edges, triangles, measure });
        let moved = placement.at(&grid, 0.5, 7);
        assert_eq!((moved.centre(0), moved.revision), ([-1.0, 2.0, 0.0], 7));
    }

    #[test]
    fn malformed_placements_are_refused() {
        for axes in ["x", "x,x", "x,-x", "u,v", ""] {
            let refused = Placement::parse(Some(axes), None, None);
            assert_eq!(refused, Err(PlacementError::Axes(axes.to_owned())));
        }
        for vector in ["1,2", "1,2,nan", "1,2,3,4", "a,b,c"] {
            let refused = Placement::parse(None, None, Some(vector));
            assert_eq!(refused, Err(PlacementError::Vector(vector.to_owned())));
        }
    }
}
