//! Geometry of moving grids and of volumes: publishes a participant's own grids and follows those
//! of its inputs. Volumes receive their geometry as if they had moved.

use super::error::PortError;
use crate::field;
use crate::grid::Grid;
use crate::message::{FieldHeader, GeometryTopic, Label, Topic};
use crate::model::Step;
use crate::transport::{Endpoint, FieldReader, FieldWriter, TransportError};
use std::time::Instant;

/// A grid of this participant, as last published.
struct GeometryPort {
    grid: Grid,
    writer: FieldWriter,
    header: FieldHeader,
}

impl GeometryPort {
    fn open(
        endpoint: &Endpoint,
        topic: &GeometryTopic,
        producer: &str,
        grids: &[Grid],
    ) -> Result<Self, PortError> {
        let grid = grids.iter().find(|grid| grid.name == topic.grid).ok_or_else(|| {
            PortError::Geometry(format!("there is no grid `{}` in the layout", topic.grid))
        })?;
        let header = FieldHeader {
            protocol: crate::PROTOCOL_VERSION,
            components: field::GEOMETRY.components,
            name: Label::new(field::GEOMETRY.name),
            unit: Label::new(field::GEOMETRY.unit),
            producer: Label::new(producer),
            grid: Label::new(&topic.grid),
            ..FieldHeader::default()
        };
        let values = field::GEOMETRY.components as usize * grid.geometry_points();
        let writer = endpoint.field_writer(&topic.service, values, topic.subscribers)?;
        Ok(Self { grid: grid.clone(), writer, header })
    }

    fn is_not_given(&self) -> Result<(), PortError> {
        let Grid { name, .. } = &self.grid;
        match (self.grid.is_volume(), self.grid.is_announced()) {
            (true, false) => Ok(()),
            (true, true) => Err(PortError::Geometry(format!(
                "the geometry of the volume `{name}` is not given"
            ))),
            (false, _) => {
                Err(PortError::Geometry(format!("the grid `{name}`, which may move, is not given")))
            }
        }
    }

    /// Publishes the grid if it has moved; returns whether it has.
    fn publish(&mut self, moved: &Grid, step: &Step) -> Result<bool, PortError> {
        self.grid.check_moved(moved).map_err(PortError::Geometry)?;
        if moved.is_announced() {
            let name = &moved.name;
            return Err(PortError::Geometry(format!(
                "the volume `{name}` is given without geometry"
            )));
        }
        if moved.revision == self.grid.revision {
            return Ok(false);
        }
        let points = moved.geometry_points();
        let mut loan = self.writer.loan(self.header.components as usize * points)?;
        moved.encode_geometry(loan.values());
        let header = &mut self.header;
        header.sequence += 1;
        (header.points, header.grid_revision) = (points as u64, moved.revision);
        header.set_step(step);
        self.writer.publish(loan, header)?;
        self.grid.clone_from(moved);
        Ok(true)
    }
}

/// Grids of this participant that peers follow.
pub(super) struct GeometryPorts(Vec<GeometryPort>);

impl GeometryPorts {
    /// Opens the ports for these topics; `grids` are those of the layout.
    pub(super) fn open(
        endpoint: &Endpoint,
        topics: &[GeometryTopic],
        producer: &str,
        grids: &[Grid],
    ) -> Result<Self, PortError> {
        let ports = topics.iter().map(|t| GeometryPort::open(endpoint, t, producer, grids));
        ports.collect::<Result<_, _>>().map(Self)
    }

    pub(super) fn wait_for_subscribers(&self, deadline: Instant) -> Result<(), TransportError> {
        self.0.iter().try_for_each(|port| port.writer.wait_for_subscribers(deadline))
    }

    /// Publishes the grids that have moved, and passes each of them to `moved`. A volume whose
    /// geometry is already published need not be passed again.
    pub(super) fn publish(
        &mut self,
        grids: &[Grid],
        step: &Step,
        mut moved: impl FnMut(&Grid),
    ) -> Result<(), PortError> {
        for port in &mut self.0 {
            match grids.iter().find(|grid| grid.name == port.grid.name) {
                Some(grid) if port.publish(grid, step)? => moved(grid),
                Some(_) => {}
                None => port.is_not_given()?,
            }
        }
        Ok(())
    }
}

/// Origin of the geometry of an input's grid.
enum Source {
    /// The grid never changes.
    Fixed,
    /// The model of this participant moves the grid.
    Own,
    /// The owner of the grid publishes its geometry; with the sequence number of the newest sample.
    Subscribed { reader: FieldReader, sequence: u64 },
}

/// A grid on which inputs arrive.
pub(super) struct InputGrid {
    pub(super) grid: Grid,
    /// Service of the geometry; empty for a fixed grid.
    service: String,
    source: Source,
}

impl InputGrid {
    /// Opens the grids of these inputs, and returns them with the index of each input's grid.
    /// Moving grids are shared.
    pub(super) fn open(
        endpoint: &Endpoint,
        topics: &[Topic],
        own: &[GeometryTopic],
    ) -> Result<(Vec<Self>, Vec<usize>), TransportError> {
        let (mut grids, mut indices) = (Vec::<Self>::new(), Vec::new());
        for topic in topics {
            let service = topic.geometry.clone().unwrap_or_default();
            let known = grids.iter().position(|g| g.service == service && !service.is_empty());
            indices.push(known.unwrap_or(grids.len()));
            if known.is_none() {
                let source = match &topic.geometry {
                    None => Source::Fixed,
                    Some(service) if own.iter().any(|t| t.service == *service) => Source::Own,
                    Some(service) => {
                        Source::Subscribed { reader: endpoint.field_reader(service)?, sequence: 0 }
                    }
                };
                grids.push(Self { grid: topic.grid.clone(), service, source });
            }
        }
        Ok((grids, indices))
    }

    /// Takes over a grid that this participant's model has moved.
    pub(super) fn moved(&mut self, grid: &Grid) {
        if matches!(self.source, Source::Own) && self.grid.name == grid.name {
            self.grid.clone_from(grid);
        }
    }

    /// Advances the grid to the revision of a sample of `field`.
    pub(super) fn follow(&mut self, field: &str, revision: u64) -> Result<(), PortError> {
        let Self { grid, source, .. } = self;
        if let Source::Subscribed { reader, sequence } = source {
            while grid.revision < revision
                && let Some(sample) = reader.receive()?
            {
                let header = sample.header();
                *sequence += 1;
                let label = (header.name.as_str(), header.grid.as_str(), header.sequence);
                if label != (field::GEOMETRY.name, &grid.name, *sequence) {
                    let found = format!("{:?} of {:?}, number {}", label.0, label.1, label.2);
                    let expected = format!("the geometry of {:?}, number {sequence}", grid.name);
                    return Err(PortError::Label { expected, found });
                }
                *grid = grid
                    .with_geometry(sample.values(), header.grid_revision)
                    .map_err(PortError::Geometry)?;
            }
        }
        if grid.revision == revision {
            return Ok(());
        }
        let (field, grid, known) = (field.to_owned(), grid.name.clone(), grid.revision);
        Err(PortError::Revision { field, grid, revision, known })
    }
}
