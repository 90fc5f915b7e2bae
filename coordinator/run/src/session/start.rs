//! From a plan to a session that is ready for its first window: participants start and are
//! configured, and every field gets its topics.

use super::fields::{Consumer, CoupledField, FieldPublisher, FieldSubscription};
use super::geometry::MovingGrid;
use super::live::{self, LiveValues};
use super::mapping::FieldMapping;
use super::memory::SharedMemory;
use super::reports::{Figures, SolveRecord};
use super::{Recording, Session};
use crate::error::{Failure, RunError, machine_failure};
use crate::fleet::Fleet;
use crate::peers::{ParticipantSlot, Peers, Phase, volume_fault};
use crate::plan::{Field, Participant, Plan, layouts, non_matching};
use crate::progress::Progress;
use crate::record::Recorder;
use contract::configuration::{Configuration, Layout};
use contract::grid::Grid;
use contract::message::{Command, CommandKind, GeometryTopic, Topic, Topics};
use contract::step::Step;
use coupling::ParticipantIndex;
use coupling::map::{Coverage, CurrentMapping};
use proto::transport::TransportError;
use std::rc::Rc;
use std::sync::Arc;
use typed_index_collections::{TiSlice, TiVec};

/// Returns the largest number of topics that a plan can need: every field, iterates of the
/// coordinator, the geometry of every moving grid, and live values.
fn topics_of(plan: &Plan) -> usize {
    let sent_on = |field: &Field| 1 + usize::from(!field.fed_back.is_empty());
    let layouts = plan.participants.iter().filter_map(|p| p.estimate.as_ref());
    let moving = layouts.flat_map(|l| l.grids.iter().filter(|grid| l.moves(grid)));
    plan.fields.iter().map(sent_on).sum::<usize>() + moving.count() + plan.live.len()
}

impl Session {
    /// Starts the participants of a plan, or takes those that wait in a fleet, and
    /// prepares them for the first window. With a recorder, the whole exchange is recorded. Long
    /// work is shown on the screen.
    ///
    /// # Errors
    /// The machine lacks memory, files or ports; or a participant fails, refuses the case or
    /// violates the contract.
    pub fn start(
        plan: &Plan,
        fleet: &mut Fleet,
        recorder: Option<Arc<Recorder>>,
        screen: &Rc<dyn Progress>,
    ) -> Result<Self, RunError> {
        let participants = plan.participants.len();
        if fleet.open_files.provide(participants, topics_of(plan), recorder.is_some())? {
            fleet.dismiss();
        }
        let held = fleet.held_memory();
        let seat = |p: &Participant| ParticipantSlot {
            role: p.role.clone(),
            program: p.program.clone(),
            attach: p.attach,
        };
        let seats: Vec<ParticipantSlot> = plan.participants.iter().map(seat).collect();
        let stayed = fleet.take(&seats);
        let is_new = stayed.is_none();
        let peers = match stayed {
            Some(peers) => peers.for_run(plan.deadlines, recorder),
            None => Peers::start(&seats, plan.deadlines, recorder)?,
        };
        let mut session = Self::new(plan, peers);
        session.peers.show_on(screen);
        if is_new {
            session.peers.join()?;
        }
        session.peers.phase = Phase::Configuring;
        // A recording contains the descriptions.
        if is_new || session.peers.recorder().is_some() {
            for (participant, planned) in plan.participants.iter_enumerated() {
                session.check_description(participant, planned)?;
            }
        }
        let layouts = session.configure(plan)?;
        let held = if is_new { 0 } else { held };
        session.memory = match SharedMemory::check(plan, held, &layouts) {
            Ok(memory) => memory,
            Err(error) => {
                // Participants without ports may wait for another run.
                if session.reusable && fleet.stays() {
                    session.stay(fleet, held);
                }
                return Err(error);
            }
        };
        session.peers.phase = Phase::Connecting;
        session.connect(plan, &layouts)?;
        session.peers.phase = Phase::Initialising;
        session.initialise(&layouts)?;
        tracing::info!("every participant is ready");
        Ok(session)
    }

