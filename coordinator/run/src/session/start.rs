//! From a plan to a session that is ready for its first window.

use super::feedback::Feedback;
use super::figures::Figures;
use super::layout::layout_fault;
use super::live::{self, LiveValues};
use super::mapped::Mapped;
use super::memory::SharedMemory;
use super::open_files;
use super::outlet::Outlet;
use super::solved::SolveRecord;
use super::subscription::{Subscription, consumer, is_informed, readers, subscription};
use super::tap::{Consumer, Tap};
use super::{Recording, Session};
use crate::crew;
use crate::error::{Failure, RunError, machine_failure};
use crate::peers::{COORDINATOR, Peers, Phase, Seat};
use crate::plan::{Field, Participant, Plan};
use crate::progress::Progress;
use crate::record::Recorder;
use contract::configuration::{Configuration, Layout};
use contract::description::Description;
use contract::grid::Grid;
use contract::message::{Command, CommandKind, Topic, Topics};
use contract::step::Step;
use coupling::ParticipantIndex;
use proto::transport::TransportError;
use std::rc::Rc;
use std::sync::Arc;
use typed_index_collections::{TiSlice, TiVec};

/// The most topics that a plan can lead to: every field, once more what the coordinator sends of it,
/// the geometry of every grid, and live values.
fn topics_of(plan: &Plan) -> usize {
    let sent_on = |field: &Field| 1 + usize::from(!field.fed_back.is_empty());
    let layouts = plan.participants.iter().filter_map(|p| p.estimate.as_ref());
    let moving = layouts.flat_map(|l| l.grids.iter().filter(|grid| l.moves(grid)));
    plan.fields.iter().map(sent_on).sum::<usize>() + moving.count() + plan.live.len()
}

impl Session {
    /// Starts the participants of a plan, or takes those that have stayed ([`crate::crew`]), and brings
    /// them to the first window. With a recorder, everything that is exchanged is recorded. Long work is
    /// shown on the screen.
    ///
    /// # Errors
    /// The machine; a participant that fails, refuses the case or violates the contract.
    pub fn start(
        plan: &Plan,
        recorder: Option<Arc<Recorder>>,
        screen: &Rc<dyn Progress>,
    ) -> Result<Self, RunError> {
        // Before anything exists, with what the participants expect; once more with what they say.
        let participants = plan.participants.len();
        if open_files::provide(participants, topics_of(plan), recorder.is_some())? {
            crew::leave();
        }
        let held = crew::held_memory();
        let estimate = |one: ParticipantIndex| plan.participants[one].estimate.as_ref();
        let memory = SharedMemory::check(plan, held, estimate)?;
        let seat = |p: &Participant| Seat {
            role: p.role.clone(),
            program: p.program.clone(),
            attach: p.attach,
        };
        let seats: Vec<Seat> = plan.participants.iter().map(seat).collect();
        let stayed = crew::take(&seats);
        let is_new = stayed.is_none();
        let peers = match stayed {
            Some(peers) => peers.for_run(plan.deadlines, recorder),
            None => Peers::start(&seats, plan.deadlines, recorder)?,
        };
        let mut session = Self::of(plan, peers, memory);
        session.peers.show_on(screen);
        if is_new {
            session.peers.join()?;
        }
        session.peers.phase = Phase::Configuring;
        // A recording has what they say of themselves.
        if is_new || session.peers.recorder().is_some() {
            for (index, participant) in plan.participants.iter_enumerated() {
                session.check_description(index, participant)?;
            }
        }
        let layouts = session.configure(plan)?;
        session.check_informed(plan, &layouts)?;
        let held = if is_new { 0 } else { held };
        session.memory = SharedMemory::check(plan, held, |index| layouts.get(index))?;
        session.peers.phase = Phase::Connecting;
        session.connect(plan, &layouts)?;
        session.peers.phase = Phase::Initialising;
        session.initialise(&layouts)?;
        tracing::info!("every participant is ready");
        Ok(session)
    }

