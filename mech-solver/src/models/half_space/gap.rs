//! Undeformed distance of the smooth bodies.
//!
//! h(x, y) = x²/(2R₁(y)) + x²/(2R₂(y)) + z₁(y − s₁) − z₂(y − s₂), minus its smallest value. z₁ and
//! z₂ are the lateral shapes of the upper and the lower body, s₁ and s₂ their lateral shifts. A
//! round body with a measured profile has the radius R₁(y) = R + z₁(0) − z₁(y − s₁), or R₂(y) = R +
//! z₂(y − s₂) − z₂(0). The distance is measured along z, which is the contact normal for small
//! contact angles only; a steeper contact is refused.

use crate::case::keys::CheckedParams;
use crate::case::scene::Scene;
use crate::case::shape::lateral::millimetres;
use crate::case::shape::{self, BodyShape};
use half_space::extent::FittedContact;
use half_space::patches::patches;
use proto::bodies::{LOWER, UPPER};
use proto::configuration::{Configuration, Refusal};
use proto::grid::Structured;

/// Number of points at which the lateral distance is searched for its minimum.
const SAMPLES: usize = 2000;
/// Maximum contact angle treated as plane [rad].
const STEEPEST: f64 = 0.2;
/// Height difference, relative to the range of heights, below which two points touch
/// simultaneously; covers rounding.
const TIE: f64 = 1e-9;

/// Undeformed distance of two bodies.
#[derive(Clone, Debug)]
pub(in crate::models) struct Gap {
    /// Upper and lower body.
    sides: [BodyShape; 2],
    /// Smallest lateral distance [m].
    closest: f64,
    /// Lateral coordinate of the origin [m].
    pub(in crate::models) origin: f64,
}

impl Gap {
    /// Reads the shapes of both bodies.
    pub(super) fn read(configuration: &Configuration, scene: &Scene) -> Result<Self, Refusal> {
        let case = CheckedParams::new(&configuration.case, shape::keys());
        Ok(Self {
            sides: [BodyShape::read(&case, scene, UPPER)?, BodyShape::read(&case, scene, LOWER)?],
            closest: 0.0,
            origin: 0.0,
        })
    }

    /// Applies the radii of another row; profiles stay.
    pub(super) fn follow(&mut self, scene: &Scene) {
        for (side, body) in self.sides.iter_mut().zip(&scene.bodies) {
            side.follow(body);
        }
    }

    /// Key of the first profile, named in errors about shapes.
    pub(super) fn profile_key(&self) -> &str {
        let shaped = self.sides.iter().rev().find(|side| !side.is_parabola());
        &shaped.unwrap_or(&self.sides[LOWER]).key
    }

    /// Returns whether both bodies are parabolic, so that without terms of the gap the contact is
    /// Hertzian.
    pub(super) fn is_quadric(&self) -> bool {
        self.sides.iter().all(BodyShape::is_parabola)
    }

    /// Returns whether a body is the parabola of its radius.
    pub(in crate::models) fn is_parabola(&self, body: usize) -> bool {
        self.sides[body].is_parabola()
    }

    /// Depth of a body's surface below the reference height, positive into the body [m], at a
    /// lateral position from the origin. The reference is the lower body's height at the origin,
    /// where the bodies touch.
    pub(in crate::models) fn drop(&self, body: usize, y: f64) -> f64 {
        let level = self.sides[LOWER].height(self.origin);
        let up = self.sides[body].up;
        let closest = if body == UPPER { self.closest } else { 0.0 };
        up * (self.sides[body].height(y + self.origin) - level - closest)
    }

    /// Rolling radius of a body at the reference height of [`Gap::drop`] [m].
    pub(in crate::models) fn radius(&self, body: usize) -> f64 {
        self.sides[body].radius(self.origin) + self.drop(body, 0.0)
    }

    fn lateral(&self, y: f64) -> f64 {
        self.sides[UPPER].height(y) - self.sides[LOWER].height(y)
    }

    /// Undeformed distance at (x, y) from the origin [m].
    pub(super) fn distance(&self, x: f64, y: f64) -> f64 {
        let y = y + self.origin;
        let [upper, lower] = self.sides.each_ref().map(|side| 0.5 * x * x / side.radius(y));
        upper + lower + self.lateral(y) - self.closest
    }

