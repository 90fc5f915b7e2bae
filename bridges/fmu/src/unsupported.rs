//! Functions of FMI 3.0 that this FMU does not support. They return an error.
//!
//! Only the first argument is declared. On all platforms of these FMUs the caller removes the other
//! arguments.

#![allow(non_snake_case, reason = "names of the standard")]
#![allow(clippy::missing_safety_doc, reason = "the standard says what a host may pass")]

use super::host::{Component, Status, with};
use super::instance::Instance;

/// Defines unsupported functions.
macro_rules! unsupported {
    ($($name:ident)*) => {
        $(
            /// Not supported: returns an error.
            #[unsafe(no_mangle)]
            pub unsafe extern "C" fn $name(instance: *mut Component) -> Status {
                let refuse = |_: &mut Instance| Err::<(), _>(concat!(stringify!($name), " is not supported").to_owned());
                // SAFETY: the host passes its instance.
                unsafe { with(instance, refuse) }
            }
        )*
    };
}

unsupported! {
    fmi3EnterStepMode fmi3EnterConfigurationMode fmi3ExitConfigurationMode fmi3GetFloat32
    fmi3GetInt8 fmi3GetUInt8 fmi3GetInt16 fmi3GetUInt16 fmi3GetInt32 fmi3GetUInt32 fmi3GetInt64
    fmi3GetUInt64 fmi3GetBoolean fmi3GetString fmi3GetBinary fmi3GetClock fmi3SetFloat32
    fmi3SetInt8 fmi3SetUInt8 fmi3SetInt16 fmi3SetUInt16 fmi3SetInt32 fmi3SetUInt32 fmi3SetInt64
    fmi3SetUInt64 fmi3SetBoolean fmi3SetString fmi3SetBinary fmi3SetClock
    fmi3GetNumberOfVariableDependencies fmi3GetVariableDependencies fmi3GetDirectionalDerivative
    fmi3GetAdjointDerivative fmi3GetOutputDerivatives fmi3GetIntervalDecimal
    fmi3GetIntervalFraction fmi3GetShiftDecimal fmi3GetShiftFraction fmi3SetIntervalDecimal
    fmi3SetIntervalFraction fmi3SetShiftDecimal fmi3SetShiftFraction fmi3EvaluateDiscreteStates
    fmi3ActivateModelPartition
}
