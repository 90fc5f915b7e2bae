//! Fields at the newest instant of a run, drawn as maps. Maps of a surface include the edges of the
//! contact. Fields on a single row of elements, such as a line contact, are drawn as lines.

use super::axis::extent;
use super::axis::{AXES, label, largest_magnitude};
use super::canvas::Drawing;
use super::image::Palette;
use super::map::{Arrows, Edge, Heatmap, Polyline, contours, contours_at};
use super::page::Block;
use super::plot::Figure;
use super::source::{Field, GridSeries, Image, Results};
use contract::field::{EDGES, QUOTIENTS, Quotient};
use run::format::{Scale, number, sentence, words};

/// Values below this share of the largest are rounding errors.
const ROUNDING: f64 = 1e-14;
/// Share of the largest value above which a field counts as different from zero: more than the
/// residual of a solve, and exceeded within the first element.
const EDGE: f64 = 1e-3;

/// Components below this share of the largest are residuals of an iteration and not drawn. The same
/// holds for negative values of a positive field.
const NOTHING: f64 = 1e-5;
/// Maximum number of smoothing passes over an edge, which turn the steps between elements into a
/// curve, and the points needed per pass. More passes would shrink a line around few elements.
const PASSES: usize = 6;
const POINTS_A_PASS: usize = 8;

/// A drawn field.
#[derive(Clone, Debug, PartialEq)]
pub enum FieldDrawing {
    /// A map over a surface or a section.
    Map(Heatmap),
    /// Lines along a single row of elements.
    Line(Figure),
}

impl FieldDrawing {
    /// The block of a page with this drawing.
    #[must_use]
    pub fn block(self) -> Block {
        match self {
            Self::Map(map) => Block::Heatmap(map),
            Self::Line(line) => Block::Figure(line),
        }
    }

    /// The drawing, for a sheet.
    #[must_use]
    pub(super) fn drawing(&self) -> Drawing<'_> {
        match self {
            Self::Map(map) => map.drawing(),
            Self::Line(line) => line.drawing(),
        }
    }
}

/// Draws all fields of all grids in the order of their files, mechanical fields first.
#[must_use]
pub fn all(results: &Results) -> Vec<FieldDrawing> {
    named(results).into_iter().map(|(_, map)| map).collect()
}

/// Same as [`all`], with the name of each field.
#[must_use]
pub fn named(results: &Results) -> Vec<(String, FieldDrawing)> {
    let edges = edges(results);
    let mut maps = Vec::new();
    for series in &results.series {
        let Some(image) = &series.image else { continue };
        let edges = if series.is_surface() { edges.as_slice() } else { &[] };
        let made: Vec<Field> = QUOTIENTS.iter().filter_map(|one| quotient(image, one)).collect();
        let drawn = |field: &Field| Some((field.name.clone(), draw(image, field, edges)?));
        maps.extend(image.fields.iter().chain(&made).filter_map(drawn));
    }
    maps
}

/// Draws a field with the edges of the contact; `None` if all values are zero.
#[must_use]
pub fn draw(image: &Image, field: &Field, edges: &[Edge]) -> Option<FieldDrawing> {
    let drawn = map(image, field, edges, Palette::Sequential).map(FieldDrawing::Map);
    drawn.or_else(|| row(image, field).map(FieldDrawing::Line))
}

/// Draws the difference of a field from another state; `None` if it is zero everywhere. Zero has a
/// neutral colour, and the length of a difference of vectors that of a value.
#[must_use]
pub fn draw_difference(image: &Image, field: &Field) -> Option<FieldDrawing> {
    let palette = if field.components > 1 { Palette::Sequential } else { Palette::Diverging };
    let everywhere = Field { in_contact: false, ..field.clone() };
    let drawn = map(image, &everywhere, &[], palette).map(FieldDrawing::Map);
    drawn.or_else(|| row(image, field).map(FieldDrawing::Line))
}

