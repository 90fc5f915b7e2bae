//! Windows of a contact with varying values, or with friction that depends on inputs or on slip.
//!
//! The springs and their reduction use the mean of f over the contact, weighted with the pressure;
//! every point is bounded by the friction of its own element ([`super::limits`]). With a single
//! slip velocity, as in the theory of Spiryagin, Polach and Cole, both are the same.

use super::case::{Case, cells, problem};
use super::contact::FastsimContact;
use super::fields;
use super::limits::Limits;
use crate::case::ellipse::Ellipse;
use crate::case::scene::{Drive, Scene};
use crate::models::contact_model;
use crate::models::creepage_search::CreepageSearch;
use crate::models::shortfall::Shortfall;
use crate::models::varying::{Scenes, no_answer};
use crate::terms::Terms;
use elastic::slip::RigidSlip;
use proto::field::FieldSpec;
use proto::model::{Inputs, Step, StepError, StepReport};
use serde_json::Value;

/// Solver of the windows.
pub(super) struct Windows {
    case: Case,
    scenes: Scenes,
    /// Hertz's pressure; used if friction is not constant.
    pressure: Vec<f64>,
}

/// A solved time window.
pub(super) struct Window {
    contact: FastsimContact,
    step: Step,
    /// Set if the prescribed force was not reached.
    shortfall: Option<Shortfall>,
}

impl Windows {
    pub(super) fn new(case: Case, scenes: Scenes) -> Self {
        let pressure = vec![0.0; case.grid.points()];
        Self { case, scenes, pressure }
    }

    /// Contact with the friction at these creepages.
    fn contact_at(
        &mut self,
        inputs: &dyn Inputs,
        scene: &Scene,
        creepage: [f64; 3],
        spent: Option<FastsimContact>,
    ) -> Result<(FastsimContact, Option<Shortfall>), StepError> {
        let Case { asked, terms, grid } = &mut self.case;
        let slip = RigidSlip { creepage, speed: scene.speeds.rolling };
        let contact = (&*grid, self.pressure.as_slice());
        let coefficient = scene.friction_coefficient;
        let friction = terms.friction.under_rigid_slip(coefficient, &slip, contact, inputs)?;
        let limits = Limits::new(grid, &friction, &self.pressure);
        let at_rest = Drive::Creepage { xi: 0.0, eta: 0.0, phi: 0.0 };
        let free = Scene { friction_coefficient: limits.mean, drive: at_rest, ..scene.clone() };
        let (mut problem, _) = problem(&free, asked, grid).map_err(no_answer)?;
        let load = problem.ellipse.normal_force;
        // Limit by the mean, to which forces refer: the sum over the strips may exceed it by
        // rounding or discretisation.
        let most = limits.mean.min(problem.capacity(&limits) / load);
        let (drive, shortfall) = Shortfall::of(scene.drive, most, load);
        problem.prescribed =
            problem.ellipse.prescribed(&Scene { drive, ..free }).map_err(no_answer)?;
        let contact = problem.solve_limited(&limits, spent);
        contact.check_power().map_err(no_answer)?;
        Ok((contact, shortfall))
    }

    /// Contact whose friction agrees with its own creepages.
    fn settled(
        &mut self,
        inputs: &dyn Inputs,
        scene: &Scene,
        mut spent: Option<FastsimContact>,
    ) -> Result<(FastsimContact, Option<Shortfall>), StepError> {
        let Case { asked, terms, grid } = &self.case;
        if terms.friction.is_constant() {
            let (problem, _) = problem(scene, asked, grid).map_err(no_answer)?;
            let contact = problem.solve(spent);
            contact.check_power().map_err(no_answer)?;
            return Ok((contact, None));
        }
        let ellipse = Ellipse::solve(scene, asked.given).map_err(no_answer)?;
        ellipse.write_pressure(*grid, &mut self.pressure);
        let first = match scene.drive {
            Drive::Creepage { xi, eta, phi } => [xi, eta, phi],
            _ => [0.0; 3],
        };
        let mut search = CreepageSearch::new(first, ellipse.semi_axis_a);
        loop {
            let solved = self.contact_at(inputs, scene, search.at(), spent.take())?;
            if !self.case.terms.friction.follows_slip() || search.take(solved.0.creepage)? {
                return Ok(solved);
            }
            spent = Some(solved.0);
        }
    }
}

impl contact_model::Contact for Windows {
    type Window = Window;

    fn solve(
        &mut self,
        step: &Step,
        inputs: &dyn Inputs,
        _accepted: Option<&Window>,
        spent: Option<Window>,
    ) -> Result<Window, StepError> {
        let scene = self.scenes.of(step)?;
        let (contact, shortfall) =
            self.settled(inputs, &scene, spent.map(|window| window.contact))?;
        Ok(Window { contact, step: *step, shortfall })
    }

    /// Initial window, with the friction coefficient of the case.
    fn first(&mut self) -> Option<Window> {
        let scene = self.scenes.of(&Step::STEADY).ok()?;
        let (problem, _) = problem(&scene, &self.case.asked, &self.case.grid).ok()?;
        Some(Window { contact: problem.solve(None), step: Step::STEADY, shortfall: None })
    }

    fn report(&self, window: &Window) -> StepReport {
        let work = cells(&window.contact.problem) as u64;
        StepReport { substeps: 1, work, ..StepReport::default() }
    }

    fn write(&self, window: &Window, spec: &FieldSpec, values: &mut [f64]) {
        fields::write(spec, &window.contact, self.case.grid, &self.case.terms, values);
    }

    fn acceptable(&self, window: &Window) -> Result<(), StepError> {
        Shortfall::refused(window.shortfall, &self.case.terms)
    }

    fn summary(&self, window: &Window) -> Value {
        self.scenes.complete(window.contact.summary(self.case.grid.dx()), &window.step)
    }

    fn terms(&self) -> &Terms {
        &self.case.terms
    }

    fn terms_mut(&mut self) -> &mut Terms {
        &mut self.case.terms
    }
}
