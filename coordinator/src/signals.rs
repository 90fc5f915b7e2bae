//! Ctrl-C, SIGTERM and SIGHUP: noted as soon as the program starts, acted upon wherever it waits.

use std::io;
use std::sync::atomic::{AtomicI32, Ordering};
use std::time::Duration;
use tokio::signal::unix::{SignalKind, signal};

/// Number of the signal that asked us to stop; 0 for none. Signals belong to the whole process.
static RECEIVED: AtomicI32 = AtomicI32::new(0);

/// From one look to the next.
const LOOK: Duration = Duration::from_millis(20);

/// Listens from now on, on a thread of its own, for as long as the process lives.
pub fn listen() -> io::Result<()> {
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build()?;
    let streams = {
        let _inside = runtime.enter();
        let kinds = [SignalKind::interrupt(), SignalKind::terminate(), SignalKind::hangup()];
        kinds.map(|kind| signal(kind).map(|stream| (kind.as_raw_value(), stream)))
    };
    for listening in streams {
        let (number, mut stream) = listening?;
        runtime.spawn(async move {
            while stream.recv().await.is_some() {
                RECEIVED.store(number, Ordering::Release);
            }
        });
    }
    std::thread::Builder::new()
        .name("signals".to_owned())
        .spawn(move || runtime.block_on(std::future::pending::<()>()))?;
    Ok(())
}

/// The signal that asked us to stop, by name.
#[must_use]
pub fn received() -> Option<&'static str> {
    match RECEIVED.load(Ordering::Acquire) {
        0 => None,
        number if number == SignalKind::interrupt().as_raw_value() => Some("Ctrl-C"),
        number if number == SignalKind::hangup().as_raw_value() => Some("SIGHUP"),
        _ => Some("SIGTERM"),
    }
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
