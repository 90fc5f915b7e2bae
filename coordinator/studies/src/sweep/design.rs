//! Points of a sweep: all combinations of values, paired values, or the rows of a table.

use crate::study::axis::{Axis, combination, combinations};
use clap::Args;
use contract::table::{Reading, Table, TableError};
use run::error::{RunError, input_failure};
use serde::{Deserialize, Serialize};
use std::iter::StepBy;
use std::ops::Range;
use std::path::{Path, PathBuf};

/// Size above which a table is refused [byte].
const MOST_BYTES: u64 = 1 << 28;

/// Options that define the points.
#[derive(Debug, Args)]
pub(super) struct PointArguments {
    /// Key to vary, with its values or a range; repeat the option for a grid.
    #[arg(long, value_name = "KEY=A,B,C|FROM..TO/COUNT", value_parser = Varied::read)]
    #[arg(required_unless_present = "table", conflicts_with = "table")]
    vary: Vec<Varied>,
    /// Pair the values instead of a grid: the first values of all keys, then the second ones, and
    /// so on.
    #[arg(long, requires = "vary")]
    paired: bool,
    /// Use a Latin hypercube instead of a grid: each value of each key once, shuffled with this
    /// seed.
    #[arg(long, value_name = "SEED", requires = "vary", conflicts_with = "paired")]
    latin: Option<u64>,
    /// Use the rows of a CSV file instead of a grid: keys in the first line, values below.
    #[arg(long, value_name = "FILE")]
    table: Option<PathBuf>,
}

/// One `--vary` option, as text and parsed.
#[derive(Clone, Debug)]
struct Varied {
    text: String,
    axis: Axis,
}

impl Varied {
    fn read(text: &str) -> Result<Self, String> {
        Ok(Self { text: text.to_owned(), axis: Axis::read(text)? })
    }
}

/// Keys, their values and the way to combine them.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Design {
    /// Keys and values.
    pub vary: Vec<Axis>,
    /// Whether point n takes the n-th value of every key; otherwise the points are all
    /// combinations.
    pub paired: bool,
}

