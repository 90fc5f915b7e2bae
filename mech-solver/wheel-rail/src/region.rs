//! Regions of penetration, and the patches that they form.
//!
//! *Patches.* Two regions belong to one patch if the distance along the tape from the last row of
//! one to the first row of the next is at most [`Joining::distance`], and if their angles differ by
//! at most [`Joining::angle`]. They are then solved on one half-space and influence each other.
//! Otherwise they form two patches, each in its own plane, without mutual influence. This criterion
//! makes the force jump over the height of the wheel. The separation at certain rows is therefore
//! kept while a height is searched.
//!
//! *Reference.* The position and angle of a patch are means over the patch, weighted with the
//! squared penetration, integrated along x ([`super::gap`]). The angle is therefore continuous in
//! the position of the wheel.
//!
//! CONTACT uses the same weights. Between two distances it reduces the mutual influence in steps,
//! and turns the planes of patches that come near each other. Here there is one distance, and
//! neither of the two.

use super::gap::Gap;

/// Criterion for regions that belong to one patch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Joining {
    /// Largest distance along the tape [m].
    pub distance: f64,
    /// Largest difference of the angles [rad].
    pub angle: f64,
}

impl Default for Joining {
    /// 4 mm, and any angle that occurs on a railhead.
    fn default() -> Self {
        Self { distance: 4e-3, angle: std::f64::consts::FRAC_PI_2 }
    }
}

/// Row in which the bodies penetrate each other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Penetrated {
    pub(super) row: i64,
    pub(super) s: f64,
    pub(super) angle: f64,
    pub(super) gap: Gap,
    pub(super) at_end: bool,
}

/// Rows at which patches are separated, in ascending order. A patch extends from one of them to the
/// last row before the next.
pub type Cuts = [i64];

/// A region, or several that form one patch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Region {
    /// First and last row j.
    pub rows: [i64; 2],
    /// Least and largest x [m].
    pub x_range: [f64; 2],
    /// Largest penetration along a normal [m].
    pub penetration: f64,
    /// x of the reference [m].
    pub x: f64,
    /// Tape distance of the reference [m].
    pub s: f64,
    /// Angle of the reference, from the y-axis to the rail's tangent [rad].
    pub angle: f64,
    /// True if the region reaches an end of the rail's or the wheel's profile.
    pub at_end: bool,
    weight: f64,
}

/// Joins all regions between the same two cuts. A region that extends across a cut appears on both
/// sides.
pub(super) fn grouped(rows: &[Region], cuts: &Cuts) -> Vec<Region> {
    let cell = |region: &Region| cuts.partition_point(|cut| *cut <= region.rows[0]);
    let mut patches: Vec<(usize, Region)> = Vec::new();
    for region in rows {
        match patches.last_mut() {
            Some((of, last)) if *of == cell(region) => last.join(region),
            _ => patches.push((cell(region), *region)),
        }
    }
    patches.into_iter().map(|(_, region)| region).collect()
}

impl Region {
    pub(super) fn of(row: &Penetrated) -> Self {
        let Gap { gap, x, x_range, weight } = row.gap;
        Self {
            rows: [row.row; 2],
            x_range,
            penetration: -gap,
            x,
            s: row.s,
            angle: row.angle,
            at_end: row.at_end,
            weight,
        }
    }

    pub(super) fn joins(&self, next: &Self, spacing: f64, joining: &Joining) -> bool {
        let distance = (next.rows[0] - self.rows[1]) as f64 * spacing;
        distance <= joining.distance && (next.angle - self.angle).abs() <= joining.angle
    }

    pub(super) fn join(&mut self, next: &Self) {
        let weight = self.weight + next.weight;
        let mean = |one: f64, other: f64| match weight > 0.0 {
            true => (self.weight * one + next.weight * other) / weight,
            false => 0.5 * (one + other),
        };
        *self = Self {
            rows: [self.rows[0], next.rows[1]],
            x_range: [self.x_range[0].min(next.x_range[0]), self.x_range[1].max(next.x_range[1])],
            penetration: self.penetration.max(next.penetration),
            x: mean(self.x, next.x),
            s: mean(self.s, next.s),
            angle: mean(self.angle, next.angle),
            at_end: self.at_end || next.at_end,
            weight,
        };
    }
}