/// Names of the fields that are zero everywhere, which have no map.
#[must_use]
pub fn zero(results: &Results) -> Vec<&str> {
    let images = results.series.iter().filter_map(|series| series.image.as_ref());
    let fields = images.flat_map(|image| &image.fields);
    let zero = fields.filter(|field| field.values.iter().all(|value| *value == 0.0));
    zero.map(|field| field.name.as_str()).collect()
}

/// Computes the quotient of two fields; `None` if one of them is missing.
fn quotient(image: &Image, made: &Quotient) -> Option<Field> {
    let [of, over] = [made.of, made.over].map(|spec| image.field(spec.name));
    let over = &over?.values;
    let ratio = |(of, over): (f64, &f64)| if *over == 0.0 { 0.0 } else { of / over };
    let mut values: Vec<f64> = of?.magnitudes().into_iter().zip(over).map(ratio).collect();
    blank_cut(&mut values, over, image.cells[image.plane()?[0]]);
    Some(Field {
        name: made.name.to_owned(),
        unit: made.unit.to_owned(),
        meaning: made.meaning.to_owned(),
        components: 1,
        in_contact: true,
        values,
    })
}

/// Clears quotients of elements that the edge of contact cuts. Such an element is only partly in
/// contact, so the quotient of its two mean values may exceed all values inside.
fn blank_cut(ratios: &mut [f64], over: &[f64], columns: usize) {
    let rows = over.len() / columns;
    let inside = |at: usize| {
        let (i, j) = (at % columns, at / columns);
        let whole = (i == 0 || over[at - 1] != 0.0)
            && (i + 1 == columns || over[at + 1] != 0.0)
            && (j == 0 || over[at - columns] != 0.0)
            && (j + 1 == rows || over[at + columns] != 0.0);
        over[at] != 0.0 && whole
    };
    let inner = (0..over.len()).filter(|at| inside(*at)).map(|at| ratios[at]).fold(0.0, f64::max);
    if inner > 0.0 {
        let limit = inner * (1.0 + NOTHING);
        ratios.iter_mut().filter(|ratio| **ratio > limit).for_each(|ratio| *ratio = 0.0);
    }
}

/// Edges of the contact \[m\]. An edge is missing if its field was not written.
fn edges(results: &Results) -> Vec<Edge> {
    let surfaces = results.series.iter().filter(|series| series.is_surface());
    let images: Vec<&Image> = surfaces.filter_map(|series| series.image.as_ref()).collect();
    let find = |name: &str| {
        let mut found = images.iter().filter_map(|image| Some((*image, image.field(name)?)));
        found.next().map(|(image, field)| (image, differs(field)))
    };
    let found = EDGES.iter().filter_map(|edge| {
        let (image, mut inside) = find(edge.field.name)?;
        if let Some(within) = edge.within {
            let (other, differs) = find(within.name)?;
            if other.cells != image.cells {
                return None;
            }
            let masked = inside.iter_mut().zip(differs).filter(|(_, other)| *other == 0.0);
            masked.for_each(|(value, _)| *value = f64::NAN);
        }
        let lines = match edge.growth {
            None => edge_of(image, &inside),
            Some(growth) => {
                let values = image.field(edge.field.name)?.magnitudes();
                border_of(image, &inside, &values, growth)
            }
        };
        (!lines.is_empty()).then(|| Edge { name: edge.words.to_owned(), lines })
    });
    found.collect()
}

/// Returns 1 for every cell that differs from zero, and 0 for the others.
fn differs(field: &Field) -> Vec<f64> {
    let values = field.magnitudes();
    let largest = values.iter().copied().fold(0.0, f64::max);
    values.iter().map(|value| f64::from(u8::from(*value > EDGE * largest))).collect()
}

