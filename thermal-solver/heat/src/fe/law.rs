//! Conductivity and heat capacity that depend on temperature, by Kirchhoff's transform.
//!
//! With Θ = ∫ λ dT from the initial temperature, conduction is linear in Θ for any λ(T). Only the
//! heat content H(Θ) = ∫ ρc dT is nonlinear; its slope dH/dΘ = ρc/λ = 1/κ is positive. λ and c are
//! linear between the rows of a table, and constant beyond it.
//!
//! H(Θ) and T(Θ) are tabulated in [`STEPS`] pieces over equal steps of Θ. They grow by the exact
//! amount in each piece, for any width of a peak of the heat capacity. Their slopes are linear in a
//! piece, which leaves an error of some 1e-8 for a smooth law. The slopes are the derivatives of
//! the tabulated functions, as Newton's method needs, and positive.

/// Number of equal steps of Θ. The table has as many nodes, so that no index is out of range.
const STEPS: usize = 8192;
/// Added to a number, this constant leaves the nearest whole number in the last bits.
const WHOLE: f64 = 4_503_599_627_370_496.0;
/// Distance below a node, in steps, at which its piece of a table begins, so that positions near a
/// node on either side are counted from that node.
const OVERLAP: f64 = 1.0 / 1024.0;
/// Distance subtracted from a position before rounding to the node of its piece.
const BELOW: f64 = 0.5 - OVERLAP;
/// Distance by which a table is continued beyond its rows [K].
const BEYOND: f64 = 3000.0;

/// Properties at a temperature.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// Temperature [K].
    pub temperature: f64,
    /// Conductivity λ [W/(m·K)].
    pub conductivity: f64,
    /// Volumetric heat capacity ρc [J/(m³·K)].
    pub capacity: f64,
}

/// Tabulated law of a material.
#[derive(Clone, Debug, PartialEq)]
pub struct Law {
    /// Index of the node at Θ = 0.
    zero: f64,
    inverse_step: f64,
    step: f64,
    heats: Box<[Node; STEPS]>,
    rises: Box<[Node; STEPS]>,
    initial: f64,
    points: Vec<Point>,
}

/// A node of a table: a function, its slope, and the change of the slope towards the next node.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(align(32))]
struct Node {
    value: f64,
    slope: f64,
    bend: f64,
}

/// Heat content at a given Θ.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeatContent {
    /// H [J/m³].
    pub heat: f64,
    /// dH/dΘ [s/m²].
    pub rate: f64,
}

impl Law {
    /// Creates the law through points at rising temperatures, for a body with the initial
    /// temperature `initial` [K].
    ///
    /// # Panics
    /// `points` is empty.
    #[must_use]
    pub fn new(points: &[Point], initial: f64) -> Self {
        let at = |rise: f64| properties(points, initial + rise);
        let (coldest, hottest) = (points[0].temperature, points[points.len() - 1].temperature);
        let (from, to) =
            ((coldest - initial).min(0.0) - BEYOND, (hottest - initial).max(0.0) + BEYOND);
        // Θ at the corners of λ(T), exactly, with parabolas between.
        let inside = points.iter().map(|point| point.temperature - initial);
        let mut corners: Vec<f64> = [from, to, 0.0].into_iter().chain(inside).collect();
        corners.sort_by(f64::total_cmp);
        corners.dedup();
        let mut potentials = vec![0.0];
        for pair in corners.windows(2) {
            let mean = 0.5 * (at(pair[0]).0 + at(pair[1]).0);
            potentials.push(potentials[potentials.len() - 1] + mean * (pair[1] - pair[0]));
        }
        let zero = corners.iter().position(|corner| *corner == 0.0).expect("zero is a corner");
        let origin = potentials[zero];
        potentials.iter_mut().for_each(|potential| *potential -= origin);
        let (lowest, highest) = (potentials[0], potentials[potentials.len() - 1]);
        let step = (highest - lowest) / (STEPS - 1) as f64;
        let zero = (-lowest / step).ceil();
        let rise = |potential: f64| {
            let next = potentials.partition_point(|p| *p <= potential).clamp(1, corners.len() - 1);
            let (low, high) = (at(corners[next - 1]).0, at(corners[next]).0);
            let length = corners[next] - corners[next - 1];
            let (slope, rest) = ((high - low) / length, potential - potentials[next - 1]);
            corners[next - 1]
                + 2.0 * rest / (low + (low * low + 2.0 * slope * rest).max(0.0).sqrt())
        };
        let begins = |node: usize| rise((node as f64 - OVERLAP - zero) * step);
        let places: Vec<f64> = (0..=STEPS).map(begins).collect();
        let tabulated = |of: &dyn Fn(f64) -> Slope| {
            let pieces = places.windows(2).map(|pair| {
                let first = corners.partition_point(|corner| *corner <= pair[0]);
                let inside = corners[first..].iter().take_while(|corner| **corner < pair[1]);
                let ends = std::iter::once(&pair[0]).chain(inside).chain(&pair[1..]);
                Piece::new(&ends.map(|rise| of(*rise)).collect::<Vec<Slope>>(), step)
            });
            tabulate(step, zero as usize, &pieces.collect::<Vec<Piece>>())
        };
        let slope = |rise: f64, over_rise: f64| Slope {
            rise,
            over_rise,
            over_potential: over_rise / at(rise).0,
        };
        Self {
            zero,
            inverse_step: 1.0 / step,
            step,
            heats: tabulated(&|rise| slope(rise, at(rise).1)),
            rises: tabulated(&|rise| slope(rise, 1.0)),
            initial,
            points: points.to_vec(),
        }
    }

