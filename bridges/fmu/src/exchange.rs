//! Functions of FMI 3.0 for model exchange. The FMU has no continuous states and no events: its
//! outputs follow from the inputs.
//!
//! Modelica Association: *Functional Mock-up Interface Specification, version 3.0* (2022),
//! chapter 3.

#![allow(non_snake_case, reason = "names of the standard")]
#![allow(clippy::missing_safety_doc, reason = "the standard says what a host may pass")]

use super::host::{Component, ERROR, Status, put, with};
use super::instance::Instance;

/// Calls `act` with an instance that was made for model exchange.
///
/// # Safety
/// `instance` is null or an instance passed by the host.
unsafe fn exchanging(
    instance: *mut Component,
    function: &str,
    act: impl FnOnce(&mut Instance) -> Result<(), String>,
) -> Status {
    // SAFETY: guaranteed by the caller.
    let Some(exchange) = (unsafe { instance.as_ref() }).map(|component| component.exchange) else {
        return ERROR;
    };
    let act = |instance: &mut Instance| match exchange {
        true => act(instance),
        false => Err(format!("{function} is for model exchange, this instance for co-simulation")),
    };
    // SAFETY: guaranteed by the caller.
    unsafe { with(instance, act) }
}

/// Defines functions that change the mode. The outputs do not depend on the mode.
macro_rules! modes {
    ($($name:ident)*) => {
        $(
            /// Succeeds: the outputs do not depend on the mode.
            #[unsafe(no_mangle)]
            pub unsafe extern "C" fn $name(instance: *mut Component) -> Status {
                // SAFETY: the host passes its instance.
                unsafe { exchanging(instance, stringify!($name), |_| Ok(())) }
            }
        )*
    };
}

modes! { fmi3EnterEventMode fmi3EnterContinuousTimeMode }

/// Defines functions that count states or event indicators; the count is 0.
macro_rules! counts {
    ($($name:ident)*) => {
        $(
            /// Writes 0 to `count`.
            #[unsafe(no_mangle)]
            pub unsafe extern "C" fn $name(instance: *mut Component, count: *mut usize) -> Status {
                let none = |_: &mut Instance| {
                    // SAFETY: the host passes a valid pointer, or null.
                    unsafe { put([count], 0) };
                    Ok(())
                };
                // SAFETY: the host passes its instance.
                unsafe { exchanging(instance, stringify!($name), none) }
            }
        )*
    };
}

counts! { fmi3GetNumberOfEventIndicators fmi3GetNumberOfContinuousStates }

/// Defines functions that read or write a list of states or event indicators; the list is empty.
macro_rules! lists {
    ($($name:ident)*) => {
        $(
            /// Succeeds if `count` is 0: the list is empty.
            #[unsafe(no_mangle)]
            pub unsafe extern "C" fn $name(
                instance: *mut Component,
                _values: *mut f64,
                count: usize,
            ) -> Status {
                let none = |_: &mut Instance| match count {
                    0 => Ok(()),
                    _ => Err(format!("{}: {count} values for an empty list", stringify!($name))),
                };
                // SAFETY: the host passes its instance.
                unsafe { exchanging(instance, stringify!($name), none) }
            }
        )*
    };
}

lists! {
    fmi3SetContinuousStates fmi3GetContinuousStates fmi3GetContinuousStateDerivatives
    fmi3GetNominalsOfContinuousStates fmi3GetEventIndicators
}

/// Sets the present time [s].
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SetTime(instance: *mut Component, time: f64) -> Status {
    // SAFETY: the host passes its instance.
    unsafe { exchanging(instance, "fmi3SetTime", |instance| instance.set_time(time)) }
}

/// Reports that no discrete state changes and no event follows.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3UpdateDiscreteStates(
    instance: *mut Component,
    update_needed: *mut bool,
    terminate: *mut bool,
    nominals_changed: *mut bool,
    values_changed: *mut bool,
    next_event_defined: *mut bool,
    _next_event: *mut f64,
) -> Status {
    let flags = [update_needed, terminate, nominals_changed, values_changed, next_event_defined];
    let update = |_: &mut Instance| {
        // SAFETY: the host passes valid pointers, or null.
        unsafe { put(flags, false) };
        Ok(())
    };
    // SAFETY: the host passes its instance.
    unsafe { exchanging(instance, "fmi3UpdateDiscreteStates", update) }
}

/// Reports that the step of the integrator causes no event and does not end the simulation.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3CompletedIntegratorStep(
    instance: *mut Component,
    _no_return: bool,
    enter_event_mode: *mut bool,
    terminate: *mut bool,
) -> Status {
    let done = |_: &mut Instance| {
        // SAFETY: the host passes valid pointers, or null.
        unsafe { put([enter_event_mode, terminate], false) };
        Ok(())
    };
    // SAFETY: the host passes its instance.
    unsafe { exchanging(instance, "fmi3CompletedIntegratorStep", done) }
}
