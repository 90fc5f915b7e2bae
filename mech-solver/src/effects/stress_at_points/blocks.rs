//! Blocks of points of the effect `stress_at_points`, as read from a case.

use crate::case::keys::CheckedParams;
use proto::bodies::{Bodies, LOWER};
use proto::configuration::{Configuration, Refusal};
use proto::description::KeySpec;
use proto::grid::{Places, Structured, check_name};
use proto::table::{Column, Reading, Table, headings};
use std::path::Path;

/// Table of the blocks in a case.
const TABLE: &str = "effects.stress_at_points";
/// Names of the coordinates.
const AXES: [&str; 3] = ["x", "y", "z"];
/// Largest number of points; their fields have 18 values each.
const MOST_POINTS: usize = 1 << 23;
/// Largest size of a file [byte].
const MOST_BYTES: u64 = 1 << 30;

/// Columns of a table of points.
fn columns() -> [Column; 3] {
    AXES.map(|axis| {
        Column::new(&[axis], "m").expected(0.0..=1.0, "contacts are smaller; check the unit")
    })
}

pub(super) fn keys() -> Vec<KeySpec> {
    let key = |name: &str| format!("{TABLE}.*.{name}");
    let mut keys = vec![
        KeySpec::text(&key("body"), "name of the body that contains the points"),
        KeySpec::table(&key("file"), &columns(), "points, in place of x, y and z"),
    ];
    for (axis, others) in
        AXES.into_iter().zip(["centres of all columns", "centres of all rows", ""])
    {
        let absent = match others {
            "" => String::new(),
            _ => format!("; absent: the {others} of elements"),
        };
        let help = format!(
            "coordinate {axis} of the points, a list of them, or first and last of points_{axis}{absent}"
        );
        keys.push(KeySpec::quantity(&key(axis), "m", &help).or_list());
        let help = format!("equally spaced points from the first to the last {axis}");
        keys.push(
            KeySpec::integer(&key(&format!("points_{axis}")), &help).at_least(2.0).at_most(1e6),
        );
    }
    keys
}

/// Block of points in one body.
#[derive(Clone, Debug)]
pub(super) struct PointBlock {
    pub(super) name: String,
    /// Index of the body that contains the block.
    pub(super) body: usize,
    points: AskedPoints,
}

#[derive(Clone, Debug)]
enum AskedPoints {
    List(Vec<[f64; 3]>),
    /// Rising coordinates along each axis; `None` for the centres of the elements.
    Axes([Option<Vec<f64>>; 3]),
}

impl PointBlock {
    /// Returns the points of the block for a contact on this grid.
    pub(super) fn places(&self, grid: &Structured) -> Places {
        match &self.points {
            AskedPoints::List(points) => Places::List(points.clone()),
            AskedPoints::Axes([x, y, z]) => Places::Lattice([
                x.clone().unwrap_or_else(|| (0..grid.ni).map(|i| grid.x(i)).collect()),
                y.clone().unwrap_or_else(|| (0..grid.nj).map(|j| grid.y(j)).collect()),
                z.clone().unwrap_or_default(),
            ]),
        }
    }

    /// Number of points; axes that follow the grid count as one point.
    fn count(&self) -> usize {
        match &self.points {
            AskedPoints::List(points) => points.len(),
            AskedPoints::Axes(axes) => {
                let counts = axes.iter().map(|axis| axis.as_ref().map_or(1, Vec::len));
                counts.fold(1, usize::saturating_mul)
            }
        }
    }
}

/// Reads the blocks of a case.
///
/// # Errors
/// A case without blocks; a block without a body or points, or with points outside of its body; too
/// many points.
pub(super) fn read(
    configuration: &Configuration,
    case: &CheckedParams<'_>,
    names: &Bodies,
) -> Result<Vec<PointBlock>, Refusal> {
    let table = configuration.case.get(TABLE).and_then(serde_json::Value::as_object);
    let blocks: Vec<PointBlock> = table
        .into_iter()
        .flatten()
        .map(|(name, _)| block(name, case, names))
        .collect::<Result<_, _>>()?;
    if blocks.is_empty() {
        return Err(Refusal::new(
            TABLE,
            "there is no block of points",
            format!("add [{TABLE}.NAME] with `body`, and `z` or `file`"),
        ));
    }
    let count = blocks.iter().map(PointBlock::count).fold(0, usize::saturating_add);
    if count > MOST_POINTS {
        let reason = format!("{count} points are more than {MOST_POINTS}");
        return Err(Refusal::new(TABLE, reason, "request fewer points, or use several runs"));
    }
    Ok(blocks)
}

