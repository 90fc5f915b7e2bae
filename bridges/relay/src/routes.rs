//! Topics of a participant, numbered identically at both ends, and the samples sent over them.

use crate::frame::Frame;
use crate::link::{Fault, SHORT, Sending};
use crate::pack::{Packing, Unpackable, pack, unpack};
use contract::configuration::Configuration;
use contract::description::Description;
use contract::field::{self, FieldKind, FieldSpec, GEOMETRY};
use contract::grid::Grid;
use contract::message::{FieldHeader, Topics};
use proto::transport::{Endpoint, FieldReader, FieldWriter, TransportError};
use std::collections::BTreeMap;
use std::time::Instant;

/// Factor by which a grid may outgrow its announced size.
const GROWTH: usize = 4;

/// Topic of the run.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Route {
    pub(crate) service: String,
    /// Announced number of values of a sample.
    values: usize,
    /// Number of subscribers besides the coordinator.
    subscribers: usize,
}

/// Topics of a participant: inputs with the geometry of their grids, outputs with the geometry of
/// own grids. Both ends derive the same lists from the body of `Connect`.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Routes {
    pub(crate) inward: Vec<Route>,
    pub(crate) outward: Vec<Route>,
    pub(crate) deadline: f64,
}

/// Number of components of each field a participant sends or receives, by name. Filled from its
/// description and its configuration.
#[derive(Clone, Debug, Default)]
pub(crate) struct Components(BTreeMap<String, usize>);

impl Components {
    /// Components of the standard fields and of the participant's own fields.
    pub(crate) fn described(description: &Description) -> Self {
        Self::of(field::TABLE.iter().map(FieldSpec::kind).chain(description.fields.clone()))
    }

    /// Adds fields described by other participants and received by this one, from the body of
    /// `Configure`. An invalid body is left for the participant to reject.
    pub(crate) fn configured(&mut self, body: &[u8]) {
        if let Ok(configuration) = serde_json::from_slice::<Configuration>(body) {
            self.0.extend(Self::of(configuration.inputs.into_iter().map(|input| input.field)).0);
        }
    }

    fn of(kinds: impl Iterator<Item = FieldKind>) -> Self {
        Self(kinds.map(|kind| (kind.name, kind.components as usize)).collect())
    }

    fn values(&self, name: &str, grid: &Grid) -> usize {
        grid.points().saturating_mul(self.0.get(name).copied().unwrap_or(1))
    }
}

impl Routes {
    pub(crate) fn of(topics: &Topics, components: &Components) -> Self {
        let values = |name: &str, grid: &Grid| components.values(name, grid);
        let mut routes = Self { deadline: topics.deadline, ..Self::default() };
        for topic in &topics.outputs {
            let (service, values) = (topic.service.clone(), values(&topic.field, &topic.grid));
            routes.outward.push(Route { service, values, subscribers: topic.subscribers });
        }
        for topic in &topics.geometry {
            let (service, subscribers) = (topic.service.clone(), topic.subscribers);
            routes.outward.push(Route { service, values: 0, subscribers });
        }
        for topic in &topics.inputs {
            routes.add(&topic.service, values(&topic.field, &topic.grid));
        }
        for topic in &topics.inputs {
            if let Some(service) = &topic.geometry {
                routes.add(service, GEOMETRY.components as usize * topic.grid.geometry_points());
            }
        }
        routes
    }

    /// Adds an incoming topic, unless the participant itself publishes it.
    fn add(&mut self, service: &str, values: usize) {
        let known = self.inward.iter().chain(&self.outward).any(|route| route.service == service);
        if !known {
            self.inward.push(Route { service: service.to_owned(), values, subscribers: 1 });
        }
    }

    /// Returns the topics as opened at the server. Each has one subscriber, the relay, and the
    /// participant itself if it reads its own output.
    pub(crate) fn at_server(topics: &Topics) -> Topics {
        let mut there = topics.clone();
        let own = |service: &str| topics.inputs.iter().any(|input| input.service == service);
        for topic in &mut there.outputs {
            topic.subscribers = 1 + usize::from(own(&topic.service));
        }
        for topic in &mut there.geometry {
            topic.subscribers = 1;
        }
        there
    }

    /// Returns the maximum length of a message with a sample [byte].
    pub(crate) fn longest(&self) -> usize {
        let all = self.inward.iter().chain(&self.outward);
        let most = all.map(|route| route.values).max().unwrap_or(0);
        SHORT.saturating_add(most.saturating_mul(GROWTH * size_of::<f64>()))
    }
}

