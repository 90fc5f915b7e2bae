//! Model `half-space`: exact contact of elastic half-spaces by boundary elements.
//!
//! Normal problem on the gap of the undeformed bodies ([`crate::half_space::normal`]), or the
//! elliptic pressure that the case gives under `[contact]`; then the tangential problem of steady
//! rolling ([`crate::half_space::levels`]) with longitudinal, lateral and spin creepage, or with a
//! longitudinal force. Without the effect `partial_slip` the whole contact slides: traction f p_n
//! against the rigid slip, which is all the slip there is.
//!
//! Pressure and traction are constant in an element and belong to the grid `contact`. Slip and
//! friction power belong to the step of a particle from an element's centre to the next one's:
//! their grid, `passage`, is shifted upstream by half an element. That the power of a step takes the
//! mean traction of both ends makes its sum the power of the forces over the creepages, exactly and
//! at every resolution ([`crate::half_space::steady_rolling`]).
//!
//! The model is quasi-static and has no memory: it is solved in the first window and keeps its
//! answer.

mod answer;

use crate::effects::{friction_heat, partial_slip, third_body_layer};
use crate::ellipse::{self, Ellipse};
use crate::half_space::influence::Elasticity;
use crate::half_space::levels::{Levels, Prescribed};
use crate::half_space::normal_contact::NormalContact;
use crate::models::{CONTACT_GRID, RIGID_GRID};
use crate::reference::carter;
use crate::scene::{GivenPatch, Scene, given_patch_keys};
use answer::Answer;
use proto::configuration::{Configuration, FieldOnGrid, Layout, Refusal};
use proto::description::{ModelSpec, names};
use proto::field::{self, FieldSpec};
use proto::grid::{Grid, Structured};
use proto::model::{
    Inputs, Model, Outputs, Setup, StateBlob, StateError, Step, StepError, StepReport,
};

/// Name in the case file.
pub const NAME: &str = "half-space";
/// Grid of what happens from one element's centre to the next one's.
pub const PASSAGE_GRID: &str = "passage";

/// More elements are refused: operators and Krylov space would take tens of gigabytes.
const MOST_ELEMENTS: usize = 4_000_000;
/// Elements round the contact that stay free: the trailing edge's passages need one.
const MARGIN: usize = 1;
/// Time of a solve over the elements^1.15, measured [s].
const SECONDS: f64 = 8e-7;
/// Working memory for an element, measured [byte].
const BYTES: f64 = 700.0;

/// What the description says of this model.
#[must_use]
pub fn spec() -> ModelSpec {
    ModelSpec {
        name: NAME.to_owned(),
        summary: "elastic half-spaces by boundary elements: exact partial slip, all creepages"
            .to_owned(),
        source: "Kalker, Three-Dimensional Elastic Bodies in Rolling Contact (1990) ch. 4; \
                 Vollebregt, Wear 314 (2014)"
            .to_owned(),
        steady: true,
        transient: true,
        consumes: Vec::new(),
        provides: names(&[&field::PRESSURE, &field::TRACTION, &field::SLIP_VELOCITY]),
        keys: given_patch_keys(),
    }
}

/// Checks a configuration; cheap, allocates no field.
///
/// # Errors
/// A case that is incomplete or out of range, bodies without an elliptic contact as a scale, a
/// force beyond f N, a grid that is too large, dissimilar bodies.
pub(crate) fn configure(configuration: &Configuration) -> Result<Box<dyn Setup>, Refusal> {
    let scene = Scene::read(&configuration.case)?;
    let given = GivenPatch::read(&configuration.case)?;
    let ellipse = Ellipse::solve(&scene, given)?;
    let bodies = Elasticity::of_pair(&scene.wheel, &scene.rail);
    if bodies.is_coupled() {
        return Err(Refusal::new(
            "rail.material",
            "wheel and rail of different elastic constants couple normal and tangential contact, \
             which this version does not solve",
            "give both the same Young's modulus and Poisson's ratio, or use hertz-carter",
        ));
    }
    let partial = configuration.has_effect(partial_slip::NAME);
    let prescribed = prescribed(&scene, &ellipse, partial)?;
    let grid = with_margin(ellipse.grid(scene.resolution)?)?;
    let layer = third_body_layer::flexibility(configuration)?;
    let mut layout = layout(configuration, grid);
    layout.remarks.extend(ellipse.remark(&scene));
    Ok(Box::new(Prepared {
        scene,
        given_pressure: given.is_some(),
        ellipse,
        bodies,
        prescribed,
        partial,
        layer,
        grid,
        layout,
    }))
}

