//! Quadrature rule over the wave number s in depth.
//!
//! Gauss's rule in panels of s, the first from 0, and of ln s, each 1.5 long: a term that decays by
//! e^{−κs²t} is smooth in ln s at all times t from [`SHORTEST`] to [`LONGEST`]. With cos(sz) in the
//! integral the factor of the state is still as smooth, and the product is integrated with the
//! polynomial through its nodes in every panel (Filon).

use numerics::quadrature::{POINTS, points};

/// Range of times that states must represent [s].
const SHORTEST: f64 = 1e-9;
const LONGEST: f64 = 1e5;
/// √(κt) s below which a time t has no effect, and above which everything has decayed.
const BEGIN: f64 = 0.1;
const END: f64 = 8.0;
/// Length of a panel in ln s.
const PANEL: f64 = 1.5;
/// Phase sz over a panel up to which the product is as smooth as the state.
const SLOW: f64 = 4.0;
/// Phase sz over which Gauss's rule integrates the product.
const PIECE: f64 = 6.0;
/// Phase sz over a panel from which the oscillating integral is below the rule's error.
const MOST_TURNS: f64 = 1e4;

/// Nodes and weights for one diffusivity.
#[derive(Clone, Debug)]
pub struct Rule {
    /// Ends of the panels [1/m].
    ends: Vec<f64>,
    /// Nodes s [1/m].
    pub nodes: Vec<f64>,
    /// Weights [1/m].
    pub weights: Vec<f64>,
}

impl Rule {
    /// Creates the rule for a diffusivity κ [m²/s] and waves from the longest to the shortest
    /// [rad/m].
    #[must_use]
    pub fn new(diffusivity: f64, [longest, shortest]: [f64; 2]) -> Self {
        let first = (BEGIN / (diffusivity * LONGEST).sqrt()).min(BEGIN * longest);
        let last = (END / (diffusivity * SHORTEST).sqrt()).max(shortest / BEGIN.powi(2));
        let count = ((last / first).ln() / PANEL).ceil();
        let step = (last / first).ln() / count;
        let ends: Vec<f64> = std::iter::once(0.0)
            .chain((0..=count as usize).map(|panel| first * (step * panel as f64).exp()))
            .collect();
        let mut rule = Self { ends, nodes: Vec::new(), weights: Vec::new() };
        for panel in 0..rule.ends.len() - 1 {
            let [from, to] = rule.range(panel);
            for (place, weight) in points(from, to) {
                let node = if panel == 0 { place } else { place.exp() };
                rule.nodes.push(node);
                rule.weights.push(if panel == 0 { weight } else { weight * node });
            }
        }
        rule
    }

    /// Returns the largest wave number of the rule [1/m].
    #[must_use]
    pub fn last(&self) -> f64 {
        self.ends[self.ends.len() - 1]
    }

    /// Returns a panel in its own variable: s, or ln s.
    fn range(&self, panel: usize) -> [f64; 2] {
        let ends = [self.ends[panel], self.ends[panel + 1]];
        if panel == 0 { ends } else { ends.map(f64::ln) }
    }

    /// Returns the weights of the nodes with cos(sz), for a function that has decayed beyond some
    /// wave number [1/m].
    #[must_use]
    pub fn with_cosine(&self, depth: f64, decayed: f64) -> Vec<f64> {
        let mut weights = vec![0.0; self.nodes.len()];
        for panel in 0..self.ends.len() - 1 {
            let own = panel * POINTS..(panel + 1) * POINTS;
            let (from, to) = (self.ends[panel], self.ends[panel + 1]);
            let turns = (to - from) * depth;
            if turns < SLOW {
                for at in own {
                    weights[at] = self.weights[at] * (self.nodes[at] * depth).cos();
                }
            } else if from < decayed && from * depth < MOST_TURNS {
                self.filon(panel, depth, to.min(2.0 * decayed), &mut weights[own]);
            }
        }
        weights
    }

    fn filon(&self, panel: usize, depth: f64, to: f64, weights: &mut [f64]) {
        let variable = |s: f64| if panel == 0 { s } else { s.ln() };
        let nodes: [f64; POINTS] =
            std::array::from_fn(|at| variable(self.nodes[panel * POINTS + at]));
        let [low, high] = self.range(panel);
        let scale = 4.0 / (high - low);
        // Barycentric weights of the polynomial through the nodes.
        let barycentric: [f64; POINTS] = std::array::from_fn(|j| {
            let others = nodes.iter().enumerate().filter(|(at, _)| *at != j);
            others.map(|(_, node)| scale * (nodes[j] - node)).product::<f64>().recip()
        });
        let from = self.ends[panel];
        let pieces = ((to - from) * depth / PIECE).ceil();
        let end = |piece: f64| from + (to - from) * piece / pieces;
        for piece in 0..pieces as usize {
            let piece = piece as f64;
            for (s, weight) in points(end(piece), end(piece + 1.0)) {
                let u = variable(s);
                let weight = weight * (s * depth).cos();
                if let Some(at) = nodes.iter().position(|node| *node == u) {
                    weights[at] += weight;
                    continue;
                }
                let parts: [f64; POINTS] = std::array::from_fn(|j| barycentric[j] / (u - nodes[j]));
                let share = weight / parts.iter().sum::<f64>();
                weights.iter_mut().zip(parts).for_each(|(sum, part)| *sum += share * part);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    const DIFFUSIVITY: f64 = 1.5e-5;

    /// (2/π) ∫ e^{−κs²t} cos(sz) ds is e^{−z²/4κt}/√(πκt): at the surface at all times of the rule,
    /// and below it. Tolerances: those of the module.
    #[test]
    fn heat_of_an_instant() {
        let rule = Rule::new(DIFFUSIVITY, [1e3; 2]);
        for exponent in -9..=5 {
            let time = 10_f64.powi(exponent);
            let spread = DIFFUSIVITY * time;
            let highest = (PI * spread).sqrt().recip();
            for over in [0.0_f64, 0.3, 1.0, 3.0] {
                let depth = over * spread.sqrt();
                let weights = rule.with_cosine(depth, 6.0 / spread.sqrt());
                let sum: f64 = rule
                    .nodes
                    .iter()
                    .zip(weights)
                    .map(|(s, weight)| weight * (-spread * s * s).exp())
                    .sum();
                let found = 2.0 / PI * sum;
                let expected = highest * (-0.25 * over * over).exp();
                let tolerance = if over == 0.0 { 1e-8 } else { 1e-4 };
                let error = (found - expected).abs() / highest;
                assert!(error < tolerance, "{time} {over}: {found} {expected} {error:e}");
            }
        }
    }
}
