//! The contact whose friction depends on slip, or on what comes in.
//!
//! The springs and their reduction have the mean of f over the contact, weighted with the pressure; every place is bounded by the friction of
//! its own element ([`super::limits`]). With one slip velocity for all, as Spiryagin, Polach and Cole have it, both are the same. It is solved anew in
//! every iteration, and in every row where the case varies.

use super::case::{Case, cells, problem};
use super::contact::Contact;
use super::fields;
use super::limits::Limits;
use crate::case::ellipse::Ellipse;
use crate::case::scene::{Drive, Scene};
use crate::models::settled_creepage::SettledCreepage;
use crate::models::shortfall::Shortfall;
use crate::models::varying::{Varying, no_answer};
use crate::terms::friction::{FrictionState, lateral};
use elastic::slip::RigidSlip;
use proto::field::FieldSpec;
use proto::model::{Inputs, Model, Outputs, StateError, Step, StepError, StepReport};
use serde_json::{Value, json};
use std::io::{self, Read, Write};

/// The model that runs.
pub(super) struct Rubbed {
    scene: Scene,
    case: Case,
    /// The values that vary, if any do.
    varying: Option<Varying>,
    wanted: Vec<&'static FieldSpec>,
    pressure: Vec<f64>,
    trial: Option<(Contact, Step)>,
    accepted: Option<(Contact, Step)>,
    /// The contact of an earlier row.
    spent: Option<Contact>,
    /// The force of the last solve is not the prescribed one.
    shortfall: Option<Shortfall>,
}

impl Rubbed {
    /// Of a scene, or of rows, of which these fields are asked for.
    pub(super) fn new(
        scene: Scene,
        case: Case,
        varying: Option<Varying>,
        wanted: Vec<&'static FieldSpec>,
    ) -> Self {
        let pressure = vec![0.0; case.grid.points()];
        let (trial, accepted, spent, shortfall) = (None, None, None, None);
        Self { scene, case, varying, wanted, pressure, trial, accepted, spent, shortfall }
    }

    fn scene(&mut self, step: &Step) -> Result<Scene, StepError> {
        match &mut self.varying {
            Some(varying) => varying.scene(step),
            None => Ok(self.scene.clone()),
        }
    }

    /// The contact with the friction at some creepages.
    fn contact_at(
        &mut self,
        inputs: &dyn Inputs,
        scene: &Scene,
        creepage: [f64; 3],
        spent: Option<Contact>,
    ) -> Result<Contact, StepError> {
        let Case { asked, terms, grid } = &mut self.case;
        let slip = RigidSlip { creepage, speed: scene.speeds.rolling };
        let state = FrictionState {
            inputs: Some(inputs),
            speed: slip.speed,
            rigid_slip: &|index| slip.at(grid, index),
            grid,
            coordinate: &lateral(grid, 0.0),
            pressure: &self.pressure,
            velocity: None,
        };
        let friction = terms.friction.evaluate(scene.friction_coefficient, &state)?;
        let limits = Limits::new(grid, &friction, &self.pressure);
        let at_rest = Drive::Creepage { xi: 0.0, eta: 0.0, phi: 0.0 };
        let free = Scene { friction_coefficient: limits.mean, drive: at_rest, ..scene.clone() };
        let (mut problem, _) = problem(&free, asked, grid).map_err(no_answer)?;
        let load = problem.ellipse.normal_force;
        // No more than the mean, to which forces are referred, where the sum over the strips is off by rounding or by its grid.
        let most = limits.mean.min(problem.capacity(&limits) / load);
        let (drive, shortfall) = Shortfall::of(scene.drive, most, load);
        self.shortfall = shortfall;
        problem.prescribed =
            problem.ellipse.prescribed(&Scene { drive, ..free }).map_err(no_answer)?;
        let contact = problem.solve_limited(&limits, spent);
        contact.check_power().map_err(no_answer)?;
        Ok(contact)
    }

    fn settled(&mut self, inputs: &dyn Inputs, scene: &Scene) -> Result<Contact, StepError> {
        let ellipse = Ellipse::solve(scene, self.case.asked.given).map_err(no_answer)?;
        ellipse.write_pressure(self.case.grid, &mut self.pressure);
        let first = match scene.drive {
            Drive::Creepage { xi, eta, phi } => [xi, eta, phi],
            _ => [0.0; 3],
        };
        let mut search = SettledCreepage::new(first, ellipse.semi_axis_a);
        let mut spent = self.spent.take();
        loop {
            let contact = self.contact_at(inputs, scene, search.at(), spent.take())?;
            if !self.case.terms.friction.follows_slip() || search.take(contact.creepage)? {
                return Ok(contact);
            }
            spent = Some(contact);
        }
    }

    fn write(&self, contact: &Contact, outputs: &mut dyn Outputs) {
        let Case { terms, grid, .. } = &self.case;
        for spec in &self.wanted {
            if let Some(values) = outputs.get(spec) {
                fields::write(spec, contact, *grid, terms, values);
            }
        }
    }
}

impl Model for Rubbed {
    fn solve(
        &mut self,
        step: &Step,
        inputs: &dyn Inputs,
        outputs: &mut dyn Outputs,
    ) -> Result<StepReport, StepError> {
        let scene = self.scene(step)?;
        let contact = self.settled(inputs, &scene)?;
        self.write(&contact, outputs);
        let work = cells(&contact.problem) as u64;
        self.trial = Some((contact, *step));
        Ok(StepReport { substeps: 1, work, ..StepReport::default() })
    }

    /// With the friction coefficient of the case; zero where that has no answer.
    fn first_outputs(&mut self, outputs: &mut dyn Outputs) {
        for spec in proto::field::TABLE {
            if let Some(place) = outputs.get(spec) {
                place.fill(0.0);
            }
        }
        let scene = self.scene(&Step::STEADY).ok();
        let Case { asked, grid, .. } = &self.case;
        let first = scene.and_then(|scene| problem(&scene, asked, grid).ok());
        if let Some((problem, _)) = first {
            self.write(&problem.solve(None), outputs);
        }
    }

    fn acceptable(&self) -> Result<(), StepError> {
        Shortfall::refused(self.shortfall, &self.case.terms)
    }

    fn accept(&mut self) {
        if let Some(solved) = self.trial.take() {
            self.spent = self.accepted.replace(solved).map(|(contact, _)| contact);
        }
        self.case.terms.accept();
    }

    fn observe(&mut self, outputs: &mut dyn Outputs) {
        if let Some((contact, _)) = &self.accepted {
            self.write(contact, outputs);
        }
    }

    fn summary(&self) -> Value {
        let Some((contact, step)) = &self.accepted else { return json!({}) };
        let mut summary = contact.summary();
        if let Some(varying) = &self.varying {
            varying.add_to(&mut summary["contact"], step);
        }
        summary
    }

    fn save(&self, into: &mut dyn Write) -> io::Result<()> {
        self.case.terms.save(into)
    }

    fn restore(&mut self, from: &mut dyn Read) -> Result<(), StateError> {
        self.case.terms.restore(from)
    }
}
