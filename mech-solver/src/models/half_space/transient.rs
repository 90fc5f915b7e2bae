//! Transient rolling and shifting: every step starts from the tractions of the previous step.
//!
//! A rolling contact advances by one element per step, Δq = Δx, in the time Δx/V. The particles of
//! an element then come from the centre of the upstream element, so nothing is interpolated and the
//! power balance is exact. With p' and u' the tractions and displacement differences before the
//! step and S the upstream shift, the slip is S = w Δq + u − S u', and
//!
//! Σ −½(S p' + p)·S = −Σ ½(S p' + p)·w Δq − (½ pᵀu − ½ p'ᵀu'):
//!
//! the work of the forces minus the change of elastic energy. With the upwind difference this holds
//! in every step, with Fromm's difference in the first step only. All later steps take Fromm's
//! difference along x and the second-order backward difference in time
//! ([`half_space::difference`]). A step in which a creepage jumps is like the first one.
//!
//! The mechanical steps need not fit into the time windows of the coupling. A step that extends
//! beyond a window continues in the next one, and the friction power of a window is the mean over
//! the parts of the steps inside it, so that no heat is lost.
//!
//! A contact that does not roll is shifted by the prescribed amount in the first window. If load,
//! shift or forces are columns of a table, it is shifted in one step per window to the values at
//! the end of the window.
//!
//! Bodies whose compliance grows creep under the load, so that the pressure changes from window to
//! window ([`half_space::retarded`]).
//!
//! Initially the bodies are pressed together without friction. If values vary, they start apart,
//! and friction acts while the first load is applied. Rolling bodies may start from their steady
//! state (`mech.begin`).

use super::answer::ContactFields;
use super::balance::{Balance, Powers};
use super::case::Case;
use super::contact::{ContactError, ContactSolver};
use super::creeping::{CreepState, CreepingBodies, Instant};
use super::power::RowStep;
use super::steady::{Following, MOST_BYTES};
use crate::models::contact_model::{CarriedLoad, Contact};
use crate::models::shortfall::Shortfall;
use crate::models::varying::no_answer;
use crate::terms::Terms;
use half_space::difference::Difference;
use half_space::dissipation::shared;
use half_space::grid_continuation::{History, Motion, Solution};
use half_space::tangential::{PrescribedMotion, TangentialState};
use proto::field::FieldSpec;
use proto::model::{Inputs, Outputs, StateError, Step, StepError, StepReport};
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::io::{self, Read, Write};

/// Remaining share of a mechanical step below which the remainder is treated as rounding error.
const ROUNDING: f64 = 1e-9;
/// Change of a creepage from step to step, relative to its last change, above which it jumps.
const MOST_GROWTH: f64 = 2.0;

/// A contact with history.
pub(super) struct Transient {
    case: Case,
    following: Option<Following>,
    /// Solver of all steps, or of the first step only.
    contact: ContactSolver,
    /// Solver of the later steps, if it differs from the first.
    further: Option<ContactSolver>,
    creeping: Option<CreepingBodies>,
    /// State before the first window.
    start: StepState,
    /// True until the start from steady rolling has been computed (`mech.begin = "steady"`).
    begins: bool,
}

/// A solved time window.
pub(super) struct Window {
    memory: StepState,
    /// Mean friction power over the window [W/m²].
    power: Vec<f64>,
    /// Means of all powers over the window.
    powers: Powers,
    report: StepReport,
    /// Set if some step could not reach the prescribed force.
    shortfall: Option<Shortfall>,
}

/// State passed from one step to the next.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct StepState {
    solution: Solution,
    pressure: Vec<f64>,
    approach: Option<f64>,
    /// Displacement differences u, x and y [m].
    displacement: [Vec<f64>; 2],
    /// State one step earlier, kept where later steps use a different solver.
    earlier: Option<Tangential>,
    /// Creep state of the bodies; empty for bodies without creep.
    crept: CreepState,
    /// Fields of the step in progress.
    answer: ContactFields,
    /// Remaining time of the step in progress [s].
    left: f64,
    /// Accumulated shift [m, m, rad]; contacts without rolling only.
    shift: [f64; 3],
}

