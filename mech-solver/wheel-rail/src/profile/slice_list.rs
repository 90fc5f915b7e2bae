//! Files that name profiles at positions: CONTACT's slices, `.slcs` for rails and `.slcw` for
//! wheels, and columns, `.slices`.
//!
//! **Columns** are a table ([`tables::table`]) of positions and file names of profiles, relative to
//! the folder of the table. The surface passes near these profiles. Positions are in m along the
//! track or in rad round the wheel, or in the unit of a header:
//!
//! ```text
//! position [mm], profile
//! 0, new.prr
//! 400, worn.prr
//! ```
//!
//! **CONTACT's files** hold, each on its own line: offset and scale of the positions, in mm or rad
//! per unit; the number of slices; the numbers of features, kinks and accelerations; the
//! interpolation, 1 through the slices and 2 near them; then a position and a quoted name for every
//! slice. Further text behind the values on a line is ignored, and comments begin with `%` or `!`.
//! Kinks and accelerations are skipped. With two features or more, a line for every slice follows.
//! It holds the position and the distance of each feature along the tape [mm], counted from the
//! first point: on the side of the track's middle for a rail, on the field side for a wheel.
//! Perturbations are refused, and so are features that a slice lacks (negative values).
//!
//! Source: Vollebregt, *User guide for CONTACT* (2025) ch. 3 and appendix, slices-file.

use super::error::ProfileError;
use super::orientation::Body;
use super::text::{decoded, lines};
use crate::slices::Along;
use std::borrow::Cow;
use std::path::Path;
use tables::table::{Column, Reading, Table, TableError};

/// Most slices in a file.
const MOST_SLICES: usize = 10_000;
/// Most features of a slice.
const MOST_FEATURES: usize = 999;
/// Relative tolerance within which the positions of features and slices are equal.
const SAME: f64 = 1e-6;

/// Format of a file that names profiles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SliceFormat {
    /// CONTACT's, `.slcs` and `.slcw`.
    Contact,
    /// Columns, `.slices`.
    Columns,
}

impl SliceFormat {
    /// Format by the extension of the file name; `None` for a profile.
    #[must_use]
    pub fn of(path: &Path) -> Option<Self> {
        let ending = path.extension().map(|ending| ending.to_string_lossy().to_ascii_lowercase());
        match ending.as_deref() {
            Some("slcs" | "slcw") => Some(Self::Contact),
            Some("slices") => Some(Self::Columns),
            _ => None,
        }
    }
}

/// Profile named at a position.
#[derive(Clone, Debug, PartialEq)]
pub struct NamedProfile {
    /// Position along the track [m] or round the wheel [rad].
    pub at: f64,
    /// Name of the file.
    pub file: String,
    /// Distances of the features along the tape, from the first point in the file's order [m].
    pub features: Vec<f64>,
}

/// Profiles at their positions, as named in a file.
#[derive(Clone, Debug, PartialEq)]
pub struct SliceList {
    /// The profiles.
    pub slices: Vec<NamedProfile>,
    /// Course of the surface along the profiles.
    pub along: Along,
}

/// Reads the profiles that a file names.
///
/// # Errors
/// Fails if a line does not match the format, or if the file uses perturbations or incomplete
/// features.
pub fn read_slices(
    text: &[u8],
    format: SliceFormat,
    body: Body,
) -> Result<SliceList, ProfileError> {
    let text = decoded(text)?;
    match format {
        SliceFormat::Contact => Groups { lines: lines(&text, &['!', '%']), line: 0 }.list(body),
        SliceFormat::Columns => columns(text, body),
    }
}

