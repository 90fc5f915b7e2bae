//! The energy audit: what a consumer was assigned of the conservative fields, it has to report that
//! it received.
//!
//! The samples are those whose sequence numbers stood in the command, so that a consumer that solves
//! at the same time as its producer is judged by what it had, not by what is newer. A consumer that
//! reports no heat is left out, by name.

use super::feedback::Feedback;
use super::index::{MappedIndex, PartIndex, TapIndex};
use super::mapped::Mapped;
use super::solved::SolveRecord;
use super::tap::Tap;
use contract::message::Reply;
use coupling::ParticipantIndex;
use typed_index_collections::TiSlice;

/// Heat across the interface in one iteration, as mean power over the window.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct HeatBalance {
    /// Surface integral of the conservative fields that the consumers which report heat were
    /// assigned; if none reports, that of all [W].
    pub sent: Option<f64>,
    /// What they report as received [W].
    pub received: Option<f64>,
    /// The consumer for which the two differ most.
    pub worst: Option<Receipt>,
    /// The largest part of the heat that a mapping has lost or made \[-\].
    pub mapping: Option<f64>,
    /// Bit by participant: it consumes a conservative field and reports no heat.
    pub unreported: u64,
}

/// Heat for one consumer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Receipt {
    /// Index of the participant.
    pub participant: ParticipantIndex,
    /// What it was assigned [W].
    pub sent: f64,
    /// What it reports [W].
    pub received: f64,
}

impl Receipt {
    /// |sent − received|, relative to the larger of the two; 0 when no heat flows at all.
    #[must_use]
    pub fn imbalance(&self) -> f64 {
        let Self { sent, received, .. } = *self;
        let scale = sent.abs().max(received.abs());
        if scale == 0.0 { 0.0 } else { (sent - received).abs() / scale }
    }
}

impl HeatBalance {
    /// The balance of the last solves.
    #[must_use]
    pub fn of(solved: &TiSlice<ParticipantIndex, SolveRecord>) -> Self {
        let mut balance = Self::default();
        let mut unreported = None;
        for (participant, record) in solved.iter_enumerated() {
            let Some(sent) = record.heat_sent else { continue };
            match record.heat_received {
                Some(received) => balance.add(Receipt { participant, sent, received }),
                None => {
                    balance.unreported |= 1 << usize::from(participant);
                    *unreported.get_or_insert(0.0) += sent;
                }
            }
        }
        balance.sent = balance.sent.or(unreported);
        balance
    }

    fn add(&mut self, receipt: Receipt) {
        *self.sent.get_or_insert(0.0) += receipt.sent;
        *self.received.get_or_insert(0.0) += receipt.received;
        let imbalance = receipt.imbalance();
        // A NaN is worse than any number.
        let better = |worst: &Receipt| imbalance <= worst.imbalance() || worst.imbalance().is_nan();
        if !self.worst.as_ref().is_some_and(better) {
            self.worst = Some(receipt);
        }
    }

    /// The largest imbalance of a consumer or of a mapping; `None` when neither is known.
    #[must_use]
    pub fn imbalance(&self) -> Option<f64> {
        match (self.worst.map(|worst| worst.imbalance()), self.mapping) {
            // `f64::max` would lose a NaN.
            (Some(exchange), Some(mapping)) if !exchange.is_nan() => Some(exchange.max(mapping)),
            (exchange, mapping) => exchange.or(mapping),
        }
    }
}

/// The power in the conservative fields that a participant is assigned, each on the grid
/// that it was sent on; `None` if it consumes none.
pub(super) fn commanded(
    taps: &TiSlice<TapIndex, Tap>,
    feedback: &TiSlice<PartIndex, Feedback>,
    mapped: &TiSlice<MappedIndex, Mapped>,
    participant: ParticipantIndex,
) -> Option<f64> {
    let mut power = None;
    let mut add = |heat: f64| *power.get_or_insert(0.0) += heat;
    for tap in taps.iter().filter(|tap| tap.is_conservative()) {
        let slots = tap.readers.iter().filter(|reader| reader.participant == participant);
        if let (Some(values), 1..) = (tap.values(), slots.count()) {
            add(tap.grid.integrate(values));
        }
    }
    for fed_back in feedback {
        let reads = fed_back.readers.iter().any(|reader| reader.participant == participant);
        fed_back.heat.filter(|_| reads).into_iter().for_each(&mut add);
    }
    for mapped in mapped.iter().filter(|mapped| mapped.reader.participant == participant) {
        mapped.heat.iter().for_each(|heat| add(heat.sent));
    }
    power
}

/// What is wrong with what a participant reports of a solve, if anything; with the heat that it
/// reported of the one before.
pub(super) fn report_fault(reply: &Reply, heat_before: Option<f64>) -> Option<String> {
    let stopped = heat_before.is_some() && reply.heat_received.is_nan();
    let ended = || stopped.then(|| "it has stopped reporting the heat it receives".to_owned());
    reply.fault().or_else(ended)
}

/// The largest part of the heat that a mapping has lost or made; `None` if no heat is mapped.
pub(super) fn of_mappings(mapped: &TiSlice<MappedIndex, Mapped>) -> Option<f64> {
    mapped.iter().filter_map(|mapped| Some(mapped.heat?.imbalance)).reduce(f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn record(heat_sent: Option<f64>, heat_received: Option<f64>) -> SolveRecord {
        SolveRecord { heat_sent, heat_received, ..SolveRecord::default() }
    }

    fn balance(solved: &[SolveRecord]) -> HeatBalance {
        HeatBalance::of(TiSlice::from_ref(solved))
    }

    fn of(sent: f64, received: Option<f64>) -> HeatBalance {
        balance(&[SolveRecord::default(), record(Some(sent), received)])
    }

    #[test]
    fn imbalance_is_relative_and_known_only_with_both_sides() {
        assert_eq!(of(0.0, Some(0.0)).imbalance(), Some(0.0));
        assert_eq!(of(100.0, Some(99.0)).imbalance(), Some(0.01));
        let silent = of(100.0, None);
        assert_eq!((silent.imbalance(), silent.unreported), (None, 0b10));
        assert_eq!((silent.sent, silent.received), (Some(100.0), None));
        assert_eq!(balance(&[record(None, Some(1.0))]), HeatBalance::default());
    }

    #[test]
    fn each_consumer_is_judged_by_itself_and_a_silent_one_is_left_out() {
        let balance = balance(&[
            record(Some(100.0), Some(101.0)),
            record(Some(100.0), Some(99.0)),
            record(Some(50.0), None),
            record(Some(2.0), Some(2.0)),
        ]);
        assert_eq!((balance.sent, balance.received), (Some(202.0), Some(202.0)));
        let worst = Receipt { participant: 1.into(), sent: 100.0, received: 99.0 };
        assert_eq!((balance.worst, balance.unreported), (Some(worst), 0b100));
        assert_eq!(balance.imbalance(), Some(0.01));
    }

    #[test]
    fn what_a_mapping_loses_counts_even_if_nobody_reports_what_came() {
        let balance =
            |sent, received, mapping| HeatBalance { mapping: Some(mapping), ..of(sent, received) };
        assert_eq!(balance(100.0, None, 1e-3).imbalance(), Some(1e-3));
        assert_eq!(balance(100.0, Some(99.0), 1e-3).imbalance(), Some(0.01));
        let infinite = balance(100.0, Some(100.0), f64::INFINITY);
        assert_eq!(infinite.imbalance(), Some(f64::INFINITY));
        assert!(balance(f64::NAN, Some(1.0), 1e-3).imbalance().is_some_and(f64::is_nan));
    }
}
