//! Field ports of a participant: inputs are read in place, outputs are written into loans.

use super::error::PortError;
use super::geometry::InputGrid;
use crate::field::{FieldKind, FieldSpec, Mapping};
use crate::grid::Grid;
use crate::live::Live;
use crate::message::{Command, FieldHeader, Interpolation, Label, OutputFile, Topic, Topics};
use crate::model::{InputField, Inputs, Outputs, Step};
use crate::transport::{
    Endpoint, FieldLoan, FieldReader, FieldSample, FieldWriter, TransportError,
};
use std::time::Instant;

/// An input and its current sample.
struct InputPort {
    field: FieldKind,
    /// Index of the grid.
    grid: usize,
    reader: FieldReader,
    sample: Option<FieldSample>,
    start: Option<Start>,
}

/// The values of an input at the start of a window.
#[derive(Debug, Default)]
struct Start {
    values: Vec<f64>,
    /// The current sample itself belongs to an earlier window, so the input is constant.
    in_use: bool,
}

/// Returns true if a sample belongs to an earlier window, or precedes the first solve.
fn is_earlier(sample: &FieldSample, window: u64) -> bool {
    sample.header().window < window || sample.header().iteration == 0
}

impl InputPort {
    /// Advances to the sample with this sequence number; all earlier samples must have arrived.
    /// Newer samples stay in the queue, because a producer that solves in parallel may be ahead.
    ///
    /// The last sample of an earlier window is the accepted one. Its values hold at the start of
    /// `window`, however often the window is repeated.
    fn advance(&mut self, expected: u64, window: u64) -> Result<(), PortError> {
        loop {
            let before = self.sample.as_ref().map_or(0, |s| s.header().sequence);
            if before >= expected {
                break;
            }
            let Some(sample) = self.reader.receive()? else { break };
            let header = sample.header();
            if header.sequence != before + 1 {
                return Err(self.out_of_sequence(header.sequence, before + 1));
            }
            self.check_label(&sample)?;
            self.keep_start(window);
            self.sample = Some(sample);
        }
        if let (Some(start), Some(sample)) = (&mut self.start, &self.sample) {
            start.in_use = is_earlier(sample, window);
        }
        match self.sample.as_ref().map_or(0, |s| s.header().sequence) {
            found if found == expected => Ok(()),
            found => Err(self.out_of_sequence(found, expected)),
        }
    }

    /// Copies the current values before they are replaced, if they hold at the start of this window
    /// and are needed.
    fn keep_start(&mut self, window: u64) {
        if let (Some(start), Some(sample)) = (&mut self.start, &self.sample)
            && is_earlier(sample, window)
        {
            start.values.clear();
            start.values.extend_from_slice(sample.values());
        }
    }

    fn out_of_sequence(&self, found: u64, expected: u64) -> PortError {
        PortError::Sequence { field: self.field.name.clone(), found, expected }
    }

    fn check_label(&self, sample: &FieldSample) -> Result<(), PortError> {
        let header = sample.header();
        if header.name.as_str() != self.field.name {
            return Err(PortError::Label {
                expected: self.field.name.clone(),
                found: header.name.as_str().to_owned(),
            });
        }
        Ok(())
    }

    /// Checks that the current sample is on the current grid revision, has a value for every point,
    /// and has as many values as at the start of the window.
    fn check_shape(&self, grid: &Grid) -> Result<(), PortError> {
        let Some(sample) = &self.sample else { return Ok(()) };
        let (field, found) = (self.field.name.clone(), sample.values().len());
        let expected = grid.points() * self.field.components as usize;
        if found != expected {
            let producer = sample.header().producer.as_str().to_owned();
            return Err(PortError::Length { field, producer, found, expected });
        }
        let revision = sample.header().grid_revision;
        if revision != grid.revision {
            let (grid, known) = (grid.name.clone(), grid.revision);
            return Err(PortError::Revision { field, grid, revision, known });
        }
        match &self.start {
            Some(Start { values, in_use: false }) if ![0, found].contains(&values.len()) => {
                Err(PortError::Grown { field, before: values.len(), now: found })
            }
            _ => Ok(()),
        }
    }
}

/// All inputs, in the order of the configuration, and their grids.
pub(super) struct InputPorts {
    ports: Vec<InputPort>,
    grids: Vec<InputGrid>,
}

impl InputPorts {
    pub(super) fn open(
        endpoint: &Endpoint,
        topics: &Topics,
        fields: impl Iterator<Item = FieldKind>,
    ) -> Result<Self, TransportError> {
        let (grids, indices) = InputGrid::open(endpoint, &topics.inputs, &topics.geometry)?;
        let inputs = topics.inputs.iter().zip(indices).zip(fields);
        let ports = inputs.map(|((topic, grid), field)| {
            let reader = endpoint.field_reader(&topic.service)?;
            let varies = topics.interpolation == Interpolation::Linear;
            let start = (varies && field.mapping == Mapping::Consistent).then(Start::default);
            Ok(InputPort { field, grid, reader, sample: None, start })
        });
        Ok(Self { ports: ports.collect::<Result<_, TransportError>>()?, grids })
    }

