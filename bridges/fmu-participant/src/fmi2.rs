//! Functions of FMI 2.0 for co-simulation.
//!
//! Modelica Association: *Functional Mock-up Interface for Model Exchange and Co-Simulation,
//! version 2.0.4* (2022), chapters 2 and 4.

use crate::description::ModelDescription;
use crate::instance::Instance;
use crate::library::{Component, Loaded};
use crate::logger::fmu_participant_log;
use crate::slave::{Experiment, Fault, Kept, Slave};
use crate::variable::{Kind, Variable};
use std::ffi::{CString, c_char, c_int, c_void};
use std::path::Path;

const CO_SIMULATION: c_int = 1;

type Instantiate = unsafe extern "C" fn(
    *const c_char,
    c_int,
    *const c_char,
    *const c_char,
    *const Callbacks,
    c_int,
    c_int,
) -> Component;
type SetUp = unsafe extern "C" fn(Component, c_int, f64, f64, c_int, f64) -> c_int;
type Simple = unsafe extern "C" fn(Component) -> c_int;
type DoStep = unsafe extern "C" fn(Component, f64, f64, c_int) -> c_int;
type Set<T> = unsafe extern "C" fn(Component, *const u32, usize, *const T) -> c_int;
type Get<T> = unsafe extern "C" fn(Component, *const u32, usize, *mut T) -> c_int;

/// `fmi2CallbackFunctions`. Its address must not change during the life of the instance.
#[repr(C)]
#[derive(Debug)]
struct Callbacks {
    logger: unsafe extern "C" fn(),
    allocate: unsafe extern "C" fn(usize, usize) -> *mut c_void,
    free: unsafe extern "C" fn(*mut c_void),
    step_finished: *const c_void,
    environment: *mut c_void,
}

unsafe extern "C" {
    fn calloc(count: usize, size: usize) -> *mut c_void;
    fn free(memory: *mut c_void);
}

/// Get and set functions of one type of value.
#[derive(Debug)]
struct Access<T> {
    set: (String, Set<T>),
    get: (String, Get<T>),
}

impl<T> Access<T> {
    fn find(library: &Loaded, word: &str) -> Result<Self, String> {
        let [set, get] = ["Set", "Get"].map(|verb| format!("fmi2{verb}{word}"));
        // SAFETY: FMI 2.0 gives functions with these names these types.
        let (setter, getter) = unsafe { (library.function(&set)?, library.function(&get)?) };
        Ok(Self { set: (set, setter), get: (get, getter) })
    }

    fn set(&self, instance: &mut Instance, reference: u32, value: &T) -> Result<(), Fault> {
        let (name, set) = &self.set;
        // SAFETY: the instance lives; the call has one reference and one value.
        instance.call(name, |of| unsafe { set(of, &raw const reference, 1, value) })
    }

    fn get(&self, instance: &mut Instance, reference: u32, mut value: T) -> Result<T, Fault> {
        let (name, get) = &self.get;
        // SAFETY: the instance lives; the call has one reference and room for one value.
        instance.call(name, |of| unsafe { get(of, &raw const reference, 1, &raw mut value) })?;
        Ok(value)
    }
}

/// Instance of FMI 2.0.
#[derive(Debug)]
pub struct Fmi2 {
    // First field, so that the instance is dropped before the callbacks it points to.
    instance: Instance,
    reals: Access<f64>,
    integers: Access<c_int>,
    booleans: Access<c_int>,
    set_up: SetUp,
    enter: Simple,
    exit: Simple,
    step: DoStep,
    _callbacks: Box<Callbacks>,
}

impl Fmi2 {
    /// Creates an instance of the FMU unpacked in `folder`.
    ///
    /// # Errors
    /// Fails if a function is missing or the FMU creates no instance.
    pub fn new(folder: &Path, of: &ModelDescription, name: &str) -> Result<Self, String> {
        let library = Loaded::open(folder, of)?;
        let mut callbacks = Box::new(Callbacks {
            logger: fmu_participant_log,
            allocate: calloc,
            free,
            step_finished: std::ptr::null(),
            environment: std::ptr::null_mut(),
        });
        let reals = Access::find(&library, "Real")?;
        let integers = Access::find(&library, "Integer")?;
        let booleans = Access::find(&library, "Boolean")?;
        // SAFETY: FMI 2.0 gives functions with these names these types.
        let (set_up, enter, exit, step, instantiate) = unsafe {
            (
                library.function("fmi2SetupExperiment")?,
                library.function("fmi2EnterInitializationMode")?,
                library.function("fmi2ExitInitializationMode")?,
                library.function("fmi2DoStep")?,
                library.function::<Instantiate>("fmi2Instantiate")?,
            )
        };
        let name = text(name)?;
        let token = text(&of.token)?;
        let resources = text(&uri(&folder.join("resources")))?;
        let instance = Instance::new(&library, of, |health| {
            callbacks.environment = health.logger.environment();
            // SAFETY: the texts live until the call returns; callbacks and logger live as long as
            // the instance.
            unsafe {
                instantiate(
                    name.as_ptr(),
                    CO_SIMULATION,
                    token.as_ptr(),
                    resources.as_ptr(),
                    &raw const *callbacks,
                    0,
                    0,
                )
            }
        })?;
        Ok(Self {
            instance,
            reals,
            integers,
            booleans,
            set_up,
            enter,
            exit,
            step,
            _callbacks: callbacks,
        })
    }
}

