//! Functions of FMI 3.0 common to all FMUs. An FMU with a case supports co-simulation; an FMU with
//! a surrogate also supports model exchange (`exchange.rs`). Clocks, intermediate updates and
//! events in co-simulation are not supported.
//!
//! Modelica Association: *Functional Mock-up Interface Specification, version 3.0* (2022),
//! chapters 2 and 4.

#![allow(non_snake_case, reason = "names of the standard")]
#![allow(clippy::missing_safety_doc, reason = "the standard says what a host may pass")]

use super::child::Fault;
use super::host::{Component, ERROR, LogMessage, Logger, OK, Status, list, put, text, with};
use super::instance::{Instance, State};
use std::ffi::{c_char, c_void};
use std::path::Path;
use std::sync::Mutex;

/// Returns the version of the standard.
#[unsafe(no_mangle)]
pub extern "C" fn fmi3GetVersion() -> *const c_char {
    c"3.0".as_ptr()
}

/// Succeeds without effect: only errors and warnings are logged, always.
#[unsafe(no_mangle)]
pub extern "C" fn fmi3SetDebugLogging(_instance: *mut Component, _on: bool) -> Status {
    OK
}

/// Creates an instance for co-simulation; returns null on failure.
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
    if event_mode || intermediate_count > 0 {
        logger.error("this FMU has no event mode and no intermediate update in co-simulation");
        return std::ptr::null_mut();
    }
    // SAFETY: the host passes null-terminated strings.
    unsafe { instantiate(token, resources, logger, false) }
}

/// Creates an instance for model exchange; returns null on failure.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3InstantiateModelExchange(
    _name: *const c_char,
    token: *const c_char,
    resources: *const c_char,
    _visible: bool,
    _logging: bool,
    environment: *mut c_void,
    tell: LogMessage,
) -> *mut Component {
    // SAFETY: the host passes null-terminated strings.
    unsafe { instantiate(token, resources, Logger { environment, tell }, true) }
}

/// # Safety
/// `token` and `resources` are null or null-terminated strings.
unsafe fn instantiate(
    token: *const c_char,
    resources: *const c_char,
    logger: Logger,
    exchange: bool,
) -> *mut Component {
    // SAFETY: guaranteed by the caller.
    let made = match unsafe { (text(token), text(resources)) } {
        (Some(token), Some(resources)) => Instance::new(Path::new(resources), token),
        _ => Err("the token, or the path of the resources, is missing".to_owned()),
    };
    let made = made.and_then(|instance| match exchange && !instance.is_algebraic() {
        true => Err("this FMU contains a case, which supports co-simulation only".to_owned()),
        false => Ok(instance),
    });
    match made {
        Ok(instance) => {
            let instance = Mutex::new(instance);
            Box::into_raw(Box::new(Component { instance, exchange, logger }))
        }
        Err(error) => {
            logger.error(&error);
            std::ptr::null_mut()
        }
    }
}

/// Returns null: scheduled execution is not supported.
#[unsafe(no_mangle)]
pub extern "C" fn fmi3InstantiateScheduledExecution() -> *mut Component {
    std::ptr::null_mut()
}

/// Frees an instance and ends its run with all processes it started.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3FreeInstance(instance: *mut Component) {
    if !instance.is_null() {
        // SAFETY: `instantiate` made it, and the host no longer uses it.
        drop(unsafe { Box::from_raw(instance) });
    }
}

/// Sets the start time of the simulation.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3EnterInitializationMode(
    instance: *mut Component,
    _tolerance_defined: bool,
    _tolerance: f64,
    start: f64,
    _stop_defined: bool,
    _stop: f64,
) -> Status {
    // SAFETY: the host passes its instance.
    unsafe { with(instance, |instance| instance.set_time(start)) }
}

/// Starts the run.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3ExitInitializationMode(instance: *mut Component) -> Status {
    // SAFETY: the host passes its instance.
    unsafe { with(instance, Instance::start) }
}

/// Succeeds without effect: the run ends when the instance is freed or reset.
#[unsafe(no_mangle)]
pub extern "C" fn fmi3Terminate(_instance: *mut Component) -> Status {
    OK
}

/// Resets the instance: the run starts again from the beginning.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3Reset(instance: *mut Component) -> Status {
    let reset = |instance: &mut Instance| {
        instance.reset();
        Ok::<_, Fault>(())
    };
    // SAFETY: the host passes its instance.
    unsafe { with(instance, reset) }
}

/// Reads values of variables.
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
        let asked = references.iter().any(|reference| instance.is_output(*reference));
        let remark = if asked { instance.refresh() } else { None };
        for (place, reference) in references.iter().enumerate() {
            let value = instance.value(*reference);
            let value = value.ok_or_else(|| format!("there is no variable {reference}"))?;
            // SAFETY: `values` has room for one value a reference, checked above.
            unsafe { values.add(place).write(value) };
        }
        Ok(remark)
    };
    // SAFETY: the host passes its instance.
    unsafe { with(instance, get) }
}

