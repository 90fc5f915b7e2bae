//! The functions of FMI 3.0, of an FMU for co-simulation without events, clocks and intermediate updates.
//!
//! Modelica Association: *Functional Mock-up Interface Specification, version 3.0* (2022), chapters 2 and 4.
//! Functions of other interface types and of what no variable of such an FMU has are there, and say that
//! they are not supported. Of those only the first argument is declared: the caller clears away the rest on
//! all platforms that these FMUs are made for.

#![allow(non_snake_case, reason = "names of the standard")]
#![allow(clippy::missing_safety_doc, reason = "the standard says what a host may pass")]

use super::child::Fault;
use super::instance::{Instance, State};
use std::ffi::{CStr, CString, c_char, c_int, c_void};
use std::path::Path;
use std::slice;

/// What a function has done: `fmi3OK`, or `fmi3Error`.
type Status = c_int;
const OK: Status = 0;
const ERROR: Status = 3;

/// Receives messages of an instance.
type LogMessage = Option<unsafe extern "C" fn(*mut c_void, Status, *const c_char, *const c_char)>;

/// An instance, and whom it tells what.
#[derive(Debug)]
pub struct Component {
    instance: Instance,
    logger: Logger,
}

#[derive(Clone, Copy, Debug)]
struct Logger {
    environment: *mut c_void,
    tell: LogMessage,
}

impl Logger {
    fn error(self, message: &str) -> Status {
        let text = CString::new(message.replace('\0', " ")).unwrap_or_default();
        if let Some(tell) = self.tell {
            // SAFETY: the host gave this function for such calls; both texts live until it returns.
            unsafe { tell(self.environment, ERROR, c"logStatusError".as_ptr(), text.as_ptr()) };
        }
        ERROR
    }
}

/// The text that a host has passed.
///
/// # Safety
/// `text` is null or a string that ends with a null.
unsafe fn text<'a>(text: *const c_char) -> Option<&'a str> {
    if text.is_null() {
        return None;
    }
    // SAFETY: as the caller promises.
    unsafe { CStr::from_ptr(text) }.to_str().ok()
}

/// Does something with an instance that a host has passed.
///
/// # Safety
/// `instance` is null or what `fmi3InstantiateCoSimulation` gave, and nobody else uses it now.
unsafe fn with<E: Message>(
    instance: *mut Component,
    act: impl FnOnce(&mut Instance) -> Result<(), E>,
) -> Status {
    // SAFETY: as the caller promises.
    let Some(component) = (unsafe { instance.as_mut() }) else { return ERROR };
    match act(&mut component.instance) {
        Ok(()) => OK,
        Err(error) => component.logger.error(&error.message()),
    }
}

/// What a host is told.
trait Message {
    fn message(&self) -> String;
}

impl Message for String {
    fn message(&self) -> String {
        self.clone()
    }
}

impl Message for Fault {
    fn message(&self) -> String {
        self.error.clone()
    }
}

/// A list that a host has passed, which may be null if it is empty.
///
/// # Safety
/// `first` is null or the first of `count` values.
unsafe fn list<'a, T>(first: *const T, count: usize) -> &'a [T] {
    if first.is_null() || count == 0 {
        return &[];
    }
    // SAFETY: as the caller promises.
    unsafe { slice::from_raw_parts(first, count) }
}

/// The version of the standard.
#[unsafe(no_mangle)]
pub extern "C" fn fmi3GetVersion() -> *const c_char {
    c"3.0".as_ptr()
}

/// Messages are those of errors, which are always told.
#[unsafe(no_mangle)]
pub extern "C" fn fmi3SetDebugLogging(_instance: *mut Component, _on: bool) -> Status {
    OK
}

