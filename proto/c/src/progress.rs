//! Progress reports, as sent by C.

use crate::fault::{COSIM_OK, guard, text};
use proto::progress::Progress;
use std::ffi::{c_char, c_int};
use std::sync::{Mutex, PoisonError};

/// Destination of the program's reports, from any thread.
static REPORTS: Mutex<Option<Progress>> = Mutex::new(None);

/// Directs reports to `progress`.
pub(crate) fn report_to(progress: &Progress) {
    *REPORTS.lock().unwrap_or_else(PoisonError::into_inner) = Some(progress.clone());
}

/// Reports the progress of build, solve, save or restore: `done` of `of` units of work; `of` is 0
/// if unknown. `what` names the activity in one ASCII word of at most 31 letters ("factorising").
/// May be called from any thread, as often as needed.
///
/// Whenever the report changes, the coordinator restarts its deadline and shows the report to the
/// user.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cosim_progress(done: u64, of: u64, what: *const c_char) -> c_int {
    guard("cosim_progress", || {
        // SAFETY: the header requires a string.
        let what = unsafe { text("what", what)? };
        let reports = REPORTS.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(progress) = &*reports {
            progress.report(done, of, what);
        }
        Ok(COSIM_OK)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Whether a report arrives is tested with a program, because `REPORTS` belongs to the process.
    #[test]
    fn null_is_refused() {
        assert_ne!(unsafe { cosim_progress(4, 4, std::ptr::null()) }, COSIM_OK);
    }
}