/// Creepages or force; without partial slip always creepages, for a prescribed force those of
/// Carter's law, as in `hertz-carter`.
fn prescribed(scene: &Scene, ellipse: &Ellipse, partial: bool) -> Result<Prescribed, Refusal> {
    let most = scene.friction_coefficient * ellipse.normal_force;
    let ratio = match ellipse.prescribed(scene)? {
        ellipse::Prescribed::Creepage { xi, eta, phi } => {
            return Ok(Prescribed::Creepage([xi, eta, phi]));
        }
        ellipse::Prescribed::ForceRatio(ratio) => ratio,
    };
    if partial && ratio.abs() < 1.0 {
        return Ok(Prescribed::Force(ratio * most));
    }
    if partial {
        return Err(Refusal::new(
            "motion",
            format!("a force of f N = {most:.6e} N leaves the creepage undetermined"),
            "write less, or prescribe motion.creepage",
        ));
    }
    let (f, p0) = (scene.friction_coefficient, ellipse.max_pressure);
    let prefactor = carter::prefactor_by_pressure(f, p0, scene.contact_compliance());
    let creep = carter::creep(prefactor, ratio.abs());
    Ok(Prescribed::Creepage([-ratio.signum() * creep, 0.0, 0.0]))
}

/// The grid of the ellipse with free elements all round.
fn with_margin(grid: Structured) -> Result<Structured, Refusal> {
    let (nx, ny) = (grid.ni + 2 * MARGIN, grid.nj + 2 * MARGIN);
    if nx * ny > MOST_ELEMENTS {
        return Err(Refusal::new(
            "mech.resolution",
            format!("makes {} elements in all", nx * ny),
            format!("lower it until there are no more than {MOST_ELEMENTS}"),
        ));
    }
    let (dx, dy) = (grid.dx(), grid.dy());
    let (x0, y0) = (grid.x(0) - MARGIN as f64 * dx, grid.y(0) - MARGIN as f64 * dy);
    Ok(Structured::contact_plane(x0, y0, dx, dy, nx, ny))
}

/// The contact grid shifted upstream by half an element.
fn passage_grid(grid: &Structured) -> Structured {
    let mut passage = *grid;
    passage.origin[0] += 0.5 * grid.dx();
    passage
}

fn layout(configuration: &Configuration, grid: Structured) -> Layout {
    let wanted = |spec: &FieldSpec| {
        let mut asked = configuration.outputs.iter().chain(&configuration.observed);
        asked.any(|name| name == spec.name)
    };
    let on = |spec: &FieldSpec| match *spec {
        field::SURFACE_SPEED => RIGID_GRID,
        field::SLIP_VELOCITY | field::FRICTION_POWER => PASSAGE_GRID,
        _ => CONTACT_GRID,
    };
    let fields: Vec<FieldOnGrid> = field::TABLE
        .iter()
        .filter(|spec| wanted(spec))
        .map(|spec| FieldOnGrid { field: spec.name.to_owned(), grid: on(spec).to_owned() })
        .collect();
    let (length, width) = (grid.dx() * grid.ni as f64, grid.dy() * grid.nj as f64);
    let whole = Structured::contact_plane(0.0, 0.0, length, width, 1, 1);
    let grids = [(CONTACT_GRID, grid), (PASSAGE_GRID, passage_grid(&grid)), (RIGID_GRID, whole)];
    let used = |name: &str| fields.iter().any(|on| on.grid == name);
    let elements = grid.points() as f64;
    Layout {
        grids: grids
            .into_iter()
            .filter(|(name, _)| used(name))
            .map(|(name, shape)| Grid::structured(name, shape))
            .collect(),
        fields,
        solve_seconds: SECONDS * elements.powf(1.15),
        memory_bytes: (BYTES * elements) as u64,
        remarks: vec![format!(
            "{} x {} elements of {:.4} mm; solved once, in the first window",
            grid.ni,
            grid.nj,
            1e3 * grid.dx()
        )],
    }
}