    /// Returns a session before configuration.
    fn new(plan: &Plan, peers: Peers) -> Self {
        let reusable = |p: &Participant| p.description.reusable && !p.attach;
        Self {
            _recording: Recording(peers.recorder().cloned()),
            guard: peers.process_guard(),
            reusable: plan.participants.iter().all(reusable),
            fields: TiVec::new(),
            coupled: TiVec::new(),
            measured: Vec::new(),
            mapped: TiVec::new(),
            moving: TiVec::new(),
            live: LiveValues::default(),
            memory: SharedMemory::default(),
            parts: TiVec::new(),
            solved: peers.all().iter().map(|_| SolveRecord::default()).collect(),
            figures: Figures::of(plan),
            computed_seconds: 0.0,
            unanswered: false,
            bytes_exchanged: 0,
            warnings: Vec::new(),
            peers,
        }
    }

    /// Checks that the participant that joined is the one that was planned.
    fn check_description(
        &mut self,
        participant: ParticipantIndex,
        planned: &Participant,
    ) -> Result<(), RunError> {
        let found = self.peers.describe(participant, self.peers.deadlines().solve)?;
        if found == *planned.description {
            return Ok(());
        }
        let (name, version) = (found.name, found.version);
        let what = format!(
            "the program that joined ({name} {version}) differs from the one described before"
        );
        if planned.attach {
            let (who, when) = (self.peers.all()[participant].who(), self.peers.phase.to_string());
            let fix = format!(
                "name the program that you start by hand as {}.command: it is only asked for its \
                 description, not started",
                planned.role
            );
            return Err(RunError::Failed(Failure { who, when, what, fix }));
        }
        Err(self.peers.misbehaved(participant, what))
    }

    /// Configures every participant along the flow of data, as planning has done.
    fn configure(&mut self, plan: &Plan) -> Result<TiVec<ParticipantIndex, Layout>, RunError> {
        let planned = plan.participants.iter().map(|one| one.configuration.clone());
        let mut configurations: TiVec<ParticipantIndex, Configuration> = planned.collect();
        let patience = self.peers.deadlines().solve;
        let layouts = layouts(&mut configurations, |one, configuration| {
            let layout = self.peers.configure(one, configuration, patience)?;
            match volume_fault(configuration, &layout) {
                None => Ok(Some(layout)),
                Some(fault) => Err(self.peers.misbehaved(one, fault)),
            }
        })?;
        Ok(layouts.into_iter().flatten().collect())
    }

    /// Lets every participant open its ports; no field is sent yet.
    fn connect(
        &mut self,
        plan: &Plan,
        layouts: &TiSlice<ParticipantIndex, Layout>,
    ) -> Result<(), RunError> {
        self.open_geometry(plan, layouts).map_err(|error| not_connected(&error))?;
        let mut topics = Vec::new();
        for field in &plan.fields {
            let topic = self.topic(plan, field, layouts);
            self.subscribe(plan, field, &topic, layouts)?;
            self.open_publishers(plan, field, &topic.grid, layouts)
                .map_err(|error| not_connected(&error))?;
            topics.push(topic);
        }
        self.live = LiveValues::open(plan, &self.peers).map_err(|error| not_connected(&error))?;
        self.peers.endpoint().close_unused();
        let (deadline, interpolation) =
            (self.peers.deadlines().start.as_secs_f64(), plan.interpolation);
        for participant in self.peers.all().keys() {
            let pairs = || plan.fields.iter().zip(&topics);
            let outputs =
                pairs().filter(|(f, _)| f.producer == participant).map(|(_, t)| t.clone());
            let outputs = outputs.collect();
            let consumed = pairs().filter(|(f, _)| f.consumers.contains(&participant));
            let inputs =
                consumed.map(|(field, topic)| self.subscribed(participant, field, topic, layouts));
            let inputs = inputs.chain(live::topics(plan, participant)).collect();
            let geometry = self.geometry_topics(plan, participant, layouts);
            let figures = plan.participants[participant].figures.clone();
            let topics = Topics { inputs, outputs, deadline, interpolation, geometry, figures };
            let body = serde_json::to_vec(&topics).expect("topics are plain data");
            self.peers.post(participant, Command::new(CommandKind::Connect), &body)?;
        }
        let mut pending = self.peers.all().keys().collect();
        let deadline = self.peers.deadlines().start;
        while let Some((_, answer)) = self.peers.next_reply(&mut pending, |_| deadline)? {
            answer?;
        }
        self.wait_for_readers()?;
        if let Some(recorder) = self.peers.recorder() {
            recorder.connect()?;
        }
        Ok(())
    }

