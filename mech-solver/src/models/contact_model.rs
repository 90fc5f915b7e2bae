//! Common model of all contacts: solves window after window, starting from the accepted state.
//!
//! A contact defines how a window is solved and which fields and figures it has ([`Contact`]).
//! [`ContactModel`] does the rest of a model's work: it keeps the last solved and the accepted
//! window, writes fields and figures, and saves and restores the state.

use crate::terms::Terms;
use proto::field::{self, FieldSpec};
use proto::model::{InputField, Inputs, Model, Outputs, StateError, Step, StepError, StepReport};
use proto::readable::quantity;
use serde_json::{Value, json};
use std::io::{self, Read, Write};

/// Largest accepted difference between the prescribed and the carried normal force, relative to the
/// prescribed one. It is above the tolerance of every search of a force: the coarsest, that of
/// `wheel-on-track`, is 1e-5.
const LARGEST_LOAD_ERROR: f64 = 2e-5;

/// Prescribed normal force of a window, and the one that the pressure of its solution carries [N].
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct CarriedLoad {
    pub(super) prescribed: f64,
    pub(super) carried: f64,
}

impl CarriedLoad {
    /// Refuses a solution that does not carry its load.
    fn check(self) -> Result<(), StepError> {
        let Self { prescribed, carried } = self;
        // Written so that a NaN is refused too.
        if (carried - prescribed).abs() <= LARGEST_LOAD_ERROR * prescribed {
            return Ok(());
        }
        Err(StepError::NoSolution(format!(
            "the contact carries {carried} of a prescribed normal force of {prescribed}: its pressure is not solved; \
             check load, shapes and limits of the pressure, or choose another mech.model",
            carried = quantity(carried, "N", 7),
            prescribed = quantity(prescribed, "N", 7)
        )))
    }
}

/// A contact that is solved in time windows.
pub(super) trait Contact {
    /// A solved window: everything that fields, figures and the next window need.
    type Window;

    /// Solves a window with these inputs, starting from the accepted one. `spent` is a discarded
    /// window: its allocated memory may be reused, its values may not.
    ///
    /// # Errors
    /// A contact without solution; an input that is missing.
    fn solve(
        &mut self,
        step: &Step,
        inputs: &dyn Inputs,
        accepted: Option<&Self::Window>,
        spent: Option<Self::Window>,
    ) -> Result<Self::Window, StepError>;

    /// Returns whether a solved window is also the solution of this step.
    fn solves(&self, _window: &Self::Window, _step: &Step) -> bool {
        false
    }

    /// Window whose fields hold before the first solve, if it is known without inputs.
    fn first(&mut self) -> Option<Self::Window> {
        None
    }

    /// Prescribed and carried normal forces of a window, one for each wheel. Every solution is
    /// refused that does not carry its load. Empty where no force is prescribed, where the force
    /// defines the pressure in closed form, or where inertia takes a part of it.
    fn loads(&self, _window: &Self::Window) -> Vec<CarriedLoad> {
        Vec::new()
    }

    /// Speeds of the upper and the lower surface if no first window is known [m/s]; all other
    /// fields are zero then.
    fn first_speeds(&self) -> [f64; 2] {
        [0.0; 2]
    }

    /// Cost of solving the window.
    fn report(&self, window: &Self::Window) -> StepReport;

    /// Writes a field of the contact, component-major; leaves fields of observations unchanged.
    fn write(&self, window: &Self::Window, spec: &FieldSpec, values: &mut [f64]);

    /// Checks whether the window may be accepted.
    ///
    /// # Errors
    /// The reason why it may not.
    fn acceptable(&self, _window: &Self::Window) -> Result<(), StepError> {
        Ok(())
    }

    /// Makes the window the accepted state of the contact itself; the terms are updated afterwards.
    fn accept(&mut self, _window: &Self::Window) {}

    /// Writes the observations of the accepted window.
    fn observe(&mut self, _window: &Self::Window, _outputs: &mut dyn Outputs) {}

    /// Sections of `summary.json`.
    fn summary(&self, window: &Self::Window) -> Value;

    /// Terms of the active effects, which have their own states.
    fn terms(&self) -> &Terms;

    /// Mutable access to the terms of the active effects.
    fn terms_mut(&mut self) -> &mut Terms;

    /// Writes the accepted window, if the next one depends on it.
    ///
    /// # Errors
    /// Errors of the writer `into`.
    fn save(&self, _accepted: Option<&Self::Window>, _into: &mut dyn Write) -> io::Result<()> {
        Ok(())
    }

    /// Reads the state written by [`Contact::save`].
    ///
    /// # Errors
    /// A state that does not fit or ends too early.
    fn restore(&mut self, _from: &mut dyn Read) -> Result<Option<Self::Window>, StateError> {
        Ok(None)
    }
}

