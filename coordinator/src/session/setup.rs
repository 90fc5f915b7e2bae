//! From a plan to a session that is ready for its first window.

use super::feedback::Feedback;
use super::mapped::Mapped;
use super::memory::SharedMemory;
use super::outlet::Outlet;
use super::patience::Patience;
use super::tap::Consumer;
use super::topics::{Subscription, consumer, is_informed, readers, subscription};
use super::{
    COORDINATOR, Context, Deadlines, Link, Phase, Session, SolveRecord, Tap, Waiting, open_files,
};
use crate::error::{Failure, RunError};
use crate::plan::{Field, Participant, Plan};
use crate::programs::Program;
use crate::record::Recorder;
use crate::supervise::{Launch, Supervisor};
use proto::configuration::{Configuration, Layout};
use proto::description::Description;
use proto::grid::Grid;
use proto::message::{Command, CommandKind, Topic, Topics};
use proto::model::Step;
use proto::run_dir::RunDir;
use proto::transport::{Beat, Endpoint, TransportError};
use std::sync::Arc;

pub(super) fn start(plan: &Plan, recorder: Option<Arc<Recorder>>) -> Result<Session, RunError> {
    // Before anything exists, with what the participants expect; once more with what they say.
    open_files::provide(plan.participants.len(), topics_of(plan), recorder.is_some())?;
    let memory = SharedMemory::check(plan, |index| plan.participants[index].estimate.as_ref())?;
    let seat = |p: &Participant| Seat {
        role: p.role.clone(),
        program: p.program.clone(),
        attach: p.attach,
    };
    let seats: Vec<Seat> = plan.participants.iter().map(seat).collect();
    let mut session = Session::open(&seats, plan.deadlines, recorder)?;
    session.memory = memory;
    session.wait_for_joining()?;
    session.phase = Phase::Configuring;
    for (index, participant) in plan.participants.iter().enumerate() {
        session.check_description(index, participant)?;
    }
    let layouts = session.configure(plan)?;
    session.check_informed(plan, &layouts)?;
    session.memory = SharedMemory::check(plan, |index| layouts.get(index))?;
    session.phase = Phase::Connecting;
    session.connect(plan, &layouts)?;
    session.phase = Phase::Initialising;
    session.initialise(&layouts)?;
    tracing::info!("every participant is ready");
    Ok(session)
}

/// The most topics that a plan can lead to: every field, once more what the coordinator sends of it,
/// and the geometry of every grid.
fn topics_of(plan: &Plan) -> usize {
    let sent_on = |field: &Field| 1 + usize::from(!field.fed_back.is_empty());
    let grids = plan.participants.iter().filter_map(|p| p.estimate.as_ref());
    plan.fields.iter().map(sent_on).sum::<usize>() + grids.map(|l| l.moving.len()).sum::<usize>()
}

/// A place in a run, and the participant that is to take it.
#[derive(Clone, Debug)]
pub(crate) struct Seat {
    pub(crate) role: String,
    pub(crate) program: Program,
    /// Started by hand, and waited for.
    pub(crate) attach: bool,
}

