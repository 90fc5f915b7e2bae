//! Regions of penetration, and the patches that they make.
//!
//! *Patches.* Regions are of one patch if the distance along the tape from the last row of one to the first of
//! the next is no more than [`Joining::distance`], and their angles differ by no more than
//! [`Joining::angle`]: they then are solved on one half-space and feel each other. Others are of two patches, each
//! in a plane of its own, that do not. As that makes a step of the force over the height of the wheel, patches are
//! held as they are, apart at some rows between them, while a height is looked for.
//!
//! *Reference.* A patch has the place and the angle that are the means over it, weighted with the
//! squared penetration, integrated along x ([`super::gap`]). Its angle thus is continuous in the position of the
//! wheel.
//!
//! CONTACT weights alike. Between two distances it attenuates the mutual influence in steps, and turns the
//! planes of patches that come near each other; here there is one distance and neither.

use super::gap::Gap;

/// When regions are of one patch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Joining {
    /// Largest distance along the tape [m].
    pub distance: f64,
    /// Largest difference of their angles [rad].
    pub angle: f64,
}

impl Default for Joining {
    /// 4 mm, and any angle that a railhead has.
    fn default() -> Self {
        Self { distance: 4e-3, angle: std::f64::consts::FRAC_PI_2 }
    }
}

/// A row that penetrates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Penetrated {
    pub(super) row: i64,
    pub(super) s: f64,
    pub(super) angle: f64,
    pub(super) gap: Gap,
    pub(super) at_end: bool,
}

/// Rows at which patches are apart, rising: a patch has rows from one of them to the last before the next.
pub type Cuts = [i64];

/// A region, or several of one patch.
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
    /// The region reaches an end of the rail's or the wheel's profile.
    pub at_end: bool,
    weight: f64,
}

/// Regions, those between the same cuts as one. A region that goes on over a cut is on both sides of it.
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
