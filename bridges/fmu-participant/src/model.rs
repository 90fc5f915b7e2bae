//! Running FMU: each window is one communication step.
//!
//! A solve restores the accepted state if a step was taken since, sets the inputs, takes the step
//! and reads the outputs. Inputs are constant over a step: an input that varies within the window
//! is set to its mean.

use crate::description::{ModelDescription, Version};
use crate::figures::Figures;
use crate::fmi2::Fmi2;
use crate::fmi3::Fmi3;
use crate::placed::{Placed, PlacedGive, PlacedTake};
use crate::slave::{Experiment, Fault, Kept, Slave};
use crate::variable::Variable;
use crate::wiring::Measure;
use proto::grid::Grid;
use proto::model::{
    InputField, Inputs, Model, Outputs, StateError, Step, StepError, StepReport, first_non_finite,
};
use serde_json::{Map, Value};
use std::cell::RefCell;
use std::io::{self, Read, Write};
use std::path::Path;

/// Relative difference between window lengths that counts as rounding: times are sums starting from
/// 0.
const ROUNDING: f64 = 1e-9;
/// Maximum size of a state that is read back [byte].
const LARGEST_STATE: u64 = 1 << 36;

/// Parts of a model.
pub struct Parts<'a> {
    /// Role of the participant.
    pub role: &'a str,
    /// Model description of the FMU.
    pub description: &'a ModelDescription,
    /// Outputs that are figures.
    pub figures: &'a [Figures],
    /// Values of parameters, in the units of the FMU.
    pub starts: &'a [(Variable, Vec<f64>)],
    /// Exchanged fields, with their grids.
    pub placed: Placed,
    /// End of the run \[s\]; `None` if whoever drives the run chooses it.
    pub end: Option<f64>,
}

/// Values read from the FMU after a step.
#[derive(Clone, Debug, Default)]
struct Answer {
    /// Values of each requested output, in SI units.
    given: Vec<Vec<f64>>,
    /// Values of each variable that is a figure, in SI units.
    figures: Vec<Vec<f64>>,
}

/// Running FMU as a model.
pub struct Running {
    role: String,
    slave: RefCell<Box<dyn Slave>>,
    placed: Placed,
    figures: Vec<Figures>,
    /// Accepted state; `None` if the FMU cannot save states.
    state: Option<Kept>,
    /// True if the FMU has stepped beyond the accepted state.
    moved: bool,
    /// True if communication steps may differ in length.
    varies_step: bool,
    /// Length of the first step [s].
    first_step: Option<f64>,
    trial: Answer,
    accepted: Answer,
    /// Error of saving the last accepted state, reported by the next solve.
    late: Option<Fault>,
    /// Buffer of values sent to the FMU.
    way: Vec<f64>,
}

impl Running {
    /// Starts the FMU unpacked in `folder`.
    ///
    /// # Errors
    /// Fails if the FMU creates no instance, or a function of the FMU returns an error.
    pub fn new(folder: &Path, parts: Parts<'_>) -> Result<Self, String> {
        let Parts { role, description, figures, starts, placed, end } = parts;
        let mut slave: Box<dyn Slave> = match description.version {
            Version::Two => Box::new(Fmi2::new(folder, description, role)?),
            Version::Three => Box::new(Fmi3::new(folder, description, role)?),
        };
        let told = |fault: Fault| fault.to_string();
        starts.iter().try_for_each(|(of, values)| slave.set(of, values)).map_err(told)?;
        if description.start_time != 0.0 {
            let start = description.start_time;
            tracing::warn!(
                "{role}: the FMU proposes to start at {start} s; its time begins at 0 s"
            );
        }
        let experiment = Experiment { stop: end, tolerance: description.tolerance };
        slave.start(&experiment).map_err(told)?;
        let mut state = description.keeps_states.then_some(Kept(std::ptr::null_mut()));
        state.iter_mut().try_for_each(|state| slave.keep(state)).map_err(told)?;
        let room = |variables: &[Variable]| vec![0.0; variables.iter().map(|one| one.size).sum()];
        let trial = Answer {
            given: placed.gives.iter().map(|placed| room(&placed.give.variables)).collect(),
            figures: figures.iter().map(|one| vec![0.0; one.variable.size]).collect(),
        };
        let mut model = Self {
            role: role.to_owned(),
            slave: RefCell::new(slave),
            placed,
            figures: figures.to_vec(),
            state,
            moved: false,
            varies_step: description.varies_step,
            first_step: None,
            accepted: trial.clone(),
            trial,
            late: None,
            way: Vec::new(),
        };
        model.read().map_err(|error| error.to_string())?;
        model.accepted.clone_from(&model.trial);
        Ok(model)
    }

