//! A run in progress: the exchange with its participants.
//!
//! [`Session::start`] prepares all participants up to the first window. `Session::solve`,
//! [`Session::accept`] and [`Session::finish`] carry out the commands of the same names. Every wait
//! has a deadline, and notices within [`proto::transport::Doorbell::NAP`] that a participant has
//! ended or that the user has interrupted the run. Dropping a session, at any point, ends all
//! processes and removes all files that the run has left on the machine.

mod audit;
mod checkpoint;
mod exchange;
mod fields;
mod geometry;
mod live;
mod mapping;
mod memory;
pub(crate) mod open_files;
mod reports;
mod start;
mod window;

pub use audit::{Balance, Receipt};
pub use fields::{Consumer, FieldIndex, FieldSubscription};
pub use geometry::MovingGrid;
pub use memory::room_for;
pub use reports::SolveRecord;
pub use window::PendingExits;

use crate::error::RunError;
use crate::peers::{Peers, ProcessGuard};
use crate::record::Recorder;
use crate::warnings::Warning;
use coupling::{Part, ParticipantIndex};
use fields::{CoupledField, MappingIndex, MovingIndex, PartIndex};
use live::LiveValues;
use mapping::FieldMapping;
use memory::SharedMemory;
use reports::Figures;
use std::path::Path;
use std::sync::Arc;
use std::time::Duration;
use typed_index_collections::{TiSlice, TiVec};

/// Participants that publish their observed fields when a window is accepted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Observed {
    /// All participants.
    Everybody,
    /// Participants whose fields have no consumer: this is all that they publish.
    Unconsumed,
    /// No participant.
    Nobody,
}

/// A run in progress.
// Fields drop in this order: the recording is closed, processes end, ports close, the run's folder
// goes last.
#[derive(Debug)]
pub struct Session {
    _recording: Recording,
    guard: ProcessGuard,
    /// Whether all participants may stay after the run.
    reusable: bool,
    fields: TiVec<FieldIndex, FieldSubscription>,
    coupled: TiVec<PartIndex, CoupledField>,
    mapped: TiVec<MappingIndex, FieldMapping>,
    moving: TiVec<MovingIndex, MovingGrid>,
    live: LiveValues,
    memory: SharedMemory,
    /// Fields that are not iterated, but have tolerances of their own.
    measured: Vec<FieldIndex>,
    /// Fields of `coupled`, then of `measured`, as parts of the coupling vector.
    parts: TiVec<PartIndex, Part>,
    solved: TiVec<ParticipantIndex, SolveRecord>,
    figures: Figures,
    computed_seconds: f64,
    /// Whether a participant has no answer to the window.
    unanswered: bool,
    bytes_exchanged: u64,
    /// Warnings raised during the run.
    warnings: Vec<Warning>,
    peers: Peers,
}

impl Session {
    /// Returns every field of the run, with its newest sample.
    #[must_use]
    pub fn fields(&self) -> &TiSlice<FieldIndex, FieldSubscription> {
        &self.fields
    }

    /// Returns the report of each participant on its last solve, in the order of the plan.
    #[must_use]
    pub fn solved(&self) -> &TiSlice<ParticipantIndex, SolveRecord> {
        &self.solved
    }

    /// Returns the figures that the participants gave for the last accepted window, in the order of
    /// the plan; `None` for a missing one.
    #[must_use]
    pub fn figures(&self) -> &[Option<f64>] {
        self.figures.values()
    }

    /// Returns the shortest window that a participant asks for, from the start of the last one [s].
    #[must_use]
    pub fn wanted_window(&self) -> Option<f64> {
        self.solved.iter().filter_map(|record| record.wanted_window).reduce(f64::min)
    }

    /// Returns the values that the participants sent last to each other, field by field.
    pub fn exchanged(&self) -> impl Iterator<Item = &[f64]> + Clone {
        self.fields
            .iter()
            .filter(|field| !field.observed_only)
            .filter_map(FieldSubscription::values)
    }

    /// Returns the size of the field values exchanged so far [byte].
    #[must_use]
    pub fn bytes_exchanged(&self) -> u64 {
        self.bytes_exchanged
    }

    /// Returns the warnings raised during the run.
    #[must_use]
    pub fn warnings(&self) -> &[Warning] {
        &self.warnings
    }

    /// Logs a warning, and adds it to those of the run.
    pub(crate) fn warn(&mut self, warning: Warning) {
        tracing::warn!("{warning}");
        self.warnings.push(warning);
    }

    /// Returns the time so far in which at least one model computed [s]. Models that compute at the
    /// same time count once, with the longest time.
    #[must_use]
    pub fn computed_seconds(&self) -> f64 {
        self.computed_seconds
    }

    /// Returns the balance of the conservative fields in the last iteration.
    #[must_use]
    pub fn balance(&self) -> Balance {
        let mapping = audit::of_mappings(&self.mapped);
        Balance { mapping, ..Balance::of(&self.solved) }
    }

    /// Checks whether a live key may take this value.
    ///
    /// # Errors
    /// The key does not exist, or the value is beyond its limits; the message names the reason.
    pub fn judge(&self, key: &str, value: f64) -> Result<(), String> {
        self.live.judge(key, value).map(drop)
    }

    /// Sets a live key, from the next solved window on.
    ///
    /// # Errors
    /// The errors of [`Session::judge`].
    pub fn give(&mut self, key: &str, value: f64) -> Result<(), String> {
        self.live.give(key, value)
    }

    /// Returns the live values that the coordinator sends, by key.
    pub fn given(&self) -> impl Iterator<Item = (&str, f64)> {
        self.live.sent.iter().map(|sent| (sent.key.as_str(), sent.value))
    }

    /// Returns the value of a live key that a participant sends, as its readers used it last.
    /// Returns `None` if no participant sends the key.
    #[must_use]
    pub fn provided(&self, key: &str) -> Option<f64> {
        let mut provided = self.live.provided.iter();
        provided.find(|provided| self.fields[provided.field].kind.name == key)?.used
    }

    /// Returns the folder of the run, which is in memory and is removed at the end of the run.
    #[must_use]
    pub fn folder(&self) -> &Path {
        &self.peers.run().info().folder
    }

    /// Returns whether a grid of the run moves.
    #[must_use]
    pub fn has_moving_grid(&self) -> bool {
        !self.moving.is_empty()
    }

    /// Lets time pass while watching processes and signals.
    ///
    /// # Errors
    /// A process has ended, or the user has interrupted the run.
    pub fn idle(&mut self, time: Duration) -> Result<(), RunError> {
        self.peers.idle(time, || ()).map_err(|stopped| self.peers.error(stopped))
    }
}

/// Recording of a run, closed whenever the run ends.
#[derive(Debug)]
struct Recording(Option<Arc<Recorder>>);

impl Drop for Recording {
    fn drop(&mut self) {
        if let Some(recorder) = &self.0 {
            // A failure of the recording is reported elsewhere: where it was noticed, or by
            // `finish`.
            recorder.close();
        }
    }
}
