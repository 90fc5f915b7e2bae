//! The iterates of the coupling data: taken from their producers, sent to who closes the loop.

use super::Session;
use super::index::PartIndex;
use super::outlet::Outlet;
use crate::error::{Failure, RunError};
use contract::step::Step;
use coupling::Part;
use proto::transport::TransportError;
use typed_index_collections::TiVec;

/// Sends an iterate on its producer's grid; how many bytes that were.
fn publish(outlet: &mut Outlet, values: &[f64], step: &Step) -> Result<u64, TransportError> {
    let mut loan = outlet.loan()?;
    loan.values().copy_from_slice(values);
    outlet.publish(loan, step)?;
    Ok(std::mem::size_of_val(values) as u64)
}

impl Session {
    /// The consumers listen to the iterates.
    pub(super) fn wait_for_readers(&self) -> Result<(), RunError> {
        let deadline = std::time::Instant::now() + self.peers.deadlines().start;
        let iterates = self.feedback.iter().filter_map(|feedback| feedback.outlet.as_ref());
        let outlets = iterates.chain(self.mapped.iter().map(|mapped| mapped.outlet()));
        let mut outlets = outlets.chain(self.live.sent.iter().map(|sent| &sent.outlet));
        let waited = outlets.try_for_each(|outlet| outlet.wait_for_subscribers(deadline));
        waited.map_err(|error| self.not_sent(&error))
    }

    /// The coupling vector: the fields of the coupling data, in the order of the plan.
    pub(super) fn coupling_parts(&self) -> TiVec<PartIndex, Part> {
        let fields = self.feedback.iter().map(|feedback| {
            let tap = &self.taps[feedback.tap];
            (tap.kind.name.as_str(), tap.values().map_or(0, <[f64]>::len))
        });
        coupling::parts(fields).into()
    }

    pub(super) fn send_iterate(&mut self, iterate: &[f64], step: &Step) -> Result<(), RunError> {
        for index in self.feedback.keys() {
            let tap = self.feedback[index].tap;
            let values = &iterate[self.parts[index].range.clone()];
            if self.feedback[index].outlet.is_some() {
                let conservative = self.taps[tap].is_conservative();
                let heat = conservative.then(|| self.current_grid(tap).integrate(values));
                self.feedback[index].heat = heat;
            }
            if let Some(outlet) = &mut self.feedback[index].outlet {
                let sent = publish(outlet, values, step);
                self.bytes_exchanged += sent.map_err(|error| self.not_sent(&error))?;
            }
            self.send_mapped_iterate(index, values, step)?;
        }
        Ok(())
    }

    pub(super) fn copy_returned(&self, returned: &mut [f64]) {
        for (feedback, part) in self.feedback.iter().zip(&self.parts) {
            let values = self.taps[feedback.tap].values();
            let values = values.expect("a field of the coupling data has its first values");
            returned[part.range.clone()].copy_from_slice(values);
        }
    }

    pub(super) fn not_sent(&self, error: &TransportError) -> RunError {
        RunError::Failed(Failure {
            who: "the exchange of fields".to_owned(),
            when: self.peers.phase.to_string(),
            what: error.to_string(),
            fix: error.advice("a participant"),
        })
    }
}