impl PointArguments {
    /// Builds the design from the options.
    ///
    /// # Errors
    /// A table cannot be read, or paired lists differ in length.
    pub(super) fn design(&self) -> Result<Design, RunError> {
        let (mut vary, paired) = match &self.table {
            Some(file) => (read(file)?, true),
            None => {
                let vary = self.vary.iter().map(|one| one.axis.clone()).collect();
                (vary, self.paired || self.latin.is_some())
            }
        };
        let length = |one: &Axis| one.values.len();
        if let Some(other) = vary.iter().find(|one| paired && length(one) != length(&vary[0])) {
            return Err(RunError::Usage(format!(
                "--vary {} has {} values, and {} has {}; paired keys need the same number of \
                 values",
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

    /// Options that reproduce this selection.
    pub(super) fn options(&self) -> Vec<String> {
        let vary = self.vary.iter().flat_map(|one| ["--vary".to_owned(), one.text.clone()]);
        let table =
            self.table.iter().map(|file| ["--table".to_owned(), file.display().to_string()]);
        let latin = self.latin.map(|seed| ["--latin".to_owned(), seed.to_string()]);
        let paired = self.paired.then(|| "--paired".to_owned());
        vary.chain(table.chain(latin).flatten()).chain(paired).collect()
    }
}

/// One part of a sweep: every `of`-th point, starting at point `one`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Part {
    /// Number of the part, counted from 1.
    pub one: usize,
    /// Number of parts.
    pub of: usize,
}

impl Part {
    /// Parses text such as `3/8`.
    ///
    /// # Errors
    /// The text has another form, or the number of the part is out of range.
    pub(super) fn read(text: &str) -> Result<Self, String> {
        let wrong = || format!("`{text}` is not a part; write 3/8 for the third of eight");
        let (one, of) = text.split_once('/').ok_or_else(wrong)?;
        let number = |text: &str| text.trim().parse::<usize>().map_err(|_| wrong());
        let part = Self { one: number(one)?, of: number(of)? };
        if (1..=part.of).contains(&part.one) { Ok(part) } else { Err(wrong()) }
    }

    /// Name of the part, usable as a file name.
    pub(super) fn name(self) -> String {
        format!("{}-of-{}", self.one, self.of)
    }

    /// Part, counted from 1, that contains a point, counted from 0.
    pub(super) fn with(number: usize, of: usize) -> usize {
        number % of + 1
    }

    /// Numbers of the part's points, for a sweep of `points` points.
    pub(super) fn numbers(self, points: usize) -> StepBy<Range<usize>> {
        (self.one - 1..points).step_by(self.of)
    }
}

impl Design {
    /// Number of points.
    pub(super) fn count(vary: &[Axis], paired: bool) -> usize {
        match paired {
            true => vary.first().map_or(0, |one| one.values.len()),
            false => combinations(vary),
        }
    }

    /// Point with this number, counted from 0, as an index into the values of each key.
    pub(super) fn point(vary: &[Axis], paired: bool, number: usize) -> Vec<usize> {
        if paired { vec![number; vary.len()] } else { combination(vary, number) }
    }

    /// Number of a point; `None` if the point does not exist.
    pub(super) fn number(vary: &[Axis], paired: bool, at: &[usize]) -> Option<usize> {
        let inside =
            at.len() == vary.len() && at.iter().zip(vary).all(|(n, one)| *n < one.values.len());
        match paired {
            _ if !inside => None,
            true => at.first().copied().filter(|first| at.iter().all(|other| other == first)),
            false => Some(at.iter().zip(vary).fold(0, |all, (n, one)| all * one.values.len() + n)),
        }
    }
}

/// Reads the columns of a table. Each cell of the first line holds a key, optionally with the unit
/// of the numbers below.
fn read(file: &Path) -> Result<Vec<Axis>, RunError> {
    let wrong = |why: String| RunError::Usage(format!("--table {}: {why}", file.display()));
    let table = Table::read(file, MOST_BYTES, Reading::WORDS).map_err(|error| match error {
        TableError::File(error) => input_failure(file, &error),
        error => wrong(error.to_string()),
    })?;
    let headings = table.headings().unwrap_or_default();
    let empty = |place: usize| {
        let mut rows = 0..table.rows();
        rows.all(|row| table.words(row).nth(place).is_none_or(|word| word.is_empty()))
    };
    let mut vary: Vec<Axis> = Vec::new();
    for (place, heading) in headings.iter().enumerate() {
        if heading.name.is_empty() && empty(place) {
            continue;
        }
        // The contents of a file that is not a table of points may be secret, so they are not
        // quoted.
        if !heading.is_dotted_key() {
            return Err(wrong(format!(
                "the first line of column {} is not a key of a case",
                place + 1
            )));
        }
        // A table of numbers from elsewhere must not start programs.
        if heading.name.ends_with(".command") {
            let key = &heading.name;
            return Err(wrong(format!(
                "column `{key}` names programs to start; write it into the case, or set it with \
                 --set {key}=…"
            )));
        }
        if vary.iter().any(|one| one.key == heading.name) {
            return Err(wrong(format!("it has two columns `{}`", heading.name)));
        }
        let value = |row: usize| {
            let word = table.words(row).nth(place).unwrap_or_default();
            let at = |what: String| wrong(format!("line {} {what}", table.line(row)));
            match &heading.unit {
                _ if word.is_empty() => Err(at(format!("has no value for `{}`", heading.name))),
                Some(unit) if word.parse::<f64>().is_ok() => Ok(format!("{word} {unit}")),
                Some(unit) => {
                    let name = &heading.name;
                    Err(at(format!(
                        "needs a plain number for `{name} [{unit}]`, because the first line \
                         gives the unit"
                    )))
                }
                None => Ok(word.into_owned()),
            }
        };
        let values = (0..table.rows()).map(value).collect::<Result<_, _>>()?;
        vary.push(Axis { key: heading.name.clone(), values });
    }
    Ok(vary)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn asked(vary: &[&str]) -> PointArguments {
        let vary = vary.iter().map(|text| Varied::read(text).unwrap()).collect();
        PointArguments { vary, paired: false, latin: None, table: None }
    }

    #[test]
    fn side_by_side_there_are_as_many_points_as_values() {
        let all = |asked: &PointArguments| -> Vec<Vec<usize>> {
            let Design { vary, paired } = asked.design().unwrap();
            let points =
                (0..Design::count(&vary, paired)).map(|n| (n, Design::point(&vary, paired, n)));
            let numbered = |(n, at): (usize, Vec<usize>)| {
                assert_eq!(Design::number(&vary, paired, &at), Some(n));
                at
            };
            points.map(numbered).collect()
        };
        let grid = asked(&["a=1,2,3", "b=4,5,6"]);
        assert_eq!(all(&grid).len(), 9);
        let paired = PointArguments { paired: true, ..grid };
        assert_eq!(all(&paired), [[0, 0], [1, 1], [2, 2]]);
        let vary = paired.design().unwrap().vary;
        for (none, paired) in [(vec![0, 3], false), (vec![0], false), (vec![0, 1], true)] {
            assert_eq!(Design::number(&vary, paired, &none), None, "{none:?}");
        }
        let uneven = PointArguments { paired: true, ..asked(&["a=1,2,3", "b=4,5"]) }.design();
        assert!(uneven.unwrap_err().to_string().contains("--vary b has 2 values, and a has 3"));
    }

    #[test]
    fn parts_are_the_whole() {
        let part = |one| Part { one, of: 4 }.numbers(9).collect::<Vec<_>>();
        assert_eq!([part(1), part(4)], [vec![0, 4, 8], vec![3, 7]]);
        for one in 1..=4 {
            assert!(part(one).iter().all(|n| Part::with(*n, 4) == one));
        }
        assert_eq!((1..=4).map(|one| part(one).len()).sum::<usize>(), 9);
        assert_eq!(Part::read("3/8"), Ok(Part { one: 3, of: 8 }));
        for wrong in ["", "3", "0/8", "9/8", "1/0", "a/b", "-1/2"] {
            assert!(Part::read(wrong).unwrap_err().contains("write 3/8"), "{wrong}");
        }
    }

    /// The options of a task reproduce the user's options.
    #[test]
    fn options_ask_for_the_same() {
        let asked = PointArguments { latin: Some(3), ..asked(&["a=1..9/3", "b=x, y ,z"]) };
        assert_eq!(asked.options(), ["--vary", "a=1..9/3", "--vary", "b=x, y ,z", "--latin", "3"]);
    }

    /// Each value occurs once. The same seed gives the same order, another seed a different one.
    #[test]
    fn a_latin_hypercube_has_each_value_once() {
        let of = |seed| {
            PointArguments { latin: Some(seed), ..asked(&["a=0..9/10", "b=0..9/10"]) }.design()
        };
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
        let units =
            read("\u{feff}motion.speed [km/h];load.normal_force;\r\n72,5;60 kN;\r\n").unwrap();
        assert_eq!(units[0].values, ["72.5 km/h"]);
        assert_eq!(units[1].values, ["60 kN"]);
        for (text, why) in [
            ("a.x,b.x\n1\n", "1 cells in line 2"),
            ("a.x,b.x\n1,\n", "line 2 has no value for `b.x`"),
            ("a.x,\n1,2\n", "the first line of column 2 is not a key"),
            ("a.x,a.x\n1,2\n", "two columns `a.x`"),
            ("a.x [kN]\n60 kN\n", "line 2 needs a plain number for `a.x [kN]`"),
            ("a.x,b.x\n", "no rows"),
            ("", "no rows"),
        ] {
            let error = read(text).unwrap_err();
            assert!(error.contains(why), "{text}: {error}");
        }
        let secret = read("root:*:20228:0\ndaemon:*:20228:0\n").unwrap_err();
        assert!(!secret.contains("20228") && !secret.contains("root"), "{secret}");
    }

    /// A table from elsewhere holds values, and starts no programs.
    #[test]
    fn a_table_names_no_programs() {
        let place = tempfile::tempdir().unwrap();
        let file = place.path().join("points.csv");
        for (text, why) in [
            ("thermal.command\n\"[\"\"touch\"\", \"\"x\"\"]\"\n", "names programs to start"),
            ("thermal\n{ command = ['x'] }\n", "column 1 is not a key of a case"),
        ] {
            std::fs::write(&file, text).unwrap();
            let error = read(&file).unwrap_err();
            assert!(error.to_string().contains(why), "{error}");
            assert_eq!(error.exit_code(), 2);
        }
    }
}
