//! What a body is made of, and what is round it.

use super::conductor::{NewtonStats, Surroundings};
use super::error::SolveError;
use super::law::{Law, Point};
use crate::Material;

/// Material of a body, and its surroundings.
#[derive(Clone, Debug, PartialEq)]
pub struct BodyProperties {
    /// Its properties while it is cold.
    pub material: Material,
    /// The points of its properties over temperature, if they depend on it.
    pub points: Vec<Point>,
    /// Its temperature while it is cold [K].
    pub initial: f64,
    /// Temperatures beyond the points have the properties of their ends.
    pub clamps: bool,
    /// Surroundings of its free surface.
    pub surroundings: Surroundings,
}

impl BodyProperties {
    /// Its equations are linear, and the same everywhere.
    #[must_use]
    pub fn is_constant(&self) -> bool {
        self.points.is_empty() && self.surroundings.is_none()
    }

    /// Its conductivity and the heat that it holds.
    #[must_use]
    pub fn law(&self) -> Law {
        let Material { density, specific_heat, conductivity } = self.material;
        match self.points.as_slice() {
            [] => Law::constant(conductivity, density * specific_heat, self.initial),
            points => Law::new(points, self.initial),
        }
    }

    /// Work of a solve whose coldest and hottest rises are these [K].
    ///
    /// # Errors
    /// The equations are not solved, or the rises are beyond what is known of the material.
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
