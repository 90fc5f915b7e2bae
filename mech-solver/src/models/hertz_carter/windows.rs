//! Windows of a contact with varying values, or with friction that depends on inputs or on slip.
//!
//! Carter's strips use a single, equivalent friction coefficient, ∫ min(f p, τ) dA/∫ p dA, with
//! which a sliding contact carries the same force. The integral is a sum over the elements, and
//! those at the rim touch in part. Tractions are at most this coefficient times Hertz's pressure,
//! so they exceed a bound τ in the middle of the contact and are below it at the rim.

use super::case::Case;
use super::contact::CarterContact;
use super::fields;
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
    /// Hertz's pressure of the last solved ellipse; used if friction is not constant.
    pressure: Vec<f64>,
    /// Share of every element that touches.
    touching: Vec<f64>,
    ellipse: Option<Ellipse>,
}

/// A solved time window.
pub(super) struct Window {
    contact: CarterContact,
    step: Step,
    /// Set if the prescribed force was not reached.
    shortfall: Option<Shortfall>,
}

impl Windows {
    pub(super) fn new(case: Case, scenes: Scenes) -> Self {
        let [pressure, touching] = [(); 2].map(|()| vec![0.0; case.grid.points()]);
        Self { case, scenes, pressure, touching, ellipse: None }
    }

    /// Equivalent friction coefficient at these creepages.
    fn friction_at(
        &self,
        inputs: &dyn Inputs,
        scene: &Scene,
        creepage: [f64; 3],
    ) -> Result<f64, StepError> {
        let Case { terms, grid, .. } = &self.case;
        let slip = RigidSlip { creepage, speed: scene.speeds.rolling };
        let contact = (grid, self.pressure.as_slice());
        let coefficient = scene.friction_coefficient;
        let elements = terms.friction.under_rigid_slip(coefficient, &slip, contact, inputs)?;
        Ok(elements.equivalent(&self.pressure, &self.touching))
    }

    /// Contact whose friction agrees with its own creepages.
    fn settled(
        &mut self,
        inputs: &dyn Inputs,
        scene: &Scene,
        ellipse: Ellipse,
    ) -> Result<(CarterContact, Option<Shortfall>), StepError> {
        let Case { law, terms, .. } = &self.case;
        if terms.friction.is_constant() {
            let contact = CarterContact::solve(scene, ellipse, *law, terms.adhesion);
            return Ok((contact.map_err(no_answer)?, None));
        }
        if self.ellipse.replace(ellipse) != Some(ellipse) {
            ellipse.write_pressure(self.case.grid, &mut self.pressure);
            ellipse.write_touching(self.case.grid, &mut self.touching);
        }
        let first = match scene.drive {
            Drive::Creepage { xi, eta, phi } => [xi, eta, phi],
            _ => [0.0; 3],
        };
        let mut search = CreepageSearch::new(first, ellipse.semi_axis_a);
        loop {
            let friction = self.friction_at(inputs, scene, search.at())?;
            let (drive, shortfall) = Shortfall::of(scene.drive, friction, ellipse.normal_force);
            let scene = Scene { friction_coefficient: friction, drive, ..scene.clone() };
            let Case { law, terms, .. } = &self.case;
            let contact =
                CarterContact::solve(&scene, ellipse, *law, terms.adhesion).map_err(no_answer)?;
            let found = [contact.creepage_xi(), 0.0, 0.0];
            if !terms.friction.follows_slip() || search.take(found)? {
                return Ok((contact, shortfall));
            }
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
        _spent: Option<Window>,
    ) -> Result<Window, StepError> {
        let scene = self.scenes.of(step)?;
        Ellipse::refuse_rest(&scene).map_err(no_answer)?;
        let ellipse = Ellipse::solve(&scene, self.case.given).map_err(no_answer)?;
        let (contact, shortfall) = self.settled(inputs, &scene, ellipse)?;
        Ok(Window { contact, step: *step, shortfall })
    }

    /// Initial window, with the friction coefficient of the case.
    fn first(&mut self) -> Option<Window> {
        let step = Step::STEADY;
        let scene = self.scenes.of(&step).ok()?;
        let Case { given, law, terms, .. } = &self.case;
        let ellipse = Ellipse::solve(&scene, *given).ok()?;
        let contact = CarterContact::solve(&scene, ellipse, *law, terms.adhesion).ok()?;
        Some(Window { contact, step, shortfall: None })
    }

    fn report(&self, _: &Window) -> StepReport {
        let work = self.case.grid.points() as u64;
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