/// Tractions of an instant and the displacements they cause.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Tangential {
    /// Tractions, x and y [Pa].
    traction: [Vec<f64>; 2],
    /// Displacement differences u, x and y [m].
    displacement: [Vec<f64>; 2],
    /// Plastic shift [m]; empty without a yielding layer.
    plastic: Vec<f64>,
    /// Creepages that led to this instant [-, -, rad/m].
    creepage: [f64; 3],
}

impl Tangential {
    /// Elastic energy Σ ½ p·u per area of an element [Pa m].
    fn energy_at_once(&self) -> f64 {
        let products =
            |(p, u): (&Vec<f64>, &Vec<f64>)| p.iter().zip(u).map(|(p, u)| p * u).sum::<f64>();
        0.5 * self.traction.iter().zip(&self.displacement).map(products).sum::<f64>()
    }

    /// Elastic energy with the second-order difference in time, ¼ Σ (p·u + (2p − p')·(2u − u')),
    /// per area of an element [Pa m].
    fn energy(&self, before: &Self) -> f64 {
        let of = |k: usize| {
            let [p, u] = [&self.traction[k], &self.displacement[k]];
            let [p_before, u_before] = [&before.traction[k], &before.displacement[k]];
            let ahead = |at: usize| (2.0 * p[at] - p_before[at]) * (2.0 * u[at] - u_before[at]);
            (0..p.len()).map(|at| p[at] * u[at] + ahead(at)).sum::<f64>()
        };
        0.25 * (of(0) + of(1))
    }

    /// Numerical dissipation of the second-order time difference, ¼ Σ δ_t²p·δ_t²u over the duration
    /// of a step [W/m²].
    fn dissipated(&self, before: &Self, earlier: &Self, duration: f64) -> Vec<f64> {
        let second_difference = |of: fn(&Self) -> &[Vec<f64>; 2]| {
            let [now, before, earlier] = [self, before, earlier].map(of);
            [0, 1].map(|k| -> Vec<f64> {
                let values = now[k].iter().zip(&before[k]).zip(&earlier[k]);
                values.map(|((now, before), earlier)| now - 2.0 * before + earlier).collect()
            })
        };
        let traction = second_difference(|instant| &instant.traction);
        let displacement = second_difference(|instant| &instant.displacement);
        let [px, py] = &traction;
        let [ux, uy] = &displacement;
        shared([px, py], [ux, uy], 0.25 / duration)
    }
}

impl StepState {
    fn at_rest(case: &Case, contact: &mut ContactSolver) -> Self {
        let zeros = vec![0.0; contact.pressure.len()];
        let state = TangentialState::at_rest(&contact.pressure, [0.0; 3]);
        let mut displacement = [zeros.clone(), zeros];
        contact.displacement(&state, &mut displacement);
        Self {
            solution: Solution::new(state),
            pressure: contact.pressure.clone(),
            approach: contact.approach,
            displacement,
            earlier: None,
            crept: CreepState::default(),
            answer: ContactFields::at_rest(case, contact),
            left: 0.0,
            shift: [0.0; 3],
        }
    }

    /// Returns the state of bodies that do not touch yet.
    fn apart(self) -> Self {
        let Self { mut solution, mut pressure, mut displacement, mut answer, .. } = self;
        solution.state = TangentialState::at_rest(&vec![0.0; pressure.len()], [0.0; 3]);
        pressure.fill(0.0);
        displacement.iter_mut().for_each(|u| u.fill(0.0));
        answer.pressure.fill(0.0);
        answer.bounding_pressure.fill(0.0);
        Self { solution, pressure, displacement, answer, approach: None, ..self }
    }

