//! Ctrl-C, SIGTERM and SIGHUP: noted as soon as the program starts, acted upon wherever it waits.
//!
//! One that is ignored when the program starts stays so, as `nohup` wants it. While nothing has to be
//! put in order ([`end_at_once`]) a signal ends the program there and then; so does a second one,
//! whatever goes on: participants notice that, and leave by themselves.

use crate::processes;
use std::io::{self, Write};
use std::os::unix::process::ExitStatusExt;
use std::process::ExitStatus;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicI32, AtomicUsize, Ordering};
use std::time::{Duration, Instant};
use tokio::signal::unix::{SignalKind, signal};

/// Number of the signal that asked us to stop; 0 for none. Signals belong to the whole process.
static RECEIVED: AtomicI32 = AtomicI32::new(0);

/// How many have said that nothing has to be put in order.
static AT_ONCE: AtomicUsize = AtomicUsize::new(0);

/// From one look to the next.
const LOOK: Duration = Duration::from_millis(20);

/// Processes of one job are signalled within this time.
const SAME_JOB: Duration = Duration::from_millis(500);

/// A signal that comes twice within this time was sent once (`timeout` signals a process and then its
/// group).
const REPEATED: Duration = Duration::from_secs(1);

/// Listens from now on, on a thread of its own, for as long as the process lives.
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

/// The signals that the process ignores: bit n − 1 for signal n.
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

/// Ends the program, and what it has started.
fn leave() -> ! {
    processes::end_all();
    let name = received().unwrap_or("a signal");
    let _ = writeln!(io::stderr(), "error: interrupted by {name}");
    // As a shell has it.
    std::process::exit(128 + RECEIVED.load(Ordering::SeqCst));
}

/// For as long as it lives a signal ends the program at once: nothing has to be put in order.
#[derive(Debug)]
pub struct AtOnce(());

/// See [`AtOnce`]. A signal that has been received before ends the program too.
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

/// The signal that asked us to stop, by name.
#[must_use]
pub fn received() -> Option<&'static str> {
    match RECEIVED.load(Ordering::SeqCst) {
        0 => None,
        number if number == SignalKind::interrupt().as_raw_value() => Some("Ctrl-C"),
        number if number == SignalKind::hangup().as_raw_value() => Some("SIGHUP"),
        _ => Some("SIGTERM"),
    }
}

/// The signal that asks us to stop, where the one that has ended another process is such a signal. Whoever stops a whole job, as schedulers
/// do, signals all of its processes, and this one may learn of it after the other has ended: it is waited for a moment.
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

/// Ends when a signal has been received.
pub async fn wait() -> &'static str {
    loop {
        if let Some(name) = received() {
            return name;
        }
        tokio::time::sleep(LOOK).await;
    }
}
