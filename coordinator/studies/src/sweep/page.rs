//! The results of a sweep as a table on the terminal and as a page with plots: lines over one key,
//! one line for each value of a second key, and a map over two keys.

use super::study::{Row, Study};
use crate::study::axis::Axis;
use crate::study::output::StudyPage;
use crate::study::quantity::Quantity;
use crate::study::table::{Cell, Column, Table};
use contract::diagram::Diagram;
use pages::axis::{extent, is_varying};
use pages::image::Palette;
use pages::map::Heatmap;
use pages::page::{Block, Page, RunStatus, Section};
use pages::plot::Figure;
use run::error::RunError;
use run::format::{Scale, counted, sentence};
use run::warnings::Warning;
use std::path::Path;

/// Number of quantities on the terminal; the files contain all.
const COLUMNS: usize = 4;
/// Number of rows on the terminal.
const ROWS: usize = 24;
/// Maximum number of rows, and of failed points, on the page.
const PAGE_ROWS: usize = 1000;
/// Maximum number of points of a line, and of marks; larger sets are thinned evenly.
const PLACES: usize = 4000;
/// Maximum number of elements of a map along a side; larger maps are omitted.
const ELEMENTS: usize = 1000;
/// Maximum number of plotted quantities.
const DRAWN: usize = 12;
/// Maximum number of lines in a plot; with more values of the second key, only the map is shown.
const LINES: usize = 6;
/// Ratio of the largest to the smallest value above which an axis is logarithmic.
const DECADES: f64 = 50.0;

impl StudyPage for Study {
    fn page(&self, _: &Path) -> Result<Page, RunError> {
        let failed = self.rows.iter().filter(|row| row.failed.is_some()).count();
        let points = counted(self.rows.len() as u64, "point");
        let varied: Vec<&str> = self.vary.iter().map(|one| one.key.as_str()).collect();
        let rows: Vec<&Row> = self.rows.iter().take(PAGE_ROWS).collect();
        let drawn = self.found().filter(|(_, one)| self.drawn.contains(&one.key)).take(DRAWN);
        let drawings = drawn.flat_map(|one| drawings(self, one));
        let diagrams = self.diagrams.iter().filter_map(|one| diagram(self, one));
        let drawings = diagrams.map(Block::Figure).chain(drawings).collect();
        let remarks = failures(self).take(PAGE_ROWS).chain(warnings(self)).map(Block::Text);
        let listed = Block::Table(table(self, usize::MAX).page(&rows));
        let blocks =
            remarks.chain([listed]).chain(more(self, PAGE_ROWS).map(Block::Text)).collect();
        Ok(Page {
            name: format!("Sweep of {}", self.case),
            title: self.title.clone().unwrap_or_default(),
            status: points,
            mood: if failed == 0 { RunStatus::Good } else { RunStatus::Open },
            reason: format!(
                "varies {} of `{}`; {} without a result; {:.1} s of run time",
                varied.join(" and "),
                self.file,
                failed,
                self.wall_s
            ),
            sections: [Section::of("Plots", drawings), Section::of("Points", blocks)]
                .into_iter()
                .flatten()
                .collect(),
        })
    }
}

/// Renders the sweep for the terminal.
pub(super) fn text(study: &Study) -> String {
    let rows: Vec<&Row> = study.rows.iter().take(ROWS).collect();
    let more = more(study, ROWS).map_or_else(String::new, |line| format!("  {line}\n"));
    let remarks = failures(study).take(ROWS).chain(warnings(study));
    let failed: String = remarks.map(|line| format!("  {line}\n")).collect();
    format!("sweep of {}\n{}{more}{failed}", study.case, table(study, COLUMNS).terminal(&rows))
}

/// States how many points are not shown.
fn more(study: &Study, shown: usize) -> Option<String> {
    let more = study.rows.len().saturating_sub(shown);
    (more > 0).then(|| format!("and {} more in sweep.csv", counted(more as u64, "point")))
}

/// Thins the points evenly, to a number that can be drawn.
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

/// One line for each figure of which points warn, with the first of them.
fn warnings(study: &Study) -> Vec<String> {
    let mut found: Vec<(&Warning, &Row, u64)> = Vec::new();
    for (row, one) in study.rows.iter().flat_map(|row| row.warnings.iter().map(move |w| (row, w))) {
        match found.iter_mut().find(|(known, ..)| known.key() == one.key()) {
            Some((.., count)) => *count += 1,
            None => found.push((one, row, 1)),
        }
    }
    let line = |(one, row, count): (&Warning, &Row, u64)| {
        let at = study.varied(row).collect::<Vec<_>>().join(", ");
        format!("warning at {}, first at {at}: {one}", counted(count, "point"))
    };
    found.into_iter().map(line).collect()
}

