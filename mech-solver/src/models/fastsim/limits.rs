//! Traction bounds of a contact whose friction is not one coefficient.
//!
//! At (x, y) the bound is min(f/f̄ g, τ): g is that by the mean coefficient f̄, the parabola or the half ellipse, f and τ are the coefficient
//! and the largest traction of the element of the contact's grid in which the place lies. Under the parabola a contact that slides carries the
//! integral of min(f/f̄ g, τ), up to a tenth less than of Hertz's pressure: see [`elastic::cut_off`].

use half_space::friction::ElementFriction;
use proto::grid::Structured;

/// Friction of the elements of a contact.
#[derive(Clone, Copy)]
pub(super) struct Limits<'a> {
    grid: &'a Structured,
    friction: &'a ElementFriction,
    /// Mean coefficient, weighted with the pressure [-].
    pub(super) mean: f64,
}

impl<'a> Limits<'a> {
    /// Traction bounds of the elements of a grid under their pressures [Pa].
    pub(super) fn new(
        grid: &'a Structured,
        friction: &'a ElementFriction,
        pressure: &[f64],
    ) -> Self {
        Self { grid, friction, mean: friction.mean(0..grid.points(), pressure) }
    }

    /// Bound at a place, from that by the mean coefficient [Pa].
    pub(super) fn at(&self, x: f64, y: f64, bound: f64) -> f64 {
        let Self { grid, friction, mean } = self;
        // Beyond the grid the nearest element counts.
        let nearest = |steps: f64, count: usize| (steps.round().max(0.0) as usize).min(count - 1);
        let i = nearest((x - grid.x(0)) / grid.dx(), grid.ni);
        let j = nearest((y - grid.y(0)) / grid.dy(), grid.nj);
        friction.limit(j * grid.ni + i, *mean, bound)
    }
}
