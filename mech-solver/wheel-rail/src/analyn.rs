//! ANALYN: the normal contact, solved row by row. Each row is a Hertz contact of its own
//! curvatures.
//!
//! Symbols: g is the gap of row y above the deepest place, A half the curvature along x, B half the
//! curvature across, δ the approach. Hertz's contact of A and B has the semi-axes a and b. With 1 +
//! α = δ/(A a²) and 1 + β = δ/(B b²) the row penetrates by
//!
//! δ' = δ − (1 + β) g,
//!
//! provided that the surface displacements have the shape of h. The row touches over 2l with
//! l² = δ'/((1 + α) A). Its pressure is half an ellipse, as high as that of Hertz's contact of A
//! and B at δ'. For an elliptical contact all of this is exact.
//!
//! B is the second difference of the gaps of three rows. A profile that is not smooth over three
//! rows gives a contact that is not smooth. On a hollow profile B is bounded below by [`FLATTEST`].
//!
//! Source: Sichani, Enblom, Berg, A novel method to model wheel–rail normal contact in vehicle
//! dynamics simulation, Vehicle System Dynamics 52 (2014) 1752–1764. As in CONTACT (Vollebregt,
//! User guide, 2022), the approach is the penetration at the deepest place, and no factor is
//! fitted.

use super::kpec::FLATTEST;
use super::parabolas::{Parabola, Parabolas};
use super::strips::PressedStrip;
use elastic::hertz::elliptic_contact;

/// Strips of a contact, from right to left; empty if the bodies do not penetrate. The compliance is
/// (1 − ν₁²)/E₁ + (1 − ν₂²)/E₂ [1/Pa].
pub(super) fn strips(parabolas: &Parabolas, compliance: f64) -> Vec<PressedStrip> {
    let Some(deepest) = parabolas.deepest() else { return Vec::new() };
    let approach = -deepest.parabola.gap;
    let strip = |(row, own): (usize, &Parabola)| {
        let across = bend_across(parabolas, row).max(FLATTEST);
        let unit = elliptic_contact(own.bend, across, 1.0, compliance);
        let gap = own.gap + approach;
        let stretch = unit.approach / (across * unit.semi_axis_b * unit.semi_axis_b);
        let left = (approach - stretch * gap) / unit.approach;
        (left > 0.0).then(|| PressedStrip {
            row,
            middle: own.place,
            half_length: unit.semi_axis_a * left.sqrt(),
            pressure: unit.max_pressure * left.sqrt(),
        })
    };
    parabolas.of_patch().filter(|(_, own)| own.gap < 0.0).filter_map(strip).collect()
}

/// B of a row [1/m], from the row and its two neighbours; at the end of a profile, from the three
/// rows next to it.
fn bend_across(parabolas: &Parabolas, row: usize) -> f64 {
    let gap = |row: Option<usize>| parabolas.at(row).map(|own| own.gap);
    let of = |middle: usize| {
        let three = [gap(middle.checked_sub(1)), gap(Some(middle)), gap(Some(middle + 1))];
        let [Some(before), Some(own), Some(after)] = three else { return None };
        Some(0.5 * (before - 2.0 * own + after) / (parabolas.spacing * parabolas.spacing))
    };
    let near = [Some(row), row.checked_sub(1), Some(row + 1)].into_iter().flatten();
    near.filter_map(of).next().unwrap_or(0.0)
}
