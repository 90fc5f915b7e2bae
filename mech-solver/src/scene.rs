//! What the case says of bodies, motion, load and friction, as plain structs in SI units.

use crate::keys::CheckedParams;
use proto::configuration::Refusal;
use proto::description::KeySpec;
use proto::params::Params;

/// Elastic constants of one body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Material {
    /// Young's modulus E [Pa].
    pub youngs_modulus: f64,
    /// Poisson's ratio ν [-].
    pub poisson_ratio: f64,
}

impl Material {
    /// Plane-strain compliance (1 − ν²)/E [1/Pa].
    #[must_use]
    pub fn compliance(&self) -> f64 {
        (1.0 - self.poisson_ratio.powi(2)) / self.youngs_modulus
    }

    /// Shear modulus E/(2(1 + ν)) [Pa].
    #[must_use]
    pub fn shear_modulus(&self) -> f64 {
        0.5 * self.youngs_modulus / (1.0 + self.poisson_ratio)
    }
}

/// What drives the wheel: a force or a creepage. Positive forces and negative creepages drive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Drive {
    /// Longitudinal force on the wheel over the normal force [-].
    TractionCoefficient(f64),
    /// Longitudinal force on the wheel [N].
    TangentialForce(f64),
    /// Velocity of the wheel relative to the rail, over the rolling speed.
    Creepage {
        /// Longitudinal [-].
        xi: f64,
        /// Lateral [-].
        eta: f64,
        /// Spin [rad/m].
        phi: f64,
    },
    /// Rigid shift of the wheel against the rail, without rolling: along x and y [m], about z [rad].
    Shift([f64; 3]),
}

/// What presses the bodies together.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Load {
    /// Normal force N [N].
    NormalForce(f64),
    /// Approach of the bodies [m].
    Approach(f64),
}

/// The case values that every model reads.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scene {
    /// Rolling radius of the wheel [m].
    pub wheel_radius: f64,
    /// Lateral curvature of the wheel tread, positive convex, 0 for a straight cone [1/m].
    pub tread_curvature: f64,
    /// Lateral radius of the rail crown [m]; `None` where a profile takes its place.
    pub rail_crown_radius: Option<f64>,
    /// Material of the wheel.
    pub wheel: Material,
    /// Material of the rail.
    pub rail: Material,
    /// Rolling speed V [m/s]; 0 for bodies that do not roll.
    pub rolling_speed: f64,
    /// Prescribed force or creepage.
    pub drive: Drive,
    /// Prescribed normal force or approach.
    pub load: Load,
    /// Friction coefficient f [-].
    pub friction_coefficient: f64,
    /// Elements per semi-axis a.
    pub resolution: usize,
}

/// A contact ellipse given by the case in place of the Hertz solution.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GivenPatch {
    /// Semi-axis a along x [m].
    pub semi_axis_a: f64,
    /// Semi-axis b along y [m].
    pub semi_axis_b: f64,
    /// Pressure p_0 at the centre [Pa].
    pub max_pressure: f64,
}

/// The keys that [`Scene::read`] reads.
#[must_use]
pub fn keys() -> Vec<KeySpec> {
    let mut keys = body_keys();
    keys.extend(motion_keys());
    keys.push(
        KeySpec::quantity(NORMAL_FORCE, "N", "normal force").required().above(0.0).one_of("load"),
    );
    keys.push(
        KeySpec::quantity(APPROACH, "m", "approach of the bodies, from first touch")
            .above(0.0)
            .one_of("load"),
    );
    keys.push(
        KeySpec::number("friction.coefficient", "friction coefficient").required().above(0.0),
    );
    keys.push(
        KeySpec::integer(RESOLUTION, "elements per semi-axis a: dx = dy = a/resolution")
            .default_value(40)
            .at_least(1.0)
            .at_most(2000.0),
    );
    keys
}

fn body_keys() -> Vec<KeySpec> {
    vec![
        KeySpec::quantity("wheel.radius", "m", "rolling radius of the wheel").required().above(0.0),
        KeySpec::quantity(
            "wheel.tread_radius",
            "m",
            "lateral radius of the wheel tread; absent: straight, negative: concave",
        ),
        KeySpec::name_in("wheel.material", "materials", "material of the wheel").required(),
        KeySpec::quantity(CROWN_RADIUS, "m", "lateral radius of the rail crown")
            .required()
            .above(0.0)
            .one_of(RAIL_SHAPE),
        KeySpec::name_in("rail.material", "materials", "material of the rail").required(),
        KeySpec::quantity("materials.*.youngs_modulus", "Pa", "Young's modulus")
            .required()
            .above(0.0),
        KeySpec::number("materials.*.poisson_ratio", "Poisson's ratio")
            .required()
            .above(-1.0)
            .at_most(0.5),
    ]
}