/// Lines between cells with 0 and cells with 1, within the grid \[m\].
fn edge_of(image: &Image, inside: &[f64]) -> Vec<Polyline> {
    let (framed, wide) = framed(image, inside, f64::NAN);
    let lines = contours(&framed, wide, 0.5).into_iter();
    lines.map(|line| smoothed(line.into_iter().map(|at| place(image, at)).collect())).collect()
}

/// Border of the area in which a field differs from zero \[m\]. The field grows from the border
/// inwards with the distance to this power.
///
/// The power 1/growth of the field is continued from the three elements behind the outermost one,
/// which the border may cut, by the parabola through them: exact for Hertz's contact. Where this
/// parabola is not zero near the outermost element, as under a sharp corner or on a rough surface,
/// the line follows the elements.
fn border_of(image: &Image, inside: &[f64], values: &[f64], growth: f64) -> Vec<Polyline> {
    let (framed_inside, wide) = framed(image, inside, 0.0);
    let linear: Vec<f64> = values.iter().map(|value| value.abs().powf(1.0 / growth)).collect();
    let (linear, _) = framed(image, &linear, 0.0);
    let crossing = |a: usize, b: usize| {
        let inward =
            if framed_inside[a] > 0.5 { a as isize - b as isize } else { (b - a) as isize };
        let last = if inward < 0 { a } else { b };
        let behind = [1, 2, 3].map(|n| {
            let at = last.checked_add_signed(n * inward);
            at.and_then(|at| linear.get(at)).copied().unwrap_or(0.0)
        });
        let part = zero_beyond(behind).unwrap_or(0.5);
        if last == a { part } else { 1.0 - part }
    };
    let lines = contours_at(&framed_inside, wide, 0.5, crossing).into_iter();
    lines.map(|line| smoothed(line.into_iter().map(|at| place(image, at)).collect())).collect()
}

/// Place where the parabola through values at -1, -2 and -3 falls to zero, if that is between -1
/// and 1 and the values fall towards it.
fn zero_beyond([first, second, third]: [f64; 3]) -> Option<f64> {
    if !(0.0 < first && first < second && second < third) {
        return None;
    }
    // The parabola first + slope (s + 1) + bend (s + 1)(s + 2).
    let (slope, bend) = (first - second, 0.5 * (first - 2.0 * second + third));
    let half = 0.5 * (slope + bend);
    let root = (half * half - bend * first).sqrt();
    let beyond = first / (root - half);
    let place = beyond - 1.0;
    (-1.0..=1.0).contains(&place).then_some(place)
}

/// Values with a row and a column more on every side, and the length of a row.
fn framed(image: &Image, values: &[f64], outside: f64) -> (Vec<f64>, usize) {
    let [columns, rows] = [image.cells[0], image.cells[1]];
    let wide = columns + 2;
    let mut framed = vec![outside; wide * (rows + 2)];
    for (n, value) in values.iter().enumerate() {
        framed[(n / columns + 1) * wide + n % columns + 1] = *value;
    }
    (framed, wide)
}

/// Place of a position among framed cells \[m\].
fn place(image: &Image, at: [f64; 2]) -> [f64; 2] {
    [0, 1].map(|axis| image.corner[axis] + (at[axis] - 0.5) * image.spacing[axis])
}

/// Smooths a line of element borders: each point becomes a weighted mean of itself and its
/// neighbours. Points move by less than an element, and the ends of an open line stay.
fn smoothed(mut line: Polyline) -> Polyline {
    let count = line.len();
    let closed = count > 2 && line.first() == line.last();
    for _ in 0..PASSES.min(count / POINTS_A_PASS) {
        let mean = |n: usize| {
            let (before, after) = match n {
                0 if closed => (count - 2, 1),
                n if n + 1 == count && closed => (n - 1, 1),
                0 => (0, 0),
                n if n + 1 == count => (n, n),
                n => (n - 1, n + 1),
            };
            [0, 1].map(|k| 0.25 * line[before][k] + 0.5 * line[n][k] + 0.25 * line[after][k])
        };
        line = (0..count).map(mean).collect();
    }
    line
}

