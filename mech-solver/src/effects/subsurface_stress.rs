//! Effect `subsurface_stress`: stresses of both bodies in a vertical section along x.
//!
//! von Mises stress √(½[(σ₁ − σ₂)² + (σ₂ − σ₃)² + (σ₃ − σ₁)²]) and largest shear stress
//! ½(σ₁ − σ₃) of the elastic half-spaces under pressure and tractions
//! ([`half_space::subsurface`]).
//!
//! If the bodies expand thermally, their thermal stress is added
//! ([`half_space::subsurface::WarmBody`]). In steady motion, the temperature rise at a depth
//! follows from the depth integrals at the surface that also determine the expansion.
//!
//! The largest von Mises stress of each body is searched in its whole volume
//! ([`SurfaceLoad::peak`]), and reported with the principal stresses and their directions. If the
//! contact has several patches, the search is repeated below each patch ([`SurfaceLoad::peaks`]).
//! Thermal stress is known only in the section; with it, only the section is searched.
//!
//! Source: Johnson, *Contact Mechanics* (1985) §3.2, §3.6 and §4.5; for thermal stress Goodier,
//! Phil. Mag. 23 (1937).

use crate::advice::situation::{PRESSURE, Situation};
use crate::case::keys::CheckedParams;
use crate::registry::entry::Effect;
use crate::terms::thermal_stress::{self, ThermalStress};
use crate::terms::{Accepted, Kind, Observation, Place, State, Terms};
use elastic::Material;
use elastic::Stress;
use half_space::patches::patches;
use half_space::subsurface::{Peak, Section, SurfaceLoad};
use proto::advice::Advice;
use proto::configuration::{Configuration, Refusal};
use proto::description::KeySpec;
use proto::field::{self, FieldSpec};
use proto::figure::{FigureSpec, Style};
use proto::grid::{Shape, Structured};
use proto::model::Outputs;
use serde_json::{Value, json};

/// Registry entry of the effect.
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

/// Largest number of patches with a peak of their own; the most heavily loaded ones are chosen.
const MOST_PATCHES: usize = 32;

/// Default depth of the section, relative to the larger semi-axis.
const DEPTH: f64 = 2.0;

const DEPTH_KEY: &str = "effects.subsurface_stress.depth";
const LAYERS: &str = "effects.subsurface_stress.layers";
const LATERAL: &str = "effects.subsurface_stress.y";

