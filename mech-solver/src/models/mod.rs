//! The models by name, cheapest first. A model is a module of this folder and one line in
//! [`MODELS`].

mod expected;
pub mod fastsim;
mod grids;
pub mod half_space;
pub mod hertz_carter;
mod power_balance;
mod precomputed;
mod row_by_row;
mod shortfall;
mod summary;
mod varying;

pub use grids::{CONTACT_GRID, RIGID_GRID};

use crate::terms::{Kind, Terms};
use proto::configuration::{Configuration, Refusal};
use proto::description::ModelSpec;
use proto::model::Setup;

/// One model of the crate.
pub struct ModelEntry {
    /// Name in the case file.
    pub name: &'static str,
    /// What the description says of it.
    pub spec: fn() -> ModelSpec,
    /// The kinds of terms that it takes.
    pub takes: &'static [Kind],
    /// Checks a configuration that names it, and whose effects and fields it provides, with the terms
    /// of the effects.
    pub(crate) configure: fn(&Configuration, Terms) -> Result<Box<dyn Setup>, Refusal>,
}

/// Every model of this crate, cheapest first.
pub const MODELS: &[ModelEntry] = &[hertz_carter::MODEL, fastsim::MODEL, half_space::MODEL];

/// The model with this name.
///
/// # Errors
/// Refuses a name that is not in [`MODELS`].
pub fn find(name: &str) -> Result<&'static ModelEntry, Refusal> {
    MODELS.iter().find(|model| model.name == name).ok_or_else(|| {
        let known: Vec<_> = MODELS.iter().map(|model| model.name).collect();
        let reason = format!("there is no mechanical model `{name}`");
        Refusal::new("mech.model", reason, format!("choose one of {}", known.join(", ")))
    })
}
