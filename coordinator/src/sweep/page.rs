//! A sweep as a table on the terminal, and as a page: lines over one key, one line for each value of a
//! second one, a map over two.

use super::study::{Row, Study};
use crate::report::map::Heatmap;
use crate::report::page::{Block, Mood, Page, Section};
use crate::report::plot::Figure;
use crate::study::axis::Axis;
use crate::study::output::Shown;
use crate::study::quantity::Quantity;
use crate::study::table::{Cell, Column, Table};
use run::error::RunError;
use run::format::{Scale, counted, of_key, sentence};
use std::path::Path;

/// Quantities on the terminal; all of them are in the files.
const COLUMNS: usize = 4;
/// Rows on the terminal.
const ROWS: usize = 24;
/// Rows, and points without an answer, on the page.
const PAGE_ROWS: usize = 1000;
/// Points of a line, and marks; of more every so many is drawn.
const PLACES: usize = 4000;
/// Elements of a map along either side; there is none of more.
const ELEMENTS: usize = 1000;
/// Quantities that are drawn.
const DRAWN: usize = 12;
/// Most lines of a plot; more values of the second key are a map alone.
const LINES: usize = 6;
/// From this ratio of the largest to the least value on an axis is by decades.
const DECADES: f64 = 50.0;

impl Shown for Study {
    fn page(&self, _: &Path) -> Result<Page, RunError> {
        let failed = self.rows.iter().filter(|row| row.failed.is_some()).count();
        let points = counted(self.rows.len() as u64, "point");
        let varied: Vec<&str> = self.vary.iter().map(|one| one.key.as_str()).collect();
        let rows: Vec<&Row> = self.rows.iter().take(PAGE_ROWS).collect();
        let drawn = self.changing().filter(|(_, one)| self.drawn.contains(&one.key)).take(DRAWN);
        let drawings = drawn.flat_map(|one| drawings(self, one)).collect();
        let remarks = failures(self).take(PAGE_ROWS).map(Block::Text);
        let listed = Block::Table(table(self, usize::MAX).page(&rows));
        let blocks =
            remarks.chain([listed]).chain(more(self, PAGE_ROWS).map(Block::Text)).collect();
        Ok(Page {
            name: format!("Sweep of {}", self.case),
            title: self.title.clone().unwrap_or_default(),
            status: points,
            mood: if failed == 0 { Mood::Good } else { Mood::Open },
            reason: format!(
                "over {} of `{}`, {} without an answer, in {:.1} s",
                varied.join(" and "),
                self.file,
                failed,
                self.wall_s
            ),
            sections: [Section::of("Over what varies", drawings), Section::of("Points", blocks)]
                .into_iter()
                .flatten()
                .collect(),
        })
    }
}

/// The sweep on the terminal.
pub(super) fn text(study: &Study) -> String {
    let rows: Vec<&Row> = study.rows.iter().take(ROWS).collect();
    let more = more(study, ROWS).map_or_else(String::new, |line| format!("  {line}\n"));
    let failed: String = failures(study).take(ROWS).map(|line| format!("  {line}\n")).collect();
    format!("sweep of {}\n{}{more}{failed}", study.case, table(study, COLUMNS).terminal(&rows))
}

/// How many points are not among the first ones.
fn more(study: &Study, shown: usize) -> Option<String> {
    let more = study.rows.len().saturating_sub(shown);
    (more > 0).then(|| format!("and {} more in sweep.csv", counted(more as u64, "point")))
}

/// Every so many of these, so that there are not too many to be drawn.
fn thinned(points: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
    let every = points.len().div_ceil(PLACES).max(1);
    points.into_iter().step_by(every).collect()
}

fn failures(study: &Study) -> impl Iterator<Item = String> {
    study.rows.iter().filter_map(|row| {
        let at: Vec<&str> = study.varied(row).collect();
        row.failed.as_ref().map(|why| format!("{}: {why}", at.join(", ")))
    })
}

fn table(study: &Study, columns: usize) -> Table<'_, Row> {
    let keys = study.vary.iter().enumerate().map(|(n, one)| {
        let value = move |row: &Row| one.values.get(row.at[n]).cloned().unwrap_or_default();
        Column::text(one.key.clone(), value).naming()
    });
    let quantities = study.changing().take(columns).map(|(column, one)| {
        Column::quantity(one.name.clone(), move |row: &Row| {
            let value = row.value(column);
            Cell::optional(value.as_ref(), |value| of_key(&one.key, value).show(value, 4))
        })
    });
    Table::new(keys.chain(quantities).collect())
}