fn table(study: &Study, columns: usize) -> Table<'_, Row> {
    let keys = study.vary.iter().enumerate().map(|(n, one)| {
        let value = move |row: &Row| one.values.get(row.at[n]).cloned().unwrap_or_default();
        Column::text(one.key.clone(), value).naming()
    });
    // Columns of curves come first, then the quantities that participants show or rank.
    let curves: Vec<&str> = study
        .diagrams
        .iter()
        .filter(|one| one.lines.is_empty())
        .flat_map(|one| [one.y.as_str(), &one.x])
        .collect();
    let (first, others): (Vec<_>, Vec<_>) =
        study.found().partition(|(_, one)| study.drawn.contains(&one.key));
    let (curves, first): (Vec<_>, Vec<_>) =
        first.into_iter().partition(|(_, one)| curves.contains(&one.key.as_str()));
    let first: Vec<_> = curves.into_iter().chain(first).collect();
    let quantities = first.into_iter().chain(others).take(columns).map(|(column, one)| {
        Column::quantity(one.name.clone(), move |row: &Row| {
            let value = row.value(column);
            Cell::optional(value.as_ref(), |value| one.scale(value).show(value, 4))
        })
    });
    Table::new(keys.chain(quantities).collect())
}

/// Plots of a quantity over one or two varied keys.
fn drawings(study: &Study, of: FieldDrawing<'_>) -> Vec<Block> {
    let Some((first, others)) = study.vary.split_first() else { return Vec::new() };
    if study.paired && !others.is_empty() {
        let each = study.vary.iter().enumerate();
        return each.filter_map(|(n, one)| marks(study, of, (n, one.numbers()?))).collect();
    }
    match (first.numbers(), others) {
        (Some(along), []) => vec![lines(study, of, (0, along), None)],
        (Some(along), [second]) => {
            let mut blocks = Vec::new();
            if second.values.len() <= LINES {
                blocks.push(lines(study, of, (0, along.clone()), Some((1, second))));
            }
            blocks.extend(map(study, of, [first, second]).map(Block::Heatmap));
            blocks
        }
        _ => Vec::new(),
    }
}

/// A quantity and its column.
type FieldDrawing<'a> = (usize, &'a Quantity);

type Numbers = (Vec<f64>, String);

/// Common unit of all values of a quantity.
fn scale(study: &Study, (column, of): FieldDrawing<'_>) -> Scale {
    let values = study.rows.iter().filter_map(|row| row.value(column));
    of.scale(values.fold(0.0, |l: f64, v| l.max(v.abs())))
}

/// Plots the points over one of the paired keys.
fn marks(
    study: &Study,
    (column, of): FieldDrawing<'_>,
    (n, (places, unit)): (usize, Numbers),
) -> Option<Block> {
    let scale = scale(study, (column, of));
    let mut figure = Figure::new(sentence(&of.name), labelled(study, n, &unit), upward(of, &scale));
    (figure.from_zero, figure.decades_x) = (false, by_decades(&places));
    figure.note = about(study, n);
    let point = |row: &Row| Some([places[row.at[n]], row.value(column)? / scale.factor]);
    let points = thinned(study.rows.iter().filter_map(point).collect());
    (!points.is_empty()).then(|| Block::Figure(figure.with_marks(sentence(&of.name), points)))
}

fn lines(
    study: &Study,
    (column, of): FieldDrawing<'_>,
    (n, (places, unit)): (usize, Numbers),
    each: Option<(usize, &Axis)>,
) -> Block {
    let scale = scale(study, (column, of));
    let mut figure = Figure::new(sentence(&of.name), labelled(study, n, &unit), upward(of, &scale));
    figure.from_zero = false;
    figure.note = about(study, n);
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

/// Builds a map of the quantity over two keys; `None` unless both are evenly spaced, as the
/// elements of a map are.
fn map(
    study: &Study,
    (column, of): FieldDrawing<'_>,
    [first, second]: [&Axis; 2],
) -> Option<Heatmap> {
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
        x_label: labelled(study, 0, &x_unit),
        y_label: labelled(study, 1, &y_unit),
        value_label: scale.unit,
        x: across,
        y: upward,
        columns: x.len(),
        values: all,
        from_zero: false,
        palette: Palette::Sequential,
        true_shape: false,
        arrows: None,
        edges: Vec::new(),
        note: format!("{} {}", about(study, 0), about(study, 1)),
    })
}