/// Reads rows of a position and a name.
fn columns(text: String, body: Body) -> Result<SliceList, ProfileError> {
    let wrong = |error: TableError| ProfileError::Table(error.to_string());
    let table = Table::parse(text, Reading::NUMBERS).map_err(wrong)?;
    let unit = if body == Body::Rail { "m" } else { "rad" };
    let columns = [Column::new(&["position"], unit), Column::new(&["profile"], "1")];
    let names = table.words_of(&columns, 1).map_err(wrong)?;
    let positions = table.numbers_of(&columns, 0).map_err(wrong)?;
    if table.rows() > MOST_SLICES {
        return Err(many(table.line(MOST_SLICES)));
    }
    let slice = |(row, (at, name)): (usize, (&f64, &Cow<'_, str>))| {
        named(table.line(row), *at, name.trim_matches('\''))
    };
    let slices = positions.iter().zip(&names).enumerate().map(slice);
    Ok(SliceList { slices: slices.collect::<Result<_, _>>()?, along: Along::Near })
}

/// A profile without features.
fn named(line: usize, at: f64, name: &str) -> Result<NamedProfile, ProfileError> {
    let name = name.trim().replace('\\', "/");
    match name.is_empty() {
        true => Err(ProfileError::line(line, "names no profile at its position")),
        false => Ok(NamedProfile { at, file: name, features: Vec::new() }),
    }
}

fn many(line: usize) -> ProfileError {
    ProfileError::line(line, format!("exceeds the limit of {MOST_SLICES} slices"))
}

/// Parses a finite number; Fortran's exponents `d` and `D` are accepted.
fn parsed(line: usize, text: &str) -> Result<f64, ProfileError> {
    let number = text.replace(['d', 'D'], "e").parse::<f64>().ok().filter(|n| n.is_finite());
    number.ok_or_else(|| ProfileError::line(line, "has no number where one is expected"))
}

/// Reader of groups of values, each of which begins on its own line.
struct Groups<I> {
    lines: I,
    /// Number of the last line.
    line: usize,
}

impl<'a, I: Iterator<Item = (usize, &'a str)>> Groups<I> {
    /// Next group of `count` values, and the line where it begins.
    fn group(
        &mut self,
        count: usize,
        what: &'static str,
    ) -> Result<(usize, Vec<&'a str>), ProfileError> {
        let (mut begin, mut values) = (None, Vec::new());
        while values.len() < count {
            let (line, content) = self.lines.next().ok_or(ProfileError::Missing(what))?;
            self.line = line;
            begin.get_or_insert(line);
            values.extend(words(content));
        }
        values.truncate(count);
        Ok((begin.unwrap_or(self.line), values))
    }

    /// Next group of numbers.
    fn numbers(
        &mut self,
        count: usize,
        what: &'static str,
    ) -> Result<(usize, Vec<f64>), ProfileError> {
        let (line, values) = self.group(count, what)?;
        let numbers = values.into_iter().map(|value| parsed(line, value));
        Ok((line, numbers.collect::<Result<_, _>>()?))
    }

    /// Next group of counts.
    fn counts<const N: usize>(
        &mut self,
        most: usize,
        what: &'static str,
    ) -> Result<[usize; N], ProfileError> {
        let (line, numbers) = self.numbers(N, what)?;
        let mut counts = [0; N];
        for (count, number) in counts.iter_mut().zip(numbers) {
            if !(number.fract() == 0.0 && (0.0..=most as f64).contains(&number)) {
                let what =
                    format!("has {number} where a whole number from 0 to {most} is expected");
                return Err(ProfileError::line(line, what));
            }
            *count = number as usize;
        }
        Ok(counts)
    }

