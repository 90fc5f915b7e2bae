//! Model `wheel-on-track`: a wheel of a wheelset on a rail of a track, all patches at any angle.
//!
//! The profiles are positioned by the dimensions of track and wheelset and by the wheelset's
//! position; their points of contact follow from that ([`wheel_rail`]). Every patch is a half-space
//! contact in its own tangent plane, with the creepages that follow from the wheelset's motion. The
//! height of the wheelset or the vertical force is prescribed.
//!
//! **Fields** are on the developed rail surface: x along the track, and y the tape distance along
//! the rail's profile, measured from its origin and increasing to the left. Patches of all contact
//! angles therefore share one grid. As in model `half-space`, slip and friction power refer to the
//! path of a particle from an element's centre to the next one's, and their grid is shifted
//! upstream by half an element.
//!
//! **Stresses** inside the bodies are those of half-spaces under these fields. Below each patch, x
//! is along the track, y along the tape and z along the normal of the patch. Other patches act on
//! it as if they lay in the same plane.
//!
//! | module | contents |
//! |---|---|
//! | `shape` | surfaces of wheel and rail, read from profile files |
//! | `keys` | keys of track, wheelset and elements |
//! | `case` | a checked case, and the position of a window |
//! | `interface` | friction coefficients and roughness heights of the elements |
//! | `plane` | grid that holds the patches of all rows |
//! | `running` | solver of the windows |
//! | `summary`, `wheels` | figures of a window, and of each wheel |

mod case;
mod interface;
mod keys;
mod plane;
mod running;
mod shape;
mod summary;
mod wheels;

use super::contact_model::ContactModel;
use super::grids::fields_over;
use crate::registry::entry::ModelEntry;
use crate::terms::{Kind, Terms};
use case::Case;
use plane::Plane;
use proto::accuracy::Accuracy;
use proto::configuration::{Configuration, Layout, Refusal};
use proto::description::{ModelSpec, names};
use proto::field;
use proto::model::Setup;
use running::Running;
use wheel_rail::settings::PatchSurface;

pub(super) use summary::{diagrams, figures};

/// Solution time of a position per element of its patches, measured [s].
const SECONDS: f64 = 6e-6;
/// Time to compute influence coefficients on curved surfaces, per cube of the sum of the rows and
/// [`BESIDE`], measured [s].
const SECONDS_OF_NUMBERS: f64 = 6e-7;
/// Number of boundary elements beside the rows.
const BESIDE: f64 = 60.0;
/// Memory per element and row of a curved surface [byte].
const BYTES_OF_NUMBERS: f64 = 150.0;
/// Working memory per element of the patches [byte].
const BYTES: f64 = 4000.0;

/// Registry entry of this model.
pub(super) const MODEL: ModelEntry = ModelEntry {
    name: "wheel-on-track",
    spec,
    takes: &[
        Kind::Gap,
        Kind::FrictionFactor,
        Kind::LocalSlip,
        Kind::RailPlace,
        Kind::TractionBound,
        Kind::Adhesion,
        Kind::Layer,
        Kind::HeatShare,
        Kind::Observation,
    ],
    configure,
};

fn spec() -> ModelSpec {
    ModelSpec {
        name: MODEL.name.to_owned(),
        summary:
            "a wheel of a wheelset on a rail of a track: measured profiles, all patches, any angle"
                .to_owned(),
        source: "Kalker, Three-Dimensional Elastic Bodies in Rolling Contact (1990) ch. 4; \
                 Vollebregt, User guide for CONTACT (2022) ch. 3-4; Piotrowski, Kik, Vehicle System Dynamics 46 \
                 (2008) 27-48; Sichani, Enblom, Berg, Vehicle System Dynamics 52 (2014) 1752-1764"
            .to_owned(),
        steady: true,
        transient: true,
        rewinds: true,
        varies_step: true,
        consumes: Vec::new(),
        provides: names(&[
            &field::PRESSURE,
            &field::TRACTION,
            &field::SLIP_VELOCITY,
            &field::CONTACT_FORCE,
        ]),
        keys: keys::keys(),
        accuracy: Accuracy { refinement: Some(keys::refinement()), ..Accuracy::default() },
    }
}

/// Checks a configuration, and solves it once to find the positions of its patches.
///
/// # Errors
/// A case that is incomplete or out of range; profiles that cannot be read or do not meet; bodies
/// of different materials.
fn configure(configuration: &Configuration, terms: Terms) -> Result<Setup, Refusal> {
    let mut case = Case::read(configuration, terms)?;
    let plane = Plane::of(configuration, &case)?;
    let place = plane.place();
    case.terms.observations.iter_mut().for_each(|term| term.place(&place));
    let layout = layout(configuration, &case, &plane);
    let configuration = configuration.clone();
    Ok(Setup::new(layout, move |_| {
        let running = Running::new(case, plane, &configuration)?;
        Ok(Box::new(ContactModel::new(running)))
    }))
}

fn layout(configuration: &Configuration, case: &Case, plane: &Plane) -> Layout {
    let grid = plane.grid();
    let upstream = case.settings.difference.middle() * grid.dx();
    let size = format!(
        "{} x {} elements of {:.4} x {:.4} mm over the rail's surface, along x and along the tape",
        grid.ni,
        grid.nj,
        1e3 * grid.dx(),
        1e3 * grid.dy()
    );
    let (mut seconds, mut bytes) = (SECONDS * plane.elements, BYTES * plane.elements);
    if case.settings.patch_surface == PatchSurface::Curved {
        let rows = grid.nj as f64;
        seconds += SECONDS_OF_NUMBERS * (rows + BESIDE).powi(3);
        bytes += BYTES_OF_NUMBERS * plane.elements * rows;
    }
    let hottest = plane.hottest_y();
    let peak = hottest.map(|y| (field::FRICTION_POWER.name.to_owned(), [0.0, y, 0.0]));
    Layout {
        peaks: peak.into_iter().collect(),
        solve_seconds: seconds,
        memory_bytes: bytes as u64,
        remarks: std::iter::once(size).chain(case.remarks.iter().cloned()).collect(),
        warnings: case.warnings.clone(),
        ..fields_over(configuration, grid, upstream, &case.terms.observations)
    }
}
