//! Table of callbacks of a program in C, and its checks.

use crate::configuration::CosimConfiguration;
use crate::fields::{CosimBlob, CosimInputs, CosimOutputs};
use crate::layout::CosimLayout;
use crate::moves::CosimMoves;
use proto::model::{Step, StepReport};
use std::ffi::{c_char, c_int, c_void};
use std::mem::MaybeUninit;

/// Version of this interface; raised when programs must be changed, not only recompiled.
pub const COSIM_VERSION: u32 = 4;

/// Flag of cosim_report.present: the program reports the power that it receives.
pub const COSIM_RECEIVED_POWER: u32 = 1;

/// Flag of cosim_report.present: the program limits the window.
pub const COSIM_WANTED_WINDOW: u32 = 2;

/// Smallest size of the table in this version [byte].
const FIRST_SIZE: usize = size_of::<CosimSolver>();

/// One iteration of one window.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CosimStep {
    /// Number of the window, from 0.
    pub window: u64,
    /// Iteration within the window, from 1.
    pub iteration: u32,
    /// Start of the window [s].
    pub start: f64,
    /// End of the window [s]; equal to start in a steady case.
    pub end: f64,
}

impl From<&Step> for CosimStep {
    fn from(step: &Step) -> Self {
        let Step { window, iteration, start, end } = *step;
        Self { window, iteration, start, end }
    }
}

/// Report of a solve, besides its outputs. The library initialises all members to 0.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CosimReport {
    /// Number of steps inside the window.
    pub substeps: u32,
    /// Number of iterations of the inner solver.
    pub inner_iterations: u32,
    /// Number of elementary operations, in the program's own unit.
    pub work: u64,
    /// Any of COSIM_RECEIVED_POWER and COSIM_WANTED_WINDOW: the quantities that the program
    /// reports.
    pub present: u32,
    /// Mean power received through conservative inputs over the window [W]; the coordinator
    /// compares it with the power sent.
    pub received_power: f64,
    /// Longest window that the program accepts from the start of this one [s], limited by an event
    /// or by accuracy. Adaptive windows respect a shorter value.
    pub wanted_window: f64,
}

impl CosimReport {
    pub(crate) const EMPTY: Self = Self {
        substeps: 0,
        inner_iterations: 0,
        work: 0,
        present: 0,
        received_power: 0.0,
        wanted_window: 0.0,
    };
}

impl From<CosimReport> for StepReport {
    fn from(report: CosimReport) -> Self {
        let reported = |flag, value| (report.present & flag != 0).then_some(value);
        Self {
            substeps: report.substeps,
            inner_iterations: report.inner_iterations,
            work: report.work,
            received_power: reported(COSIM_RECEIVED_POWER, report.received_power),
            wanted_window: reported(COSIM_WANTED_WINDOW, report.wanted_window),
        }
    }
}

