//! Friction of the elements of a contact, at the latest creepages and slips.

use super::case::Case;
use crate::terms::friction::{FrictionState, lateral};
use elastic::slip::RigidSlip;
use half_space::aligned::AlignedGrid;
use half_space::friction::ElementFriction;
use half_space::tangential::{Arguments, BoundLaw, Creepage, NotConverged};
use proto::model::{Inputs, StepError};

/// Conditions under which friction is evaluated, apart from creepages and slips.
pub(super) struct FrictionConditions<'a> {
    pub(super) case: &'a Case,
    pub(super) inputs: &'a dyn Inputs,
    /// Grid of the tractions.
    pub(super) rows: AlignedGrid,
    /// Pressure of the elements in these rows [Pa].
    pub(super) pressure: Vec<f64>,
}

impl FrictionConditions<'_> {
    /// Friction at these creepages, and at the slip velocity of every element if a law follows it
    /// [m/s].
    pub(super) fn evaluate(
        &self,
        creepage: Creepage,
        velocity: Option<&[f64]>,
    ) -> Result<ElementFriction, StepError> {
        let Self { case, inputs, rows, pressure } = self;
        let slip = RigidSlip { creepage, speed: case.scene.speeds.rolling };
        let origin_y = case.footprint.gap.as_ref().map_or(0.0, |gap| gap.origin);
        let state = FrictionState {
            inputs: Some(*inputs),
            speed: slip.speed,
            rigid_slip: &|index| slip.at_place(rows.centre(index)),
            rows,
            coordinate: &lateral(&case.footprint.grid, origin_y),
            pressure,
            velocity,
        };
        case.terms.friction.evaluate(case.scene.friction_coefficient, &state)
    }
}

/// Friction that follows the solution.
pub(super) struct FollowingFriction<'a> {
    pub(super) case: &'a Case,
    pub(super) inputs: &'a dyn Inputs,
    pub(super) arguments: Arguments,
}

impl FollowingFriction<'_> {
    /// Error of a solve that did not converge.
    pub(super) fn refusal(&self, found: &NotConverged) -> StepError {
        StepError::NoSolution(match self.arguments.slip {
            true => format!(
                "friction that depends on the slip of each element was not found: {found}; let \
                 friction fall more slowly with slip, or choose another start"
            ),
            false => format!(
                "friction falls with slip, and no creepage was found for the force: {found}; \
                 prescribe less force, or motion.creepage"
            ),
        })
    }
}

/// Traction bounds of a contact as a function of creepages and slips.
pub(super) struct ContactBounds<'a> {
    pub(super) conditions: FrictionConditions<'a>,
    pub(super) arguments: Arguments,
}

impl BoundLaw for ContactBounds<'_> {
    fn arguments(&self) -> Arguments {
        self.arguments
    }

    fn evaluate(&self, creepage: Creepage, slip: &[f64], bound: &mut [f64]) {
        let duration = self.conditions.case.passage().duration;
        let velocity = self
            .arguments
            .slip
            .then(|| slip.iter().map(|slip| slip / duration).collect::<Vec<_>>());
        // Inputs that friction cannot use were refused before, with the friction at the start.
        if let Ok(friction) = self.conditions.evaluate(creepage, velocity.as_deref()) {
            let bounds = friction.bounds(&self.conditions.pressure);
            bound.iter_mut().zip(bounds).for_each(|(bound, value)| *bound = value);
        }
    }
}
