//! Processes that end with a link.

use crate::link::Link;
use run::peers::EndsFirst;
use std::sync::{Arc, Mutex, PoisonError};

/// The processes of a run, which end with the link.
#[derive(Clone, Default)]
pub(super) struct Processes(Arc<Mutex<Option<EndsFirst>>>);

impl Processes {
    /// These end with the link.
    pub(super) fn end_with(&self, link: &Link, processes: EndsFirst) {
        self.set(Some(processes));
        if link.lost().is_some() {
            self.set(None);
        }
    }

    /// The run is over.
    pub(super) fn let_go(&self) {
        self.set(None);
    }

    fn set(&self, processes: Option<EndsFirst>) {
        let before = {
            let mut held = self.0.lock().unwrap_or_else(PoisonError::into_inner);
            std::mem::replace(&mut *held, processes)
        };
        // Ends them, which takes a while.
        drop(before);
    }
}
