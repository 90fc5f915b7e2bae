//! Fields that are fed back: the coordinator takes them from their producer, and sends its own
//! iterate of them to those who consume them.
//!
//! Only the consumers that close the loop hear the coordinator; everybody else hears the producer
//! directly. The topic is `field/coordinator/NAME`; its samples have sequence numbers of their own.

use super::tap::Consumer;
use super::{COORDINATOR, Session};
use crate::couple::Part;
use crate::error::{Failure, RunError};
use proto::field::FieldKind;
use proto::grid::Grid;
use proto::message::{FieldHeader, Label};
use proto::model::Step;
use proto::transport::{FieldWriter, TransportError};

/// One field that is fed back.
#[derive(Debug)]
pub(super) struct Feedback {
    /// Index of its tap.
    pub(super) tap: usize,
    pub(super) readers: Vec<Consumer>,
    /// Surface integral of the last iterate, if its mapping conserves it.
    pub(super) heat: Option<f64>,
    writer: FieldWriter,
    header: FieldHeader,
}

impl Feedback {
    pub(super) fn new(
        tap: usize,
        (kind, grid): (&FieldKind, &Grid),
        readers: Vec<Consumer>,
        writer: FieldWriter,
    ) -> Self {
        let header = FieldHeader {
            protocol: proto::PROTOCOL_VERSION,
            components: kind.components,
            points: grid.points() as u64,
            grid_revision: grid.revision,
            name: Label::new(&kind.name),
            unit: Label::new(&kind.unit),
            producer: Label::new(COORDINATOR),
            grid: Label::new(&grid.name),
            ..FieldHeader::default()
        };
        Self { tap, readers, heat: None, writer, header }
    }

    /// The service on which the iterates of a field travel.
    pub(super) fn service(field: &str) -> String {
        format!("field/{COORDINATOR}/{field}")
    }

    /// Sequence number of the newest iterate.
    pub(super) fn sequence(&self) -> u64 {
        self.header.sequence
    }

    fn publish(&mut self, values: &[f64], step: &Step) -> Result<(), TransportError> {
        let mut loan = self.writer.loan(values.len())?;
        loan.values().copy_from_slice(values);
        self.header.sequence += 1;
        self.header.window = step.window;
        self.header.iteration = step.iteration;
        (self.header.start, self.header.end) = (step.start, step.end);
        self.writer.publish(loan, &self.header)
    }
}

impl Session {
    /// The consumers listen to the iterates.
    pub(super) fn wait_for_readers(&self) -> Result<(), RunError> {
        let deadline = std::time::Instant::now() + self.deadlines.start;
        let wait = |of: &Feedback| of.writer.wait_for_subscribers(deadline);
        self.feedback.iter().try_for_each(wait).map_err(|error| self.not_sent(&error))
    }

    /// The coupling vector: the fields that are fed back, in the order of the plan.
    pub(super) fn coupling_parts(&self) -> Vec<Part> {
        let fields = self.feedback.iter().map(|feedback| {
            let tap = &self.taps[feedback.tap];
            (tap.kind.name.as_str(), tap.values().map_or(0, <[f64]>::len))
        });
        crate::couple::parts(fields)
    }

    pub(super) fn send_iterate(&mut self, iterate: &[f64], step: &Step) -> Result<(), RunError> {
        for index in 0..self.feedback.len() {
            let feedback = &mut self.feedback[index];
            let tap = &self.taps[feedback.tap];
            let values = &iterate[self.parts[index].range.clone()];
            feedback.heat = tap.is_conservative().then(|| tap.grid.integrate(values));
            let sent = feedback.publish(values, step);
            sent.map_err(|error| self.not_sent(&error))?;
            self.bytes_exchanged += std::mem::size_of_val(values) as u64;
        }
        Ok(())
    }

    pub(super) fn copy_returned(&self, returned: &mut [f64]) {
        for (feedback, part) in self.feedback.iter().zip(&self.parts) {
            let values = self.taps[feedback.tap].values();
            let values = values.expect("a field that is fed back has its first values");
            returned[part.range.clone()].copy_from_slice(values);
        }
    }

    fn not_sent(&self, error: &TransportError) -> RunError {
        RunError::Failed(Failure {
            who: "the exchange of iterates".to_owned(),
            when: self.phase.to_string(),
            what: error.to_string(),
            fix: "see log.jsonl; a participant may have left its inputs unread".to_owned(),
        })
    }
}
