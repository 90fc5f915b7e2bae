//! A measured lateral profile: heights over the lateral coordinate, from a file.
//!
//! The formats are those of [`crate::profile`]. Columns of numbers are taken as in the file, with y
//! to the left and z up unless told, in ascending or descending order of y. Files of SIMPACK and
//! Miniprof are converted to these axes. Here a profile is a height over y: a profile with upright
//! flanks is refused.
//!
//! Natural cubic splines interpolate between the points and end at kinks ([`crate::curve`]). Their
//! curvature is continuous, as a contact requires.

use crate::curve::Curve;
use crate::profile::orientation::{Body, Heights, oriented};
use crate::profile::{self, Format, Reading, columns, miniprof, simpack};
use std::path::Path;
use tables::input_file::{self, InputFileError};
use tables::readable::quantity;

/// Least number of points of a profile.
const FEWEST: usize = 4;
/// Largest file accepted [byte].
const MOST_BYTES: u64 = 64 << 20;

/// A lateral profile z(y).
#[derive(Clone, Debug, PartialEq)]
pub struct Profile(Curve);

/// Reason why a profile cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum ProfileError {
    /// The file cannot be read.
    #[error(transparent)]
    File(#[from] InputFileError),
    /// The file does not match its format.
    #[error(transparent)]
    Format(#[from] profile::ProfileError),
    /// The lateral coordinates are not in ascending order.
    #[error(
        "is not a height over y: y does not rise at point {point}, y = {y}; cut upright flanks off, or use the \
         model wheel-on-track", y = quantity(*.y, "m", 5))]
    Order {
        /// Number of the point, from 1, in ascending order of y.
        point: usize,
        /// Lateral coordinate of the point [m].
        y: f64,
    },
    /// Too few points.
    #[error("has {0} points, and a spline needs {FEWEST}")]
    Few(usize),
}

impl Profile {
    /// Reads the file of a body, and smooths it by no more than `tolerance` [m] at any point.
    /// `heights` is the direction of its heights, `None` for that of the format.
    ///
    /// # Errors
    /// Fails if the file cannot be read, is too large, or does not hold a profile that is a height
    /// over y.
    pub fn read(
        path: &Path,
        body: Body,
        heights: Option<Heights>,
        tolerance: f64,
    ) -> Result<Self, ProfileError> {
        let text = input_file::read_text(path, MOST_BYTES)?;
        let format = Format::of(path);
        let usual = Reading::usual(format, body);
        let direction = heights.unwrap_or(usual.heights);
        let points = match format {
            // Any shape, such as a groove or a part of a crown.
            Format::Columns => {
                let points = columns::points(text)?.into_iter();
                let up = if direction == Heights::Down { -1.0 } else { 1.0 };
                points.map(|[y, z]| [y, up * z]).collect()
            }
            Format::Simpack => oriented(simpack::points(&text)?.0, body, direction, false)?,
            Format::Miniprof => oriented(miniprof::points(&text)?, body, direction, true)?,
        };
        Self::through(points, tolerance)
    }

    /// Parses a text of columns, and smooths it like [`Profile::read`].
    ///
    /// # Errors
    /// Fails if the text does not hold a profile that is a height over y.
    pub fn parse(text: &str, tolerance: f64) -> Result<Self, ProfileError> {
        Self::through(columns::points(text.to_owned())?, tolerance)
    }

    fn through(mut points: Vec<[f64; 2]>, tolerance: f64) -> Result<Self, ProfileError> {
        if points.len() < FEWEST {
            return Err(ProfileError::Few(points.len()));
        }
        if points[0][0] > points[points.len() - 1][0] {
            points.reverse();
        }
        if let Some(at) = points.windows(2).position(|pair| pair[1][0] <= pair[0][0]) {
            return Err(ProfileError::Order { point: at + 2, y: points[at + 1][0] });
        }
        let (y, z) = points.into_iter().map(|[y, z]| (y, z)).unzip();
        Ok(Self(Curve::new(y, z, tolerance)))
    }

    /// Curve through the points.
    #[must_use]
    pub fn curve(&self) -> &Curve {
        &self.0
    }

    /// First and last lateral coordinate [m].
    #[must_use]
    pub fn range(&self) -> [f64; 2] {
        self.0.range()
    }

    /// Height at y [m]. Beyond the ends the profile continues straight.
    #[must_use]
    pub fn height(&self, y: f64) -> f64 {
        self.0.at(y)[0]
    }

