//! White etching layer that forms under the contact in steady motion
//! ([`crate::effects::phase_transformation`]).
//!
//! Temperatures are rises above the initial one, also in the criterion. Each row is evaluated at
//! the surface first; the depth of its transformed layer is then found by bisection. Along a level
//! the temperature is known at the element centres. The rates are those of the straight line
//! between the two centres where it passes A_c1. If it does not cool that far within the grid, the
//! cooling rate is that of T ~ 1/√t through the last two centres.

use crate::effects::phase_transformation::Criterion;
use serde_json::{Value, json};

/// Number of bisection steps for the depth.
pub(super) const HALVINGS: usize = 12;

/// Thermal cycle of the material at some depth of a row.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Cycle {
    /// Highest rise [K].
    pub(super) highest: f64,
    /// Heating and cooling rates through the start temperature [K/s]; 0 where it is not reached.
    pub(super) rates: [f64; 2],
}

impl Cycle {
    /// Returns the cycle for the rises along a row [K]. Material enters at the last element and
    /// passes an element in the time `passing` [s].
    pub(super) fn of(rises: &[f64], passing: f64, start: f64) -> Self {
        let highest = rises.iter().copied().fold(0.0, f64::max);
        if highest < start {
            return Self { highest, rates: [0.0; 2] };
        }
        let warm = |value: &f64| *value >= start;
        let entering = rises.iter().rposition(warm).expect("the highest is warm");
        let leaving = rises.iter().position(warm).expect("the highest is warm");
        let rate = |warm: usize, cold: Option<usize>| {
            let cold = cold.and_then(|cold| rises.get(cold));
            cold.map(|cold| (rises[warm] - cold) / passing)
        };
        let heating = rate(entering, entering.checked_add(1)).unwrap_or(0.0);
        let cooling = rate(leaving, leaving.checked_sub(1));
        let cooling = cooling.unwrap_or_else(|| later(rises, passing, start));
        Self { highest, rates: [heating, cooling] }
    }

    /// Returns the cycle of a row of a stationary body, which stays hot.
    pub(super) fn at_rest(rises: &[f64]) -> Self {
        Self { highest: rises.iter().copied().fold(0.0, f64::max), rates: [0.0; 2] }
    }

    /// Highest rise minus the transformation temperature [K]; negative where that is not reached.
    pub(super) fn margin(&self, criterion: &Criterion) -> f64 {
        self.highest - criterion.temperature(self.rates[0])
    }

    fn quenches(&self, criterion: &Criterion) -> bool {
        self.rates[1] >= criterion.critical_rate
    }
}

/// Returns the cooling rate through the start temperature behind the row [K/s], from T = C/√(t −
/// t₀) through its last two centres.
pub(super) fn later(rises: &[f64], passing: f64, start: f64) -> f64 {
    let [last, before] = [rises[0], rises.get(1).copied().unwrap_or(0.0)];
    if before <= last {
        return 0.0;
    }
    let ratio = (before / last).powi(2);
    let square = last * last * passing * ratio / (ratio - 1.0);
    start.powi(3) / (2.0 * square)
}

/// Transformed cross-section of a body.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct WhiteLayer {
    depth: f64,
    rows: usize,
    /// Cycle of the row with the largest margin.
    hottest: Cycle,
    /// Largest excess of a rise over the transformation temperature [K].
    margin: f64,
    /// Length of the layer of a stationary body [m]; `None` for a moving body, whose layer has no
    /// end.
    length: Option<f64>,
}

impl WhiteLayer {
    /// Evaluates the rows of a grid. `along(row, depth)` returns the thermal cycle at a depth [m]
    /// of a row; nothing transforms at the depth `deepest`.
    pub(super) fn of(
        rows: impl Iterator<Item = usize>,
        criterion: &Criterion,
        deepest: f64,
        mut along: impl FnMut(usize, f64) -> Cycle,
    ) -> Self {
        let mut layer = Self { margin: f64::NEG_INFINITY, ..Self::default() };
        for row in rows {
            let surface = along(row, 0.0);
            let margin = surface.margin(criterion);
            if margin > layer.margin {
                (layer.margin, layer.hottest) = (margin, surface);
            }
            if margin < 0.0 || !surface.quenches(criterion) {
                continue;
            }
            layer.rows += 1;
            let (mut inside, mut outside) = (0.0, deepest);
            for _ in 0..HALVINGS {
                let middle = 0.5 * (inside + outside);
                match along(row, middle).margin(criterion) >= 0.0 {
                    true => inside = middle,
                    false => outside = middle,
                }
            }
            layer.depth = layer.depth.max(inside);
        }
        layer
    }

