//! Which points a sweep has: all combinations of values, values side by side, or the rows of a table.

use crate::study::axis::{Axis, points};
use clap::Args;
use run::error::{RunError, file_failure};
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// The options.
#[derive(Debug, Args)]
pub(super) struct Asked {
    /// What varies: a key, and its values or a range; several make a grid.
    #[arg(long, value_name = "KEY=A,B,C|FROM..TO/COUNT", value_parser = Axis::read)]
    #[arg(required_unless_present = "table", conflicts_with = "table")]
    vary: Vec<Axis>,
    /// No grid: the first values of all keys, the second ones, and so on.
    #[arg(long, requires = "vary")]
    paired: bool,
    /// No grid, a Latin hypercube: each value of each key once, in an order that this seed gives.
    #[arg(long, value_name = "SEED", requires = "vary", conflicts_with = "paired")]
    latin: Option<u64>,
    /// No grid, the rows of a CSV file: keys in its first line, values below them.
    #[arg(long, value_name = "FILE")]
    table: Option<PathBuf>,
}

/// The keys with their values, and how they are combined.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Design {
    /// Keys and values.
    pub vary: Vec<Axis>,
    /// The n-th values of all keys are a point; otherwise all combinations are.
    pub paired: bool,
}

impl Asked {
    /// What is asked for.
    ///
    /// # Errors
    /// A table that cannot be read, or lists that are not equally long where they have to be.
    pub(super) fn design(&self) -> Result<Design, RunError> {
        let (mut vary, paired) = match &self.table {
            Some(file) => (read(file)?, true),
            None => (self.vary.clone(), self.paired || self.latin.is_some()),
        };
        let length = |one: &Axis| one.values.len();
        if let Some(other) = vary.iter().find(|one| paired && length(one) != length(&vary[0])) {
            return Err(RunError::Usage(format!(
                "--vary {} has {} values, and {} has {}; side by side all keys have as many",
                other.key,
                length(other),
                vary[0].key,
                length(&vary[0])
            )));
        }
        if let Some(seed) = self.latin {
            let mut random = fastrand::Rng::with_seed(seed);
            vary.iter_mut().skip(1).for_each(|one| random.shuffle(&mut one.values));
        }
        Ok(Design { vary, paired })
    }
}

/// One of so many parts of a sweep: every so many points, from this one on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Part {
    /// Which part, from 1 on.
    pub one: usize,
    /// How many there are.
    pub of: usize,
}

impl Part {
    /// Reads `3/8`.
    ///
    /// # Errors
    /// Says what is wrong with the text.
    pub(super) fn read(text: &str) -> Result<Self, String> {
        let wrong = || format!("`{text}` is no part; write 3/8 for the third of eight");
        let (one, of) = text.split_once('/').ok_or_else(wrong)?;
        let number = |text: &str| text.trim().parse::<usize>().map_err(|_| wrong());
        let part = Self { one: number(one)?, of: number(of)? };
        if (1..=part.of).contains(&part.one) { Ok(part) } else { Err(wrong()) }
    }

    /// The point of this number, from 0 on, is in it.
    fn has(self, n: usize) -> bool {
        n % self.of == self.one - 1
    }
}

/// The points, or those of a part: an index into the values of each key.
pub(super) fn points_of(vary: &[Axis], paired: bool, part: Option<Part>) -> Vec<Vec<usize>> {
    let length = vary.first().map_or(0, |one| one.values.len());
    let all: Vec<Vec<usize>> = match paired {
        true => (0..length).map(|n| vec![n; vary.len()]).collect(),
        false => points(vary).collect(),
    };
    let wanted = |(n, _): &(usize, Vec<usize>)| part.is_none_or(|part| part.has(*n));
    all.into_iter().enumerate().filter(wanted).map(|(_, at)| at).collect()
}

