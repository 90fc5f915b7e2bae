//! Log messages of an FMU. All go to the log; the last error message also goes into the error shown
//! to the user.

use std::ffi::{CStr, c_char, c_int, c_void};
use std::sync::{Mutex, PoisonError};

/// Maximum length of a stored message [character].
const LONGEST: usize = 1000;

/// Status returned by a function of FMI.
pub type Status = c_int;
/// Success.
pub const OK: Status = 0;
/// Success with a warning.
pub const WARNING: Status = 1;
/// Call rejected, state unchanged.
pub const DISCARD: Status = 2;
/// Fatal error: all instances of this FMU are unusable.
pub const FATAL: Status = 4;

unsafe extern "C" {
    /// Formats a message of FMI 2.0 and passes it to [`fmu_participant_logged`].
    pub fn fmu_participant_log();
}

/// Stores the last error message. The address must not change during the life of the instance.
#[derive(Debug, Default)]
pub struct Logger {
    last: Mutex<Option<String>>,
}

impl Logger {
    /// Returns the pointer that identifies this logger to an FMU.
    #[must_use]
    pub fn environment(&self) -> *mut c_void {
        std::ptr::from_ref(self).cast_mut().cast()
    }

    /// Takes the last error message since the previous call.
    #[must_use]
    pub fn take(&self) -> Option<String> {
        self.last.lock().unwrap_or_else(PoisonError::into_inner).take()
    }

    fn told(&self, status: Status, text: &str) {
        let line = proto::text::one_line(text.trim());
        match status {
            OK => tracing::debug!("{line}"),
            WARNING => tracing::warn!("{line}"),
            _ => {
                tracing::error!("{line}");
                let short = line.chars().take(LONGEST).collect();
                *self.last.lock().unwrap_or_else(PoisonError::into_inner) = Some(short);
            }
        }
    }
}

/// Receives a formatted message of an instance.
///
/// # Safety
/// `environment` is null or points to a living [`Logger`]; `text` is null or a null-terminated
/// string.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmu_participant_logged(
    environment: *mut c_void,
    status: Status,
    text: *const c_char,
) {
    if environment.is_null() || text.is_null() {
        return;
    }
    // SAFETY: guaranteed by the caller; a logger is only read through shared references.
    let (logger, text) = unsafe { (&*environment.cast::<Logger>(), CStr::from_ptr(text)) };
    logger.told(status, &text.to_string_lossy());
}

/// Logger of FMI 3.0.
///
/// # Safety
/// Same as for [`fmu_participant_logged`].
pub unsafe extern "C" fn log_message(
    environment: *mut c_void,
    status: Status,
    _category: *const c_char,
    text: *const c_char,
) {
    // SAFETY: guaranteed by the caller.
    unsafe { fmu_participant_logged(environment, status, text) };
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Type of the logger as seen from C, with a variable number of arguments.
    type Variadic =
        unsafe extern "C" fn(*mut c_void, *const c_char, Status, *const c_char, *const c_char, ...);

    #[test]
    fn a_format_is_filled_in() {
        let logger = Logger::default();
        // SAFETY: the function is defined in C with this signature.
        unsafe {
            let log: Variadic = std::mem::transmute(fmu_participant_log as *const c_void);
            let (name, of) = (c"one".as_ptr(), c"logStatusError".as_ptr());
            log(logger.environment(), name, 3, of, c"%s is %g\n".as_ptr(), c"x".as_ptr(), 0.5);
        }
        assert_eq!(logger.take().as_deref(), Some("x is 0.5"));
        assert_eq!(logger.take(), None);
    }

    #[test]
    fn only_failures_are_kept_and_none_moves_about() {
        let logger = Logger::default();
        let tell = |status, text: &CStr| {
            let none = std::ptr::null();
            // SAFETY: the logger lives; the text is null-terminated.
            unsafe { log_message(logger.environment(), status, none, text.as_ptr()) };
        };
        tell(WARNING, c"careful");
        assert_eq!(logger.take(), None);
        tell(FATAL, c"gone\x1b[2J");
        assert_eq!(logger.take().as_deref(), Some("gone\\u{1b}[2J"));
    }
}
