//! Effect `subsurface_stress`: stresses of both bodies in a vertical section along x.
//!
//! von Mises stress √(½[(σ₁ − σ₂)² + (σ₂ − σ₃)² + (σ₃ − σ₁)²]) and largest shear stress
//! ½(σ₁ − σ₃) of the elastic half-spaces under pressure and tractions
//! ([`crate::half_space::subsurface`]).
//!
//! Source: Johnson, *Contact Mechanics* (1985) §3.2, §3.6 and §4.5.

use crate::half_space::subsurface::{Section, SurfaceLoad};
use crate::keys::CheckedParams;
use crate::models::names::HALF_SPACE;
use crate::scene::Scene;
use proto::bodies::Bodies;
use proto::configuration::{Configuration, Refusal};
use proto::description::{EffectSpec, KeySpec, names};
use proto::field::{self, FieldSpec};
use proto::grid::Structured;
use proto::model::Outputs;
use serde_json::{Value, json};

/// Name in the case file.
pub const NAME: &str = "subsurface_stress";

/// Names of the grids of both bodies.
pub(crate) const GRIDS: [&str; 2] = ["upper_stress_section", "lower_stress_section"];
const VON_MISES: [FieldSpec; 2] = [field::UPPER_SECTION_VON_MISES, field::LOWER_SECTION_VON_MISES];
const MAX_SHEAR: [FieldSpec; 2] = [field::UPPER_SECTION_MAX_SHEAR, field::LOWER_SECTION_MAX_SHEAR];

/// Depth of the section over the larger semi-axis, unless the case says otherwise.
const DEPTH: f64 = 2.0;

const DEPTH_KEY: &str = "effects.subsurface_stress.depth";
const LAYERS: &str = "effects.subsurface_stress.layers";
const LATERAL: &str = "effects.subsurface_stress.y";

fn keys() -> Vec<KeySpec> {
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

/// What the description says of this effect.
#[must_use]
pub fn spec() -> EffectSpec {
    let fields = [&VON_MISES[0], &VON_MISES[1], &MAX_SHEAR[0], &MAX_SHEAR[1]];
    EffectSpec {
        name: NAME.to_owned(),
        law: "von Mises stress sqrt(3 J2) and largest shear stress (s1 - s3)/2 of the elastic \
              half-spaces in a vertical section"
            .to_owned(),
        source:
            "Johnson, Contact Mechanics (1985) par. 3.2, 3.6; Love, Phil. Trans. R. Soc. A 228 \
                 (1929)"
                .to_owned(),
        models: vec![HALF_SPACE.to_owned()],
        consumes: Vec::new(),
        provides: names(&fields),
        keys: keys(),
    }
}

/// The sections that a case asks for.
#[derive(Clone, Debug)]
pub(crate) struct Sections {
    contact: Structured,
    y: f64,
    depths: Vec<f64>,
    /// What the case calls the bodies.
    names: Bodies,
    /// Poisson's ratios of both bodies.
    poisson: [f64; 2],
    results: Option<[Fields; 2]>,
}

/// The stresses of one body, depth after depth [Pa].
#[derive(Clone, Debug, Default)]
struct Fields {
    von_mises: Vec<f64>,
    max_shear: Vec<f64>,
}

impl Sections {
    /// The sections of a configuration; `None` when the effect is off. The highest pressure without
    /// friction is at `peak_y` [m].
    ///
    /// # Errors
    /// The effect is on and a value is out of range.
    pub(crate) fn read(
        configuration: &Configuration,
        scene: &Scene,
        contact: Structured,
        [a, b]: [f64; 2],
        peak_y: f64,
    ) -> Result<Option<Self>, Refusal> {
        if !configuration.has_effect(NAME) {
            return Ok(None);
        }
        let case = CheckedParams::new(&configuration.case, keys());
        let depth = case.maybe_number(DEPTH_KEY)?.unwrap_or(DEPTH * a.max(b));
        let layers = usize::try_from(case.integer(LAYERS)?).expect("the key's range is positive");
        let step = depth / layers as f64;
        Ok(Some(Self {
            contact,
            y: case.maybe_number(LATERAL)?.unwrap_or(peak_y),
            depths: (0..layers).map(|k| (k as f64 + 0.5) * step).collect(),
            names: scene.names.clone(),
            poisson: scene.materials().map(|material| material.poisson_ratio),
            results: None,
        }))
    }

    /// The grid of a body's section and the fields on it: the upper one lies above the contact, the
    /// lower one below.
    pub(crate) fn grid_of(&self, spec: &FieldSpec) -> Option<&'static str> {
        let body = (0..2).find(|body| [VON_MISES[*body], MAX_SHEAR[*body]].contains(spec))?;
        Some(GRIDS[body])
    }

    /// The grids of both bodies.
    pub(crate) fn grids(&self) -> [(&'static str, Structured); 2] {
        let step = 2.0 * self.depths[0];
        let grid = |up: f64| Structured {
            origin: [self.contact.x(0), self.y, up * self.depths[0]],
            step_i: self.contact.step_i,
            step_j: [0.0, 0.0, up * step],
            ni: self.contact.ni,
            nj: self.depths.len(),
        };
        [(GRIDS[0], grid(1.0)), (GRIDS[1], grid(-1.0))]
    }

    /// Computes the stresses under a pressure and the tractions on the upper body, x then y [Pa].
    pub(crate) fn compute(&mut self, pressure: &[f64], traction: &[f64]) {
        let turned: Vec<f64> = traction.iter().map(|value| -value).collect();
        let on = [traction, &turned];
        self.results = Some(std::array::from_fn(|body| {
            let load = SurfaceLoad::new(&self.contact, pressure, on[body]);
            let mut section = Section::new(&self.contact, self.poisson[body], self.y, &self.depths);
            let zeros = vec![0.0; section.points()];
            let mut fields = Fields { von_mises: zeros.clone(), max_shear: zeros };
            section.equivalents(&load, &mut fields.von_mises, &mut fields.max_shear);
            fields
        }));
    }

    /// Writes the fields that are asked for.
    pub(crate) fn write(&self, outputs: &mut dyn Outputs) {
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

    /// The section `stress` of `summary.json`: the largest values and where they are.
    pub(crate) fn summary(&self) -> Option<Value> {
        let results = self.results.as_ref()?;
        let largest = |values: &[f64]| {
            let (at, value) = values.iter().enumerate().max_by(|a, b| a.1.total_cmp(b.1))?;
            Some((*value, self.contact.x(at % self.contact.ni), self.depths[at / self.contact.ni]))
        };
        let body = |fields: &Fields| {
            let (von_mises, x, depth) = largest(&fields.von_mises)?;
            let (shear, shear_x, shear_depth) = largest(&fields.max_shear)?;
            Some(json!({
                "max_von_mises_pa": von_mises, "von_mises_x_m": x, "von_mises_depth_m": depth,
                "max_shear_pa": shear, "shear_x_m": shear_x, "shear_depth_m": shear_depth,
                "section_y_m": self.y,
            }))
        };
        let names = &self.names.0;
        let both = names
            .iter()
            .zip(results)
            .filter_map(|(name, fields)| Some((name.clone(), body(fields)?)));
        Some(Value::Object(both.collect()))
    }
}
