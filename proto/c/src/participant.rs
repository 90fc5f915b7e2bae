//! The callbacks as a [`Solver`], [`Setup`] and [`Model`] of the contract.
//!
//! A fault of a callback becomes the error of the trait's method. Methods without an error (first
//! outputs, accept, observe, summary, and failures in configure and build other than refusals)
//! unwind to `cosim_main`. There the message is printed and the process ends, so that the
//! coordinator reports the participant with this message.

use crate::configuration::CosimConfiguration;
use crate::fault::{Fault, call, call_text};
use crate::fields::{CosimBlob, CosimInputs, CosimOutputs, Direction};
use crate::layout::CosimLayout;
use crate::moves::Followed;
use crate::progress;
use crate::solver::{CosimReport, CosimSolver, CosimStep};
use proto::configuration::{Configuration, Layout, Refusal};
use proto::description::Description;
use proto::field::{FieldKind, FieldSpec};
use proto::grid::Grid;
use proto::model::{
    Inputs, Model, Outputs, Setup, Solver, StateError, Step, StepError, StepReport,
};
use serde_json::{Map, Value, json};
use std::collections::BTreeSet;
use std::ffi::c_void;
use std::io::{self, Read, Write};
use std::panic::resume_unwind;
use std::sync::{Mutex, PoisonError};

const CHECKED: &str = "the table was checked when it was read";

/// Callbacks and their user pointer.
#[derive(Clone, Copy)]
struct Callbacks {
    table: CosimSolver,
    user: *mut c_void,
}

impl Callbacks {
    /// Asks for the geometry of the followed grids.
    fn move_grids(&self, followed: &mut Followed) -> Result<(), Fault> {
        let Some(moved_grids) = self.table.moved_grids else {
            return Ok(());
        };
        // SAFETY: the caller guarantees valid callbacks.
        followed.ask(|moves| unsafe { moved_grids(self.user, moves) })
    }
}

/// A program with its description.
pub(crate) struct Program {
    callbacks: Callbacks,
    description: Description,
}

impl Program {
    /// Asks the program for its description.
    ///
    /// # Safety
    /// The callbacks must follow the rules of the header, with this `user`.
    pub(crate) unsafe fn new(table: CosimSolver, user: *mut c_void) -> Result<Self, String> {
        let describe = table.describe.expect(CHECKED);
        // SAFETY: the caller guarantees valid callbacks.
        let text = call_text("describe", || unsafe { describe(user) });
        let description = text.map_err(|fault| fault.to_string()).and_then(|text| described(&text));
        match description {
            Ok(description) => Ok(Self { callbacks: Callbacks { table, user }, description }),
            Err(error) => {
                destroy(Callbacks { table, user });
                Err(error)
            }
        }
    }
}

impl Drop for Program {
    fn drop(&mut self) {
        destroy(self.callbacks);
    }
}

fn destroy(callbacks: Callbacks) {
    if let Some(destroy) = callbacks.table.destroy {
        // SAFETY: the caller guarantees valid callbacks; nothing is called after this.
        unsafe { destroy(callbacks.user) };
    }
}

/// Parses a description and fills in values that the library knows or can default.
fn described(text: &str) -> Result<Description, String> {
    let wrong = |error: serde_json::Error| format!("the text of `describe`: {error}");
    let mut value: Value = serde_json::from_str(text).map_err(wrong)?;
    if let Some(object) = value.as_object_mut() {
        object.insert("protocol".to_owned(), json!(proto::PROTOCOL_VERSION));
        let defaults = [("standalone", json!(false)), ("estimates", json!(true))];
        let lists = ["effects", "keys", "fields"].map(|list| (list, json!([])));
        fill(object, defaults.into_iter().chain(lists));
        for section in ["models", "effects"] {
            let entries = object.get_mut(section).and_then(Value::as_array_mut);
            for entry in entries.into_iter().flatten().filter_map(Value::as_object_mut) {
                fill(entry, ["consumes", "provides", "keys"].map(|list| (list, json!([]))));
            }
        }
    }
    let description: Description = serde_json::from_value(value).map_err(wrong)?;
    description.check().map_err(|why| format!("the text of `describe`: {why}"))?;
    Ok(description)
}

