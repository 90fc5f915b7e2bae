//! Normal and tangential contact of one instant.
//!
//! For bodies of the same elastic constants, the pressure is solved once, then the tractions.
//! Otherwise pressure and tractions are solved alternately until the pressure converges
//! ([`half_space::coupling`]).

use super::balance::{Hysteresis, PowerError, PressurePower};
use super::case::Case;
use super::drive::Driven;
use super::friction::{ContactBounds, FollowingFriction, FrictionConditions};
use crate::models::shortfall::Shortfall;
use half_space::aligned::{AlignedGrid, Chord};
use half_space::coupling::Coupling;
use half_space::difference::Stencil;
use half_space::extent::elliptic;
use half_space::friction::ElementFriction;
use half_space::grid_continuation::{
    Contact, Friction, History, Levels, Motion, Solution, TangentialError,
};
use half_space::influence::Influence;
use half_space::leading_edge::{AlignedPressure, align};
use half_space::normal::{NormalError, NormalSolver, Prescribed};
use half_space::slip_operator::Displacement;
use half_space::slip_velocity::{first_velocities, slip_velocities};
use half_space::slip_zone::SlippingRows;
use half_space::tangential::{self, Arguments, BoundLaw, Creepage, TangentialState};
use proto::model::{Inputs, StepError};
use proto::readable::{number, quantity};

/// Relative change of the pressure at convergence, far below the error of any grid.
const REST: f64 = 1e-6;
/// Relative accuracy of the tractions, below the discretisation error of any grid.
const TOLERANCE: f64 = 1e-4;
/// Relative accuracy of the tractions where friction follows the slip: its error is that of the
/// slip in an element, which may be a small part of the motion.
const FOLLOWING_TOLERANCE: f64 = 1e-7;
/// Relative accuracy of the tractions inside an outer iteration, well below its own tolerance.
const LOOP_TOLERANCE: f64 = 1e-10;
/// Share of f N assumed if the current friction does not allow the prescribed force: almost all
/// elements slip, but the creepage stays finite.
const ALMOST_ALL: f64 = 0.999;
/// Maximum number of alternations between normal and tangential contact.
const MOST_ALTERNATIONS: usize = 30;
/// Number of alternations after which only half of the pressure change is applied. Where tractions
/// are much larger than the pressure, an edge element may alternate between contact and no contact.
const WHOLE_ALTERNATIONS: usize = 10;

/// Reason why an instant has no solution.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub(super) enum ContactError {
    #[error(transparent)]
    Normal(#[from] NormalError),
    #[error(transparent)]
    Tangential(#[from] TangentialError),
    #[error(
        "normal and tangential contact did not converge in {MOST_ALTERNATIONS} alternations: the \
         pressure still changes by {change} of its maximum", change = number(*.change, 2))]
    Unsettled { change: f64 },
    #[error(transparent)]
    Power(#[from] PowerError),
    #[error("the bodies do not touch at an approach of {approach}", approach = quantity(*.approach, "m", 5))]
    Apart { approach: f64 },
}

/// Solvers of a contact, with the latest pressure.
#[derive(Debug)]
pub(super) struct ContactSolver {
    normal: Option<Normal>,
    levels: Option<Levels>,
    /// Bodies and motion of the levels.
    settings: Contact,
    /// Grid of the tractions, whose rows may begin at the leading edge.
    pub(super) rows: AlignedGrid,
    /// Pressure of the elements in displaced rows; empty on a regular grid.
    row_pressure: Vec<f64>,
    /// Edges of displaced rows; empty on a regular grid.
    chords: Vec<Option<Chord>>,
    coupling: Option<Coupling>,
    /// Displacements by which viscoelastic bodies dissipate, built when first needed.
    dissipating: Option<Dissipating>,
    /// Friction of every element.
    friction: ElementFriction,
    area: f64,
    /// Pressure and approach of the frictionless contact.
    frictionless: (Vec<f64>, Option<f64>),
    pub(super) pressure: Vec<f64>,
    /// Approach [m]; unknown for a given pressure.
    pub(super) approach: Option<f64>,
    /// Total number of iterations of the normal solver.
    pub(super) normal_iterations: usize,
    /// Slip s₀ without tractions.
    slip_history: [Vec<f64>; 2],
    bound: Vec<f64>,
    /// True if friction depends on inputs or on slip.
    heated: bool,
    /// Slip velocity of every element, used by friction that depends on local slip [m/s].
    velocity: Option<Vec<f64>>,
    /// Set if the last solve could not reach the prescribed force.
    pub(super) shortfall: Option<Shortfall>,
}

