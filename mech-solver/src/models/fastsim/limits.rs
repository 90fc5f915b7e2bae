//! Traction bounds of a contact with varying friction.
//!
//! At (x, y) the bound is min(f/f̄ g, τ). Here g is the bound at the mean coefficient f̄, a
//! parabola or half ellipse; f and τ are the friction coefficient and the largest traction of the
//! grid element at that position. Under the parabola a sliding contact carries the integral of
//! min(f/f̄ g, τ), which is up to a tenth less than with Hertz's pressure; see
//! [`elastic::cut_off`].

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
    /// Creates the traction bounds of the elements of a grid under these pressures [Pa].
    pub(super) fn new(
        grid: &'a Structured,
        friction: &'a ElementFriction,
        pressure: &[f64],
    ) -> Self {
        Self { grid, friction, mean: friction.mean(0..grid.points(), pressure) }
    }

    /// Bound at a position, from the bound at the mean coefficient [Pa].
    pub(super) fn at(&self, x: f64, y: f64, bound: f64) -> f64 {
        let Self { grid, friction, mean } = self;
        // Beyond the grid the nearest element applies.
        let nearest = |steps: f64, count: usize| (steps.round().max(0.0) as usize).min(count - 1);
        let i = nearest((x - grid.x(0)) / grid.dx(), grid.ni);
        let j = nearest((y - grid.y(0)) / grid.dy(), grid.nj);
        friction.limit(j * grid.ni + i, *mean, bound)
    }
}
