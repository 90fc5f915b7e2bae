//! Host of a participant: a process of its own, or a thread of a program that is linked with the
//! solver.

use crate::run_dir::{peak_resident_memory, processor_seconds};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// A request to a participant on a thread to leave its run.
#[derive(Clone, Debug, Default)]
pub struct Stop(Arc<AtomicBool>);

impl Stop {
    /// Asks the participant to leave; it does so when it next waits for a command.
    pub fn ask(&self) {
        self.0.store(true, Ordering::Release);
    }

    fn is_asked(&self) -> bool {
        self.0.load(Ordering::Acquire)
    }
}

/// The host of a participant.
#[derive(Clone, Debug)]
pub enum Host {
    /// A process, which the participant may end.
    Process,
    /// A thread, which continues until asked to stop. The participant must not affect other threads
    /// of the process.
    Thread(Stop),
}

impl Host {
    /// Returns true if the participant must leave.
    pub(super) fn is_stopped(&self) -> bool {
        match self {
            Self::Process => false,
            Self::Thread(stop) => stop.is_asked(),
        }
    }

    /// Processor seconds of the participant so far.
    pub(super) fn processor_seconds(&self) -> f64 {
        match self {
            Self::Process => processor_seconds(),
            Self::Thread(_) => {
                let spent = rustix::time::clock_gettime(rustix::time::ClockId::ThreadCPUTime);
                spent.tv_sec as f64 + 1e-9 * spent.tv_nsec as f64
            }
        }
    }

    /// Peak resident memory of the participant \[byte\]; unknown for a thread, which shares the
    /// memory of its process.
    pub(super) fn peak_resident_memory(&self) -> Option<u64> {
        match self {
            Self::Process => peak_resident_memory(),
            Self::Thread(_) => None,
        }
    }
}