/// Error of a sample received over the network.
#[derive(Debug, thiserror::Error)]
pub(crate) enum SampleError {
    #[error("a sample arrived for the unknown topic {0}")]
    NoTopic(u16),
    #[error("a sample of {found} values arrived for `{service}`; at most {most} are allowed")]
    TooLong { service: String, found: u64, most: usize },
    #[error(transparent)]
    Unpackable(#[from] Unpackable),
    #[error(transparent)]
    Transport(#[from] TransportError),
}

/// Ports of samples that leave this run for the other end.
pub(crate) struct Readers(Vec<FieldReader>);

impl Readers {
    pub(crate) fn open(endpoint: &Endpoint, routes: &[Route]) -> Result<Self, TransportError> {
        let open = |route: &Route| endpoint.field_reader(&route.service);
        routes.iter().map(open).collect::<Result<_, _>>().map(Self)
    }

    /// Sends all samples that have arrived.
    pub(crate) fn forward(&self, sending: &Sending, wanted: Packing) -> Result<(), ForwardError> {
        for (topic, reader) in self.0.iter().enumerate() {
            while let Some(sample) = reader.receive()? {
                let (packing, bytes) = pack(sample.values(), wanted);
                sending.send(&Frame::Sample {
                    topic: topic as u16,
                    header: *sample.header(),
                    packing,
                    values: sample.values().len() as u64,
                    bytes: &bytes,
                })?;
            }
        }
        Ok(())
    }
}

/// Error of passing samples on.
#[derive(Debug, thiserror::Error)]
pub(crate) enum ForwardError {
    #[error(transparent)]
    Transport(#[from] TransportError),
    #[error(transparent)]
    Link(#[from] Fault),
}

/// Ports of samples that arrive from the other end.
pub(crate) struct Writers(Vec<(Route, FieldWriter)>);

impl Writers {
    /// Opens the ports, for the announced number of subscribers, or for a single one if `one` is
    /// true.
    pub(crate) fn open(
        endpoint: &Endpoint,
        routes: &[Route],
        one: bool,
    ) -> Result<Self, TransportError> {
        let open = |route: &Route| {
            let subscribers = if one { 1 } else { route.subscribers };
            let writer = endpoint.field_writer(&route.service, route.values, subscribers)?;
            Ok((route.clone(), writer))
        };
        routes.iter().map(open).collect::<Result<_, _>>().map(Self)
    }

    pub(crate) fn wait_for_subscribers(&self, until: Instant) -> Result<(), TransportError> {
        self.0.iter().try_for_each(|(_, writer)| writer.wait_for_subscribers(until))
    }

    /// Publishes a sample. Checks the number of values before allocating memory.
    pub(crate) fn publish(
        &self,
        topic: u16,
        header: &FieldHeader,
        packing: Packing,
        values: u64,
        bytes: &[u8],
    ) -> Result<(), SampleError> {
        let (route, writer) = self.0.get(usize::from(topic)).ok_or(SampleError::NoTopic(topic))?;
        let most = (route.values.saturating_mul(GROWTH)).max(SHORT / size_of::<f64>());
        let count = usize::try_from(values).ok().filter(|count| *count <= most);
        let count = count.ok_or_else(|| {
            let service = route.service.clone();
            SampleError::TooLong { service, found: values, most }
        })?;
        let mut loan = writer.loan(count)?;
        unpack(packing, bytes, loan.values())?;
        Ok(writer.publish(loan, header)?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use contract::configuration::{Input, Mode};
    use contract::grid::Structured;
    use contract::message::{GeometryTopic, Topic};
    use contract::params::Params;

    fn topic(field: &str, service: &str, geometry: Option<&str>) -> Topic {
        let grid = Grid::structured("g", Structured::contact_plane(0.0, 0.0, 1.0, 1.0, 10, 10));
        let (field, service) = (field.to_owned(), service.to_owned());
        Topic { field, service, grid, subscribers: 3, geometry: geometry.map(str::to_owned) }
    }

    #[test]
    fn both_ends_number_the_same_topics() {
        let topics = Topics {
            inputs: vec![
                topic("friction_power", "field/mech/friction_power", Some("geometry/mech/g")),
                topic("pressure", "field/mech/pressure", Some("geometry/mech/g")),
                topic("x", "field/thermal/x", Some("geometry/thermal/g")),
            ],
            outputs: vec![topic("x", "field/thermal/x", None)],
            geometry: vec![GeometryTopic {
                grid: "g".to_owned(),
                service: "geometry/thermal/g".to_owned(),
                subscribers: 2,
            }],
            ..Topics::default()
        };
        let components = Components::of(std::iter::empty());
        let routes = Routes::of(&topics, &components);
        let names = |routes: &[Route]| -> Vec<String> {
            routes.iter().map(|route| route.service.clone()).collect()
        };
        let inward = ["field/mech/friction_power", "field/mech/pressure", "geometry/mech/g"];
        assert_eq!(names(&routes.inward), inward);
        assert_eq!(names(&routes.outward), ["field/thermal/x", "geometry/thermal/g"]);
        let there = Routes::at_server(&topics);
        assert_eq!((there.outputs[0].subscribers, there.geometry[0].subscribers), (2, 1));
        assert_eq!(names(&Routes::of(&there, &components).inward), inward);
        assert_eq!(routes.longest(), SHORT + 100 * GROWTH * 8);
    }

    /// Fields described by the participant or by their producer have the described number of
    /// components.
    #[test]
    fn vectors_that_are_in_no_table_have_all_their_components() {
        let kind = |name: &str| FieldKind {
            name: name.to_owned(),
            components: 3,
            ..FieldSpec::kind(field::find("pressure").unwrap())
        };
        let mut components = Components::of([kind("own")].into_iter());
        let input = Input {
            field: kind("other"),
            producer: "left".to_owned(),
            grid: None,
            moves: false,
            peak: None,
            extent: None,
        };
        let configuration = Configuration {
            role: "right".to_owned(),
            model: "linear".to_owned(),
            mode: Mode::Transient,
            windows: None,
            case: Params::default(),
            histories: None,
            inputs: vec![input],
            outputs: vec!["own".to_owned()],
            observed: Vec::new(),
            threads: 1,
        };
        components.configured(&serde_json::to_vec(&configuration).unwrap());
        let topics = Topics {
            inputs: vec![topic("other", "field/left/other", None)],
            outputs: vec![topic("own", "field/right/own", None)],
            ..Topics::default()
        };
        let routes = Routes::of(&topics, &components);
        assert_eq!((routes.inward[0].values, routes.outward[0].values), (300, 300));
    }
}