    /// Lets every participant build its model, and publish the geometry of its volumes and its
    /// first outputs.
    fn initialise(&mut self, layouts: &TiSlice<ParticipantIndex, Layout>) -> Result<(), RunError> {
        for participant in self.peers.all().keys() {
            self.peers.post(participant, Command::new(CommandKind::Initialise), &[])?;
        }
        let before = Step { iteration: 0, ..Step::STEADY };
        let mut pending = self.peers.all().keys().collect();
        let deadlines = *self.peers.deadlines();
        let patience = |participant| deadlines.build_of(&layouts[participant]);
        while let Some((participant, answer)) = self.peers.next_reply(&mut pending, patience)? {
            answer?;
            self.receive_geometry(participant, &before)?;
            self.check_volumes(participant)?;
            self.collect(participant, &before, false)?;
        }
        self.keep_geometry();
        self.make_mappings()?;
        self.parts = self.coupling_parts();
        self.fields.keys().try_for_each(|field| self.check_finite(field))
    }

    /// Subscribes to a field.
    fn subscribe(
        &mut self,
        plan: &Plan,
        field: &Field,
        topic: &Topic,
        layouts: &TiSlice<ParticipantIndex, Layout>,
    ) -> Result<(), RunError> {
        let reader = self
            .peers
            .endpoint()
            .field_reader(&topic.service)
            .map_err(|error| not_connected(&error))?;
        let listen =
            |recorder: &Arc<Recorder>| recorder.listen(self.peers.endpoint(), &topic.service);
        let recorded =
            self.peers.recorder().map(listen).transpose().map_err(|error| not_connected(&error))?;
        let direct = readers(field, layouts, &FieldSource::Producer);
        self.fields.push(FieldSubscription {
            kind: field.kind.clone(),
            grid: topic.grid.clone(),
            moving: self.moving_grid(field.producer, &topic.grid.name),
            producer: field.producer,
            producer_role: plan.participants[field.producer].role.clone(),
            readers: direct
                .map(|participant| Consumer::new(plan, &field.kind.name, participant))
                .collect(),
            observed_only: field.observed_only(),
            wanted: field.wanted,
            reader,
            sample: None,
            checked: 0,
            recorded,
        });
        Ok(())
    }

    /// Opens the coordinator's own topics of the field that was subscribed last.
    fn open_publishers(
        &mut self,
        plan: &Plan,
        field: &Field,
        source: &Grid,
        layouts: &TiSlice<ParticipantIndex, Layout>,
    ) -> Result<(), TransportError> {
        let index = self.fields.last_key().expect("the field was subscribed to before");
        let (kind, recorder) = (&field.kind, self.peers.recorder());
        if !field.fed_back.is_empty() {
            let iterates = readers(field, layouts, &FieldSource::Iterates);
            let readers: Vec<Consumer> = iterates
                .map(|participant| Consumer::new(plan, &field.kind.name, participant))
                .collect();
            let open = |subscribers| {
                let service = CoupledField::service(&kind.name);
                FieldPublisher::open(
                    self.peers.endpoint(),
                    &service,
                    kind,
                    source,
                    subscribers,
                    recorder,
                )
            };
            let publisher = (!readers.is_empty()).then(|| open(readers.len())).transpose()?;
            self.coupled.push(CoupledField::new(index, readers, publisher));
        }
        self.measured.extend(plan.is_only_measured(field).then_some(index));
        for &participant in &field.consumers {
            let FieldSource::Mapped(grid) = source_of(field, participant, layouts) else {
                continue;
            };
            let service = FieldMapping::service(&kind.name, &plan.participants[participant].role);
            let publisher =
                FieldPublisher::open(self.peers.endpoint(), &service, kind, grid, 1, recorder)?;
            let part = self.coupled.last_key().filter(|_| field.fed_back.contains(&participant));
            let moving = self.moving_grid(participant, &grid.name);
            self.mapped.push(FieldMapping {
                field: index,
                part,
                reader: Consumer::new(plan, &kind.name, participant),
                integral: None,
                moving,
                grid: grid.clone(),
                mapping: CurrentMapping::new(field.method, kind.mapping),
                reported: (0, Coverage::default()),
                seen: 0,
                publisher,
            });
        }
        Ok(())
    }

    /// Subscribes to the grids whose geometry is sent.
    fn open_geometry(
        &mut self,
        plan: &Plan,
        layouts: &TiSlice<ParticipantIndex, Layout>,
    ) -> Result<(), TransportError> {
        for (participant, layout) in layouts.iter_enumerated() {
            for grid in plan.travelling(participant, layout) {
                let (role, recorder) =
                    (self.peers.all()[participant].role(), self.peers.recorder());
                let endpoint = self.peers.endpoint();
                self.moving.push(MovingGrid::open(endpoint, participant, role, grid, recorder)?);
            }
        }
        Ok(())
    }

