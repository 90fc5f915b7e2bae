//! The contact whose friction depends on what comes in, or on slip.
//!
//! Carter's strips know one friction coefficient: the equivalent one, Σ min(f p, τ)/Σ p over the elements, with which a
//! contact that slides carries the same force. Tractions are this coefficient times Hertz's pressure at most, so that they pass a bound
//! τ in the middle of the contact and are below it at the rim. It is solved anew in every iteration.

use super::case::Case;
use super::contact::Contact;
use super::fields;
use crate::case::scene::{Drive, Scene};
use crate::models::settled_creepage::SettledCreepage;
use crate::models::shortfall::Shortfall;
use crate::terms::friction::{FrictionState, lateral};
use elastic::slip::RigidSlip;
use proto::configuration::Refusal;
use proto::field;
use proto::model::{Inputs, Model, Outputs, StateError, Step, StepError, StepReport};
use serde_json::Value;
use std::io::{self, Read, Write};

/// The model that runs.
pub(super) struct Heated {
    case: Case,
    pressure: Vec<f64>,
    /// The force of the last solve is not the prescribed one.
    shortfall: Option<Shortfall>,
}

impl Heated {
    pub(super) fn new(case: Case) -> Self {
        let pressure = fields::values(&field::PRESSURE, &case.contact, case.grid, &case.terms);
        Self { pressure, shortfall: None, case }
    }

    /// The equivalent friction coefficient at some creepages.
    fn friction_at(&self, inputs: &dyn Inputs, creepage: [f64; 3]) -> Result<f64, StepError> {
        let Case { terms, scene, grid, .. } = &self.case;
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
        let elements = terms.friction.evaluate(scene.friction_coefficient, &state)?;
        Ok(elements.equivalent(&self.pressure))
    }

    /// Solves the contact with the friction at some creepages; those that it has then.
    fn contact_at(
        &mut self,
        inputs: &dyn Inputs,
        creepage: [f64; 3],
    ) -> Result<[f64; 3], StepError> {
        let friction = self.friction_at(inputs, creepage)?;
        let normal_force = self.case.contact.ellipse.normal_force;
        let (drive, shortfall) = Shortfall::of(self.case.scene.drive, friction, normal_force);
        self.shortfall = shortfall;
        let scene = Scene { friction_coefficient: friction, drive, ..self.case.scene.clone() };
        let Case { contact, law, terms, .. } = &mut self.case;
        *contact = Contact::solve(&scene, contact.ellipse, *law, terms.adhesion).map_err(
            |Refusal { reason, fix, .. }| StepError::NoSolution(format!("{reason}; {fix}")),
        )?;
        Ok([contact.creepage_xi(), 0.0, 0.0])
    }

    fn write(&self, outputs: &mut dyn Outputs) {
        for spec in &self.case.wanted {
            if let Some(place) = outputs.get(spec) {
                let Case { contact, grid, terms, .. } = &self.case;
                fields::write(spec, contact, *grid, terms, place);
            }
        }
    }
}

impl Model for Heated {
    fn solve(
        &mut self,
        _step: &Step,
        inputs: &dyn Inputs,
        outputs: &mut dyn Outputs,
    ) -> Result<StepReport, StepError> {
        let first = match self.case.scene.drive {
            Drive::Creepage { xi, eta, phi } => [xi, eta, phi],
            _ => [0.0; 3],
        };
        let mut search = SettledCreepage::new(first, self.case.contact.ellipse.semi_axis_a);
        loop {
            let found = self.contact_at(inputs, search.at())?;
            if !self.case.terms.friction.follows_slip() || search.take(found)? {
                break;
            }
        }
        self.write(outputs);
        let work = self.case.grid.points() as u64;
        Ok(StepReport { substeps: 1, work, ..StepReport::default() })
    }

    fn first_outputs(&mut self, outputs: &mut dyn Outputs) {
        self.write(outputs);
    }

    fn acceptable(&self) -> Result<(), StepError> {
        Shortfall::refused(self.shortfall, &self.case.terms)
    }

    fn accept(&mut self) {
        self.case.terms.accept();
    }

    fn observe(&mut self, outputs: &mut dyn Outputs) {
        self.write(outputs);
    }

    fn summary(&self) -> Value {
        self.case.contact.summary()
    }

    fn save(&self, into: &mut dyn Write) -> io::Result<()> {
        self.case.terms.save(into)
    }

    fn restore(&mut self, from: &mut dyn Read) -> Result<(), StateError> {
        self.case.terms.restore(from)
    }
}
