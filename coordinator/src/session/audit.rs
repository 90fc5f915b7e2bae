//! The energy audit: what one participant sends through a conservative field, another has to say
//! it received.

use super::feedback::Feedback;
use super::mapped::Mapped;
use super::tap::Consumer;
use super::{SolveRecord, Tap};

/// Heat across the interface in one iteration, as mean power over the window.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct HeatBalance {
    /// Surface integral of the conservative fields as sent [W].
    pub sent: Option<f64>,
    /// What their consumers report as received [W].
    pub received: Option<f64>,
    /// The largest part of the heat that a mapping has lost or made \[-\].
    pub mapping: Option<f64>,
}

impl HeatBalance {
    /// The larger of |sent − received|, relative to the larger of the two, and of what mappings
    /// have made of it; 0 when no heat flows at all, `None` when neither is known.
    #[must_use]
    pub fn imbalance(&self) -> Option<f64> {
        match (self.of_exchange(), self.mapping) {
            // `f64::max` would lose a NaN.
            (Some(exchange), Some(mapping)) if !exchange.is_nan() => Some(exchange.max(mapping)),
            (exchange, mapping) => exchange.or(mapping),
        }
    }

    fn of_exchange(&self) -> Option<f64> {
        let (sent, received) = (self.sent?, self.received?);
        let scale = sent.abs().max(received.abs());
        Some(if scale == 0.0 { 0.0 } else { (sent - received).abs() / scale })
    }
}

/// The balance over all conservative fields that somebody consumes. Sent is what each consumer was
/// given to read: the producer's values, or the coordinator's iterate of them, and before mapping.
pub(super) fn balance(
    taps: &[Tap],
    feedback: &[Feedback],
    mapped: &[Mapped],
    solved: &[SolveRecord],
) -> HeatBalance {
    let mut balance = HeatBalance::default();
    let mut consumers = 0_u64;
    let mut deliver = |heat: f64, readers: &[Consumer]| {
        *balance.sent.get_or_insert(0.0) += heat * readers.len() as f64;
        consumers |= readers.iter().fold(0, |all, reader| all | 1 << reader.participant);
    };
    for tap in taps.iter().filter(|tap| tap.is_conservative()) {
        if let Some(values) = tap.values() {
            // What is only fed back costs no sum here.
            let heat = if tap.readers.is_empty() { 0.0 } else { tap.grid.integrate(values) };
            deliver(heat, &tap.readers);
        }
    }
    for fed_back in feedback {
        if let Some(heat) = fed_back.heat {
            deliver(heat, &fed_back.readers);
        }
    }
    let mapped = mapped.iter().filter_map(|mapped| Some((mapped.heat?, mapped.reader)));
    for (heat, reader) in mapped.clone() {
        deliver(heat.sent, &[reader]);
    }
    balance.mapping = mapped.map(|(heat, _)| heat.imbalance).reduce(f64::max);
    for (participant, record) in solved.iter().enumerate() {
        if let (true, Some(heat)) = (consumers >> participant & 1 == 1, record.heat_received) {
            *balance.received.get_or_insert(0.0) += heat;
        }
    }
    balance
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn imbalance_is_relative_and_known_only_with_both_sides() {
        let balance =
            |sent, received| HeatBalance { sent, received, ..HeatBalance::default() }.imbalance();
        assert_eq!(balance(Some(0.0), Some(0.0)), Some(0.0));
        assert_eq!(balance(Some(100.0), Some(99.0)), Some(0.01));
        assert_eq!(balance(Some(100.0), None), None);
        assert_eq!(balance(None, Some(1.0)), None);
    }

    #[test]
    fn what_a_mapping_loses_counts_even_if_nobody_reports_what_came() {
        let balance = |sent, received, mapping| {
            HeatBalance { sent: Some(sent), received, mapping: Some(mapping) }.imbalance()
        };
        assert_eq!(balance(100.0, None, 1e-3), Some(1e-3));
        assert_eq!(balance(100.0, Some(99.0), 1e-3), Some(0.01));
        assert_eq!(balance(100.0, Some(100.0), f64::INFINITY), Some(f64::INFINITY));
        assert!(balance(f64::NAN, Some(1.0), 1e-3).is_some_and(f64::is_nan));
    }
}
