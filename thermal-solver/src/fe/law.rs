//! Conductivity and heat capacity that depend on temperature, by Kirchhoff's transform.
//!
//! With Θ = ∫ λ dT, from the initial temperature on, conduction is linear in Θ whatever λ(T) is, and all that is not is
//! the heat H(Θ) = ∫ ρc dT that a place holds, whose slope dH/dΘ = ρc/λ = 1/κ is positive. Between the
//! lines of a table λ and c are straight, and constant beyond it.
//!
//! H(Θ) and T(Θ) are tabulated at [`STEPS`] even steps of Θ, their slopes being straight in between: what that leaves
//! is some 1e-8, and the slopes are those of the functions themselves, as Newton's method asks for.

/// Even steps of Θ; the table has as many nodes, so that no index is beyond it.
const STEPS: usize = 8192;
/// What is added to a number so that its last bits are the nearest whole one.
const WHOLE: f64 = 4_503_599_627_370_496.0;
/// What is taken from a place before it is rounded to the node below it: less than a half, so that what is next to a
/// node counts from that node, on either side.
const BELOW: f64 = 0.5 - 1.0 / 1024.0;
/// How far beyond its lines a table is continued [K].
const BEYOND: f64 = 3000.0;

/// Properties at a temperature.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// Temperature [K].
    pub temperature: f64,
    /// Conductivity λ [W/(m·K)].
    pub conductivity: f64,
    /// Heat capacity by volume ρc [J/(m³·K)].
    pub capacity: f64,
}

/// A material.
#[derive(Clone, Debug, PartialEq)]
pub struct Law {
    /// Number of the node at Θ = 0.
    zero: f64,
    inverse_step: f64,
    step: f64,
    heats: Box<[Node; STEPS]>,
    rises: Box<[Node; STEPS]>,
    initial: f64,
    points: Vec<Point>,
}

/// A node of a table: a function, its slope, and the slope of that towards the next node.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(align(32))]
struct Node {
    value: f64,
    slope: f64,
    bend: f64,
}

/// What a place with a Θ has.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Held {
    /// H [J/m³].
    pub heat: f64,
    /// dH/dΘ [s/m²].
    pub rate: f64,
}

impl Law {
    /// Of points at rising temperatures, for a body that is at `initial` [K] when it is cold.
    ///
    /// # Panics
    /// Without points.
    #[must_use]
    pub fn new(points: &[Point], initial: f64) -> Self {
        let at = |temperature: f64| properties(points, temperature);
        let (coldest, hottest) = (points[0].temperature, points[points.len() - 1].temperature);
        let (from, to) = (coldest.min(initial) - BEYOND, hottest.max(initial) + BEYOND);
        // Θ at the corners of λ(T), exactly: parabolas between.
        let inside = points.iter().map(|point| point.temperature);
        let mut corners: Vec<f64> = [from, to, initial].into_iter().chain(inside).collect();
        corners.sort_by(f64::total_cmp);
        corners.dedup();
        let mut potentials = vec![0.0];
        for pair in corners.windows(2) {
            let mean = 0.5 * (at(pair[0]).0 + at(pair[1]).0);
            potentials.push(potentials[potentials.len() - 1] + mean * (pair[1] - pair[0]));
        }
        let zero = corners.iter().position(|corner| *corner == initial).expect("it is a corner");
        let origin = potentials[zero];
        potentials.iter_mut().for_each(|potential| *potential -= origin);
        let (lowest, highest) = (potentials[0], potentials[potentials.len() - 1]);
        let step = (highest - lowest) / (STEPS - 1) as f64;
        let zero = (-lowest / step).ceil();
        let temperature = |potential: f64| {
            let next = potentials.partition_point(|p| *p <= potential).clamp(1, corners.len() - 1);
            let (low, high) = (at(corners[next - 1]).0, at(corners[next]).0);
            let length = corners[next] - corners[next - 1];
            let (slope, rest) = ((high - low) / length, potential - potentials[next - 1]);
            corners[next - 1]
                + 2.0 * rest / (low + (low * low + 2.0 * slope * rest).max(0.0).sqrt())
        };
        let slopes = |of: &dyn Fn(f64, f64) -> f64| {
            let slope = |node: usize| {
                let (conductivity, capacity) = at(temperature((node as f64 - zero) * step));
                of(conductivity, capacity)
            };
            tabulate(step, zero as usize, slope)
        };
        Self {
            zero,
            inverse_step: 1.0 / step,
            step,
            heats: slopes(&|conductivity, capacity| capacity / conductivity),
            rises: slopes(&|conductivity, _| 1.0 / conductivity),
            initial,
            points: points.to_vec(),
        }
    }

