//! What a host passes, and what it is told.

use super::child::Fault;
use super::instance::Instance;
use std::ffi::{CStr, CString, c_char, c_int, c_void};
use std::slice;
use std::sync::Mutex;

/// What a function has done: [`OK`], [`WARNING`] or [`ERROR`], as the standard numbers them.
pub type Status = c_int;
/// Done.
pub const OK: Status = 0;
/// Done, with something that the host has been told.
pub const WARNING: Status = 1;
/// Not done.
pub const ERROR: Status = 3;

/// Receives messages of an instance.
pub type LogMessage =
    Option<unsafe extern "C" fn(*mut c_void, Status, *const c_char, *const c_char)>;

/// An instance, and whom it tells what.
#[derive(Debug)]
pub struct Component {
    /// The instance. One call at a time has it: FMI forbids others, and they get an error.
    pub instance: Mutex<Instance>,
    /// It is for model exchange.
    pub exchange: bool,
    /// Whom it tells.
    pub logger: Logger,
}

/// Who receives messages.
#[derive(Clone, Copy, Debug)]
pub struct Logger {
    /// Handed back with every message.
    pub environment: *mut c_void,
    /// The function of the host.
    pub tell: LogMessage,
}

impl Logger {
    /// Tells an error.
    pub fn error(self, message: &str) -> Status {
        self.say(ERROR, c"logStatusError", message)
    }

    fn say(self, status: Status, category: &CStr, message: &str) -> Status {
        let text = CString::new(message.replace('\0', " ")).unwrap_or_default();
        if let Some(tell) = self.tell {
            // SAFETY: the host gave this function for such calls; both texts live until it returns.
            unsafe { tell(self.environment, status, category.as_ptr(), text.as_ptr()) };
        }
        status
    }
}

/// The text that a host has passed.
///
/// # Safety
/// `text` is null or a string that ends with a null.
pub unsafe fn text<'a>(text: *const c_char) -> Option<&'a str> {
    if text.is_null() {
        return None;
    }
    // SAFETY: as the caller promises.
    unsafe { CStr::from_ptr(text) }.to_str().ok()
}

/// Does something with an instance that a host has passed.
///
/// # Safety
/// `instance` is null or what `fmi3InstantiateCoSimulation` or `fmi3InstantiateModelExchange` gave, and is not freed
/// before this returns.
pub unsafe fn with<D: Done, E: Message>(
    instance: *mut Component,
    act: impl FnOnce(&mut Instance) -> Result<D, E>,
) -> Status {
    // SAFETY: as the caller promises.
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

/// What was done may leave a remark.
pub trait Done {
    /// The remark.
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

/// What a host is told.
pub trait Message {
    /// In words.
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
pub unsafe fn list<'a, T>(first: *const T, count: usize) -> &'a [T] {
    if first.is_null() || count == 0 {
        return &[];
    }
    // SAFETY: as the caller promises.
    unsafe { slice::from_raw_parts(first, count) }
}

/// Writes a value to each of some places that a host has passed, of which any may be null.
///
/// # Safety
/// Each is null or a place for a value.
pub unsafe fn put<T: Copy, const N: usize>(places: [*mut T; N], value: T) {
    for place in places.into_iter().filter(|place| !place.is_null()) {
        // SAFETY: as the caller promises.
        unsafe { place.write(value) };
    }
}
