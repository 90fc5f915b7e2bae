//! What is between wheel and rail. The friction coefficient of every element is that of the case, with its factors over the surface of the rail or
//! along the track and what other laws make of it. Heights of rough surfaces stand on the rail, over the way along the track and the tape distance.

use super::case::{Case, Position};
use crate::bands::{At, Bands, Over};
use crate::slip::SlipStart;
use crate::terms::Rubbing;
use crate::track::interface::{Elements, Interface};
use crate::track::rail::Side;
use proto::bodies::LOWER;
use proto::grid::Structured;
use proto::model::Inputs;

/// What is between wheel and rail in a window.
pub(super) struct Between<'a> {
    pub(super) case: &'a Case,
    pub(super) position: &'a Position,
    /// What comes in, and y on the grid of the fields less the tape distance [m] of the left rail and the right; while the grid is looked for
    /// there are only factors.
    pub(super) solving: Option<(&'a dyn Inputs, [f64; 2])>,
}

impl Interface for Between<'_> {
    fn is_rough(&self) -> bool {
        !self.case.terms.gap.is_empty()
    }

    fn height(&self, _side: Side, [x, tape]: [f64; 2]) -> f64 {
        self.case.terms.height(self.position.motion.way + x, tape)
    }

    fn coefficients(&self, elements: &Elements<'_>, friction: &mut [f64]) -> Result<(), String> {
        friction.fill(self.position.friction);
        for term in &self.case.terms.friction {
            match (term.bands(), self.solving) {
                (Some(bands), _) => self.multiply(bands, elements, friction),
                (None, Some((inputs, shifts))) => {
                    let shift = shifts[usize::from(elements.side == Side::Right)];
                    let mut grid = elements.grid;
                    grid.origin[1] += shift;
                    let rubbing = Rubbing {
                        inputs,
                        speed: elements.speed,
                        rigid_slip: elements.rigid_slip,
                        grid: &grid,
                        origin_y: -shift,
                        pressure: elements.pressure,
                        velocity: elements.slip,
                    };
                    term.apply(&rubbing, friction).map_err(|error| error.to_string())?;
                }
                (None, None) => {}
            }
        }
        Ok(())
    }

    fn follows_elements(&self) -> Option<SlipStart> {
        self.solving.and_then(|_| self.case.terms.friction_follows_elements())
    }
}

impl Between<'_> {
    /// Multiplies coefficients by the factors of their elements.
    fn multiply(&self, bands: &Bands, elements: &Elements<'_>, friction: &mut [f64]) {
        if bands.at == At::Patches {
            let factor = bands.factor(self.of_patch(bands.over, elements));
            friction.iter_mut().for_each(|friction| *friction *= factor);
            return;
        }
        for (index, friction) in friction.iter_mut().enumerate() {
            if elements.pressure[index] > 0.0 {
                *friction *= bands.factor(self.of_element(bands.over, elements, index));
            }
        }
    }

    /// The coordinate of factors at an element.
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

    /// The same at the reference of the patch.
    fn of_patch(&self, over: Over, elements: &Elements<'_>) -> f64 {
        let Elements { side, reference: [x, tape], angle, .. } = *elements;
        match over {
            Over::Lateral => tape,
            Over::Track => self.position.motion.way + x,
            // In the axes of the profile, which cant and deviation have turned.
            Over::Inclination => {
                side.sign() * (angle - self.position.deviation.roll) - self.case.track.cant
            }
        }
    }
}
