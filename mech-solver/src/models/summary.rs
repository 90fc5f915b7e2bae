//! Sections of `summary.json`.

use half_space::extent::Moments;
use half_space::patches::{Patch, patches};
use proto::grid::Structured;
use serde_json::{Value, json};

/// Maximum number of listed patches; those with the largest load are kept.
const MOST_LISTED: usize = 32;

/// Adds the keys of one object to another.
pub(super) fn extend(section: &mut Value, more: Value) {
    if let (Value::Object(section), Value::Object(more)) = (section, more) {
        section.extend(more);
    }
}

/// Adds the share of the contact area whose pressure is at its largest possible value, if there is
/// one.
pub(super) fn add_limited_area(figures: &mut Value, bound: f64, pressure: &[f64]) {
    if bound < f64::INFINITY {
        let count = |from: f64| pressure.iter().filter(|p| **p >= from).count() as f64;
        figures["limited_area_ratio"] = (count(bound) / count(f64::MIN_POSITIVE)).into();
    }
}

/// Adds the number of patches of a pressure and, if there are several, the figures of each.
pub(super) fn add_patches(figures: &mut Value, grid: &Structured, pressure: &[f64]) {
    let patches = patches(grid, pressure);
    figures["patches"] = patches.len().into();
    if patches.len() > 1 {
        let all = heaviest(patches, MOST_LISTED);
        figures["each_patch"] = all.iter().map(|patch| patch_figures(patch, grid)).collect();
    }
}

/// Patches with the largest load, sorted by y.
fn heaviest(mut patches: Vec<Patch>, most: usize) -> Vec<Patch> {
    patches.sort_by(|a, b| b.sum.total_cmp(&a.sum));
    patches.truncate(most);
    patches.sort_by(|a, b| a.moments.centre[1].total_cmp(&b.moments.centre[1]));
    patches
}

/// Figures of one patch in `summary.json`.
fn patch_figures(patch: &Patch, grid: &Structured) -> Value {
    let Moments { centre: [x, y], semi_axes: [a, b] } = patch.moments;
    let [low, high] = patch.sides(grid);
    let area = grid.element_area();
    json!({
        "x_m": x,
        "y_m": y,
        "y_from_m": low,
        "y_to_m": high,
        "semi_axis_a_m": a,
        "semi_axis_b_m": b,
        "normal_force_n": patch.sum * area,
        "max_pressure_pa": patch.max_pressure,
        "rows": patch.row_count(),
    })
}