    /// Restores the accepted state.
    fn go_back(&mut self) -> Result<(), StepError> {
        if !self.moved {
            return Ok(());
        }
        let Some(state) = &self.state else {
            return Err(StepError::NoSolution(
                "the FMU cannot restore a state to solve a window again (canGetAndSetFMUstate)"
                    .to_owned(),
            ));
        };
        self.slave.get_mut().return_to(state).map_err(failed)?;
        self.moved = false;
        Ok(())
    }

    /// Rejects a step whose length differs from the first one, if the FMU requires constant steps.
    fn check_length(&mut self, length: f64) -> Result<(), StepError> {
        let first = *self.first_step.get_or_insert(length);
        match self.varies_step || (length - first).abs() <= ROUNDING * first {
            true => Ok(()),
            false => Err(StepError::NoSolution(format!(
                "the FMU requires steps of constant length {first} s, got {length} s (canHandleVariableCommunicationStepSize)"
            ))),
        }
    }

    /// Sets the inputs. Returns the power received through densities [W]; `None` if no input is a
    /// density.
    fn set(&mut self, inputs: &dyn Inputs) -> Result<Option<f64>, StepError> {
        let mut heat = None;
        for placed in &self.placed.takes {
            let PlacedTake { take, conservative, components } = placed;
            let name = || take.spec.name.to_owned();
            let missing = || StepError::MissingInput { field: name() };
            let InputField { values, grid } = inputs.get(&take.spec).ok_or_else(missing)?;
            if let Some(index) = first_non_finite(values) {
                return Err(StepError::NonFiniteInput {
                    field: name(),
                    index,
                    value: values[index],
                });
            }
            let start = inputs.start(&take.spec);
            measure(take.measure, (values, start), grid, *components, &mut self.way);
            if *conservative && *components == 1 {
                *heat.get_or_insert(0.0) += grid.integrate(values);
            }
            pass_on(&mut **self.slave.get_mut(), &take.variables, &mut self.way)?;
        }
        Ok(heat)
    }

    /// Reads outputs and figures.
    fn read(&mut self) -> Result<(), StepError> {
        let slave = self.slave.get_mut();
        for (placed, values) in self.placed.gives.iter().zip(&mut self.trial.given) {
            let mut rest = &mut values[..];
            for variable in &placed.give.variables {
                let (own, others) = rest.split_at_mut(variable.size);
                slave.get(variable, own).map_err(failed)?;
                in_si(variable, own);
                if let Some(place) = first_non_finite(own) {
                    let (name, value) = (&variable.name, own[place]);
                    return Err(StepError::NoSolution(format!(
                        "the FMU returned {value} for `{name}`"
                    )));
                }
                rest = others;
            }
        }
        for (figures, values) in self.figures.iter().zip(&mut self.trial.figures) {
            slave.get(&figures.variable, values).map_err(failed)?;
            in_si(&figures.variable, values);
        }
        Ok(())
    }

    fn write(&self, answer: &Answer, outputs: &mut dyn Outputs) {
        for (PlacedGive { give, uniform }, values) in self.placed.gives.iter().zip(&answer.given) {
            let Some(place) = outputs.get(&give.spec) else { continue };
            match uniform {
                false => place.copy_from_slice(values),
                true => {
                    let points = place.len() / values.len();
                    let components = place.chunks_exact_mut(points).zip(values);
                    components.for_each(|(component, value)| component.fill(*value));
                }
            }
        }
    }
}

fn failed(fault: Fault) -> StepError {
    StepError::NoSolution(fault.to_string())
}

fn in_si(variable: &Variable, values: &mut [f64]) {
    if !variable.unit.is_si() {
        values.iter_mut().for_each(|value| *value = variable.unit.to_si(*value));
    }
}

/// Computes the values of a field for the FMU: all values, surface integral or mean. If the field
/// has values at the start of the window, the mean of start and end is used.
fn measure(
    measure: Measure,
    (values, start): (&[f64], Option<&[f64]>),
    grid: &Grid,
    components: usize,
    into: &mut Vec<f64>,
) {
    into.clear();
    let points = values.len() / components;
    let area = match measure {
        Measure::Mean => grid.areas().iter().sum(),
        _ => 1.0,
    };
    let over = |values: &[f64]| grid.integrate(values) / area;
    match measure {
        Measure::Values => into.extend_from_slice(values),
        _ => into.extend(values.chunks_exact(points).map(over)),
    }
    let Some(start) = start else { return };
    let halve = |value: &mut f64, first: f64| *value = 0.5 * (*value + first);
    match measure {
        Measure::Values => {
            into.iter_mut().zip(start).for_each(|(value, first)| halve(value, *first))
        }
        _ => into
            .iter_mut()
            .zip(start.chunks_exact(points))
            .for_each(|(value, first)| halve(value, over(first))),
    }
}

