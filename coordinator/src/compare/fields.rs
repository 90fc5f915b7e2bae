//! Comparison of fields: norms of the difference, and the place of the largest one.
//!
//! A field of A is compared with the field of B of the same name in the same plane. Names of grids
//! are ignored, because every program chooses its own.
//!
//! If the grids differ, the field of B is interpolated bilinearly between its cell centres, at the
//! cell centres of A inside them.

use pages::axis::largest_magnitude;
use pages::source::{Field, Image, Results};
use serde::Serialize;

/// Largest relative difference that counts as rounding or as the residual of an iteration.
pub(super) const NEGLIGIBLE: f64 = 1e-6;

/// Difference of a field, which one result may lack.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct FieldDifference {
    /// Name of the field.
    pub field: String,
    /// Participant and grid, in A if it has the field.
    pub grid: String,
    /// SI unit.
    pub unit: String,
    /// Largest magnitude in A, if it has the field.
    pub largest_a: Option<f64>,
    /// Largest magnitude in B, if it has the field.
    pub largest_b: Option<f64>,
    /// Difference, if both fields overlap.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub difference: Option<Difference>,
}

/// The difference of two fields.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct Difference {
    /// √(∫|B − A|² / ∫|A|²) over the common area \[-\]; `None` if A is zero.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub l2: Option<f64>,
    /// Largest |B − A|.
    pub max: f64,
    /// Place of the largest difference \[m\].
    pub at: [f64; 3],
    /// B was interpolated, because the grids differ.
    pub interpolated: bool,
}

impl FieldDifference {
    /// Both fields agree within rounding.
    pub(super) fn is_negligible(&self) -> bool {
        let largest = [self.largest_a, self.largest_b].into_iter().flatten().fold(0.0, f64::max);
        self.difference.as_ref().is_some_and(|one| one.max <= NEGLIGIBLE * largest)
    }
}

/// A field with its grid.
type Placed<'a> = (&'a str, &'a Image, &'a Field);

fn all(of: &Results) -> Vec<Placed<'_>> {
    let images = of.series.iter().filter_map(|one| Some((one.name.as_str(), one.image.as_ref()?)));
    images.flat_map(|(name, image)| image.fields.iter().map(move |f| (name, image, f))).collect()
}

/// Returns the fields that differ, and the number of equal ones.
pub(super) fn differences(a: &Results, b: &Results) -> (Vec<FieldDifference>, usize) {
    let [of_a, of_b] = [all(a), all(b)];
    let (mut different, mut same) = (Vec::new(), 0);
    let partners = partners(&of_a, &of_b);
    for ((name, image, field), partner) in of_a.iter().zip(&partners) {
        let other = partner.map(|n| of_b[n]);
        if other.is_some_and(|(_, at, other)| is_same((image, field), (at, other))) {
            same += 1;
            continue;
        }
        different.push(FieldDifference {
            difference: other.and_then(|(_, at, other)| difference((image, field), (at, other))),
            largest_b: other.map(|(_, _, other)| largest(other)),
            ..lacking(name, field)
        });
    }
    let alone = of_b.iter().enumerate().filter(|(n, _)| !partners.contains(&Some(*n)));
    for (_, (name, _, field)) in alone {
        let only = lacking(name, field);
        different.push(FieldDifference { largest_b: only.largest_a, largest_a: None, ..only });
    }
    (different, same)
}