pub(crate) const NORMAL_FORCE: &str = "load.normal_force";
pub(crate) const APPROACH: &str = "load.approach";
/// Key of the elements per semi-axis.
pub(crate) const RESOLUTION: &str = "mech.resolution";
pub(crate) const CROWN_RADIUS: &str = "rail.crown_radius";
/// Group of the alternatives that give the rail its shape.
pub(crate) const RAIL_SHAPE: &str = "rail.shape";

/// Group of the alternatives that drive the wheel.
pub(crate) const DRIVE: &str = "motion.drive";
const TRACTION_COEFFICIENT: &str = "motion.traction_coefficient";
const TANGENTIAL_FORCE: &str = "motion.tangential_force";
const CREEPAGE: &str = "motion.creepage.xi";
pub(crate) const SPEED: &str = "motion.speed";
const SHIFT: [&str; 3] = ["motion.shift.x", "motion.shift.y", "motion.shift.turn"];

fn motion_keys() -> Vec<KeySpec> {
    vec![
        KeySpec::quantity(SPEED, "m/s", "rolling speed; 0 for a shift without rolling")
            .required()
            .at_least(0.0),
        KeySpec::number(
            TRACTION_COEFFICIENT,
            "longitudinal force on the wheel over normal force; positive drives",
        )
        .one_of(DRIVE)
        .magnitude_below(&["friction.coefficient"]),
        KeySpec::quantity(
            TANGENTIAL_FORCE,
            "N",
            "longitudinal force on the wheel; positive drives",
        )
        .one_of(DRIVE)
        .magnitude_below(&["friction.coefficient", "load.normal_force"]),
        KeySpec::number(CREEPAGE, "longitudinal creepage; negative drives").one_of(DRIVE),
        KeySpec::number("motion.creepage.eta", "lateral creepage").one_of(DRIVE).default_value(0.0),
        KeySpec::quantity("motion.creepage.phi", "1/m", "spin creepage [rad/m]")
            .one_of(DRIVE)
            .default_value(0.0),
    ]
}

/// The keys of a shift, for the models that solve one.
#[must_use]
pub fn shift_keys() -> Vec<KeySpec> {
    let help = [
        "rigid shift of the wheel along x, made in the first window",
        "rigid shift of the wheel along y",
        "rigid rotation of the wheel about z [rad]",
    ];
    let key = |k: usize| {
        let unit = if k == 2 { "1" } else { "m" };
        KeySpec::quantity(SHIFT[k], unit, help[k]).one_of(DRIVE).default_value(0.0)
    };
    (0..3).map(key).collect()
}

/// The keys that [`GivenPatch::read`] reads, for the models that take a given ellipse.
#[must_use]
pub fn given_patch_keys() -> Vec<KeySpec> {
    let key = |path, unit, help| KeySpec::quantity(path, unit, help).above(0.0).together("contact");
    vec![
        key("contact.semi_axis_a", "m", "semi-axis along x, in place of the Hertz solution's"),
        key("contact.semi_axis_b", "m", "semi-axis along y, in place of the Hertz solution's"),
        key("contact.max_pressure", "Pa", "largest pressure, in place of the Hertz solution's"),
    ]
}

impl Scene {
    /// Reads the case values named by [`keys`].
    ///
    /// # Errors
    /// A key that is missing or out of range, a tread radius of zero, and none or several of the
    /// alternatives that drive the wheel.
    pub fn read(params: &Params) -> Result<Self, Refusal> {
        let case = CheckedParams::new(params, keys());
        Ok(Self {
            wheel_radius: case.number("wheel.radius")?,
            tread_curvature: read_tread_curvature(&case)?,
            rail_crown_radius: case.maybe_number(CROWN_RADIUS)?,
            wheel: read_material(&case, "wheel.material")?,
            rail: read_material(&case, "rail.material")?,
            rolling_speed: case.number(SPEED)?,
            drive: read_drive(params, &case)?,
            load: read_load(&case)?,
            friction_coefficient: case.number("friction.coefficient")?,
            resolution: usize::try_from(case.integer(RESOLUTION)?)
                .expect("the key's range is positive and small"),
        })
    }

    /// Coefficient of x² in the gap of the undeformed bodies, 1/(2 R_wheel) [1/m].
    #[must_use]
    pub fn gap_coefficient_x(&self) -> f64 {
        0.5 / self.wheel_radius
    }