    /// Reads a complete file of CONTACT.
    fn list(mut self, body: Body) -> Result<SliceList, ProfileError> {
        let (_, scale) = self.numbers(2, "offset and scale of its positions")?;
        let [count] = self.counts(MOST_SLICES, "number of slices")?;
        let [features, kinks, accelerations] =
            self.counts(MOST_FEATURES, "numbers of features, kinks and accelerations")?;
        let along = self.way()?;
        // Positions are in mm or in rad.
        let unit = if body == Body::Rail { 1e-3 } else { 1.0 };
        let position = |value: f64| unit * scale[1] * (scale[0] + value);
        let mut slices = Vec::new();
        for _ in 0..count {
            let (line, values) =
                self.group(2, "position and name of every slice that it announces")?;
            let at = position(parsed(line, values[0])?);
            slices.push(named(line, at, values[1])?);
        }
        if features > 1 {
            for (count, what) in [(kinks, "kinks"), (accelerations, "accelerations")] {
                self.numbers(count, what)?;
            }
            for slice in &mut slices {
                let (line, values) = self.numbers(features + 1, "features of every slice")?;
                let at = position(values[0]);
                if (at - slice.at).abs() > SAME * slice.at.abs().max(unit) {
                    let what = format!(
                        "has features of the position {}, which differs from that of the next slice",
                        values[0]
                    );
                    return Err(ProfileError::line(line, what));
                }
                if values[1..].iter().any(|feature| *feature < 0.0) {
                    let what = "leaves out features (negative values): interrupted slices are not supported; give each part as a separate rail";
                    return Err(ProfileError::line(line, what));
                }
                slice.features = values[1..].iter().map(|feature| 1e-3 * feature).collect();
            }
        }
        Ok(SliceList { slices, along })
    }

    /// Reads the interpolation along the slices.
    fn way(&mut self) -> Result<Along, ProfileError> {
        let (line, content) =
            self.lines.next().ok_or(ProfileError::Missing("interpolation along the slices"))?;
        let mut values = words(content);
        let way = values.next().unwrap_or_default();
        if values.next().and_then(|value| value.parse::<i64>().ok()).is_some_and(|kind| kind != 0) {
            let what = "asks for perturbations, which are not supported; use the body's key `irregularity`";
            return Err(ProfileError::line(line, what));
        }
        match way {
            "1" => Ok(Along::Through),
            "2" => Ok(Along::Near),
            _ => {
                let what =
                    "has an interpolation other than 1 (through the slices) or 2 (near them)";
                Err(ProfileError::line(line, what))
            }
        }
    }
}

