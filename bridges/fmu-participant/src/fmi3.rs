//! Functions of FMI 3.0 for co-simulation, without events, clocks and intermediate updates.
//!
//! Modelica Association: *Functional Mock-up Interface Specification, version 3.0* (2022),
//! chapters 2 and 4.

use crate::description::ModelDescription;
use crate::fmi2::text;
use crate::instance::Instance;
use crate::library::{Component, Loaded};
use crate::logger::log_message;
use crate::slave::{Experiment, Fault, Kept, Slave};
use crate::variable::{Kind, Variable};
use std::ffi::{CString, c_char, c_int, c_void};
use std::path::Path;

type LogMessage = unsafe extern "C" fn(*mut c_void, c_int, *const c_char, *const c_char);
type Instantiate = unsafe extern "C" fn(
    *const c_char,
    *const c_char,
    *const c_char,
    bool,
    bool,
    bool,
    bool,
    *const u32,
    usize,
    *mut c_void,
    LogMessage,
    *const c_void,
) -> Component;
type Enter = unsafe extern "C" fn(Component, bool, f64, f64, bool, f64) -> c_int;
type Exit = unsafe extern "C" fn(Component) -> c_int;
type DoStep = unsafe extern "C" fn(
    Component,
    f64,
    f64,
    bool,
    *mut bool,
    *mut bool,
    *mut bool,
    *mut f64,
) -> c_int;
type Set<T> = unsafe extern "C" fn(Component, *const u32, usize, *const T, usize) -> c_int;
type Get<T> = unsafe extern "C" fn(Component, *const u32, usize, *mut T, usize) -> c_int;

/// Numeric type of FMI 3.0.
trait Number: Copy + Default {
    /// Name of the type in names of functions.
    const WORD: &str;
    fn of(value: f64) -> Self;
    fn number(self) -> f64;
}

macro_rules! numbers {
    ($($type:ty = $word:literal),*) => {
        $(impl Number for $type {
            const WORD: &str = $word;
            fn of(value: f64) -> Self {
                value as $type
            }
            fn number(self) -> f64 {
                self as f64
            }
        })*
    };
}

numbers! {
    f64 = "Float64", f32 = "Float32", i8 = "Int8", u8 = "UInt8", i16 = "Int16", u16 = "UInt16",
    i32 = "Int32", u32 = "UInt32", i64 = "Int64", u64 = "UInt64"
}

/// `bool` of C; an FMU may write any byte to it.
#[derive(Clone, Copy, Debug, Default)]
#[repr(transparent)]
struct Flag(u8);

impl Number for Flag {
    const WORD: &str = "Boolean";

    fn of(value: f64) -> Self {
        Self(u8::from(value != 0.0))
    }

    fn number(self) -> f64 {
        f64::from(u8::from(self.0 != 0))
    }
}

/// Get and set functions of one type of value, with a buffer so that a step does not allocate. A
/// function may be missing if no variable of the FMU has the type.
#[derive(Debug)]
struct Access<T> {
    set: (String, Option<Set<T>>),
    get: (String, Option<Get<T>>),
    way: Vec<T>,
}

impl<T: Number> Access<T> {
    fn find(library: &Loaded) -> Self {
        let [set, get] = ["Set", "Get"].map(|verb| format!("fmi3{verb}{}", T::WORD));
        // SAFETY: FMI 3.0 gives functions with these names these types.
        let (setter, getter) =
            unsafe { (library.function(&set).ok(), library.function(&get).ok()) };
        Self { set: (set, setter), get: (get, getter), way: Vec::new() }
    }

    fn set(&mut self, of: &mut Instance, reference: u32, values: &[f64]) -> Result<(), Fault> {
        let Self { set: (name, set), way, .. } = self;
        let set = set.ok_or_else(|| missing(name))?;
        way.clear();
        way.extend(values.iter().map(|value| T::of(*value)));
        // SAFETY: the instance lives; the length of the list is passed.
        of.call(name, |of| unsafe { set(of, &raw const reference, 1, way.as_ptr(), way.len()) })
    }

    fn get(&mut self, of: &mut Instance, reference: u32, values: &mut [f64]) -> Result<(), Fault> {
        let Self { get: (name, get), way, .. } = self;
        let get = get.ok_or_else(|| missing(name))?;
        way.clear();
        way.resize(values.len(), T::default());
        let (to, room) = (way.as_mut_ptr(), way.len());
        // SAFETY: the instance lives; the buffer has room for the number of values passed.
        of.call(name, |of| unsafe { get(of, &raw const reference, 1, to, room) })?;
        values.iter_mut().zip(way).for_each(|(value, found)| *value = found.number());
        Ok(())
    }
}

fn missing(name: &str) -> Fault {
    Fault(format!("the FMU has no {name}"))
}

/// Instance of FMI 3.0.
#[derive(Debug)]
pub struct Fmi3 {
    instance: Instance,
    values: Values,
    enter: Enter,
    exit: Exit,
    step: DoStep,
}

