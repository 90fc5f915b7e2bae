//! Model `hertz-carter`: Hertz's ellipse and Carter's strips, in closed form.
//!
//! Normal: [`crate::reference::hertz`], or the ellipse that the case gives under `[contact]`.
//! Tangential, longitudinal creepage or force only: with the effect `partial_slip` Carter's strips
//! ([`crate::reference::carter`]) with one of the creep laws `carter-radius` and `carter-pressure`;
//! without it the whole contact slides, with the traction f p_n and the same slip V s everywhere,
//! where s is the prescribed creepage or what the creep law gives at the prescribed force (that is
//! what Naeimi et al. and Ertz & Knothe compute with).
//!
//! Fields are element means, see `strips`. The model is quasi-static and has no memory: its answer
//! is the same in every window of a transient case. It is computed once, when the model is built; a
//! solve copies it to the outputs that are asked for.
//!
//! Deviations from the sources: the strips of an elliptic patch share one prefactor A and take ξ
//! from their own half length, so that the friction power is V s F in every strip.

mod contact;
mod fields;

use crate::effects::partial_slip;
use crate::keys::CheckedParams;
use crate::scene::{Drive, GivenPatch, Scene, given_patch_keys};
use contact::{Contact, CreepLaw};
use proto::configuration::{Configuration, FieldOnGrid, Layout, Refusal};
use proto::description::{KeySpec, ModelSpec, names};
use proto::field::{self, FieldSpec};
use proto::grid::{Grid, Structured};
use proto::model::{
    Inputs, Model, Outputs, Setup, StateBlob, StateError, Step, StepError, StepReport,
};

/// Name in the case file.
pub const NAME: &str = "hertz-carter";
/// Name of the grid that covers the contact.
pub const CONTACT_GRID: &str = "contact";
/// Name of the grid of quantities that belong to a whole body: one element as large as the
/// contact's grid.
pub const RIGID_GRID: &str = "rigid";

const CREEP_LAW: &str = "motion.creep_law";
/// More elements are refused: their fields would take gigabytes.
const MOST_ELEMENTS: f64 = 33_554_432.0;
/// Time to copy one value to an output, measured [s].
const SECONDS_PER_COPY: f64 = 2e-9;
/// Time to compute one value, measured [s].
const SECONDS_PER_VALUE: f64 = 7e-8;

/// What the description says of this model.
#[must_use]
pub fn spec() -> ModelSpec {
    let mut keys = given_patch_keys();
    keys.push(creep_law_key());
    ModelSpec {
        name: NAME.to_owned(),
        summary: "Hertz ellipse and Carter strips in closed form, longitudinal creepage only"
            .to_owned(),
        source:
            "Johnson, Contact Mechanics (1985) ch. 4; Carter, Proc. R. Soc. Lond. A 112 (1926) \
                 151-157; Naeimi et al., eqs. 18-19"
                .to_owned(),
        steady: true,
        transient: true,
        consumes: Vec::new(),
        provides: names(&[&field::PRESSURE, &field::TRACTION, &field::SLIP_VELOCITY]),
        keys,
    }
}

fn creep_law_key() -> KeySpec {
    KeySpec::choice(
        CREEP_LAW,
        &["carter-radius", "carter-pressure"],
        "prefactor of the creep: f a/R_wheel or 2 f p_0 E*",
    )
    .default_value("carter-pressure")
}

/// Checks a configuration whose effects and fields this model provides; cheap, allocates no field.
///
/// # Errors
/// Refuses a case that is incomplete or out of range, lateral creepage and spin, bodies whose
/// contact is no ellipse, a force beyond f N, and a grid that is too large.
pub(crate) fn configure(configuration: &Configuration) -> Result<Box<dyn Setup>, Refusal> {
    let scene = Scene::read(&configuration.case)?;
    let given = GivenPatch::read(&configuration.case)?;
    let case = CheckedParams::new(&configuration.case, vec![creep_law_key()]);
    let law = match case.text(CREEP_LAW)? {
        "carter-radius" => CreepLaw::Radius,
        _ => CreepLaw::Pressure,
    };
    let partial = configuration.has_effect(partial_slip::NAME);
    let contact = Contact::solve(&scene, given, law, partial)?;
    let grid = contact_grid(&contact, scene.resolution)?;
    let wanted = wanted_fields(configuration);
    let mut layout = layout(&wanted, grid);
    layout.remarks.extend(remarks(&scene, &contact, given, partial));
    Ok(Box::new(Prepared { contact, grid, wanted, layout }))
}

/// Rows and columns of elements Δx = Δy = a/resolution that cover the ellipse, odd in number.
fn contact_grid(contact: &Contact, resolution: usize) -> Result<Structured, Refusal> {
    let step = contact.semi_axis_a / resolution as f64;
    let half_rows = (contact.semi_axis_b / step - 0.5).ceil().max(0.0);
    let elements = (2.0 * resolution as f64 + 1.0) * (2.0 * half_rows + 1.0);
    if elements > MOST_ELEMENTS {
        return Err(Refusal::new(
            "mech.resolution",
            format!("{resolution} elements per semi-axis a make {elements:.3e} elements in all"),
            format!("lower it until there are no more than {MOST_ELEMENTS:.3e}"),
        ));
    }
    let (nx, ny) = (2 * resolution + 1, 2 * half_rows as usize + 1);
    let (x0, y0) = (-(resolution as f64) * step, -half_rows * step);
    Ok(Structured::contact_plane(x0, y0, step, step, nx, ny))
}