    /// Lateral range in which both shapes are known [m].
    pub(super) fn range(&self) -> [f64; 2] {
        let [[u0, u1], [l0, l1]] = self.sides.each_ref().map(BodyShape::range);
        [u0.max(l0), u1.min(l1)]
    }

    /// Kinks of both shapes where the bodies face each other, in the frame of the contact [m].
    fn kinks(&self) -> impl Iterator<Item = f64> + '_ {
        let [first, last] = self.range();
        let both = self.sides.iter().rev().flat_map(BodyShape::kinks);
        both.filter(move |y| (first..=last).contains(y))
    }

    /// Lateral positions of kinks under a pressure, from the origin [m].
    pub(super) fn kinks_under(&self, grid: &Structured, pressure: &[f64]) -> Vec<f64> {
        let places: Vec<f64> = self.kinks().map(|y| y - self.origin).collect();
        if places.is_empty() {
            return places;
        }
        let patches = patches(grid, pressure);
        let inside = |y: &f64| {
            patches.iter().any(|patch| {
                let [low, high] = patch.sides(grid);
                (low..=high).contains(y)
            })
        };
        places.into_iter().filter(inside).collect()
    }

    /// Shifts the zero height to the first point of contact and the origin to its position. If
    /// several points touch at once, the origin is their middle, so that mirrored bodies have
    /// mirrored grids. Returns the lowest y of these points from the origin [m].
    pub(super) fn settle(&mut self) -> Result<f64, Refusal> {
        let [first, last] = self.range();
        if first >= last {
            return Err(Refusal::new(
                self.profile_key(),
                "the bodies do not face each other anywhere",
                "check the lateral coordinates of both profiles and their lateral_shift",
            ));
        }
        let at = |k: usize| first + (last - first) * k as f64 / SAMPLES as f64;
        let places = (0..=SAMPLES).map(at).chain(self.kinks());
        let heights: Vec<(f64, f64)> = places.map(|y| (y, self.lateral(y))).collect();
        let highest = heights.iter().map(|(_, z)| *z).fold(f64::NEG_INFINITY, f64::max);
        let lowest = heights.iter().map(|(_, z)| *z).fold(f64::INFINITY, f64::min);
        let level = lowest + TIE * (highest - lowest);
        let touching = || heights.iter().filter(|(_, z)| *z <= level).map(|(y, _)| *y);
        let low = touching().fold(f64::INFINITY, f64::min);
        let high = touching().fold(f64::NEG_INFINITY, f64::max);
        (self.origin, self.closest) = (0.5 * (low + high), lowest);
        Ok(low - self.origin)
    }

    /// Remarks on modifications of the shapes and on kinks within the contact.
    pub(super) fn remarks(&self, fitted: &FittedContact) -> Vec<String> {
        let mut remarks: Vec<String> =
            self.sides.iter().rev().filter_map(BodyShape::remark).collect();
        let under = self.kinks_under(&fitted.grid, &fitted.pressure);
        if !under.is_empty() {
            let places = millimetres(under.iter().map(|y| y + self.origin));
            remarks.push(format!(
                "the contact reaches kinks at y = {places}: the pressure there grows with the \
                 resolution"
            ));
        }
        remarks
    }

    /// Warnings about implausible shapes.
    pub(in crate::models) fn warnings(&self, scene: &Scene) -> Vec<Refusal> {
        let sides = self.sides.iter().enumerate();
        sides.filter_map(|(body, side)| side.warning(scene, body)).collect()
    }

    /// Refuses a contact that is too steep anywhere.
    pub(super) fn refuse_steep(&self, fitted: &FittedContact) -> Result<(), Refusal> {
        let rows = fitted.pressure.chunks_exact(fitted.grid.ni).enumerate();
        for (row, _) in rows.filter(|(_, row)| row.iter().any(|p| *p > 0.0)) {
            let y = fitted.grid.y(row) + self.origin;
            let slopes = self.sides.each_ref().map(|side| side.slope(y).abs());
            let slope = slopes[LOWER].max(slopes[UPPER]);
            if slope.atan() > STEEPEST {
                let angle = slope.atan();
                return Err(Refusal::new(
                    self.profile_key(),
                    format!(
                        "the bodies touch at y = {y:.4} m at an angle of {angle:.2} rad to the plane"
                    ),
                    format!(
                        "shift or turn the profiles until the whole contact is below {STEEPEST} rad"
                    ),
                ));
            }
        }
        Ok(())
    }
}