impl Session {
    /// Makes a run and starts its participants; nobody has joined yet.
    pub(crate) fn open(
        seats: &[Seat],
        deadlines: Deadlines,
        recorder: Option<Arc<Recorder>>,
    ) -> Result<Self, RunError> {
        let roles: Vec<String> = seats.iter().map(|seat| seat.role.clone()).collect();
        let run = RunDir::create(&roles).map_err(|error| {
            machine(
                "the machine",
                "while preparing the run",
                &error,
                "COSIM_RUNTIME_DIR may name another folder of yours in memory",
            )
        })?;
        let (prefix, folder) = (&run.info().prefix, run.info().folder.display());
        tracing::info!(prefix, %folder, "run created");
        let opened = |error: &TransportError| {
            machine("shared memory", "while preparing the run", error, "check /dev/shm")
        };
        let endpoint = Endpoint::open(run.info()).map_err(|e| opened(&e))?;
        let doorbell = endpoint.doorbell(COORDINATOR).map_err(|e| opened(&e))?;
        let link = |seat: &Seat| {
            let commands = endpoint.command_sender(&seat.role)?;
            let replies = endpoint.reply_receiver(&seat.role)?;
            let ringer = endpoint.ringer(&seat.role)?;
            let name = (seat.role.as_str(), seat.program.name());
            Ok(Link::new(name, seat.attach, commands, replies, ringer))
        };
        let links: Result<Vec<Link>, TransportError> = seats.iter().map(link).collect();
        let links = links.map_err(|e| opened(&e))?;
        let started = seats.iter().filter(|seat| !seat.attach);
        let launch =
            |seat: &Seat| Launch { role: seat.role.clone(), program: seat.program.clone() };
        let launches: Vec<Launch> = started.map(launch).collect();
        let supervisor =
            Supervisor::start(&launches, &run.info().folder).map_err(|(who, error)| {
                machine(&who, "while starting", &error, "check the command of this participant")
            })?;
        for seat in seats.iter().filter(|seat| seat.attach) {
            let (role, program) = (&seat.role, seat.program.command_line());
            let folder = run.info().folder.display();
            tracing::warn!("waiting for {role}: start `{program} --join {folder} --role {role}`");
        }
        Ok(Self {
            supervisor,
            recorder,
            taps: Vec::new(),
            feedback: Vec::new(),
            mapped: Vec::new(),
            moving: Vec::new(),
            memory: SharedMemory::default(),
            parts: Vec::new(),
            solved: vec![SolveRecord::default(); links.len()],
            links,
            doorbell,
            _endpoint: endpoint,
            run,
            deadlines,
            phase: Phase::Starting,
            computed_seconds: 0.0,
            bytes_exchanged: 0,
        })
    }

    /// Waits until everybody has joined.
    pub(crate) fn wait_for_joining(&mut self) -> Result<(), RunError> {
        for one in 0..self.links.len() {
            let patience = if self.links[one].is_attached() {
                self.deadlines.solve
            } else {
                self.deadlines.start
            };
            let mut waited = Patience::new();
            let Self { links, doorbell, supervisor, run, deadlines, phase, .. } = self;
            let context = Context { supervisor, run, phase: *phase, deadlines };
            let joined = doorbell.wait(
                || {
                    if links[one].is_up() {
                        return Ok(Some(()));
                    }
                    // A participant that has not joined has no heartbeat yet.
                    links[one].beat_received(Beat::Busy);
                    let waited = waited.waited();
                    if waited > patience {
                        let what =
                            format!("it did not join within {:.1} s", patience.as_secs_f64());
                        return Err(Waiting::Run(RunError::Failed(Failure {
                            who: links[one].who(),
                            when: context.phase.to_string(),
                            what,
                            fix: "raise coupling.start_deadline if it needs longer".to_owned(),
                        })));
                    }
                    context.look(links, one, waited, patience).map(|()| None)
                },
                |_, _| (),
            );
            joined.map_err(|waiting| match waiting {
                Waiting::Run(error) => error,
                Waiting::Transport(error) => self.transport_failed(one, &error),
            })?;
        }
        Ok(())
    }

    /// What joined is what was planned with.
    fn check_description(&mut self, one: usize, participant: &Participant) -> Result<(), RunError> {
        self.post(one, Command::new(CommandKind::Describe), &[], true)?;
        let message = self.await_done(one, self.deadlines.solve)?;
        let found: Description = serde_json::from_slice(message.body())
            .map_err(|e| self.misbehaved(one, format!("its description is not valid: {e}")))?;
        if found == participant.description {
            return Ok(());
        }
        let (name, version) = (found.name, found.version);
        let what =
            format!("what joined ({name} {version}) differs from what described itself before");
        if participant.attach {
            let (who, when) = (self.links[one].who(), self.phase.to_string());
            let fix = format!(
                "name the program that you start by hand as {}.command: it is asked what it is, and \
                 not started",
                participant.role
            );
            return Err(RunError::Failed(Failure { who, when, what, fix }));
        }
        Err(self.misbehaved(one, what))
    }

