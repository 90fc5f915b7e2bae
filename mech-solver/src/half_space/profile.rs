//! A measured lateral profile: heights over the lateral coordinate, from a file.
//!
//! The file is text with a header that names the columns y and z with their units, then one point a
//! line with y rising; `#` begins a comment:
//!
//! ```text
//! # rail 3, km 12.4, left
//! y [mm], z [mm]
//! -36.0, -4.12
//! -35.5, -3.87
//! ```
//!
//! y points to the left and z up, as everywhere. Between the points lie natural cubic splines, whose
//! curvature is continuous, as a contact needs it, and which end at kinks ([`super::curve`]).

use super::curve::Curve;
use std::path::Path;

/// Fewest points of a profile.
const FEWEST: usize = 4;
/// Larger files are refused.
const MOST_BYTES: u64 = 64 << 20;

/// A lateral profile z(y).
#[derive(Clone, Debug, PartialEq)]
pub struct Profile(Curve);

/// Why a profile cannot be used.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ProfileError {
    /// The file cannot be read.
    #[error("cannot be read: {0}")]
    File(String),
    /// The header is not `y [unit], z [unit]`.
    #[error("its header is not two columns `y [mm], z [mm]`, but {0:?}")]
    Header(String),
    /// A line is not two finite numbers.
    #[error("line {line} is not two finite numbers")]
    Line {
        /// Number of the line, from 1.
        line: u64,
    },
    /// The lateral coordinates do not rise.
    #[error("y does not rise at line {line}")]
    Order {
        /// Number of the line, from 1.
        line: u64,
    },
    /// Too few points.
    #[error("it has {0} points, and a spline needs {FEWEST}")]
    Few(usize),
}

impl Profile {
    /// Reads a file, and smooths it by no more than `tolerance` [m] at any point.
    ///
    /// # Errors
    /// The file cannot be read, is too large, or is not a profile.
    pub fn read(path: &Path, tolerance: f64) -> Result<Self, ProfileError> {
        let file_error = |error: std::io::Error| ProfileError::File(error.to_string());
        let bytes = std::fs::metadata(path).map_err(file_error)?.len();
        if bytes > MOST_BYTES {
            return Err(ProfileError::File(format!("it has {bytes} bytes")));
        }
        Self::parse(&std::fs::read(path).map_err(file_error)?, tolerance)
    }

    /// Reads the text of a file, and smooths as [`Profile::read`] does.
    ///
    /// # Errors
    /// It is not a profile.
    pub fn parse(text: &[u8], tolerance: f64) -> Result<Self, ProfileError> {
        let text = std::str::from_utf8(text)
            .map_err(|error| ProfileError::File(format!("is not text: {error}")))?;
        let lines = text
            .lines()
            .zip(1..)
            .map(|(line, number)| (line.split('#').next().unwrap_or_default().trim(), number));
        let mut lines = lines.filter(|(line, _)| !line.is_empty());
        let units = units(lines.next().map_or("", |(line, _)| line))?;
        let (mut y, mut z) = (Vec::<f64>::new(), Vec::new());
        for (text, line) in lines {
            let [at, height] = point(text, units).ok_or(ProfileError::Line { line })?;
            if y.last().is_some_and(|last| at <= *last) {
                return Err(ProfileError::Order { line });
            }
            y.push(at);
            z.push(height);
        }
        if y.len() < FEWEST {
            return Err(ProfileError::Few(y.len()));
        }
        Ok(Self(Curve::new(y, z, tolerance)))
    }

    /// The curve through the points.
    #[must_use]
    pub fn curve(&self) -> &Curve {
        &self.0
    }

    /// The first and the last lateral coordinate [m].
    #[must_use]
    pub fn range(&self) -> [f64; 2] {
        self.0.range()
    }