    /// Coefficient of y² in the gap of the undeformed bodies, half the sum of the lateral
    /// curvatures [1/m]; not positive when the tread is as hollow as the crown is round. A rail
    /// without a radius counts as flat.
    #[must_use]
    pub fn gap_coefficient_y(&self) -> f64 {
        0.5 * (self.rail_crown_radius.map_or(0.0, f64::recip) + self.tread_curvature)
    }

    /// Sum of both bodies' compliances, (1 − ν₁²)/E₁ + (1 − ν₂²)/E₂ [1/Pa]
    /// (Naeimi et al., eq. 19, where it is written E*).
    #[must_use]
    pub fn contact_compliance(&self) -> f64 {
        self.wheel.compliance() + self.rail.compliance()
    }

    /// Shear modulus G of both bodies together, 1/G = ½(1/G₁ + 1/G₂) [Pa] (Kalker 1990).
    #[must_use]
    pub fn combined_shear_modulus(&self) -> f64 {
        2.0 / (self.wheel.shear_modulus().recip() + self.rail.shear_modulus().recip())
    }

    /// Poisson's ratio ν of both bodies together, ν/G = ½(ν₁/G₁ + ν₂/G₂) [-] (Kalker 1990).
    #[must_use]
    pub fn combined_poisson_ratio(&self) -> f64 {
        let share = |body: &Material| body.poisson_ratio / body.shear_modulus();
        0.5 * self.combined_shear_modulus() * (share(&self.wheel) + share(&self.rail))
    }
}

impl GivenPatch {
    /// Reads the ellipse if the case gives one.
    ///
    /// # Errors
    /// A value that is out of range, and an ellipse given in part.
    pub fn read(params: &Params) -> Result<Option<Self>, Refusal> {
        let case = CheckedParams::new(params, given_patch_keys());
        let names = ["contact.semi_axis_a", "contact.semi_axis_b", "contact.max_pressure"];
        if !names.iter().any(|name| case.has(name)) {
            return Ok(None);
        }
        Ok(Some(Self {
            semi_axis_a: case.number(names[0])?,
            semi_axis_b: case.number(names[1])?,
            max_pressure: case.number(names[2])?,
        }))
    }
}

fn read_material(case: &CheckedParams<'_>, key: &str) -> Result<Material, Refusal> {
    let name = case.text(key)?;
    Ok(Material {
        youngs_modulus: case.number(&format!("materials.{name}.youngs_modulus"))?,
        poisson_ratio: case.number(&format!("materials.{name}.poisson_ratio"))?,
    })
}

fn read_tread_curvature(case: &CheckedParams<'_>) -> Result<f64, Refusal> {
    const KEY: &str = "wheel.tread_radius";
    match case.maybe_number(KEY)? {
        None => Ok(0.0),
        Some(0.0) => Err(Refusal::new(
            KEY,
            "a radius of zero is a knife edge",
            "write the lateral radius of the tread, or leave the key out for a straight tread",
        )),
        Some(radius) => Ok(1.0 / radius),
    }
}

fn read_load(case: &CheckedParams<'_>) -> Result<Load, Refusal> {
    match (case.maybe_number(NORMAL_FORCE)?, case.maybe_number(APPROACH)?) {
        (Some(force), None) => Ok(Load::NormalForce(force)),
        (None, Some(approach)) => Ok(Load::Approach(approach)),
        (None, None) => Err(Refusal::new(
            NORMAL_FORCE,
            "missing",
            format!("add `{NORMAL_FORCE}` or `{APPROACH}`"),
        )),
        (Some(_), Some(_)) => Err(Refusal::new(
            APPROACH,
            format!("excludes `{NORMAL_FORCE}`: each determines the other"),
            format!("keep {NORMAL_FORCE} or {APPROACH}"),
        )),
    }
}

