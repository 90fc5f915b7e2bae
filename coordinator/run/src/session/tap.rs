//! The coordinator's own view of every field: it receives each sample, checks label and values,
//! and holds the newest.

use super::index::MovingIndex;
use crate::record::TopicNumber;
use contract::field::{FieldKind, Mapping};
use contract::grid::Grid;
use contract::message::FieldHeader;
use contract::step::Step;
use coupling::ParticipantIndex;
use proto::transport::{FieldReader, FieldSample};

/// A participant that consumes a field.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Consumer {
    /// Index of the participant.
    pub participant: ParticipantIndex,
    /// Index among its inputs.
    pub slot: usize,
}

/// One field of the run.
#[derive(Debug)]
pub struct Tap {
    pub(super) kind: FieldKind,
    pub(super) grid: Grid,
    /// Index of the grid among those that move, if it does.
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

impl Tap {
    /// A tap of the only participant of a run, the one with this role.
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

    /// The next sample of a step becomes the newest; `None` if none has come.
    ///
    /// # Errors
    /// It cannot be received, or it is not what it should be.
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

    /// Its next samples are on the grid as it is now.
    pub fn move_to(&mut self, grid: &Grid) {
        self.grid.clone_from(grid);
    }

    /// Kind of the field.
    #[must_use]
    pub fn kind(&self) -> &FieldKind {
        &self.kind
    }

    /// The grid that its newest sample is on.
    #[must_use]
    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    /// Index of the participant that sends it.
    #[must_use]
    pub fn producer(&self) -> ParticipantIndex {
        self.producer
    }

    /// Role of the participant that sends it.
    #[must_use]
    pub fn producer_role(&self) -> &str {
        &self.producer_role
    }

    /// Which consumers subscribe to it directly; those which receive iterates or mapped values of
    /// it subscribe to the coordinator.
    #[must_use]
    pub fn readers(&self) -> &[Consumer] {
        &self.readers
    }

    /// Its surface integral is what a mapping preserves.
    pub(super) fn is_conservative(&self) -> bool {
        self.kind.mapping == Mapping::Conservative
    }

    /// The case wants it written out.
    #[must_use]
    pub fn wanted(&self) -> bool {
        self.wanted
    }

    /// The newest values, component-major; `None` before the first sample.
    #[must_use]
    pub fn values(&self) -> Option<&[f64]> {
        self.sample.as_ref().map(FieldSample::values)
    }

    /// Sequence number of the newest sample; 0 before the first.
    #[must_use]
    pub fn sequence(&self) -> u64 {
        self.sample.as_ref().map_or(0, |sample| sample.header().sequence)
    }

    /// What is wrong with a sample, if anything.
    pub(super) fn fault(&self, sample: &FieldSample, step: &Step) -> Option<String> {
        let (header, name) = (sample.header(), &self.kind.name);
        let expected = self.grid.points() * self.kind.components as usize;
        if header.protocol != contract::PROTOCOL_VERSION {
            return Some(format!("field `{name}` has protocol version {}", header.protocol));
        }
        if header.grid_revision != self.grid.revision {
            let (grid, found, known) = (&self.grid.name, header.grid_revision, self.grid.revision);
            return Some(format!(
                "field `{name}` is on revision {found} of grid `{grid}`, whose geometry is known in \
                 revision {known}"
            ));
        }
        if sample.values().len() != expected || !self.shape_fits(header) {
            return Some(format!(
                "field `{name}` has {} values ({} components, {} points), expected {expected}",
                sample.values().len(),
                header.components,
                header.points
            ));
        }
        let label = [
            &header.name.as_str(),
            &header.unit.as_str(),
            &header.producer.as_str(),
            &header.grid.as_str(),
        ];
        if label
            != [
                &name.as_str(),
                &self.kind.unit.as_str(),
                &self.producer_role.as_str(),
                &self.grid.name.as_str(),
            ]
        {
            return Some(format!(
                "field `{name}` is labelled {:?} in {:?} from {:?} on {:?}",
                header.name, header.unit, header.producer, header.grid
            ));
        }
        if header.sequence != self.sequence() + 1 {
            let (found, expected) = (header.sequence, self.sequence() + 1);
            return Some(format!("field `{name}` has sequence number {found}, not {expected}"));
        }
        let labelled = (header.window, header.iteration, header.start, header.end);
        if labelled != (step.window, step.iteration, step.start, step.end) {
            return Some(format!(
                "field `{name}` is labelled window {}, iteration {}, from {} s to {} s",
                header.window, header.iteration, header.start, header.end
            ));
        }
        None
    }

    fn shape_fits(&self, header: &FieldHeader) -> bool {
        header.components == self.kind.components && header.points == self.grid.points() as u64
    }
}
