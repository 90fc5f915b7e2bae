//! Instance of the FMU: variables, windows and states.

use super::child::{Coordinator, Fault};
use super::evaluator::Evaluator;
use super::manifest::{Manifest, Of, Variable};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Instance: the source of the outputs, with the values of all variables.
#[derive(Debug)]
pub struct Instance {
    resources: PathBuf,
    manifest: Manifest,
    source: Source,
    values: Values,
}

/// Coordinator of a run, shared with the saved states of the run.
type SharedCoordinator = Arc<Mutex<Coordinator>>;

fn lock(coordinator: &Mutex<Coordinator>) -> MutexGuard<'_, Coordinator> {
    coordinator.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Source of the outputs.
#[derive(Debug)]
enum Source {
    /// Run of a case; `None` before the start.
    Run(Option<SharedCoordinator>),
    /// Surrogate. It has no state: the outputs depend on the inputs only, at any time.
    Surrogate(Box<Evaluator>),
}

/// Values of all variables.
#[derive(Clone, Debug, PartialEq)]
struct Values {
    time: f64,
    inputs: Vec<f64>,
    /// NaN marks an output without a value, as before the first window of a run.
    outputs: Vec<f64>,
    /// True if the outputs are up to date: the window of a run is solved, or the surrogate was
    /// evaluated at these inputs.
    known: bool,
}

/// Saved state of an instance.
#[derive(Debug)]
pub struct State {
    values: Values,
    /// Coordinator that holds the state, and the number of the state there; `None` before the first
    /// window.
    kept: Option<(SharedCoordinator, u64)>,
}

impl Drop for State {
    fn drop(&mut self) {
        if let Some((coordinator, number)) = &self.kept {
            // A run that has ended has already lost its states.
            let _ = lock(coordinator).free(*number);
        }
    }
}

impl Instance {
    /// Creates an instance of the FMU with these resources and this token. Starts no process.
    ///
    /// # Errors
    /// Fails if the resources are not those of an FMU of this library, or the token differs.
    pub fn new(resources: &Path, token: &str) -> Result<Self, String> {
        let manifest = Manifest::read(resources)?;
        if manifest.token != token {
            let of = &manifest.token;
            return Err(format!("the host passed the token {token}, the FMU has the token {of}"));
        }
        let source = match &manifest.of {
            Of::Case { .. } => Source::Run(None),
            Of::Surrogate => Source::Surrogate(Box::new(Evaluator::read(resources, &manifest)?)),
        };
        let values = Values::first(&manifest);
        Ok(Self { resources: resources.to_owned(), manifest, source, values })
    }

    /// True if the outputs follow from the inputs alone, without windows and states.
    #[must_use]
    pub fn is_algebraic(&self) -> bool {
        matches!(self.source, Source::Surrogate(_))
    }

    /// Starts again from the beginning. Keeps the processes of the run, unless the run has failed.
    pub fn reset(&mut self) {
        if let Source::Run(run) = &mut self.source {
            // Saved states need the coordinator that holds them, so that a shared coordinator is
            // not reset.
            let again =
                |run: &SharedCoordinator| Arc::strong_count(run) == 1 && lock(run).reset().is_ok();
            *run = run.take().filter(again);
        }
        self.values = Values::first(&self.manifest);
    }

    /// Sets the time [s].
    ///
    /// # Errors
    /// Fails if the time is not finite.
    pub fn set_time(&mut self, time: f64) -> Result<(), String> {
        if !time.is_finite() {
            return Err(format!("the time is {time}, not a finite number"));
        }
        self.values.time = time;
        Ok(())
    }

    /// Starts the run of a case, to detect errors before the first window.
    ///
    /// # Errors
    /// Fails if the run does not start.
    pub fn start(&mut self) -> Result<(), Fault> {
        self.running().map(drop)
    }

    /// Returns the run of a case, started on the first call; `None` for a surrogate.
    fn running(&mut self) -> Result<Option<SharedCoordinator>, Fault> {
        let (Source::Run(run), Of::Case { options, programs }) =
            (&mut self.source, &self.manifest.of)
        else {
            return Ok(None);
        };
        if run.is_none() {
            let outputs = self.manifest.outputs.len();
            let started = Coordinator::start(&self.resources, (options, programs), outputs)?;
            *run = Some(Arc::new(Mutex::new(started)));
        }
        Ok(run.clone())
    }

    /// Brings the outputs of a surrogate up to date with the inputs. If the point lies outside the
    /// surrogate's region, all outputs become NaN and a warning is returned, once a point.
    pub fn refresh(&mut self) -> Option<String> {
        let Source::Surrogate(evaluator) = &mut self.source else { return None };
        let Values { inputs, outputs, known, .. } = &mut self.values;
        if std::mem::replace(known, true) {
            return None;
        }
        let refused = evaluator.figures(inputs, outputs).err()?;
        Some(format!("{refused}; all outputs are NaN"))
    }