/// Sets variables one after the other to values in SI units.
fn pass_on(
    slave: &mut dyn Slave,
    variables: &[Variable],
    values: &mut [f64],
) -> Result<(), StepError> {
    let found = values.len();
    let mut rest = values;
    for variable in variables {
        let Some((own, others)) = rest.split_at_mut_checked(variable.size) else {
            return Err(StepError::NoSolution(format!(
                "{found} values are fewer than the FMU expects"
            )));
        };
        if !variable.unit.is_si() {
            own.iter_mut().for_each(|value| *value = variable.unit.in_own(*value));
        }
        slave.set(variable, own).map_err(failed)?;
        rest = others;
    }
    match rest.len() {
        0 => Ok(()),
        _ => Err(StepError::NoSolution(format!("{found} values are more than the FMU expects"))),
    }
}

impl Model for Running {
    fn solve(
        &mut self,
        step: &Step,
        inputs: &dyn Inputs,
        outputs: &mut dyn Outputs,
    ) -> Result<StepReport, StepError> {
        if let Some(fault) = self.late.take() {
            return Err(failed(fault));
        }
        self.check_length(step.duration())?;
        self.go_back()?;
        let received_power = self.set(inputs)?;
        self.moved = true;
        self.slave.get_mut().step(step.start, step.duration()).map_err(failed)?;
        self.read()?;
        self.write(&self.trial, outputs);
        Ok(StepReport { substeps: 1, work: 1, received_power, ..StepReport::default() })
    }

    fn first_outputs(&mut self, outputs: &mut dyn Outputs) {
        self.write(&self.accepted, outputs);
    }

    fn accept(&mut self) {
        if let Some(state) = &mut self.state {
            self.late = self.slave.get_mut().keep(state).err();
        }
        self.moved = false;
        std::mem::swap(&mut self.accepted, &mut self.trial);
    }

    fn observe(&mut self, outputs: &mut dyn Outputs) {
        self.write(&self.accepted, outputs);
    }

    fn summary(&self) -> Value {
        let values = self.figures.iter().zip(&self.accepted.figures);
        let named = values.flat_map(|(figures, values)| figures.words.iter().cloned().zip(values));
        let section: Map<String, Value> =
            named.map(|(word, value)| (word, Value::from(*value))).collect();
        let mut summary = Map::new();
        summary.insert(self.role.clone(), Value::Object(section));
        Value::Object(summary)
    }

    fn save(&self, into: &mut dyn Write) -> io::Result<()> {
        let cannot = || {
            io::Error::other(
                "the FMU cannot save states (canGetAndSetFMUstate): a run with it has no checkpoints; remove output.checkpoint_every",
            )
        };
        let state = self.state.as_ref().ok_or_else(cannot)?;
        let bytes = self.slave.borrow_mut().bytes(state).map_err(io::Error::other)?;
        into.write_all(&(bytes.len() as u64).to_le_bytes())?;
        into.write_all(&bytes)
    }

    fn restore(&mut self, from: &mut dyn Read) -> Result<(), StateError> {
        let length = u64::from_le_bytes(proto::state::read_bytes(from)?);
        if length > LARGEST_STATE {
            return Err(StateError(format!("it claims {length} bytes")));
        }
        let mut bytes = Vec::new();
        from.take(length).read_to_end(&mut bytes)?;
        if bytes.len() as u64 != length {
            return Err(StateError("it is truncated".to_owned()));
        }
        let Some(state) = &mut self.state else {
            return Err(StateError("the FMU cannot save states".to_owned()));
        };
        let slave = self.slave.get_mut();
        let told = |fault: Fault| StateError(fault.to_string());
        slave.free(state);
        slave.read_bytes(&bytes, state).map_err(told)?;
        slave.return_to(state).map_err(told)?;
        (self.moved, self.late) = (false, None);
        self.read().map_err(|error| StateError(error.to_string()))?;
        self.accepted.clone_from(&self.trial);
        Ok(())
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        if let Some(state) = &mut self.state {
            self.slave.get_mut().free(state);
        }
    }
}
