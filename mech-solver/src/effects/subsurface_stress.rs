//! Effect `subsurface_stress`: stresses of both bodies in a vertical section along x.
//!
//! von Mises stress √(½[(σ₁ − σ₂)² + (σ₂ − σ₃)² + (σ₃ − σ₁)²]) and largest shear stress
//! ½(σ₁ − σ₃) of the elastic half-spaces under pressure and tractions
//! ([`crate::half_space::subsurface`]).
//!
//! Where the bodies expand as they are warm, their thermal stress is added ([`crate::half_space::subsurface::WarmBody`]): the rise at a depth
//! follows from its integrals at the surface, which raise that too, as the material moves steadily. A body at rest, in which heat
//! stays where it was and whose depth follows from all that was before, is refused with that.
//!
//! The point of each body with the largest von Mises stress is looked for in its whole volume ([`SurfaceLoad::peak`]), with the principal
//! stresses there and their directions; with thermal stress, which is known in the section alone, only in that.
//!
//! Source: Johnson, *Contact Mechanics* (1985) §3.2, §3.6 and §4.5; for thermal stress Goodier, Phil. Mag. 23 (1937).

use crate::entry::Effect;
use crate::half_space::subsurface::{Peak, RiseIntegral, Section, Stress, SurfaceLoad, WarmBody};
use crate::keys::CheckedParams;
use crate::scene::{Material, Scene};
use crate::situation::{PRESSURE, Situation};
use crate::terms::{Accepted, Kind, Observation, Place, State, Terms};
use proto::advice::Advice;
use proto::bodies::Bodies;
use proto::configuration::{Configuration, Refusal};
use proto::description::KeySpec;
use proto::field::{self, FieldSpec};
use proto::figure::FigureSpec;
use proto::grid::Structured;
use proto::model::Outputs;
use serde_json::{Value, json};

/// What the registry says of it.
pub const EFFECT: Effect = Effect {
    name: "subsurface_stress",
    law: "von Mises stress sqrt(3 J2) and largest shear stress (s1 - s3)/2 of the elastic half-spaces \
          in a vertical section, with the thermal stress of bodies that expand as they move steadily",
    source: "Johnson, Contact Mechanics (1985) par. 3.2, 3.6; Love, Phil. Trans. R. Soc. A 228 (1929); \
             Goodier, Phil. Mag. 23 (1937) 1017-1032",
    kinds: &[Kind::Observation],
    consumes: &[],
    provides: &[&VON_MISES[0], &VON_MISES[1], &MAX_SHEAR[0], &MAX_SHEAR[1]],
    keys,
    figures,
    advise: Some(advise),
    terms,
};

/// Names of the grids of both bodies.
const GRIDS: [&str; 2] = ["upper_stress_section", "lower_stress_section"];
const VON_MISES: [FieldSpec; 2] = [field::UPPER_SECTION_VON_MISES, field::LOWER_SECTION_VON_MISES];
const MAX_SHEAR: [FieldSpec; 2] = [field::UPPER_SECTION_MAX_SHEAR, field::LOWER_SECTION_MAX_SHEAR];

/// Depth of the section over the larger semi-axis, unless the case says otherwise.
const DEPTH: f64 = 2.0;

const DEPTH_KEY: &str = "effects.subsurface_stress.depth";
const LAYERS: &str = "effects.subsurface_stress.layers";
const LATERAL: &str = "effects.subsurface_stress.y";

/// What the diffusivity is made of.
const THERMAL: [(&str, &str, &str); 3] = [
    ("conductivity", "W/(m K)", "heat flux per temperature gradient; of bodies that expand"),
    ("density", "kg/m3", "mass per volume; of bodies that expand"),
    ("specific_heat", "J/(kg K)", "heat per mass and temperature; of bodies that expand"),
];

fn keys() -> Vec<KeySpec> {
    let thermal = THERMAL.map(|(name, unit, help)| {
        KeySpec::quantity(&format!("materials.*.{name}"), unit, help).above(0.0)
    });
    let mut keys = own_keys();
    keys.extend(thermal);
    keys
}

fn own_keys() -> Vec<KeySpec> {
    vec![
        KeySpec::quantity(
            DEPTH_KEY,
            "m",
            "depth of the section; absent: twice the larger semi-axis",
        )
        .above(0.0),
        KeySpec::integer(LAYERS, "points along the depth")
            .default_value(60)
            .at_least(1.0)
            .at_most(2000.0),
        KeySpec::quantity(
            LATERAL,
            "m",
            "lateral coordinate of the section; absent: through the highest pressure",
        ),
    ]
}