/// Draws a field as a map; `None` if the cells do not form a plane, or all values are zero.
fn map(image: &Image, field: &Field, edges: &[Edge], palette: Palette) -> Option<Heatmap> {
    let [horizontal, upright] = image.plane()?;
    let mut values = field.magnitudes();
    let [least, most] = extent(values.iter().copied()).unwrap_or_default();
    let largest = least.abs().max(most.abs());
    if largest == 0.0 || image.cells[upright] < 2 || image.cells[horizontal] < 2 {
        return None;
    }
    let scale = Scale::of(&field.unit, largest);
    // Negative values within rounding do not count.
    let is_positive = palette == Palette::Sequential && -least <= NOTHING * most;
    let is_zero = |value: &f64| value.abs() <= ROUNDING * largest;
    let from_zero = values.iter().any(is_zero) || is_positive && least < 0.0;
    let most = largest_at(image, field, &values, &scale, palette);
    for value in &mut values {
        let shown = if is_positive { value.max(0.0) } else { *value };
        // Outside the contact there is no value of its fields; a body has a temperature everywhere.
        *value = match is_zero(value) {
            true if field.in_contact => f64::NAN,
            true => 0.0,
            false => shown / scale.factor,
        };
    }
    let lengths = [horizontal, upright].map(|axis| {
        let borders = image.borders(axis);
        Scale::of("m", borders[0].abs().max(borders[1].abs()))
    });
    let borders = |n: usize, axis: usize| image.borders(axis).map(|b| b / lengths[n].factor);
    let scaled = |edge: &Edge| {
        let place = |p: &[f64; 2]| [p[0] / lengths[0].factor, p[1] / lengths[1].factor];
        let line = |line: &Polyline| line.iter().map(place).collect();
        Edge { name: edge.name.clone(), lines: edge.lines.iter().map(line).collect() }
    };
    let length = if field.components > 1 { "Length of the vector: " } else { "" };
    Some(Heatmap {
        title: words(&field.name),
        x_label: label(AXES[horizontal], &lengths[0].unit),
        y_label: label(AXES[upright], &lengths[1].unit),
        value_label: scale.unit,
        x: borders(0, horizontal),
        y: borders(1, upright),
        columns: image.cells[horizontal],
        values,
        from_zero,
        palette,
        true_shape: upright == 1,
        arrows: arrows(field).filter(|_| upright == 1),
        edges: edges.iter().map(scaled).collect(),
        note: format!("{}. {most}", sentence(&format!("{length}{}", field.meaning))),
    })
}

/// Returns whether the grid is a single row of elements.
#[must_use]
pub fn is_row(series: &GridSeries) -> bool {
    series.image.as_ref().and_then(along_row).is_some()
}

/// Axis along a single row; `None` for any other grid.
fn along_row(image: &Image) -> Option<usize> {
    let plane = image.plane()?;
    match plane.map(|axis| image.cells[axis]) {
        [count, 1] if count > 1 => Some(plane[0]),
        [1, count] if count > 1 => Some(plane[1]),
        _ => None,
    }
}