    /// Sets the length of the layer of a stationary body, that of its hot part [m].
    pub(super) fn with_length(self, length: f64) -> Self {
        Self { length: Some(length), ..self }
    }

    /// Returns the figures of the summary for rows of the width `row_width` [m]. Rates that do not
    /// occur are omitted.
    pub(super) fn figures(&self, row_width: f64) -> Value {
        let mut figures = json!({
            "depth_m": self.depth,
            "width_m": self.rows as f64 * row_width,
            "temperature_margin_k": self.margin,
        });
        if let Some(length) = self.length {
            figures["length_m"] = json!(length);
            figures["hot_length_m"] = json!(length);
        }
        let names = ["heating_rate_k_per_s", "cooling_rate_k_per_s"];
        for (name, rate) in names.into_iter().zip(self.hottest.rates) {
            if rate > 0.0 {
                figures[name] = json!(rate);
            }
        }
        figures
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CRITERION: Criterion =
        Criterion { start: 900.0, shift: 20.0, reference_rate: 10.0, critical_rate: 100.0 };

    /// A triangular profile heated at 2e4 and cooled at 1e4 K/s; a row that ends before it has
    /// cooled.
    #[test]
    fn rates_are_those_of_the_crossing() {
        let passing = 1e-2;
        let triangle: Vec<f64> = (0..20)
            .map(|k| {
                if k < 15 {
                    300.0 + 100.0 * f64::from(k)
                } else {
                    1700.0 - 200.0 * f64::from(k - 14)
                }
            })
            .collect();
        let cycle = Cycle::of(&triangle, passing, 900.0);
        assert_eq!(cycle, Cycle { highest: 1700.0, rates: [2e4, 1e4] });
        // The shift is 20 K for each tenfold increase of the heating rate.
        let shift = 20.0 * (2e4f64 / 10.0).log10();
        assert!((cycle.margin(&CRITERION) - (1700.0 - 900.0 - shift)).abs() < 1e-9);
        // T = 1e3/√t from t = 0.25 on, in steps of 0.25: through 900 at t = (1/0.9)², with −T/(2t).
        let tail: Vec<f64> = (1..=3).rev().map(|k| 1e3 / (0.25 * f64::from(k)).sqrt()).collect();
        let found = Cycle::of(&tail, 0.25, 900.0).rates[1];
        let exact = 900.0 / (2.0 * (1.0f64 / 0.9).powi(2));
        assert!((found / exact - 1.0).abs() < 1e-12, "{found} {exact}");
    }

    /// The temperature falls linearly with depth: the layer ends where it passes the start
    /// temperature.
    #[test]
    fn depth_and_width_of_a_wedge() {
        let criterion = Criterion { shift: 0.0, ..CRITERION };
        let along = |row: usize, depth: f64| Cycle {
            highest: 1200.0 - 100.0 * row as f64 - 1e6 * depth,
            rates: [1e5, 1e5],
        };
        let layer = WhiteLayer::of(0..8, &criterion, 1e-3, along);
        // Resolution of the bisection: a millimetre in 4096 parts.
        assert!((layer.depth - 3e-4).abs() < 1e-3 / 4096.0, "{layer:?}");
        assert_eq!((layer.rows, layer.margin), (4, 300.0));
        let slow = |row: usize, depth: f64| Cycle { rates: [1e5, 10.0], ..along(row, depth) };
        assert_eq!(WhiteLayer::of(0..8, &criterion, 1e-3, slow).rows, 0, "nothing quenches");
    }
}
