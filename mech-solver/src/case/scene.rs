//! Bodies, load and friction of a case, as plain structs in SI units. Its motion is in
//! [`super::motion`].

use crate::case::keys::CheckedParams;
use crate::case::motion::{motion_keys, read_drive, read_rolling_speed, read_surface_speeds};
use elastic::{Material, hertz};
use proto::bodies::{Bodies, LOWER, UPPER, position_key, surface_speed_key};
use proto::configuration::Refusal;
use proto::description::{KeySpec, Renamed};
use proto::params::Params;
use std::sync::LazyLock;

pub(crate) use crate::case::motion::{DRIVE, SPEED, prescribes_force};
pub use crate::case::motion::{Drive, Speeds, shift_keys};

/// Prescribed normal load.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Load {
    /// Normal force N [N].
    NormalForce(f64),
    /// Approach of the bodies [m].
    Approach(f64),
}

/// One body of the pair.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Body {
    /// Radius along x [m], the rolling radius of a rotating body; infinite for a straight body,
    /// negative for a concave one.
    pub radius_x: f64,
    /// Lateral radius [m]; infinite for a straight body, negative for a concave one.
    pub radius_y: f64,
    /// Elastic constants.
    pub material: Material,
    /// Yield stress [Pa], if the case gives one.
    pub yield_stress: Option<f64>,
}

/// Case values that every model reads.
#[derive(Clone, Debug, PartialEq)]
pub struct Scene {
    /// Names of the upper and the lower body in the case.
    pub names: Bodies,
    /// Upper and lower body.
    pub bodies: [Body; 2],
    /// Speeds of rolling and of the surfaces.
    pub speeds: Speeds,
    /// Prescribed force, creepage or shift.
    pub drive: Drive,
    /// Prescribed normal force or approach.
    pub load: Load,
    /// Friction coefficient f [-].
    pub friction_coefficient: f64,
    /// Width of a line contact, uniform across it [m]; `None` for an ellipse.
    pub width: Option<f64>,
}

/// Contact ellipse given by the case in place of the Hertz solution.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GivenPatch {
    /// Semi-axis a along x [m].
    pub semi_axis_a: f64,
    /// Semi-axis b along y [m].
    pub semi_axis_b: f64,
    /// Pressure p_0 at the centre [Pa].
    pub max_pressure: f64,
}

/// Keys that [`Scene::read`] reads. They are built once, because a history has a scene in every
/// row.
static KEYS: LazyLock<Vec<KeySpec>> =
    LazyLock::new(|| [body_keys(), contact_keys(), vec![width_key()]].concat());

/// Returns the keys of motion, load and friction. [`Scene::read`] also reads [`body_keys`] and
/// [`width_key`].
#[must_use]
pub fn contact_keys() -> Vec<KeySpec> {
    let mut keys = motion_keys();
    keys.push(
        KeySpec::quantity(NORMAL_FORCE, "N", "normal force")
            .expected(1e-6..=5e6, "heavy axles press with 2e5 N; check the unit")
            .varies()
            .required()
            .above(0.0)
            .one_of("load"),
    );
    keys.push(
        KeySpec::quantity(APPROACH, "m", "approach of the bodies, from first touch")
            .expected(0.0..=1e-3, "a loaded wheel approaches the rail by 0.1 mm; check the unit")
            .varies()
            .above(0.0)
            .one_of("load"),
    );
    keys.push(
        KeySpec::quantity(
            MAX_PRESSURE,
            "Pa",
            "largest pressure of Hertz's contact of the radii, from which the normal force follows",
        )
        .expected(0.0..=1e10, "the hardest steels yield below 1e10 Pa; check the unit")
        .varies()
        .above(0.0)
        .one_of("load"),
    );
    keys.push(
        KeySpec::number("friction.coefficient", "friction coefficient")
            .expected(0.0..=1.0, "dry steel has 0.3 to 0.6, clean metals and rubber more")
            .varies()
            .required()
            .above(0.0),
    );
    keys
}

