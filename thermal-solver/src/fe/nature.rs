//! What a body is made of, and what is round it.

use super::conductor::{Surroundings, Took};
use super::law::{Law, Point};
use crate::scene::Material;
use proto::model::StepError;

/// What a body is made of, and what is round it.
#[derive(Clone, Debug, PartialEq)]
pub struct Nature {
    /// Its properties while it is cold.
    pub material: Material,
    /// The points of its properties over temperature, if they depend on it.
    pub points: Vec<Point>,
    /// Its temperature while it is cold [K].
    pub initial: f64,
    /// What is beyond the points counts as their ends.
    pub clamps: bool,
    /// What is round its free surface.
    pub surroundings: Surroundings,
}

impl Nature {
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

    /// The work of a solve whose coldest and hottest rises are these [K]; `less_rounding` is what
    /// lowers the rounding of its equations, for a solve that has failed.
    ///
    /// # Errors
    /// The equations are not solved, or the rises are beyond what is known of the material.
    pub fn check(
        &self,
        extremes: [f64; 2],
        took: Took,
        less_rounding: &str,
    ) -> Result<u64, StepError> {
        if !took.is_solved() {
            // Newton's method converges from any start, unless conjugate gradients end too early,
            // which elimination does not, or rounding exceeds the tolerance: between layers so thin
            // that what they conduct cancels.
            let fix = if took.stopped { "thermal.solver = \"direct\"" } else { less_rounding };
            return Err(StepError::NoSolution(format!(
                "the equations of the elements are not solved: the residual is {:.1e} after {} steps of Newton's \
                 method; write {fix}",
                took.residual, took.newton
            )));
        }
        let work = (took.newton + took.iterations) as u64;
        let (Some(first), Some(last)) = (self.points.first(), self.points.last()) else {
            return Ok(work);
        };
        let [cold, hot] = extremes.map(|rise| self.initial + rise);
        let beyond = if hot > last.temperature { hot } else { cold };
        if self.clamps || (first.temperature..=last.temperature).contains(&beyond) {
            return Ok(work);
        }
        Err(StepError::NoSolution(format!(
            "{beyond:.1} K is beyond the table of properties, which is from {} to {} K; extend it, or write \
             effects.temperature_material.beyond = \"hold\"",
            first.temperature, last.temperature
        )))
    }
}
