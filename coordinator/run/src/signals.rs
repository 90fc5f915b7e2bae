//! Ctrl-C, SIGTERM and SIGHUP: noted from the start of the program, handled wherever the program
//! waits.
//!
//! A signal that is ignored at the start stays ignored, as `nohup` requires. While no clean-up is
//! needed ([`end_at_once`]), a signal ends the program immediately. A second signal does so at any
//! time; participants notice the end and leave by themselves.

use crate::processes;
use std::io::{self, Write};
use std::os::unix::process::ExitStatusExt;
use std::process::ExitStatus;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicI32, AtomicUsize, Ordering};
use std::time::{Duration, Instant};
use tokio::signal::unix::{SignalKind, signal};

/// Number of the signal that asked the program to stop; 0 for none. Signals concern the whole
/// process.
static RECEIVED: AtomicI32 = AtomicI32::new(0);

/// Number of [`AtOnce`] guards in force.
static AT_ONCE: AtomicUsize = AtomicUsize::new(0);

/// Time between two checks for a signal.
const LOOK: Duration = Duration::from_millis(20);

/// Time within which the processes of one job are signalled.
const SAME_JOB: Duration = Duration::from_millis(500);

/// Time within which a repeated signal counts as the same one (`timeout` signals a process and then
/// its group).
const REPEATED: Duration = Duration::from_secs(1);

/// Listens for signals from now on, on a separate thread, for the life of the process.
pub fn listen() -> io::Result<()> {
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build()?;
    let ignored = ignored();
    let streams = {
        let _inside = runtime.enter();
        let kinds = [SignalKind::interrupt(), SignalKind::terminate(), SignalKind::hangup()];
        let heeded = kinds.into_iter().filter(|kind| ignored >> (kind.as_raw_value() - 1) & 1 == 0);
        heeded
            .map(|kind| Ok((kind.as_raw_value(), signal(kind)?)))
            .collect::<io::Result<Vec<_>>>()?
    };
    for (number, mut stream) in streams {
        runtime.spawn(async move {
            while stream.recv().await.is_some() {
                note(number);
            }
        });
    }
    std::thread::Builder::new()
        .name("signals".to_owned())
        .spawn(move || runtime.block_on(std::future::pending::<()>()))?;
    Ok(())
}

/// Returns the signals that the process ignores: bit n − 1 for signal n.
fn ignored() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok()).unwrap_or(0)
}

fn note(number: i32) {
    static FIRST: OnceLock<Instant> = OnceLock::new();
    RECEIVED.store(number, Ordering::SeqCst);
    let again = FIRST.get_or_init(Instant::now).elapsed() > REPEATED;
    if again || AT_ONCE.load(Ordering::SeqCst) > 0 {
        leave();
    }
}

/// Ends the program and all processes that it has started.
fn leave() -> ! {
    processes::end_all();
    let name = received().unwrap_or("a signal");
    let _ = writeln!(io::stderr(), "error: interrupted by {name}");
    // Exit code as reported by a shell.
    std::process::exit(128 + RECEIVED.load(Ordering::SeqCst));
}

/// Guard during whose life a signal ends the program at once, because no clean-up is needed.
#[derive(Debug)]
pub struct AtOnce(());

/// Lets signals end the program at once, while the returned guard lives. A signal received before
/// ends the program too.
#[must_use]
pub fn end_at_once() -> AtOnce {
    AT_ONCE.fetch_add(1, Ordering::SeqCst);
    if received().is_some() {
        leave();
    }
    AtOnce(())
}

impl Drop for AtOnce {
    fn drop(&mut self) {
        AT_ONCE.fetch_sub(1, Ordering::SeqCst);
    }
}

/// Returns the name of the signal that asked the program to stop.
#[must_use]
pub fn received() -> Option<&'static str> {
    match RECEIVED.load(Ordering::SeqCst) {
        0 => None,
        number if number == SignalKind::interrupt().as_raw_value() => Some("Ctrl-C"),
        number if number == SignalKind::hangup().as_raw_value() => Some("SIGHUP"),
        _ => Some("SIGTERM"),
    }
}

/// Returns the signal that asks this program to stop, if another process was ended by such a
/// signal. A scheduler that stops a job signals all of its processes. This process may receive its
/// signal after the other has ended, so the function waits for half a second at most.
#[must_use]
pub fn received_like(other: ExitStatus) -> Option<&'static str> {
    let kinds = [SignalKind::interrupt(), SignalKind::terminate(), SignalKind::hangup()];
    let number = other.signal()?;
    let since = Instant::now();
    while kinds.iter().any(|kind| kind.as_raw_value() == number) && since.elapsed() < SAME_JOB {
        if received().is_some() {
            return received();
        }
        std::thread::sleep(LOOK);
    }
    None
}

/// Waits until a signal has been received.
pub async fn wait() -> &'static str {
    loop {
        if let Some(name) = received() {
            return name;
        }
        tokio::time::sleep(LOOK).await;
    }
}
