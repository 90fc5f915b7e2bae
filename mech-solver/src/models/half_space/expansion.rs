//! Thermal expansion of the surfaces ([`crate::effects::thermal_expansion`]).

use super::case::Case;
use crate::terms::surface::{KeptSurface, raise};
use proto::configuration::Refusal;
use proto::field;
use proto::model::{Inputs, StepError};

/// Refuses cases that have no solution with thermal expansion.
pub(super) fn refuse(case: &Case, effect: &str) -> Result<(), Refusal> {
    let refused = |reason: &str, fix: &str| {
        let fix = format!("{fix}, or remove the effect");
        Err(Refusal::new(&format!("effects.{effect}"), reason, fix))
    };
    if case.bodies.are_coupled() {
        return refused(
            "bodies of different elastic constants slip under their pressure, and the power of rising surfaces is missing in \
             the balance",
            "give both bodies the same elastic constants",
        );
    }
    if case.scene.speeds.rolling == 0.0 {
        return refused(
            "a shift has memory: heat would change the pressure under its tractions",
            "write a motion.speed above 0",
        );
    }
    if case.memory {
        return refused(
            "the tractions of one step would meet another pressure in the next, which the power balance does not include",
            "write mech.rolling = \"steady\"",
        );
    }
    Ok(())
}

impl Case {
    /// Passes the thermal expansion to the observations.
    ///
    /// # Errors
    /// An observation that does not support thermal expansion.
    pub(super) fn expand_observed(&mut self) -> Result<(), Refusal> {
        let Some(coefficients) = self.terms.expansion else { return Ok(()) };
        let speeds = self.scene.speeds.of_surfaces(0.0);
        self.terms.observations.iter_mut().try_for_each(|term| term.expand(coefficients, speeds))
    }

    /// Updates the thermal rise of the surfaces. Returns whether thermal expansion is active.
    ///
    /// # Errors
    /// An input that is missing or unusable.
    pub(super) fn expand(&mut self, inputs: &dyn Inputs) -> Result<bool, StepError> {
        let Some(coefficients) = self.terms.expansion else { return Ok(false) };
        let grid = &self.footprint.grid;
        self.rises.clear();
        self.rises.resize(grid.points(), 0.0);
        raise(inputs, &self.scene.bodies, coefficients, grid, &mut self.rises)?;
        if !self.terms.observations.is_empty() {
            let [upper, lower] = [&field::UPPER_RISE_INTEGRAL, &field::LOWER_RISE_INTEGRAL];
            self.heated = Some([KeptSurface::of(inputs, upper)?, KeptSurface::of(inputs, lower)?]);
        }
        Ok(true)
    }
}
