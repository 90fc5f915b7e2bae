//! The models by name, cheapest first. A model is a module of this folder and one line in
//! [`MODELS`], its name in [`names`].

mod expected;
pub mod fastsim;
mod grids;
pub mod half_space;
pub mod hertz_carter;
pub mod names;
mod power_balance;
mod precomputed;
mod row_by_row;
mod summary;
mod varying;

pub use grids::{CONTACT_GRID, RIGID_GRID};

use proto::configuration::{Configuration, Refusal};
use proto::description::ModelSpec;
use proto::model::Setup;

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
