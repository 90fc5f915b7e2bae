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

/// What is running and not in use.
#[derive(Default)]
pub(super) struct Lives {
    /// Joined, and not initialised.
    pub(super) joined: RefCell<Option<Life>>,
    /// Between two windows, each as it was configured.
    pub(super) ready: RefCell<Vec<(Configuration, Life)>>,
    /// How settings went on after their first window, see [`Bench::unobserved`].
    pub(super) unobserved: RefCell<Vec<(Configuration, Rc<Values>)>>,
    /// On its way.
    pub(super) coming: RefCell<VecDeque<Life>>,
    /// Some process has joined.
    pub(super) once: Cell<bool>,
    /// A process was started, and none has.
    pub(super) never: Cell<bool>,
}