/// Draws a field on a single row of elements as lines, one for each component above rounding.
/// `None` for any other grid, or if all values are zero.
fn row(image: &Image, field: &Field) -> Option<Figure> {
    let along = along_row(image)?;
    let magnitudes = field.magnitudes();
    let largest = largest_magnitude(&magnitudes);
    if largest == 0.0 {
        return None;
    }
    let scale = Scale::of(&field.unit, largest);
    let borders = image.borders(along);
    let length = Scale::of("m", borders[0].abs().max(borders[1].abs()));
    let most = largest_at(image, field, &magnitudes, &scale, Palette::Sequential);
    let mut figure =
        Figure::new(words(&field.name), label(AXES[along], &length.unit), label("", &scale.unit));
    figure.note = format!("{}. {most}", sentence(&field.meaning));
    for component in 0..field.components {
        let values: Vec<f64> =
            field.values.iter().skip(component).step_by(field.components).copied().collect();
        if values.iter().all(|value| value.abs() <= NOTHING * largest) {
            continue;
        }
        let point = |(at, value): (usize, &f64)| {
            [image.middle(along, at) / length.factor, value / scale.factor]
        };
        let points = values.iter().enumerate().map(point).collect();
        let name = AXES.get(component).filter(|_| field.components > 1);
        let own = name.filter(|_| figure.lines.is_empty()).map(|axis| format!("along {axis}"));
        figure.y_label = label(own.as_deref().unwrap_or_default(), &scale.unit);
        figure = figure
            .with(name.map_or_else(|| words(&field.name), |axis| format!("along {axis}")), points);
    }
    Some(figure)
}

/// Describes the largest value and its position in a sentence.
fn largest_at(
    image: &Image,
    field: &Field,
    values: &[f64],
    scale: &Scale,
    palette: Palette,
) -> String {
    let size = |value: f64| match palette {
        Palette::Sequential => value,
        Palette::Diverging => value.abs(),
    };
    let sizes = extent(values.iter().map(|value| size(*value)));
    let (Some([_, most]), Some(plane)) = (sizes, image.plane()) else { return String::new() };
    let columns = image.cells[plane[0]];
    // Among values that are equal within rounding, take the one nearest to the origin.
    let off = |at: &usize| {
        image.middle(plane[0], at % columns).hypot(image.middle(plane[1], at / columns))
    };
    let as_large = (0..values.len()).filter(|&at| size(values[at]) >= most - 1e-9 * most.abs());
    let Some(at) = as_large.min_by(|a, b| off(a).total_cmp(&off(b))) else { return String::new() };
    let place = [0, 1].map(|n| {
        let middle = image.middle(plane[n], [at % columns, at / columns][n]);
        let borders = image.borders(plane[n]);
        let length = Scale::of("m", borders[0].abs().max(borders[1].abs()));
        // Treat values within rounding of zero as zero.
        let middle = if middle.abs() < 1e-9 * image.spacing[plane[n]] { 0.0 } else { middle };
        format!("{} {}", AXES[plane[n]], length.show(middle, 3))
    });
    let what = if field.components > 1 { "Longest" } else { "Largest" };
    let unit = if scale.unit.is_empty() { "" } else { "\u{a0}" };
    let most = number(values[at] / scale.factor, 4);
    format!("{what} {most}{unit}{} at {}.", scale.unit, place.join(", "))
}