/// The columns of a table.
fn read(file: &Path) -> Result<Vec<Axis>, RunError> {
    let wrong = |why: String| RunError::Usage(format!("--table {}: {why}", file.display()));
    let text = std::fs::read(file).map_err(|error| file_failure(file, &error))?;
    let mut reader = csv::ReaderBuilder::new()
        .trim(csv::Trim::All)
        .comment(Some(b'#'))
        .from_reader(text.as_slice());
    let head = reader.headers().map_err(|error| wrong(error.to_string()))?.clone();
    let mut vary: Vec<Axis> =
        head.iter().map(|key| Axis { key: key.to_owned(), values: Vec::new() }).collect();
    for row in reader.records() {
        let row = row.map_err(|error| wrong(error.to_string()))?;
        for (one, value) in vary.iter_mut().zip(&row) {
            if value.is_empty() {
                let line = row.position().map_or(0, csv::Position::line);
                return Err(wrong(format!("line {line} has no value for `{}`", one.key)));
            }
            one.values.push(value.to_owned());
        }
    }
    if vary.iter().any(|one| one.key.is_empty()) {
        return Err(wrong("a column has no key in the first line".to_owned()));
    }
    if vary.first().is_none_or(|one| one.values.is_empty()) {
        return Err(wrong("it has no rows below its first line of keys".to_owned()));
    }
    Ok(vary)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn asked(vary: &[&str]) -> Asked {
        let vary = vary.iter().map(|text| Axis::read(text).unwrap()).collect();
        Asked { vary, paired: false, latin: None, table: None }
    }

    #[test]
    fn side_by_side_there_are_as_many_points_as_values() {
        let grid = asked(&["a=1,2,3", "b=4,5,6"]).design().unwrap();
        assert_eq!(points_of(&grid.vary, grid.paired, None).len(), 9);
        let paired = Asked { paired: true, ..asked(&["a=1,2,3", "b=4,5,6"]) }.design().unwrap();
        assert_eq!(points_of(&paired.vary, paired.paired, None), [[0, 0], [1, 1], [2, 2]]);
        let uneven = Asked { paired: true, ..asked(&["a=1,2,3", "b=4,5"]) }.design();
        assert!(uneven.unwrap_err().to_string().contains("--vary b has 2 values, and a has 3"));
    }

    /// Every point is in one part.
    #[test]
    fn parts_are_the_whole() {
        let Design { vary, paired } = asked(&["a=1,2,3", "b=4,5,6"]).design().unwrap();
        let part = |one| points_of(&vary, paired, Some(Part { one, of: 4 }));
        assert_eq!(part(1), [[0, 0], [1, 1], [2, 2]]);
        let mut all: Vec<_> = (1..=4).flat_map(part).collect();
        all.sort();
        assert_eq!(all, points_of(&vary, paired, None));
        assert_eq!(Part::read("3/8"), Ok(Part { one: 3, of: 8 }));
        for wrong in ["", "3", "0/8", "9/8", "1/0", "a/b", "-1/2"] {
            assert!(Part::read(wrong).unwrap_err().contains("write 3/8"), "{wrong}");
        }
    }

    /// Each value once; the same seed gives the same order, another one another.
    #[test]
    fn a_latin_hypercube_has_each_value_once() {
        let of = |seed| Asked { latin: Some(seed), ..asked(&["a=0..9/10", "b=0..9/10"]) }.design();
        let [one, same, other] = [1, 1, 2].map(|seed| of(seed).unwrap());
        assert_eq!(one, same);
        assert_ne!(one.vary[1], other.vary[1]);
        let mut values = one.vary[1].values.clone();
        assert_ne!(values, one.vary[0].values);
        values.sort();
        assert_eq!(values, one.vary[0].values);
    }

    #[test]
    fn a_table_has_a_point_a_row() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("points.csv");
        let read = |text: &str| {
            std::fs::write(&file, text).unwrap();
            read(&file).map_err(|error| error.to_string())
        };
        let vary =
            read("motion.speed, load.normal_force\n# two\n20, 60 kN\n30,\"[1, 2]\"\n").unwrap();
        assert_eq!(vary[0].values, ["20", "30"]);
        assert_eq!(vary[1].values, ["60 kN", "[1, 2]"]);
        for (text, why) in [
            ("a,b\n1\n", "with 1 fields"),
            ("a,b\n1,\n", "line 2 has no value for `b`"),
            ("a,\n1,2\n", "no key"),
            ("a,b\n", "no rows"),
            ("", "no rows"),
        ] {
            let error = read(text).unwrap_err();
            assert!(error.contains(why), "{text}: {error}");
        }
    }
}
