//! Options of a case, and the problem of a scene.

use super::contact::Problem;
use crate::case::ellipse::Ellipse;
use crate::case::keys::CheckedParams;
use crate::case::resolution;
use crate::case::scene::{GivenPatch, Scene};
use crate::models::springs;
use crate::terms::Terms;
use elastic::fastsim::bound::Bound;
use elastic::fastsim::flexibility::{Flexibilities, Kind};
use elastic::fastsim::integration::Lattice;
use elastic::fastsim::reduction::Reduction;
use elastic::kalker::{self, CreepCoefficients};
use proto::configuration::Refusal;
use proto::description::KeySpec;
use proto::grid::Structured;
use proto::params::Params;
use std::f64::consts::PI;

const TRACTION_BOUND: &str = "mech.traction_bound";
const STICK_ZONE: &str = "mech.stick_zone";
/// Minimum number of strips; the force of a contact that sticks is then accurate to 1e-4.
const FEWEST_STRIPS: usize = 16;
/// Default number of elements per semi-axis.
pub(super) const RESOLUTION: usize = 40;

/// Keys that are specific to this model.
pub(super) fn own_keys() -> Vec<KeySpec> {
    let mut keys = vec![
        springs::flexibility_key(),
        KeySpec::choice(
            TRACTION_BOUND,
            &["parabolic", "elliptic"],
            "traction bound: a parabola with the same integral, or the friction coefficient times Hertz's pressure",
        )
        .default_value("parabolic"),
        KeySpec::choice(
            STICK_ZONE,
            &["springs", "strips"],
            "traction where surfaces stick: from the springs (FASTSIM), or from Kalker's strip theory under the elliptic \
             bound (FASTRIP)",
        )
        .default_value("springs"),
    ];
    keys.extend(springs::reduction_keys());
    keys
}

/// Options of a case in addition to its scene.
#[derive(Clone, Copy, Debug)]
pub(super) struct Options {
    /// Ellipse given by the case.
    pub(super) given: Option<GivenPatch>,
    pub(super) kind: Kind,
    pub(super) bound: Bound,
    /// True if strip theory gives the traction in the stick zone.
    pub(super) strip_theory: bool,
    pub(super) reduction: Reduction,
    /// Elements per semi-axis.
    pub(super) resolution: usize,
    /// True if surfaces may stick.
    pub(super) partial: bool,
}

impl Options {
    /// Reads the options.
    ///
    /// # Errors
    /// A value that is out of range; two options that exclude each other.
    pub(super) fn read(
        case: &Params,
        given: Option<GivenPatch>,
        partial: bool,
    ) -> Result<Self, Refusal> {
        let own = CheckedParams::new(case, own_keys());
        let kind = springs::flexibility(&own)?;
        let bound = match own.text(TRACTION_BOUND)? {
            "elliptic" => Bound::Elliptic,
            _ => Bound::Parabolic,
        };
        let strip_theory = own.text(STICK_ZONE)? == "strips";
        if strip_theory && bound != Bound::Elliptic {
            let reason = "is `strips`, whose tractions are those under Hertz's pressure";
            let fix = format!("write {TRACTION_BOUND} = \"elliptic\", or \"springs\" here");
            return Err(Refusal::new(STICK_ZONE, reason, fix));
        }
        let reduction = springs::reduction(&own)?;
        let resolution = resolution::read(case, RESOLUTION)?;
        Ok(Self { given, kind, bound, strip_theory, reduction, resolution, partial })
    }
}

/// Returns the problem of a scene, with fields on this grid.
///
/// # Errors
/// A scene without an elliptic contact or without rolling; bodies outside Kalker's table; a force
/// beyond friction.
pub(super) fn problem(
    scene: &Scene,
    asked: &Options,
    grid: &Structured,
) -> Result<(Problem, CreepCoefficients), Refusal> {
    let Options { given, kind, bound, strip_theory, reduction, resolution, partial } = *asked;
    let ellipse = Ellipse::solve(scene, given)?;
    Ellipse::refuse_rest(scene)?;
    let coefficients = coefficients(scene, &ellipse)?;
    let axes = [ellipse.semi_axis_a, ellipse.semi_axis_b];
    let problem = Problem {
        ellipse,
        prescribed: ellipse.prescribed(scene)?,
        flexibilities: Flexibilities::new(&coefficients, axes, scene.combined_shear_modulus()),
        kind,
        reduction,
        strip_theory: strip_theory.then(|| scene.combined_poisson_ratio()),
        lattice: lattice(&ellipse, grid, resolution, bound),
        friction_coefficient: scene.friction_coefficient,
        speeds: scene.speeds,
        partial,
    };
    Ok((problem, coefficients))
}

fn coefficients(scene: &Scene, ellipse: &Ellipse) -> Result<CreepCoefficients, Refusal> {
    for (name, body) in scene.names.0.iter().zip(scene.materials()) {
        if body.poisson_ratio < 0.0 {
            let reason = format!(
                "has a Poisson's ratio of {}, and Kalker's table begins at 0",
                body.poisson_ratio
            );
            let key = format!("bodies.{name}.material");
            return Err(Refusal::new(&key, reason, "name a material whose ratio is 0 or more"));
        }
    }
    let aspect = ellipse.semi_axis_a / ellipse.semi_axis_b;
    Ok(kalker::creep_coefficients(aspect, scene.combined_poisson_ratio()))
}

/// Lattice with cells as long as an element on the longest strip, and strips at most half as wide
/// as an element.
fn lattice(ellipse: &Ellipse, grid: &Structured, resolution: usize, bound: Bound) -> Lattice {
    let half = (PI * ellipse.semi_axis_b / grid.dy()).ceil() as usize;
    Lattice {
        semi_axis_a: ellipse.semi_axis_a,
        semi_axis_b: ellipse.semi_axis_b,
        strips: (2 * half).max(FEWEST_STRIPS),
        cells: 2 * resolution,
        bound,
    }
}

/// Number of cells of the lattice.
pub(super) fn cells(problem: &Problem) -> usize {
    problem.lattice.strips * problem.lattice.cells
}

/// Data shared by all rows of a history.
pub(super) struct Case {
    pub(super) asked: Options,
    pub(super) terms: Terms,
    pub(super) grid: Structured,
}