/// Tangential displacement by the tractions of viscoelastic bodies, and the coupling of different
/// bodies.
#[derive(Debug)]
struct Dissipating {
    tangential: Displacement,
    coupling: Option<Coupling>,
}

impl Dissipating {
    fn new(case: &Case) -> Self {
        let (grid, bodies) = (&case.footprint.grid, &case.bodies);
        let (counts, sides) = ([grid.ni, grid.nj], [grid.dx(), grid.dy()]);
        let coupling = || Coupling::with_memory(bodies, counts, sides, Stencil::DISPLACEMENT);
        Self {
            tangential: Displacement::with_memory(bodies, 0.0, counts, sides),
            coupling: bodies.are_coupled().then(coupling),
        }
    }
}

/// A normal contact problem.
#[derive(Debug)]
struct Normal {
    solver: NormalSolver,
    prescribed: Prescribed,
    undeformed: Vec<f64>,
    /// Undeformed distance including the normal displacement by tractions [m].
    distance: Vec<f64>,
}

impl ContactSolver {
    /// Builds the operators of a case and solves the frictionless normal contact.
    pub(super) fn new(case: &Case, motion: Motion) -> Result<Self, ContactError> {
        let grid = &case.footprint.grid;
        let sides = [grid.dx(), grid.dy()];
        let coupled = case.bodies.are_coupled();
        let normal = case.distance().map(|undeformed| {
            let mut solver = NormalSolver::of_bodies(grid.ni, grid.nj, sides, &case.bodies);
            solver.pressure_bound = case.terms.pressure_bound();
            let prescribed = super::geometry::prescribed(case.scene.load);
            Normal { solver, prescribed, distance: undeformed.clone(), undeformed }
        });
        let contact = Contact {
            bodies: case.bodies,
            layer: case.terms.layer(),
            yields: case.terms.yields,
            semi_axes: case.footprint.semi_axes,
            motion,
            difference: case.difference,
            tolerance: match case.terms.follow_inputs() {
                true => LOOP_TOLERANCE,
                false if case.terms.friction.follows_elements().is_some() => FOLLOWING_TOLERANCE,
                false => TOLERANCE,
            },
        };
        let zeros = vec![0.0; grid.points()];
        let mut solver = Self {
            normal,
            levels: None,
            settings: contact,
            rows: AlignedGrid::regular(*grid),
            row_pressure: Vec::new(),
            chords: Vec::new(),
            coupling: (case.terms.adhesion && coupled).then(|| {
                let stencil = motion.stencil(case.difference);
                if case.bodies.remember() {
                    return Coupling::with_memory(&case.bodies, [grid.ni, grid.nj], sides, stencil);
                }
                let influence = Influence::of_grid(grid, case.bodies.instantaneous);
                Coupling::new(&influence, grid.ni, grid.nj, stencil)
            }),
            dissipating: None,
            friction: ElementFriction::uniform(grid.points(), case.scene.friction_coefficient),
            frictionless: Default::default(),
            area: grid.element_area(),
            pressure: case.given_pressure(),
            approach: None,
            normal_iterations: 0,
            slip_history: [zeros.clone(), zeros.clone()],
            bound: zeros,
            heated: !case.terms.friction.is_constant(),
            velocity: None,
            shortfall: None,
        };
        solver.normal_step()?;
        solver.place_rows(case);
        solver.set_bound();
        solver.frictionless = (solver.pressure.clone(), solver.approach);
        Ok(solver)
    }

    /// Restores the frictionless pressure, so that a solve depends on its inputs only.
    pub(super) fn reset(&mut self) {
        self.pressure.clone_from(&self.frictionless.0);
        self.approach = self.frictionless.1;
        self.normal_iterations = 0;
        if let Some(normal) = &mut self.normal {
            normal.distance.clone_from(&normal.undeformed);
        }
        self.set_bound();
    }