/// Returns the keys of the bodies and their materials, which every model reads.
#[must_use]
pub fn body_keys() -> Vec<KeySpec> {
    vec![
        position_key(),
        KeySpec::quantity(
            "bodies.*.radius_x",
            "m",
            "rolling radius; omit for a straight body; negative if concave",
        )
        .expected(1e-4..=50.0, "bearing balls to mill rolls; check the unit")
        .varies(),
        KeySpec::quantity(
            "bodies.*.radius_y",
            "m",
            "lateral radius; absent: straight, negative: concave",
        )
        .expected(1e-4..=1e3, "beyond a kilometre a body is straight; check the unit")
        .varies(),
        KeySpec::name_in("bodies.*.material", "materials", "material of the body").required(),
        surface_speed_key(),
        KeySpec::quantity("materials.*.youngs_modulus", "Pa", "Young's modulus")
            .required()
            .expected(1e4..=f64::INFINITY, "gels are stiffer; check the unit")
            .above(0.0),
        KeySpec::number("materials.*.poisson_ratio", "Poisson's ratio")
            .required()
            .above(-1.0)
            .at_most(0.5),
        KeySpec::quantity(
            "materials.*.yield_stress",
            "Pa",
            "yield stress, for the shakedown figures of the summary and plastic flow of explicit elements",
        )
        .expected(1e4..=1e10, "the hardest steels have 3 GPa; check the unit")
        .above(0.0),
    ]
}

/// Returns the tables of bodies of version 0.1, with their present names.
#[must_use]
pub fn renamed() -> Vec<Renamed> {
    let table = |name: &str, position: &str, radii: &str| {
        let to = format!("[bodies.{name}] with position = \"{position}\", {radii}");
        Renamed::new(name, &to)
    };
    vec![
        table("wheel", "upper", "radius_x for radius, radius_y for tread_radius"),
        table("rail", "lower", "radius_y for crown_radius"),
    ]
}

pub(crate) const NORMAL_FORCE: &str = "load.normal_force";
pub(crate) const APPROACH: &str = "load.approach";
const MAX_PRESSURE: &str = "load.max_pressure";
/// Alternative keys of the load.
const LOADS: [&str; 3] = [NORMAL_FORCE, APPROACH, MAX_PRESSURE];

pub(crate) const WIDTH: &str = "contact.width";

/// Returns the key of the width of a line contact, for the models that solve one.
#[must_use]
pub fn width_key() -> KeySpec {
    let help = "width of bodies that touch along a line (plane strain, uniform across the width); absent: an ellipse";
    KeySpec::quantity(WIDTH, "m", help)
        .expected(1e-4..=10.0, "from thin discs to mill rolls; check the unit")
        .above(0.0)
}