    /// Configures every participant along the flow of data; each receives the grids of its inputs.
    fn configure(&mut self, plan: &Plan) -> Result<Vec<Layout>, RunError> {
        let mut layouts: Vec<Layout> = Vec::with_capacity(self.links.len());
        for (one, participant) in plan.participants.iter().enumerate() {
            let mut configuration = participant.configuration.clone();
            for input in &mut configuration.inputs {
                let producer = self.links.iter().position(|l| l.role() == input.producer);
                let layout = producer.and_then(|index| layouts.get(index));
                input.grid = layout.and_then(|l| l.grid_of(&input.field.name)).cloned();
                input.peak = layout.and_then(|l| l.peaks.get(&input.field.name)).copied();
                input.moves = is_informed(plan, &layouts, input);
            }
            let body = serde_json::to_vec(&configuration).expect("a configuration is plain data");
            self.post(one, Command::new(CommandKind::Configure), &body, true)?;
            let message = self.await_done(one, self.deadlines.solve)?;
            let layout: Layout = serde_json::from_slice(message.body())
                .map_err(|e| self.misbehaved(one, format!("its layout is not valid: {e}")))?;
            drop(message);
            self.check_layout(one, &configuration, &layout)?;
            layouts.push(layout);
        }
        Ok(layouts)
    }

    fn check_layout(
        &self,
        one: usize,
        configuration: &Configuration,
        layout: &Layout,
    ) -> Result<(), RunError> {
        layout_fault(configuration, layout).map_or(Ok(()), |what| Err(self.misbehaved(one, what)))
    }

