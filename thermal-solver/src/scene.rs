//! What the thermal participant reads from a case, whatever the model: materials and speed.

use proto::configuration::Refusal;
use proto::description::KeySpec;
use proto::params::Params;

/// Thermal properties of a body, constant over the temperature.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Material {
    /// Density ρ [kg/m³].
    pub density: f64,
    /// Specific heat c [J/(kg·K)].
    pub specific_heat: f64,
    /// Conductivity λ [W/(m·K)].
    pub conductivity: f64,
}

impl Material {
    /// Diffusivity κ = λ/(ρc) [m²/s].
    #[must_use]
    pub fn diffusivity(&self) -> f64 {
        self.conductivity / (self.density * self.specific_heat)
    }

    /// Effusivity β = √(λρc) [J/(m²·K·√s)], see [`crate::reference::scales`].
    #[must_use]
    pub fn effusivity(&self) -> f64 {
        (self.conductivity * self.density * self.specific_heat).sqrt()
    }
}

/// The bodies and their speed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scene {
    /// Materials of wheel and rail.
    pub materials: [Material; 2],
    /// Rolling speed V [m/s]; sets the depth of the sections only, the heat moves with the
    /// surface speeds that arrive as an input.
    pub speed: f64,
}

impl Scene {
    /// Reads the scene; refuses what is missing or not positive, with the key named.
    pub fn read(case: &Params) -> Result<Self, Refusal> {
        let wheel = read_material(case, case.text("wheel.material")?)?;
        let rail = read_material(case, case.text("rail.material")?)?;
        Ok(Self { materials: [wheel, rail], speed: positive(case, "motion.speed")? })
    }
}

/// The keys that [`Scene::read`] reads.
#[must_use]
pub fn keys() -> Vec<KeySpec> {
    let property = |name: &str, unit: &str, help: &str| {
        KeySpec::quantity(&format!("materials.*.{name}"), unit, help).required().above(0.0)
    };
    vec![
        KeySpec::name_in("wheel.material", "materials", "material of the wheel").required(),
        KeySpec::name_in("rail.material", "materials", "material of the rail").required(),
        property("density", "kg/m3", "mass per volume"),
        property("specific_heat", "J/(kg K)", "heat per mass and temperature"),
        property("conductivity", "W/(m K)", "heat flux per temperature gradient"),
        KeySpec::quantity("motion.speed", "m/s", "rolling speed").required().above(0.0),
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
            "wheel": {"material": "steel"}, "rail": {"material": "iron"},
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
        assert_eq!(scene.speed, 38.889);
    }

    #[test]
    fn refusals_name_the_key() {
        let mut bad = case();
        bad["materials"]["iron"]["conductivity"] = json!(0.0);
        let refusal = Scene::read(&Params(bad)).unwrap_err();
        assert_eq!(refusal.key, "materials.iron.conductivity");
        let mut bad = case();
        bad["wheel"]["material"] = json!("brass");
        assert_eq!(Scene::read(&Params(bad)).unwrap_err().key, "materials.brass.density");
    }
}
