//! Material and surroundings of a body.

use super::conductor::{NewtonStats, Surroundings};
use super::error::SolveError;
use super::law::{Law, Point};
use crate::Material;

/// Material of a body, and its surroundings.
#[derive(Clone, Debug, PartialEq)]
pub struct BodyProperties {
    /// Properties at the initial temperature.
    pub material: Material,
    /// Points of the properties over temperature; empty for constant properties.
    pub points: Vec<Point>,
    /// Initial temperature [K].
    pub initial: f64,
    /// Whether properties beyond the points keep the values at the ends.
    pub clamps: bool,
    /// Surroundings of the free surface.
    pub surroundings: Surroundings,
}

impl BodyProperties {
    /// Returns whether the equations are linear with uniform coefficients.
    #[must_use]
    pub fn is_constant(&self) -> bool {
        self.points.is_empty() && self.surroundings.is_none()
    }

    /// Returns the law of conductivity and heat content.
    #[must_use]
    pub fn law(&self) -> Law {
        let Material { density, specific_heat, conductivity } = self.material;
        match self.points.as_slice() {
            [] => Law::constant(conductivity, density * specific_heat, self.initial),
            points => Law::new(points, self.initial),
        }
    }

    /// Checks a solve with these lowest and highest rises [K], and returns its work.
    ///
    /// # Errors
    /// The equations are not solved, or a rise is outside the range of the material data.
    pub fn check(&self, extremes: [f64; 2], took: NewtonStats) -> Result<u64, SolveError> {
        if !took.is_solved() {
            return Err(SolveError::NotSolved {
                residual: took.residual,
                newton: took.newton,
                gradients_stopped: took.stopped,
            });
        }
        let work = (took.newton + took.iterations) as u64;
        let (Some(first), Some(last)) = (self.points.first(), self.points.last()) else {
            return Ok(work);
        };
        let [cold, hot] = extremes.map(|rise| self.initial + rise);
        let temperature = if hot > last.temperature { hot } else { cold };
        if self.clamps || (first.temperature..=last.temperature).contains(&temperature) {
            return Ok(work);
        }
        let known = [first.temperature, last.temperature];
        Err(SolveError::BeyondProperties { temperature, known })
    }
}
