//! Moving grids and volumes: the coordinator subscribes to their geometry on `geometry/ROLE/GRID`,
//! if a field of the run is on the grid or is mapped to it.
//!
//! Geometry is part of the accepted state. A participant publishes it when it has accepted a window
//! or has been restored, and then replies. Thus the geometry is known before the next window and
//! holds through all of its iterations. A volume is announced without geometry and receives it
//! during initialisation. A run without moving grids and volumes has no such topics and replies.

use crate::record::{Recorder, TopicNumber};
use contract::field::GEOMETRY;
use contract::grid::Grid;
use contract::message::FieldHeader;
use contract::step::Step;
use coupling::ParticipantIndex;
use proto::transport::{Endpoint, FieldReader, FieldSample, TransportError};
use std::sync::Arc;

/// A grid whose geometry is sent.
#[derive(Debug)]
pub struct MovingGrid {
    /// Index of the participant that owns the grid.
    pub(super) participant: ParticipantIndex,
    /// Accepted grid, for the next window.
    pub(super) grid: Grid,
    /// Grid of the last window, to which the current samples belong.
    pub(super) last: Grid,
    /// Largest number of points for which the topics have room.
    pub(super) capacity: usize,
    pub(super) role: String,
    pub(super) reader: FieldReader,
    pub(super) sequence: u64,
    pub(super) recorded: Option<TopicNumber>,
}

impl MovingGrid {
    /// Subscribes to the geometry of a participant's grid.
    ///
    /// # Errors
    /// The topic cannot be opened.
    pub fn open(
        endpoint: &Endpoint,
        participant: ParticipantIndex,
        role: &str,
        grid: &Grid,
        recorder: Option<&Arc<Recorder>>,
    ) -> Result<Self, TransportError> {
        let service = Self::service(role, &grid.name);
        let recorded = recorder.map(|recorder| recorder.listen(endpoint, &service)).transpose()?;
        Ok(Self {
            participant,
            grid: grid.clone(),
            last: grid.clone(),
            capacity: grid.points(),
            role: role.to_owned(),
            reader: endpoint.field_reader(&service)?,
            sequence: 0,
            recorded,
        })
    }

    /// Returns the current grid.
    #[must_use]
    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    /// Takes the next sample of a step as the new geometry; `None` if none has arrived.
    ///
    /// # Errors
    /// The sample cannot be received, or its label or geometry is invalid.
    pub fn take(&mut self, step: &Step) -> Result<Option<&Grid>, String> {
        let Some(sample) = self.reader.receive().map_err(|error| error.to_string())? else {
            return Ok(None);
        };
        self.grid = self.moved(&sample, step)?;
        self.sequence += 1;
        Ok(Some(&self.grid))
    }

    /// Returns the name of the service for the geometry of a grid.
    #[must_use]
    pub fn service(role: &str, grid: &str) -> String {
        format!("geometry/{role}/{grid}")
    }

    /// Returns whether values in a checkpoint may be on the grid. Fields on a volume are never
    /// exchanged.
    pub(super) fn is_exchanged(&self) -> bool {
        !self.grid.is_volume()
    }

    /// Returns the name of the checkpoint file with the grid of the stored values.
    pub(super) fn file(&self) -> String {
        format!("{}.{}.geometry", self.role, self.grid.name)
    }

    /// Returns the grid that a sample describes. The label of the sample must match this step.
    pub(super) fn moved(&self, sample: &FieldSample, step: &Step) -> Result<Grid, String> {
        let (header, grid) = (sample.header(), &self.grid);
        let mut expected = FieldHeader::new(&GEOMETRY.kind(), &self.role, grid);
        expected.set_step(step);
        expected.sequence = self.sequence + 1;
        // Number of points and revision are new; the geometry itself is checked against them.
        (expected.points, expected.grid_revision) = (header.points, header.grid_revision);
        if let Some(difference) = header.difference(&expected, sample.values().len()) {
            return Err(format!("the geometry of grid `{}` {difference}", grid.name));
        }
        grid.with_geometry(sample.values(), header.grid_revision)
    }
}