    /// No participant subscribes to a field on a moving grid unannounced, or without knowing it.
    fn check_informed(&self, plan: &Plan, layouts: &[Layout]) -> Result<(), RunError> {
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
                    let (producer, role) = (&self.links[field.producer], self.links[one].role());
                    return Err(RunError::Failed(Failure {
                        who: producer.who(),
                        when: self.phase.to_string(),
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
    fn connect(&mut self, plan: &Plan, layouts: &[Layout]) -> Result<(), RunError> {
        self.open_geometry(plan, layouts).map_err(|error| {
            machine("shared memory", "while connecting", &error, "check /dev/shm")
        })?;
        let mut topics = Vec::new();
        for field in &plan.fields {
            let topic = self.topic(plan, field, layouts);
            self.open_tap(plan, field, &topic, layouts)?;
            self.open_outlets(plan, field, &topic.grid, layouts).map_err(|error| {
                machine("shared memory", "while connecting", &error, "check /dev/shm")
            })?;
            topics.push(topic);
        }
        let (deadline, interpolation) = (self.deadlines.start.as_secs_f64(), plan.interpolation);
        for one in 0..self.links.len() {
            let pairs = || plan.fields.iter().zip(&topics);
            let outputs = pairs().filter(|(f, _)| f.producer == one).map(|(_, t)| t.clone());
            let outputs = outputs.collect();
            let consumed = pairs().filter(|(f, _)| f.consumers.contains(&one));
            let inputs = consumed.map(|(field, topic)| self.subscribed(one, field, topic, layouts));
            let inputs = inputs.collect();
            let geometry = self.geometry_topics(plan, one, layouts);
            let topics = Topics { inputs, outputs, deadline, interpolation, geometry };
            let body = serde_json::to_vec(&topics).expect("topics are plain data");
            self.post(one, Command::new(CommandKind::Connect), &body, true)?;
        }
        for one in 0..self.links.len() {
            self.await_done(one, self.deadlines.start)?;
        }
        self.wait_for_readers()?;
        if let Some(recorder) = &self.recorder {
            recorder.connect()?;
        }
        Ok(())
    }

    /// Lets everybody build its model and publish its first outputs.
    fn initialise(&mut self, layouts: &[Layout]) -> Result<(), RunError> {
        for one in 0..self.links.len() {
            self.post(one, Command::new(CommandKind::Initialise), &[], true)?;
        }
        let before = Step { iteration: 0, ..Step::STEADY };
        for (one, layout) in layouts.iter().enumerate() {
            self.await_done(one, self.deadlines.build_of(layout))?;
            self.collect(one, &before, false)?;
        }
        self.make_mappings()?;
        self.parts = self.coupling_parts();
        (0..self.taps.len()).try_for_each(|tap| self.check_finite(tap))
    }

    fn open_tap(
        &mut self,
        plan: &Plan,
        field: &Field,
        topic: &Topic,
        layouts: &[Layout],
    ) -> Result<(), RunError> {
        let reader = self._endpoint.field_reader(&topic.service).map_err(|error| {
            machine("shared memory", "while connecting", &error, "check /dev/shm")
        })?;
        let listen = |recorder: &Arc<Recorder>| recorder.listen(&self._endpoint, &topic.service);
        let recorded = self.recorder.as_ref().map(listen).transpose().map_err(|error| {
            machine("shared memory", "while connecting", &error, "check /dev/shm")
        })?;
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
        layouts: &[Layout],
    ) -> Result<(), TransportError> {
        let (kind, tap, recorder) = (&field.kind, self.taps.len() - 1, self.recorder.as_ref());
        if !field.fed_back.is_empty() {
            let iterates = readers(field, layouts, &Subscription::Iterates);
            let readers: Vec<Consumer> = iterates.map(|one| consumer(plan, field, one)).collect();
            let open = |subscribers| {
                let service = Feedback::service(&kind.name);
                Outlet::open(&self._endpoint, &service, (kind, source), subscribers, recorder)
            };
            let outlet = (!readers.is_empty()).then(|| open(readers.len())).transpose()?;
            self.feedback.push(Feedback::new(tap, readers, outlet));
        }
        for &one in &field.consumers {
            let Subscription::Mapped(grid) = subscription(field, one, layouts) else { continue };
            let service = Mapped::service(&kind.name, &plan.participants[one].role);
            let outlet = Outlet::open(&self._endpoint, &service, (kind, grid), 1, recorder)?;
            let part = field.fed_back.contains(&one).then(|| self.feedback.len() - 1);
            let moving = self.moving_grid(one, &grid.name);
            let (of, reader) = ((kind, grid, moving), consumer(plan, field, one));
            self.mapped.push(Mapped::new((tap, part), of, field.method, reader, outlet));
        }
        Ok(())
    }
}

/// What is wrong with a layout as the answer to a configuration, if anything.
pub(crate) fn layout_fault(configuration: &Configuration, layout: &Layout) -> Option<String> {
    if let Err(fault) = layout.check() {
        return Some(fault);
    }
    let mut sent = configuration.outputs.iter().chain(&configuration.observed);
    if let Some(field) = sent.find(|field| layout.grid_of(field).is_none()) {
        return Some(format!("its layout has no grid for `{field}`"));
    }
    let received = |field: &str| configuration.inputs.iter().any(|i| i.field.name == field);
    let wish = layout.inputs.iter().find(|wish| !received(&wish.field))?;
    Some(format!("it requests a grid for `{}`, which is not an input of it", wish.field))
}

fn machine(who: &str, when: &str, error: &dyn std::fmt::Display, fix: &str) -> RunError {
    RunError::Failed(Failure {
        who: who.to_owned(),
        when: when.to_owned(),
        what: error.to_string(),
        fix: fix.to_owned(),
    })
}