/// Returns the keys that [`GivenPatch::read`] reads, for the models that accept a given ellipse.
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
    /// Returns true if one body is at rest while the other passes, so that the whole contact
    /// slides.
    #[must_use]
    pub fn slides(&self) -> bool {
        let Drive::Creepage { xi, .. } = self.drive else { return false };
        self.speeds.rolling > 0.0 && self.speeds.of_surfaces(xi).contains(&0.0)
    }

    /// Reads the case values named by [`body_keys`], [`contact_keys`] and [`width_key`].
    ///
    /// # Errors
    /// A key that is missing or out of range; a radius of zero; none or several of the alternatives
    /// that drive the upper body.
    pub fn read(params: &Params) -> Result<Self, Refusal> {
        let case = CheckedParams::new(params, &KEYS[..]);
        let names = Bodies::read(params)?;
        let prescribed = read_surface_speeds(&case, &names)?;
        let [upper, lower] = [UPPER, LOWER].map(|body| read_body(params, &case, &names, body));
        let bodies = [upper?, lower?];
        let speeds = Speeds { rolling: read_rolling_speed(&case, &names, prescribed)?, prescribed };
        let mut scene = Self {
            bodies,
            drive: read_drive(params, &case, &names, speeds)?,
            names,
            speeds,
            load: Load::NormalForce(0.0),
            friction_coefficient: case.number("friction.coefficient")?,
            width: case.maybe_number(WIDTH)?,
        };
        scene.load = scene.read_load(&case)?;
        Ok(scene)
    }

    /// Reads the load. Hertz's contact of the radii turns a largest pressure into a normal force.
    fn read_load(&self, case: &CheckedParams<'_>) -> Result<Load, Refusal> {
        let given: Vec<&str> = LOADS.into_iter().filter(|key| case.has(key)).collect();
        match given[..] {
            [NORMAL_FORCE] => Ok(Load::NormalForce(case.number(NORMAL_FORCE)?)),
            [APPROACH] => Ok(Load::Approach(case.number(APPROACH)?)),
            [_] => Ok(Load::NormalForce(self.force_at_pressure(case.number(MAX_PRESSURE)?)?)),
            [] => Err(Refusal::new(NORMAL_FORCE, "missing", format!("add {}", LOADS.join(" or ")))),
            [first, second, ..] => Err(Refusal::new(
                second,
                format!("excludes `{first}`: each determines the other"),
                format!("keep one of {}", given.join(", ")),
            )),
        }
    }

    /// Normal force at which Hertz's contact of the radii has this largest pressure [N].
    fn force_at_pressure(&self, pressure: f64) -> Result<f64, Refusal> {
        let [along, across] = [self.gap_coefficient_x(), self.gap_coefficient_y()];
        let compliance = self.contact_compliance();
        if along <= 0.0 || (self.width.is_none() && across <= 0.0) {
            return Err(Refusal::new(
                MAX_PRESSURE,
                "needs the radii of a closed contact, along the motion and, without a width, across it",
                format!("give the radii, or write {NORMAL_FORCE}"),
            ));
        }
        // The pressure grows with the third root of the force, under a line with the square root.
        Ok(match self.width {
            Some(width) => {
                let unit = hertz::line_contact(along, width, 1.0, compliance).max_pressure;
                (pressure / unit).powi(2)
            }
            None => {
                let unit = hertz::elliptic_contact(along, across, 1.0, compliance).max_pressure;
                (pressure / unit).powi(3)
            }
        })
    }

    /// Combined radius R of the pair along x, 1/R = 1/R₁ + 1/R₂ [m].
    #[must_use]
    pub fn relative_radius_x(&self) -> f64 {
        let [upper, lower] = self.bodies.map(|body| body.radius_x);
        // If one body is straight, return the other radius without rounding.
        match (upper.is_finite(), lower.is_finite()) {
            (_, false) => upper,
            (false, _) => lower,
            _ => (upper.recip() + lower.recip()).recip(),
        }
    }

    /// Smallest radius along x of the convex bodies [m]; infinite if there is none.
    #[must_use]
    pub fn smallest_radius_x(&self) -> f64 {
        let round = self.bodies.iter().map(|body| body.radius_x).filter(|radius| *radius > 0.0);
        round.fold(f64::INFINITY, f64::min)
    }

    /// Coefficient of x² in the gap of the undeformed bodies, half the sum of the curvatures along
    /// x [1/m].
    #[must_use]
    pub fn gap_coefficient_x(&self) -> f64 {
        0.5 * (self.bodies[LOWER].radius_x.recip() + self.bodies[UPPER].radius_x.recip())
    }

    /// Coefficient of y² in the gap of the undeformed bodies, half the sum of the lateral
    /// curvatures [1/m]. It is not positive if one body is at least as concave as the other is
    /// convex.
    #[must_use]
    pub fn gap_coefficient_y(&self) -> f64 {
        0.5 * (self.bodies[LOWER].radius_y.recip() + self.bodies[UPPER].radius_y.recip())
    }

    /// Materials of the upper and the lower body.
    #[must_use]
    pub fn materials(&self) -> [Material; 2] {
        self.bodies.map(|body| body.material)
    }

    /// Sum of the compliances of both bodies, (1 − ν₁²)/E₁ + (1 − ν₂²)/E₂ [1/Pa] (called E* in
    /// Naeimi et al., eq. 19).
    #[must_use]
    pub fn contact_compliance(&self) -> f64 {
        self.bodies[UPPER].material.compliance() + self.bodies[LOWER].material.compliance()
    }

    /// Combined shear modulus G of both bodies, 1/G = ½(1/G₁ + 1/G₂) [Pa] (Kalker 1990).
    #[must_use]
    pub fn combined_shear_modulus(&self) -> f64 {
        let [upper, lower] = self.materials().map(|material| material.shear_modulus());
        2.0 / (upper.recip() + lower.recip())
    }

    /// Combined Poisson's ratio ν of both bodies, ν/G = ½(ν₁/G₁ + ν₂/G₂) [-] (Kalker 1990).
    #[must_use]
    pub fn combined_poisson_ratio(&self) -> f64 {
        let share = |body: &Material| body.poisson_ratio / body.shear_modulus();
        let [upper, lower] = self.materials();
        0.5 * self.combined_shear_modulus() * (share(&upper) + share(&lower))
    }
}