/// Model that runs a contact.
pub(super) struct ContactModel<C: Contact> {
    contact: C,
    /// Last solved window, unless the accepted window already is its solution.
    trial: Option<C::Window>,
    accepted: Option<C::Window>,
    /// Discarded window whose allocated memory can be reused.
    spent: Option<C::Window>,
}

impl<C: Contact> ContactModel<C> {
    pub(super) fn new(contact: C) -> Self {
        Self { contact, trial: None, accepted: None, spent: None }
    }

    /// Last solved window; before any solve, the first window.
    fn last(&self) -> Option<&C::Window> {
        self.trial.as_ref().or(self.accepted.as_ref())
    }

    /// Writes the requested fields of the contact.
    fn write(contact: &C, window: &C::Window, outputs: &mut dyn Outputs) {
        for spec in field::TABLE {
            if let Some(values) = outputs.get(spec) {
                contact.write(window, spec, values);
            }
        }
    }
}

impl<C: Contact> Model for ContactModel<C> {
    fn solve(
        &mut self,
        step: &Step,
        inputs: &dyn Inputs,
        outputs: &mut dyn Outputs,
    ) -> Result<StepReport, StepError> {
        let Self { contact, trial, accepted, spent } = self;
        if !trial.as_ref().is_some_and(|window| contact.solves(window, step)) {
            let memory = trial.take().or(spent.take());
            if !accepted.as_ref().is_some_and(|window| contact.solves(window, step)) {
                let window = contact.solve(step, inputs, accepted.as_ref(), memory)?;
                contact.loads(&window).into_iter().try_for_each(CarriedLoad::check)?;
                *trial = Some(window);
            }
        }
        let window = trial.as_ref().or(accepted.as_ref()).expect("one of them answers");
        Self::write(contact, window, outputs);
        Ok(contact.report(window))
    }

    fn first_outputs(&mut self, outputs: &mut dyn Outputs) {
        self.trial = self.contact.first();
        if let Some(window) = &self.trial {
            return Self::write(&self.contact, window, outputs);
        }
        let speeds = self.contact.first_speeds();
        for spec in field::TABLE {
            if let Some(values) = outputs.get(spec) {
                match *spec {
                    field::SURFACE_SPEED => values.copy_from_slice(&speeds),
                    _ => values.fill(0.0),
                }
            }
        }
    }

    fn acceptable(&self) -> Result<(), StepError> {
        self.last().map_or(Ok(()), |window| self.contact.acceptable(window))
    }

    fn accept(&mut self) {
        if let Some(window) = self.trial.take() {
            self.spent = self.accepted.replace(window);
        }
        if let Some(window) = &self.accepted {
            self.contact.accept(window);
        }
        self.contact.terms_mut().accept();
    }

    fn observe(&mut self, outputs: &mut dyn Outputs) {
        if let Some(window) = &self.accepted {
            Self::write(&self.contact, window, outputs);
            self.contact.observe(window, outputs);
        }
    }

    fn summary(&self) -> Value {
        // A window that was refused leaves no figures.
        let shown = self.accepted.as_ref().or(self.trial.as_ref());
        shown.map_or_else(|| json!({}), |window| self.contact.summary(window))
    }

    fn save(&self, into: &mut dyn Write) -> io::Result<()> {
        self.contact.terms().save(into)?;
        self.contact.save(self.accepted.as_ref(), into)
    }

    fn restore(&mut self, from: &mut dyn Read) -> Result<(), StateError> {
        self.contact.terms_mut().restore(from)?;
        self.accepted = self.contact.restore(from)?;
        self.trial = None;
        Ok(())
    }
}

/// Empty inputs.
pub(super) struct Nothing;

impl Inputs for Nothing {
    fn get(&self, _: &FieldSpec) -> Option<InputField<'_>> {
        None
    }
}

/// Writes the two components of a vector field one after the other.
pub(super) fn write_pair(values: &mut [f64], [x, y]: &[Vec<f64>; 2]) {
    let (first, second) = values.split_at_mut(x.len());
    first.copy_from_slice(x);
    second.copy_from_slice(y);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_does_not_carry_its_load_is_refused_with_both_forces() {
        let check = |prescribed: f64, carried: f64| CarriedLoad { prescribed, carried }.check();
        assert_eq!(check(1800.0, 1800.0 * (1.0 + 1e-5)), Ok(()));
        assert_eq!(check(0.0, 0.0), Ok(()));
        let message = check(1800.0, 1775.8).unwrap_err().to_string();
        assert!(
            message.contains("carries 1.775800 kN of a prescribed normal force of 1.800000 kN"),
            "{message}"
        );
        assert!(check(1800.0, f64::NAN).is_err());
    }
}
