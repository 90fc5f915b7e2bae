//! Errors of callbacks, and protection of C from Rust panics.
//!
//! A callback returns a status. The reason is stored per thread by [`cosim_refuse`], [`cosim_fail`]
//! and every accessor that detects an error.

use proto::configuration::Refusal;
use std::any::Any;
use std::cell::RefCell;
use std::ffi::{CStr, c_char, c_int};
use std::fmt;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// Status of a callback or function: success.
pub const COSIM_OK: c_int = 0;
/// Status of a callback or function: the case is refused, see cosim_refuse().
pub const COSIM_REFUSED: c_int = 1;
/// Status of a callback or function: failure, see cosim_fail().
pub const COSIM_FAILED: c_int = 2;

/// Reason for the failure of a callback.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Fault {
    /// The case is not supported.
    Refused(Refusal),
    /// The callback failed.
    Failed(String),
    /// The interface was misused; the callback fails whatever its status.
    Misused(String),
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Refused(refusal) => refusal.fmt(f),
            Self::Failed(text) | Self::Misused(text) => f.write_str(text),
        }
    }
}

thread_local! {
    static FAULT: RefCell<Option<Fault>> = const { RefCell::new(None) };
}

/// Records a fault for the running callback and returns its status.
fn record(fault: Fault) -> c_int {
    let status = if matches!(fault, Fault::Refused(_)) { COSIM_REFUSED } else { COSIM_FAILED };
    FAULT.with_borrow_mut(|kept| {
        if !matches!(kept, Some(Fault::Misused(_))) {
            *kept = Some(fault);
        }
    });
    status
}

/// Runs a callback that returns a status.
pub(crate) fn call(name: &str, callback: impl FnOnce() -> c_int) -> Result<(), Fault> {
    FAULT.set(None);
    let status = callback();
    match (status, FAULT.take()) {
        (_, Some(misused @ Fault::Misused(_))) => Err(misused),
        (COSIM_OK, _) => Ok(()),
        (_, Some(fault)) => Err(fault),
        (status, None) => Err(Fault::Failed(format!(
            "`{name}` returned {status} without a reason (cosim_fail, cosim_refuse)"
        ))),
    }
}

/// Runs a callback that returns a text owned by the solver, or NULL on failure.
pub(crate) fn call_text(
    name: &str,
    callback: impl FnOnce() -> *const c_char,
) -> Result<String, Fault> {
    let mut text = None;
    call(name, || {
        let answer = callback();
        if answer.is_null() {
            return COSIM_FAILED;
        }
        // SAFETY: the header requires a NUL-terminated string that outlives the callback.
        text = Some(unsafe { CStr::from_ptr(answer) }.to_string_lossy().into_owned());
        COSIM_OK
    })?;
    Ok(text.expect("a callback without a text has failed"))
}

/// Return type of an exported function, with a value for failure.
pub(crate) trait Unsuccessful {
    fn with(status: c_int) -> Self;
}

impl Unsuccessful for c_int {
    fn with(status: c_int) -> Self {
        status
    }
}

impl Unsuccessful for bool {
    fn with(_: c_int) -> Self {
        false
    }
}

impl Unsuccessful for usize {
    fn with(_: c_int) -> Self {
        0
    }
}

impl<T> Unsuccessful for *const T {
    fn with(_: c_int) -> Self {
        std::ptr::null()
    }
}

impl<T> Unsuccessful for *mut T {
    fn with(_: c_int) -> Self {
        std::ptr::null_mut()
    }
}

/// Runs the body of an exported function; records faults and panics.
pub(crate) fn guard<T: Unsuccessful>(name: &str, body: impl FnOnce() -> Result<T, Fault>) -> T {
    let fault = match catch_unwind(AssertUnwindSafe(body)) {
        Ok(Ok(value)) => return value,
        Ok(Err(Fault::Misused(text))) => Fault::Misused(format!("{name}: {text}")),
        Ok(Err(fault)) => fault,
        Err(panic) => Fault::Misused(format!("{name} panicked: {}", panic_text(&*panic))),
    };
    T::with(record(fault))
}

/// Returns the message of a panic.
pub(crate) fn panic_text(panic: &(dyn Any + Send)) -> String {
    let text = panic.downcast_ref::<&str>().map(|text| (*text).to_owned());
    let text = text.or_else(|| panic.downcast_ref::<String>().cloned());
    text.unwrap_or_else(|| "without a text".to_owned())
}