    /// Pressure and tractions, with the tangential displacements they cause.
    fn instant(&self) -> Instant<'_> {
        let Self { pressure, displacement, solution, .. } = self;
        Instant { pressure, traction: &solution.state.traction, displacement }
    }

    /// Tractions, with the displacements they cause and the plastic shift.
    fn tangential(&self) -> Tangential {
        let TangentialState { traction, plastic, creepage, .. } = &self.solution.state;
        let (traction, plastic) = (traction.clone(), plastic.clone());
        let displacement = self.displacement.clone();
        Tangential { traction, displacement, plastic, creepage: *creepage }
    }

    /// Returns whether all fields have this number of elements.
    fn fits(&self, count: usize) -> bool {
        let earlier = self.earlier.iter().all(|earlier| {
            let layer = earlier.plastic.len() == self.solution.state.plastic.len();
            let fields = earlier.traction.iter().chain(&earlier.displacement);
            layer && fields.into_iter().all(|field| field.len() == count)
        });
        let Self { solution: Solution { state, .. }, answer, .. } = self;
        let one = [&self.pressure, &answer.pressure, &answer.friction_power];
        let two = [&answer.traction, &answer.slip_velocity];
        earlier
            && state.fits(count)
            && one.iter().all(|field| field.len() == count)
            && two.iter().all(|field| field.len() == 2 * count)
            && self.displacement.iter().all(|field| field.len() == count)
    }
}

impl Transient {
    pub(super) fn new(case: Case, following: Option<Following>) -> Result<Self, ContactError> {
        let motion = match case.scene.speeds.rolling > 0.0 {
            true => Motion::FirstRollingStep,
            false => Motion::Shift,
        };
        let mut contact = ContactSolver::new(&case, motion)?;
        let further = case.difference == Difference::Fromm && case.scene.speeds.rolling > 0.0;
        let further =
            further.then(|| ContactSolver::new(&case, Motion::RollingStep)).transpose()?;
        let mut start = StepState::at_rest(&case, &mut contact);
        if following.is_some() {
            start = start.apart();
        }
        let zeros = vec![0.0; contact.pressure.len()];
        let mut creeping = None;
        if !case.delays.is_empty() {
            let normal = match following {
                Some(_) => zeros.clone(),
                None => contact.normal_displacement(&start.solution.state),
            };
            let (operators, crept) = CreepingBodies::new(&case, &start.pressure, normal);
            start.crept = crept;
            creeping = Some(operators);
        }
        if case.terms.yields.is_some() {
            let state = &mut start.solution.state;
            (state.plastic, state.yielded) = (zeros.clone(), zeros);
        }
        let begins = case.begins_steady;
        Ok(Self { case, following, contact, further, creeping, start, begins })
    }

    /// Replaces the start state by steady rolling under the initial values.
    fn begin(&mut self, inputs: &dyn Inputs) -> Result<(), StepError> {
        let no_solution = |error: ContactError| StepError::NoSolution(error.to_string());
        let case = &mut self.case;
        let mut steady = ContactSolver::new(case, Motion::SteadyRolling).map_err(no_solution)?;
        let driven = case.driven;
        steady.set_friction(case, inputs, driven.at(0.0).creepage)?;
        let solution = steady.solve(case, inputs, &driven, None, None)?;
        let start = &mut self.start;
        start.answer = ContactFields::partial(case, &steady, &solution, None);
        if let Some(power) = steady.numerical_dissipation(case, &solution.state) {
            start.answer.add_numerical_dissipation(case, &power);
        }
        start.answer.leave_rows(case, &steady, &solution.state);
        (start.pressure, start.approach) = (steady.pressure, steady.approach);
        self.contact.pressure.clone_from(&start.pressure);
        self.contact.displacement(&solution.state, &mut start.displacement);
        start.solution = Solution::new(solution.state);
        start.earlier = self.further.as_ref().map(|_| start.tangential());
        Ok(())
    }