/// Get and set functions of all types.
#[derive(Debug)]
struct Values {
    float64: Access<f64>,
    float32: Access<f32>,
    int8: Access<i8>,
    uint8: Access<u8>,
    int16: Access<i16>,
    uint16: Access<u16>,
    int32: Access<i32>,
    uint32: Access<u32>,
    int64: Access<i64>,
    uint64: Access<u64>,
    boolean: Access<Flag>,
}

impl Values {
    fn find(library: &Loaded) -> Self {
        Self {
            float64: Access::find(library),
            float32: Access::find(library),
            int8: Access::find(library),
            uint8: Access::find(library),
            int16: Access::find(library),
            uint16: Access::find(library),
            int32: Access::find(library),
            uint32: Access::find(library),
            int64: Access::find(library),
            uint64: Access::find(library),
            boolean: Access::find(library),
        }
    }
}

impl Fmi3 {
    /// Creates an instance of the FMU unpacked in `folder`.
    ///
    /// # Errors
    /// Fails if a function is missing or the FMU creates no instance.
    pub fn new(folder: &Path, of: &ModelDescription, name: &str) -> Result<Self, String> {
        let library = Loaded::open(folder, of)?;
        let values = Values::find(&library);
        // SAFETY: FMI 3.0 gives functions with these names these types.
        let (enter, exit, step, instantiate) = unsafe {
            (
                library.function("fmi3EnterInitializationMode")?,
                library.function("fmi3ExitInitializationMode")?,
                library.function("fmi3DoStep")?,
                library.function::<Instantiate>("fmi3InstantiateCoSimulation")?,
            )
        };
        let [name, token] = [text(name)?, text(&of.token)?];
        let resources: CString = text(&format!("{}/resources/", folder.display()))?;
        let instance = Instance::new(&library, of, |health| {
            let to = health.logger.environment();
            // SAFETY: the texts live until the call returns; the logger lives as long as the
            // instance.
            unsafe {
                instantiate(
                    name.as_ptr(),
                    token.as_ptr(),
                    resources.as_ptr(),
                    false,
                    false,
                    false,
                    false,
                    std::ptr::null(),
                    0,
                    to,
                    log_message,
                    std::ptr::null(),
                )
            }
        })?;
        Ok(Self { instance, values, enter, exit, step })
    }
}

/// Calls a method of the [`Access`] of a variable's type.
macro_rules! by_kind {
    ($kind:expr, $values:expr, $do:ident($($argument:expr),*)) => {
        match $kind {
            Kind::Float64 => $values.float64.$do($($argument),*),
            Kind::Float32 => $values.float32.$do($($argument),*),
            Kind::Int8 => $values.int8.$do($($argument),*),
            Kind::UInt8 => $values.uint8.$do($($argument),*),
            Kind::Int16 => $values.int16.$do($($argument),*),
            Kind::UInt16 => $values.uint16.$do($($argument),*),
            Kind::Int32 => $values.int32.$do($($argument),*),
            Kind::UInt32 => $values.uint32.$do($($argument),*),
            Kind::Int64 => $values.int64.$do($($argument),*),
            Kind::UInt64 => $values.uint64.$do($($argument),*),
            Kind::Boolean => $values.boolean.$do($($argument),*),
        }
    };
}

impl Slave for Fmi3 {
    fn set(&mut self, variable: &Variable, values: &[f64]) -> Result<(), Fault> {
        let (of, reference) = (&mut self.instance, variable.reference);
        by_kind!(variable.kind, self.values, set(of, reference, values))
    }

    fn get(&mut self, variable: &Variable, values: &mut [f64]) -> Result<(), Fault> {
        let (of, reference) = (&mut self.instance, variable.reference);
        by_kind!(variable.kind, self.values, get(of, reference, values))
    }

    fn start(&mut self, experiment: &Experiment) -> Result<(), Fault> {
        let Self { instance, enter, exit, .. } = self;
        let defined = |value: Option<f64>| (value.is_some(), value.unwrap_or(0.0));
        let ((has_tolerance, tolerance), (has_stop, stop)) =
            (defined(experiment.tolerance), defined(experiment.stop));
        // SAFETY: the instance lives.
        unsafe {
            instance.call("fmi3EnterInitializationMode", |of| {
                enter(of, has_tolerance, tolerance, 0.0, has_stop, stop)
            })?;
            instance.call("fmi3ExitInitializationMode", |of| exit(of))?;
        }
        instance.has_started();
        Ok(())
    }

    /// Takes a communication step. Later calls may return to an earlier state
    /// (`noSetFMUStatePriorToCurrentPoint` is false).
    fn step(&mut self, start: f64, length: f64) -> Result<(), Fault> {
        let ([mut event, mut terminate, mut early], mut last) = ([0_u8; 3], start);
        let step = self.step;
        // SAFETY: the instance lives; all pointers are valid.
        self.instance.call("fmi3DoStep", |of| unsafe {
            step(
                of,
                start,
                length,
                false,
                (&raw mut event).cast(),
                (&raw mut terminate).cast(),
                (&raw mut early).cast(),
                &raw mut last,
            )
        })?;
        match (terminate, early) {
            (0, 0) => Ok(()),
            (0, _) => Err(Fault(format!("fmi3DoStep returned early at {last} s"))),
            _ => Err(Fault(format!("the FMU requested the end of the simulation at {last} s"))),
        }
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