    /// True if the variable is an output.
    #[must_use]
    pub fn is_output(&self, reference: u32) -> bool {
        matches!(self.manifest.variable(reference), Some(Variable::Output(_)))
    }

    /// Returns the value of a variable; `None` if no variable has this reference.
    #[must_use]
    pub fn value(&self, reference: u32) -> Option<f64> {
        let Values { time, inputs, outputs, .. } = &self.values;
        Some(match self.manifest.variable(reference)? {
            Variable::Time => *time,
            Variable::Input(place) => inputs[place],
            Variable::Output(place) => outputs[place],
        })
    }

    /// Sets the value of an input.
    ///
    /// # Errors
    /// Fails if no input has this reference. Limits are checked later: by the next window, or when
    /// an output is read.
    pub fn set(&mut self, reference: u32, value: f64) -> Result<(), String> {
        match self.manifest.variable(reference) {
            Some(Variable::Input(place)) => {
                self.values.inputs[place] = value;
                self.values.known &= !self.is_algebraic();
                Ok(())
            }
            Some(_) => Err(format!("the variable {reference} is not an input")),
            None => Err(format!("there is no variable {reference}")),
        }
    }

    /// Solves the window from the time of the instance to `start + duration` [s]; a surrogate
    /// changes only its time. Returns the new time.
    ///
    /// # Errors
    /// Fails if a time or an input is not finite, the window has no solution, or the run has ended.
    pub fn step(&mut self, start: f64, duration: f64) -> Result<f64, Fault> {
        let end = start + duration;
        // JSON has no infinite numbers: the coordinator would treat such an end as absent.
        if !end.is_finite() {
            let error =
                format!("a step of {duration} s at {start} s does not end at a finite time");
            return Err(Fault { error, ended: false });
        }
        let Some(coordinator) = self.running()? else {
            self.values.time = end;
            return Ok(end);
        };
        let keys = self.manifest.inputs.iter().map(|input| input.key.as_str());
        let set: BTreeMap<&str, f64> = keys.zip(self.values.inputs.iter().copied()).collect();
        if let Some((key, value)) = set.iter().find(|(_, value)| !value.is_finite()) {
            let error = format!("`{key}` is {value}, not a finite number");
            return Err(Fault { error, ended: false });
        }
        self.values.outputs = lock(&coordinator).step(&set, end)?;
        (self.values.time, self.values.known) = (end, true);
        Ok(end)
    }

    /// Saves the state.
    ///
    /// # Errors
    /// Fails if the coordinator cannot save the state or the run has ended.
    pub fn save(&mut self) -> Result<State, Fault> {
        let values = self.values.clone();
        // Before its first window, a new start reproduces the state of a run.
        let kept = match &self.source {
            Source::Run(Some(coordinator)) if self.values.known => {
                let number = lock(coordinator).save()?;
                Some((Arc::clone(coordinator), number))
            }
            _ => None,
        };
        Ok(State { values, kept })
    }

    /// Restores a saved state.
    ///
    /// # Errors
    /// Fails if the run of the state has ended.
    pub fn restore(&mut self, state: &State) -> Result<(), Fault> {
        if let Source::Run(run) = &mut self.source {
            match &state.kept {
                Some((coordinator, number)) => {
                    lock(coordinator).restore(*number)?;
                    *run = Some(Arc::clone(coordinator));
                }
                None if self.values.known => *run = None,
                None => {}
            }
        }
        self.values = state.values.clone();
        Ok(())
    }

    /// Serialises a state of a surrogate: the time and the inputs, as little-endian doubles.
    /// Returns `None` for the run of a case.
    #[must_use]
    pub fn serialised(&self, state: &State) -> Option<Vec<u8>> {
        let Values { time, inputs, .. } = &state.values;
        let bytes = [time].into_iter().chain(inputs).flat_map(|value| value.to_le_bytes());
        self.is_algebraic().then(|| bytes.collect())
    }

    /// Reads a serialised state.
    ///
    /// # Errors
    /// Fails for the run of a case, or if the number of bytes is wrong.
    pub fn deserialised(&self, bytes: &[u8]) -> Result<State, String> {
        let (values, rest) = bytes.as_chunks();
        let expected = 1 + self.manifest.inputs.len();
        if !self.is_algebraic() || !rest.is_empty() || values.len() != expected {
            let given = bytes.len();
            return Err(format!(
                "{given} bytes are not a state of this FMU; expected {}",
                8 * expected
            ));
        }
        let mut values = values.iter().map(|bytes| f64::from_le_bytes(*bytes));
        let mut state = State { values: Values::first(&self.manifest), kept: None };
        state.values.time = values.next().unwrap_or_default();
        state.values.inputs = values.collect();
        Ok(state)
    }
}

impl Values {
    /// Values before the first window.
    fn first(manifest: &Manifest) -> Self {
        Self {
            time: 0.0,
            inputs: manifest.inputs.iter().map(|input| input.start).collect(),
            outputs: vec![f64::NAN; manifest.outputs.len()],
            known: false,
        }
    }
}