impl GivenPatch {
    /// Reads the ellipse if the case gives one.
    ///
    /// # Errors
    /// A value that is out of range; an ellipse that is only partly given.
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

/// Reads the elastic constants of a body.
///
/// # Errors
/// A constant that is missing or out of range.
pub(crate) fn read_material(
    params: &Params,
    names: &Bodies,
    body: usize,
) -> Result<Material, Refusal> {
    let case = CheckedParams::new(params, &KEYS[..]);
    let name = case.text(&names.key(body, "material"))?;
    Ok(Material {
        youngs_modulus: case.number(&format!("materials.{name}.youngs_modulus"))?,
        poisson_ratio: case.number(&format!("materials.{name}.poisson_ratio"))?,
    })
}

fn read_body(
    params: &Params,
    case: &CheckedParams<'_>,
    names: &Bodies,
    body: usize,
) -> Result<Body, Refusal> {
    let radius = |name: &str| {
        let key = names.key(body, name);
        match case.maybe_number(&key)? {
            Some(0.0) => Err(Refusal::new(
                &key,
                "a radius of zero is a knife edge",
                "write the radius, or leave the key out for a straight body",
            )),
            radius => Ok(radius.unwrap_or(f64::INFINITY)),
        }
    };
    let material = case.text(&names.key(body, "material"))?;
    Ok(Body {
        yield_stress: case.maybe_number(&format!("materials.{material}.yield_stress"))?,
        radius_x: radius("radius_x")?,
        radius_y: radius("radius_y")?,
        material: read_material(params, names, body)?,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::{Value, json};

    fn case() -> Value {
        json!({
            "bodies": {"wheel": {"position": "upper", "radius_x": 0.46, "material": "steel"},
            "rail": {"position": "lower", "radius_y": 0.3, "material": "rubber"}},
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
        assert_eq!(scene.bodies[UPPER].material.youngs_modulus, 210e9);
        assert_eq!(scene.bodies[LOWER].material.poisson_ratio, 0.5);
        assert_eq!(scene.bodies[UPPER].radius_y, f64::INFINITY);
        assert_eq!(scene.relative_radius_x(), 0.46);
        assert_eq!(scene.drive, Drive::TractionCoefficient(0.58));
        assert_eq!(scene.gap_coefficient_x(), 0.5 / 0.46);
        assert_eq!(scene.contact_compliance(), 0.91 / 210e9 + 0.75 / 1e6);
        // Rubber is so much softer that practically only rubber deforms: G = 2 G₂, ν = ν₂.
        let (steel, rubber) = (210e9 / 2.6, 1e6 / 3.0);
        let expected = 2.0 / (1.0 / steel + 1.0 / rubber);
        assert!((scene.combined_shear_modulus() / expected - 1.0).abs() < 1e-15);
        assert!((scene.combined_poisson_ratio() - 0.5).abs() < 1e-6);
    }

    #[test]
    fn refusals_name_the_key() {
        assert_eq!(
            refused(|c| c["bodies"]["wheel"]["radius_x"] = json!(0.0)).key,
            "bodies.wheel.radius_x"
        );
        assert_eq!(
            refused(|c| c["bodies"]["wheel"]["radius_y"] = json!(0)).key,
            "bodies.wheel.radius_y"
        );
        assert_eq!(
            refused(|c| c["materials"]["steel"]["poisson_ratio"] = json!(0.51)).key,
            "materials.steel.poisson_ratio"
        );
        assert_eq!(
            refused(|c| c["bodies"]["rail"]["material"] = json!("wood")).key,
            "materials.wood.youngs_modulus"
        );
        assert_eq!(refused(|c| c["motion"] = json!({"speed": 1.0})).key, "motion");
        let two = refused(|c| c["motion"]["creepage"] = json!({"xi": 0.0}));
        assert_eq!(two.key, "motion.creepage");
        let both = refused(|c| c["bodies"]["rail"]["surface_speed"] = json!(3.0));
        assert_eq!(both.key, "motion.traction_coefficient");
    }

    /// A locked wheel slides at the full speed of the rail. Two discs have a creepage of their
    /// speed difference divided by the mean speed.
    #[test]
    fn surface_speeds_drive() {
        let mut case = case();
        case["motion"] = json!({"speed": 20.0});
        case["bodies"]["wheel"]["surface_speed"] = json!(0.0);
        let locked = Scene::read(&Params(case.clone())).unwrap();
        assert_eq!(locked.drive, Drive::Creepage { xi: 1.0, eta: 0.0, phi: 0.0 });
        assert_eq!(locked.speeds.of_surfaces(1.0), [0.0, 20.0]);
        case["motion"] = json!({});
        case["bodies"]["wheel"]["surface_speed"] = json!(3.0);
        case["bodies"]["rail"]["surface_speed"] = json!(1.0);
        let discs = Scene::read(&Params(case.clone())).unwrap();
        assert_eq!(discs.speeds, Speeds { rolling: 2.0, prescribed: Some([3.0, 1.0]) });
        assert_eq!(discs.drive, Drive::Creepage { xi: -1.0, eta: 0.0, phi: 0.0 });
        // A third speed is refused, with either fix, unless it is the mean.
        case["motion"] = json!({"speed": 7.0});
        let refused = Scene::read(&Params(case.clone())).unwrap_err();
        assert!(refused.key == SPEED && refused.reason.contains("2 m/s"), "{refused}");
        let mut one = case.clone();
        one["bodies"]["rail"].as_object_mut().unwrap().remove("surface_speed");
        assert_eq!(Scene::read(&Params(one)).unwrap().speeds.prescribed, Some([3.0, 7.0]));
        case["motion"] = json!({"speed": 2.0});
        assert_eq!(Scene::read(&Params(case.clone())).unwrap().speeds, discs.speeds);
        case["motion"] = json!({});
        case["bodies"]["wheel"]["surface_speed"] = json!(0.0);
        case["bodies"]["rail"]["surface_speed"] = json!(0.0);
        let rest = Scene::read(&Params(case)).unwrap_err();
        assert_eq!(rest.reason, "both surfaces are at rest");
    }

    /// A largest pressure is the load whose Hertz contact has it, of an ellipse and of a line.
    #[test]
    fn a_pressure_determines_the_load() {
        let mut case = case();
        case["load"] = json!({"max_pressure": 5e8});
        for (body, width) in [("rail", None), ("rail", Some(0.01))] {
            if width.is_some() {
                case["bodies"][body].as_object_mut().unwrap().remove("radius_y");
                case["contact"] = json!({"width": width});
            }
            let scene = Scene::read(&Params(case.clone())).unwrap();
            let Load::NormalForce(force) = scene.load else { panic!("{:?}", scene.load) };
            let [along, across] = [scene.gap_coefficient_x(), scene.gap_coefficient_y()];
            let compliance = scene.contact_compliance();
            let found = match width {
                Some(width) => hertz::line_contact(along, width, force, compliance),
                None => hertz::elliptic_contact(along, across, force, compliance),
            };
            assert!((found.max_pressure / 5e8 - 1.0).abs() < 1e-12, "{}", found.max_pressure);
        }
        case.as_object_mut().unwrap().remove("contact");
        assert_eq!(Scene::read(&Params(case.clone())).unwrap_err().key, MAX_PRESSURE, "no radius");
        case["load"]["normal_force"] = json!(1.0);
        assert_eq!(Scene::read(&Params(case)).unwrap_err().key, MAX_PRESSURE, "two loads");
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
