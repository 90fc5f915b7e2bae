//! Model `conformal`: prismatic bodies that touch on a curved surface, in steady rolling.
//!
//! The cross-sections of both bodies are arcs, one inside the other: a flange root in a gauge
//! corner, a roller in its groove. The contact surface is curved, and a corner or a throat deforms
//! differently from a half-space ([`half_space::conformal`]). Every window is an independent steady
//! state.
//!
//! **Fields** are on the developed surface: x along the rolling direction, y the arc length s along
//! the surface. As in model `half-space`, slip and friction power refer to the path of a particle
//! from an element's centre to the next one's, and their grid is shifted upstream by half an
//! element.
//!
//! | module | contents |
//! |---|---|
//! | `case` | keys, values prescribed in a window, grid of the contact |
//! | `running` | solver of the windows |
//! | `window` | a window and its solution |
//! | `summary` | figures of a window |

mod case;
mod running;
mod summary;
mod window;

use super::contact_model::ContactModel;
use super::grids::fields_over;
use crate::case::scene::Scene;
use crate::models::expected::refinement;
use crate::registry::entry::ModelEntry;
use crate::terms::{Kind, Terms};
use case::{Case, Footprint};
use proto::accuracy::Accuracy;
use proto::configuration::{Configuration, Layout, Refusal};
use proto::description::{ModelSpec, names};
use proto::field;
use proto::model::Setup;
use running::Running;

pub(super) use summary::figures;

/// Solution time per element, measured [s].
const SECONDS: f64 = 2e-5;
/// Time to compute the influence coefficients, measured [s]: factor of the cube of the rows, and
/// constant part.
const BUILD: [f64; 2] = [1.5e-5, 0.5];
/// Working memory [byte]: per element and row, and per element.
const BYTES: [f64; 2] = [150.0, 1000.0];

/// Registry entry of this model.
pub(super) const MODEL: ModelEntry =
    ModelEntry { name: "conformal", spec, takes: &[Kind::Adhesion, Kind::HeatShare], configure };

fn spec() -> ModelSpec {
    ModelSpec {
        name: MODEL.name.to_owned(),
        summary:
            "bodies that touch on a curved surface, one arc inside the other: influence numbers of \
                  their shapes"
                .to_owned(),
        source: "Kalker, Three-Dimensional Elastic Bodies in Rolling Contact (1990) ch. 4; \
                 Vollebregt and Segal, Vehicle System Dynamics 52 (2014) suppl. 455"
            .to_owned(),
        steady: true,
        transient: true,
        rewinds: true,
        varies_step: true,
        consumes: Vec::new(),
        provides: names(&[&field::PRESSURE, &field::TRACTION, &field::SLIP_VELOCITY]),
        keys: case::keys(),
        accuracy: Accuracy { refinement: Some(refinement(1.5, 0.035)), ..Accuracy::default() },
    }
}

/// Semi-axes of an ellipse that fits the middle of a pressure, over those of the equivalent ellipse
/// between half-spaces. Pressures of conformal contacts are more pointed: 0.98 in a gauge corner of
/// 13 mm, the rest is margin.
const POINTED: f64 = 0.97;

/// Checks a configuration, and finds the extent of its contacts.
///
/// # Errors
/// A case that is incomplete or out of range; arcs that do not touch; a grid that is too large.
fn configure(configuration: &Configuration, terms: Terms) -> Result<Setup, Refusal> {
    let case = Case::read(configuration)?;
    let footprint = Footprint::of(configuration, &case)?;
    let mut layout = layout(configuration, &case, &footprint);
    // The contact has room within its grid. The slip zone of a contact that adheres is not known.
    if !terms.adhesion || Scene::read(&configuration.case)?.slides() {
        let name = field::FRICTION_POWER.name.to_owned();
        layout.extents.insert(name, footprint.semi_axes.map(|axis| POINTED * axis));
    }
    let configuration = configuration.clone();
    Ok(Setup::new(layout, move |_| {
        let running = Running::new(case, &footprint, terms, &configuration);
        Ok(Box::new(ContactModel::new(running)))
    }))
}

fn layout(configuration: &Configuration, case: &Case, footprint: &Footprint) -> Layout {
    let grid = footprint.grid;
    let upstream = case.difference.middle() * grid.dx();
    let (elements, rows) = (grid.points() as f64, grid.nj as f64);
    let [low, high] = footprint.directions(case).map(f64::to_degrees);
    let remark = format!(
        "{} x {} elements of {:.4} x {:.4} mm along x and over the surface, which turns from {low:.1}° to {high:.1}°",
        grid.ni,
        grid.nj,
        1e3 * grid.dx(),
        1e3 * grid.dy()
    );
    let [cubic, constant] = BUILD;
    let [pairs, each] = BYTES;
    Layout {
        solve_seconds: SECONDS * elements,
        build_seconds: cubic * rows.powi(3) + constant,
        memory_bytes: (elements * (pairs * rows + each)) as u64,
        remarks: vec![remark],
        ..fields_over(configuration, grid, upstream, &[])
    }
}