/// Returns, for each field of A, the index of its partner in B: the field of the same name on the
/// grid of the same name, or else in the nearest plane with the same axes.
fn partners(of_a: &[Placed<'_>], of_b: &[Placed<'_>]) -> Vec<Option<usize>> {
    let named = |(name, _, field): &Placed<'_>| {
        of_b.iter().position(|(grid, _, other)| grid == name && other.name == field.name)
    };
    let mut partners: Vec<Option<usize>> = of_a.iter().map(named).collect();
    for n in 0..of_a.len() {
        let (_, image, field) = &of_a[n];
        if partners[n].is_some() || image.plane().is_none() {
            continue;
        }
        let alike = |at: &usize| {
            let (_, other, candidate) = &of_b[*at];
            candidate.name == field.name
                && other.plane() == image.plane()
                && !partners.contains(&Some(*at))
        };
        let distance = |at: &usize| {
            let apart = |axis: usize| match image.cells[axis] {
                0 => (of_b[*at].1.corner[axis] - image.corner[axis]).abs(),
                _ => 0.0,
            };
            (0..3).map(apart).sum::<f64>()
        };
        let nearest = |a: &usize, b: &usize| distance(a).total_cmp(&distance(b));
        partners[n] = (0..of_b.len()).filter(alike).min_by(nearest);
    }
    partners
}

/// Returns the entry of a field that only A has.
fn lacking(grid: &str, field: &Field) -> FieldDifference {
    FieldDifference {
        field: field.name.clone(),
        grid: grid.to_owned(),
        unit: field.unit.clone(),
        largest_a: Some(largest(field)),
        largest_b: None,
        difference: None,
    }
}

fn largest(field: &Field) -> f64 {
    largest_magnitude(&field.magnitudes())
}

fn same_grid(a: &Image, b: &Image) -> bool {
    (a.corner, a.spacing, a.cells) == (b.corner, b.spacing, b.cells)
}

fn is_same(a: (&Image, &Field), b: (&Image, &Field)) -> bool {
    let bits = |field: &Field| field.values.iter().map(|v| v.to_bits()).collect::<Vec<_>>();
    same_grid(a.0, b.0) && bits(a.1) == bits(b.1)
}

fn difference(a: (&Image, &Field), b: (&Image, &Field)) -> Option<Difference> {
    let ([along, upright], components) = (a.0.plane()?, a.1.components);
    if b.0.plane() != Some([along, upright]) || b.1.components != components {
        return None;
    }
    let (mut squares, mut own, mut max, mut at) = (0.0, 0.0, -1.0, [0.0; 3]);
    let interpolated = !same_grid(a.0, b.0);
    let columns = a.0.cells[along];
    for (n, values) in a.1.values.chunks_exact(components).enumerate() {
        let mut place = a.0.corner;
        place[along] = a.0.middle(along, n % columns);
        place[upright] = a.0.middle(upright, n / columns);
        let weights = match interpolated {
            false => Some([(n, 1.0), (n, 0.0), (n, 0.0), (n, 0.0)]),
            true => between(b.0, [along, upright], [place[along], place[upright]]),
        };
        let Some(weights) = weights else { continue };
        let other = |c: usize| -> f64 {
            weights.iter().map(|(cell, weight)| weight * b.1.values[cell * components + c]).sum()
        };
        let square: f64 = (0..components).map(|c| (other(c) - values[c]).powi(2)).sum();
        squares += square;
        own += values.iter().map(|v| v * v).sum::<f64>();
        if square.sqrt() > max {
            (max, at) = (square.sqrt(), place);
        }
    }
    let l2 = match (squares == 0.0, own > 0.0) {
        (true, _) => Some(0.0),
        (false, has_values) => has_values.then(|| (squares / own).sqrt()),
    };
    (max >= 0.0).then_some(Difference { l2, max, at, interpolated })
}

