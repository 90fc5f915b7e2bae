//! Signs of life to and from the end at home. Without any for too long the link is lost, and what the program
//! does for it ends.

use crate::fabric::Hold;
use crate::frame::Frame;
use crate::line::{Incoming, Sending};
use run::peers::EndsFirst;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// From one sign of life to the next.
const INTERVAL: Duration = Duration::from_millis(100);
/// What the end at home has sent before it left is still read for so long.
const LAST_WORDS: Duration = Duration::from_millis(300);

/// Why the link is lost, and what ends with it.
#[derive(Default)]
struct State {
    lost: Option<String>,
    processes: Option<EndsFirst>,
}

/// Watches the link until dropped.
pub(super) struct Guard {
    state: Arc<Mutex<State>>,
    hold: Arc<Hold>,
    stop: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

fn lock(state: &Mutex<State>) -> MutexGuard<'_, State> {
    state.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Guard {
    pub(super) fn start(
        life: Incoming,
        hold: Hold,
        sending: Arc<Sending>,
        silence: Duration,
    ) -> Self {
        let (state, hold) = (Arc::new(Mutex::new(State::default())), Arc::new(hold));
        let stop = Arc::new(AtomicBool::new(false));
        let shared = (Arc::clone(&state), Arc::clone(&hold), Arc::clone(&stop));
        let thread = std::thread::spawn(move || {
            let (state, hold, stop) = shared;
            if let Some(why) = watch(life, &hold, &sending, silence, &stop) {
                let mut state = lock(&state);
                state.lost = Some(why);
                let processes = state.processes.take();
                drop(state);
                // Ends them, which takes a while.
                drop(processes);
            }
        });
        Self { state, hold, stop, thread: Some(thread) }
    }

    /// Why the link is lost, if it is.
    pub(super) fn lost(&self) -> Option<String> {
        lock(&self.state).lost.clone()
    }

    /// The processes of a run end with the link.
    pub(super) fn end_with_it(&self, processes: EndsFirst) {
        let mut state = lock(&self.state);
        if state.lost.is_none() {
            state.processes = Some(processes);
        }
    }

    /// The run is over.
    pub(super) fn let_go(&self) {
        let processes = lock(&self.state).processes.take();
        drop(processes);
    }

    /// Rings when something arrives.
    pub(super) fn ring(&self, bell: Option<Box<dyn Fn() + Send>>) {
        self.hold.ring(bell);
    }

    /// The end at home has left or is lost.
    pub(super) fn is_over(&self) -> bool {
        self.hold.is_gone() || self.lost().is_some()
    }
}

impl Drop for Guard {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::SeqCst);
        self.hold.ring(None);
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

fn watch(
    mut life: Incoming,
    hold: &Hold,
    sending: &Sending,
    silence: Duration,
    stop: &AtomicBool,
) -> Option<String> {
    let (mut heard, mut sent, mut gone) = (Instant::now(), None::<Instant>, None::<Instant>);
    while !stop.load(Ordering::SeqCst) {
        if sent.is_none_or(|sent| sent.elapsed() >= INTERVAL) {
            if let Err(error) = sending.sign(&Frame::Alive) {
                return Some(error.to_string());
            }
            sent = Some(Instant::now());
        }
        match life.within(INTERVAL / 2) {
            Ok(Some(_)) => heard = Instant::now(),
            Ok(None) => {}
            Err(error) => return Some(error.to_string()),
        }
        if hold.is_gone() && gone.get_or_insert_with(Instant::now).elapsed() > LAST_WORDS {
            return Some("the end at home is gone, or its connection was closed".to_owned());
        }
        if heard.elapsed() > silence {
            return Some(format!("nothing was received for {:.1} s", silence.as_secs_f64()));
        }
    }
    None
}
