//! Signs of life to and from the far end. Without any for too long the link is lost, and so is this process:
//! its last words say so, and the coordinator reports them with window and iteration.

use crate::fabric::Hold;
use crate::frame::Frame;
use crate::line::{Incoming, Sending};
use contract::message::ProgressReport;
use contract::text::one_line;
use proto::run_dir::RunDir;
use std::io::Write;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// From one sign of life to the next.
const INTERVAL: Duration = Duration::from_millis(100);
/// What the far end has sent before it left is still read for so long.
const LAST_WORDS: Duration = Duration::from_millis(300);

/// What becomes of the signs of the far participant.
pub(super) trait Hears: Send {
    /// Its heart has beaten.
    fn beat(&mut self);
    /// It has said how far it is.
    fn progress(&mut self, report: ProgressReport);
}

/// Who hears, once there is somebody.
pub(super) type Ears = Arc<Mutex<Option<Box<dyn Hears>>>>;

/// A membership that is left in order when the process ends here.
pub(super) type Membership = Arc<Mutex<Option<RunDir>>>;

/// Keeps the line until dropped.
pub(super) struct Keeper {
    stop: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl Keeper {
    pub(super) fn start(
        (life, hold): (Incoming, Hold),
        sending: Arc<Sending>,
        ears: Ears,
        (endpoint, silence): (String, Duration),
        membership: Membership,
    ) -> Self {
        let stop = Arc::new(AtomicBool::new(false));
        let stopped = Arc::clone(&stop);
        let thread = std::thread::spawn(move || {
            let ends = keep(life, &hold, &sending, &ears, silence, &stopped);
            let (words, code) = match ends {
                None => return,
                Some(Ends::Lost(why)) => (format!("the link to {endpoint} is lost: {why}"), 1),
                Some(Ends::Told { words, code }) => (words, code),
            };
            let words = words.strip_prefix("error: ").unwrap_or(&words);
            let _ = writeln!(std::io::stderr(), "error: {words}");
            leave(&membership, code);
        });
        Self { stop, thread: Some(thread) }
    }
}

impl Drop for Keeper {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::SeqCst);
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

/// Why nobody waits any longer for what cannot come.
enum Ends {
    Lost(String),
    /// The far end has said why.
    Told {
        words: String,
        code: u8,
    },
}

/// Until it is stopped, or why the process ends.
fn keep(
    mut life: Incoming,
    hold: &Hold,
    sending: &Sending,
    ears: &Ears,
    silence: Duration,
    stopped: &AtomicBool,
) -> Option<Ends> {
    let lost = |why: String| Some(Ends::Lost(why));
    let (mut heard, mut sent, mut gone) = (Instant::now(), None::<Instant>, None::<Instant>);
    while !stopped.load(Ordering::SeqCst) {
        if sent.is_none_or(|sent| sent.elapsed() >= INTERVAL) {
            if let Err(error) = sending.sign(&Frame::Alive) {
                return lost(error.to_string());
            }
            sent = Some(Instant::now());
        }
        let message = match life.within(INTERVAL / 2) {
            Ok(message) => message,
            Err(error) => return lost(error.to_string()),
        };
        if let Some(message) = message {
            heard = Instant::now();
            let mut ears = ears.lock().unwrap_or_else(PoisonError::into_inner);
            match (Frame::read(&message), &mut *ears) {
                (Ok(Frame::Beat), Some(ears)) => ears.beat(),
                (Ok(Frame::Progress(report)), Some(ears)) => ears.progress(report),
                (Ok(Frame::Ended { code, words }), _) => {
                    let words = one_line(words).into_owned();
                    // Who waits for a message has them too, and what came before.
                    std::thread::sleep(LAST_WORDS);
                    return Some(Ends::Told { words, code: code.max(1) });
                }
                (Ok(_), _) => {}
                (Err(error), _) => return lost(error.to_string()),
            }
        }
        if hold.is_gone() && gone.get_or_insert_with(Instant::now).elapsed() > LAST_WORDS {
            return lost("the far end is gone, or its connection was closed".to_owned());
        }
        if heard.elapsed() > silence {
            return lost(format!("nothing was received for {:.1} s", silence.as_secs_f64()));
        }
    }
    None
}

/// Ends the process, whatever its other threads do; the run's folder is left in order.
pub(super) fn leave(membership: &Membership, code: u8) -> ! {
    drop(membership.lock().map(|mut run| run.take()));
    std::process::exit(code.into());
}