/// Sets values of inputs.
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
    // SAFETY: the host passes valid pointers, or null.
    unsafe {
        put([event_needed, terminate, early], false);
        put([last], start);
    }
    let step = |instance: &mut Instance| {
        let end = instance.step(start, duration)?;
        // SAFETY: the host passes a valid pointer, or null.
        unsafe { put([last], end) };
        Ok::<_, Fault>(())
    };
    // SAFETY: the host passes its instance.
    unsafe { with(instance, step) }
}

/// Saves the state of an instance.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetFMUState(
    instance: *mut Component,
    state: *mut *mut State,
) -> Status {
    let get = |instance: &mut Instance| {
        let saved = instance.save()?;
        // SAFETY: `state` is not null, checked before the call.
        unsafe { keep(saved, state) };
        Ok::<_, Fault>(())
    };
    if state.is_null() {
        return ERROR;
    }
    // SAFETY: the host passes its instance.
    unsafe { with(instance, get) }
}

/// Stores a state through a pointer of the host.
///
/// # Safety
/// `place` is valid; if `*place` is not null, it holds a state made by this library, which is
/// overwritten.
unsafe fn keep(saved: State, place: *mut *mut State) {
    // SAFETY: guaranteed by the caller.
    unsafe {
        match (*place).as_mut() {
            Some(old) => *old = saved,
            None => *place = Box::into_raw(Box::new(saved)),
        }
    }
}

/// Restores a saved state.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SetFMUState(instance: *mut Component, state: *const State) -> Status {
    // SAFETY: the host passes a state from `fmi3GetFMUState`.
    let Some(state) = (unsafe { state.as_ref() }) else { return ERROR };
    // SAFETY: the host passes its instance.
    unsafe { with(instance, |instance| instance.restore(state)) }
}

/// Frees a saved state.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3FreeFMUState(
    instance: *mut Component,
    state: *mut *mut State,
) -> Status {
    let free = |_: &mut Instance| {
        if !state.is_null() {
            // SAFETY: the host passes a valid pointer to null or to a state from `fmi3GetFMUState`.
            unsafe {
                if !(*state).is_null() {
                    drop(Box::from_raw(*state));
                    *state = std::ptr::null_mut();
                }
            }
        }
        Ok::<_, Fault>(())
    };
    // SAFETY: the host passes its instance.
    unsafe { with(instance, free) }
}

/// Writes the size [byte] of a serialised state of a surrogate.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SerializedFMUStateSize(
    instance: *mut Component,
    state: *const State,
    size: *mut usize,
) -> Status {
    let count = |bytes: &[u8]| {
        // SAFETY: the host passes a valid pointer, or null.
        unsafe { put([size], bytes.len()) };
        Ok(())
    };
    // SAFETY: the host passes a state of this instance.
    unsafe { serialised(instance, state, count) }
}

/// Serialises a state of a surrogate.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SerializeFMUState(
    instance: *mut Component,
    state: *const State,
    bytes: *mut u8,
    size: usize,
) -> Status {
    let copy = |all: &[u8]| {
        if all.len() != size || bytes.is_null() {
            return Err(format!("a state has {} bytes, the buffer has {size}", all.len()));
        }
        // SAFETY: the host guarantees room for `size` bytes.
        unsafe { bytes.copy_from_nonoverlapping(all.as_ptr(), size) };
        Ok(())
    };
    // SAFETY: the host passes a state of this instance.
    unsafe { serialised(instance, state, copy) }
}

/// Calls `act` with the bytes of a serialised state.
///
/// # Safety
/// `instance` and `state` are null or were returned by functions of this library.
unsafe fn serialised(
    instance: *mut Component,
    state: *const State,
    act: impl FnOnce(&[u8]) -> Result<(), String>,
) -> Status {
    // SAFETY: guaranteed by the caller.
    let state = unsafe { state.as_ref() };
    let bytes = |instance: &mut Instance| {
        let state = state.ok_or_else(|| "the state is null".to_owned())?;
        let bytes = instance.serialised(state);
        act(&bytes.ok_or_else(|| "states of a run cannot be serialised".to_owned())?)
    };
    // SAFETY: guaranteed by the caller.
    unsafe { with(instance, bytes) }
}

/// Creates a state from its serialised bytes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3DeserializeFMUState(
    instance: *mut Component,
    bytes: *const u8,
    size: usize,
    state: *mut *mut State,
) -> Status {
    let read = |instance: &mut Instance| {
        // SAFETY: the host passes `size` bytes.
        let saved = instance.deserialised(unsafe { list(bytes, size) })?;
        // SAFETY: `state` is not null, checked before the call.
        unsafe { keep(saved, state) };
        Ok::<_, String>(())
    };
    if state.is_null() {
        return ERROR;
    }
    // SAFETY: the host passes its instance.
    unsafe { with(instance, read) }
}
