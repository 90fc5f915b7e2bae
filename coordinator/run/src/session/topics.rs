//! The topics of a run: services, subscribers, grids.

use super::Session;
use super::feedback::Feedback;
use super::mapped::Mapped;
use super::moving::MovingGrid;
use super::subscription::{Subscription, readers, subscription};
use crate::plan::{Field, Plan};
use contract::configuration::Layout;
use contract::grid::Grid;
use contract::message::{GeometryTopic, Topic};
use coupling::ParticipantIndex;
use proto::transport::TransportError;
use typed_index_collections::TiSlice;

impl Session {
    /// Listens to the grids whose geometry travels.
    pub(super) fn open_geometry(
        &mut self,
        plan: &Plan,
        layouts: &TiSlice<ParticipantIndex, Layout>,
    ) -> Result<(), TransportError> {
        for (one, layout) in layouts.iter_enumerated() {
            for grid in plan.travelling(one, layout) {
                let owner = (one, self.peers.all()[one].role());
                let recorder = self.peers.recorder();
                self.moving.push(MovingGrid::open(self.peers.endpoint(), owner, grid, recorder)?);
            }
        }
        Ok(())
    }

    /// The geometry that a participant has to publish: we subscribe, and so does every participant
    /// which receives a field on the grid from its producer, or our iterates of it.
    pub(super) fn geometry_topics(
        &self,
        plan: &Plan,
        one: ParticipantIndex,
        layouts: &TiSlice<ParticipantIndex, Layout>,
    ) -> Vec<GeometryTopic> {
        let topic = |moving: &MovingGrid| {
            let name = &moving.grid.name;
            let on_it = |field: &&Field| {
                let grid = layouts[one].grid_of(&field.kind.name);
                field.producer == one && grid.is_some_and(|grid| grid.name == *name)
            };
            let listens = |consumer: &ParticipantIndex| {
                plan.fields.iter().filter(on_it).any(|field| {
                    let maps = || {
                        matches!(subscription(field, *consumer, layouts), Subscription::Mapped(_))
                    };
                    field.consumers.contains(consumer) && !maps()
                })
            };
            let listeners = self.peers.all().keys().filter(listens).count();
            let service = MovingGrid::service(self.peers.all()[one].role(), name);
            let subscribers = listeners + 1 + usize::from(self.peers.recorder().is_some());
            GeometryTopic { grid: name.clone(), service, subscribers }
        };
        self.moving.iter().filter(|moving| moving.participant == one).map(topic).collect()
    }

    /// The service of a grid's geometry, if it may move.
    fn geometry_service(&self, one: ParticipantIndex, grid: &Grid) -> Option<String> {
        let moves = self.moving_grid(one, &grid.name);
        moves.map(|_| MovingGrid::service(self.peers.all()[one].role(), &grid.name))
    }

    /// The topic on which the producer sends a field.
    pub(super) fn topic(
        &self,
        plan: &Plan,
        field: &Field,
        layouts: &TiSlice<ParticipantIndex, Layout>,
    ) -> Topic {
        let role = &plan.participants[field.producer].role;
        let grid: &Grid =
            layouts[field.producer].grid_of(&field.kind.name).expect("layout is checked");
        Topic {
            field: field.kind.name.clone(),
            service: format!("field/{role}/{}", field.kind.name),
            grid: grid.clone(),
            // Those of its consumers which subscribe to it directly, our own tap, and the recorder.
            subscribers: readers(field, layouts, &Subscription::Producer).count()
                + 1
                + usize::from(self.peers.recorder().is_some()),
            geometry: self.geometry_service(field.producer, grid),
        }
    }

    /// The topic on which a consumer receives a field, given the producer's.
    pub(super) fn subscribed(
        &self,
        one: ParticipantIndex,
        field: &Field,
        topic: &Topic,
        layouts: &TiSlice<ParticipantIndex, Layout>,
    ) -> Topic {
        let name = &topic.field;
        match subscription(field, one, layouts) {
            Subscription::Producer => topic.clone(),
            Subscription::Iterates => Topic {
                service: Feedback::service(name),
                subscribers: readers(field, layouts, &Subscription::Iterates).count(),
                ..topic.clone()
            },
            Subscription::Mapped(grid) => Topic {
                field: name.clone(),
                service: Mapped::service(name, self.peers.all()[one].role()),
                grid: grid.clone(),
                subscribers: 1,
                geometry: self.geometry_service(one, grid),
            },
        }
    }
}
