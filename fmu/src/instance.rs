//! An instance: its variables, its windows, and its states.

use super::child::{Coordinator, Fault};
use super::manifest::{Manifest, Variable};
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::rc::Rc;

/// A run with the values of its variables.
#[derive(Debug)]
pub struct Instance {
    resources: PathBuf,
    manifest: Manifest,
    /// Absent before the first window.
    coordinator: Option<Rc<RefCell<Coordinator>>>,
    values: Values,
}

/// The values of all variables.
#[derive(Clone, Debug, PartialEq)]
struct Values {
    time: f64,
    inputs: Vec<f64>,
    /// NaN for those that there are not, as before the first window.
    outputs: Vec<f64>,
    /// A window has been solved.
    stepped: bool,
}

/// A state of an instance, which can be returned to for as long as it is there.
#[derive(Debug)]
pub struct State {
    values: Values,
    /// The coordinator that keeps it, and its number there; absent: before the first window.
    kept: Option<(Rc<RefCell<Coordinator>>, u64)>,
}

impl Drop for State {
    fn drop(&mut self) {
        if let Some((coordinator, number)) = &self.kept {
            // Of a run that has ended all states are gone.
            let _ = coordinator.borrow_mut().free(*number);
        }
    }
}

impl Instance {
    /// An instance of the FMU with these resources and this token; nothing is started yet.
    ///
    /// # Errors
    /// They are not those of an FMU of this library, or of another one; in words.
    pub fn new(resources: &Path, token: &str) -> Result<Self, String> {
        let manifest = Manifest::read(resources)?;
        if manifest.token != token {
            let of = &manifest.token;
            return Err(format!("the FMU was asked for with the token {token}, and has {of}"));
        }
        let values = Values::first(&manifest);
        Ok(Self { resources: resources.to_owned(), manifest, coordinator: None, values })
    }

    /// A new run from the beginning.
    pub fn reset(&mut self) {
        self.coordinator = None;
        self.values = Values::first(&self.manifest);
    }

    /// The time of the beginning [s].
    pub fn begin_at(&mut self, time: f64) {
        self.values.time = time;
    }

    /// Starts the run, so that what is wrong with the case comes to light before its first window.
    ///
    /// # Errors
    /// It does not start.
    pub fn start(&mut self) -> Result<(), Fault> {
        self.running().map(drop)
    }

    fn running(&mut self) -> Result<Rc<RefCell<Coordinator>>, Fault> {
        if let Some(coordinator) = &self.coordinator {
            return Ok(Rc::clone(coordinator));
        }
        let coordinator = Coordinator::start(&self.resources, &self.manifest)?;
        let coordinator = Rc::new(RefCell::new(coordinator));
        self.coordinator = Some(Rc::clone(&coordinator));
        Ok(coordinator)
    }

    /// The value of a variable; `None` if there is none of this reference.
    #[must_use]
    pub fn value(&self, reference: u32) -> Option<f64> {
        let Values { time, inputs, outputs, .. } = &self.values;
        Some(match self.manifest.variable(reference)? {
            Variable::Time => *time,
            Variable::Input(place) => inputs[place],
            Variable::Output(place) => outputs[place],
        })
    }

    /// Gives the value of an input.
    ///
    /// # Errors
    /// There is none of this reference, in words. Limits are judged with the window.
    pub fn set(&mut self, reference: u32, value: f64) -> Result<(), String> {
        match self.manifest.variable(reference) {
            Some(Variable::Input(place)) => {
                self.values.inputs[place] = value;
                Ok(())
            }
            Some(_) => Err(format!("the variable {reference} is no input")),
            None => Err(format!("there is no variable {reference}")),
        }
    }

    /// Solves the window from the time of the instance to another one [s].
    ///
    /// # Errors
    /// The window has no answer, or the run has ended.
    pub fn step(&mut self, end: f64) -> Result<(), Fault> {
        let coordinator = self.running()?;
        let keys = self.manifest.inputs.iter().map(|input| input.key.as_str());
        let set: BTreeMap<&str, f64> = keys.zip(self.values.inputs.iter().copied()).collect();
        if let Some((key, value)) = set.iter().find(|(_, value)| !value.is_finite()) {
            let error = format!("`{key}` is {value}, not a finite number");
            return Err(Fault { error, ended: false });
        }
        self.values.outputs = coordinator.borrow_mut().step(&set, end)?;
        (self.values.time, self.values.stepped) = (end, true);
        Ok(())
    }

    /// Keeps the state.
    ///
    /// # Errors
    /// It cannot be kept, or the run has ended.
    pub fn save(&mut self) -> Result<State, Fault> {
        let values = self.values.clone();
        // Before its first window a run has no state that another start would not give.
        let kept = match &self.coordinator {
            Some(coordinator) if self.values.stepped => {
                let number = coordinator.borrow_mut().save()?;
                Some((Rc::clone(coordinator), number))
            }
            _ => None,
        };
        Ok(State { values, kept })
    }

    /// Returns to a state.
    ///
    /// # Errors
    /// Its run has ended.
    pub fn restore(&mut self, state: &State) -> Result<(), Fault> {
        match &state.kept {
            Some((coordinator, number)) => {
                coordinator.borrow_mut().restore(*number)?;
                self.coordinator = Some(Rc::clone(coordinator));
            }
            None if self.values.stepped => self.coordinator = None,
            None => {}
        }
        self.values = state.values.clone();
        Ok(())
    }
}

impl Values {
    /// Before the first window.
    fn first(manifest: &Manifest) -> Self {
        Self {
            time: 0.0,
            inputs: manifest.inputs.iter().map(|input| input.start).collect(),
            outputs: vec![f64::NAN; manifest.outputs.len()],
            stepped: false,
        }
    }
}