    /// Creates the law of constant properties.
    #[must_use]
    pub fn constant(conductivity: f64, capacity: f64, initial: f64) -> Self {
        Self::new(&[Point { temperature: initial, conductivity, capacity }], initial)
    }

    /// Returns the initial temperature [K].
    #[must_use]
    pub fn initial(&self) -> f64 {
        self.initial
    }

    /// Returns the conductivity at the initial temperature [W/(m·K)].
    #[must_use]
    pub fn conductivity(&self) -> f64 {
        properties(&self.points, self.initial).0
    }

    /// Returns a function and its slope at Θ. Positions are counted from the node at Θ = 0, so that
    /// a small rise keeps all its digits.
    #[inline(always)]
    fn look_up(&self, table: &[Node; STEPS], potential: f64) -> [f64; 2] {
        let at = potential * self.inverse_step + self.zero;
        let whole = (at - BELOW).clamp(0.0, (STEPS - 1) as f64) + WHOLE;
        let Node { value, slope, bend } = table[whole.to_bits() as usize % STEPS];
        let rest = potential - ((whole - WHOLE) - self.zero) * self.step;
        let more = rest * bend;
        [value + rest * (slope + 0.5 * more), slope + more]
    }

    /// Returns the heat content at Θ [W/m].
    #[inline(always)]
    #[must_use]
    pub fn held(&self, potential: f64) -> HeatContent {
        let [heat, rate] = self.look_up(&self.heats, potential);
        HeatContent { heat, rate }
    }

    /// Returns the temperature rise at Θ [K].
    #[inline(always)]
    #[must_use]
    pub fn rise(&self, potential: f64) -> f64 {
        self.look_up(&self.rises, potential)[0]
    }

    /// Returns 1/λ at Θ [m·K/W].
    #[must_use]
    pub fn resistivity(&self, potential: f64) -> f64 {
        self.look_up(&self.rises, potential)[1]
    }

    /// Returns Θ [W/m] at a temperature rise [K].
    #[must_use]
    pub fn potential(&self, rise: f64) -> f64 {
        let node = self.rises.partition_point(|node| node.value <= rise).max(1) - 1;
        let Node { value, slope, bend } = self.rises[node];
        let over = rise - value;
        let root = (slope * slope + 2.0 * bend * over).max(0.0).sqrt();
        (node as f64 - self.zero) * self.step + 2.0 * over / (slope + root)
    }
}

/// Slopes of a function at a point: over the rise, linear between corners, and over Θ.
struct Slope {
    rise: f64,
    over_rise: f64,
    over_potential: f64,
}

/// A function over one step of Θ.
struct Piece {
    /// Increment of the function.
    growth: f64,
    /// Slopes at both ends; linear between.
    ends: [f64; 2],
}

impl Piece {
    /// Builds a piece from its slopes at both ends and at the corners between. The increment is
    /// exact. The difference of the end slopes is limited so that the linear slope gives this
    /// increment and stays above the least slope.
    fn new(slopes: &[Slope], step: f64) -> Self {
        let part = |pair: &[Slope]| {
            0.5 * (pair[0].over_rise + pair[1].over_rise) * (pair[1].rise - pair[0].rise)
        };
        let growth: f64 = slopes.windows(2).map(part).sum();
        let over_potential = || slopes.iter().map(|slope| slope.over_potential);
        let (mean, least) = (growth / step, over_potential().fold(f64::INFINITY, f64::min));
        let half = 0.5 * (slopes[slopes.len() - 1].over_potential - slopes[0].over_potential);
        let most = (mean - least).max(0.0);
        let half = half.clamp(-most, most);
        Self { growth, ends: [mean - half, mean + half] }
    }
}