    /// Returns the geometry topics that a participant must publish. Their subscribers are the
    /// coordinator, and every participant that receives a field on the grid from its producer, or
    /// iterates of the field.
    fn geometry_topics(
        &self,
        plan: &Plan,
        participant: ParticipantIndex,
        layouts: &TiSlice<ParticipantIndex, Layout>,
    ) -> Vec<GeometryTopic> {
        let topic = |moving: &MovingGrid| {
            let name = &moving.grid.name;
            let on_it = |field: &&Field| {
                let grid = layouts[participant].grid_of(&field.kind.name);
                field.producer == participant && grid.is_some_and(|grid| grid.name == *name)
            };
            let listens = |consumer: &ParticipantIndex| {
                plan.fields.iter().filter(on_it).any(|field| {
                    let maps =
                        || matches!(source_of(field, *consumer, layouts), FieldSource::Mapped(_));
                    field.consumers.contains(consumer) && !maps()
                })
            };
            let listeners = self.peers.all().keys().filter(listens).count();
            let service = MovingGrid::service(self.peers.all()[participant].role(), name);
            let subscribers = listeners + 1 + usize::from(self.peers.recorder().is_some());
            GeometryTopic { grid: name.clone(), service, subscribers }
        };
        self.moving.iter().filter(|moving| moving.participant == participant).map(topic).collect()
    }

    /// Returns the service of a grid's geometry, if the grid may move.
    fn geometry_service(&self, participant: ParticipantIndex, grid: &Grid) -> Option<String> {
        let moves = self.moving_grid(participant, &grid.name);
        moves.map(|_| MovingGrid::service(self.peers.all()[participant].role(), &grid.name))
    }

    /// Returns the topic on which the producer sends a field.
    fn topic(
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
            // Subscribers: direct consumers, the coordinator, and the recorder.
            subscribers: readers(field, layouts, &FieldSource::Producer).count()
                + 1
                + usize::from(self.peers.recorder().is_some()),
            geometry: self.geometry_service(field.producer, grid),
        }
    }

    /// Returns the topic on which a consumer receives a field, given the producer's topic.
    fn subscribed(
        &self,
        participant: ParticipantIndex,
        field: &Field,
        topic: &Topic,
        layouts: &TiSlice<ParticipantIndex, Layout>,
    ) -> Topic {
        let name = &topic.field;
        match source_of(field, participant, layouts) {
            FieldSource::Producer => topic.clone(),
            FieldSource::Iterates => Topic {
                service: CoupledField::service(name),
                subscribers: readers(field, layouts, &FieldSource::Iterates).count(),
                ..topic.clone()
            },
            FieldSource::Mapped(grid) => Topic {
                field: name.clone(),
                service: FieldMapping::service(name, self.peers.all()[participant].role()),
                grid: grid.clone(),
                subscribers: 1,
                geometry: self.geometry_service(participant, grid),
            },
        }
    }
}

/// Sender from which a consumer receives a field.
#[derive(Debug, PartialEq)]
enum FieldSource<'a> {
    Producer,
    /// The coordinator, on the producer's grid.
    Iterates,
    /// The coordinator, on the grid that the consumer wants; the values may be iterates as well.
    Mapped(&'a Grid),
}

/// Returns the sender from which a consumer receives a field.
fn source_of<'a>(
    field: &Field,
    participant: ParticipantIndex,
    layouts: &'a TiSlice<ParticipantIndex, Layout>,
) -> FieldSource<'a> {
    match non_matching(field, participant, |index| layouts.get(index)) {
        Some([_, wanted]) => FieldSource::Mapped(wanted),
        None if field.fed_back.contains(&participant) => FieldSource::Iterates,
        None => FieldSource::Producer,
    }
}

/// Returns the consumers that receive a field from this sender.
fn readers<'a>(
    field: &'a Field,
    layouts: &'a TiSlice<ParticipantIndex, Layout>,
    source: &'a FieldSource<'a>,
) -> impl Iterator<Item = ParticipantIndex> + 'a {
    field
        .consumers
        .iter()
        .copied()
        .filter(move |&participant| source_of(field, participant, layouts) == *source)
}

fn not_connected(error: &dyn std::fmt::Display) -> RunError {
    machine_failure("shared memory", "while connecting", error, "check /dev/shm")
}
