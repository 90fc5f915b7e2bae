//! Cross-section of the surface of a prismatic body.
//!
//! A section is made of arcs. The direction θ is linear in the length s between the given points
//! and constant beyond the first and the last, where the surface is straight. Positions follow
//! exactly from (dy, dz) = (cos θ, sin θ) ds. y is across, z up; the common normal of both bodies
//! is (−sin θ, cos θ), from the lower into the upper body.

/// Cross-section of a body.
#[derive(Clone, Debug, PartialEq)]
pub struct CrossSection {
    /// Lengths s at which the direction is given, rising [m].
    at: Vec<f64>,
    /// Direction θ at each s [rad].
    directions: Vec<f64>,
    /// Coordinates y and z at each s [m].
    places: Vec<[f64; 2]>,
}

impl CrossSection {
    /// Creates a section with these directions [rad] at these rising lengths [m]; the first point
    /// is at y = z = 0.
    ///
    /// # Panics
    /// If the lists are empty or differ in length.
    #[must_use]
    pub fn new(at: Vec<f64>, directions: Vec<f64>) -> Self {
        assert!(!at.is_empty() && at.len() == directions.len(), "a direction at every length");
        let mut places = vec![[0.0; 2]];
        for pair in 0..at.len() - 1 {
            let (length, turn) = (at[pair + 1] - at[pair], directions[pair + 1] - directions[pair]);
            places.push(along(places[pair], directions[pair], turn, length));
        }
        Self { at, directions, places }
    }

    /// Creates an arc of curvature dθ/ds [1/m] over |s| ≤ `half` [m].
    #[must_use]
    pub fn arc(curvature: f64, half: f64) -> Self {
        let turned = curvature * half;
        let mut section = Self::new(vec![-half, half], vec![-turned, turned]);
        let (middle, _) = section.at(0.0);
        for [y, z] in &mut section.places {
            *y -= middle[0];
            *z -= middle[1];
        }
        section
    }

    /// Creates a straight line.
    #[must_use]
    pub(super) fn straight() -> Self {
        Self::new(vec![0.0], vec![0.0])
    }

    /// Position [m] and direction [rad] at s [m].
    #[must_use]
    pub fn at(&self, s: f64) -> ([f64; 2], f64) {
        let right = self.at.partition_point(|at| *at <= s);
        let left = right.saturating_sub(1);
        let (length, direction) = (s - self.at[left], self.directions[left]);
        let turn = match (left, right) {
            // The surface is straight beyond the ends.
            (0, 0) => 0.0,
            (_, right) if right == self.at.len() => 0.0,
            _ => {
                let [from, to] = [self.at[left], self.at[right]];
                (self.directions[right] - direction) * length / (to - from)
            }
        };
        (along(self.places[left], direction, turn, length), direction + turn)
    }

    /// First and last length at which the direction is given [m].
    #[must_use]
    pub fn ends(&self) -> [f64; 2] {
        [self.at[0], self.at[self.at.len() - 1]]
    }

    /// Range of the direction over the whole section [rad].
    #[must_use]
    pub fn turn(&self) -> f64 {
        let range = self.directions.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |range, at| {
            [range[0].min(*at), range[1].max(*at)]
        });
        range[1] - range[0]
    }
}

/// End of an arc that begins at a point in a direction [rad] and turns by `turn` [rad] over its
/// length [m].
fn along([y, z]: [f64; 2], direction: f64, turn: f64, length: f64) -> [f64; 2] {
    let half = 0.5 * turn;
    let chord = if half.abs() > 1e-8 { length * half.sin() / half } else { length };
    let middle = direction + half;
    [y + chord * middle.cos(), z + chord * middle.sin()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_quarter_of_a_circle_and_the_lines_beyond() {
        let radius = 10e-3_f64;
        let quarter = std::f64::consts::FRAC_PI_4;
        let arc = CrossSection::arc(-1.0 / radius, radius * quarter);
        for angle in [-0.7, 0.0, 0.3] {
            let ([y, z], direction) = arc.at(radius * angle);
            assert!((y - radius * angle.sin()).abs() < 1e-17);
            assert!((z - radius * (angle.cos() - 1.0)).abs() < 1e-17);
            assert!((direction + angle).abs() < 1e-15);
        }
        let ([y, z], direction) = arc.at(radius * quarter + 5e-3);
        let line = [radius * quarter.sin(), radius * (quarter.cos() - 1.0)];
        assert!((y - line[0] - 5e-3 * quarter.cos()).abs() < 1e-17);
        assert!((z - line[1] + 5e-3 * quarter.sin()).abs() < 1e-17);
        assert!((direction + quarter).abs() < 1e-15);
        assert!((arc.turn() - 2.0 * quarter).abs() < 1e-15);
    }

    /// An arc given at many points equals the arc given at its ends.
    #[test]
    fn pieces_of_an_arc_are_the_arc() {
        let at: Vec<f64> = (0..=8).map(|k| -4e-3 + 1e-3 * f64::from(k)).collect();
        let pieces = CrossSection::new(at.clone(), at.iter().map(|s| -90.0 * s).collect());
        let whole = CrossSection::new(vec![-4e-3, 4e-3], vec![0.36, -0.36]);
        for s in [-9e-3, -3.7e-3, 0.0, 2.2e-3, 4e-3, 8e-3] {
            let ((a, one), (b, other)) = (pieces.at(s), whole.at(s));
            assert!((a[0] - b[0]).abs() < 1e-16 && (a[1] - b[1]).abs() < 1e-16, "{s}");
            assert!((one - other).abs() < 1e-14, "{s}");
        }
    }
}