    /// Applies load, shapes and friction of another row, and solves the frictionless normal
    /// contact. `displaced` is the displacement left by earlier loads. The solver starts from the
    /// latest pressure if `warm`.
    pub(super) fn follow(
        &mut self,
        case: &Case,
        warm: bool,
        displaced: Option<&[f64]>,
    ) -> Result<(), ContactError> {
        if let (Some(normal), Some(undeformed)) = (&mut self.normal, case.distance()) {
            normal.undeformed = undeformed;
            displaced.into_iter().for_each(|by| add(&mut normal.undeformed, by));
            normal.distance.clone_from(&normal.undeformed);
            normal.prescribed = super::geometry::prescribed(case.scene.load);
        }
        self.friction =
            ElementFriction::uniform(self.pressure.len(), case.scene.friction_coefficient);
        if !warm || self.normal.is_none() {
            self.pressure = case.given_pressure();
        }
        self.normal_iterations = 0;
        self.normal_step()?;
        self.place_rows(case);
        self.set_bound();
        self.frictionless = (self.pressure.clone(), self.approach);
        Ok(())
    }

    /// Places the rows under the latest pressure, and builds the operators of other rows.
    fn place_rows(&mut self, case: &Case) {
        let grid = case.footprint.grid;
        let found = (self.settings.motion != Motion::Shift && case.displaces_rows())
            .then(|| aligned(case, &self.pressure))
            .flatten();
        let regular = || AlignedPressure {
            rows: AlignedGrid::regular(grid),
            means: Vec::new(),
            chords: Vec::new(),
        };
        let AlignedPressure { rows, means, chords } = found.unwrap_or_else(regular);
        if case.terms.adhesion && (self.levels.is_none() || rows != self.rows) {
            self.levels = Some(Levels::of_rows(&rows, &self.settings));
        }
        (self.rows, self.row_pressure, self.chords) = (rows, means, chords);
    }