    /// Applies the values of a window. Rolling bodies take the means over the window, a shift its
    /// values at the end of the window; for creeping bodies, the displacements left by earlier
    /// loads are evaluated at the end of the window. `before` is the state at the start of the
    /// window.
    fn follow(&mut self, step: &Step, before: &StepState) -> Result<(), StepError> {
        let no_solution = |error: ContactError| StepError::NoSolution(error.to_string());
        if let Some(Following { varying, patch, .. }) = &self.following {
            let rolls = self.case.scene.speeds.rolling > 0.0;
            let at = Step { start: if rolls { step.start } else { step.end }, ..*step };
            self.case.follow(&varying.configuration(&at), *patch).map_err(no_answer)?;
        } else if self.creeping.is_none() {
            return Ok(());
        }
        if let Some(creeping) = &mut self.creeping {
            if let Some(elasticity) = creeping.take(step.duration()) {
                self.case.bodies = elasticity.into();
                self.contact =
                    ContactSolver::new(&self.case, Motion::Shift).map_err(no_solution)?;
            }
            creeping.recall(&before.crept, before.instant());
        }
        let displaced = self.creeping.as_ref().map(CreepingBodies::normal);
        for contact in self.further.iter_mut().chain([&mut self.contact]) {
            contact.pressure.clone_from(&before.pressure);
            contact.follow(&self.case, true, displaced).map_err(no_solution)?;
        }
        Ok(())
    }

    /// Advances from the state before a window to its end.
    fn advance(
        &mut self,
        window: &mut Window,
        duration: f64,
        inputs: &dyn Inputs,
    ) -> Result<(), StepError> {
        window.memory.solution.newton_steps = 0;
        window.memory.solution.operator_applications = 0;
        if self.following.is_none() && self.creeping.is_none() {
            for contact in self.further.iter_mut().chain([&mut self.contact]) {
                contact.pressure.clone_from(&window.memory.pressure);
                contact.approach = window.memory.approach;
            }
        }
        let mut rest = duration;
        while rest > ROUNDING * duration {
            if window.memory.left == 0.0 {
                let (step, shortfall) = self.step(&mut window.memory, duration, inputs)?;
                window.memory.left = step;
                window.shortfall = window.shortfall.or(shortfall);
                window.report.substeps += 1;
            }
            let Window { memory, power, powers, .. } = window;
            let taken = memory.left.min(rest);
            let share = taken / duration;
            for (mean, power) in power.iter_mut().zip(&memory.answer.friction_power) {
                *mean += share * power;
            }
            powers.add(share, &memory.answer.powers(&self.case));
            rest -= taken;
            memory.left -= taken;
            if memory.left <= ROUNDING * taken {
                memory.left = 0.0;
            }
        }
        let Window { memory, power, powers, report, .. } = window;
        if duration == 0.0 {
            power.clone_from(&memory.answer.friction_power);
            *powers = memory.answer.powers(&self.case);
        }
        report.inner_iterations = memory.solution.newton_steps as u32;
        report.work = memory.solution.operator_applications as u64;
        Ok(())
    }