    /// Slope dz/dy at y [-].
    #[must_use]
    pub fn slope(&self, y: f64) -> f64 {
        self.0.at(y)[1]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn text(count: usize, function: impl Fn(f64) -> f64) -> String {
        let point = |k: usize| {
            let y = k as f64 / (count - 1) as f64;
            format!("{y}, {}\n", function(y))
        };
        format!("# a comment\ny [m], z [m]\n{}", (0..count).map(point).collect::<String>())
    }

    /// The error of the spline is of fourth order in the spacing if the end conditions hold, as for
    /// sin πy.
    #[test]
    fn converges_with_the_fourth_order() {
        let error = |count: usize| {
            let wave = |y: f64| (std::f64::consts::PI * y).sin();
            let profile = Profile::parse(&text(count, wave), 0.0).unwrap();
            let at = |k: usize| (profile.height(k as f64 / 999.0) - wave(k as f64 / 999.0)).abs();
            (0..1000).map(at).fold(0.0, f64::max)
        };
        let (coarse, fine) = (error(11), error(21));
        assert!(fine < 1e-5 && (coarse / fine).log2() > 3.8, "{coarse} {fine}");
    }

    #[test]
    fn units_and_straight_ends() {
        let profile = Profile::parse("y [mm], z [um]\n-1,-2\n0,0\n1,2\n3,6\n", 0.0).unwrap();
        assert_eq!(profile.range(), [-1e-3, 3e-3]);
        for y in [-2e-3, 0.5e-3, 5e-3] {
            assert!((profile.height(y) - 2e-3 * y).abs() < 1e-15);
            assert!((profile.slope(y) - 2e-3).abs() < 1e-12);
        }
    }

    #[test]
    fn faults_name_the_line() {
        let fault = |text: &str| Profile::parse(text, 0.0).unwrap_err();
        let said = |text: &str| fault(text).to_string();
        assert!(said("y, z\n1,2\n").contains("names no unit of column `y`"));
        assert!(said("y [mm], z [inch]\n1,2\n").contains("unknown unit `inch`"));
        assert!(said("y [m], z [m]\n0,1\n#\n1,x\n").contains("column `z` of line 4"));
        assert!(said("y [m], z [m]\n0,1,7\n").contains("3 cells in line 2"));
        assert!(said("y [m], z [m]\n0,1\n1,NaN\n").contains("column `z` of line 3"));
        let order = fault("y [m], z [m]\n0,1\n1,2\n1,3\n2,4\n");
        assert!(matches!(order, ProfileError::Order { point: 3, .. }), "{order}");
        assert!(matches!(fault("y [m], z [m]\n0,1\n"), ProfileError::Few(1)));
        let nowhere = Profile::read(Path::new("nowhere.csv"), Body::Rail, None, 0.0);
        assert!(matches!(nowhere, Err(ProfileError::File(_))));
    }

    /// All layouts that the model wheel-on-track reads.
    #[test]
    fn order_header_and_separators_are_free() {
        let rising = Profile::parse("y [m], z [m]\n0,1\n1,2\n2,1\n3,0\n", 0.0).unwrap();
        for text in [
            "z [m]; y [m]\n0; 3\n1; 2\n2; 1\n1,0; 0\n",
            "\u{feff}y,z\r\nm,m\r\n0,1\r\n1,2\r\n2,1\r\n3,0\r\n",
            "3000 0\n2000 1000\n1000 2000\n0 1000\n",
        ] {
            let text = input_file::into_text(text.as_bytes().to_vec()).unwrap();
            assert_eq!(Profile::parse(&text, 0.0).unwrap(), rising, "{text}");
        }
    }

    proptest! {
        /// Any text gives a profile or an error.
        #[test]
        fn any_text(text in "[-0-9eEyzm.,; \\[\\]\t\n]{0,200}") {
            let _ = Profile::parse(&text, 0.0);
        }

        #[test]
        fn any_points(values in prop::collection::vec((-1e3f64..1e3, -1e3f64..1e3), 0..20)) {
            let lines: String = values.iter().map(|(y, z)| format!("{y},{z}\n")).collect();
            let text = format!("y [mm], z [mm]\n{lines}");
            for tolerance in [0.0, 1e-3] {
                if let Ok(profile) = Profile::parse(&text, tolerance) {
                    let [first, last] = profile.range();
                    prop_assert!(profile.height(0.5 * (first + last)).is_finite());
                }
            }
        }
    }
}
