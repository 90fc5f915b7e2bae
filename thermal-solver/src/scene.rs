//! Materials and speeds that the thermal participant reads from a case, for all models.

use heat::Material;
use proto::bodies::{
    Bodies, INITIAL_TEMPERATURE, LOWER, UPPER, initial_temperature_key, position_key,
    surface_speed_key,
};
use proto::configuration::{Configuration, Refusal};
use proto::description::KeySpec;
use proto::params::Params;

/// Materials, initial temperatures and speeds of the bodies.
#[derive(Clone, Debug, PartialEq)]
pub struct Scene {
    /// Names of the upper and the lower body in the case.
    pub names: Bodies,
    /// Materials of the upper and the lower body.
    pub materials: [Material; 2],
    /// Initial temperatures of the upper and the lower body [K].
    pub initial_temperatures: [f64; 2],
    /// True for each body that the case prescribes as stationary.
    pub at_rest: [bool; 2],
    /// Expected surface speeds of the upper and the lower body [m/s]. They set the depth of the
    /// sections only; the conduction uses the surface speeds that arrive as an input.
    pub speeds: [f64; 2],
}

impl Scene {
    /// Reads the scene.
    ///
    /// # Errors
    /// A value that is missing or not positive; the error names its key.
    pub fn read(case: &Params) -> Result<Self, Refusal> {
        let names = Bodies::read(case)?;
        let material = |body: usize| read_material(case, case.text(&names.key(body, "material"))?);
        let materials = [material(UPPER)?, material(LOWER)?];
        let initial = |body: usize| {
            let key = names.key(body, "initial_temperature");
            Ok(case.maybe_number(&key)?.unwrap_or(INITIAL_TEMPERATURE))
        };
        let initial_temperatures = [initial(UPPER)?, initial(LOWER)?];
        let own = |body: usize| -> Result<Option<f64>, Refusal> {
            let own = case.maybe_number(&names.key(body, "surface_speed"))?;
            Ok(own.or(case.maybe_number(SPEED)?))
        };
        let locked = case.maybe_number(CREEPAGE)? == Some(1.0)
            && !case.has(&names.key(UPPER, "surface_speed"));
        let at_rest = [locked || own(UPPER)? == Some(0.0), own(LOWER)? == Some(0.0)];
        let speeds = read_speeds(case, &names)?;
        Ok(Self { names, materials, initial_temperatures, at_rest, speeds })
    }

    /// Returns the surface speeds of a body [m/s] in the rows of the case's tables; one speed if it
    /// does not vary, or is given from outside.
    #[must_use]
    pub fn speeds_in(&self, body: usize, given: &Configuration) -> Vec<f64> {
        let own = self.names.key(body, "surface_speed");
        let rows = given.histories.as_ref().filter(|histories| histories.live.is_none());
        let values = |key: &str| {
            let column = rows.and_then(|histories| histories.values.get(key)).cloned();
            column.or_else(|| Some(vec![given.case.maybe_number(key).ok()??]))
        };
        if let Some(speeds) = values(&own) {
            return speeds;
        }
        let Some(speeds) = values(SPEED) else { return vec![self.speeds[body]] };
        let creepages = values(CREEPAGE).filter(|_| body == UPPER).unwrap_or(vec![0.0]);
        let at = |values: &[f64], row: usize| values[row.min(values.len() - 1)];
        (0..speeds.len().max(creepages.len()))
            .map(|row| at(&speeds, row) * (1.0 - at(&creepages, row)))
            .collect()
    }

    /// Returns the first row of the case's tables, counted from 0, in which a body is at rest. A
    /// row that is an instant counts if the body is still at rest at the next one, or at the end.
    #[must_use]
    pub fn resting_row(&self, body: usize, given: &Configuration) -> Option<usize> {
        let speeds = self.speeds_in(body, given);
        let instants = given.histories.as_ref().filter(|histories| !histories.rows);
        let end = given.windows.and_then(|windows| windows.end);
        let lasts = |row: usize| match (instants, speeds.get(row + 1)) {
            (Some(_), Some(next)) => *next == 0.0,
            (Some(histories), None) => end.is_none_or(|end| end > histories.times[row]),
            (None, _) => true,
        };
        (0..speeds.len()).find(|row| speeds[*row] == 0.0 && lasts(*row))
    }

    /// Returns the lowest and the highest expected speed of a body over the run [m/s].
    #[must_use]
    pub fn speed_range(&self, given: &Configuration, body: usize) -> [f64; 2] {
        let own = self.names.key(body, "surface_speed");
        let key = if given.case.has(&own) { own.as_str() } else { SPEED };
        match given.histories.as_ref().and_then(|histories| histories.values.get(key)) {
            Some(speeds) => [
                speeds.iter().copied().fold(f64::INFINITY, f64::min),
                speeds.iter().copied().fold(0.0, f64::max),
            ],
            None if self.at_rest[body] => [0.0; 2],
            None => [self.speeds[body]; 2],
        }
    }
}

