//! Friction and roughness between wheel and rail.
//!
//! The friction coefficient of every element is that of the case, multiplied by factors over the
//! rail surface or along the track, and modified by other friction laws. Heights of rough surfaces
//! belong to the rail, as a function of the distance along the track and the tape distance.

use super::case::{Case, Position};
use crate::terms::bands::{At, Over};
use crate::terms::friction::FrictionState;
use half_space::aligned::AlignedGrid;
use half_space::friction::ElementFriction;
use half_space::slip_velocity::SlipStart;
use proto::bodies::LOWER;
use proto::grid::Structured;
use proto::model::Inputs;
use wheel_rail::interface::{Elements, Interface};
use wheel_rail::rail::Side;

/// Friction and roughness between wheel and rail in a window.
pub(super) struct FrictionInterface<'a> {
    pub(super) case: &'a Case,
    pub(super) position: &'a Position,
    /// Inputs, and the shift between y on the grid of the fields and the tape distance of the left
    /// and the right rail [m]; `None` during the search for the grid.
    pub(super) solving: Option<(&'a dyn Inputs, [f64; 2])>,
}

impl Interface for FrictionInterface<'_> {
    fn is_rough(&self) -> bool {
        !self.case.terms.gap.is_empty()
    }

    fn height(&self, _side: Side, [x, tape]: [f64; 2]) -> f64 {
        self.case.terms.height(self.position.motion.way + x, tape)
    }

    fn friction(&self, elements: &Elements<'_>) -> Result<ElementFriction, String> {
        let shift = self
            .solving
            .map_or(0.0, |(_, shifts)| shifts[usize::from(elements.side == Side::Right)]);
        let mut grid = elements.grid;
        grid.origin[1] += shift;
        let state = FrictionState {
            inputs: self.solving.map(|(inputs, _)| inputs),
            speed: elements.speed,
            rigid_slip: elements.rigid_slip,
            rows: &AlignedGrid::regular(grid),
            coordinate: &|over, at, index| match at {
                At::Patches => Some(self.of_patch(over, elements)),
                At::Elements => {
                    (elements.pressure[index] > 0.0).then(|| self.of_element(over, elements, index))
                }
            },
            pressure: elements.pressure,
            velocity: elements.slip,
        };
        let law = &self.case.terms.friction;
        law.evaluate(self.position.friction, &state).map_err(|error| error.to_string())
    }

    fn follows_elements(&self) -> Option<SlipStart> {
        self.solving.and_then(|_| self.case.terms.friction.follows_elements())
    }
}

impl FrictionInterface<'_> {
    /// Coordinate of the friction factors at an element.
    fn of_element(&self, over: Over, elements: &Elements<'_>, index: usize) -> f64 {
        let Elements { side, grid, .. } = elements;
        let Structured { ni, .. } = *grid;
        let (x, tape) = (self.position.motion.way + grid.x(index % ni), grid.y(index / ni));
        match over {
            Over::Lateral => tape,
            Over::Track => x,
            Over::Inclination => self.case.surfaces[LOWER].angle(x, side.sign() * tape),
        }
    }

    /// Coordinate of the friction factors at the reference point of a patch.
    fn of_patch(&self, over: Over, elements: &Elements<'_>) -> f64 {
        let Elements { side, reference: [x, tape], angle, .. } = *elements;
        match over {
            Over::Lateral => tape,
            Over::Track => self.position.motion.way + x,
            // In the axes of the profile, without the rotation by cant and deviation.
            Over::Inclination => {
                side.sign() * (angle - self.position.deviation.roll) - self.case.track.cant
            }
        }
    }
}
