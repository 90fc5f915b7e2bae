//! Grids that move, and volumes: the coordinator subscribes to the geometry of every one that a field
//! of the run is on, or is mapped to, on `geometry/ROLE/GRID`.
//!
//! Geometry is part of the accepted state. A participant publishes it when it has accepted a window
//! (or has been restored), and replies; so it is known before anybody solves the next one, and holds
//! through all iterations of it. A volume is announced without a geometry, which it is initialised
//! with. A run without either has no such topic and no such reply.

use crate::record::{Recorder, TopicNumber};
use contract::field::GEOMETRY;
use contract::grid::Grid;
use contract::step::Step;
use coupling::ParticipantIndex;
use proto::transport::{Endpoint, FieldReader, FieldSample, TransportError};
use std::sync::Arc;

/// One grid whose geometry travels.
#[derive(Debug)]
pub struct MovingGrid {
    /// Index of the participant whose grid it is.
    pub(super) participant: ParticipantIndex,
    /// As it is accepted, for the next window.
    pub(super) grid: Grid,
    /// As it was in the last window: its samples are on it.
    pub(super) last: Grid,
    /// Most points that its topics have room for.
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
        (participant, role): (ParticipantIndex, &str),
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

    /// As it is known now.
    #[must_use]
    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    /// The next sample of a step says how it is now; `None` if none has come.
    ///
    /// # Errors
    /// It cannot be received, or it is not what it should be.
    pub fn take(&mut self, step: &Step) -> Result<Option<&Grid>, String> {
        let Some(sample) = self.reader.receive().map_err(|error| error.to_string())? else {
            return Ok(None);
        };
        self.grid = self.moved(&sample, step)?;
        self.sequence += 1;
        Ok(Some(&self.grid))
    }

    /// The service on which the geometry of a role's grid travels.
    #[must_use]
    pub fn service(role: &str, grid: &str) -> String {
        format!("geometry/{role}/{grid}")
    }

    /// Values in a checkpoint may be on it; what is on a volume is never exchanged.
    pub(super) fn is_exchanged(&self) -> bool {
        !self.grid.is_volume()
    }

    /// The file of a checkpoint with the grid on which the values in it are.
    pub(super) fn file(&self) -> String {
        format!("{}.{}.geometry", self.role, self.grid.name)
    }

    /// The grid as a sample says; it has to be labelled for this step.
    pub(super) fn moved(&self, sample: &FieldSample, step: &Step) -> Result<Grid, String> {
        let (header, grid) = (sample.header(), &self.grid);
        let about = format!("the geometry of grid `{}`", grid.name);
        if header.protocol != contract::PROTOCOL_VERSION {
            return Err(format!("{about} has protocol version {}", header.protocol));
        }
        let label = [&header.name.as_str(), &header.unit.as_str()];
        let place = [&header.producer.as_str(), &header.grid.as_str()];
        let expected = [&GEOMETRY.name, &GEOMETRY.unit];
        if label != expected || place != [&self.role.as_str(), &grid.name.as_str()] {
            let (label, place) = (label.map(|text| *text), place.map(|text| *text));
            return Err(format!("{about} is labelled {label:?} from {place:?}"));
        }
        if header.sequence != self.sequence + 1 {
            let (found, expected) = (header.sequence, self.sequence + 1);
            return Err(format!("{about} has sequence number {found}, not {expected}"));
        }
        let labelled = (header.window, header.iteration, header.start, header.end);
        if labelled != (step.window, step.iteration, step.start, step.end) {
            let (window, iteration) = (header.window, header.iteration);
            return Err(format!("{about} is labelled window {window}, iteration {iteration}"));
        }
        let shape = (header.components, header.points * u64::from(header.components));
        if shape != (GEOMETRY.components, sample.values().len() as u64) {
            let (components, points) = (header.components, header.points);
            let found = sample.values().len();
            return Err(format!(
                "{about} has {found} values ({components} components, {points} points)"
            ));
        }
        grid.with_geometry(sample.values(), header.grid_revision)
    }
}