/// A solver: its callbacks. Each is called with the `user` of cosim_main() as the first argument,
/// and never from two threads at once.
///
/// A callback returns COSIM_OK, or the result of cosim_refuse() or cosim_fail(). A callback that
/// returns a text returns NULL after one of these. A callback must not throw a C++ exception nor
/// longjmp out. Optional callbacks may be NULL; describe, configure and solve are required.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct CosimSolver {
    /// sizeof(cosim_solver); callbacks appended in a later version are NULL for this program.
    pub size: usize,
    /// COSIM_VERSION.
    pub version: u32,
    /// Returns the description of the program as JSON (see proto/c/README.md); called once. The
    /// program owns the text, which must stay valid until destroy.
    pub describe: Option<unsafe extern "C" fn(user: *mut c_void) -> *const c_char>,
    /// Checks a configuration and sets grids and cost. Cheap; allocates no fields. May be called
    /// more than once; the last call counts.
    pub configure: Option<
        unsafe extern "C" fn(
            user: *mut c_void,
            configuration: *const CosimConfiguration<'_>,
            layout: *mut CosimLayout,
        ) -> c_int,
    >,
    /// Allocates everything the solver needs. NULL: nothing to allocate. A program that describes
    /// itself as "reusable" is configured and built again for another run, in which nothing of the
    /// previous run may remain.
    pub build: Option<unsafe extern "C" fn(user: *mut c_void) -> c_int>,
    /// Writes the initial outputs, before the first solve. NULL: zeros.
    pub first_outputs:
        Option<unsafe extern "C" fn(user: *mut c_void, outputs: *mut CosimOutputs<'_>) -> c_int>,
    /// Solves one window from the accepted state with the given inputs, and writes the outputs. A
    /// window may be solved any number of times; only accept advances the state.
    pub solve: Option<
        unsafe extern "C" fn(
            user: *mut c_void,
            step: *const CosimStep,
            inputs: *const CosimInputs<'_>,
            outputs: *mut CosimOutputs<'_>,
            report: *mut CosimReport,
        ) -> c_int,
    >,
    /// Makes the last solve the accepted state. NULL: the program has no state.
    pub accept: Option<unsafe extern "C" fn(user: *mut c_void) -> c_int>,
    /// Writes the observed fields of the accepted state, which are output fields not needed in
    /// every iteration. NULL: runs that observe a field are refused.
    pub observe:
        Option<unsafe extern "C" fn(user: *mut c_void, outputs: *mut CosimOutputs<'_>) -> c_int>,
    /// Writes the accepted state with cosim_blob_write(). NULL, together with restore: the program
    /// has no state.
    pub save: Option<unsafe extern "C" fn(user: *mut c_void, blob: *mut CosimBlob<'_>) -> c_int>,
    /// Restores a saved state, which it must read completely with cosim_blob_read(); the run then
    /// continues bit-identically.
    pub restore: Option<unsafe extern "C" fn(user: *mut c_void, blob: *mut CosimBlob<'_>) -> c_int>,
    /// Returns the program's part of summary.json, a JSON object of sections that are merged over
    /// the participants: {"temperature": {...}}. The program owns the text, which must stay valid
    /// until destroy. NULL: no summary.
    pub summary: Option<unsafe extern "C" fn(user: *mut c_void) -> *const c_char>,
    /// Frees the resources of `user`; called once, last.
    pub destroy: Option<unsafe extern "C" fn(user: *mut c_void)>,
    /// Supplies the geometry of the layout's volumes and moving grids in the accepted state, with
    /// cosim_geometry(). Called after build, accept and restore, if any of these grids is needed;
    /// the geometry must not change in between. NULL: there are no such grids.
    pub moved_grids:
        Option<unsafe extern "C" fn(user: *mut c_void, moves: *mut CosimMoves<'_>) -> c_int>,
    /// Frees the allocations of build, because the run is over. Called after every successful
    /// build, even if the run failed. NULL: destroy or the next build frees them.
    pub finish: Option<unsafe extern "C" fn(user: *mut c_void) -> c_int>,
}

/// Returns the table with every callback unset, like `{0}` in C.
#[cfg(test)]
pub(crate) fn empty() -> CosimSolver {
    // SAFETY: all-zero means NULL, hence `None`, for every member except the numbers.
    let zeroed: CosimSolver = unsafe { std::mem::zeroed() };
    CosimSolver { size: size_of::<CosimSolver>(), version: COSIM_VERSION, ..zeroed }
}

/// Reads the table of a program.
///
/// # Safety
/// `solver` must be NULL or point to as many bytes as its first member states.
pub(crate) unsafe fn read(solver: *const CosimSolver) -> Result<CosimSolver, String> {
    if solver.is_null() {
        return Err("cosim_main: `solver` is NULL".to_owned());
    }
    // SAFETY: not NULL; every table begins with these two members.
    let (size, version) = unsafe { ((*solver).size, (*solver).version) };
    if version != COSIM_VERSION || !(FIRST_SIZE..=size_of::<CosimSolver>()).contains(&size) {
        return Err(format!(
            "cosim_solver has version {version} and size {size}; this library has {COSIM_VERSION} \
             and {}: set `.size = sizeof(cosim_solver), .version = COSIM_VERSION`, and compile with \
             the library's own cosim.h",
            size_of::<CosimSolver>()
        ));
    }
    let mut table = MaybeUninit::<CosimSolver>::zeroed();
    // SAFETY: `size` bytes exist, at most the size of the table; the rest stays zero, which is NULL
    // for a callback.
    let table = unsafe {
        table.as_mut_ptr().cast::<u8>().copy_from_nonoverlapping(solver.cast(), size);
        table.assume_init()
    };
    table.check().map(|()| table)
}

impl CosimSolver {
    fn check(&self) -> Result<(), String> {
        let there = [
            ("describe", self.describe.is_some()),
            ("configure", self.configure.is_some()),
            ("solve", self.solve.is_some()),
        ];
        if let Some((name, _)) = there.iter().find(|(_, there)| !there) {
            return Err(format!("cosim_solver.{name} is NULL; a solver needs it"));
        }
        if self.save.is_some() != self.restore.is_some() {
            return Err("cosim_solver has one of `save` and `restore`; a state needs both".into());
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    unsafe extern "C" fn text(_: *mut c_void) -> *const c_char {
        c"{}".as_ptr()
    }
    unsafe extern "C" fn configure(
        _: *mut c_void,
        _: *const CosimConfiguration<'_>,
        _: *mut CosimLayout,
    ) -> c_int {
        0
    }
    unsafe extern "C" fn solve(
        _: *mut c_void,
        _: *const CosimStep,
        _: *const CosimInputs<'_>,
        _: *mut CosimOutputs<'_>,
        _: *mut CosimReport,
    ) -> c_int {
        0
    }
    unsafe extern "C" fn save(_: *mut c_void, _: *mut CosimBlob<'_>) -> c_int {
        0
    }

    #[test]
    fn a_table_is_checked() {
        let least = CosimSolver {
            describe: Some(text),
            configure: Some(configure),
            solve: Some(solve),
            ..empty()
        };
        assert!(unsafe { read(&raw const least) }.is_ok());
        let wrong = [
            (CosimSolver { describe: None, ..least }, "describe is NULL"),
            (CosimSolver { configure: None, ..least }, "configure is NULL"),
            (CosimSolver { solve: None, ..least }, "solve is NULL"),
            (CosimSolver { save: Some(save), ..least }, "a state needs both"),
            (CosimSolver { version: 1, ..least }, "version 1"),
            (CosimSolver { size: 0, ..least }, "size 0"),
            (CosimSolver { size: least.size + 8, ..least }, "sizeof(cosim_solver)"),
        ];
        for (table, why) in wrong {
            let error = unsafe { read(&raw const table) }.unwrap_err();
            assert!(error.contains(why), "{error}");
        }
        assert!(unsafe { read(std::ptr::null()) }.unwrap_err().contains("is NULL"));
    }

    #[test]
    fn what_a_report_does_not_say_is_absent() {
        let nothing = StepReport::from(CosimReport::EMPTY);
        assert_eq!(nothing, StepReport::default());
        let report = |present| {
            let report = CosimReport { present, wanted_window: 2.0, ..CosimReport::EMPTY };
            let report = StepReport::from(report);
            (report.received_power, report.wanted_window)
        };
        assert_eq!(report(COSIM_RECEIVED_POWER), (Some(0.0), None));
        assert_eq!(report(COSIM_RECEIVED_POWER | COSIM_WANTED_WINDOW), (Some(0.0), Some(2.0)));
    }
}