/// Vectors of a field with two or three components.
fn arrows(field: &Field) -> Option<Arrows> {
    let component = |n: usize| field.values.iter().skip(n).step_by(field.components).copied();
    (field.components > 1).then(|| Arrows { x: component(0).collect(), y: component(1).collect() })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn image(values: Vec<f64>) -> (Image, Field) {
        let field = Field {
            name: "pressure".to_owned(),
            unit: "Pa".to_owned(),
            meaning: "normal pressure".to_owned(),
            components: 1,
            in_contact: true,
            values,
        };
        let (corner, spacing) = ([-1e-3, -1e-3, 0.0], [1e-3; 3]);
        (Image { corner, spacing, cells: [3, 2, 0], fields: vec![field.clone()] }, field)
    }

    /// A line contact is drawn as lines: one for a scalar, and one for each nonzero component of a
    /// vector.
    #[test]
    fn a_single_row_is_drawn_as_lines() {
        let (mut image, pressure) = image(vec![0.0, 5e6, 1e6]);
        image.cells = [3, 1, 0];
        assert!(map(&image, &pressure, &[], Palette::Sequential).is_none());
        let figure = row(&image, &pressure).unwrap();
        assert_eq!(figure.lines.len(), 1);
        let values: Vec<f64> = figure.lines[0].points.iter().map(|point| point[1]).collect();
        assert_eq!(values, [0.0, 5.0, 1.0]);
        assert!((figure.lines[0].points[1][0] - 0.5).abs() < 1e-12);
        assert_eq!([figure.x_label.as_str(), figure.y_label.as_str()], ["x [mm]", "MPa"]);
        let values = vec![1e6, 0.0, -2e6, 1e-3, 0.0, 0.0];
        let traction = Field { components: 2, values, ..pressure };
        let figure = row(&image, &traction).unwrap();
        let names: Vec<&str> = figure.lines.iter().map(|line| line.name.as_str()).collect();
        assert_eq!((names, figure.y_label.as_str()), (vec!["along x"], "along x [MPa]"));
        image.cells = [3, 2, 0];
        assert!(row(&image, &traction).is_none());
    }

    /// A rise of −9.7e-5 K beside 72 K is a rounding error, so the colours begin at zero. A field
    /// with larger negative values keeps its sign.
    #[test]
    fn rounding_is_zero() {
        let (image, field) = image(vec![0.0; 6]);
        let field = Field {
            unit: "K".to_owned(),
            values: vec![-9.7e-5, 72.0, 1.0, 2.0, 3.0, 4.0],
            ..field
        };
        let drawn = map(&image, &field, &[], Palette::Sequential).unwrap();
        assert!(drawn.from_zero);
        assert_eq!(drawn.values[..3], [0.0, 72.0, 1.0]);
        let field = Field { values: vec![-1.0, 72.0, 1.0, 2.0, 3.0, 4.0], ..field };
        let drawn = map(&image, &field, &[], Palette::Sequential).unwrap();
        assert!(!drawn.from_zero && drawn.values[0] == -1.0);
    }

    /// An element partly in contact may have a larger quotient of traction and pressure than any
    /// element inside, so it is left blank.
    #[test]
    fn elements_that_the_edge_cuts_have_no_quotient() {
        let over = [0.0, 1.0, 1.0, 1.0, 0.0].repeat(3);
        let mut ratios = vec![0.0; 15];
        ratios[5..10].copy_from_slice(&[0.0, 0.87, 0.3, 0.25, 0.0]);
        blank_cut(&mut ratios, &over, 5);
        assert_eq!(ratios[5..10], [0.0, 0.0, 0.3, 0.25, 0.0]);
    }

    /// Cells of unit size round the origin.
    fn square(count: usize) -> Image {
        let corner = [-0.5 * count as f64, -0.5 * count as f64, 0.0];
        Image { corner, spacing: [1.0; 3], cells: [count, count, 0], fields: vec![] }
    }

    fn radius(n: usize, count: usize) -> f64 {
        let [x, y] = [n % count, n / count].map(|k| k as f64 - 0.5 * (count - 1) as f64);
        x.hypot(y)
    }

    /// The edge of a disc of elements is a circle within a third of an element, without steps.
    #[test]
    fn an_edge_has_no_steps() {
        let count = 41;
        let inside = |n: usize| f64::from(u8::from(radius(n, count) < 15.0));
        let inside: Vec<f64> = (0..count * count).map(inside).collect();
        let lines = edge_of(&square(count), &inside);
        assert_eq!(lines.len(), 1);
        let radii = || lines[0].iter().map(|[x, y]| x.hypot(*y));
        let (least, most) = (radii().fold(f64::MAX, f64::min), radii().fold(0.0, f64::max));
        assert!(most - least < 0.6 && (0.5 * (most + least) - 15.0).abs() < 0.3, "{least} {most}");
    }

    /// The square of Hertz's pressure is a paraboloid, whose continuation is exact; smoothing moves
    /// a point of a circle inwards by at most 1/4R in each of six passes.
    #[test]
    fn the_border_of_a_hertzian_pressure_is_a_circle() {
        let count = 41;
        let edge = 15.2;
        let pressure = |n: usize| (1.0 - (radius(n, count) / edge).powi(2)).max(0.0).sqrt();
        let pressures: Vec<f64> = (0..count * count).map(pressure).collect();
        let inside: Vec<f64> = pressures.iter().map(|p| f64::from(u8::from(*p > 0.0))).collect();
        let lines = border_of(&square(count), &inside, &pressures, 0.5);
        assert_eq!(lines.len(), 1);
        let apart = lines[0].iter().map(|[x, y]| (x.hypot(*y) - edge).abs()).fold(0.0, f64::max);
        assert!(apart < 6.0 / (4.0 * edge), "{apart}");
    }

    #[test]
    fn an_edge_goes_round_what_differs_from_zero() {
        let (image, field) = image(vec![0.0, 5e6, 0.0, 0.0, 1e3, 0.0]);
        let lines = border_of(&image, &differs(&field), &field.values, 0.5);
        assert_eq!(lines.len(), 1);
        assert_eq!(lines[0].first(), lines[0].last());
        // The line surrounds the lower cell of the middle column; 1 kPa beside 5 MPa counts as
        // zero.
        let reach = |axis: usize| lines[0].iter().map(move |p| p[axis]).fold(f64::MIN, f64::max);
        assert!((reach(0) - 1e-3).abs() < 1e-15 && reach(1).abs() < 1e-15, "{lines:?}");
    }

    #[test]
    fn traction_over_pressure_is_nothing_beside_the_contact() {
        let (mut image, pressure) = image(vec![0.0, 5e6, 0.0, 0.0, 1e6, 0.0]);
        let [of] = QUOTIENTS else { panic!("{QUOTIENTS:?}") };
        assert!(quotient(&image, of).is_none());
        let mut values = vec![0.0; 12];
        [values[2], values[3], values[9]] = [-3e6, 4e6, 2e5];
        image.fields.push(Field { name: of.of.name.to_owned(), components: 2, values, ..pressure });
        let made = quotient(&image, of).unwrap();
        assert_eq!(made.values, [0.0, 1.0, 0.0, 0.0, 0.2, 0.0]);
    }

    /// A difference keeps its sign, however small one side is, and is not blank where it is zero.
    #[test]
    fn a_difference_is_told_by_its_magnitude() {
        let (image, field) = image(vec![0.0, -5e6, 0.0, 0.0, 1.0, 2e6]);
        let Some(FieldDrawing::Map(map)) = draw_difference(&image, &field) else { panic!() };
        assert_eq!(map.values, [0.0, -5.0, 0.0, 0.0, 1e-6, 2.0]);
        assert!(map.note.contains("Largest −5.000\u{a0}MPa at x 0.500\u{a0}mm"), "{}", map.note);
        let same = Field { values: vec![0.0; 6], ..field };
        assert!(draw_difference(&image, &same).is_none());
    }

    #[test]
    fn the_largest_value_is_told_with_its_place() {
        let (image, field) = image(vec![0.0, 5e6, 0.0, 0.0, 1e3, 2e6]);
        let map = map(&image, &field, &[], Palette::Sequential).unwrap();
        assert!(
            map.note.ends_with("Largest 5.000\u{a0}MPa at x 0.500\u{a0}mm, y −500\u{a0}µm."),
            "{}",
            map.note
        );
        // A length of two millimetres is shown in millimetres, one of one millimetre in
        // micrometres.
        let near = |a: [f64; 2], b: [f64; 2]| (0..2).all(|n| (a[n] - b[n]).abs() < 1e-9);
        assert!(near(map.x, [-1.0, 2.0]) && near(map.y, [-1000.0, 1000.0]), "{:?}", map.y);
        assert_eq!([map.x_label.as_str(), map.y_label.as_str()], ["x [mm]", "y [µm]"]);
        assert!(map.from_zero && map.true_shape && map.arrows.is_none());
    }
}