/// Returns the four cells around a place with their weights; `None` outside the cell centres.
fn between(image: &Image, axes: [usize; 2], place: [f64; 2]) -> Option<[(usize, f64); 4]> {
    let mut cells = [[0; 2]; 2];
    let mut parts = [0.0; 2];
    for n in 0..2 {
        let (axis, count) = (axes[n], image.cells[axes[n]]);
        let along = (place[n] - image.middle(axis, 0)) / image.spacing[axis];
        // A place that is outside by rounding lies on the border.
        let along = if along.abs() < 1e-9 { 0.0 } else { along };
        if along < 0.0 || along > (count - 1) as f64 + 1e-9 {
            return None;
        }
        let low = (along as usize).min(count.saturating_sub(2));
        cells[n] = [low, (low + 1).min(count - 1)];
        parts[n] = along - low as f64;
    }
    let columns = image.cells[axes[0]];
    let cell = |i: usize, j: usize| cells[1][j] * columns + cells[0][i];
    let [u, v] = parts;
    Some([
        (cell(0, 0), (1.0 - u) * (1.0 - v)),
        (cell(1, 0), u * (1.0 - v)),
        (cell(0, 1), (1.0 - u) * v),
        (cell(1, 1), u * v),
    ])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn placed(columns: usize, rows: usize, of: impl Fn(f64, f64) -> f64) -> (Image, Field) {
        let (dx, dy) = (4.0 / columns as f64, 2.0 / rows as f64);
        let value = |n: usize| {
            let (i, j) = ((n % columns) as f64, (n / columns) as f64);
            of(-2.0 + (i + 0.5) * dx, -1.0 + (j + 0.5) * dy)
        };
        let field = Field {
            name: "heat".to_owned(),
            unit: "K".to_owned(),
            meaning: String::new(),
            components: 1,
            in_contact: true,
            values: (0..columns * rows).map(value).collect(),
        };
        let (corner, spacing) = ([-2.0, -1.0, 0.0], [dx, dy, dx]);
        (Image { corner, spacing, cells: [columns, rows, 0], fields: vec![] }, field)
    }

    #[test]
    fn the_largest_difference_has_its_place() {
        let (image, field) = placed(8, 4, |x, y| x + y);
        let mut other = field.clone();
        other.values[11] += 0.5;
        let found = difference((&image, &field), (&image, &other)).unwrap();
        assert_eq!((found.max, found.at, found.interpolated), (0.5, [-0.25, -0.25, 0.0], false));
        let own: f64 = field.values.iter().map(|v| v * v).sum();
        assert!((found.l2.unwrap() - 0.5 / own.sqrt()).abs() < 1e-15);
        // A difference from zero has no ratio.
        let mut zero = field.clone();
        zero.values.fill(0.0);
        let found = difference((&image, &zero), (&image, &field)).unwrap();
        assert_eq!((found.l2, found.max), (None, largest(&field)));
        let found = difference((&image, &zero), (&image, &zero)).unwrap();
        assert_eq!((found.l2, found.max), (Some(0.0), 0.0));
    }

    #[test]
    fn a_field_is_known_by_name_and_place() {
        let (image, field) = placed(8, 4, |x, y| x + y);
        let section = Image { cells: [8, 0, 4], ..image.clone() };
        let far = Image { corner: [-2.0, 1.0, 0.0], ..section.clone() };
        let other = Field { name: "flux".to_owned(), ..field.clone() };
        let of_a = [("t/contact", &image, &field), ("t/contact", &image, &other)];
        let of_b = [("t/side", &section, &field), ("t/passage", &image, &field)];
        assert_eq!(partners(&of_a, &of_b), [Some(1), None]);
        let of_a = [("t/section", &section, &field)];
        let of_b = [("t/far", &far, &field), ("t/near", &section, &field)];
        assert_eq!(partners(&of_a, &of_b), [Some(1)]);
    }

    #[test]
    fn a_plane_is_the_same_on_every_grid() {
        let plane = |x: f64, y: f64| 3.0 + 2.0 * x - y;
        let [(image, field), (other, finer)] = [placed(8, 4, plane), placed(20, 14, plane)];
        let found = difference((&image, &field), (&other, &finer)).unwrap();
        assert!(found.interpolated && found.max < 1e-12, "{found:?}");
        let found = difference((&other, &finer), (&image, &field)).unwrap();
        assert!(found.max < 1e-12, "where the coarser has no middles there is no comparison");
    }
}