/// Plots the points of a sweep in a diagram of its quantities. Points over a single key, or over
/// one of two keys at each value of the other, are joined by a line. `None` if the sweep lacks
/// these quantities, they do not change, or the points of a line differ in more than they may.
fn diagram(study: &Study, of: &Diagram) -> Option<Figure> {
    let column = |key: &str| study.changing().find(|(_, one)| one.key == key);
    let (x, y) = (column(&of.x)?, column(&of.y)?);
    let [x_scale, y_scale] = [x, y].map(|one| scale(study, one));
    let point = |row: &&Row| {
        let value = |column: usize, scale: &Scale| Some(row.value(column)? / scale.factor);
        Some([value(x.0, &x_scale)?, value(y.0, &y_scale)?])
    };
    let groups = groups(study, x.0);
    let mixed = |key: &String| {
        let other = study.changing().find(|(_, one)| one.key == *key);
        let varies = |rows: &Vec<&Row>, column: usize| {
            is_varying(rows.iter().filter_map(|row| row.value(column)))
        };
        other.is_some_and(|(column, _)| groups.iter().any(|(_, rows)| varies(rows, column)))
    };
    if of.constant.iter().any(mixed) {
        return None;
    }
    let [x_label, y_label] =
        [(x.1, &x_scale), (y.1, &y_scale)].map(|(one, scale)| named(&one.name, &scale.unit));
    let mut figure = Figure::new(of.title.as_str(), x_label, y_label);
    for line in &of.lines {
        let place = |p: &[f64; 2]| [p[0] / x_scale.factor, p[1] / y_scale.factor];
        figure = figure.with(line.name.as_str(), line.points.iter().map(place).collect());
        if let Some(line) = figure.lines.last_mut() {
            line.dots = false;
        }
    }
    figure.note.clone_from(&of.note);
    let curves = of.lines.is_empty() && groups.len() <= LINES && !study.paired;
    if !curves || study.vary.len() > 2 {
        let points = thinned(study.rows.iter().filter_map(|row| point(&row)).collect());
        return Some(figure.with_marks("this sweep", points));
    }
    for (name, rows) in groups {
        let mut points: Vec<[f64; 2]> = rows.iter().filter_map(point).collect();
        points.sort_by(|a, b| a[0].total_cmp(&b[0]));
        figure = figure.with(name, thinned(points));
    }
    Some(figure)
}

/// Groups the points so that each group is a curve over the quantity of this column, with a name.
/// Of two keys, the groups have a value each of the one that changes the quantity less.
fn groups(study: &Study, column: usize) -> Vec<(String, Vec<&Row>)> {
    let all = || ("this sweep".to_owned(), study.rows.iter().collect());
    let ([_, _], false) = (study.vary.as_slice(), study.paired) else { return vec![all()] };
    let by = |n: usize| -> Vec<(String, Vec<&Row>)> {
        let vary = &study.vary[n];
        let group = |(at, value): (usize, &String)| {
            let rows = study.rows.iter().filter(|row| row.at[n] == at).collect();
            (format!("{} = {value}", vary.key), rows)
        };
        vary.values.iter().enumerate().map(group).collect()
    };
    let reach = |groups: &[(String, Vec<&Row>)]| -> f64 {
        let of = |rows: &Vec<&Row>| extent(rows.iter().filter_map(|row| row.value(column)));
        let ranges = groups.iter().filter_map(|(_, rows)| of(rows));
        ranges.map(|[low, high]| high - low).fold(0.0, f64::max)
    };
    let [first, second] = [by(0), by(1)];
    if reach(&second) >= reach(&first) { second } else { first }
}

/// Label of the axis of a varied key: its name and the unit of its values.
fn labelled(study: &Study, n: usize, unit: &str) -> String {
    let name = study.names.get(n).and_then(|name| name.split([';', ':', ',', '[']).next());
    named(name.map_or(study.vary[n].key.as_str(), str::trim), unit)
}

/// Key of an axis and its help text, which explains signs, for example.
fn about(study: &Study, n: usize) -> String {
    let key = &study.vary[n].key;
    match study.names.get(n) {
        Some(help) if help != key => format!("{key}: {help}."),
        _ => String::new(),
    }
}

/// Label of the axis of a quantity.
fn upward(of: &Quantity, scale: &Scale) -> String {
    named(&of.name, &scale.unit)
}

fn named(name: &str, unit: &str) -> String {
    let name = sentence(name);
    if unit.is_empty() { name } else { format!("{name} [{unit}]") }
}

fn by_decades(places: &[f64]) -> bool {
    let least = places.iter().copied().fold(f64::INFINITY, f64::min);
    let most = places.iter().copied().fold(0.0, f64::max);
    least > 0.0 && most > DECADES * least
}