/// An instance for co-simulation; null if there is none.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3InstantiateCoSimulation(
    _name: *const c_char,
    token: *const c_char,
    resources: *const c_char,
    _visible: bool,
    _logging: bool,
    event_mode: bool,
    _early_return: bool,
    _intermediate: *const u32,
    intermediate_count: usize,
    environment: *mut c_void,
    tell: LogMessage,
    _intermediate_update: *const c_void,
) -> *mut Component {
    let logger = Logger { environment, tell };
    // SAFETY: the host passes texts.
    let (token, resources) = unsafe { (text(token), text(resources)) };
    let made = match (token, resources) {
        (Some(token), Some(resources)) => Instance::new(Path::new(resources), token),
        _ => Err("the token, or the path of the resources, is missing".to_owned()),
    };
    let made = made.and_then(|instance| match (event_mode, intermediate_count) {
        (false, 0) => Ok(instance),
        _ => Err("this FMU has no event mode and no intermediate update".to_owned()),
    });
    match made {
        Ok(instance) => Box::into_raw(Box::new(Component { instance, logger })),
        Err(error) => {
            logger.error(&error);
            std::ptr::null_mut()
        }
    }
}

/// There is no instance of this kind.
#[unsafe(no_mangle)]
pub extern "C" fn fmi3InstantiateModelExchange() -> *mut Component {
    std::ptr::null_mut()
}

/// There is no instance of this kind.
#[unsafe(no_mangle)]
pub extern "C" fn fmi3InstantiateScheduledExecution() -> *mut Component {
    std::ptr::null_mut()
}

/// Ends the run of an instance; what it has started ends with it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3FreeInstance(instance: *mut Component) {
    if !instance.is_null() {
        // SAFETY: it was made by `fmi3InstantiateCoSimulation`, and the host forgets it.
        drop(unsafe { Box::from_raw(instance) });
    }
}

/// The start time of the simulation.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3EnterInitializationMode(
    instance: *mut Component,
    _tolerance_defined: bool,
    _tolerance: f64,
    start: f64,
    _stop_defined: bool,
    _stop: f64,
) -> Status {
    let begin = |instance: &mut Instance| {
        instance.begin_at(start);
        Ok::<_, Fault>(())
    };
    // SAFETY: the host passes its instance.
    unsafe { with(instance, begin) }
}

/// Starts the run.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3ExitInitializationMode(instance: *mut Component) -> Status {
    // SAFETY: the host passes its instance.
    unsafe { with(instance, Instance::start) }
}

/// Nothing to do: the run ends with its instance, or with a reset.
#[unsafe(no_mangle)]
pub extern "C" fn fmi3Terminate(_instance: *mut Component) -> Status {
    OK
}

/// A new run from the beginning.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3Reset(instance: *mut Component) -> Status {
    let reset = |instance: &mut Instance| {
        instance.reset();
        Ok::<_, Fault>(())
    };
    // SAFETY: the host passes its instance.
    unsafe { with(instance, reset) }
}

/// Values of variables.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetFloat64(
    instance: *mut Component,
    references: *const u32,
    count: usize,
    values: *mut f64,
    value_count: usize,
) -> Status {
    let get = |instance: &mut Instance| {
        // SAFETY: the host passes lists of these lengths.
        let references = unsafe { list(references, count) };
        if value_count != count || (values.is_null() && count > 0) {
            return Err(format!("{value_count} values of {count} scalar variables"));
        }
        for (place, reference) in references.iter().enumerate() {
            let value = instance.value(*reference);
            let value = value.ok_or_else(|| format!("there is no variable {reference}"))?;
            // SAFETY: there is a place for every reference, as was checked.
            unsafe { values.add(place).write(value) };
        }
        Ok(())
    };
    // SAFETY: the host passes its instance.
    unsafe { with(instance, get) }
}

/// Values of inputs.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SetFloat64(
    instance: *mut Component,
    references: *const u32,
    count: usize,
    values: *const f64,
    value_count: usize,
) -> Status {
    let set = |instance: &mut Instance| {
        // SAFETY: the host passes lists of these lengths.
        let (references, values) = unsafe { (list(references, count), list(values, value_count)) };
        if references.len() != values.len() {
            return Err(format!("{value_count} values of {count} scalar variables"));
        }
        let mut pairs = references.iter().zip(values);
        pairs.try_for_each(|(reference, value)| instance.set(*reference, *value))
    };
    // SAFETY: the host passes its instance.
    unsafe { with(instance, set) }
}

