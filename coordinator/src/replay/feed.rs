//! The inputs of the participant that is driven: recorded samples, published when they are due.
//!
//! Of the samples that come between two solves the participant needs the newest, and the newest of
//! the window before, which holds at the window's start; what others come between is left out, and
//! all are numbered anew.

use proto::message::{Command, FieldHeader, Topic};
use proto::transport::{Endpoint, FieldWriter, TransportError};
use std::time::Instant;

/// One input.
#[derive(Debug)]
struct Input {
    service: String,
    writer: FieldWriter,
    /// Recorded samples that are still to be published, in order.
    pending: Vec<(FieldHeader, Vec<f64>)>,
    /// Recorded and own number of what was published last.
    recorded: u64,
    published: u64,
}

/// All inputs, in the order of the configuration.
#[derive(Debug, Default)]
pub(super) struct Feed(Vec<Input>);

impl Feed {
    /// Opens the topics; the participant is the only subscriber.
    pub(super) fn open(endpoint: &Endpoint, topics: &[Topic]) -> Result<Self, TransportError> {
        let inputs = topics.iter().map(|topic| {
            let writer = endpoint.field_writer(&topic.service, topic.grid.points(), 1)?;
            let (service, pending) = (topic.service.clone(), Vec::new());
            Ok(Input { service, writer, pending, recorded: 0, published: 0 })
        });
        Ok(Self(inputs.collect::<Result<_, TransportError>>()?))
    }

    pub(super) fn wait_for_subscriber(&self, deadline: Instant) -> Result<(), TransportError> {
        self.0.iter().try_for_each(|input| input.writer.wait_for_subscribers(deadline))
    }

    /// A recorded sample; of no interest unless it travelled on the topic of an input.
    pub(super) fn take(&mut self, service: &str, header: &FieldHeader, values: &[f64]) {
        for input in self.0.iter_mut().filter(|input| input.service == service) {
            match input.pending.last_mut() {
                Some((last, kept)) if last.window == header.window => {
                    *last = *header;
                    kept.clear();
                    kept.extend_from_slice(values);
                }
                _ => input.pending.push((*header, values.to_vec())),
            }
            // The newest of the window before, and the newest.
            let surplus = input.pending.len().saturating_sub(2);
            input.pending.drain(..surplus);
        }
    }

    /// Publishes what a recorded solve used, and puts the numbers it has now into the command.
    pub(super) fn publish(&mut self, command: &mut Command) -> Result<(), TransportError> {
        for (slot, input) in self.0.iter_mut().enumerate() {
            let wanted = command.expected[slot];
            let due = input.pending.iter().take_while(|(header, _)| header.sequence <= wanted);
            let due = due.count();
            for (mut header, values) in input.pending.drain(..due) {
                input.recorded = header.sequence;
                input.published += 1;
                header.sequence = input.published;
                let mut loan = input.writer.loan(values.len())?;
                loan.values().copy_from_slice(&values);
                input.writer.publish(loan, &header)?;
            }
            // A number that was never recorded stays one that never comes.
            let known = input.recorded == wanted;
            command.expected[slot] = if known { input.published } else { u64::MAX };
        }
        Ok(())
    }
}
