//! First guess of the pressure in a normal contact.
//!
//! Elements whose undeformed distance h is below a level c count as touching. For a paraboloid of
//! revolution half the approach is the level at the contact's edge, and
//! p = p_0 √((c − h)/(c − h_min)) with p_0 = 4 (c − h_min)/(π E* a) is Hertz's solution (Johnson
//! §3.4, E* the sum of compliances), a the radius of the contact. Other shapes use the radius of a
//! circle of equal area.

use super::prescribed::Prescribed;
use std::f64::consts::PI;

/// Halvings of the interval of the level, enough for a guess.
const HALVINGS: usize = 30;

/// Writes the guess; at least one element then has a positive pressure.
pub(super) fn fill(
    distance: &[f64],
    prescribed: Prescribed,
    area: f64,
    compliance: f64,
    pressure: &mut [f64],
) {
    let lowest = distance.iter().copied().fold(f64::INFINITY, f64::min);
    let highest = distance.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let guess = Guess { distance, lowest, area, compliance };
    let depth = match prescribed {
        Prescribed::Approach(approach) => 0.5 * (approach - lowest),
        Prescribed::Load(load) => guess.depth_under(load, highest - lowest),
    };
    for (value, h) in pressure.iter_mut().zip(distance) {
        *value = (depth - (h - lowest)).max(0.0).sqrt();
    }
    let peak = guess.max_pressure(depth) / depth.sqrt();
    if peak.is_finite() && peak > 0.0 {
        pressure.iter_mut().for_each(|value| *value *= peak);
    } else {
        // The distances are equal, or differ by less than rounding.
        let touching = distance.iter().map(|h| if *h <= lowest { 1.0 } else { 0.0 });
        pressure.iter_mut().zip(touching).for_each(|(value, one)| *value = one);
    }
}

struct Guess<'a> {
    distance: &'a [f64],
    lowest: f64,
    area: f64,
    compliance: f64,
}

impl Guess<'_> {
    fn heights(&self) -> impl Iterator<Item = f64> {
        self.distance.iter().map(|h| h - self.lowest)
    }

    /// Peak pressure p_0 at the depth c − h_min.
    fn max_pressure(&self, depth: f64) -> f64 {
        let touching = self.heights().filter(|height| *height <= depth).count();
        let radius = (touching as f64 * self.area / PI).sqrt();
        4.0 * depth / (PI * self.compliance * radius)
    }

    fn load(&self, depth: f64) -> f64 {
        let roots: f64 = self.heights().map(|height| (1.0 - height / depth).max(0.0).sqrt()).sum();
        self.max_pressure(depth) * roots * self.area
    }

    /// Depth, at most `range`, at which the guess carries the load.
    fn depth_under(&self, load: f64, range: f64) -> f64 {
        let (mut low, mut high) = (0.0, range);
        if range <= 0.0 || self.load(high) <= load {
            return high;
        }
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            *(if self.load(middle) < load { &mut low } else { &mut high }) = middle;
        }
        high
    }
}
