//! A run in progress: the conversation with its participants.
//!
//! [`Session::start`] brings everybody to the point where the first window can be solved;
//! [`Session::solve`], [`Session::accept`] and [`Session::finish`] do what they say. Every wait
//! notices within [`Doorbell::NAP`] that a participant has ended or that the user wants to stop,
//! and has a deadline. Dropping a session, at any point, ends all processes and removes everything
//! that the run has left on the machine.

mod audit;
mod checkpoint;
mod collect;
mod feedback;
mod figures;
mod geometry;
mod given;
mod index;
mod iterates;
mod layout;
mod live;
mod mapped;
mod mapping;
mod memory;
mod moving;
pub(crate) mod open_files;
mod outlet;
mod solved;
mod start;
mod subscription;
mod tap;
mod topics;
mod window;

pub use audit::{HeatBalance, Receipt};
pub use layout::layout_fault;
pub use memory::room_for;
pub use moving::MovingGrid;
pub use outlet::header;
pub use solved::SolveRecord;
pub use tap::{Consumer, Tap};
pub use window::Leaving;

use crate::peers::{EndsFirst, Peers};
use crate::record::Recorder;
use crate::warnings::Warning;
use coupling::{Part, ParticipantIndex};
use feedback::Feedback;
use figures::Figures;
use index::{MappedIndex, MovingIndex, PartIndex, TapIndex};
use live::LiveValues;
use mapped::Mapped;
use memory::SharedMemory;
use std::sync::Arc;
use typed_index_collections::{TiSlice, TiVec};

/// Which participants publish their observed fields when a window is accepted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Observed {
    /// All of them.
    Everybody,
    /// Those of which no other participant consumes anything: they publish nothing else.
    Unconsumed,
    /// None.
    Nobody,
}

/// A run in progress.
// Fields drop in this order: the recording is closed, processes end, ports close, the run's folder
// goes last.
#[derive(Debug)]
pub struct Session {
    _recording: Recording,
    guard: EndsFirst,
    /// All participants may stay after the run.
    reusable: bool,
    taps: TiVec<TapIndex, Tap>,
    feedback: TiVec<PartIndex, Feedback>,
    mapped: TiVec<MappedIndex, Mapped>,
    moving: TiVec<MovingIndex, MovingGrid>,
    live: LiveValues,
    memory: SharedMemory,
    /// The fields of `feedback` as parts of the coupling vector.
    parts: TiVec<PartIndex, Part>,
    solved: TiVec<ParticipantIndex, SolveRecord>,
    figures: Figures,
    computed_seconds: f64,
    /// A participant has no answer to the window.
    unanswered: bool,
    bytes_exchanged: u64,
    /// Warnings raised during the run.
    warnings: Vec<Warning>,
    peers: Peers,
}

impl Session {
    /// Every field of the run with its newest sample.
    #[must_use]
    pub fn taps(&self) -> &TiSlice<TapIndex, Tap> {
        &self.taps
    }

    /// What each participant reported of its last solve, in the plan's order.
    #[must_use]
    pub fn solved(&self) -> &TiSlice<ParticipantIndex, SolveRecord> {
        &self.solved
    }

    /// The figures that the participants gave when the last window was accepted, in the plan's order; NaN
    /// for those that there are not.
    #[must_use]
    pub fn figures(&self) -> &[f64] {
        self.figures.values()
    }

    /// The shortest window that a participant wants from the start of the last one [s].
    #[must_use]
    pub fn wanted_window(&self) -> Option<f64> {
        self.solved.iter().filter_map(|record| record.wanted_window).reduce(f64::min)
    }

    /// What the participants sent last to each other, field by field.
    pub fn exchanged(&self) -> impl Iterator<Item = &[f64]> + Clone {
        self.taps.iter().filter(|tap| !tap.observed_only).filter_map(Tap::values)
    }

    /// Bytes of field values exchanged so far.
    #[must_use]
    pub fn bytes_exchanged(&self) -> u64 {
        self.bytes_exchanged
    }

    /// Warnings raised during the run.
    #[must_use]
    pub fn warnings(&self) -> &[Warning] {
        &self.warnings
    }

    /// Seconds so far in which some model computed; models that compute at the same time count
    /// once, with the longest.
    #[must_use]
    pub fn computed_seconds(&self) -> f64 {
        self.computed_seconds
    }

    /// Heat sent and received in the last iteration.
    #[must_use]
    pub fn heat_balance(&self) -> HeatBalance {
        let mapping = audit::of_mappings(&self.mapped);
        HeatBalance { mapping, ..HeatBalance::of(&self.solved) }
    }
}

/// The recording of a run, closed at its end however that comes.
#[derive(Debug)]
struct Recording(Option<Arc<Recorder>>);

impl Drop for Recording {
    fn drop(&mut self) {
        if let Some(recorder) = &self.0 {
            // Its failure has been reported by whatever noticed it, or will be by `finish`.
            recorder.close();
        }
    }
}
