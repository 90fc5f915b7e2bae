//! Fields of the driven participant: inputs, published from recorded samples when they are due, and
//! outputs, received for comparison.
//!
//! Between two solves the participant needs the newest sample, and the newest one of the window
//! before, which holds at the window's start. Other samples in between are omitted, and all are
//! renumbered.

use contract::configuration::Layout;
use contract::description::Description;
use contract::field::GEOMETRY;
use contract::grid::Grid;
use contract::message::{Command, FieldHeader, GeometryTopic, Topic, Topics};
use proto::transport::{Endpoint, FieldReader, FieldWriter, TransportError};
use run::plan::{geometry_bytes, sample_bytes};
use std::time::Instant;

/// Topic of an input.
#[derive(Debug)]
struct Input {
    service: String,
    writer: FieldWriter,
    /// Recorded samples that are still to be published, in order.
    pending: Vec<(FieldHeader, Vec<f64>)>,
    /// Recorded and new sequence number of the last published sample.
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

    /// Publishes the first `count` pending samples.
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

/// All inputs, in the order of the configuration, and the geometry of their grids.
#[derive(Debug, Default)]
pub(super) struct Inputs {
    inputs: Vec<Input>,
    geometry: Vec<Input>,
}

impl Inputs {
    /// Opens the topics of the inputs, and of grids that other participants move.
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

    /// Takes a recorded sample, if it belongs to an input.
    pub(super) fn take(&mut self, service: &str, header: &FieldHeader, values: &[f64]) {
        let all = self.inputs.iter_mut().chain(&mut self.geometry);
        for input in all.filter(|input| input.service == service) {
            match input.pending.last_mut() {
                Some((last, kept)) if last.window == header.window => {
                    *last = *header;
                    values.clone_into(kept);
                }
                _ => input.pending.push((*header, values.to_vec())),
            }
            // Keeps the newest sample, and the newest one of the window before.
            let surplus = input.pending.len().saturating_sub(2);
            input.pending.drain(..surplus);
        }
    }

    /// Publishes the inputs of a recorded solve, and writes their new numbers into the command.
    pub(super) fn publish(&mut self, command: &mut Command) -> Result<(), TransportError> {
        for geometry in &mut self.geometry {
            geometry.publish(geometry.pending.len())?;
        }
        for (slot, input) in self.inputs.iter_mut().enumerate() {
            let wanted = command.expected[slot];
            let due = input.pending.iter().take_while(|(header, _)| header.sequence <= wanted);
            let due = due.count();
            input.publish(due)?;
            // An unrecorded number becomes one that never arrives.
            let known = input.recorded == wanted;
            command.expected[slot] = if known { input.published } else { u64::MAX };
        }
        Ok(())
    }
}

/// Topic of an output of the participant.
#[derive(Debug)]
pub(super) struct Output {
    pub(super) field: String,
    pub(super) service: String,
    pub(super) reader: FieldReader,
    /// Whether the output is sent in every iteration; otherwise only when a window is observed.
    pub(super) exchanged: bool,
    /// Last recorded sample.
    pub(super) recorded: Option<(FieldHeader, Vec<f64>)>,
    /// Whether a sample was recorded since the pending restore.
    pub(super) restored: bool,
    /// For a geometry: the last recorded grid, and the one before.
    pub(super) grids: Vec<Grid>,
}

impl Output {
    fn open(endpoint: &Endpoint, field: &str, service: &str) -> Result<Self, TransportError> {
        let (field, service) = (field.to_owned(), service.to_owned());
        let reader = endpoint.field_reader(&service)?;
        let (exchanged, recorded, restored, grids) = (false, None, false, Vec::new());
        Ok(Self { field, service, reader, exchanged, recorded, restored, grids })
    }

    /// Takes a recorded sample.
    pub(super) fn take(&mut self, header: &FieldHeader, values: &[f64]) {
        // An output sent before any solve is sent in each iteration, except a geometry.
        self.exchanged |= header.iteration == 0 && self.grids.is_empty();
        self.restored = true;
        let (label, kept) = self.recorded.get_or_insert_default();
        *label = *header;
        values.clone_into(kept);
        let moved = self.grids.last().map(|g| g.with_geometry(values, header.grid_revision));
        if let Some(Ok(grid)) = moved {
            self.grids.push(grid);
            let surplus = self.grids.len().saturating_sub(2);
            self.grids.drain(..surplus);
        }
    }
}

/// Opens the outputs of the participant, and the geometry of its grids.
pub(super) fn open_outputs(
    endpoint: &Endpoint,
    topics: &mut Topics,
    layout: &Layout,
) -> Result<Vec<Output>, TransportError> {
    let mut outputs = Vec::new();
    for topic in &mut topics.outputs {
        topic.subscribers = 1;
        outputs.push(Output::open(endpoint, &topic.field, &topic.service)?);
    }
    for topic in &mut topics.geometry {
        topic.subscribers = 1;
        let mut output = Output::open(endpoint, GEOMETRY.name, &topic.service)?;
        output.grids.extend(grid_of(layout, topic).cloned());
        outputs.push(output);
    }
    Ok(outputs)
}

/// Returns the size of a sample of each topic [byte].
pub(super) fn sample_sizes(topics: &Topics, layout: &Layout, said: &Description) -> Vec<u64> {
    let components = |name: &str| said.field_kind(name).map_or(1, |kind| kind.components);
    let all = topics.inputs.iter().chain(&topics.outputs);
    let fields = all.map(|t| sample_bytes(t.grid.points(), components(&t.field)));
    let geometry = topics.geometry.iter().filter_map(|topic| grid_of(layout, topic));
    fields.chain(geometry.map(geometry_bytes)).collect()
}

/// Returns the grid of a geometry topic in a layout.
fn grid_of<'a>(layout: &'a Layout, topic: &GeometryTopic) -> Option<&'a Grid> {
    layout.grids.iter().find(|grid| grid.name == topic.grid)
}

/// Returns the moving grids at the time of the last outputs. Volumes are excluded.
pub(super) fn moving_grids(outputs: &[Output]) -> Vec<Grid> {
    let revision = |grid: &str| {
        let on_it = |(header, _): &&(FieldHeader, Vec<f64>)| header.grid.as_str() == grid;
        let samples = outputs.iter().filter(|o| o.grids.is_empty());
        samples.filter_map(|o| o.recorded.as_ref()).find(on_it).map(|(h, _)| h.grid_revision)
    };
    let moves = |output: &&Output| output.grids.first().is_some_and(|grid| !grid.is_volume());
    let of = |output: &Output| {
        let wanted = revision(&output.grids[0].name);
        let exact = output.grids.iter().find(|grid| Some(grid.revision) == wanted);
        exact.or(output.grids.first()).cloned()
    };
    outputs.iter().filter(moves).filter_map(of).collect()
}