    /// Rows of the tractions, with a solution under the latest pressure.
    pub(super) fn slipping_rows<'a>(
        &'a self,
        state: &'a TangentialState,
        speed: f64,
    ) -> SlippingRows<'a> {
        SlippingRows {
            rows: &self.rows,
            chords: &self.chords,
            state,
            bound: &self.bound,
            elasticity: self.settings.bodies.instantaneous,
            speed,
        }
    }

    /// Pressure of the elements in the rows of the tractions [Pa].
    pub(super) fn row_pressure(&self) -> &[f64] {
        match self.rows.displacements() {
            Some(_) => &self.row_pressure,
            None => &self.pressure,
        }
    }

    /// Updates friction that depends on inputs or on the creepages.
    pub(super) fn set_friction(
        &mut self,
        case: &Case,
        inputs: &dyn Inputs,
        creepage: Creepage,
    ) -> Result<(), StepError> {
        if case.terms.friction.is_constant() {
            return Ok(());
        }
        let conditions = self.friction_conditions(case, inputs);
        self.friction = conditions.evaluate(creepage, self.velocity.as_deref())?;
        self.set_bound();
        Ok(())
    }

    /// Conditions of friction under the latest pressure.
    fn friction_conditions<'a>(
        &self,
        case: &'a Case,
        inputs: &'a dyn Inputs,
    ) -> FrictionConditions<'a> {
        let (rows, pressure) = (self.rows.clone(), self.row_pressure().to_vec());
        FrictionConditions { case, inputs, rows, pressure }
    }

    /// Solves for the tractions, starting from a nearby solution if one is given. `history` holds
    /// the slip and the plastic shift left by the previous instant. Friction that depends on a
    /// creepage of a prescribed force, or on the slip of every element, agrees with the solution.
    pub(super) fn solve(
        &mut self,
        case: &Case,
        inputs: &dyn Inputs,
        driven: &Driven,
        near: Option<Solution>,
        history: Option<History<'_>>,
    ) -> Result<Solution, StepError> {
        let arguments = Arguments {
            creepage: driven.has_force() && case.terms.friction.follows_slip(),
            slip: case.terms.friction.follows_elements().is_some(),
        };
        if arguments == Arguments::default() {
            let solved = self.solve_under(driven, None, near, history);
            return solved.map_err(|error| StepError::NoSolution(error.to_string()));
        }
        let duration = case.passage().duration;
        if let Some(start) = case.terms.friction.follows_elements() {
            let scale = (self.pressure.len(), duration, case.scene.speeds.rolling);
            let near = near.as_ref().map(|near| &near.state);
            self.velocity = Some(first_velocities(start, near, scale));
        }
        let before = near.as_ref().filter(|_| driven.has_force()).map(|near| near.state.creepage);
        self.set_friction(case, inputs, before.unwrap_or(driven.at(0.0).creepage))?;
        let follows = FollowingFriction { case, inputs, arguments };
        let solved = self.solve_under(driven, Some(&follows), near, history);
        let solution = solved.map_err(|error| match &error {
            ContactError::Tangential(TangentialError::NotConverged(found)) => {
                follows.refusal(found)
            }
            _ => StepError::NoSolution(error.to_string()),
        })?;
        if let Some(velocity) = &mut self.velocity {
            *velocity = slip_velocities(&solution.state, duration);
        }
        self.set_friction(case, inputs, solution.state.creepage)?;
        Ok(solution)
    }

    /// Traction bound f p of every element [Pa].
    pub(super) fn bound(&self) -> &[f64] {
        &self.bound
    }

    /// Normal force [N].
    fn normal_force(&self) -> f64 {
        self.pressure.iter().sum::<f64>() * self.area
    }

    fn set_bound(&mut self) {
        let bounds: Vec<f64> = self.friction.bounds(self.row_pressure()).collect();
        self.bound = bounds;
    }

    /// Solves the normal contact from the latest pressure. Returns the relative change of the
    /// pressure.
    fn normal_step(&mut self) -> Result<f64, ContactError> {
        let Some(normal) = &mut self.normal else { return Ok(0.0) };
        let before = self.pressure.clone();
        let Normal { solver, prescribed, distance, .. } = normal;
        let found = solver.solve(distance, *prescribed, &mut self.pressure)?;
        if found.touches_edge {
            let (nx, ny) = solver.shape();
            return Err(NormalError::Edge { nx, ny }.into());
        }
        if found.contact_elements == 0 {
            return Err(ContactError::Apart { approach: found.approach });
        }
        self.approach = Some(found.approach);
        self.normal_iterations += found.iterations;
        let largest = self.pressure.iter().copied().fold(0.0, f64::max);
        let change = self.pressure.iter().zip(&before).map(|(p, q)| (p - q).abs());
        Ok(change.fold(0.0, f64::max) / largest)
    }

    /// Solves for the tractions, with friction that follows the solution if given.
    fn solve_under(
        &mut self,
        driven: &Driven,
        follows: Option<&FollowingFriction<'_>>,
        near: Option<Solution>,
        history: Option<History<'_>>,
    ) -> Result<Solution, ContactError> {
        let prescribed = self.prescribed(driven);
        let law = follows.map(|follows| self.bound_law(follows));
        let law = law.as_ref().map(|law| law as &dyn BoundLaw);
        let levels = self.levels.as_mut().expect("partial slip has its operators");
        let friction = Friction { bound: &self.bound, law };
        let solved = near.is_none() && history.is_none();
        let mut solution = match (near, history) {
            (Some(near), _) => near,
            (None, Some(_)) => Solution::new(TangentialState::at_rest(&self.bound, [0.0; 3])),
            (None, None) => levels.solve(friction, &prescribed)?,
        };
        if self.coupling.is_none() {
            if !solved {
                let found = levels.improve(friction, &prescribed, history, &mut solution);
                match found {
                    // The initial guess was too far from the solution.
                    Err(TangentialError::NotConverged(_)) if history.is_none() => {
                        return Ok(levels.solve(friction, &prescribed)?);
                    }
                    found => found?,
                }
            }
            return Ok(solution);
        }
        let mut change = f64::INFINITY;
        for alternation in 0..MOST_ALTERNATIONS {
            self.rolling_step(driven, follows, history, &mut solution)?;
            if change <= REST {
                return Ok(solution);
            }
            let share = if alternation < WHOLE_ALTERNATIONS { 1.0 } else { 0.5 };
            change = self.yield_to(&solution.state, share)? / share;
        }
        Err(ContactError::Unsettled { change })
    }

    /// Law of the bounds under the latest pressure.
    fn bound_law<'a>(&self, follows: &FollowingFriction<'a>) -> ContactBounds<'a> {
        let conditions = self.friction_conditions(follows.case, follows.inputs);
        ContactBounds { conditions, arguments: follows.arguments }
    }

    /// Returns the prescribed motion at the latest pressure. Where friction depends on inputs or
    /// slip, a force beyond the friction limit is reduced to [`ALMOST_ALL`] of that limit.
    fn prescribed(&mut self, driven: &Driven) -> tangential::PrescribedMotion {
        let mut prescribed = driven.at(self.normal_force());
        let [x, y, _] = prescribed.force.map(Option::unwrap_or_default);
        let asked = x.hypot(y);
        let carried = ALMOST_ALL * self.bound.iter().sum::<f64>() * self.area;
        self.shortfall = (self.heated && asked > carried).then_some(Shortfall { asked, carried });
        if self.shortfall.is_some() {
            for force in prescribed.force[..2].iter_mut().flatten() {
                *force *= carried / asked;
            }
        }
        prescribed
    }

    /// Solves for the tractions under the latest pressure, including the slip caused by the
    /// pressure.
    fn rolling_step(
        &mut self,
        driven: &Driven,
        follows: Option<&FollowingFriction<'_>>,
        history: Option<History<'_>>,
        solution: &mut Solution,
    ) -> Result<(), ContactError> {
        self.set_bound();
        let prescribed = self.prescribed(driven);
        let law = follows.map(|follows| self.bound_law(follows));
        let law = law.as_ref().map(|law| law as &dyn BoundLaw);
        let [history_x, history_y] = &mut self.slip_history;
        if let Some(coupling) = &mut self.coupling {
            coupling.slip_by_pressure(&self.pressure, [history_x, history_y]);
        }
        if let Some(history) = history {
            for (sum, more) in self.slip_history.iter_mut().zip(history.slip) {
                sum.iter_mut().zip(more).for_each(|(sum, more)| *sum += more);
            }
        }
        let levels = self.levels.as_mut().expect("partial slip has its operators");
        let [history_x, history_y] = &self.slip_history;
        let history = History {
            slip: [history_x, history_y],
            plastic: history.and_then(|history| history.plastic),
        };
        let friction = Friction { bound: &self.bound, law };
        levels.improve(friction, &prescribed, Some(history), solution)?;
        Ok(())
    }

    /// Solves for the pressure after moving the distance by `share` towards the one under the
    /// current tractions. Returns the change of the pressure.
    fn yield_to(&mut self, state: &TangentialState, share: f64) -> Result<f64, ContactError> {
        let (Some(coupling), Some(normal)) = (&mut self.coupling, &mut self.normal) else {
            return Ok(0.0);
        };
        let [along_x, along_y] = &state.traction;
        let mut by_traction = vec![0.0; self.pressure.len()];
        coupling.distance_by_traction([along_x, along_y], &mut by_traction);
        let Normal { distance, undeformed, .. } = normal;
        for ((distance, undeformed), by) in distance.iter_mut().zip(undeformed).zip(&by_traction) {
            *distance = share * (*undeformed + by) + (1.0 - share) * *distance;
        }
        self.normal_step()
    }

    /// Power of the pressure on the normal displacement in steady rolling, for bodies of different
    /// elastic constants or viscoelastic bodies; `None` where the pressure does no work.
    pub(super) fn pressure_power(
        &mut self,
        case: &Case,
        traction: Option<[&[f64]; 2]>,
    ) -> Option<PressurePower> {
        let normal = self.normal.as_ref()?;
        let approach = self.approach?;
        let mut by_traction = vec![0.0; self.pressure.len()];
        match (&mut self.coupling, traction) {
            (Some(coupling), Some(traction)) => {
                coupling.distance_by_traction(traction, &mut by_traction);
            }
            _ if case.bodies.remember() => {}
            _ => return None,
        }
        let Normal { solver, undeformed, .. } = normal;
        let by_pressure = solver.displacement();
        let gap = |at: usize| undeformed[at] + by_traction[at] + by_pressure[at] - approach;
        let (grid, duration) = (&case.footprint.grid, case.passage().duration);
        let differences = case.difference.antisymmetric();
        Some(PressurePower::of(grid, duration, differences, &self.pressure, undeformed, gap))
    }

    /// Numerical dissipation of the difference along x under these tractions [W/m²].
    pub(super) fn numerical_dissipation(
        &mut self,
        case: &Case,
        state: &TangentialState,
    ) -> Option<Vec<f64>> {
        let [x, y] = &state.traction;
        self.levels.as_mut()?.dissipation([x, y], &self.pressure, case.scene.speeds.rolling)
    }

    /// Power dissipated by viscoelastic bodies under the pressure, and under the tractions if their
    /// displacements contribute to the slip.
    pub(super) fn hysteresis(
        &mut self,
        case: &Case,
        traction: Option<[&[f64]; 2]>,
    ) -> Option<Hysteresis> {
        let normal = self.normal.as_ref().filter(|_| case.bodies.remember())?;
        let (grid, duration) = (&case.footprint.grid, case.passage().duration);
        let differences = case.difference.antisymmetric();
        let mut taken = Hysteresis::default();
        let mut closed = normal.solver.displacement().to_vec();
        if let Some(traction) = traction {
            let zeros = vec![0.0; grid.points()];
            let [mut along, mut across] = [zeros.clone(), zeros];
            let Dissipating { tangential, coupling } =
                self.dissipating.get_or_insert_with(|| Dissipating::new(case));
            tangential.apply(traction, [&mut along, &mut across]);
            if let Some(coupling) = coupling {
                let [mut more_along, mut more_across] = [along.clone(), across.clone()];
                coupling.slip_by_pressure(&self.pressure, [&mut more_along, &mut more_across]);
                add(&mut along, &more_along);
                add(&mut across, &more_across);
                coupling.distance_by_traction(traction, &mut more_along);
                add(&mut closed, &more_along);
            }
            taken.take(grid, duration, differences, traction[0], &along);
            taken.take(grid, duration, differences, traction[1], &across);
        }
        taken.take(grid, duration, differences, &self.pressure, &closed);
        Some(taken)
    }

    /// Normal displacement difference of an instant, caused by pressure and tractions [m].
    pub(super) fn normal_displacement(&mut self, state: &TangentialState) -> Vec<f64> {
        let mut displacement = vec![0.0; self.pressure.len()];
        if let Some(coupling) = &mut self.coupling {
            let [px, py] = &state.traction;
            coupling.distance_by_traction([px, py], &mut displacement);
        }
        if let Some(Normal { solver, .. }) = &self.normal {
            add(&mut displacement, solver.displacement());
        }
        displacement
    }

    /// Tangential displacement difference of an instant, caused by tractions and pressure [m]; for
    /// transient motions.
    pub(super) fn displacement(
        &mut self,
        state: &TangentialState,
        displacement: &mut [Vec<f64>; 2],
    ) {
        let [along_x, along_y] = displacement;
        let [px, py] = &state.traction;
        let levels = self.levels.as_mut().expect("partial slip has its operators");
        levels.displacement([px, py], [along_x, along_y]);
        if let Some(coupling) = &mut self.coupling {
            let [history_x, history_y] = &mut self.slip_history;
            coupling.slip_by_pressure(&self.pressure, [history_x, history_y]);
            for (sum, more) in displacement.iter_mut().zip(&self.slip_history) {
                sum.iter_mut().zip(more).for_each(|(sum, more)| *sum += more);
            }
        }
    }
}

/// Rows that begin at the leading edge, with their pressure: in closed form for an ellipse,
/// otherwise from the pressure; `None` if its rows are no half ellipses. Tractions with memory have
/// the same rows under all loads, those of the smallest.
fn aligned(case: &Case, pressure: &[f64]) -> Option<AlignedPressure> {
    let grid = &case.footprint.grid;
    let known = case.footprint.gap.is_none() || case.is_hertzian();
    let Some(ellipse) = case.footprint.ellipse.filter(|_| known) else {
        return align(grid, pressure);
    };
    let axes = [ellipse.semi_axis_a, ellipse.semi_axis_b];
    let begins = if case.memory { case.footprint.smallest } else { axes };
    let rows = AlignedGrid::of_ellipse(*grid, begins);
    let mut means = elliptic(&rows, axes);
    let [before, after] = [pressure, &means].map(|of| of.iter().sum::<f64>());
    means.iter_mut().for_each(|mean| *mean *= before / after);
    let chords = Chord::of_ellipse(grid, axes);
    (after > 0.0).then_some(AlignedPressure { rows, means, chords })
}

fn add(sum: &mut [f64], more: &[f64]) {
    sum.iter_mut().zip(more).for_each(|(sum, more)| *sum += more);
}