/// Words of a line, separated by blanks and commas, or quoted.
fn words(line: &str) -> impl Iterator<Item = &str> {
    let mut rest = line;
    std::iter::from_fn(move || {
        rest = rest.trim_start_matches(|c: char| c.is_whitespace() || c == ',');
        if let Some(quoted) = rest.strip_prefix('\'') {
            let (word, behind) = quoted.split_once('\'').unwrap_or((quoted, ""));
            rest = behind;
            return Some(word);
        }
        let end = rest.find(|c: char| c.is_whitespace() || c == ',').unwrap_or(rest.len());
        let (word, behind) = rest.split_at(end);
        rest = behind;
        (!word.is_empty()).then_some(word)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn contact(text: &str, body: Body) -> Result<SliceList, ProfileError> {
        read_slices(text.as_bytes(), SliceFormat::Contact, body)
    }

    const RAIL: &str = "% a crossing\n\n 0.5 1000. U_OFFSET, U_SCALE [m]\n 2 NSLC\n 3 1 0 NFEAT, NKINK, NACCEL\n 1 U_INTPOL\n\
        -0.25 'a/one slice.prr' ! first\n 1d0, 'a\\two.prr'\n 1\n -0.25 0. 33.5\n 50\n 1.0 0 34 999\n";

    #[test]
    fn what_contact_writes_is_read() {
        let list = contact(RAIL, Body::Rail).unwrap();
        assert_eq!(list.along, Along::Through);
        let [one, two] = [&list.slices[0], &list.slices[1]];
        assert!((one.at - 0.25).abs() < 1e-15 && (two.at - 1.5).abs() < 1e-15);
        assert_eq!((one.file.as_str(), two.file.as_str()), ("a/one slice.prr", "a/two.prr"));
        assert!(
            (one.features[1] - 33.5e-3).abs() < 1e-15 && (two.features[2] - 0.999).abs() < 1e-15
        );
        let wheel = "0 0.0174533\n2\n0 0 0\n2\n-10 'x'\n10 'y'\n";
        let list = contact(wheel, Body::Wheel).unwrap();
        assert!((list.slices[1].at - 0.174533).abs() < 1e-12 && list.along == Along::Near);
        assert!(list.slices[0].features.is_empty());
    }

    #[test]
    fn columns_name_profiles_at_positions() {
        let of = |text: &str, body| read_slices(text.as_bytes(), SliceFormat::Columns, body);
        let list = of("# worn\nposition [mm], profile\n0, new.csv\n400, worn 2.csv\n", Body::Rail)
            .unwrap();
        assert_eq!(list.slices[1], named(4, 0.4, "worn 2.csv").unwrap());
        let list = of("profile, position [deg]\n\"a, b.prw\", 90\n", Body::Wheel).unwrap();
        assert_eq!(list.slices[0].file, "a, b.prw");
        assert!((list.slices[0].at - std::f64::consts::FRAC_PI_2).abs() < 1e-15);
        let list = of("0 a.prw\n0.1\t\"b.prw\"\n", Body::Wheel).unwrap();
        assert_eq!((list.slices[1].at, list.slices[1].file.as_str()), (0.1, "b.prw"));
        for (text, what) in [
            ("position [deg], profile\n0, a\n", "column `position` of line 1"),
            ("0 a\nx b\n", "no number in column 1 of line 2"),
            ("0\n", "1 columns and no header"),
            ("0 \"\"\n", "line 1 names no profile"),
        ] {
            let error = of(text, Body::Rail).unwrap_err().to_string();
            assert!(error.contains(what), "{error}");
        }
    }

    #[test]
    fn errors_name_the_line_and_what_would_do() {
        for (from, to, what) in [
            (" 2 NSLC", " 2.5", "line 4 has 2.5 where a whole number from 0 to 10000"),
            (" 2 NSLC", " 3", "line 12 has features of the position 1,"),
            (" 1 U_INTPOL", " 3 U_INTPOL", "line 6 has an interpolation other than"),
            (" 1 U_INTPOL", " 1 2", "perturbations, which are not supported"),
            (" 34 999", " -1 999", "line 12 leaves out features"),
            (" 34 999", "", "no features of every slice"),
            ("\n 1.0 0", "\n 1.1 0", "line 12 has features of the position 1.1"),
            ("1000.", "x", "line 3 has no number"),
        ] {
            let text = RAIL.replacen(from, to, 1);
            let error = contact(&text, Body::Rail).unwrap_err().to_string();
            assert!(error.contains(what), "{error}");
        }
        assert_eq!(SliceFormat::of(Path::new("a.SLCW")), Some(SliceFormat::Contact));
        assert_eq!(SliceFormat::of(Path::new("a.slices")), Some(SliceFormat::Columns));
        assert_eq!(SliceFormat::of(Path::new("a.csv")), None);
    }

    proptest! {
        #[test]
        fn no_bytes_panic(bytes in prop::collection::vec(any::<u8>(), 0..300), contact: bool, wheel: bool) {
            let format = if contact { SliceFormat::Contact } else { SliceFormat::Columns };
            let body = if wheel { Body::Wheel } else { Body::Rail };
            let _ = read_slices(&bytes, format, body);
        }

        /// Words of the format in any order.
        #[test]
        fn no_words_panic(words in prop::collection::vec(0..12_usize, 0..40), wheel: bool) {
            let known = ["0", "1", "2", "1e308", "-1", "'a b'", "'", "%", "\n", "\n", "0.5", "nan"];
            let text: Vec<&str> = words.iter().map(|word| known[*word]).collect();
            let body = if wheel { Body::Wheel } else { Body::Rail };
            let _ = read_slices(text.join(" ").as_bytes(), SliceFormat::Contact, body);
        }
    }
}
