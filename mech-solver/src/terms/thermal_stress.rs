//! Thermal stress inside bodies that expand and move steadily: the case values that it needs, and
//! the conditions under which it is defined ([`half_space::subsurface::WarmBody`]).
//!
//! A body at rest is refused: its heat stays in place, and the depth of the heat follows from the
//! whole history.

use crate::case::keys::CheckedParams;
use crate::case::scene::read_material;
use crate::terms::state::Accepted;
use elastic::Material;
use half_space::subsurface::{RiseIntegral, WarmBody};
use proto::bodies::{Bodies, LOWER, UPPER};
use proto::configuration::{Configuration, Refusal};
use proto::description::KeySpec;

/// Material properties that determine the diffusivity.
const THERMAL: [(&str, &str, &str); 3] = [
    ("conductivity", "W/(m K)", "heat flux per temperature gradient; for bodies that expand"),
    ("density", "kg/m3", "mass per volume; for bodies that expand"),
    ("specific_heat", "J/(kg K)", "heat per mass and temperature; for bodies that expand"),
];

/// Returns the keys of the thermal stress.
pub(crate) fn keys() -> impl Iterator<Item = KeySpec> {
    THERMAL.into_iter().map(|(name, unit, help)| {
        KeySpec::quantity(&format!("materials.*.{name}"), unit, help).above(0.0)
    })
}

/// Properties of both bodies for the thermal stress.
#[derive(Debug)]
pub(crate) struct ThermalStress {
    /// Effect that requests the thermal stress.
    effect: &'static str,
    /// Names of the bodies in the case.
    pub(crate) names: Bodies,
    /// Materials of both bodies, and their names.
    pub(crate) materials: [Material; 2],
    called: [String; 2],
    /// Conductivity [W/(m·K)], density [kg/m³] and specific heat [J/(kg·K)] of both bodies, if the
    /// case gives them.
    thermal: [[Option<f64>; 3]; 2],
    /// Coefficients of thermal expansion [1/K]; `None` if the bodies do not expand.
    expansion: Option<[f64; 2]>,
}

impl ThermalStress {
    /// Reads the properties from a case whose keys `case` checks.
    ///
    /// # Errors
    /// A value that is missing or out of range.
    pub(crate) fn read(
        configuration: &Configuration,
        case: &CheckedParams<'_>,
        effect: &'static str,
    ) -> Result<Self, Refusal> {
        let params = &configuration.case;
        let names = Bodies::read(params)?;
        let material = |body: usize| params.text(&names.key(body, "material"));
        let called = [material(0)?.to_owned(), material(1)?.to_owned()];
        let mut thermal = [[None; 3]; 2];
        for (values, material) in thermal.iter_mut().zip(&called) {
            for (value, (name, ..)) in values.iter_mut().zip(THERMAL) {
                *value = case.maybe_number(&format!("materials.{material}.{name}"))?;
            }
        }
        let read = |body| read_material(params, &names, body);
        let materials = [read(UPPER)?, read(LOWER)?];
        Ok(Self { effect, names, materials, called, thermal, expansion: None })
    }

    /// Returns true if the bodies expand.
    pub(crate) fn is_there(&self) -> bool {
        self.expansion.is_some()
    }

    /// Announces thermal expansion of both bodies, with their coefficients [1/K] and their surface
    /// speeds [m/s].
    ///
    /// # Errors
    /// A body without diffusivity; a body at rest.
    pub(crate) fn expand(
        &mut self,
        coefficients: [f64; 2],
        speeds: [f64; 2],
    ) -> Result<(), Refusal> {
        let effect = self.effect;
        for (body, speed) in speeds.into_iter().enumerate() {
            let lacking = THERMAL.iter().zip(self.thermal[body]).find(|(_, value)| value.is_none());
            if let Some(((name, ..), _)) = lacking {
                return Err(Refusal::new(
                    &format!("materials.{}.{name}", self.called[body]),
                    "missing: the thermal stress below the surface needs the diffusivity",
                    format!("write it, or remove effects.{effect}"),
                ));
            }
            if speed <= 0.0 {
                return Err(Refusal::new(
                    &self.names.key(body, "surface_speed"),
                    format!(
                        "`{}` is at rest: the depth of its heat depends on the whole history, but the thermal stress \
                         below the surface is computed for steady motion",
                        self.names.0[body]
                    ),
                    format!("write a speed above 0 m/s, or remove effects.{effect}"),
                ));
            }
        }
        self.expansion = Some(coefficients);
        Ok(())
    }

    /// Returns the warm body with the integrals of its temperature rise; `None` if it does not
    /// expand.
    pub(crate) fn of<'a>(
        &self,
        accepted: &Accepted<'a>,
        body: usize,
    ) -> Option<(WarmBody, RiseIntegral<'a>)> {
        let (expansion, heated) = (self.expansion?[body], accepted.heated?[body]);
        let [conductivity, density, specific_heat] = self.thermal[body];
        let Material { youngs_modulus, poisson_ratio } = self.materials[body];
        let warm = WarmBody {
            youngs_modulus,
            poisson_ratio,
            expansion,
            diffusivity: conductivity? / (density? * specific_heat?),
            speed: accepted.surface_speed[body],
        };
        let (grid, values) = heated.parts();
        Some((warm, RiseIntegral { grid, values }))
    }
}
