//! Fields of a run as the coordinator sees them. It receives every sample, checks its label and
//! values and holds the newest one ([`FieldSubscription`]). It also sends some fields itself
//! ([`FieldPublisher`]).
//!
//! For coupling data ([`CoupledField`]) the coordinator receives the producer's samples and sends
//! its own iterate to consumers. Only the consumers that close the loop subscribe to the
//! coordinator; all others subscribe to the producer directly. The topic is
//! `field/coordinator/NAME`; its samples have their own sequence numbers. A consumer on another
//! grid has its own topic ([`super::mapping`]).

use crate::peers::COORDINATOR;
use crate::plan::Plan;
use crate::record::{Recorder, TopicNumber};
use contract::field::FieldKind;
use contract::grid::Grid;
use contract::message::FieldHeader;
use contract::step::Step;
use coupling::ParticipantIndex;
use proto::transport::{
    Endpoint, FieldLoan, FieldReader, FieldSample, FieldWriter, TransportError,
};
use std::sync::Arc;
use std::time::Instant;

coupling::index! {
    /// A field of the run.
    pub FieldIndex
}

coupling::index! {
    /// A field of the coupling data.
    pub(super) PartIndex
}

coupling::index! {
    /// A field that is mapped for a consumer.
    pub(super) MappingIndex
}

coupling::index! {
    /// A grid that may move.
    pub(super) MovingIndex
}

/// A participant that consumes a field.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Consumer {
    /// Index of the participant.
    pub participant: ParticipantIndex,
    /// Index of the field among the participant's inputs.
    pub slot: usize,
}

impl Consumer {
    /// Returns the consumer for a participant that has the field of this name among its inputs.
    pub(super) fn new(plan: &Plan, field: &str, participant: ParticipantIndex) -> Self {
        let inputs = &plan.participants[participant].configuration.inputs;
        let slot = inputs.iter().position(|input| input.field.name == field);
        Self { participant, slot: slot.expect("a consumer has the field as an input") }
    }
}

/// A field of the run to which the coordinator subscribes, with its newest sample.
#[derive(Debug)]
pub struct FieldSubscription {
    pub(super) kind: FieldKind,
    pub(super) grid: Grid,
    /// Index of the grid among the moving grids, if it moves.
    pub(super) moving: Option<MovingIndex>,
    pub(super) producer: ParticipantIndex,
    pub(super) producer_role: String,
    pub(super) readers: Vec<Consumer>,
    pub(super) observed_only: bool,
    pub(super) wanted: bool,
    pub(super) reader: FieldReader,
    pub(super) sample: Option<FieldSample>,
    pub(super) checked: u64,
    pub(super) recorded: Option<TopicNumber>,
}

impl FieldSubscription {
    /// Returns a subscription to a field of the only participant of a run, which has this role.
    pub fn of_role(role: &str, kind: FieldKind, grid: Grid, reader: FieldReader) -> Self {
        Self {
            kind,
            grid,
            moving: None,
            producer: ParticipantIndex::FIRST,
            producer_role: role.to_owned(),
            readers: Vec::new(),
            observed_only: false,
            wanted: false,
            reader,
            sample: None,
            checked: 0,
            recorded: None,
        }
    }

    /// Takes the next sample of a step as the newest; `None` if none has arrived.
    ///
    /// # Errors
    /// The sample cannot be received, or its label or length is wrong.
    pub fn take(&mut self, step: &Step) -> Result<Option<&[f64]>, String> {
        let Some(sample) = self.reader.receive().map_err(|error| error.to_string())? else {
            return Ok(None);
        };
        if let Some(fault) = self.fault(&sample, step) {
            return Err(fault);
        }
        self.sample = Some(sample);
        Ok(self.values())
    }

    /// Expects the next samples on this grid.
    pub fn move_to(&mut self, grid: &Grid) {
        self.grid.clone_from(grid);
    }

    /// Returns the kind of the field.
    #[must_use]
    pub fn kind(&self) -> &FieldKind {
        &self.kind
    }

    /// Returns the grid of the newest sample.
    #[must_use]
    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    /// Returns the index of the participant that sends the field.
    #[must_use]
    pub fn producer(&self) -> ParticipantIndex {
        self.producer
    }

    /// Returns the role of the participant that sends the field.
    #[must_use]
    pub fn producer_role(&self) -> &str {
        &self.producer_role
    }

    /// Returns the consumers that subscribe to the producer directly. Consumers of iterates or
    /// mapped values subscribe to the coordinator.
    #[must_use]
    pub fn readers(&self) -> &[Consumer] {
        &self.readers
    }

    /// Returns whether the field is a power, which the audit follows.
    pub(super) fn is_power(&self) -> bool {
        self.kind.is_power()
    }