fn fill(
    object: &mut Map<String, Value>,
    defaults: impl IntoIterator<Item = (&'static str, Value)>,
) {
    for (key, value) in defaults {
        object.entry(key).or_insert(value);
    }
}

impl Solver for Program {
    fn description(&self) -> Description {
        self.description.clone()
    }

    fn configure(&self, configuration: &Configuration) -> Result<Setup, Refusal> {
        let Callbacks { table, user } = self.callbacks;
        let configure = table.configure.expect(CHECKED);
        let given = CosimConfiguration::new(configuration);
        let mut layout = CosimLayout::default();
        // SAFETY: the caller guarantees valid callbacks.
        let configured =
            call("configure", || unsafe { configure(user, &raw const given, &raw mut layout) });
        refusing(configured)?;
        if table.observe.is_none()
            && let Some(field) = configuration.observed.first()
        {
            return Err(Refusal::new(
                "output.fields",
                format!("the program has no `observe` that would write `{field}`"),
                "leave the field out, or complete the program",
            ));
        }
        let callbacks = self.callbacks;
        let followed = followed(&layout.layout, configuration);
        let fields = fields(&self.description, configuration);
        Ok(Setup::new(layout.layout, move |progress| {
            progress::report_to(progress);
            if let Some(build) = table.build {
                // SAFETY: the caller guarantees valid callbacks.
                refusing(call("build", || unsafe { build(user) }))?;
            }
            let mut built = Built { callbacks, followed, fields };
            built.move_grids();
            Ok(Box::new(built))
        }))
    }
}

/// Returns the moving grids of a layout, and the volumes that carry a field of this run.
fn followed(layout: &Layout, configuration: &Configuration) -> Followed {
    let Configuration { outputs, observed, .. } = configuration;
    let is_used = |grid: &Grid| {
        outputs.iter().chain(observed).any(|field| layout.grid_of(field) == Some(grid))
    };
    Followed::among(&layout.grids, |grid| {
        layout.moving.contains(&grid.name) || (grid.is_volume() && is_used(grid))
    })
}

/// Returns all fields that the program may request in this run.
fn fields(description: &Description, configuration: &Configuration) -> Vec<FieldSpec> {
    let inputs = configuration.inputs.iter().map(|input| kept(&input.field));
    let known = |name: &String| description.field_kind(name).as_ref().map(kept);
    let sent = configuration.outputs.iter().chain(&configuration.observed);
    inputs.chain(sent.filter_map(known)).collect()
}

/// Returns a field in the form that a model requests. Its texts live as long as the process, with
/// one copy of each.
fn kept(kind: &FieldKind) -> FieldSpec {
    static TEXTS: Mutex<BTreeSet<&'static str>> = Mutex::new(BTreeSet::new());
    let mut texts = TEXTS.lock().unwrap_or_else(PoisonError::into_inner);
    let mut keep = |text: &str| {
        let known = texts.get(text).copied();
        known.unwrap_or_else(|| {
            let text: &'static str = String::leak(text.to_owned());
            texts.insert(text);
            text
        })
    };
    FieldSpec {
        name: keep(&kind.name),
        unit: keep(&kind.unit),
        components: kind.components,
        mapping: kind.mapping,
        body: kind.body,
        meaning: keep(&kind.meaning),
    }
}

/// Converts a refusal to an error; every other fault ends the program.
fn refusing(called: Result<(), Fault>) -> Result<(), Refusal> {
    match called {
        Ok(()) => Ok(()),
        Err(Fault::Refused(refusal)) => Err(refusal),
        Err(fault) => end(&fault),
    }
}

struct Built {
    callbacks: Callbacks,
    followed: Followed,
    fields: Vec<FieldSpec>,
}

impl Built {
    fn move_grids(&mut self) {
        self.callbacks.move_grids(&mut self.followed).unwrap_or_else(|fault| end(&fault));
    }
}

impl Drop for Built {
    fn drop(&mut self) {
        let Callbacks { table, user } = self.callbacks;
        if let Some(finish) = table.finish {
            // SAFETY: the caller guarantees valid callbacks.
            let finished = call("finish", || unsafe { finish(user) });
            if let Err(fault) = finished
                && !std::thread::panicking()
            {
                end(&fault);
            }
        }
    }
}

/// Last message of a program, on the way to `cosim_main`.
pub(crate) struct FatalMessage(pub(crate) String);

fn end(fault: &Fault) -> ! {
    resume_unwind(Box::new(FatalMessage(fault.to_string())))
}

impl Model for Built {
    fn solve(
        &mut self,
        step: &Step,
        inputs: &dyn Inputs,
        outputs: &mut dyn Outputs,
    ) -> Result<StepReport, StepError> {
        let Callbacks { table, user } = self.callbacks;
        let solve = table.solve.expect(CHECKED);
        let (step, fields) = (CosimStep::from(step), self.fields.as_slice());
        let inputs = CosimInputs { inputs, fields };
        let mut outputs = CosimOutputs { outputs, fields };
        let mut report = CosimReport::EMPTY;
        // SAFETY: the caller guarantees valid callbacks; all four live until it returns.
        call("solve", || unsafe {
            solve(user, &raw const step, &raw const inputs, &raw mut outputs, &raw mut report)
        })
        .map_err(|fault| StepError::NoSolution(fault.to_string()))?;
        Ok(report.into())
    }

    fn first_outputs(&mut self, outputs: &mut dyn Outputs) {
        let fields = self.fields.as_slice();
        let Callbacks { table, user } = self.callbacks;
        let Some(first_outputs) = table.first_outputs else {
            for field in fields {
                if let Some(values) = outputs.get(field) {
                    values.fill(0.0);
                }
            }
            return;
        };
        let mut outputs = CosimOutputs { outputs, fields };
        // SAFETY: the caller guarantees valid callbacks.
        call("first_outputs", || unsafe { first_outputs(user, &raw mut outputs) })
            .unwrap_or_else(|fault| end(&fault));
    }

    fn accept(&mut self) {
        let Callbacks { table, user } = self.callbacks;
        if let Some(accept) = table.accept {
            // SAFETY: the caller guarantees valid callbacks.
            call("accept", || unsafe { accept(user) }).unwrap_or_else(|fault| end(&fault));
        }
        self.move_grids();
    }

    fn moved_grids(&self) -> &[Grid] {
        &self.followed.grids
    }

    fn observe(&mut self, outputs: &mut dyn Outputs) {
        let Callbacks { table, user } = self.callbacks;
        if let Some(observe) = table.observe {
            let mut outputs = CosimOutputs { outputs, fields: &self.fields };
            // SAFETY: the caller guarantees valid callbacks.
            call("observe", || unsafe { observe(user, &raw mut outputs) })
                .unwrap_or_else(|fault| end(&fault));
        }
    }

    fn summary(&self) -> Value {
        let Callbacks { table, user } = self.callbacks;
        let Some(summary) = table.summary else { return json!({}) };
        // SAFETY: the caller guarantees valid callbacks.
        let text = call_text("summary", || unsafe { summary(user) });
        let text = text.unwrap_or_else(|fault| end(&fault));
        match serde_json::from_str(&text) {
            Ok(Value::Object(sections)) => Value::Object(sections),
            Ok(_) => end(&Fault::Failed(format!("`summary` is no JSON object: {text}"))),
            Err(error) => end(&Fault::Failed(format!("`summary` is not JSON: {error}: {text}"))),
        }
    }

    fn save(&self, into: &mut dyn Write) -> io::Result<()> {
        let Callbacks { table, user } = self.callbacks;
        let Some(save) = table.save else { return Ok(()) };
        let mut blob = CosimBlob(Direction::Saving(into));
        // SAFETY: the caller guarantees valid callbacks.
        call("save", || unsafe { save(user, &raw mut blob) })
            .map_err(|fault| io::Error::other(fault.to_string()))
    }

    fn restore(&mut self, from: &mut dyn Read) -> Result<(), StateError> {
        let Callbacks { table, user } = self.callbacks;
        let Some(restore) = table.restore else { return Ok(()) };
        let mut blob = CosimBlob(Direction::Restoring(from));
        // SAFETY: the caller guarantees valid callbacks.
        call("restore", || unsafe { restore(user, &raw mut blob) })
            .and_then(|()| self.callbacks.move_grids(&mut self.followed))
            .map_err(|fault| StateError(fault.to_string()))
    }
}

#[cfg(test)]
mod tests;