/// Solves a window.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3DoStep(
    instance: *mut Component,
    start: f64,
    duration: f64,
    _no_return: bool,
    event_needed: *mut bool,
    terminate: *mut bool,
    early: *mut bool,
    last: *mut f64,
) -> Status {
    let put = |time: f64| {
        // SAFETY: the host passes places, or null.
        unsafe {
            for flag in [event_needed, terminate, early].into_iter().filter(|flag| !flag.is_null())
            {
                flag.write(false);
            }
            if !last.is_null() {
                last.write(time);
            }
        }
    };
    put(start);
    let end = start + duration;
    // SAFETY: the host passes its instance.
    let status = unsafe { with(instance, |instance| instance.step(end)) };
    if status == OK {
        put(end);
    }
    status
}

/// Keeps the state of an instance.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetFMUState(
    instance: *mut Component,
    state: *mut *mut State,
) -> Status {
    let get = |instance: &mut Instance| {
        let saved = instance.save()?;
        // SAFETY: the host passes a place; one that is not null holds a state of ours that is replaced.
        unsafe {
            match (*state).as_mut() {
                Some(old) => *old = saved,
                None => *state = Box::into_raw(Box::new(saved)),
            }
        }
        Ok::<_, Fault>(())
    };
    if state.is_null() {
        return ERROR;
    }
    // SAFETY: the host passes its instance.
    unsafe { with(instance, get) }
}

/// Returns to a state.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SetFMUState(instance: *mut Component, state: *const State) -> Status {
    // SAFETY: the host passes a state that `fmi3GetFMUState` gave.
    let Some(state) = (unsafe { state.as_ref() }) else { return ERROR };
    // SAFETY: the host passes its instance.
    unsafe { with(instance, |instance| instance.restore(state)) }
}

/// Forgets a state.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3FreeFMUState(
    _instance: *mut Component,
    state: *mut *mut State,
) -> Status {
    if !state.is_null() {
        // SAFETY: the host passes a place; what is in it was given by `fmi3GetFMUState`.
        unsafe {
            if !(*state).is_null() {
                drop(Box::from_raw(*state));
                *state = std::ptr::null_mut();
            }
        }
    }
    OK
}

/// Functions that nothing of such an FMU needs.
macro_rules! unsupported {
    ($($name:ident)*) => {
        $(
            /// Not supported.
            #[unsafe(no_mangle)]
            pub unsafe extern "C" fn $name(instance: *mut Component) -> Status {
                let refuse = |_: &mut Instance| Err(concat!(stringify!($name), " is not supported").to_owned());
                // SAFETY: the host passes its instance.
                unsafe { with::<String>(instance, refuse) }
            }
        )*
    };
}

unsupported! {
    fmi3EnterEventMode fmi3EnterStepMode fmi3EnterConfigurationMode fmi3ExitConfigurationMode
    fmi3GetFloat32 fmi3GetInt8 fmi3GetUInt8 fmi3GetInt16 fmi3GetUInt16 fmi3GetInt32 fmi3GetUInt32
    fmi3GetInt64 fmi3GetUInt64 fmi3GetBoolean fmi3GetString fmi3GetBinary fmi3GetClock
    fmi3SetFloat32 fmi3SetInt8 fmi3SetUInt8 fmi3SetInt16 fmi3SetUInt16 fmi3SetInt32 fmi3SetUInt32
    fmi3SetInt64 fmi3SetUInt64 fmi3SetBoolean fmi3SetString fmi3SetBinary fmi3SetClock
    fmi3GetNumberOfVariableDependencies fmi3GetVariableDependencies
    fmi3SerializedFMUStateSize fmi3SerializeFMUState fmi3DeserializeFMUState
    fmi3GetDirectionalDerivative fmi3GetAdjointDerivative fmi3GetOutputDerivatives
    fmi3GetIntervalDecimal fmi3GetIntervalFraction fmi3GetShiftDecimal fmi3GetShiftFraction
    fmi3SetIntervalDecimal fmi3SetIntervalFraction fmi3SetShiftDecimal fmi3SetShiftFraction
    fmi3EvaluateDiscreteStates fmi3UpdateDiscreteStates fmi3ActivateModelPartition
    fmi3EnterContinuousTimeMode fmi3CompletedIntegratorStep fmi3SetTime fmi3SetContinuousStates
    fmi3GetContinuousStateDerivatives fmi3GetEventIndicators fmi3GetContinuousStates
    fmi3GetNominalsOfContinuousStates fmi3GetNumberOfEventIndicators
    fmi3GetNumberOfContinuousStates
}