    /// Advances to the samples named by a command, and to the revisions of their grids.
    pub(super) fn advance(&mut self, command: &Command) -> Result<(), PortError> {
        let Self { ports, grids } = self;
        for (port, sequence) in ports.iter_mut().zip(command.expected) {
            port.advance(sequence, command.window)?;
            let revision = port.sample.as_ref().map(|sample| sample.header().grid_revision);
            if let Some(revision) = revision {
                grids[port.grid].follow(&port.field.name, revision)?;
            }
        }
        ports.iter().try_for_each(|port| port.check_shape(&grids[port.grid].grid))
    }

    /// Takes over a grid that this participant's model has moved.
    pub(super) fn moved(&mut self, grid: &Grid) {
        self.grids.iter_mut().for_each(|input| input.moved(grid));
    }

    /// Passes received live values to the models that read them.
    pub(super) fn give(&self, live: &Live) -> Result<(), PortError> {
        for port in self.ports.iter().filter(|port| live.limits.contains_key(&port.field.name)) {
            let (key, Some(sample)) = (&port.field.name, &port.sample) else { continue };
            match sample.values() {
                [value] if value.is_finite() => live.give(key, *value),
                values => {
                    return Err(PortError::Live { key: key.clone(), values: values.to_vec() });
                }
            }
        }
        Ok(())
    }

    /// Returns the current values.
    pub(super) fn values(&self) -> InputValues<'_> {
        let values = self.ports.iter().filter_map(|port| {
            let values = port.sample.as_ref()?.values();
            let start = port.start.as_ref().and_then(|start| match start {
                Start { in_use: true, .. } => Some(values),
                Start { values, .. } => Some(values.as_slice()).filter(|v| !v.is_empty()),
            });
            let grid = &self.grids[port.grid].grid;
            Some(InputValue { name: &port.field.name, now: InputField { values, grid }, start })
        });
        InputValues(values.collect())
    }
}

/// Current values in shared memory; unlike the ports, these may be read by any thread.
pub(super) struct InputValues<'a>(Vec<InputValue<'a>>);

struct InputValue<'a> {
    name: &'a str,
    now: InputField<'a>,
    /// Values at the start of the window.
    start: Option<&'a [f64]>,
}

impl InputValues<'_> {
    fn of(&self, field: &FieldSpec) -> Option<&InputValue<'_>> {
        self.0.iter().find(|value| value.name == field.name)
    }
}

impl Inputs for InputValues<'_> {
    fn get(&self, field: &FieldSpec) -> Option<InputField<'_>> {
        self.of(field).map(|value| value.now)
    }

    fn start(&self, field: &FieldSpec) -> Option<&[f64]> {
        self.of(field)?.start
    }
}

/// Mark of an unwritten value in a loan: a NaN that the processor never produces by itself, and
/// that propagates through computations.
const UNWRITTEN: f64 = f64::from_bits(0x7ff8_756e_7772_6974);

/// Maximum number of marks in a loan. A completely unwritten output is always detected. In a partly
/// written one, any gap of 1/63 of its values is detected, and a smaller gap by chance.
const MARKS: usize = 64;

/// Indices of the marks in a loan: evenly spread, including the first and the last value.
fn marked(values: usize) -> impl Iterator<Item = usize> {
    let marks = values.min(MARKS);
    (0..marks).map(move |mark| mark * (values - 1) / (marks - 1).max(1))
}

fn mark(values: &mut [f64]) {
    marked(values.len()).for_each(|at| values[at] = UNWRITTEN);
}

/// Index of the first mark that is still in place.
fn first_unwritten(values: &[f64]) -> Option<usize> {
    marked(values.len()).find(|at| values[*at].to_bits() == UNWRITTEN.to_bits())
}

/// An output with its writer and current loan.
struct OutputPort {
    name: String,
    values: usize,
    writer: FieldWriter,
    header: FieldHeader,
    loan: Option<FieldLoan>,
}

/// Outputs that are published together.
#[derive(Default)]
pub(super) struct OutputPorts(Vec<OutputPort>);

