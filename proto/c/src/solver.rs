//! The table of callbacks that is a program in C, and what it is checked for.

use crate::configuration::CosimConfiguration;
use crate::fields::{CosimBlob, CosimInputs, CosimOutputs};
use crate::layout::CosimLayout;
use crate::moves::CosimMoves;
use proto::model::{Step, StepReport};
use std::ffi::{c_char, c_int, c_void};
use std::mem::MaybeUninit;

/// Version of this interface. Raised when a program has to be changed, and not only compiled again.
pub const COSIM_VERSION: u32 = 3;

/// The smallest table that there has ever been under this version [byte].
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

/// What a solve says besides its outputs. The library sets everything to 0 or NAN before.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CosimReport {
    /// Steps taken inside the window.
    pub substeps: u32,
    /// Iterations of the inner solver.
    pub inner_iterations: u32,
    /// Number of elementary operations in the program's own measure.
    pub work: u64,
    /// Heat received through conservative inputs, as the mean power over the window [W]: the
    /// coordinator's audit compares it with what was sent. NAN for a program that receives none.
    pub heat_received: f64,
    /// Longest window that the program would take from this one's start [s]: up to an event, or for
    /// its accuracy. Adaptive windows obey it where it is shorter. NAN for no wish.
    pub wanted_window: f64,
}

impl CosimReport {
    pub(crate) const EMPTY: Self = Self {
        substeps: 0,
        inner_iterations: 0,
        work: 0,
        heat_received: f64::NAN,
        wanted_window: f64::NAN,
    };
}

impl From<CosimReport> for StepReport {
    fn from(report: CosimReport) -> Self {
        let said = |value: f64| (!value.is_nan()).then_some(value);
        Self {
            substeps: report.substeps,
            inner_iterations: report.inner_iterations,
            work: report.work,
            heat_received: said(report.heat_received),
            wanted_window: said(report.wanted_window),
        }
    }
}

/// A solver: its callbacks, each called with the `user` of cosim_main() as the first argument, and
/// never from two threads at once.
///
/// A callback answers COSIM_OK, or what cosim_refuse() or cosim_fail() return; one that answers with
/// a text, NULL after one of these. It must not throw a C++ exception nor jump out. A callback that
/// is NULL is left out; describe, configure and solve must be there.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct CosimSolver {
    /// sizeof(cosim_solver): callbacks that a later version appends are NULL for this program.
    pub size: usize,
    /// COSIM_VERSION.
    pub version: u32,
    /// What the program can do, as JSON (see proto/c/README.md); called once. The text is the
    /// program's and stays until destroy.
    pub describe: Option<unsafe extern "C" fn(user: *mut c_void) -> *const c_char>,
    /// Checks a configuration and answers with grids and cost; cheap, allocates no field. May be
    /// called more than once, the last one counts.
    pub configure: Option<
        unsafe extern "C" fn(
            user: *mut c_void,
            configuration: *const CosimConfiguration<'_>,
            layout: *mut CosimLayout,
        ) -> c_int,
    >,
    /// Allocates everything the solver needs. NULL: nothing. A program that describes itself as
    /// "reusable" is configured and built again for another run, in which nothing of the one before
    /// may be left.
    pub build: Option<unsafe extern "C" fn(user: *mut c_void) -> c_int>,
    /// Writes the outputs that hold before the first solve. NULL: zeros.
    pub first_outputs:
        Option<unsafe extern "C" fn(user: *mut c_void, outputs: *mut CosimOutputs<'_>) -> c_int>,
    /// Solves one window from the accepted state with the given inputs, and writes the outputs. A
    /// window may be solved any number of times: only accept moves on.
    pub solve: Option<
        unsafe extern "C" fn(
            user: *mut c_void,
            step: *const CosimStep,
            inputs: *const CosimInputs<'_>,
            outputs: *mut CosimOutputs<'_>,
            report: *mut CosimReport,
        ) -> c_int,
    >,
    /// Makes the last solve the accepted state. NULL: there is no state.
    pub accept: Option<unsafe extern "C" fn(user: *mut c_void) -> c_int>,
    /// Writes the observed fields of the accepted state: those that are only looked at and need not
    /// be there in every iteration. NULL: a run that would observe any is refused.
    pub observe:
        Option<unsafe extern "C" fn(user: *mut c_void, outputs: *mut CosimOutputs<'_>) -> c_int>,
    /// Writes the accepted state with cosim_blob_write(). NULL, together with restore: no state.
    pub save: Option<unsafe extern "C" fn(user: *mut c_void, blob: *mut CosimBlob<'_>) -> c_int>,
    /// Returns to a saved state, all of which it reads with cosim_blob_read(); the run then continues
    /// bit-identically.
    pub restore: Option<unsafe extern "C" fn(user: *mut c_void, blob: *mut CosimBlob<'_>) -> c_int>,
    /// The program's part of summary.json, a JSON object of sections that are merged over the
    /// participants: {"temperature": {...}}. The text is the program's and stays until destroy.
    /// NULL: none.
    pub summary: Option<unsafe extern "C" fn(user: *mut c_void) -> *const c_char>,
    /// Frees what `user` holds; called once, last.
    pub destroy: Option<unsafe extern "C" fn(user: *mut c_void)>,
    /// Gives the geometry of the layout's volumes and of its grids that move, as they are in the
    /// accepted state, with cosim_geometry(). Called after build, accept and restore, if anybody
    /// needs one of them; between these calls they stay. NULL: there are none.
    pub moved_grids:
        Option<unsafe extern "C" fn(user: *mut c_void, moves: *mut CosimMoves<'_>) -> c_int>,
    /// Frees what build has allocated: the run is over. Called after a build that succeeded, also
    /// if the run failed. NULL: destroy or the next build does it.
    pub finish: Option<unsafe extern "C" fn(user: *mut c_void) -> c_int>,
}

/// The table with every callback unset, as `{0}` makes it in C.
#[cfg(test)]
pub(crate) fn empty() -> CosimSolver {
    // SAFETY: zero is NULL, and so `None`, for every member but the numbers.
    let zeroed: CosimSolver = unsafe { std::mem::zeroed() };
    CosimSolver { size: size_of::<CosimSolver>(), version: COSIM_VERSION, ..zeroed }
}

/// Reads the table that a program was compiled with.
///
/// # Safety
/// `solver` is NULL or points to as many bytes as its first member says.
pub(crate) unsafe fn read(solver: *const CosimSolver) -> Result<CosimSolver, String> {
    if solver.is_null() {
        return Err("cosim_main: `solver` is NULL".to_owned());
    }
    // SAFETY: not NULL; every table begins with these two.
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
    // SAFETY: `size` bytes are there, no more than the table has; what is not copied stays zero,
    // which is NULL for a callback.
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
        let report = CosimReport { heat_received: 0.0, wanted_window: 2.0, ..CosimReport::EMPTY };
        let report = StepReport::from(report);
        assert_eq!((report.heat_received, report.wanted_window), (Some(0.0), Some(2.0)));
    }
}