    /// Returns whether the case wants the field written.
    #[must_use]
    pub fn wanted(&self) -> bool {
        self.wanted
    }

    /// Returns the newest values, component-major; `None` before the first sample.
    #[must_use]
    pub fn values(&self) -> Option<&[f64]> {
        self.sample.as_ref().map(FieldSample::values)
    }

    /// Returns the sequence number of the newest sample; 0 before the first.
    #[must_use]
    pub fn sequence(&self) -> u64 {
        self.sample.as_ref().map_or(0, |sample| sample.header().sequence)
    }

    /// Returns the fault in a sample of a step, if any.
    pub(super) fn fault(&self, sample: &FieldSample, step: &Step) -> Option<String> {
        let mut expected = FieldHeader::new(&self.kind, &self.producer_role, &self.grid);
        expected.set_step(step);
        expected.sequence = self.sequence() + 1;
        let difference = sample.header().difference(&expected, sample.values().len())?;
        Some(format!("field `{}` {difference}", self.kind.name))
    }
}

/// A topic on which the coordinator itself sends a field.
#[derive(Debug)]
pub(super) struct FieldPublisher {
    values: usize,
    writer: FieldWriter,
    header: FieldHeader,
    recorded: Option<(Arc<Recorder>, TopicNumber)>,
}

impl FieldPublisher {
    /// Opens a topic for a field on a grid. A recorder is a further subscriber.
    pub(super) fn open(
        endpoint: &Endpoint,
        service: &str,
        kind: &FieldKind,
        grid: &Grid,
        subscribers: usize,
        recorder: Option<&Arc<Recorder>>,
    ) -> Result<Self, TransportError> {
        let recorded = recorder.map(|recorder| {
            Ok::<_, TransportError>((Arc::clone(recorder), recorder.listen(endpoint, service)?))
        });
        let recorded = recorded.transpose()?;
        let subscribers = subscribers + usize::from(recorded.is_some());
        let values = grid.points() * kind.components as usize;
        let writer = endpoint.field_writer(service, values, subscribers)?;
        let header = FieldHeader::new(kind, COORDINATOR, grid);
        Ok(Self { values, writer, header, recorded })
    }

    /// Sends the next samples on this grid.
    pub(super) fn move_to(&mut self, grid: &Grid) {
        self.values = grid.points() * self.header.components as usize;
        self.header.points = grid.points() as u64;
        self.header.grid_revision = grid.revision;
    }

    /// Waits until all subscribers have connected.
    pub(super) fn wait_for_subscribers(&self, deadline: Instant) -> Result<(), TransportError> {
        self.writer.wait_for_subscribers(deadline)
    }

    /// Returns the sequence number of the newest sample.
    pub(super) fn sequence(&self) -> u64 {
        self.header.sequence
    }

    /// Returns memory for the next sample.
    pub(super) fn loan(&self) -> Result<FieldLoan, TransportError> {
        self.writer.loan(self.values)
    }

    /// Sends the sample of a step.
    pub(super) fn publish(&mut self, loan: FieldLoan, step: &Step) -> Result<(), TransportError> {
        self.header.sequence += 1;
        self.header.set_step(step);
        self.writer.publish(loan, &self.header)?;
        if let Some((recorder, topic)) = &self.recorded {
            recorder.sample(*topic, self.header.sequence);
        }
        Ok(())
    }
}

/// A field of the coupling data.
#[derive(Debug)]
pub(super) struct CoupledField {
    /// Field that the producer sends.
    pub(super) field: FieldIndex,
    /// Consumers that receive the iterates on the producer's grid.
    pub(super) readers: Vec<Consumer>,
    /// Surface integral of the last iterate, if the field is a power on a grid with areas.
    pub(super) integral: Option<f64>,
    /// First value of the last iterate; the only one of a live value.
    pub(super) first: Option<f64>,
    /// Topic of the iterates; `None` if they have no reader.
    pub(super) publisher: Option<FieldPublisher>,
}

impl CoupledField {
    pub(super) fn new(
        field: FieldIndex,
        readers: Vec<Consumer>,
        publisher: Option<FieldPublisher>,
    ) -> Self {
        Self { field, readers, integral: None, first: None, publisher }
    }

    /// Returns the name of the service for the iterates of a field.
    pub(super) fn service(field: &str) -> String {
        format!("field/{COORDINATOR}/{field}")
    }

    /// Sends the next iterates on this grid, the producer's current one.
    pub(super) fn move_to(&mut self, grid: &Grid) {
        if let Some(publisher) = &mut self.publisher {
            publisher.move_to(grid);
        }
    }

    /// Returns the sequence number of the newest iterate.
    pub(super) fn sequence(&self) -> u64 {
        self.publisher.as_ref().map_or(0, FieldPublisher::sequence)
    }
}
