//! How far the program is, as C says it.

use crate::fault::{COSIM_OK, guard, text};
use proto::progress::Progress;
use std::ffi::{c_char, c_int};
use std::sync::{Mutex, PoisonError};

/// Where the program's reports go: it may report from any thread, and is one participant.
static REPORTS: Mutex<Option<Progress>> = Mutex::new(None);

/// Reports go there from now on.
pub(crate) fn report_to(progress: &Progress) {
    *REPORTS.lock().unwrap_or_else(PoisonError::into_inner) = Some(progress.clone());
}

/// Says how far build, solve, save or restore is: `done` of `of` in the program's own measure, `of`
/// being 0 if nobody knows; `what` is being done, in an ASCII word of at most 31 letters
/// ("factorising"). From any thread, as often as the program likes.
///
/// Whenever it changes, the deadline of the coordinator starts anew, and the user sees it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cosim_progress(done: u64, of: u64, what: *const c_char) -> c_int {
    guard("cosim_progress", || {
        // SAFETY: the header asks for a string.
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

    #[test]
    fn a_report_arrives_and_null_is_reported() {
        let progress = Progress::default();
        report_to(&progress);
        assert_eq!(unsafe { cosim_progress(3, 4, c"summing".as_ptr()) }, COSIM_OK);
        assert_eq!(progress.newest().unwrap().to_string(), "3 of 4 summing");
        assert_ne!(unsafe { cosim_progress(4, 4, std::ptr::null()) }, COSIM_OK);
        assert_eq!(progress.newest().unwrap().done, 3);
    }
}