    /// Height at y [m]; beyond the ends the straight continuation.
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

/// Metres in the units of both columns.
fn units(header: &str) -> Result<[f64; 2], ProfileError> {
    let unit = |column: Option<&str>, name: &str| {
        let text = column?.trim().strip_prefix(name)?.trim();
        match text.strip_prefix('[')?.strip_suffix(']')?.trim() {
            "m" => Some(1.0),
            "mm" => Some(1e-3),
            "um" | "µm" => Some(1e-6),
            _ => None,
        }
    };
    let mut columns = header.split(',');
    match (unit(columns.next(), "y"), unit(columns.next(), "z"), columns.next()) {
        (Some(y), Some(z), None) => Ok([y, z]),
        _ => Err(ProfileError::Header(header.chars().take(80).collect())),
    }
}

/// The two numbers of a line [m].
fn point(text: &str, units: [f64; 2]) -> Option<[f64; 2]> {
    let mut columns = text.split(',');
    let (y, z) = (columns.next()?, columns.next()?);
    let number = |text: &str| text.trim().parse::<f64>().ok();
    let point = [number(y)? * units[0], number(z)? * units[1]];
    let good = columns.next().is_none() && point.iter().all(|value| value.is_finite());
    good.then_some(point)
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

    /// A spline errs by the fourth power of the spacing where the end conditions hold, here sin πy.
    #[test]
    fn converges_with_the_fourth_order() {
        let error = |count: usize| {
            let wave = |y: f64| (std::f64::consts::PI * y).sin();
            let profile = Profile::parse(text(count, wave).as_bytes(), 0.0).unwrap();
            let at = |k: usize| (profile.height(k as f64 / 999.0) - wave(k as f64 / 999.0)).abs();
            (0..1000).map(at).fold(0.0, f64::max)
        };
        let (coarse, fine) = (error(11), error(21));
        assert!(fine < 1e-5 && (coarse / fine).log2() > 3.8, "{coarse} {fine}");
    }

    #[test]
    fn units_and_straight_ends() {
        let profile = Profile::parse(b"y [mm], z [um]\n-1,-2\n0,0\n1,2\n3,6\n", 0.0).unwrap();
        assert_eq!(profile.range(), [-1e-3, 3e-3]);
        for y in [-2e-3, 0.5e-3, 5e-3] {
            assert!((profile.height(y) - 2e-3 * y).abs() < 1e-15);
            assert!((profile.slope(y) - 2e-3).abs() < 1e-12);
        }
    }

    #[test]
    fn faults_name_the_line() {
        let fault = |text: &str| Profile::parse(text.as_bytes(), 0.0).unwrap_err();
        assert!(matches!(fault("y, z\n1,2\n"), ProfileError::Header(_)));
        assert!(matches!(fault("y [mm], z [inch]\n1,2\n"), ProfileError::Header(_)));
        assert_eq!(fault("y [m], z [m]\n0,1\n#\n1,x\n"), ProfileError::Line { line: 4 });
        assert_eq!(fault("y [m], z [m]\n0,1,7\n"), ProfileError::Line { line: 2 });
        assert_eq!(fault("y [m], z [m]\n0,1\n0,2\n"), ProfileError::Order { line: 3 });
        assert_eq!(fault("y [m], z [m]\n0,1\n1,NaN\n"), ProfileError::Line { line: 3 });
        assert_eq!(fault("y [m], z [m]\n0,1\n"), ProfileError::Few(1));
        assert!(matches!(Profile::read(Path::new("nowhere.csv"), 0.0), Err(ProfileError::File(_))));
    }

    proptest! {
        /// Whatever the bytes, there is an answer, and a profile that was read is finite.
        #[test]
        fn any_bytes(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
            let _ = Profile::parse(&bytes, 0.0);
        }

        #[test]
        fn any_points(values in prop::collection::vec((-1e3f64..1e3, -1e3f64..1e3), 0..20)) {
            let lines: String = values.iter().map(|(y, z)| format!("{y},{z}\n")).collect();
            let text = format!("y [mm], z [mm]\n{lines}");
            for tolerance in [0.0, 1e-3] {
                if let Ok(profile) = Profile::parse(text.as_bytes(), tolerance) {
                    let [first, last] = profile.range();
                    prop_assert!(profile.height(0.5 * (first + last)).is_finite());
                }
            }
        }
    }
}
