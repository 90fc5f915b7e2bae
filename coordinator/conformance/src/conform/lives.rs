//! Processes that several checks share.
//!
//! A participant may take seconds to start, and some checks leave it as any other could find it: joined
//! and not configured to stay, or between two windows. Such a life is kept for the next check; one in
//! which a check failed, or that a check has spoilt, is not. While one process is put through a check
//! the next ones start.

use super::life::{Life, Values};
use contract::configuration::Configuration;
use std::cell::{Cell, RefCell};
use std::collections::VecDeque;
use std::rc::Rc;

/// All that a fresh process publishes, outputs and observed fields.
pub(super) struct Reference {
    /// Answer of the first window, to inputs of variation 0.
    pub(super) first: Values,
    /// Of the second window, with inputs of variation 1, after the first one was accepted and not
    /// observed.
    pub(super) second: Values,
}

/// What is running and not in use.
#[derive(Default)]
pub(super) struct Lives {
    /// Joined, and not initialised.
    pub(super) joined: RefCell<Option<Life>>,
    /// Between two windows, each as it was configured.
    pub(super) ready: RefCell<Vec<(Configuration, Life)>>,
    /// Windows of fresh processes, see [`Bench::reference`].
    pub(super) references: RefCell<Vec<(Configuration, Rc<Reference>)>>,
    /// On its way.
    pub(super) coming: RefCell<VecDeque<Life>>,
    /// Some process has joined.
    pub(super) once: Cell<bool>,
    /// A process was started, and none has.
    pub(super) never: Cell<bool>,
}