    fn of(plan: &Plan, peers: Peers, memory: SharedMemory) -> Self {
        let reusable = |p: &Participant| p.description.reusable && !p.attach;
        Self {
            _recording: Recording(peers.recorder().cloned()),
            guard: peers.end_first(),
            reusable: plan.participants.iter().all(reusable),
            taps: TiVec::new(),
            feedback: TiVec::new(),
            mapped: TiVec::new(),
            moving: TiVec::new(),
            live: LiveValues::default(),
            memory,
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

    /// What joined is what was planned with.
    fn check_description(
        &mut self,
        one: ParticipantIndex,
        participant: &Participant,
    ) -> Result<(), RunError> {
        self.peers.post(one, Command::new(CommandKind::Describe), &[], true)?;
        let message = self.peers.done(one, self.peers.deadlines().solve)?;
        let found: Description = serde_json::from_slice(message.body()).map_err(|e| {
            self.peers.misbehaved(one, format!("its description is not valid: {e}"))
        })?;
        if found == participant.description {
            return Ok(());
        }
        let (name, version) = (found.name, found.version);
        let what =
            format!("what joined ({name} {version}) differs from what described itself before");
        if participant.attach {
            let (who, when) = (self.peers.all()[one].who(), self.peers.phase.to_string());
            let fix = format!(
                "name the program that you start by hand as {}.command: it is asked what it is, and \
                 not started",
                participant.role
            );
            return Err(RunError::Failed(Failure { who, when, what, fix }));
        }
        Err(self.peers.misbehaved(one, what))
    }

    /// Configures every participant along the flow of data; each receives the grids of its inputs.
    fn configure(&mut self, plan: &Plan) -> Result<TiVec<ParticipantIndex, Layout>, RunError> {
        let mut layouts: TiVec<ParticipantIndex, Layout> =
            TiVec::with_capacity(self.peers.all().len());
        for (one, participant) in plan.participants.iter_enumerated() {
            let mut configuration = participant.configuration.clone();
            for input in configuration.inputs.iter_mut().filter(|i| i.producer != COORDINATOR) {
                let producer = self.peers.all().position(|l| l.role() == input.producer);
                let layout = producer.and_then(|index| layouts.get(index));
                input.grid = layout.and_then(|l| l.grid_of(&input.field.name)).cloned();
                input.peak = layout.and_then(|l| l.peaks.get(&input.field.name)).copied();
                input.moves = is_informed(plan, &layouts, input);
            }
            let body = serde_json::to_vec(&configuration).expect("a configuration is plain data");
            self.peers.post(one, Command::new(CommandKind::Configure), &body, true)?;
            let message = self.peers.done(one, self.peers.deadlines().solve)?;
            let layout: Layout = serde_json::from_slice(message.body())
                .map_err(|e| self.peers.misbehaved(one, format!("its layout is not valid: {e}")))?;
            drop(message);
            self.check_layout(one, &configuration, &layout)?;
            layouts.push(layout);
        }
        Ok(layouts)
    }

    fn check_layout(
        &self,
        one: ParticipantIndex,
        configuration: &Configuration,
        layout: &Layout,
    ) -> Result<(), RunError> {
        layout_fault(configuration, layout)
            .map_or(Ok(()), |what| Err(self.peers.misbehaved(one, what)))
    }

    /// No participant subscribes to a field on a moving grid unannounced, or without knowing it.
    fn check_informed(
        &self,
        plan: &Plan,
        layouts: &TiSlice<ParticipantIndex, Layout>,
    ) -> Result<(), RunError> {
        for field in &plan.fields {
            let (producer, name) = (&layouts[field.producer], &field.kind.name);
            let grid = producer.grid_of(name).expect("layout is checked");
            for &one in field.consumers.iter().filter(|_| producer.moves(grid)) {
                let inputs = &plan.participants[one].configuration.inputs;
                let input = inputs.iter().find(|input| input.field.name == *name);
                let informed = input.is_some_and(|input| is_informed(plan, &layouts[..one], input));
                if !informed
                    && !matches!(subscription(field, one, layouts), Subscription::Mapped(_))
                {
                    let (producer, role) =
                        (&self.peers.all()[field.producer], self.peers.all()[one].role());
                    return Err(RunError::Failed(Failure {
                        who: producer.who(),
                        when: self.peers.phase.to_string(),
                        what: format!(
                            "its grid `{}` may move, of which {role}, which subscribes to `{name}` \
                             on it, could not be informed",
                            grid.name
                        ),
                        fix: format!(
                            "let it announce that in its estimate, or let {role} request `{name}` \
                             on a grid of its own"
                        ),
                    }));
                }
            }
        }
        Ok(())
    }

    /// Lets everybody open its ports; nothing is sent yet.
    fn connect(
        &mut self,
        plan: &Plan,
        layouts: &TiSlice<ParticipantIndex, Layout>,
    ) -> Result<(), RunError> {
        self.open_geometry(plan, layouts).map_err(|error| not_connected(&error))?;
        let mut topics = Vec::new();
        for field in &plan.fields {
            let topic = self.topic(plan, field, layouts);
            self.open_tap(plan, field, &topic, layouts)?;
            self.open_outlets(plan, field, &topic.grid, layouts)
                .map_err(|error| not_connected(&error))?;
            topics.push(topic);
        }
        self.live = LiveValues::open(plan, &self.peers).map_err(|error| not_connected(&error))?;
        self.peers.endpoint().close_unused();
        let (deadline, interpolation) =
            (self.peers.deadlines().start.as_secs_f64(), plan.interpolation);
        for one in self.peers.all().keys() {
            let pairs = || plan.fields.iter().zip(&topics);
            let outputs = pairs().filter(|(f, _)| f.producer == one).map(|(_, t)| t.clone());
            let outputs = outputs.collect();
            let consumed = pairs().filter(|(f, _)| f.consumers.contains(&one));
            let inputs = consumed.map(|(field, topic)| self.subscribed(one, field, topic, layouts));
            let inputs = inputs.chain(live::topics(plan, one)).collect();
            let geometry = self.geometry_topics(plan, one, layouts);
            let figures = plan.participants[one].figures.clone();
            let topics = Topics { inputs, outputs, deadline, interpolation, geometry, figures };
            let body = serde_json::to_vec(&topics).expect("topics are plain data");
            self.peers.post(one, Command::new(CommandKind::Connect), &body, true)?;
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

    /// Lets everybody build its model, publish the geometry of its volumes, and its first outputs.
    fn initialise(&mut self, layouts: &TiSlice<ParticipantIndex, Layout>) -> Result<(), RunError> {
        for one in self.peers.all().keys() {
            self.peers.post(one, Command::new(CommandKind::Initialise), &[], true)?;
        }
        let before = Step { iteration: 0, ..Step::STEADY };
        let mut pending = self.peers.all().keys().collect();
        let deadlines = *self.peers.deadlines();
        let patience = |one| deadlines.build_of(&layouts[one]);
        while let Some((one, answer)) = self.peers.next_reply(&mut pending, patience)? {
            answer?;
            self.receive_geometry(one, &before)?;
            self.check_volumes(one)?;
            self.collect(one, &before, false)?;
        }
        self.keep_geometry();
        self.make_mappings()?;
        self.parts = self.coupling_parts();
        self.taps.keys().try_for_each(|tap| self.check_finite(tap))
    }

    fn open_tap(
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
        let direct = readers(field, layouts, &Subscription::Producer);
        self.taps.push(Tap {
            kind: field.kind.clone(),
            grid: topic.grid.clone(),
            moving: self.moving_grid(field.producer, &topic.grid.name),
            producer: field.producer,
            producer_role: plan.participants[field.producer].role.clone(),
            readers: direct.map(|one| consumer(plan, field, one)).collect(),
            observed_only: field.observed_only(),
            wanted: field.wanted,
            reader,
            sample: None,
            checked: 0,
            recorded,
        });
        Ok(())
    }

    /// The coordinator's own topics of the field whose tap was opened last.
    fn open_outlets(
        &mut self,
        plan: &Plan,
        field: &Field,
        source: &Grid,
        layouts: &TiSlice<ParticipantIndex, Layout>,
    ) -> Result<(), TransportError> {
        let tap = self.taps.last_key().expect("the tap was opened before");
        let (kind, recorder) = (&field.kind, self.peers.recorder());
        if !field.fed_back.is_empty() {
            let iterates = readers(field, layouts, &Subscription::Iterates);
            let readers: Vec<Consumer> = iterates.map(|one| consumer(plan, field, one)).collect();
            let open = |subscribers| {
                let service = Feedback::service(&kind.name);
                Outlet::open(self.peers.endpoint(), &service, (kind, source), subscribers, recorder)
            };
            let outlet = (!readers.is_empty()).then(|| open(readers.len())).transpose()?;
            self.feedback.push(Feedback::new(tap, readers, outlet));
        }
        for &one in &field.consumers {
            let Subscription::Mapped(grid) = subscription(field, one, layouts) else { continue };
            let service = Mapped::service(&kind.name, &plan.participants[one].role);
            let outlet = Outlet::open(self.peers.endpoint(), &service, (kind, grid), 1, recorder)?;
            let part = self.feedback.last_key().filter(|_| field.fed_back.contains(&one));
            let moving = self.moving_grid(one, &grid.name);
            let (of, reader) = ((kind, grid, moving), consumer(plan, field, one));
            self.mapped.push(Mapped::new((tap, part), of, field.method, reader, outlet));
        }
        Ok(())
    }
}

fn not_connected(error: &dyn std::fmt::Display) -> RunError {
    machine_failure("shared memory", "while connecting", error, "check /dev/shm")
}