impl OutputPorts {
    pub(super) fn open(
        endpoint: &Endpoint,
        topics: &[Topic],
        producer: &str,
        kind: impl Fn(&str) -> Option<FieldKind>,
    ) -> Result<Self, PortError> {
        let ports = topics.iter().map(|topic| {
            let kind = kind(&topic.field).ok_or_else(|| PortError::Label {
                expected: "a field that this program describes".to_owned(),
                found: topic.field.clone(),
            })?;
            let values = topic.grid.points() * kind.components as usize;
            let header = FieldHeader::new(&kind, producer, &topic.grid);
            let (service, subscribers) = (&topic.service, topic.subscribers);
            let writer = match topic.geometry {
                Some(_) => endpoint.field_writer(service, values, subscribers)?,
                None => endpoint.fixed_field_writer(service, values, subscribers)?,
            };
            Ok(OutputPort { name: kind.name, values, writer, header, loan: None })
        });
        Ok(Self(ports.collect::<Result<_, PortError>>()?))
    }

    /// Waits for all subscribers. As a startup barrier, nothing is published before all have
    /// subscribed.
    pub(super) fn wait_for_subscribers(&self, deadline: Instant) -> Result<(), TransportError> {
        self.0.iter().try_for_each(|port| port.writer.wait_for_subscribers(deadline))
    }

    pub(super) fn loan(&mut self) -> Result<(), PortError> {
        for port in &mut self.0 {
            if port.loan.is_some() {
                return Err(PortError::Loan(port.name.clone()));
            }
            let mut loan = port.writer.loan(port.values)?;
            mark(loan.values());
            port.loan = Some(loan);
        }
        Ok(())
    }

    /// Sends the following samples on the moved grid.
    pub(super) fn moved(&mut self, grid: &Grid) {
        let name = Label::new(&grid.name);
        for port in self.0.iter_mut().filter(|port| port.header.grid == name) {
            port.values = grid.points() * port.header.components as usize;
            port.header.points = grid.points() as u64;
            port.header.grid_revision = grid.revision;
        }
    }

    /// Fills the loans with values from files, one for each output.
    pub(super) fn read(&mut self, files: &[OutputFile]) -> Result<(), PortError> {
        for port in &mut self.0 {
            let Some(loan) = port.loan.as_mut() else { continue };
            let file = files.iter().find(|file| file.field == port.name);
            let path = file.map(|file| file.path.clone()).unwrap_or_default();
            let failed = |reason: String| {
                let (field, path) = (port.name.clone(), path.clone());
                Err(PortError::Restore { field, path, reason })
            };
            let bytes = match std::fs::read(&path) {
                Ok(bytes) => bytes,
                Err(error) => return failed(error.to_string()),
            };
            let values = loan.values();
            if bytes.len() != std::mem::size_of_val(values) {
                let (found, expected) = (bytes.len(), std::mem::size_of_val(values));
                return failed(format!("{found} bytes, expected {expected}"));
            }
            for (value, bytes) in values.iter_mut().zip(bytes.as_chunks().0) {
                *value = f64::from_le_bytes(*bytes);
            }
        }
        Ok(())
    }

    /// Returns the loans unpublished.
    pub(super) fn discard(&mut self) {
        self.0.iter_mut().for_each(|port| port.loan = None);
    }

    /// Publishes all loans; none if any loan is unwritten.
    pub(super) fn publish(&mut self, step: &Step) -> Result<(), PortError> {
        if let Some((field, index)) = self.unwritten() {
            self.discard();
            return Err(PortError::Unwritten { field, index });
        }
        for port in &mut self.0 {
            if let Some(loan) = port.loan.take() {
                port.header.sequence += 1;
                port.header.set_step(step);
                port.writer.publish(loan, &port.header)?;
            }
        }
        Ok(())
    }
}

impl OutputPorts {
    /// Returns the first unwritten output and the index of its first mark.
    fn unwritten(&mut self) -> Option<(String, usize)> {
        self.0.iter_mut().find_map(|port| {
            let index = first_unwritten(port.loan.as_mut()?.values())?;
            Some((port.name.clone(), index))
        })
    }
}

impl Outputs for OutputPorts {
    fn get(&mut self, field: &FieldSpec) -> Option<&mut [f64]> {
        let port = self.0.iter_mut().find(|port| port.name == field.name)?;
        port.loan.as_mut().map(FieldLoan::values)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_not_written_is_noticed_whatever_its_size() {
        for length in [0_usize, 1, 2, 63, 64, 65, 1000, 100_003] {
            let mut values = vec![1.0; length];
            mark(&mut values);
            assert_eq!(first_unwritten(&values), (length > 0).then_some(0), "{length}");
            assert!(marked(length).count() <= MARKS);
            values.fill(f64::NAN);
            assert_eq!(first_unwritten(&values), None, "another NaN is a value");
        }
    }

    #[test]
    fn a_gap_of_a_sixty_third_is_noticed_wherever_it_is() {
        let length = 6300;
        for start in (0..length - 100).step_by(7) {
            let mut values = vec![0.0; length];
            mark(&mut values);
            values[..start].fill(1.0);
            values[start + 100..].fill(1.0);
            let found = first_unwritten(&values).unwrap();
            assert!((start..start + 100).contains(&found), "{start}: {found}");
        }
    }
}