fn block(name: &str, case: &CheckedParams<'_>, names: &Bodies) -> Result<PointBlock, Refusal> {
    let key = |part: &str| format!("{TABLE}.{name}.{part}");
    check_name("block", name).map_err(|reason| {
        Refusal::new(&format!("{TABLE}.{name}"), reason, "give the block another name")
    })?;
    let body_key = key("body");
    let called = case.text(&body_key)?;
    let Some(body) = names.0.iter().position(|body| body == called) else {
        let fix = format!("write `{}` or `{}`", names.0[0], names.0[1]);
        return Err(Refusal::new(&body_key, format!("there is no body `{called}`"), fix));
    };
    let file = key("file");
    if case.has(&file) {
        let axis = AXES.into_iter().find(|axis| case.has(&key(axis)));
        if let Some(axis) = axis {
            let reason = format!("the points of `{name}` come from a file");
            return Err(Refusal::new(&key(axis), reason, format!("remove it, or {file}")));
        }
        let path = case.text(&file)?;
        let fix = format!("give a table of {}, {} in `{called}`", headings(&columns()), side(body));
        let points = from_file(Path::new(path), body)
            .map_err(|reason| Refusal::new(&file, format!("`{path}` {reason}"), fix))?;
        return Ok(PointBlock { name: name.to_owned(), body, points: AskedPoints::List(points) });
    }
    let [x, y, z] = AXES.map(|axis| coordinates(axis, &key, case));
    let axes = [x?, y?, z?];
    let Some(depths) = &axes[2] else {
        let fix = format!("write {} or {file}", key("z"));
        return Err(Refusal::new(&key("z"), "missing", fix));
    };
    if let Some(outside) = depths.iter().find(|z| !inside(**z, body)) {
        let reason = format!("{outside} m is not in `{called}`, which has {}", side(body));
        return Err(Refusal::new(&key("z"), reason, "write the other sign, or another body"));
    }
    Ok(PointBlock { name: name.to_owned(), body, points: AskedPoints::Axes(axes) })
}

fn inside(z: f64, body: usize) -> bool {
    if body == LOWER { z <= 0.0 } else { z >= 0.0 }
}

fn side(body: usize) -> &'static str {
    if body == LOWER { "z <= 0" } else { "z >= 0" }
}

/// Reads the coordinates along an axis in rising order; `None` if the case has none.
fn coordinates(
    axis: &str,
    key: &impl Fn(&str) -> String,
    case: &CheckedParams<'_>,
) -> Result<Option<Vec<f64>>, Refusal> {
    let (own, count) = (key(axis), key(&format!("points_{axis}")));
    let values = case.maybe_numbers(&own)?;
    if !case.has(&count) {
        return values.map(|values| rising(&own, values)).transpose();
    }
    let Some([first, last]) =
        values.as_deref().and_then(|values| <[f64; 2]>::try_from(values).ok())
    else {
        let fix = format!("write {own} = [FIRST, LAST], or remove {count}");
        return Err(Refusal::new(
            &own,
            "a number of points needs a first and a last coordinate",
            fix,
        ));
    };
    let count = case.integer(&count)?;
    let step = (last - first) / (count - 1) as f64;
    let at = |n: i64| if n + 1 == count { last } else { first + n as f64 * step };
    rising(&own, (0..count).map(at).collect()).map(Some)
}

/// Sorts the values, and refuses duplicates.
fn rising(key: &str, mut values: Vec<f64>) -> Result<Vec<f64>, Refusal> {
    values.sort_by(f64::total_cmp);
    // Turns −0 into 0.
    values.iter_mut().for_each(|value| *value += 0.0);
    match values.windows(2).find(|pair| pair[0] == pair[1]) {
        Some(pair) => {
            let reason = format!("{} m occurs twice", pair[0]);
            Err(Refusal::new(key, reason, "write every coordinate once"))
        }
        None => Ok(values),
    }
}

/// Reads the points of a table in a file.
fn from_file(path: &Path, body: usize) -> Result<Vec<[f64; 3]>, String> {
    let table = Table::read(path, MOST_BYTES, Reading::NUMBERS);
    points_of(&table.map_err(|error| error.to_string())?, body)
}

fn points_of(table: &Table, body: usize) -> Result<Vec<[f64; 3]>, String> {
    let found = table.columns(&columns()).map_err(|error| error.to_string())?;
    let point = |row: usize| {
        let point = [0, 1, 2].map(|axis: usize| found[axis][row]);
        let (z, line) = (point[2], table.line(row));
        match inside(z, body) {
            true => Ok(point),
            false => Err(format!("has a point outside of the body, z = {z} m, in line {line}")),
        }
    };
    (0..table.rows()).map(point).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proto::bodies::UPPER;

    #[test]
    fn points_of_a_file() {
        let parse = |text: &str, body| {
            let table = Table::parse(text.to_owned(), Reading::NUMBERS);
            points_of(&table.map_err(|error| error.to_string())?, body)
        };
        let expected = Ok(vec![[0.0, 1e-3, -2e-3], [1.0, 2.0, -3.0]]);
        let text = "x [m], y [m], z [m]\n0, 1e-3, -2e-3 # first\n\n 1, 2, -3\n";
        assert_eq!(parse(text, LOWER), expected);
        // The header gives the units and the order of the columns.
        assert_eq!(parse("z [mm]; y [mm]; x [m]\n-2; 1; 0\n-3000; 2000; 1\n", LOWER), expected);
        let wrong = |text: &str, body| parse(text, body).unwrap_err();
        assert!(wrong(text, UPPER).contains("z = -0.002 m, in line 2"));
        assert!(wrong("1, 2\n", LOWER).contains("2 columns"));
        assert!(wrong("1 2 -3\nx y z\n", LOWER).contains("column 1 of line 2"));
        assert!(wrong("1 2 nan\n", LOWER).contains("column 3 of line 1"));
        assert!(wrong("x, y, z\n", LOWER).contains("no rows"));
        assert!(wrong("x [s], y [mm], z [mm]\n1,2,-3\n", LOWER).contains("column `x` of line 1"));
    }
}
