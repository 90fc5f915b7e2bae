//! The inputs of the participant that is driven: recorded samples, published when they are due.
//!
//! Of the samples that come between two solves the participant needs the newest, and the newest of
//! the window before, which holds at the window's start; what others come between is left out, and
//! all are renumbered.

use contract::message::{Command, FieldHeader, Topic, Topics};
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

impl Input {
    /// Opens a topic; the participant is the only subscriber.
    fn open(endpoint: &Endpoint, service: &str, values: usize) -> Result<Self, TransportError> {
        let writer = endpoint.field_writer(service, values, 1)?;
        let (service, pending) = (service.to_owned(), Vec::new());
        Ok(Self { service, writer, pending, recorded: 0, published: 0 })
    }

    /// Publishes the first of the pending samples.
    fn publish(&mut self, count: usize) -> Result<(), TransportError> {
        for (mut header, values) in self.pending.drain(..count) {
            self.recorded = header.sequence;
            self.published += 1;
            header.sequence = self.published;
            let mut loan = self.writer.loan(values.len())?;
            loan.values().copy_from_slice(&values);
            self.writer.publish(loan, &header)?;
        }
        Ok(())
    }
}

/// All inputs, in the order of the configuration, and the geometry of the grids they are on.
#[derive(Debug, Default)]
pub(super) struct Feed {
    inputs: Vec<Input>,
    geometry: Vec<Input>,
}

impl Feed {
    /// Opens the topics of the inputs, and those of grids that others move.
    pub(super) fn open(endpoint: &Endpoint, topics: &Topics) -> Result<Self, TransportError> {
        let input = |topic: &Topic| Input::open(endpoint, &topic.service, topic.grid.points());
        let inputs = topics.inputs.iter().map(input).collect::<Result<_, _>>()?;
        let mut geometry: Vec<Input> = Vec::new();
        for topic in &topics.inputs {
            let Some(service) = &topic.geometry else { continue };
            let known = geometry.iter().any(|input| input.service == *service);
            if !known && topics.geometry.iter().all(|own| own.service != *service) {
                geometry.push(Input::open(endpoint, service, 3 * topic.grid.geometry_points())?);
            }
        }
        Ok(Self { inputs, geometry })
    }

    pub(super) fn wait_for_subscriber(&self, deadline: Instant) -> Result<(), TransportError> {
        let mut all = self.inputs.iter().chain(&self.geometry);
        all.try_for_each(|input| input.writer.wait_for_subscribers(deadline))
    }

    /// A recorded sample; of no interest unless it travelled on the topic of an input.
    pub(super) fn take(&mut self, service: &str, header: &FieldHeader, values: &[f64]) {
        let all = self.inputs.iter_mut().chain(&mut self.geometry);
        for input in all.filter(|input| input.service == service) {
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
        for geometry in &mut self.geometry {
            geometry.publish(geometry.pending.len())?;
        }
        for (slot, input) in self.inputs.iter_mut().enumerate() {
            let wanted = command.expected[slot];
            let due = input.pending.iter().take_while(|(header, _)| header.sequence <= wanted);
            let due = due.count();
            input.publish(due)?;
            // A number that was never recorded stays one that never comes.
            let known = input.recorded == wanted;
            command.expected[slot] = if known { input.published } else { u64::MAX };
        }
        Ok(())
    }
}
