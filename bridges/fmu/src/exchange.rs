//! The functions of model exchange, for an FMU without continuous states and events: outputs follow from the inputs.
//!
//! Modelica Association: *Functional Mock-up Interface Specification, version 3.0* (2022), chapter 3.

#![allow(non_snake_case, reason = "names of the standard")]
#![allow(clippy::missing_safety_doc, reason = "the standard says what a host may pass")]

use super::host::{Component, ERROR, Status, put, with};
use super::instance::Instance;

/// Does something with an instance for model exchange.
///
/// # Safety
/// `instance` is null or an instance that a host has passed.
unsafe fn exchanging(
    instance: *mut Component,
    function: &str,
    act: impl FnOnce(&mut Instance) -> Result<(), String>,
) -> Status {
    // SAFETY: as the caller promises.
    let Some(exchange) = (unsafe { instance.as_ref() }).map(|component| component.exchange) else {
        return ERROR;
    };
    let act = |instance: &mut Instance| match exchange {
        true => act(instance),
        false => Err(format!("{function} is for model exchange, this instance for co-simulation")),
    };
    // SAFETY: as the caller promises.
    unsafe { with(instance, act) }
}

/// Functions that only change the mode, of which nothing depends here.
macro_rules! modes {
    ($($name:ident)*) => {
        $(
            /// Nothing depends on the mode.
            #[unsafe(no_mangle)]
            pub unsafe extern "C" fn $name(instance: *mut Component) -> Status {
                // SAFETY: the host passes its instance.
                unsafe { exchanging(instance, stringify!($name), |_| Ok(())) }
            }
        )*
    };
}

modes! { fmi3EnterEventMode fmi3EnterContinuousTimeMode }

/// Functions that count what there is none of.
macro_rules! counts {
    ($($name:ident)*) => {
        $(
            /// There are none.
            #[unsafe(no_mangle)]
            pub unsafe extern "C" fn $name(instance: *mut Component, count: *mut usize) -> Status {
                let none = |_: &mut Instance| {
                    // SAFETY: the host passes a place, or null.
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

/// Functions over lists that are empty.
macro_rules! lists {
    ($($name:ident)*) => {
        $(
            /// The list is empty.
            #[unsafe(no_mangle)]
            pub unsafe extern "C" fn $name(
                instance: *mut Component,
                _values: *mut f64,
                count: usize,
            ) -> Status {
                let none = |_: &mut Instance| match count {
                    0 => Ok(()),
                    _ => Err(format!("{}: {count} of what there is none", stringify!($name))),
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

/// The time now.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SetTime(instance: *mut Component, time: f64) -> Status {
    // SAFETY: the host passes its instance.
    unsafe { exchanging(instance, "fmi3SetTime", |instance| instance.set_time(time)) }
}

/// No discrete state changes, and no event comes.
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
        // SAFETY: the host passes places, or null.
        unsafe { put(flags, false) };
        Ok(())
    };
    // SAFETY: the host passes its instance.
    unsafe { exchanging(instance, "fmi3UpdateDiscreteStates", update) }
}

/// Nothing follows from a step of the host.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3CompletedIntegratorStep(
    instance: *mut Component,
    _no_return: bool,
    enter_event_mode: *mut bool,
    terminate: *mut bool,
) -> Status {
    let done = |_: &mut Instance| {
        // SAFETY: the host passes places, or null.
        unsafe { put([enter_event_mode, terminate], false) };
        Ok(())
    };
    // SAFETY: the host passes its instance.
    unsafe { exchanging(instance, "fmi3CompletedIntegratorStep", done) }
}