/// The sections that a case asks for.
#[derive(Debug)]
struct Sections {
    /// Depth [m]; `None` for what suits the contact.
    depth: Option<f64>,
    layers: usize,
    /// Lateral coordinate [m]; `None` for that of the highest pressure.
    y: Option<f64>,
    /// What the case calls the bodies.
    names: Bodies,
    /// Materials of both bodies, and by name.
    materials: [Material; 2],
    called: [String; 2],
    /// Conductivity [W/(m·K)], density [kg/m³] and specific heat [J/(kg·K)] of both, where the case says so.
    thermal: [[Option<f64>; 3]; 2],
    /// Coefficients of thermal expansion of bodies that expand [1/K].
    expansion: Option<[f64; 2]>,
    on: Option<Plane>,
    results: Option<[Fields; 2]>,
    peaks: [Option<Peak>; 2],
}

/// Where the sections lie.
#[derive(Debug)]
struct Plane {
    contact: Structured,
    y: f64,
    depths: Vec<f64>,
}

/// The stresses of one body, depth after depth [Pa].
#[derive(Clone, Debug, Default)]
struct Fields {
    von_mises: Vec<f64>,
    max_shear: Vec<f64>,
}

fn terms(configuration: &Configuration) -> Result<Terms, Refusal> {
    let case = CheckedParams::new(&configuration.case, keys());
    let scene = Scene::read(&configuration.case)?;
    let material = |body: usize| configuration.case.text(&scene.names.key(body, "material"));
    let called = [material(0)?.to_owned(), material(1)?.to_owned()];
    let mut thermal = [[None; 3]; 2];
    for (values, material) in thermal.iter_mut().zip(&called) {
        for (value, (name, ..)) in values.iter_mut().zip(THERMAL) {
            *value = case.maybe_number(&format!("materials.{material}.{name}"))?;
        }
    }
    let sections = Sections {
        depth: case.maybe_number(DEPTH_KEY)?,
        layers: usize::try_from(case.integer(LAYERS)?).expect("the key's range is positive"),
        y: case.maybe_number(LATERAL)?,
        materials: scene.materials(),
        called,
        thermal,
        expansion: None,
        names: scene.names,
        on: None,
        results: None,
        peaks: [None; 2],
    };
    Ok(Terms { observations: vec![Box::new(sections)], ..Terms::default() })
}

impl State for Sections {}

impl Sections {
    /// Thermal stresses of a body in its section, where it expands.
    fn thermal(&self, plane: &Plane, accepted: &Accepted<'_>, body: usize) -> Option<Vec<Stress>> {
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
        let xs: Vec<f64> = (0..plane.contact.ni).map(|column| plane.contact.x(column)).collect();
        Some(warm.stresses(&RiseIntegral { grid, values }, &xs, plane.y, &plane.depths))
    }
}

impl Observation for Sections {
    fn place(&mut self, place: &Place) {
        let [a, b] = place.semi_axes;
        let step = self.depth.unwrap_or(DEPTH * a.max(b)) / self.layers as f64;
        self.on = Some(Plane {
            contact: place.grid,
            y: self.y.unwrap_or(place.peak_y),
            depths: (0..self.layers).map(|k| (k as f64 + 0.5) * step).collect(),
        });
    }

    fn expand(&mut self, coefficients: [f64; 2], speeds: [f64; 2]) -> Result<(), Refusal> {
        for (body, speed) in speeds.into_iter().enumerate() {
            let lacking = THERMAL.iter().zip(self.thermal[body]).find(|(_, value)| value.is_none());
            if let Some(((name, ..), _)) = lacking {
                return Err(Refusal::new(
                    &format!("materials.{}.{name}", self.called[body]),
                    "missing: the thermal stress in the section needs the diffusivity",
                    format!("write it, or remove effects.{}", EFFECT.name),
                ));
            }
            if speed <= 0.0 {
                return Err(Refusal::new(
                    &self.names.key(body, "surface_speed"),
                    format!(
                        "`{}` is at rest: how deep its heat is follows from all that was before, and the thermal stress in \
                         the section is that of steady motion",
                        self.names.0[body]
                    ),
                    format!("write a speed above 0 m/s, or remove effects.{}", EFFECT.name),
                ));
            }
        }
        self.expansion = Some(coefficients);
        Ok(())
    }

    /// The section of the upper body lies above the contact, that of the lower one below.
    fn grids(&self) -> Vec<(&'static str, Structured)> {
        let Some(Plane { contact, y, depths }) = &self.on else { return Vec::new() };
        let step = 2.0 * depths[0];
        let grid = |up: f64| Structured {
            origin: [contact.x(0), *y, up * depths[0]],
            step_i: contact.step_i,
            step_j: [0.0, 0.0, up * step],
            ni: contact.ni,
            nj: depths.len(),
        };
        vec![(GRIDS[0], grid(1.0)), (GRIDS[1], grid(-1.0))]
    }

