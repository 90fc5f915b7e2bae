//! An instance: its variables, its windows, and its states.

use super::child::{Coordinator, Fault};
use super::evaluator::Evaluator;
use super::manifest::{Manifest, Of, Variable};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// What gives the outputs, with the values of all variables.
#[derive(Debug)]
pub struct Instance {
    resources: PathBuf,
    manifest: Manifest,
    source: Source,
    values: Values,
}

/// The coordinator of a run, which its states refer to as well.
type SharedCoordinator = Arc<Mutex<Coordinator>>;

fn lock(coordinator: &Mutex<Coordinator>) -> MutexGuard<'_, Coordinator> {
    coordinator.lock().unwrap_or_else(PoisonError::into_inner)
}

/// What gives the outputs.
#[derive(Debug)]
enum Source {
    /// The run of a case; absent before it is started.
    Run(Option<SharedCoordinator>),
    /// A surrogate, which has no state: outputs are those of the inputs at any time.
    Surrogate(Box<Evaluator>),
}

/// The values of all variables.
#[derive(Clone, Debug, PartialEq)]
struct Values {
    time: f64,
    inputs: Vec<f64>,
    /// NaN for those that there are not, as before the first window of a run.
    outputs: Vec<f64>,
    /// The outputs have been computed: a window of a run has been solved, a surrogate was asked for these inputs.
    known: bool,
}

/// A state of an instance, which can be returned to for as long as it is there.
#[derive(Debug)]
pub struct State {
    values: Values,
    /// The coordinator that keeps it, and its number there; absent: before the first window.
    kept: Option<(SharedCoordinator, u64)>,
}

impl Drop for State {
    fn drop(&mut self) {
        if let Some((coordinator, number)) = &self.kept {
            // Of a run that has ended all states are gone.
            let _ = lock(coordinator).free(*number);
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
        let source = match &manifest.of {
            Of::Case { .. } => Source::Run(None),
            Of::Surrogate => Source::Surrogate(Box::new(Evaluator::read(resources, &manifest)?)),
        };
        let values = Values::first(&manifest);
        Ok(Self { resources: resources.to_owned(), manifest, source, values })
    }

    /// It has neither windows nor a state: outputs follow from the inputs alone.
    #[must_use]
    pub fn is_algebraic(&self) -> bool {
        matches!(self.source, Source::Surrogate(_))
    }

    /// A new run from the beginning: of the same processes, unless the run before has failed.
    pub fn reset(&mut self) {
        if let Source::Run(run) = &mut self.source {
            // A state that is kept holds the run that it is of.
            let again =
                |run: &SharedCoordinator| Arc::strong_count(run) == 1 && lock(run).reset().is_ok();
            *run = run.take().filter(again);
        }
        self.values = Values::first(&self.manifest);
    }

    /// Sets the time [s].
    ///
    /// # Errors
    /// It is not finite.
    pub fn set_time(&mut self, time: f64) -> Result<(), String> {
        if !time.is_finite() {
            return Err(format!("the time is {time}, not a finite number"));
        }
        self.values.time = time;
        Ok(())
    }

    /// Starts the run of a case, so that what is wrong with it comes to light before its first window.
    ///
    /// # Errors
    /// It does not start.
    pub fn start(&mut self) -> Result<(), Fault> {
        self.running().map(drop)
    }

    /// The run of a case, which is started where there is none yet; `None` for a surrogate.
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

    /// Brings the outputs of a surrogate up to date with the inputs. Returns what there is to remark: the point is
    /// outside of the surrogate, and all outputs are NaN. It is remarked once for a point.
    pub fn refresh(&mut self) -> Option<String> {
        let Source::Surrogate(evaluator) = &mut self.source else { return None };
        let Values { inputs, outputs, known, .. } = &mut self.values;
        if std::mem::replace(known, true) {
            return None;
        }
        let refused = evaluator.figures(inputs, outputs).err()?;
        Some(format!("{refused}; all outputs are NaN"))
    }

    /// Whether a variable is an output.
    #[must_use]
    pub fn is_output(&self, reference: u32) -> bool {
        matches!(self.manifest.variable(reference), Some(Variable::Output(_)))
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
    /// There is none of this reference, in words. Limits are judged with the window, or when an output is read.
    pub fn set(&mut self, reference: u32, value: f64) -> Result<(), String> {
        match self.manifest.variable(reference) {
            Some(Variable::Input(place)) => {
                self.values.inputs[place] = value;
                self.values.known &= !self.is_algebraic();
                Ok(())
            }
            Some(_) => Err(format!("the variable {reference} is no input")),
            None => Err(format!("there is no variable {reference}")),
        }
    }

    /// Solves the window from the time of the instance to `start + duration` [s]; of a surrogate only the time changes.
    /// Returns the new time.
    ///
    /// # Errors
    /// The times are not finite, the window has no answer, or the run has ended.
    pub fn step(&mut self, start: f64, duration: f64) -> Result<f64, Fault> {
        let end = start + duration;
        // The coordinator would take such an end, which JSON does not have, for one that is not given.
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

    /// Keeps the state.
    ///
    /// # Errors
    /// It cannot be kept, or the run has ended.
    pub fn save(&mut self) -> Result<State, Fault> {
        let values = self.values.clone();
        // Before its first window a run has no state that another start would not give.
        let kept = match &self.source {
            Source::Run(Some(coordinator)) if self.values.known => {
                let number = lock(coordinator).save()?;
                Some((Arc::clone(coordinator), number))
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

    /// Bytes of a state of a surrogate: the time and the inputs, as little-endian doubles.
    #[must_use]
    pub fn serialised(&self, state: &State) -> Option<Vec<u8>> {
        let Values { time, inputs, .. } = &state.values;
        let bytes = [time].into_iter().chain(inputs).flat_map(|value| value.to_le_bytes());
        self.is_algebraic().then(|| bytes.collect())
    }

    /// The state of such bytes.
    ///
    /// # Errors
    /// It is the run of a case, or they are too many or too few; in words.
    pub fn deserialised(&self, bytes: &[u8]) -> Result<State, String> {
        let (values, rest) = bytes.as_chunks();
        let expected = 1 + self.manifest.inputs.len();
        if !self.is_algebraic() || !rest.is_empty() || values.len() != expected {
            let given = bytes.len();
            return Err(format!(
                "{given} bytes are no state of this FMU, which has {}",
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
    /// Before the first window.
    fn first(manifest: &Manifest) -> Self {
        Self {
            time: 0.0,
            inputs: manifest.inputs.iter().map(|input| input.start).collect(),
            outputs: vec![f64::NAN; manifest.outputs.len()],
            known: false,
        }
    }
}
