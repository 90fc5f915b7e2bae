//! ANALYN: the normal contact row by row, each as the contact of Hertz of its own curvatures.
//!
//! In row y with the gap g over the deepest place, the bend A along x and B across, Hertz has the semi-axes a and b at the
//! approach δ. With 1 + α = δ/(A a²) and 1 + β = δ/(B b²) the row penetrates by
//!
//! δ' = δ − (1 + β) g
//!
//! as far as displacements of the surfaces are like h, and touches over 2l with l² = δ'/((1 + α) A); its pressure is half an ellipse as high as that of
//! Hertz's contact of A and B at δ'. On an ellipse all of that is exact.
//!
//! B is the second difference of the gaps of three rows: a profile that is not smooth over them makes contacts that are
//! not. Where it is hollow, B is next to none ([`FLATTEST`]).
//!
//! Source: Sichani, Enblom, Berg, A novel method to model wheel–rail normal contact in vehicle dynamics simulation, Vehicle
//! System Dynamics 52 (2014) 1752–1764; as in CONTACT (Vollebregt, User guide, 2022), the penetration at the deepest place
//! is the approach, and no factor is fitted.

use super::kpec::FLATTEST;
use super::parabolas::{Parabola, Parabolas};
use super::strips::PressedStrip;
use elastic::hertz::elliptic_contact;

/// The strips of a contact, from right to left, on bodies of a compliance (1 − ν₁²)/E₁ + (1 − ν₂²)/E₂ [1/Pa]; none without
/// penetration.
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

/// B of a row, of three rows around it, or beside it where a profile ends [1/m].
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