    fn grid_of(&self, field: &FieldSpec) -> Option<&'static str> {
        let body = (0..2).find(|body| [VON_MISES[*body], MAX_SHEAR[*body]].contains(field))?;
        Some(GRIDS[body])
    }

    fn observe(&mut self, accepted: &Accepted<'_>) {
        let Some(plane @ Plane { contact, y, depths }) = &self.on else { return };
        let turned: Vec<f64> = accepted.traction.iter().map(|value| -value).collect();
        let on = [accepted.traction, &turned];
        let warm = self.expansion.is_some();
        let of = |body: usize| SurfaceLoad::new(contact, accepted.pressure, on[body]);
        let peaks = [0, 1].map(|body| match warm {
            true => None,
            false => of(body).peak(self.materials[body].poisson_ratio, Stress::von_mises),
        });
        self.results = Some(std::array::from_fn(|body| {
            let load = of(body);
            let mut section = Section::new(contact, self.materials[body].poisson_ratio, *y, depths);
            let zeros = vec![0.0; section.points()];
            let mut fields = Fields { von_mises: zeros.clone(), max_shear: zeros };
            let thermal = self.thermal(plane, accepted, body);
            let Fields { von_mises, max_shear } = &mut fields;
            section.equivalents(&load, thermal.as_deref(), von_mises, max_shear);
            fields
        }));
        self.peaks = peaks;
    }

    fn write(&self, outputs: &mut dyn Outputs) {
        for (body, fields) in self.results.iter().flatten().enumerate() {
            for (spec, values) in
                [(&VON_MISES[body], &fields.von_mises), (&MAX_SHEAR[body], &fields.max_shear)]
            {
                if let Some(place) = outputs.get(spec) {
                    place.copy_from_slice(values);
                }
            }
        }
    }

    /// The largest values and where they are.
    fn summary(&self) -> Option<(&'static str, Value)> {
        let (Plane { contact, y, depths }, results) = (self.on.as_ref()?, self.results.as_ref()?);
        let largest = |values: &[f64]| {
            let (at, value) = values.iter().enumerate().max_by(|a, b| a.1.total_cmp(b.1))?;
            Some((*value, contact.x(at % contact.ni), depths[at / contact.ni]))
        };
        let body = |fields: &Fields, peak: &Option<Peak>, up: f64| {
            let (von_mises, x, depth) = largest(&fields.von_mises)?;
            let (shear, shear_x, shear_depth) = largest(&fields.max_shear)?;
            let mut figures = json!({
                "max_von_mises_pa": von_mises, "von_mises_x_m": x, "von_mises_depth_m": depth,
                "max_shear_pa": shear, "shear_x_m": shear_x, "shear_depth_m": shear_depth,
                "section_y_m": y,
            });
            if let Some(peak) = peak {
                figures["volume"] = in_the_volume(peak, up);
            }
            Some(figures)
        };
        let names = &self.names.0;
        let both = names.iter().zip(results).zip(self.peaks.iter().zip([1.0, -1.0])).filter_map(
            |((name, fields), (peak, up))| Some((name.clone(), body(fields, peak, up)?)),
        );
        Some(("stress", Value::Object(both.collect())))
    }
}

/// The largest von Mises stress of a body; `up` is 1 for the upper one and −1 for the lower one, whose depth points down.
fn in_the_volume(peak: &Peak, up: f64) -> Value {
    let [x, y, depth] = peak.place;
    let principal = peak.stress.principal_directions();
    json!({
        "max_von_mises_pa": peak.stress.von_mises(), "x_m": x, "y_m": y, "depth_m": depth,
        "principal_pa": principal.map(|(value, _)| value),
        "directions": principal.map(|(_, [x, y, z])| [x, y, up * z]),
    })
}

fn figures() -> Vec<FigureSpec> {
    let figure =
        |name: &str, unit, words| FigureSpec::new(&format!("stress.*.{name}"), unit, words);
    vec![
        figure("volume.max_von_mises_pa", "Pa", "largest von Mises stress in the body")
            .on("stress in *", "von Mises")
            .digits(4),
        figure("volume.x_m", "m", "where it is, along x").on("stress in *", "at x"),
        figure("volume.y_m", "m", "where it is, along y").on("stress in *", "y"),
        figure("volume.depth_m", "m", "how deep it is").on("stress in *", "depth"),
        figure("max_von_mises_pa", "Pa", "largest von Mises stress in the section"),
        figure("max_shear_pa", "Pa", "largest shear stress in the section"),
    ]
}

fn advise(_: &Situation<'_>) -> Advice {
    Advice::new(EFFECT.name, "computed of the contact, and changes nothing in it")
        .moves(PRESSURE, 0.0)
        .with(format!("effects.{}={{}}", EFFECT.name))
}