fn read_drive(params: &Params, case: &CheckedParams<'_>) -> Result<Drive, Refusal> {
    let alternatives = [TRACTION_COEFFICIENT, TANGENTIAL_FORCE, CREEPAGE, "motion.shift"];
    let given: Vec<_> = alternatives.into_iter().filter(|key| case.has(key)).collect();
    match given[..] {
        [TRACTION_COEFFICIENT] => {
            Ok(Drive::TractionCoefficient(case.number(TRACTION_COEFFICIENT)?))
        }
        [TANGENTIAL_FORCE] => Ok(Drive::TangentialForce(case.number(TANGENTIAL_FORCE)?)),
        [CREEPAGE] => Ok(Drive::Creepage {
            xi: case.number(CREEPAGE)?,
            eta: case.number("motion.creepage.eta")?,
            phi: case.number("motion.creepage.phi")?,
        }),
        [_] => {
            let case = CheckedParams::new(params, shift_keys());
            let [x, y, turn] = SHIFT.map(|key| case.number(key));
            Ok(Drive::Shift([x?, y?, turn?]))
        }
        [] => Err(Refusal::new(
            "motion",
            "nothing says how the wheel is driven",
            format!("add one of {}", alternatives.join(", ")),
        )),
        [_, second, ..] => Err(Refusal::new(
            second,
            format!("excludes `{}`: each determines how the wheel is driven", given[0]),
            format!("keep one of {}", given.join(", ")),
        )),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::{Value, json};

    fn case() -> Value {
        json!({
            "wheel": {"radius": 0.46, "material": "steel"},
            "rail": {"crown_radius": 0.3, "material": "rubber"},
            "materials": {
                "steel": {"youngs_modulus": 210e9, "poisson_ratio": 0.3},
                "rubber": {"youngs_modulus": 1e6, "poisson_ratio": 0.5},
            },
            "motion": {"speed": 38.889, "traction_coefficient": 0.58},
            "load": {"normal_force": 134e3},
            "friction": {"coefficient": 0.6},
        })
    }

    fn refused(change: impl FnOnce(&mut Value)) -> Refusal {
        let mut case = case();
        change(&mut case);
        Scene::read(&Params(case)).unwrap_err()
    }

    #[test]
    fn reads_both_bodies_and_fills_defaults() {
        let scene = Scene::read(&Params(case())).unwrap();
        assert_eq!(scene.wheel.youngs_modulus, 210e9);
        assert_eq!(scene.rail.poisson_ratio, 0.5);
        assert_eq!(scene.resolution, 40);
        assert_eq!(scene.tread_curvature, 0.0);
        assert_eq!(scene.drive, Drive::TractionCoefficient(0.58));
        assert_eq!(scene.gap_coefficient_x(), 0.5 / 0.46);
        assert_eq!(scene.contact_compliance(), 0.91 / 210e9 + 0.75 / 1e6);
        // Rubber is so much softer that it alone deforms: G = 2 G₂, ν = ν₂.
        let (steel, rubber) = (210e9 / 2.6, 1e6 / 3.0);
        let expected = 2.0 / (1.0 / steel + 1.0 / rubber);
        assert!((scene.combined_shear_modulus() / expected - 1.0).abs() < 1e-15);
        assert!((scene.combined_poisson_ratio() - 0.5).abs() < 1e-6);
    }

    #[test]
    fn refusals_name_the_key() {
        assert_eq!(refused(|c| c["wheel"]["radius"] = json!(0.0)).key, "wheel.radius");
        assert_eq!(refused(|c| c["wheel"]["tread_radius"] = json!(0)).key, "wheel.tread_radius");
        assert_eq!(
            refused(|c| c["materials"]["steel"]["poisson_ratio"] = json!(0.51)).key,
            "materials.steel.poisson_ratio"
        );
        assert_eq!(
            refused(|c| c["rail"]["material"] = json!("wood")).key,
            "materials.wood.youngs_modulus"
        );
        assert_eq!(refused(|c| c["mech"] = json!({"resolution": 2001})).key, "mech.resolution");
        assert_eq!(refused(|c| c["motion"] = json!({"speed": 1.0})).key, "motion");
        let two = refused(|c| c["motion"]["creepage"] = json!({"xi": 0.0}));
        assert_eq!(two.key, "motion.creepage.xi");
    }

    #[test]
    fn creepage_defaults_of_the_other_components_are_zero() {
        let mut case = case();
        case["motion"] = json!({"speed": 1.0, "creepage": {"xi": -0.01}});
        let scene = Scene::read(&Params(case)).unwrap();
        assert_eq!(scene.drive, Drive::Creepage { xi: -0.01, eta: 0.0, phi: 0.0 });
    }

    #[test]
    fn a_given_patch_is_whole_or_absent() {
        let read = |value| GivenPatch::read(&Params(value));
        assert_eq!(read(json!({})), Ok(None));
        let part = json!({"contact": {"semi_axis_a": 1.0, "max_pressure": 1.0}});
        assert_eq!(read(part).unwrap_err().key, "contact.semi_axis_b");
        let whole =
            json!({"contact": {"semi_axis_a": 1.0, "semi_axis_b": 2.0, "max_pressure": 3.0}});
        assert_eq!(read(whole).unwrap().unwrap().semi_axis_b, 2.0);
    }
}
