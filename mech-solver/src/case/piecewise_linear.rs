//! Values over a coordinate such as temperature, from a table ([`proto::table`]) with linear
//! interpolation.

use proto::bodies::ABSOLUTE;
use proto::table::{Column, Reading, Table};
use std::path::Path;

/// Largest size of a file [byte].
const MOST_BYTES: u64 = 1 << 24;

/// Column of absolute temperatures.
pub(crate) fn absolute_temperature() -> Column {
    Column::new(&["temperature", "T"], "K").expected(100.0..=3000.0, ABSOLUTE)
}

/// Tables of `N` values at rising coordinates.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct PiecewiseLinear<const N: usize> {
    points: Vec<(f64, [f64; N])>,
    /// True if the first and the last values hold beyond the ends.
    clamps: bool,
}

impl<const N: usize> PiecewiseLinear<N> {
    /// Reads a file with a table of `columns`: the coordinate, and `N` values. `check` refuses
    /// values of a row.
    ///
    /// # Errors
    /// A file or a table that is unusable; the text names the line.
    pub(crate) fn read(
        path: &Path,
        columns: &[Column],
        clamps: bool,
        check: impl Fn(&[f64; N]) -> Result<(), String>,
    ) -> Result<Self, String> {
        let table = Table::read(path, MOST_BYTES, Reading::NUMBERS);
        Self::from_table(&table.map_err(|error| error.to_string())?, columns, clamps, check)
    }

    /// Reads the columns of a table, as [`PiecewiseLinear::read`] does.
    ///
    /// # Errors
    /// A table that is unusable; the text names the line.
    pub(crate) fn from_table(
        table: &Table,
        columns: &[Column],
        clamps: bool,
        check: impl Fn(&[f64; N]) -> Result<(), String>,
    ) -> Result<Self, String> {
        let found = table.columns(columns).map_err(|error| error.to_string())?;
        let name = &columns[0].names[0];
        table.check_rising(name, &found[0], false).map_err(|error| error.to_string())?;
        let point = |row: usize| {
            let values = std::array::from_fn(|k| found[k + 1][row]);
            check(&values).map_err(|reason| format!("{reason} in line {}", table.line(row)))?;
            Ok((found[0][row], values))
        };
        Ok(Self { points: (0..table.rows()).map(point).collect::<Result<_, String>>()?, clamps })
    }

    /// Coordinates of the rows.
    pub(crate) fn coordinates(&self) -> impl Iterator<Item = f64> {
        self.points.iter().map(|(at, _)| *at)
    }

    /// Returns true if no value rises with the coordinate.
    pub(crate) fn falls(&self) -> bool {
        let falls = |low: &[f64; N], high: &[f64; N]| low.iter().zip(high).all(|(a, b)| a >= b);
        self.points.windows(2).all(|pair| falls(&pair[0].1, &pair[1].1))
    }

    /// Returns the values at a coordinate; `None` beyond the rows unless the ends are clamped.
    pub(crate) fn at(&self, coordinate: f64) -> Option<[f64; N]> {
        let Self { points, clamps } = self;
        let right = points.partition_point(|(at, _)| *at <= coordinate);
        let (first, last) = (points[0], points[points.len() - 1]);
        if coordinate == last.0 {
            return Some(last.1);
        }
        match right {
            0 => clamps.then_some(first.1),
            _ if right == points.len() => clamps.then_some(last.1),
            _ => {
                let ((start, low), (end, high)) = (points[right - 1], points[right]);
                let between =
                    |k: usize| low[k] + (high[k] - low[k]) * (coordinate - start) / (end - start);
                Some(std::array::from_fn(between))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn curve<const N: usize>(text: &str, clamps: bool) -> Result<PiecewiseLinear<N>, String> {
        let positive = |values: &[f64; N]| match values.iter().all(|value| *value > 0.0) {
            true => Ok(()),
            false => Err("has no value above 0".to_owned()),
        };
        let table =
            Table::parse(text.to_owned(), Reading::NUMBERS).map_err(|error| error.to_string())?;
        let columns =
            [Column::new(&["T"], "K"), Column::new(&["f"], "1"), Column::new(&["g"], "1")];
        PiecewiseLinear::from_table(&table, &columns[..=N], clamps, positive)
    }

    #[test]
    fn rows_and_ends() {
        let of = |clamps| curve("# rise, f\n0, 0.5\n100, 0.3\n200,0.2 # hot\n", clamps).unwrap();
        assert_eq!(of(false).at(50.0), Some([0.4]));
        assert_eq!(of(false).at(200.0), Some([0.2]));
        assert_eq!((of(false).at(201.0), of(false).at(-1.0)), (None, None));
        assert_eq!((of(true).at(1e9), of(true).at(-1.0)), (Some([0.2]), Some([0.5])));
        let two: PiecewiseLinear<2> = curve("0 1 1\n10 0.5 0.25\n", false).unwrap();
        assert_eq!(two.at(5.0), Some([0.75, 0.625]));
        let named: PiecewiseLinear<1> =
            curve("f; T [°C]\n0,5; -273,15\n0,25; 26,85\n", false).unwrap();
        assert_eq!(named.at(150.0), Some([0.375]));
        for (text, part) in [
            ("", "no rows"),
            ("1,2\n1,2", "from line 1 to line 2"),
            ("1", "1 columns and no header"),
            ("0,0", "above 0 in line 1"),
        ] {
            let error = curve::<1>(text, false).unwrap_err();
            assert!(error.contains(part), "{text}: {error}");
        }
    }

    proptest! {
        /// Any text is either read or refused, without a panic.
        #[test]
        fn any_text_is_read_or_refused(text in "[-0-9eEinfa.,; #\n]{0,200}") {
            if let Ok(curve) = curve::<1>(&text, false) {
                prop_assert!(curve.points.windows(2).all(|pair| pair[0].0 < pair[1].0));
            }
        }
    }
}
