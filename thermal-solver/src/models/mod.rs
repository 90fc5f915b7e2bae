//! The models, cheapest first: one file a model, one line in the list here.
//!
//! What models have in common, checking inputs, splitting heat, writing outputs, the summary and
//! the state, is in [`shell`]; a model answers for the physics only, through
//! [`shell::Conduction`].

pub mod columns;
pub mod ertz_knothe;
pub mod setup;
pub mod shell;
pub mod summary;

use crate::scene::Material;
use proto::accuracy::Simplification;
use proto::configuration::{Configuration, Refusal};
use proto::description::{ModelSpec, names};
use proto::field;
use proto::model::Setup;

/// A model of the list.
#[derive(Clone, Copy, Debug)]
pub struct Entry {
    /// Name in the case file.
    pub name: &'static str,
    /// Its description.
    pub spec: fn() -> ModelSpec,
    /// Prepares it for a configuration.
    pub configure: fn(&Configuration) -> Result<Box<dyn Setup>, Refusal>,
}

/// All models, cheapest first.
pub const REGISTRY: &[Entry] = &[
    Entry {
        name: ertz_knothe::NAME,
        spec: ertz_knothe::spec,
        configure: setup::configure::<ertz_knothe::ErtzKnothe>,
    },
    Entry {
        name: columns::NAME,
        spec: columns::spec,
        configure: setup::configure::<columns::Columns>,
    },
];

/// Prepares the model that a configuration names.
pub fn configure(configuration: &Configuration) -> Result<Box<dyn Setup>, Refusal> {
    match REGISTRY.iter().find(|model| model.name == configuration.model) {
        Some(model) => (model.configure)(configuration),
        None => {
            let known: Vec<&str> = REGISTRY.iter().map(|model| model.name).collect();
            Err(Refusal::new(
                "thermal.model",
                format!("`{}` is not a model of this participant", configuration.model),
                format!("write one of: {}", known.join(", ")),
            ))
        }
    }
}

/// What every model leaves out that conducts heat normal to the surface only. The rise behind a
/// uniform band is √(2πx)·(1 + 1/(8x)) − 1 with x = 2Pe against √(2πx) in one dimension (Jaeger's
/// integral of e^x K₀(x)), so 0.28/√Pe at a sharp edge; where the flux is smooth the heat from ahead
/// and behind nearly cancels, and some 1/Pe is left.
fn along_the_surface() -> Simplification {
    let source = "Jaeger, Proc. R. Soc. NSW 76 (1942) 203-224, at Pe = 10 000";
    Simplification::always("no conduction along the surface", AT_HIGH_SPEED, source)
}

/// The error of it at the speeds of railways \[-\].
const AT_HIGH_SPEED: f64 = 2e-4;

/// What more it costs in a slow case: 1/Pe in all, with half the length of the grid for a.
fn along_the_surface_at(frame: &setup::Frame) -> Option<Simplification> {
    let half = 0.5 * frame.grid.dx() * frame.grid.ni as f64;
    let inverse = |body: &Material| 2.0 * body.diffusivity() / (half * frame.scene.speed);
    let inverse = frame.scene.materials.iter().map(inverse).fold(0.0, f64::max);
    let more = inverse - AT_HIGH_SPEED;
    (more > 0.0).then(|| {
        let what = format!("no conduction along the surface, at Pe = {:.3}", 1.0 / inverse);
        Simplification::always(&what, more, "Jaeger, Proc. R. Soc. NSW 76 (1942) 203-224: 1/Pe")
    })
}

/// The fields that every model consumes and provides, by name.
fn fields() -> (Vec<String>, Vec<String>) {
    let consumes = names(&[&field::FRICTION_POWER, &field::SURFACE_SPEED]);
    let provides = names(&[
        &field::RAIL_TEMPERATURE,
        &field::WHEEL_TEMPERATURE,
        &field::RAIL_SECTION_TEMPERATURE,
        &field::WHEEL_SECTION_TEMPERATURE,
    ]);
    (consumes, provides)
}
