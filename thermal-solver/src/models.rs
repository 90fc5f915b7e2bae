//! The models of heat conduction, one file each. Each has an entry in the registry list and its
//! name in [`names`].
//!
//! Shared parts are separate modules: [`setup`] checks a configuration and lays out the grids,
//! [`inputs`] checks the inputs and splits the heat, [`summary`] fills the summary. A model whose
//! surface temperatures are on the grid of the heat flux implements only the physics, through
//! [`conduction::Conduction`]; [`conduction_model`] does the rest. Any other model implements
//! [`proto::model::Model`] with these helpers.

pub mod columns;
pub mod conduction;
pub mod conduction_model;
mod constriction;
mod elements;
pub mod ends;
pub mod ertz_knothe;
pub mod fe;
pub mod fields;
pub mod frame;
mod inputs;
mod interface;
pub mod moving_source;
pub mod names;
mod normal_only;
pub mod periodic;
mod previous_passages;
pub mod rod;
pub mod setup;
mod summary;
mod transforming;
mod white_layer;

use crate::capability::Capability;
use proto::configuration::{Configuration, Refusal};
use proto::description::ModelSpec;
use proto::model::Setup;

/// Entry of the registry list.
#[derive(Clone, Copy, Debug)]
pub struct Entry {
    /// Name of the model in the case file.
    pub name: &'static str,
    /// Returns the description of the model.
    pub spec: fn() -> ModelSpec,
    /// Optional capabilities of the model.
    pub capabilities: &'static [Capability],
    /// Checks a configuration and prepares the model for it.
    pub configure: fn(&Configuration) -> Result<Setup, Refusal>,
}

/// All models: those of a single contact, cheapest first, then those of periodic or finite bodies.
pub const REGISTRY: &[Entry] = &[
    Entry {
        name: names::ERTZ_KNOTHE,
        spec: ertz_knothe::spec,
        capabilities: ertz_knothe::CAPABILITIES,
        configure: setup::configure::<ertz_knothe::ErtzKnothe>,
    },
    Entry {
        name: names::COLUMNS,
        spec: columns::spec,
        capabilities: columns::CAPABILITIES,
        configure: setup::configure::<columns::Columns>,
    },
    Entry {
        name: names::MOVING_SOURCE,
        spec: moving_source::spec,
        capabilities: moving_source::CAPABILITIES,
        configure: setup::configure::<moving_source::MovingSource>,
    },
    Entry {
        name: names::FE,
        spec: fe::spec,
        capabilities: fe::CAPABILITIES,
        configure: setup::configure::<fe::FiniteElements>,
    },
    Entry {
        name: names::PERIODIC,
        spec: periodic::spec,
        capabilities: periodic::CAPABILITIES,
        configure: setup::configure::<periodic::Periodic>,
    },
    Entry {
        name: names::ROD,
        spec: rod::spec,
        capabilities: rod::CAPABILITIES,
        configure: setup::configure::<rod::Rods>,
    },
];

/// Returns the model with this name.
///
/// # Errors
/// An unknown name.
pub(crate) fn find(name: &str) -> Result<&'static Entry, Refusal> {
    REGISTRY.iter().find(|model| model.name == name).ok_or_else(|| {
        let known: Vec<&str> = REGISTRY.iter().map(|model| model.name).collect();
        Refusal::new(
            "thermal.model",
            format!("`{name}` is not a model of this participant"),
            format!("write one of: {}", known.join(", ")),
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_list_has_every_name() {
        let listed: Vec<&str> = REGISTRY.iter().map(|model| model.name).collect();
        assert_eq!(listed, names::ALL);
    }
}