/// The fields that this run asks for, in the order of the table of fields.
fn wanted_fields(configuration: &Configuration) -> Vec<&'static FieldSpec> {
    let named = |name: &str| {
        configuration.outputs.iter().chain(&configuration.observed).any(|wanted| wanted == name)
    };
    field::TABLE.iter().filter(|spec| named(spec.name)).collect()
}

fn layout(wanted: &[&'static FieldSpec], grid: Structured) -> Layout {
    let mut grids = vec![Grid::structured(CONTACT_GRID, grid)];
    if wanted.contains(&&field::SURFACE_SPEED) {
        let (length, width) = (grid.dx() * grid.ni as f64, grid.dy() * grid.nj as f64);
        let whole = Structured::contact_plane(0.0, 0.0, length, width, 1, 1);
        grids.push(Grid::structured(RIGID_GRID, whole));
    }
    let values: usize = wanted.iter().map(|spec| fields::count(spec, &grid)).sum();
    Layout {
        grids,
        fields: wanted.iter().map(|spec| on_grid(spec)).collect(),
        solve_seconds: SECONDS_PER_COPY * values as f64,
        memory_bytes: (values * size_of::<f64>()) as u64,
        remarks: vec![format!(
            "the fields are computed once, in about {:.1e} s; a solve copies them",
            SECONDS_PER_VALUE * values as f64
        )],
    }
}

fn on_grid(spec: &FieldSpec) -> FieldOnGrid {
    let grid = if *spec == field::SURFACE_SPEED { RIGID_GRID } else { CONTACT_GRID };
    FieldOnGrid { field: spec.name.to_owned(), grid: grid.to_owned() }
}

fn remarks(
    scene: &Scene,
    contact: &Contact,
    given: Option<GivenPatch>,
    partial: bool,
) -> Vec<String> {
    let mut remarks = vec![contact.to_string()];
    let force = contact.normal_force;
    // Quantities are shown to about this accuracy; less is no difference to a reader.
    if given.is_some() && (force / scene.normal_force - 1.0).abs() > 1e-6 {
        remarks.push(format!(
            "the ellipse given under [contact] carries {force:.6e} N, which replaces the \
             {:.6e} N of load.normal_force",
            scene.normal_force
        ));
    }
    if !partial && !matches!(scene.drive, Drive::Creepage { .. }) {
        remarks.push(format!(
            "without effects.partial_slip the whole contact slides: the wheel carries {:.6e} N, \
             f N, and not the prescribed force, from which the creep law takes the creepage",
            contact.creep_force()
        ));
    }
    remarks
}

/// A checked case.
struct Prepared {
    contact: Contact,
    grid: Structured,
    wanted: Vec<&'static FieldSpec>,
    layout: Layout,
}

impl Setup for Prepared {
    fn layout(&self) -> &Layout {
        &self.layout
    }

    fn build(self: Box<Self>) -> Result<Box<dyn Model>, Refusal> {
        let Self { contact, grid, wanted, .. } = *self;
        let fields = wanted.into_iter().map(|spec| (spec, fields::values(spec, &contact, grid)));
        let fields = fields.collect();
        Ok(Box::new(HertzCarter { contact, elements: grid.points(), fields }))
    }
}

/// The model that runs: the fields, computed once.
struct HertzCarter {
    contact: Contact,
    elements: usize,
    fields: Vec<(&'static FieldSpec, Vec<f64>)>,
}

impl HertzCarter {
    fn write(&self, outputs: &mut dyn Outputs) {
        for (spec, values) in &self.fields {
            if let Some(place) = outputs.get(spec) {
                place.copy_from_slice(values);
            }
        }
    }
}

impl Model for HertzCarter {
    fn solve(
        &mut self,
        _step: &Step,
        _inputs: &dyn Inputs,
        outputs: &mut dyn Outputs,
    ) -> Result<StepReport, StepError> {
        self.write(outputs);
        Ok(StepReport { substeps: 1, work: self.elements as u64, ..StepReport::default() })
    }

    fn first_outputs(&mut self, outputs: &mut dyn Outputs) {
        self.write(outputs);
    }

    fn accept(&mut self) {}

    fn observe(&mut self, outputs: &mut dyn Outputs) {
        self.write(outputs);
    }

    fn summary(&self) -> serde_json::Value {
        self.contact.summary()
    }

    fn save(&self, into: &mut StateBlob) {
        into.0.clear();
    }

    fn restore(&mut self, from: &StateBlob) -> Result<(), StateError> {
        match from.0.len() {
            0 => Ok(()),
            bytes => Err(StateError(format!("{NAME} has no state, but there are {bytes} bytes"))),
        }
    }
}