    /// Solves one mechanical step. Returns its duration [s] and the shortfall of the force, if any.
    fn step(
        &mut self,
        trial: &mut StepState,
        window: f64,
        inputs: &dyn Inputs,
    ) -> Result<(f64, Option<Shortfall>), StepError> {
        let no_solution = |error: ContactError| StepError::NoSolution(error.to_string());
        let case = &mut self.case;
        let rolls = case.scene.speeds.rolling > 0.0;
        let now = case.driven.at(0.0);
        let before = trial.solution.state.creepage;
        let earlier = trial.earlier.take().filter(|earlier| !jumps(&now, before, earlier.creepage));
        case.first_step = earlier.is_none();
        let start = Start { columns: case.footprint.grid.ni, rolls };
        let mut slip = [0, 1].map(|k| match &earlier {
            Some(earlier) => {
                let pairs = trial.displacement[k].iter().zip(&earlier.displacement[k]);
                pairs.map(|(before, earlier)| 0.5 * earlier - 2.0 * before).collect()
            }
            None => start.of(&trial.displacement[k]).map(|before| -before).collect::<Vec<_>>(),
        });
        if let Some(creeping) = &self.creeping {
            creeping.add_to(&mut slip);
        }
        // Fresh material enters at the leading edge.
        let yields = case.terms.yields.is_some();
        let plastic: Option<Vec<_>> =
            yields.then(|| start.of(&trial.solution.state.plastic).collect());
        if !rolls {
            case.shift_duration = window;
        }
        let driven = if rolls { case.driven } else { case.driven.beyond(trial.shift) };
        let [along, across] = &slip;
        let history = History { slip: [along, across], plastic: plastic.as_deref() };
        let before = trial.tangential();
        let near = Some(trial.solution.clone());
        let contact = match (&mut self.further, &earlier) {
            (Some(further), Some(_)) => further,
            _ => &mut self.contact,
        };
        trial.solution = contact.solve(case, inputs, &driven, near, Some(history))?;
        let shortfall = contact.shortfall;
        trial.answer =
            ContactFields::partial(case, contact, &trial.solution, Some(&before.traction));
        let state = &trial.solution.state;
        if let Some(power) = contact.numerical_dissipation(case, state) {
            trial.answer.add_numerical_dissipation(case, &power);
        }
        let (pressure, approach) = (contact.pressure.clone(), contact.approach);
        for contact in self.further.iter_mut().chain([&mut self.contact]) {
            (contact.pressure, contact.approach) = (pressure.clone(), approach);
        }
        self.contact.displacement(state, &mut trial.displacement);
        let mut kept = None;
        if let Some(creeping) = &mut self.creeping {
            creeping.add_to(&mut trial.displacement);
            let normal = self.contact.normal_displacement(state);
            let StepState { solution, pressure, displacement, crept, .. } = &mut *trial;
            let Tangential { traction, displacement: displaced, .. } = &before;
            let before = Instant { pressure, traction, displacement: displaced };
            let (pressure, traction) = (&self.contact.pressure, &solution.state.traction);
            let after = Instant { pressure, traction, displacement };
            kept = Some(creeping.end(crept, before, after, normal));
        }
        if let Some(kept) = kept {
            trial.answer.dissipate(case, kept.dissipated);
        }
        let after = trial.tangential();
        if let Some(earlier) = &earlier {
            let power = after.dissipated(&before, earlier, case.passage().duration);
            trial.answer.add_numerical_dissipation(case, &power);
        }
        let contact = match (&self.further, &earlier) {
            (Some(further), Some(_)) => further,
            _ => &self.contact,
        };
        trial.answer.leave_rows(case, contact, &trial.solution.state);
        if !case.bodies.are_coupled() {
            let energy = match (&earlier, kept) {
                (Some(earlier), _) => [before.energy(earlier), after.energy(&before)],
                (None, Some(kept)) => kept.stored,
                (None, None) => [before.energy_at_once(), after.energy_at_once()],
            };
            let taken = kept.map(|kept| kept.along_plane);
            let TangentialState { traction, creepage, .. } = &trial.solution.state;
            let step = RowStep {
                rows: &self.contact.rows,
                before: &before.traction,
                after: traction,
                creepage: *creepage,
            };
            let balance = Balance::step(case, &trial.answer, &step, energy, taken);
            trial.answer.balance =
                Some(balance.check().map_err(|error| no_solution(error.into()))?);
        }
        if !rolls {
            for (sum, shift) in trial.shift.iter_mut().zip(trial.solution.state.creepage) {
                *sum += shift;
            }
            trial.answer.creepage = trial.shift;
        }
        trial.earlier = self.further.as_ref().map(|_| before);
        (trial.pressure, trial.approach) = (pressure, approach);
        Ok((case.passage().duration, shortfall))
    }
}

/// Returns whether a prescribed creepage jumps: it changes by more than twice its last change. A
/// step of the particles sees the jump when it happens; the backward difference in time would see
/// it half a step late.
fn jumps(now: &PrescribedMotion, before: [f64; 3], earlier: [f64; 3]) -> bool {
    (0..3)
        .filter(|k| now.force[*k].is_none())
        .any(|k| (now.creepage[k] - before[k]).abs() > MOST_GROWTH * (before[k] - earlier[k]).abs())
}