/// Builds the nodes of a function in pieces that is zero at one node.
fn tabulate(step: f64, zero: usize, pieces: &[Piece]) -> Box<[Node; STEPS]> {
    let mut nodes = Box::new([Node::default(); STEPS]);
    // Step back from a node to the beginning of its piece.
    let overlap = OVERLAP * step;
    let mut before = Vec::with_capacity(STEPS);
    for (node, Piece { ends: [first, last], .. }) in nodes.iter_mut().zip(pieces) {
        node.bend = (last - first) / step;
        node.slope = first + overlap * node.bend;
        before.push(overlap * (first + 0.5 * overlap * node.bend));
    }
    let growth = |node: usize| pieces[node].growth - before[node] + before[node + 1];
    for node in zero + 1..STEPS {
        nodes[node].value = nodes[node - 1].value + growth(node - 1);
    }
    for node in (0..zero).rev() {
        nodes[node].value = nodes[node + 1].value - growth(node);
    }
    nodes
}

/// Returns λ and ρc at a temperature.
fn properties(points: &[Point], temperature: f64) -> (f64, f64) {
    let next = points.partition_point(|point| point.temperature <= temperature);
    let (low, high) = (&points[next.saturating_sub(1)], &points[next.min(points.len() - 1)]);
    let length = high.temperature - low.temperature;
    let part = if length > 0.0 { (temperature - low.temperature) / length } else { 0.0 };
    let mix = |a: f64, b: f64| a + part * (b - a);
    (mix(low.conductivity, high.conductivity), mix(low.capacity, high.capacity))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// λ falls and c rises linearly: closed forms of Θ, H and their inverse. Tolerance: the steps
    /// of the table.
    #[test]
    fn a_straight_law_has_its_closed_forms() {
        let (cold, initial, slope) = (50.0, 293.15, -5e-4);
        let point = |rise: f64| Point {
            temperature: initial + rise,
            conductivity: cold * (1.0 + slope * rise),
            capacity: 3e6 * (1.0 + 1e-3 * rise),
        };
        let law = Law::new(&[point(-200.0), point(1000.0)], initial);
        for rise in [-150.0, 0.0, 1.0, 281.7, 999.0] {
            let potential = cold * rise * (1.0 + 0.5 * slope * rise);
            assert!(
                (law.rise(potential) - rise).abs() < 1e-6 * 281.7,
                "{rise} {}",
                law.rise(potential)
            );
            assert!((law.potential(rise) - potential).abs() < 1e-6 * cold * 281.7);
            let heat = 3e6 * rise * (1.0 + 0.5e-3 * rise);
            assert!((law.held(potential).heat - heat).abs() < 1e-6 * 3e6 * 999.0, "{rise}");
        }
    }

    /// Constant properties are exact to rounding, far beyond any table and for any small rise.
    #[test]
    fn constant_properties_are_exact() {
        let law = Law::constant(50.0, 3e6, 300.0);
        for rise in [-250.0, 0.0, 1e-30, 1e-3, 2500.0_f64] {
            assert!((law.rise(50.0 * rise) - rise).abs() <= 1e-12 * rise.abs());
            assert!((law.held(50.0 * rise).heat - 3e6 * rise).abs() <= 1e-12 * 3e6 * rise.abs());
        }
    }

    /// A peak of the heat capacity over 0.2 K, less than a step of the table, between constant
    /// properties. The heat content is exact on both sides of the peak, and no slope is below that
    /// of the constant properties. Tolerance: rounding.
    #[test]
    fn the_heat_of_a_narrow_peak_is_kept() {
        let initial = 300.0;
        for place in [350.0, 350.13, 350.41, 351.0] {
            let point = |over: f64, capacity: f64| Point {
                temperature: place + over,
                conductivity: 50.0,
                capacity,
            };
            let law = Law::new(&[point(-0.1, 3e6), point(0.0, 5e9), point(0.1, 3e6)], initial);
            let latent = 0.1 * (5e9 - 3e6);
            for rise in [20.0, 45.0, 55.0, 400.0] {
                let heat = 3e6 * rise + if initial + rise > place { latent } else { 0.0 };
                let found = law.held(law.potential(rise));
                assert!((found.heat / heat - 1.0).abs() < 1e-10, "{place} {rise} {}", found.heat);
            }
            let least = (0..20_000).map(|k| law.held(50.0 * 5e-3 * f64::from(k)).rate);
            let least = least.fold(f64::INFINITY, f64::min);
            assert!(least > (1.0 - 1e-10) * 3e6 / 50.0, "{place} {least}");
        }
    }

    /// A conductivity that falls to a hundredth over a tenth of a kelvin: Θ and the rise are
    /// inverse to each other. Tolerance: rounding.
    #[test]
    fn a_step_of_the_conductivity_is_inverted() {
        let point = |temperature: f64, conductivity: f64| Point {
            temperature,
            conductivity,
            capacity: 3e6,
        };
        let law = Law::new(&[point(400.0, 50.0), point(400.1, 0.5)], 300.0);
        for rise in [-2000.0, -1.0, 0.0, 99.9, 100.05, 100.2, 101.0, 1000.0] {
            let found = law.rise(law.potential(rise));
            assert!((found - rise).abs() < 1e-10 * (1.0 + rise.abs()), "{rise} {found}");
        }
    }
}
