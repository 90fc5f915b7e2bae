//! Registry of the models by name: first models of round bodies, cheapest first, then models of
//! periodic or finite bodies. A model is a module of this folder and one line in [`MODELS`].

mod conformal;
mod contact_model;

mod expected;
pub mod explicit_fe;
pub mod fastsim;
mod grids;
pub mod half_space;
pub mod hertz_carter;
mod periodic;
mod power_balance;
mod precomputed;
mod rod;

mod creepage_search;
mod shortfall;
mod springs;
mod summary;
pub(crate) mod varying;
mod wheel_on_track;

pub use grids::{CONTACT_GRID, RIGID_GRID};

use crate::case::scene::Scene;
use crate::figures::indicators;
use crate::registry::entry::ModelEntry;
use proto::advice::Known;
use proto::configuration::Refusal;
use proto::diagram::Diagram;
use proto::figure::FigureSpec;
use proto::params::Params;

/// All models of this crate: first those of round bodies, cheapest first, then the others.
pub const MODELS: &[ModelEntry] = &[
    hertz_carter::MODEL,
    fastsim::MODEL,
    half_space::MODEL,
    conformal::MODEL,
    wheel_on_track::MODEL,
    explicit_fe::MODEL,
    periodic::MODEL,
    rod::MODEL,
];

/// Figures that are specific to a model.
pub(crate) fn own_figures() -> Vec<FigureSpec> {
    [wheel_on_track::figures(), conformal::figures()].concat()
}

/// Diagrams of the models and of the common figures.
pub(crate) fn diagrams() -> Vec<Diagram> {
    let common = vec![indicators::creep_curve(), indicators::shakedown_diagram()];
    [wheel_on_track::diagrams(), common].concat()
}

/// Figures of the contact, by their keys in the summary, estimated with the cheapest model that
/// supports all creepages, with tractions of at most `largest` [Pa]; `None` if that model has no
/// solution.
pub(crate) fn estimated_contact(
    scene: &Scene,
    case: &Params,
    sticks: bool,
    largest: Option<f64>,
) -> Option<Known> {
    fastsim::estimate(scene, case, sticks, largest)
}

/// Returns the model with this name.
///
/// # Errors
/// A name that is not in [`MODELS`].
pub fn find(name: &str) -> Result<&'static ModelEntry, Refusal> {
    MODELS.iter().find(|model| model.name == name).ok_or_else(|| {
        let known: Vec<_> = MODELS.iter().map(|model| model.name).collect();
        let reason = format!("there is no mechanical model `{name}`");
        Refusal::new("mech.model", reason, format!("choose one of {}", known.join(", ")))
    })
}