/// A quantity over the key that varies, or over two.
fn drawings(study: &Study, of: Drawn<'_>) -> Vec<Block> {
    let Some((first, others)) = study.vary.split_first() else { return Vec::new() };
    if study.paired && !others.is_empty() {
        let each = study.vary.iter().enumerate();
        return each.filter_map(|(n, one)| marks(study, of, (n, one, one.numbers()?))).collect();
    }
    match (first.numbers(), others) {
        (Some(along), []) => vec![lines(study, of, (0, first, along), None)],
        (Some(along), [second]) => {
            let mut blocks = Vec::new();
            if second.values.len() <= LINES {
                blocks.push(lines(study, of, (0, first, along.clone()), Some((1, second))));
            }
            blocks.extend(map(study, of, [first, second]).map(Block::Heatmap));
            blocks
        }
        _ => Vec::new(),
    }
}

/// A quantity and its column.
type Drawn<'a> = (usize, &'a Quantity);

type Numbers = (Vec<f64>, String);

/// The unit in which all values of a quantity are shown.
fn scale(study: &Study, (column, of): Drawn<'_>) -> Scale {
    let values = study.rows.iter().filter_map(|row| row.value(column));
    of_key(&of.key, values.fold(0.0, |l: f64, v| l.max(v.abs())))
}

/// The quantity of each point over one of the keys that vary together.
fn marks(
    study: &Study,
    (column, of): Drawn<'_>,
    (n, along, (places, unit)): (usize, &Axis, Numbers),
) -> Option<Block> {
    let scale = scale(study, (column, of));
    let mut figure =
        Figure::new(sentence(&of.name), labelled(&along.key, &unit), scale.unit.clone());
    (figure.from_zero, figure.decades_x) = (false, by_decades(&places));
    let point = |row: &Row| Some([places[row.at[n]], row.value(column)? / scale.factor]);
    let points = thinned(study.rows.iter().filter_map(point).collect());
    (!points.is_empty()).then(|| Block::Figure(figure.with_marks(sentence(&of.name), points)))
}

fn lines(
    study: &Study,
    (column, of): Drawn<'_>,
    (n, along, (places, unit)): (usize, &Axis, Numbers),
    each: Option<(usize, &Axis)>,
) -> Block {
    let scale = scale(study, (column, of));
    let mut figure =
        Figure::new(sentence(&of.name), labelled(&along.key, &unit), scale.unit.clone());
    figure.from_zero = false;
    figure.decades_x = by_decades(&places);
    let line = |fixed: Option<(usize, usize)>| {
        let rows = study.rows.iter().filter(|row| fixed.is_none_or(|(n, at)| row.at[n] == at));
        let mut points: Vec<[f64; 2]> = rows
            .filter_map(|row| Some([places[row.at[n]], row.value(column)? / scale.factor]))
            .collect();
        points.sort_by(|a, b| a[0].total_cmp(&b[0]));
        thinned(points)
    };
    let figure = match each {
        None => figure.with(sentence(&of.name), line(None)),
        Some((second, vary)) => (0..vary.values.len()).fold(figure, |figure, at| {
            let name = format!("{} = {}", vary.key, vary.values[at]);
            figure.with(name, line(Some((second, at))))
        }),
    };
    Block::Figure(figure)
}

/// The quantity over two keys; `None` unless both are evenly spaced, as elements of a map are.
fn map(study: &Study, (column, of): Drawn<'_>, [first, second]: [&Axis; 2]) -> Option<Heatmap> {
    let ((x, x_unit), (y, y_unit)) = (first.numbers()?, second.numbers()?);
    let borders = |places: &[f64]| {
        let step = (places.last()? - places[0]) / (places.len() as f64 - 1.0);
        let even = |(n, place): (usize, &f64)| {
            (place - (places[0] + n as f64 * step)).abs() < 1e-6 * step.abs()
        };
        let rises = (3..=ELEMENTS).contains(&places.len())
            && step > 0.0
            && places.iter().enumerate().all(even);
        rises.then(|| [places[0] - 0.5 * step, places[0] + (places.len() as f64 - 0.5) * step])
    };
    let (across, upward) = (borders(&x)?, borders(&y)?);
    let scale = scale(study, (column, of));
    let mut all = vec![f64::NAN; x.len() * y.len()];
    for row in &study.rows {
        if let Some(value) = row.value(column) {
            all[row.at[1] * x.len() + row.at[0]] = value / scale.factor;
        }
    }
    let drawn = all.iter().any(|value| value.is_finite());
    drawn.then(|| Heatmap {
        title: sentence(&of.name),
        x_label: labelled(&first.key, &x_unit),
        y_label: labelled(&second.key, &y_unit),
        value_label: scale.unit,
        x: across,
        y: upward,
        columns: x.len(),
        values: all,
        from_zero: false,
        true_shape: false,
        arrows: None,
        edges: Vec::new(),
        note: String::new(),
    })
}

fn labelled(key: &str, unit: &str) -> String {
    if unit.is_empty() { key.to_owned() } else { format!("{key} [{unit}]") }
}

fn by_decades(places: &[f64]) -> bool {
    let least = places.iter().copied().fold(f64::INFINITY, f64::min);
    let most = places.iter().copied().fold(0.0, f64::max);
    least > 0.0 && most > DECADES * least
}
