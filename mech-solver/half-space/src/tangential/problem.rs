//! The tangential problem on one grid, and its prescribed quantities.

use super::bound_law::BoundLaw;
use super::state::{Creepage, TangentialState};
use crate::yielding::Yield;

/// Prescribed force for some components, prescribed creepage for the others.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PrescribedMotion {
    /// Creepages [-, -, rad/m], or shifts [m, m, rad]; ignored where a force is prescribed.
    pub creepage: Creepage,
    /// Longitudinal and lateral force [N] and spin moment [N m] on body 1; `None` where the
    /// creepage is prescribed.
    pub force: [Option<f64>; 3],
}

impl PrescribedMotion {
    /// Prescribes all creepages.
    #[must_use]
    pub fn creepages(creepage: Creepage) -> Self {
        Self { creepage, force: [None; 3] }
    }

    /// Prescribes a longitudinal force [N], with no lateral creepage and no spin.
    #[must_use]
    pub fn longitudinal_force(force: f64) -> Self {
        Self { creepage: [0.0; 3], force: [Some(force), None, None] }
    }

    /// Returns true if any force is prescribed.
    #[must_use]
    pub fn has_force(&self) -> bool {
        self.force.iter().any(Option::is_some)
    }
}

/// Layer that yields.
#[derive(Clone, Copy, Debug)]
pub struct Layer<'a> {
    /// Law of the yield stress.
    pub law: Yield,
    /// Plastic shift κ' of every element before the step [m]; `None` in steady rolling.
    pub before: Option<&'a [f64]>,
}

/// The problem on one grid of nx × ny elements.
#[derive(Debug)]
pub struct Problem<'a> {
    /// Elements along x.
    pub nx: usize,
    /// Distance Δq rolled in the step [m]; 1 in a shift, where the creepages are distances [m] and
    /// a rotation [rad].
    pub distance: f64,
    /// Distance ahead of an element's centre at which the rigid slip is taken; 0 in a shift [m].
    pub ahead: f64,
    /// Area of an element [m²].
    pub element_area: f64,
    /// Centres along x in a row that is not displaced [m].
    pub x: &'a [f64],
    /// Displacement of each row along x [m].
    pub offset: &'a [f64],
    /// Centres along y [m].
    pub y: &'a [f64],
    /// Traction bound g = f p_n at the start [Pa]; 0 outside the contact.
    pub bound: &'a [f64],
    /// Law of the bounds, if they depend on the solution.
    pub law: Option<&'a dyn BoundLaw>,
    /// Slip s₀ without tractions, x and y [m].
    pub slip_history: Option<[&'a [f64]; 2]>,
    /// Yielding layer.
    pub layer: Option<Layer<'a>>,
    /// Prescribed forces; their creepages are unknown.
    pub wanted: Option<PrescribedForces>,
}

/// Forces that a contact has to carry.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PrescribedForces {
    /// Longitudinal and lateral force [N] and spin moment [N m] on body 1; `None` where the
    /// creepage is given.
    pub force: [Option<f64>; 3],
    /// Error allowed in the forces [N], and in the moment over the length.
    pub tolerance: f64,
    /// A length of the contact [m].
    pub length: f64,
    /// Size of the creepages at which a good part of the contact slips; spin times the length.
    pub creepage: f64,
}

impl PrescribedForces {
    /// Size of the unknown creepages, or of their steps.
    pub(super) fn size(&self, creepage: Creepage) -> f64 {
        let of = |k: usize| if self.force[k].is_some() { creepage[k] } else { 0.0 };
        of(0).hypot(of(1)).hypot(of(2) * self.length)
    }
}

impl Problem<'_> {
    /// Returns true if the sizes of tractions in the slip area depend on the slip.
    pub(super) fn sizes_follow_slip(&self) -> bool {
        self.layer.is_some() || self.law.is_some_and(|law| law.arguments().slip)
    }

    /// Force on body 1, x and y [N], and its moment about z [N m].
    #[must_use]
    pub fn forces(&self, state: &TangentialState) -> [f64; 3] {
        let mut sum = [0.0; 3];
        for (row, (y, offset)) in self.y.iter().zip(self.offset).enumerate() {
            let range = row * self.nx..(row + 1) * self.nx;
            let rows = state.traction[0][range.clone()].iter().zip(&state.traction[1][range]);
            for ((px, py), x) in rows.zip(self.x) {
                sum[0] += px;
                sum[1] += py;
                sum[2] += (x + offset) * py - y * px;
            }
        }
        sum.map(|value| value * self.element_area)
    }

    /// Centre of an element [m].
    fn centre(&self, index: usize) -> [f64; 2] {
        let (i, j) = (index % self.nx, index / self.nx);
        [self.x[i] + self.offset[j], self.y[j]]
    }

    /// Rigid slip of an element in the step by a unit of one component of the creepage [m per
    /// unit].
    pub(super) fn rigid_slip(&self, component: usize, index: usize) -> [f64; 2] {
        let [x, y] = self.centre(index);
        let x = x + self.ahead;
        let slip = match component {
            0 => [1.0, 0.0],
            1 => [0.0, 1.0],
            _ => [-y, x],
        };
        slip.map(|value| value * self.distance)
    }

    /// Contribution of a unit of traction on an element, along x and along y, to one component of
    /// the forces [N/Pa].
    pub(super) fn force_of(&self, component: usize, index: usize) -> [f64; 2] {
        let [x, y] = self.centre(index);
        let force = match component {
            0 => [1.0, 0.0],
            1 => [0.0, 1.0],
            _ => [-y, x],
        };
        force.map(|value| value * self.element_area)
    }

    /// Missing force F* − F of the prescribed components [N], [N m].
    pub(super) fn lack(&self, state: &TangentialState) -> [f64; 3] {
        let Some(wanted) = &self.wanted else { return [0.0; 3] };
        let forces = self.forces(state);
        std::array::from_fn(|k| wanted.force[k].map_or(0.0, |wanted| wanted - forces[k]))
    }

    /// Largest missing force over its tolerance.
    pub(super) fn error(&self, lack: [f64; 3]) -> f64 {
        let Some(wanted) = &self.wanted else { return 0.0 };
        lack[0].abs().max(lack[1].abs()).max(lack[2].abs() / wanted.length) / wanted.tolerance
    }
}
