//! Reports on standard error when damaged shared memory ends the process. Lets a write beyond the
//! largest size of a file fail instead.
//!
//! Touching a file that was truncated, or for which `/dev/shm` has no room, raises a bus error.
//! Overwritten management data of iceoryx2 leads to an invalid access. Neither can be repaired; the
//! handlers print the cause before the process ends. Participants notice the end and leave. The
//! next run removes the remaining files.

use std::io;
use std::mem::MaybeUninit;
use std::ptr;
use std::sync::OnceLock;

const CUT: &[u8] = b"error: shared memory failed: a file of the run in /dev/shm has been \
                     truncated, or there is no room for it (bus error); free or enlarge /dev/shm; \
                     the next run removes what this one leaves\n";
const OVERWRITTEN: &[u8] =
    b"error: invalid access to memory: the run's files in /dev/shm have been \
      overwritten, or the program is at fault; the next run removes what this one leaves\n";

/// The Rust runtime's handler of invalid accesses, which recognises stack overflows.
static BEFORE: OnceLock<libc::sigaction> = OnceLock::new();

/// Installs the handlers that report such an end on standard error.
pub fn report() -> io::Result<()> {
    let before = install(libc::SIGSEGV, overwritten)?;
    let _ = BEFORE.set(before);
    install(libc::SIGXFSZ, too_long)?;
    install(libc::SIGBUS, cut).map(|_| ())
}

/// Lets a write beyond the largest size of a file (`ulimit -f`) fail with an error, which names the
/// file, instead of ending the process.
extern "C" fn too_long(_signal: i32) {}

fn install(signal: i32, handler: extern "C" fn(i32)) -> io::Result<libc::sigaction> {
    let mut before = MaybeUninit::zeroed();
    // SAFETY: an action of zeros is a valid one without mask; `before` is written by the call, and
    // read only after its success. The handlers call only functions that are safe in a signal
    // handler.
    unsafe {
        let mut action: libc::sigaction = MaybeUninit::zeroed().assume_init();
        action.sa_sigaction = handler as *const () as usize;
        action.sa_flags = libc::SA_ONSTACK;
        match libc::sigaction(signal, &raw const action, before.as_mut_ptr()) {
            0 => Ok(before.assume_init()),
            _ => Err(io::Error::last_os_error()),
        }
    }
}

/// Reports the bus error and ends the process.
extern "C" fn cut(_signal: i32) {
    // SAFETY: both calls are safe in a signal handler.
    unsafe {
        libc::write(2, CUT.as_ptr().cast(), CUT.len());
        libc::_exit(1);
    }
}

/// Reports the invalid access and restores the former handler. On return the access is repeated,
/// and the former handler ends the process.
extern "C" fn overwritten(signal: i32) {
    let before = BEFORE.get().map_or(ptr::null(), ptr::from_ref);
    // SAFETY: all calls are safe in a signal handler; without a former action nothing is restored,
    // and then the process ends here.
    unsafe {
        libc::write(2, OVERWRITTEN.as_ptr().cast(), OVERWRITTEN.len());
        if before.is_null() || libc::sigaction(signal, before, ptr::null_mut()) != 0 {
            libc::_exit(1);
        }
    }
}
