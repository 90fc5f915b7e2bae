//! The energy audit: what one participant sends through a conservative field, another has to say
//! it received.

use super::{SolveRecord, Tap};
use proto::field::Mapping;

/// Heat across the interface in one iteration, as mean power over the window.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct HeatBalance {
    /// Surface integral of the conservative fields as sent [W].
    pub sent: Option<f64>,
    /// What their consumers report as received [W].
    pub received: Option<f64>,
}

impl HeatBalance {
    /// |sent − received| relative to the larger of the two; 0 when no heat flows at all, `None`
    /// when one side is not known.
    #[must_use]
    pub fn imbalance(&self) -> Option<f64> {
        let (sent, received) = (self.sent?, self.received?);
        let scale = sent.abs().max(received.abs());
        Some(if scale == 0.0 { 0.0 } else { (sent - received).abs() / scale })
    }
}

/// The balance over all conservative fields that somebody consumes.
pub(super) fn balance(taps: &[Tap], solved: &[SolveRecord]) -> HeatBalance {
    let mut balance = HeatBalance::default();
    let conserved = || taps.iter().filter(|tap| tap.kind.mapping == Mapping::Conservative);
    for tap in conserved() {
        if let Some(values) = tap.values() {
            let heat = tap.grid.integrate(values) * tap.readers.len() as f64;
            *balance.sent.get_or_insert(0.0) += heat;
        }
    }
    for (participant, record) in solved.iter().enumerate() {
        let consumes = |tap: &Tap| tap.readers.iter().any(|r| r.participant == participant);
        if let (true, Some(heat)) = (conserved().any(consumes), record.heat_received) {
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
        let balance = |sent, received| HeatBalance { sent, received }.imbalance();
        assert_eq!(balance(Some(0.0), Some(0.0)), Some(0.0));
        assert_eq!(balance(Some(100.0), Some(99.0)), Some(0.01));
        assert_eq!(balance(Some(100.0), None), None);
        assert_eq!(balance(None, Some(1.0)), None);
    }
}