/// Positions of the particles at the start of a step.
#[derive(Clone, Copy)]
struct Start {
    /// Number of elements in a row.
    columns: usize,
    /// True if particles come from the upstream element; those entering at the leading edge carry
    /// zero.
    rolls: bool,
}

impl Start {
    fn of(self, before: &[f64]) -> impl Iterator<Item = f64> {
        (0..before.len()).map(move |index| match self.rolls {
            true if (index + 1).is_multiple_of(self.columns) => 0.0,
            true => before[index + 1],
            false => before[index],
        })
    }
}

impl Contact for Transient {
    type Window = Window;

    fn solve(
        &mut self,
        step: &Step,
        inputs: &dyn Inputs,
        accepted: Option<&Window>,
        spent: Option<Window>,
    ) -> Result<Window, StepError> {
        if accepted.is_none() && std::mem::take(&mut self.begins) {
            self.begin(inputs)?;
        }
        let before = accepted.map_or(&self.start, |window| &window.memory);
        let (memory, power) = match spent {
            Some(Window { mut memory, mut power, .. }) => {
                memory.clone_from(before);
                power.fill(0.0);
                (memory, power)
            }
            None => (before.clone(), vec![0.0; before.pressure.len()]),
        };
        let (powers, report) = (Powers::default(), StepReport::default());
        let mut window = Window { memory, power, powers, report, shortfall: None };
        self.follow(step, &window.memory)?;
        let creepage = self.case.driven.at(0.0).creepage;
        for contact in self.further.iter_mut().chain([&mut self.contact]) {
            contact.set_friction(&self.case, inputs, creepage)?;
        }
        self.advance(&mut window, step.duration(), inputs)?;
        Ok(window)
    }

    fn loads(&self, window: &Window) -> Vec<CarriedLoad> {
        window.memory.answer.loads(&self.case)
    }

    fn first_speeds(&self) -> [f64; 2] {
        self.case.scene.speeds.of_surfaces(0.0)
    }

    fn report(&self, window: &Window) -> StepReport {
        window.report
    }

    fn write(&self, window: &Window, spec: &FieldSpec, values: &mut [f64]) {
        window.memory.answer.write(&self.case, &window.power, spec, values);
    }

    fn acceptable(&self, window: &Window) -> Result<(), StepError> {
        Shortfall::refused(window.shortfall, &self.case.terms)
    }

    fn observe(&mut self, window: &Window, outputs: &mut dyn Outputs) {
        self.case.observe(&window.memory.answer, outputs);
    }

    fn summary(&self, window: &Window) -> Value {
        self.case.summary(&window.memory.answer, &window.powers)
    }

    fn terms(&self) -> &Terms {
        &self.case.terms
    }

    fn terms_mut(&mut self) -> &mut Terms {
        &mut self.case.terms
    }

    fn save(&self, accepted: Option<&Window>, mut into: &mut dyn Write) -> io::Result<()> {
        let state = accepted.map(|Window { memory, power, powers, .. }| (memory, power, powers));
        let config = bincode::config::standard();
        bincode::serde::encode_into_std_write(state, &mut into, config)
            .map(|_| ())
            .map_err(io::Error::other)
    }

    fn restore(&mut self, mut from: &mut dyn Read) -> Result<Option<Window>, StateError> {
        let config = bincode::config::standard().with_limit::<MOST_BYTES>();
        let wrong = |reason: String| StateError(format!("half-space: {reason}"));
        let state: Option<(StepState, Vec<f64>, Powers)> =
            bincode::serde::decode_from_std_read(&mut from, config)
                .map_err(|e| wrong(e.to_string()))?;
        let Some((memory, power, powers)) = state else { return Ok(None) };
        let count = self.start.pressure.len();
        let layer = memory.solution.state.plastic.len() == self.start.solution.state.plastic.len();
        let creeps = memory.crept.is_like(&self.start.crept);
        if !memory.fits(count) || power.len() != count || !layer || !creeps {
            return Err(wrong("the state belongs to another grid".to_owned()));
        }
        let report = StepReport::default();
        Ok(Some(Window { memory, power, powers, report, shortfall: None }))
    }
}
