//! Shared memory: the need of the fields, compared with the limits.
//!
//! The kernel does not refuse a segment that does not fit: it kills the process that touches it.
//! Therefore the need is computed before any segment is created, and again before a grid that grows
//! needs more. What a run has been granted is set aside from the other runs of the process until
//! the segments exist.

use crate::error::{Failure, RunError};
use crate::plan::{Plan, geometry_bytes, non_matching, sample_bytes, topic_bytes};
use contract::configuration::Layout;
use contract::grid::Grid;
use coupling::ParticipantIndex;
use proto::run_dir::free_shared_memory;
use std::sync::{Mutex, PoisonError};
use typed_index_collections::TiSlice;

/// Shared memory of a run besides its fields [byte].
const OVERHEAD: u64 = 1 << 20;

/// Shared memory granted to the runs of this process that they have not yet written to [byte].
static GRANTED: Mutex<u64> = Mutex::new(0);

/// Share of a run in the granted memory.
#[derive(Debug)]
struct Grant {
    all: &'static Mutex<u64>,
    bytes: u64,
}

impl Grant {
    /// Grants `needed` bytes from the `free` ones that have not been granted to other runs.
    ///
    /// # Errors
    /// Returns the bytes that are left.
    fn of(all: &'static Mutex<u64>, needed: u64, free: impl Fn() -> u64) -> Result<Self, u64> {
        let mut granted = all.lock().unwrap_or_else(PoisonError::into_inner);
        let left = free().saturating_sub(*granted);
        if needed > left {
            return Err(left);
        }
        *granted += needed;
        drop(granted);
        Ok(Self { all, bytes: needed })
    }
}

impl Drop for Grant {
    fn drop(&mut self) {
        *self.all.lock().unwrap_or_else(PoisonError::into_inner) -= self.bytes;
    }
}

/// Shared memory that a run has taken, and its limit.
#[derive(Debug, Default)]
pub(super) struct SharedMemory {
    limit: u64,
    /// Shared memory counted so far [byte].
    taken: u64,
    /// Memory set aside for the run, until its first window is accepted.
    grant: Option<Grant>,
}

impl SharedMemory {
    /// Counts the need of the fields of a plan. Participants that have stayed already hold `held`
    /// bytes of it.
    ///
    /// # Errors
    /// The need exceeds the free shared memory or the limit of the case.
    pub(super) fn check(
        plan: &Plan,
        held: u64,
        layouts: &TiSlice<ParticipantIndex, Layout>,
    ) -> Result<Self, RunError> {
        let limit = plan.shared_memory_limit.unwrap_or(u64::MAX);
        let taken = OVERHEAD + live(plan) + fields(plan, layouts) + geometry(plan, layouts);
        let grant = grant(taken, held, limit, "before the fields were created")?;
        Ok(Self { limit, taken, grant: Some(grant) })
    }

    /// Returns the granted memory: the segments of the run exist, or are counted anew.
    pub(super) fn settle(&mut self) {
        self.grant = None;
    }

    /// Returns the shared memory counted so far [byte].
    pub(super) fn taken(&self) -> u64 {
        self.taken
    }

    /// Counts new segments for `points` points of fields with these numbers of components.
    ///
    /// # Errors
    /// The need exceeds the free shared memory or the limit of the case.
    pub(super) fn take(
        &mut self,
        points: usize,
        components: &[u32],
        when: &str,
    ) -> Result<(), RunError> {
        let bytes = |components: &u32| topic_bytes(sample_bytes(points, *components));
        let needed = components.iter().map(bytes).sum::<u64>();
        self.settle();
        grant(needed, 0, self.limit.saturating_sub(self.taken), when)?;
        self.taken += needed;
        Ok(())
    }
}

/// Checks that there is room for topics whose samples have these lengths [byte].
///
/// # Errors
/// The need exceeds the free shared memory.
pub fn room_for(samples: Vec<u64>, when: &str) -> Result<(), RunError> {
    let topics = samples.into_iter().map(topic_bytes);
    grant(topics.fold(OVERHEAD, u64::saturating_add), 0, u64::MAX, when).map(drop)
}

/// Returns the need of the live values that the coordinator sends [byte].
fn live(plan: &Plan) -> u64 {
    let sent = plan.live.iter().filter(|live| live.provider.is_none());
    sent.count() as u64 * topic_bytes(sample_bytes(1, 1))
}

fn fields(plan: &Plan, layouts: &TiSlice<ParticipantIndex, Layout>) -> u64 {
    let layout = |participant| layouts.get(participant);
    let of = |field: &crate::plan::Field| {
        let grid = layout(field.producer)?.grid_of(&field.kind.name)?;
        let bytes = |on: &Grid| topic_bytes(sample_bytes(on.points(), field.kind.components));
        let wanted =
            |&one: &ParticipantIndex| non_matching(field, one, layout).map(|[_, wanted]| wanted);
        let mapped = field.consumers.iter().filter_map(wanted).map(bytes).sum::<u64>();
        let iterates = field.fed_back.iter().any(|one| wanted(one).is_none());
        Some((1 + u64::from(iterates)) * bytes(grid) + mapped)
    };
    plan.fields.iter().filter_map(of).sum()
}

fn geometry(plan: &Plan, layouts: &TiSlice<ParticipantIndex, Layout>) -> u64 {
    let travelling =
        layouts.iter_enumerated().flat_map(|(one, layout)| plan.travelling(one, layout));
    travelling.map(|grid| topic_bytes(geometry_bytes(grid))).sum()
}

/// Grants memory, of which the run holds `held` bytes already.
fn grant(needed: u64, held: u64, limit: u64, when: &str) -> Result<Grant, RunError> {
    let granted = match needed <= limit {
        true => Grant::of(&GRANTED, needed.saturating_sub(held), free_shared_memory),
        false => Err(limit.saturating_sub(held)),
    };
    let mib = |bytes: u64| format!("{:.1} MiB", bytes as f64 / f64::from(1 << 20));
    granted.map_err(|left| {
        let left = left.saturating_add(held);
        RunError::Failed(Failure {
            who: "shared memory".to_owned(),
            when: when.to_owned(),
            what: format!("the fields need {}, but only {} may be used", mib(needed), mib(left)),
            fix:
                "enlarge /dev/shm (in a container: --shm-size), raise limits.shared_memory, write \
                  fewer fields (output.fields), use a coarser resolution, or run fewer cases at \
                  the same time"
                    .to_owned(),
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn memory_for_one_run_is_not_granted_twice() {
        static ALL: Mutex<u64> = Mutex::new(0);
        let grant = |needed| Grant::of(&ALL, needed, || 100);
        let first = grant(60).unwrap();
        assert_eq!(grant(60).unwrap_err(), 40);
        assert!(grant(40).is_ok());
        drop(first);
        assert!(grant(100).is_ok());
        assert_eq!(*ALL.lock().unwrap(), 0);
    }
}
