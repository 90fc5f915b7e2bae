//! Model `periodic`: elastic half-spaces in sliding contact, periodic along x and y.
//!
//! The bodies are nominally flat and touch on a periodic cell L_x × L_y: rough or wavy surfaces,
//! and pads and blocks that are large compared with their roughness. The normal contact is solved
//! by [`half_space::normal`] with the exact flexibility of every wave of the grid, 2c/k, with c the
//! normal compliance of the pair and k the wave number. The undeformed distance is the sum of the
//! heights of all effects. The load is the load per cell. The traction is f p against the rigid
//! slip, and the slip is the rigid slip. With one row of elements nothing depends on y: plane
//! strain.
//!
//! Steady, or transient without history: every instant is solved from the same initial pressure, so
//! that it depends on the inputs only.
//!
//! Source: Westergaard, J. Appl. Mech. 6 (1939) A49-A53; Johnson, Contact Mechanics (1985), ch. 13;
//! Stanley and Kato, J. Tribol. 119 (1997) 481-485, for waves on a grid. Neglected: the influence
//! of tractions on the pressure of bodies of different elastic constants, a phase of the order of f
//! (1 − 2ν)/(2 − 2ν).

mod case;
mod cell;
mod contact;

use super::contact_model::ContactModel;
use super::grids::{CONTACT_GRID, RIGID_GRID, laid_out, whole};
use crate::case::scene::contact_keys;
use crate::registry::entry::ModelEntry;
use crate::terms::{Kind, Terms};
use case::Case;
use contact::Sliding;
use proto::accuracy::Accuracy;
use proto::configuration::{Configuration, Layout, Refusal};
use proto::description::{ModelSpec, names};
use proto::field::{self, FieldSpec};
use proto::model::Setup;
use proto::readable::quantity;

/// Solution time per element, for rough surfaces in full contact [s].
const SECONDS: f64 = 1e-6;
/// Working memory per element [byte].
const BYTES: f64 = 250.0;

/// Registry entry of this model.
pub(super) const MODEL: ModelEntry = ModelEntry {
    name: "periodic",
    spec,
    takes: &[
        Kind::Gap,
        Kind::FrictionFactor,
        Kind::TractionBound,
        Kind::PressureBound,
        Kind::Expansion,
        Kind::HeatShare,
    ],
    configure,
};

fn spec() -> ModelSpec {
    ModelSpec {
        name: MODEL.name.to_owned(),
        summary: "elastic half-spaces whose contact repeats along x and y, in full sliding"
            .to_owned(),
        source: "Johnson, Contact Mechanics (1985) ch. 13; Stanley & Kato, J. Tribol. 119 (1997)"
            .to_owned(),
        steady: true,
        transient: true,
        rewinds: true,
        varies_step: true,
        consumes: Vec::new(),
        provides: names(&[&field::PRESSURE, &field::TRACTION, &field::SLIP_VELOCITY]),
        keys: [contact_keys(), cell::keys()].concat(),
        accuracy: Accuracy { refinement: Some(cell::refinement()), ..Accuracy::default() },
    }
}

/// Checks a configuration without allocating any lasting field.
///
/// # Errors
/// A case that is incomplete or out of range; bodies with radii; an approach; a force or spin;
/// heights that are not periodic.
fn configure(configuration: &Configuration, terms: Terms) -> Result<Setup, Refusal> {
    let case = Case::read(configuration, terms)?;
    let layout = layout(configuration, &case);
    Ok(Setup::new(layout, |_| Ok(Box::new(ContactModel::new(Sliding::new(case))))))
}

fn layout(configuration: &Configuration, case: &Case) -> Layout {
    let grid = case.grid;
    let on = |spec: &FieldSpec| match *spec {
        field::SURFACE_SPEED => RIGID_GRID,
        _ => CONTACT_GRID,
    };
    let [length, width] = case.cell();
    let grids = vec![(CONTACT_GRID, grid), (RIGID_GRID, whole(&grid))];
    Layout {
        solve_seconds: SECONDS * grid.points() as f64,
        memory_bytes: (BYTES * grid.points() as f64) as u64,
        remarks: vec![format!(
            "a periodic cell of {:.4} x {:.4} mm, {} x {} elements, under a mean pressure of {}",
            1e3 * length,
            1e3 * width,
            grid.ni,
            grid.nj,
            quantity(case.mean_pressure(), "Pa", 5)
        )],
        ..laid_out(configuration, on, grids)
    }
}
