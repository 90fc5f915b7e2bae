//! The models by name, cheapest first. A model is a module of this folder and one line in
//! [`MODELS`].

pub mod fastsim;
pub mod half_space;
pub mod hertz_carter;
mod precomputed;

use crate::scene::RESOLUTION;
use proto::accuracy::Refinement;
use proto::configuration::{Configuration, Refusal};
use proto::description::ModelSpec;
use proto::model::{Setup, StateBlob, StateError};
use serde_json::Value;

/// Name of the grid that covers the contact.
pub const CONTACT_GRID: &str = "contact";
/// Name of the grid of quantities that belong to a whole body: one element as large as the
/// contact's grid.
pub const RIGID_GRID: &str = "rigid";

/// One model of the crate.
pub struct ModelEntry {
    /// What the description says of it.
    pub spec: fn() -> ModelSpec,
    /// Checks a configuration that names it, and whose effects and fields it provides.
    pub(crate) configure: fn(&Configuration) -> Result<Box<dyn Setup>, Refusal>,
}

/// Every model of this crate, cheapest first.
pub const MODELS: &[ModelEntry] = &[
    ModelEntry { spec: hertz_carter::spec, configure: hertz_carter::configure },
    ModelEntry { spec: fastsim::spec, configure: fastsim::configure },
    ModelEntry { spec: half_space::spec, configure: half_space::configure },
];

/// Largest imbalance of power that is accepted: above what the turns of pressure and tractions of
/// different bodies leave, 2e-7 in the worst of a thousand contacts.
pub(crate) const LARGEST_POWER_IMBALANCE: f64 = 1e-6;

/// |taken − given| over the magnitudes of all that is exchanged \[-\]; 0 where nothing is, or so little
/// that its products have no digits left.
pub(crate) fn power_imbalance(taken: f64, given: f64, exchanged: f64) -> f64 {
    const FAINT: f64 = f64::MIN_POSITIVE / f64::EPSILON;
    let off = (taken - given).abs();
    if off <= FAINT && exchanged <= FAINT { 0.0 } else { off / exchanged }
}

/// Where the expected errors of the models were measured.
const STUDY: &str = "`coordinator cost` of the cases wheel-rail and full-slip";

/// How the error of a model falls with the elements per semi-axis, from this error at five on.
fn refinement(order: f64, error: f64) -> Refinement {
    Refinement {
        key: RESOLUTION.to_owned(),
        levels: vec![5, 10, 20, 40, 80, 160, 320],
        order,
        error,
        source: STUDY.to_owned(),
    }
}

/// The model with this name.
///
/// # Errors
/// Refuses a name that is not in [`MODELS`].
pub fn find(name: &str) -> Result<&'static ModelEntry, Refusal> {
    MODELS.iter().find(|model| (model.spec)().name == name).ok_or_else(|| {
        let known: Vec<_> = MODELS.iter().map(|model| (model.spec)().name).collect();
        let reason = format!("there is no mechanical model `{name}`");
        Refusal::new("mech.model", reason, format!("choose one of {}", known.join(", ")))
    })
}

/// Restores a model that has no state.
fn restore_nothing(name: &str, from: &StateBlob) -> Result<(), StateError> {
    match from.0.len() {
        0 => Ok(()),
        bytes => Err(StateError(format!("{name} has no state, but there are {bytes} bytes"))),
    }
}

/// Adds the keys of one object to another.
fn extend(section: &mut Value, more: Value) {
    if let (Value::Object(section), Value::Object(more)) = (section, more) {
        section.extend(more);
    }
}
