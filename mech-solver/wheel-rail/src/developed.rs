//! The fields of all patches on one grid over x and the tape distance, the developed surface of the
//! rail.
//!
//! The elements of all patches belong to one grid. An element is in contact in two patches only if
//! their planes overlap at a cut ([`super::region`]); there the values are summed. Components along
//! x and along the tangent of a patch become components along x and along the tape.

use super::fields::Fields;
use super::patch::Patch;

/// Fields over x and the tape distance. Element (i, j) has the index j·nx + i and its middle at
/// ((first₀ + i) Δx, (first₁ + j) Δs).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Developed {
    /// Numbers of the first element along x and along the tape.
    pub first: [i64; 2],
    /// Elements along x and along the tape.
    pub counts: [usize; 2],
    /// Pressure [Pa].
    pub pressure: Vec<f64>,
    /// Tractions on the wheel, along x and along the tape [Pa].
    pub traction: [Vec<f64>; 2],
    /// Velocity of the wheel's surface relative to the rail's, along x and along the tape [m/s].
    pub slip_velocity: [Vec<f64>; 2],
    /// Friction power [W/m²].
    pub friction_power: Vec<f64>,
}

impl Developed {
    /// Combines the fields of patches on the smallest grid that holds all loaded elements plus
    /// `margin` elements on each side. Empty without patches.
    #[must_use]
    pub fn of(patches: &[Patch], margin: usize) -> Self {
        let mut low = [i64::MAX; 2];
        let mut high = [i64::MIN; 2];
        for [i, j] in patches.iter().flat_map(|patch| busy(&patch.fields)) {
            low = [low[0].min(i), low[1].min(j)];
            high = [high[0].max(i), high[1].max(j)];
        }
        if low[0] > high[0] {
            return Self::default();
        }
        let first = low.map(|at| at - margin as i64);
        let counts = [0, 1].map(|k| (high[k] - low[k]) as usize + 1 + 2 * margin);
        Self::on(patches, first, counts)
    }

    /// Combines the fields of patches on a given part of the grid; elements outside are omitted.
    #[must_use]
    pub fn on(patches: &[Patch], first: [i64; 2], counts: [usize; 2]) -> Self {
        let mut sum = Self::empty(first, counts);
        sum.take(patches, 0);
        sum
    }

    /// Creates a part of the grid with all fields zero.
    #[must_use]
    pub fn empty(first: [i64; 2], counts: [usize; 2]) -> Self {
        let zeros = || vec![0.0; counts[0] * counts[1]];
        Self {
            first,
            counts,
            pressure: zeros(),
            traction: [zeros(), zeros()],
            slip_velocity: [zeros(), zeros()],
            friction_power: zeros(),
        }
    }

    /// Adds the fields of patches, shifted by `rows` along the tape; elements outside are omitted.
    pub fn take(&mut self, patches: &[Patch], rows: i64) {
        patches.iter().for_each(|patch| self.add(&patch.fields, rows));
    }

    fn add(&mut self, fields: &Fields, rows: i64) {
        let [nx, ny] = fields.counts;
        for at in 0..nx * ny {
            let place = [at % nx, at / nx];
            let [i, j] = [0, 1].map(|k| fields.first[k] + place[k] as i64 - self.first[k]);
            let j = j + rows;
            let [wide, high] = self.counts.map(|count| count as i64);
            if !(0..wide).contains(&i) || !(0..high).contains(&j) {
                continue;
            }
            let to = (j * wide + i) as usize;
            self.pressure[to] += fields.pressure[at];
            self.friction_power[to] += fields.friction_power[at];
            for k in 0..2 {
                self.traction[k][to] += fields.traction[k][at];
                self.slip_velocity[k][to] += fields.slip_velocity[k][at];
            }
        }
    }
}

/// Numbers of the elements of a patch with pressure or power.
fn busy(fields: &Fields) -> impl Iterator<Item = [i64; 2]> + '_ {
    let [nx, _] = fields.counts;
    let values = fields.pressure.iter().zip(&fields.friction_power).enumerate();
    let busy = values.filter(|(_, (p, power))| **p > 0.0 || **power != 0.0);
    busy.map(move |(at, _)| {
        [fields.first[0] + (at % nx) as i64, fields.first[1] + (at / nx) as i64]
    })
}
