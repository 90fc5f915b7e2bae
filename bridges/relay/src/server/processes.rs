//! Processes that end with a link.

use crate::link::Link;
use run::peers::ProcessGuard;
use std::sync::{Arc, Mutex, PoisonError};

/// Processes of a run, ended with the link.
#[derive(Clone, Default)]
pub(super) struct Processes(Arc<Mutex<Option<ProcessGuard>>>);

impl Processes {
    /// Ends these processes when the link ends.
    pub(super) fn end_with(&self, link: &Link, processes: ProcessGuard) {
        self.set(Some(processes));
        if link.lost().is_some() {
            self.set(None);
        }
    }

    /// Releases the processes at the end of a run.
    pub(super) fn let_go(&self) {
        self.set(None);
    }

    fn set(&self, processes: Option<ProcessGuard>) {
        let before = {
            let mut held = self.0.lock().unwrap_or_else(PoisonError::into_inner);
            std::mem::replace(&mut *held, processes)
        };
        // Ends the previous processes, which takes a while; the lock is free meanwhile.
        drop(before);
    }
}
