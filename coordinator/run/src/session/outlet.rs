//! A topic on which the coordinator itself sends a field: coupling data, or what is mapped.

use crate::peers::COORDINATOR;
use crate::record::{Recorder, TopicNumber};
use contract::field::FieldKind;
use contract::grid::Grid;
use contract::message::{FieldHeader, Label};
use contract::step::Step;
use proto::transport::{Endpoint, FieldLoan, FieldWriter, TransportError};
use std::sync::Arc;
use std::time::Instant;

/// What stands on every sample of a field that the coordinator sends on a grid.
pub fn header(kind: &FieldKind, grid: &Grid) -> FieldHeader {
    FieldHeader {
        protocol: contract::PROTOCOL_VERSION,
        components: kind.components,
        points: grid.points() as u64,
        grid_revision: grid.revision,
        name: Label::new(&kind.name),
        unit: Label::new(&kind.unit),
        producer: Label::new(COORDINATOR),
        grid: Label::new(&grid.name),
        ..FieldHeader::default()
    }
}

/// The writer of a topic, and the label of its samples.
#[derive(Debug)]
pub(super) struct Outlet {
    values: usize,
    writer: FieldWriter,
    header: FieldHeader,
    recorded: Option<(Arc<Recorder>, TopicNumber)>,
}

impl Outlet {
    /// Opens a topic for a field on a grid; the recorder, if there is one, is one more subscriber.
    pub(super) fn open(
        endpoint: &Endpoint,
        service: &str,
        (kind, grid): (&FieldKind, &Grid),
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
        let header = header(kind, grid);
        Ok(Self { values, writer, header, recorded })
    }

    /// The grid has moved.
    pub(super) fn moved(&mut self, grid: &Grid) {
        self.values = grid.points() * self.header.components as usize;
        self.header.points = grid.points() as u64;
        self.header.grid_revision = grid.revision;
    }

    /// Its subscribers are there.
    pub(super) fn wait_for_subscribers(&self, deadline: Instant) -> Result<(), TransportError> {
        self.writer.wait_for_subscribers(deadline)
    }

    /// Sequence number of the newest sample.
    pub(super) fn sequence(&self) -> u64 {
        self.header.sequence
    }

    /// A place for the next sample.
    pub(super) fn loan(&self) -> Result<FieldLoan, TransportError> {
        self.writer.loan(self.values)
    }

    pub(super) fn publish(&mut self, loan: FieldLoan, step: &Step) -> Result<(), TransportError> {
        self.header.sequence += 1;
        self.header.window = step.window;
        self.header.iteration = step.iteration;
        (self.header.start, self.header.end) = (step.start, step.end);
        self.writer.publish(loan, &self.header)?;
        if let Some((recorder, topic)) = &self.recorded {
            recorder.sample(*topic, self.header.sequence);
        }
        Ok(())
    }
}
