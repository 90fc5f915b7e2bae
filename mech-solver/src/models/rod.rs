//! Model `rod`: two rods end to end, in contact or apart.
//!
//! Each body is a rod along the normal of the contact, fixed at its far end; a body without a
//! length is rigid and fixed. At the initial temperatures their ends are a gap g₀ apart. Heat makes
//! a rod longer by αW, with W the integral of its temperature rise over the length, so that
//!
//! g = g₀ − Σ αW,  p = 0        if this g is positive,
//! g = 0,  p = (Σ αW − g₀)/Σ(L/E)   otherwise.
//!
//! The sides are free, motion is only along the rods, and inertia and friction are neglected.
//!
//! Source: J. R. Barber, J. Dundurs, M. Comninou, J. Appl. Mech. 47 (1980) 871-874.

use super::contact_model::{Contact, ContactModel};
use super::grids::{CONTACT_GRID, RIGID_GRID, is_rigid, laid_out};
use crate::case::keys::CheckedParams;
use crate::case::scene::read_material;
use crate::effects;
use crate::registry::entry::ModelEntry;
use crate::terms::surface::Surface;
use crate::terms::{Kind, Terms};
use proto::accuracy::Accuracy;
use proto::bodies::Bodies;
use proto::configuration::{Configuration, Layout, Refusal};
use proto::description::{KeySpec, ModelSpec, names};
use proto::field::{self, FieldSpec};
use proto::grid::Structured;
use proto::model::{Inputs, Setup, Step, StepError, StepReport};
use proto::readable::quantity;
use serde_json::{Value, json};

/// Registry entry of this model.
pub(super) const MODEL: ModelEntry =
    ModelEntry { name: "rod", spec, takes: &[Kind::Expansion, Kind::HeatShare], configure };

const LENGTH: &str = "length";
const AREA: &str = "mech.area";
const GAP: &str = "mech.gap";

fn keys() -> Vec<KeySpec> {
    let length = "length of the rod, fixed at its far end; absent: the body is rigid and fixed";
    vec![
        KeySpec::quantity(&format!("bodies.*.{LENGTH}"), "m", length).above(0.0),
        KeySpec::quantity(AREA, "m2", "cross-section of the rods").required().above(0.0),
        KeySpec::quantity(GAP, "m", "distance of the ends at the initial temperatures")
            .default_value(0.0)
            .at_least(0.0),
    ]
}

fn spec() -> ModelSpec {
    ModelSpec {
        name: MODEL.name.to_owned(),
        summary: "two rods end to end, in contact or apart, without friction".to_owned(),
        source: "Barber, Dundurs & Comninou, J. Appl. Mech. 47 (1980) 871-874".to_owned(),
        steady: true,
        transient: true,
        rewinds: true,
        varies_step: true,
        consumes: Vec::new(),
        provides: names(&[&field::PRESSURE, &field::GAP]),
        keys: keys(),
        accuracy: Accuracy::default(),
    }
}

/// Two rods.
#[derive(Clone, Debug, PartialEq)]
struct Rods {
    area: f64,
    /// Initial gap g₀ [m].
    gap: f64,
    /// Thermal expansion α of the upper and the lower body [1/K].
    expansion: [f64; 2],
    /// Flexibility Σ L/E [m/Pa].
    flexibility: f64,
}

impl Rods {
    fn read(configuration: &Configuration, expansion: Option<[f64; 2]>) -> Result<Self, Refusal> {
        let case = CheckedParams::new(&configuration.case, keys());
        let bodies = Bodies::read(&configuration.case)?;
        let mut flexibility = 0.0;
        for body in 0..2 {
            let material = read_material(&configuration.case, &bodies, body)?;
            let length = case.maybe_number(&bodies.key(body, LENGTH))?;
            flexibility += length.unwrap_or(0.0) / material.youngs_modulus;
        }
        if flexibility == 0.0 {
            let reason = "both bodies are rigid and fixed";
            let fix = "write the length of at least one rod";
            return Err(Refusal::new(&bodies.key(0, LENGTH), reason, fix));
        }
        let expansion = expansion.unwrap_or_default();
        Ok(Self { area: case.number(AREA)?, gap: case.number(GAP)?, expansion, flexibility })
    }

    /// Gap and pressure after the ends have approached by this length [m].
    fn pressed(&self, nearer: f64) -> Window {
        let gap = self.gap - nearer;
        match gap > 0.0 {
            true => Window { gap, pressure: 0.0 },
            false => Window { gap: 0.0, pressure: -gap / self.flexibility },
        }
    }
}

fn configure(configuration: &Configuration, terms: Terms) -> Result<Setup, Refusal> {
    let rods = Rods::read(configuration, terms.expansion)?;
    let side = rods.area.sqrt();
    let end = Structured::contact_plane(0.0, 0.0, side, side, 1, 1);
    let on = |spec: &FieldSpec| if is_rigid(spec) { RIGID_GRID } else { CONTACT_GRID };
    let grids = vec![(CONTACT_GRID, end), (RIGID_GRID, end)];
    let remark = if terms.expansion.is_none() {
        effects::without(Kind::Expansion) + "nothing moves"
    } else {
        format!("ends {} apart at the initial temperatures", quantity(rods.gap, "m", 5))
    };
    let layout = Layout { remarks: vec![remark], ..laid_out(configuration, on, grids) };
    Ok(Setup::new(layout, |_| Ok(Box::new(ContactModel::new(Ends { rods, terms })))))
}

/// Ends of two rods.
struct Ends {
    rods: Rods,
    terms: Terms,
}

/// Gap and pressure in a window.
struct Window {
    gap: f64,
    pressure: f64,
}

impl Contact for Ends {
    type Window = Window;

    fn solve(
        &mut self,
        _step: &Step,
        inputs: &dyn Inputs,
        _accepted: Option<&Window>,
        _spent: Option<Window>,
    ) -> Result<Window, StepError> {
        let mut nearer = 0.0;
        if self.terms.expansion.is_some() {
            let fields = [&field::UPPER_RISE_INTEGRAL, &field::LOWER_RISE_INTEGRAL];
            for (field, coefficient) in fields.into_iter().zip(self.rods.expansion) {
                nearer += coefficient * Surface::of(inputs, field)?.at(0.0, 0.0);
            }
        }
        Ok(self.rods.pressed(nearer))
    }

    fn first(&mut self) -> Option<Window> {
        Some(self.rods.pressed(0.0))
    }

    fn report(&self, _: &Window) -> StepReport {
        StepReport { substeps: 1, work: 1, ..StepReport::default() }
    }

    fn write(&self, window: &Window, spec: &FieldSpec, values: &mut [f64]) {
        values.fill(match *spec {
            field::GAP => window.gap,
            field::PRESSURE => window.pressure,
            _ => 0.0,
        });
    }

    fn summary(&self, Window { gap, pressure }: &Window) -> Value {
        json!({"contact": {
            "gap_m": gap,
            "max_pressure_pa": pressure,
            "normal_force_n": pressure * self.rods.area,
        }})
    }

    fn terms(&self) -> &Terms {
        &self.terms
    }

    fn terms_mut(&mut self) -> &mut Terms {
        &mut self.terms
    }
}