fn keys() -> Vec<KeySpec> {
    let mut keys = own_keys();
    keys.extend(thermal_stress::keys());
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

/// Requested sections and their results.
#[derive(Debug)]
struct Sections {
    /// Depth [m]; `None` for the default.
    depth: Option<f64>,
    layers: usize,
    /// Lateral coordinate [m]; `None` for the position of the highest pressure.
    y: Option<f64>,
    /// Materials and thermal stress of both bodies.
    thermal: ThermalStress,
    on: Option<Plane>,
    results: Option<[Fields; 2]>,
    peaks: [Option<Peak>; 2],
    /// Peaks of both bodies below each of several patches, with the number of the patch from 1.
    below_patches: [Vec<(usize, Peak)>; 2],
}

/// Position of the sections.
#[derive(Debug)]
struct Plane {
    contact: Structured,
    y: f64,
    depths: Vec<f64>,
}

/// Stresses of one body, depth after depth [Pa].
#[derive(Clone, Debug, Default)]
struct Fields {
    von_mises: Vec<f64>,
    max_shear: Vec<f64>,
}

fn terms(configuration: &Configuration) -> Result<Terms, Refusal> {
    let case = CheckedParams::new(&configuration.case, keys());
    let sections = Sections {
        depth: case.maybe_number(DEPTH_KEY)?,
        layers: usize::try_from(case.integer(LAYERS)?).expect("the key's range is positive"),
        y: case.maybe_number(LATERAL)?,
        thermal: ThermalStress::read(configuration, &case, EFFECT.name)?,
        on: None,
        results: None,
        peaks: [None; 2],
        below_patches: Default::default(),
    };
    Ok(Terms { observations: vec![Box::new(sections)], ..Terms::default() })
}

impl State for Sections {}

impl Sections {
    /// Thermal stresses of a body in its section; `None` if it does not expand.
    fn warm(&self, plane: &Plane, accepted: &Accepted<'_>, body: usize) -> Option<Vec<Stress>> {
        let (warm, rise) = self.thermal.of(accepted, body)?;
        let xs: Vec<f64> = (0..plane.contact.ni).map(|column| plane.contact.x(column)).collect();
        Some(warm.stresses(&rise, &xs, plane.y, &plane.depths))
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
        self.thermal.expand(coefficients, speeds)
    }

    /// Returns the grids of the sections: above the contact for the upper body, below it for the
    /// lower one.
    fn grids(&self) -> Vec<(&'static str, Shape)> {
        let Some(Plane { contact, y, depths }) = &self.on else { return Vec::new() };
        let step = 2.0 * depths[0];
        let grid = |up: f64| {
            Shape::Structured(Structured {
                origin: [contact.x(0), *y, up * depths[0]],
                step_i: contact.step_i,
                step_j: [0.0, 0.0, up * step],
                ni: contact.ni,
                nj: depths.len(),
            })
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
        let warm = self.thermal.is_there();
        let of = |body: usize| SurfaceLoad::new(contact, accepted.pressure, on[body]);
        let peaks = [0, 1].map(|body| match warm {
            true => None,
            false => of(body).peak(self.thermal.materials[body].poisson_ratio, Stress::von_mises),
        });
        self.below_patches = [0, 1].map(|body| match warm {
            true => Vec::new(),
            false => {
                below_patches(contact, accepted.pressure, &of(body), self.thermal.materials[body])
            }
        });
        self.results = Some(std::array::from_fn(|body| {
            let load = of(body);
            let mut section =
                Section::new(contact, self.thermal.materials[body].poisson_ratio, *y, depths);
            let zeros = vec![0.0; section.points()];
            let mut fields = Fields { von_mises: zeros.clone(), max_shear: zeros };
            let thermal = self.warm(plane, accepted, body);
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

    /// Largest values and their positions.
    fn summary(&self) -> Option<(&'static str, Value)> {
        let (Plane { contact, y, depths }, results) = (self.on.as_ref()?, self.results.as_ref()?);
        let largest = |values: &[f64]| {
            let (at, value) = values.iter().enumerate().max_by(|a, b| a.1.total_cmp(b.1))?;
            Some((*value, contact.x(at % contact.ni), depths[at / contact.ni]))
        };
        let body =
            |fields: &Fields, (peak, each): (&Option<Peak>, &Vec<(usize, Peak)>), up: f64| {
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
                if !each.is_empty() {
                    let patch = |(patch, peak): &(usize, Peak)| {
                        let mut figures = in_the_volume(peak, up);
                        figures["patch"] = (*patch).into();
                        figures
                    };
                    figures["each_patch"] = each.iter().map(patch).collect();
                }
                Some(figures)
            };
        let names = &self.thermal.names.0;
        let peaks = self.peaks.iter().zip(&self.below_patches).zip([1.0, -1.0]);
        let both =
            names.iter().zip(results).zip(peaks).filter_map(|((name, fields), (peaks, up))| {
                Some((name.clone(), body(fields, peaks, up)?))
            });
        Some(("stress", Value::Object(both.collect())))
    }
}

/// Returns the largest von Mises stress below each patch, in the lateral order of the patches;
/// empty for a single patch. If there are too many patches, only the most heavily loaded ones are
/// included.
fn below_patches(
    grid: &Structured,
    pressure: &[f64],
    load: &SurfaceLoad<'_>,
    material: Material,
) -> Vec<(usize, Peak)> {
    let all = patches(grid, pressure);
    if all.len() < 2 {
        return Vec::new();
    }
    let mut places: Vec<usize> = (0..all.len()).collect();
    places.sort_by(|a, b| all[*b].sum.total_cmp(&all[*a].sum));
    places.truncate(MOST_PATCHES);
    places.sort_unstable();
    let elements = places.iter().map(|place| all[*place].elements.as_slice());
    let peaks = load.peaks(material.poisson_ratio, Stress::von_mises, elements);
    places.iter().zip(peaks).filter_map(|(place, peak)| Some((place + 1, peak?))).collect()
}

/// Describes the largest von Mises stress of a body. `up` is 1 for the upper body and −1 for the
/// lower one, whose depth points down.
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
            .digits(4)
            .headline(),
        figure("volume.x_m", "m", "x of that stress").on("stress in *", "at x").style(Style::Place),
        figure("volume.y_m", "m", "y of that stress").on("stress in *", "y").style(Style::Place),
        figure("volume.depth_m", "m", "depth of that stress").on("stress in *", "depth"),
        figure("each_patch.#.patch", "1", "number of the patch among all, from 1"),
        figure("each_patch.#.max_von_mises_pa", "Pa", "largest von Mises stress below the patch"),
        figure("each_patch.#.x_m", "m", "x of that stress"),
        figure("each_patch.#.y_m", "m", "y of that stress"),
        figure("each_patch.#.depth_m", "m", "depth of that stress"),
        figure("max_von_mises_pa", "Pa", "largest von Mises stress in the section"),
        figure("max_shear_pa", "Pa", "largest shear stress in the section"),
    ]
}

fn advise(_: &Situation<'_>) -> Advice {
    Advice::new(EFFECT.name, "computed from the contact, without influence on it")
        .moves(PRESSURE, 0.0)
        .with(format!("effects.{}={{}}", EFFECT.name))
}