    /// Of constant properties.
    #[must_use]
    pub fn constant(conductivity: f64, capacity: f64, initial: f64) -> Self {
        Self::new(&[Point { temperature: initial, conductivity, capacity }], initial)
    }

    /// Temperature of the cold body [K].
    #[must_use]
    pub fn initial(&self) -> f64 {
        self.initial
    }

    /// Conductivity of the cold body [W/(m·K)].
    #[must_use]
    pub fn conductivity(&self) -> f64 {
        properties(&self.points, self.initial).0
    }

    /// A function and its slope where Θ is this. Counted from Θ = 0, where a node is, so that what is nearly
    /// cold has all its digits.
    #[inline(always)]
    fn look_up(&self, table: &[Node; STEPS], potential: f64) -> [f64; 2] {
        let at = potential * self.inverse_step + self.zero;
        let whole = (at - BELOW).clamp(0.0, (STEPS - 1) as f64) + WHOLE;
        let Node { value, slope, bend } = table[whole.to_bits() as usize % STEPS];
        let rest = potential - ((whole - WHOLE) - self.zero) * self.step;
        let more = rest * bend;
        [value + rest * (slope + 0.5 * more), slope + more]
    }

    /// Heat that a place with this Θ [W/m] holds.
    #[inline(always)]
    #[must_use]
    pub fn held(&self, potential: f64) -> Held {
        let [heat, rate] = self.look_up(&self.heats, potential);
        Held { heat, rate }
    }

    /// Rise of its temperature [K].
    #[inline(always)]
    #[must_use]
    pub fn rise(&self, potential: f64) -> f64 {
        self.look_up(&self.rises, potential)[0]
    }

    /// 1/λ there [m·K/W].
    #[must_use]
    pub fn resistivity(&self, potential: f64) -> f64 {
        self.look_up(&self.rises, potential)[1]
    }

    /// Θ [W/m] at a rise of the temperature [K], by Newton's method.
    #[must_use]
    pub fn potential(&self, rise: f64) -> f64 {
        let mut potential = rise * self.conductivity();
        for _ in 0..60 {
            let error = self.rise(potential) - rise;
            potential -= error / self.resistivity(potential);
            if error.abs() <= 1e-13 * rise.abs() {
                break;
            }
        }
        potential
    }
}

/// Nodes of a function with these slopes that is zero at one of them.
fn tabulate(step: f64, zero: usize, slope: impl Fn(usize) -> f64) -> Box<[Node; STEPS]> {
    let slopes: Vec<f64> = (0..=STEPS).map(slope).collect();
    let mut nodes = Box::new([Node::default(); STEPS]);
    for (node, pair) in nodes.iter_mut().zip(slopes.windows(2)) {
        (node.slope, node.bend) = (pair[0], (pair[1] - pair[0]) / step);
    }
    let between = |node: usize| 0.5 * step * (slopes[node] + slopes[node + 1]);
    for node in zero + 1..STEPS {
        nodes[node].value = nodes[node - 1].value + between(node - 1);
    }
    for node in (0..zero).rev() {
        nodes[node].value = nodes[node + 1].value - between(node);
    }
    nodes
}

/// λ and ρc at a temperature.
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

    /// λ falls straight, c rises: closed forms of Θ, H and their inverse. Tolerance: the steps.
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

    /// Constant properties are met to rounding, far beyond any table, and however little a place has warmed.
    #[test]
    fn constant_properties_are_exact() {
        let law = Law::constant(50.0, 3e6, 300.0);
        for rise in [-250.0, 0.0, 1e-30, 1e-3, 2500.0_f64] {
            assert!((law.rise(50.0 * rise) - rise).abs() <= 1e-12 * rise.abs());
            assert!((law.held(50.0 * rise).heat - 3e6 * rise).abs() <= 1e-12 * 3e6 * rise.abs());
        }
    }
}