/// Reads the surface speed of each body, or the rolling speed. A stationary body is assigned the
/// speed of the other body, so that both sections are equally deep.
fn read_speeds(case: &Params, names: &Bodies) -> Result<[f64; 2], Refusal> {
    let own = |body: usize| case.maybe_number(&names.key(body, "surface_speed"));
    let rolling = case.maybe_number(SPEED)?;
    let [upper, lower] = [own(UPPER)?.or(rolling), own(LOWER)?.or(rolling)];
    match (upper.unwrap_or(0.0), lower.unwrap_or(0.0)) {
        (upper, lower) if upper > 0.0 && lower > 0.0 => Ok([upper, lower]),
        (one, other) if one.max(other) > 0.0 => Ok([one.max(other); 2]),
        // Between stationary bodies the section has its largest depth.
        _ if upper.is_some() || lower.is_some() => Ok([f64::MIN_POSITIVE; 2]),
        _ => Err(Refusal::new(
            SPEED,
            "missing",
            format!("write a `{SPEED}`, 0 for bodies at rest, or a surface_speed of a body"),
        )),
    }
}

const SPEED: &str = "motion.speed";
/// Group of the alternative keys that drive the upper body.
const DRIVE: &str = "motion.drive";
/// Longitudinal creepage ξ, at which the upper surface passes with (1 − ξ) V.
pub(crate) const CREEPAGE: &str = "motion.creepage.xi";

/// Returns the keys that [`Scene::read`] reads.
#[must_use]
pub fn keys() -> Vec<KeySpec> {
    let property = |name: &str, unit: &str, help: &str| {
        KeySpec::quantity(&format!("materials.*.{name}"), unit, help).required().above(0.0)
    };
    const SOLIDS: &str = "of solids; check the unit";
    vec![
        position_key(),
        KeySpec::name_in("bodies.*.material", "materials", "material of the body").required(),
        initial_temperature_key(),
        surface_speed_key(),
        property("density", "kg/m3", "mass per volume").expected(20.0..=3e4, SOLIDS),
        property("specific_heat", "J/(kg K)", "heat per mass and temperature")
            .expected(10.0..=1e4, SOLIDS),
        property("conductivity", "W/(m K)", "heat flux per temperature gradient")
            .expected(0.0..=5e3, SOLIDS),
        KeySpec::quantity(SPEED, "m/s", "rolling speed").at_least(0.0).varies(),
        KeySpec::number(CREEPAGE, "longitudinal creepage; 1 for an upper body at rest")
            .varies()
            .one_of_or_none(DRIVE),
    ]
}

fn read_material(case: &Params, name: &str) -> Result<Material, Refusal> {
    let property = |key: &str| positive(case, &format!("materials.{name}.{key}"));
    Ok(Material {
        density: property("density")?,
        specific_heat: property("specific_heat")?,
        conductivity: property("conductivity")?,
    })
}

fn positive(case: &Params, key: &str) -> Result<f64, Refusal> {
    let value = case.number(key)?;
    if value > 0.0 {
        return Ok(value);
    }
    Err(Refusal::new(key, format!("{value} is not greater than 0"), "write a positive number"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn case() -> serde_json::Value {
        json!({
            "bodies": {"wheel": {"position": "upper", "material": "steel"}, "rail": {"position": "lower", "material": "iron"}},
            "materials": {
                "steel": {"density": 7850.0, "specific_heat": 419.5, "conductivity": 50.0},
                "iron": {"density": 7000.0, "specific_heat": 500.0, "conductivity": 40.0},
            },
            "motion": {"speed": 38.889},
        })
    }

    #[test]
    fn each_body_gets_its_own_material() {
        let scene = Scene::read(&Params(case())).unwrap();
        assert_eq!(scene.materials.map(|m| m.density), [7850.0, 7000.0]);
        assert_eq!(scene.speeds, [38.889; 2]);
    }

    #[test]
    fn refusals_name_the_key() {
        let mut bad = case();
        bad["materials"]["iron"]["conductivity"] = json!(0.0);
        let refusal = Scene::read(&Params(bad)).unwrap_err();
        assert_eq!(refusal.key, "materials.iron.conductivity");
        let mut bad = case();
        bad["bodies"]["wheel"]["material"] = json!("brass");
        assert_eq!(Scene::read(&Params(bad)).unwrap_err().key, "materials.brass.density");
    }
}
