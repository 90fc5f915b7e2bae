//! Data passed by the host, and messages to the host.

use super::child::Fault;
use super::instance::Instance;
use std::ffi::{CStr, CString, c_char, c_int, c_void};
use std::slice;
use std::sync::Mutex;

/// Result of a function: [`OK`], [`WARNING`] or [`ERROR`], numbered as in the standard.
pub type Status = c_int;
/// Success.
pub const OK: Status = 0;
/// Success, with a warning sent to the host.
pub const WARNING: Status = 1;
/// Failure.
pub const ERROR: Status = 3;

/// Function of the host that receives log messages.
pub type LogMessage =
    Option<unsafe extern "C" fn(*mut c_void, Status, *const c_char, *const c_char)>;

/// Instance with the connection to its host.
#[derive(Debug)]
pub struct Component {
    /// The instance. FMI forbids concurrent calls; a second call gets an error.
    pub instance: Mutex<Instance>,
    /// True for model exchange, false for co-simulation.
    pub exchange: bool,
    /// Receiver of messages.
    pub logger: Logger,
}

/// Receiver of messages of an instance.
#[derive(Clone, Copy, Debug)]
pub struct Logger {
    /// Pointer that the host gets back with every message.
    pub environment: *mut c_void,
    /// Log function of the host.
    pub tell: LogMessage,
}

impl Logger {
    /// Sends an error message and returns [`ERROR`].
    pub fn error(self, message: &str) -> Status {
        self.say(ERROR, c"logStatusError", message)
    }

    fn say(self, status: Status, category: &CStr, message: &str) -> Status {
        let text = CString::new(message.replace('\0', " ")).unwrap_or_default();
        if let Some(tell) = self.tell {
            // SAFETY: the host provided this function for such calls; both texts live until it
            // returns.
            unsafe { tell(self.environment, status, category.as_ptr(), text.as_ptr()) };
        }
        status
    }
}

/// Reads a text passed by the host; `None` if null or not UTF-8.
///
/// # Safety
/// `text` is null or a null-terminated string.
pub unsafe fn text<'a>(text: *const c_char) -> Option<&'a str> {
    if text.is_null() {
        return None;
    }
    // SAFETY: guaranteed by the caller.
    unsafe { CStr::from_ptr(text) }.to_str().ok()
}

/// Calls `act` with an instance passed by the host, and reports warnings and errors to the host.
///
/// # Safety
/// `instance` is null or was returned by `fmi3InstantiateCoSimulation` or
/// `fmi3InstantiateModelExchange`, and is not freed before this function returns.
pub unsafe fn with<D: Done, E: Message>(
    instance: *mut Component,
    act: impl FnOnce(&mut Instance) -> Result<D, E>,
) -> Status {
    // SAFETY: guaranteed by the caller.
    let Some(component) = (unsafe { instance.as_ref() }) else { return ERROR };
    let Ok(mut instance) = component.instance.try_lock() else {
        return component.logger.error("another call of this instance has not returned yet");
    };
    let acted = act(&mut instance);
    drop(instance);
    match acted {
        Ok(done) => match done.remark() {
            Some(remark) => component.logger.say(WARNING, c"logStatusWarning", &remark),
            None => OK,
        },
        Err(error) => component.logger.error(&error.message()),
    }
}

/// Result of a successful call, which may carry a warning.
pub trait Done {
    /// Returns the warning for the host.
    fn remark(self) -> Option<String>;
}

impl Done for () {
    fn remark(self) -> Option<String> {
        None
    }
}

impl Done for Option<String> {
    fn remark(self) -> Option<String> {
        self
    }
}

/// Error that can be reported to the host.
pub trait Message {
    /// Returns the error message for the host.
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

/// Returns a list passed by the host; the list may be null if empty.
///
/// # Safety
/// `first` is null or points to `count` values.
pub unsafe fn list<'a, T>(first: *const T, count: usize) -> &'a [T] {
    if first.is_null() || count == 0 {
        return &[];
    }
    // SAFETY: guaranteed by the caller.
    unsafe { slice::from_raw_parts(first, count) }
}

/// Writes a value through every pointer that is not null.
///
/// # Safety
/// Each pointer is null or valid for writes.
pub unsafe fn put<T: Copy, const N: usize>(places: [*mut T; N], value: T) {
    for place in places.into_iter().filter(|place| !place.is_null()) {
        // SAFETY: guaranteed by the caller.
        unsafe { place.write(value) };
    }
}
