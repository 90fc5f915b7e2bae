//! Audit of conservative fields: a consumer must report that it received what was sent to it. Such
//! a field is a power per area; the audit compares its surface integral.
//!
//! The audit uses the samples whose sequence numbers stood in the command. Thus a consumer that
//! solves at the same time as its producer is judged by the samples that it had, not by newer ones.
//! A consumer without a report is excluded, and named. A consumer is also excluded if one of the
//! powers that it receives has no integral, because a grid has no areas.

use super::fields::{
    Consumer, CoupledField, FieldIndex, FieldSubscription, MappingIndex, PartIndex,
};
use super::mapping::FieldMapping;
use super::reports::SolveRecord;
use contract::grid::Grid;
use contract::message::Reply;
use coupling::ParticipantIndex;
use typed_index_collections::TiSlice;

/// Balance of the conservative fields in one iteration, as mean power over the window.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Balance {
    /// Surface integral of the conservative fields that were sent to consumers with a report; if
    /// none reports, to all consumers [W].
    pub sent: Option<f64>,
    /// Power that the same consumers report as received [W].
    pub received: Option<f64>,
    /// Consumer with the largest difference between the two.
    pub worst: Option<Receipt>,
    /// Largest relative change of the integral by a mapping \[-\].
    pub mapping: Option<f64>,
    /// One bit for each participant: set if it consumes a conservative field without a report.
    pub unreported: u64,
}

/// Balance of a consumer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Receipt {
    /// Index of the participant.
    pub participant: ParticipantIndex,
    /// Power that was sent to the consumer [W].
    pub sent: f64,
    /// Power that the consumer reports [W].
    pub received: f64,
}

impl Receipt {
    /// Returns |sent − received|, relative to the larger of the two; 0 if both are zero.
    #[must_use]
    pub fn imbalance(&self) -> f64 {
        let Self { sent, received, .. } = *self;
        let scale = sent.abs().max(received.abs());
        if scale == 0.0 { 0.0 } else { (sent - received).abs() / scale }
    }
}

impl Balance {
    /// Returns the balance of the last solves.
    #[must_use]
    pub fn of(solved: &TiSlice<ParticipantIndex, SolveRecord>) -> Self {
        let mut balance = Self::default();
        let mut unreported = None;
        for (participant, record) in solved.iter_enumerated() {
            let Some(sent) = record.sent else { continue };
            match record.received {
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

    /// Returns the largest imbalance of a consumer or of a mapping; `None` if neither is known.
    #[must_use]
    pub fn imbalance(&self) -> Option<f64> {
        let exchange = self.worst.map(|worst| worst.imbalance());
        exchange.into_iter().chain(self.mapping).reduce(larger)
    }
}

/// Returns the larger of two imbalances. A NaN is worse than any number, and `f64::max` would lose
/// it.
fn larger(one: f64, other: f64) -> f64 {
    if other.is_nan() || other > one { other } else { one }
}

/// Returns the power in the conservative fields that a participant consumes, each on the grid on
/// which it was sent. Returns `None` if the participant consumes none, or one whose integral is
/// unknown because a grid has no areas.
pub(super) fn commanded(
    fields: &TiSlice<FieldIndex, FieldSubscription>,
    coupled: &TiSlice<PartIndex, CoupledField>,
    mapped: &TiSlice<MappingIndex, FieldMapping>,
    participant: ParticipantIndex,
) -> Option<f64> {
    let reads = |readers: &[Consumer]| readers.iter().any(|r| r.participant == participant);
    let unknown = |index: FieldIndex, grid: &Grid| {
        let field = &fields[index];
        field.is_power() && !(field.grid.has_areas() && grid.has_areas())
    };
    let direct =
        fields.iter_enumerated().filter(|(_, field)| reads(&field.readers)).map(|(index, _)| index);
    let iterates = coupled.iter().filter(|one| reads(&one.readers)).map(|one| one.field);
    let own = mapped.iter().filter(|mapped| mapped.reader.participant == participant);
    if direct.chain(iterates).any(|index| unknown(index, &fields[index].grid))
        || own.clone().any(|mapped| unknown(mapped.field, &mapped.grid))
    {
        return None;
    }
    let mut power = None;
    let mut add = |part: f64| *power.get_or_insert(0.0) += part;
    for field in fields.iter().filter(|field| field.is_power()) {
        let slots = field.readers.iter().filter(|reader| reader.participant == participant);
        if let (Some(values), 1..) = (field.values(), slots.count()) {
            add(field.grid.integrate(values));
        }
    }
    for fed_back in coupled {
        fed_back.integral.filter(|_| reads(&fed_back.readers)).into_iter().for_each(&mut add);
    }
    for mapped in own {
        mapped.integral.and_then(|integral| integral.sent).into_iter().for_each(&mut add);
    }
    power
}

/// Returns the fault in the report of a solve, if any. `before` is the power in the report of the
/// solve before.
pub(super) fn report_fault(reply: &Reply, before: Option<f64>) -> Option<String> {
    let stopped = before.is_some() && reply.received_power().is_none();
    let ended = || stopped.then(|| "it has stopped reporting the power it receives".to_owned());
    reply.fault().or_else(ended)
}

/// Returns the largest relative change of an integral by a mapping; `None` if no conservative field
/// is mapped.
pub(super) fn of_mappings(mapped: &TiSlice<MappingIndex, FieldMapping>) -> Option<f64> {
    mapped.iter().filter_map(|mapped| Some(mapped.integral?.imbalance)).reduce(larger)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn record(sent: Option<f64>, received: Option<f64>) -> SolveRecord {
        SolveRecord { sent, received, ..SolveRecord::default() }
    }

    fn balance(solved: &[SolveRecord]) -> Balance {
        Balance::of(TiSlice::from_ref(solved))
    }

    fn of(sent: f64, received: Option<f64>) -> Balance {
        balance(&[SolveRecord::default(), record(Some(sent), received)])
    }

    #[test]
    fn imbalance_is_relative_and_known_only_with_both_sides() {
        assert_eq!(of(0.0, Some(0.0)).imbalance(), Some(0.0));
        assert_eq!(of(100.0, Some(99.0)).imbalance(), Some(0.01));
        let silent = of(100.0, None);
        assert_eq!((silent.imbalance(), silent.unreported), (None, 0b10));
        assert_eq!((silent.sent, silent.received), (Some(100.0), None));
        assert_eq!(balance(&[record(None, Some(1.0))]), Balance::default());
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
            |sent, received, mapping| Balance { mapping: Some(mapping), ..of(sent, received) };
        assert_eq!(balance(100.0, None, 1e-3).imbalance(), Some(1e-3));
        assert_eq!(balance(100.0, Some(99.0), 1e-3).imbalance(), Some(0.01));
        let infinite = balance(100.0, Some(100.0), f64::INFINITY);
        assert_eq!(infinite.imbalance(), Some(f64::INFINITY));
        assert!(balance(f64::NAN, Some(1.0), 1e-3).imbalance().is_some_and(f64::is_nan));
        assert!(balance(100.0, Some(99.0), f64::NAN).imbalance().is_some_and(f64::is_nan));
        let mappings = |all: [f64; 3]| all.into_iter().reduce(larger).unwrap();
        assert!(mappings([1.0, f64::NAN, 2.0]).is_nan() && mappings([f64::NAN, 1.0, 2.0]).is_nan());
        assert_eq!(mappings([1.0, 3.0, 2.0]), 3.0);
    }
}