/// Reads a text argument.
///
/// # Safety
/// `text` must be NULL or point to a NUL-terminated string that lives for `'a`.
pub(crate) unsafe fn text<'a>(what: &str, text: *const c_char) -> Result<&'a str, Fault> {
    if text.is_null() {
        return Err(Fault::Misused(format!("`{what}` is NULL")));
    }
    // SAFETY: not NULL; the caller guarantees the rest.
    let text = unsafe { CStr::from_ptr(text) };
    text.to_str().map_err(|_| Fault::Misused(format!("`{what}` is not UTF-8: {text:?}")))
}

/// Reads an argument by shared reference.
///
/// # Safety
/// `pointer` must be NULL or point to a `T` that is not modified during `'a`.
pub(crate) unsafe fn shared<'a, T>(what: &str, pointer: *const T) -> Result<&'a T, Fault> {
    // SAFETY: guaranteed by the caller.
    unsafe { pointer.as_ref() }.ok_or_else(|| Fault::Misused(format!("`{what}` is NULL")))
}

/// Reads an argument by exclusive reference.
///
/// # Safety
/// `pointer` must be NULL or point to a `T` that nothing else uses during `'a`.
pub(crate) unsafe fn exclusive<'a, T>(what: &str, pointer: *mut T) -> Result<&'a mut T, Fault> {
    // SAFETY: guaranteed by the caller.
    unsafe { pointer.as_mut() }.ok_or_else(|| Fault::Misused(format!("`{what}` is NULL")))
}

/// Refuses the case; the run ends before it has begun, with exit code 2.
///
/// For configure and build: `return cosim_refuse(...)`. `key` is the dotted key of the case at
/// fault ("motion.speed"), `reason` states why its value is refused, `fix` what to write instead.
/// All three are copied. Returns COSIM_REFUSED.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cosim_refuse(
    key: *const c_char,
    reason: *const c_char,
    fix: *const c_char,
) -> c_int {
    guard("cosim_refuse", || {
        // SAFETY: the header requires strings.
        let (key, reason, fix) =
            unsafe { (text("key", key)?, text("reason", reason)?, text("fix", fix)?) };
        Err(Fault::Refused(Refusal::new(key, reason, fix)))
    })
}

/// Reports the failure of a callback; the run ends with exit code 1 and this text as its error.
///
/// Use `return cosim_fail("...")` in any callback, on the thread of the call. `message` is copied.
/// Returns COSIM_FAILED.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cosim_fail(message: *const c_char) -> c_int {
    guard("cosim_fail", || {
        // SAFETY: the header requires a string.
        let message = unsafe { text("message", message)? };
        Err(Fault::Failed(message.to_owned()))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_reason_counts_and_success_forgets_it() {
        let refuse = || unsafe { cosim_refuse(c"a.b".as_ptr(), c"no".as_ptr(), c"yes".as_ptr()) };
        let fail = || unsafe { cosim_fail(c"broken".as_ptr()) };
        let refused = Err(Fault::Refused(Refusal::new("a.b", "no", "yes")));
        assert_eq!(call("x", refuse), refused);
        assert_eq!(call("x", || [refuse(), fail()][1]), Err(Fault::Failed("broken".to_owned())));
        assert_eq!(call("x", || fail() - COSIM_FAILED), Ok(()));
        let silent = call("x", || 7).unwrap_err().to_string();
        assert_eq!(silent, "`x` returned 7 without a reason (cosim_fail, cosim_refuse)");
    }

    #[test]
    fn misuse_is_not_forgotten() {
        let misused = call("x", || {
            unsafe { cosim_fail(std::ptr::null()) };
            unsafe { cosim_fail(c"something else".as_ptr()) };
            COSIM_OK
        });
        let text = "cosim_fail: `message` is NULL".to_owned();
        assert_eq!(misused, Err(Fault::Misused(text)));
        let latin = [0xe9_u8, 0].map(|c| c as c_char);
        let misused = call("x", || unsafe { cosim_fail(latin.as_ptr()) });
        assert!(misused.unwrap_err().to_string().contains("not UTF-8"));
    }

    #[test]
    fn a_panic_becomes_a_fault() {
        let status = |n: usize| guard::<c_int>("f", || Ok([COSIM_OK][n]));
        assert_eq!(call("x", || status(0)), Ok(()));
        let fault = call("x", || status(1)).unwrap_err().to_string();
        assert!(fault.starts_with("f panicked: index out of bounds"), "{fault}");
        let fault = call("x", || [status(1), COSIM_OK][1]).unwrap_err();
        assert!(matches!(fault, Fault::Misused(_)), "also if the callback does not say so");
    }

    #[test]
    fn a_text_of_the_solvers() {
        assert_eq!(call_text("x", || c"{}".as_ptr()), Ok("{}".to_owned()));
        let none = call_text("x", std::ptr::null).unwrap_err().to_string();
        assert!(none.starts_with("`x` returned 2 without a reason"), "{none}");
    }
}