/// Converts a text for C.
pub(crate) fn text(text: &str) -> Result<CString, String> {
    CString::new(text).map_err(|_| format!("the text {text:?} contains a null byte"))
}

/// Converts a folder into a file URI.
fn uri(folder: &Path) -> String {
    let mut uri = "file://".to_owned();
    for byte in folder.as_os_str().as_encoded_bytes() {
        match byte {
            b'/' | b'-' | b'_' | b'.' | b'~' => uri.push(char::from(*byte)),
            byte if byte.is_ascii_alphanumeric() => uri.push(char::from(*byte)),
            byte => uri += &format!("%{byte:02X}"),
        }
    }
    uri
}

impl Slave for Fmi2 {
    fn set(&mut self, variable: &Variable, values: &[f64]) -> Result<(), Fault> {
        let (of, reference, value) = (&mut self.instance, variable.reference, values[0]);
        match variable.kind {
            Kind::Boolean => self.booleans.set(of, reference, &c_int::from(value != 0.0)),
            Kind::Float64 => self.reals.set(of, reference, &value),
            _ => self.integers.set(of, reference, &(value as c_int)),
        }
    }

    fn get(&mut self, variable: &Variable, values: &mut [f64]) -> Result<(), Fault> {
        let (of, reference) = (&mut self.instance, variable.reference);
        values[0] = match variable.kind {
            Kind::Boolean => self.booleans.get(of, reference, 0)?.into(),
            Kind::Float64 => self.reals.get(of, reference, 0.0)?,
            _ => self.integers.get(of, reference, 0)?.into(),
        };
        Ok(())
    }

    fn start(&mut self, experiment: &Experiment) -> Result<(), Fault> {
        let Self { instance, set_up, enter, exit, .. } = self;
        let defined = |value: Option<f64>| (c_int::from(value.is_some()), value.unwrap_or(0.0));
        let ((has_tolerance, tolerance), (has_stop, stop)) =
            (defined(experiment.tolerance), defined(experiment.stop));
        // SAFETY: the instance lives.
        unsafe {
            instance.call("fmi2SetupExperiment", |of| {
                set_up(of, has_tolerance, tolerance, 0.0, has_stop, stop)
            })?;
            instance.call("fmi2EnterInitializationMode", |of| enter(of))?;
            instance.call("fmi2ExitInitializationMode", |of| exit(of))?;
        }
        instance.has_started();
        Ok(())
    }

    /// Takes a communication step. Later calls may return to an earlier state
    /// (`noSetFMUStatePriorToCurrentPoint` is false).
    fn step(&mut self, start: f64, length: f64) -> Result<(), Fault> {
        let step = self.step;
        // SAFETY: the instance lives.
        self.instance.call("fmi2DoStep", |of| unsafe { step(of, start, length, 0) })
    }

    fn keep(&mut self, state: &mut Kept) -> Result<(), Fault> {
        self.instance.keep(state)
    }

    fn return_to(&mut self, state: &Kept) -> Result<(), Fault> {
        self.instance.return_to(state)
    }

    fn bytes(&mut self, state: &Kept) -> Result<Vec<u8>, Fault> {
        self.instance.bytes(state)
    }

    fn read_bytes(&mut self, bytes: &[u8], state: &mut Kept) -> Result<(), Fault> {
        self.instance.read_bytes(bytes, state)
    }

    fn free(&mut self, state: &mut Kept) {
        self.instance.free(state);
    }
}

#[cfg(test)]
mod tests {
    use super::uri;
    use std::path::Path;

    #[test]
    fn folders_become_uris() {
        assert_eq!(uri(Path::new("/dev/shm/a b/fmu-x.y")), "file:///dev/shm/a%20b/fmu-x.y");
    }
}