/// A checked case.
struct Prepared {
    scene: Scene,
    given_pressure: bool,
    ellipse: Ellipse,
    bodies: Elasticity,
    prescribed: Prescribed,
    partial: bool,
    layer: f64,
    grid: Structured,
    layout: Layout,
}

impl Setup for Prepared {
    fn layout(&self) -> &Layout {
        &self.layout
    }

    fn build(self: Box<Self>) -> Result<Box<dyn Model>, Refusal> {
        Ok(Box::new(HalfSpace { case: *self, answer: None }))
    }
}

/// The model that runs.
struct HalfSpace {
    case: Prepared,
    answer: Option<Answer>,
}

impl HalfSpace {
    fn compute(&self) -> Result<Answer, StepError> {
        let no_solution = |error: String| StepError::NoSolution(error);
        let case = &self.case;
        let normal = match case.given_pressure {
            true => NormalContact::elliptic(&case.grid, &case.ellipse),
            false => NormalContact::solve(
                &case.grid,
                &case.bodies,
                [case.scene.gap_coefficient_x(), case.scene.gap_coefficient_y()],
                case.ellipse.normal_force,
            )
            .map_err(|error| no_solution(error.to_string()))?,
        };
        if !case.partial {
            return Ok(Answer::sliding(case, normal));
        }
        let friction = case.scene.friction_coefficient;
        let bound: Vec<f64> = normal.pressure.iter().map(|p| friction * p).collect();
        let mut levels =
            Levels::new(&case.grid, &case.bodies, case.layer, case.ellipse.semi_axis_a);
        let solution = levels
            .solve(&bound, case.prescribed, case.linear_slope())
            .map_err(|error| no_solution(error.to_string()))?;
        Ok(Answer::rolling(case, normal, solution))
    }
}

impl Prepared {
    /// |dF/dξ| of the linear theory, roughly: G a b C_11 with C_11 = 4 [N].
    fn linear_slope(&self) -> f64 {
        4.0 * self.ellipse.semi_axis_a * self.ellipse.semi_axis_b / self.bodies.shear_compliance
    }
}

impl Model for HalfSpace {
    fn solve(
        &mut self,
        _step: &Step,
        _inputs: &dyn Inputs,
        outputs: &mut dyn Outputs,
    ) -> Result<StepReport, StepError> {
        let answer = match self.answer.take() {
            Some(answer) => answer,
            None => self.compute()?,
        };
        answer.write(outputs);
        let report = StepReport {
            substeps: 1,
            inner_iterations: answer.iterations,
            work: answer.work,
            ..StepReport::default()
        };
        self.answer = Some(answer);
        Ok(report)
    }

    fn first_outputs(&mut self, outputs: &mut dyn Outputs) {
        let speeds = friction_heat::surface_speeds(self.case.scene.rolling_speed, 0.0);
        for spec in field::TABLE {
            if let Some(place) = outputs.get(spec) {
                match *spec {
                    field::SURFACE_SPEED => place.copy_from_slice(&speeds),
                    _ => place.fill(0.0),
                }
            }
        }
    }

    fn accept(&mut self) {}

    fn observe(&mut self, outputs: &mut dyn Outputs) {
        if let Some(answer) = &self.answer {
            answer.write(outputs);
        }
    }

    fn summary(&self) -> serde_json::Value {
        self.answer.as_ref().map_or_else(|| serde_json::json!({}), Answer::summary)
    }

    fn save(&self, into: &mut StateBlob) {
        into.0.clear();
    }

    fn restore(&mut self, from: &StateBlob) -> Result<(), StateError> {
        match from.0.len() {
            0 => Ok(()),
            bytes => Err(StateError(format!("{NAME} has no state, but there are {bytes} bytes"))),
        }
    }
}
