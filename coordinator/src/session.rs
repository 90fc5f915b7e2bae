//! A run in progress: the conversation with its participants.
//!
//! [`Session::start`] brings everybody to the point where the first window can be solved;
//! [`Session::solve`], [`Session::accept`] and [`Session::finish`] do what they say. Every wait
//! notices within [`Doorbell::NAP`] that a participant has ended or that the user wants to stop,
//! and has a deadline. Dropping a session, at any point, ends all processes and removes everything
//! that the run has left on the machine.

mod audit;
mod feedback;
mod geometry;
pub(crate) mod link;
mod mapped;
mod memory;
mod open_files;
pub(crate) mod outlet;
pub(crate) mod patience;
mod setup;
mod state;
mod tap;
mod topics;

pub use audit::{HeatBalance, Receipt};
pub(crate) use memory::room_for;
pub(crate) use setup::{Seat, layout_fault};
pub use tap::Tap;

use crate::couple::{Exchange, Part};
use crate::error::{Failure, RunError};
use crate::plan::Plan;
use crate::record::Recorder;
use crate::signals;
use crate::supervise::{Exit, Supervisor};
use feedback::Feedback;
use geometry::MovingGrid;
use link::Link;
use mapped::Mapped;
use memory::SharedMemory;
use patience::Patience;
use proto::configuration::Layout;
use proto::message::{Command, CommandKind, Finished, OBSERVE, Reply, Status};
use proto::model::Step;
use proto::run_dir::RunDir;
use proto::transport::{Doorbell, Endpoint, Message, TransportError};
use std::os::unix::process::ExitStatusExt;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// The name under which the coordinator itself sends fields; no role can have it.
pub(crate) const COORDINATOR: &str = "coordinator";

/// How long a participant may take to end after its last word.
const LEAVE: Duration = Duration::from_secs(2);

/// How long every kind of wait may last.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Deadlines {
    /// From starting a participant to its joining the run.
    pub start: Duration,
    /// Building a model.
    pub build: Duration,
    /// One command.
    pub solve: Duration,
    /// From one heartbeat to the next.
    pub heartbeat: Duration,
}

impl Deadlines {
    /// How much longer than expected building a model may take.
    const BUILD_MARGIN: f64 = 10.0;

    /// For building the model of this layout: longer where the participant expects so.
    fn build_of(&self, layout: &Layout) -> Duration {
        let expected = Self::BUILD_MARGIN * layout.build_seconds;
        Duration::try_from_secs_f64(expected).map_or(self.build, |margin| margin.max(self.build))
    }
}

/// Which participants publish their observed fields when a window is accepted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Observed {
    /// All of them.
    Everybody,
    /// Those of which no other participant consumes anything: they publish nothing else.
    Unconsumed,
    /// None.
    Nobody,
}

/// What is going on, for messages.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Phase {
    Starting,
    Configuring,
    Connecting,
    Initialising,
    Solving(Step),
    Accepting(Step),
    Saving(Step),
    Restoring(Step),
    Finishing,
}

impl std::fmt::Display for Phase {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Starting => f.write_str("while starting"),
            Self::Configuring => f.write_str("while being configured"),
            Self::Connecting => f.write_str("while connecting"),
            Self::Initialising => f.write_str("while building its model"),
            Self::Solving(s) => write!(f, "in window {}, iteration {}", s.window, s.iteration),
            Self::Accepting(s) => write!(f, "while accepting window {}", s.window),
            Self::Saving(s) => write!(f, "while saving its state after window {}", s.window),
            Self::Restoring(s) => write!(f, "while restoring its state after window {}", s.window),
            Self::Finishing => f.write_str("while finishing"),
        }
    }
}

/// What one participant reported of its last solve.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SolveRecord {
    /// Seconds in the model.
    pub model_seconds: f64,
    /// Work in the model's own measure.
    pub work: u64,
    /// Substeps.
    pub substeps: u32,
    /// Iterations of the inner solver.
    pub inner_iterations: u32,
    /// Power in the conservative inputs that it was assigned [W].
    pub heat_sent: Option<f64>,
    /// Mean power received through conservative inputs, as it reports [W].
    pub heat_received: Option<f64>,
    /// Longest window that it would take from the start of this one [s].
    pub wanted_window: Option<f64>,
}

/// A run in progress.
// Fields drop in this order: processes end first, ports close next, the run's folder goes last.
#[derive(Debug)]
pub struct Session {
    supervisor: Supervisor,
    recorder: Option<Arc<Recorder>>,
    taps: Vec<Tap>,
    feedback: Vec<Feedback>,
    mapped: Vec<Mapped>,
    moving: Vec<MovingGrid>,
    memory: SharedMemory,
    /// The fields of `feedback` as parts of the coupling vector.
    parts: Vec<Part>,
    links: Vec<Link>,
    doorbell: Doorbell,
    _endpoint: Endpoint,
    run: RunDir,
    deadlines: Deadlines,
    phase: Phase,
    solved: Vec<SolveRecord>,
    computed_seconds: f64,
    bytes_exchanged: u64,
}

impl Session {
    /// Starts the participants of a plan and brings them to the first window. With a recorder,
    /// everything that is exchanged is recorded.
    pub fn start(plan: &Plan, recorder: Option<Arc<Recorder>>) -> Result<Self, RunError> {
        setup::start(plan, recorder)
    }

    /// What the command now under way is called in messages.
    pub(crate) fn about(&mut self, command: &Command) {
        let step = command.step();
        self.phase = match CommandKind::from_number(command.kind) {
            Some(CommandKind::Describe) | None => Phase::Starting,
            Some(CommandKind::Configure) => Phase::Configuring,
            Some(CommandKind::Connect) => Phase::Connecting,
            Some(CommandKind::Initialise) => Phase::Initialising,
            Some(CommandKind::Solve) => Phase::Solving(step),
            Some(CommandKind::Accept) => Phase::Accepting(step),
            Some(CommandKind::Save) => Phase::Saving(step),
            Some(CommandKind::Restore) => Phase::Restoring(step),
            Some(CommandKind::Finish) => Phase::Finishing,
        };
    }

    /// The run's folder, which goes with it.
    pub(crate) fn folder(&self) -> &std::path::Path {
        &self.run.info().folder
    }

    /// The services of the run.
    pub(crate) fn endpoint(&self) -> &Endpoint {
        &self._endpoint
    }

    /// Limits of the waits.
    pub(crate) fn deadlines(&self) -> &Deadlines {
        &self.deadlines
    }

    /// Gives the participants that have been asked to finish the time to do so.
    pub(crate) fn wait_for_exits(&self) {
        if !self.supervisor.wait_for_exits(LEAVE) {
            tracing::warn!("a participant did not leave after Finish and is ended");
        }
    }

    /// Every field of the run with its newest sample.
    #[must_use]
    pub fn taps(&self) -> &[Tap] {
        &self.taps
    }

    /// What each participant reported of its last solve, in the plan's order.
    #[must_use]
    pub fn solved(&self) -> &[SolveRecord] {
        &self.solved
    }

    /// The shortest window that a participant wants from the start of the last one [s].
    #[must_use]
    pub fn wanted_window(&self) -> Option<f64> {
        self.solved.iter().filter_map(|record| record.wanted_window).reduce(f64::min)
    }

    /// What the participants sent last to each other, field by field.
    pub fn exchanged(&self) -> impl Iterator<Item = &[f64]> + Clone {
        self.taps.iter().filter(|tap| !tap.observed_only).filter_map(Tap::values)
    }

    /// Bytes of field values exchanged so far.
    #[must_use]
    pub fn bytes_exchanged(&self) -> u64 {
        self.bytes_exchanged
    }

    /// Seconds so far in which some model computed; models that compute at the same time count
    /// once, with the longest.
    #[must_use]
    pub fn computed_seconds(&self) -> f64 {
        self.computed_seconds
    }

    /// Heat sent and received in the last iteration.
    #[must_use]
    pub fn heat_balance(&self) -> HeatBalance {
        let mapping = audit::of_mappings(&self.mapped);
        HeatBalance { mapping, ..HeatBalance::of(&self.solved) }
    }

    /// Makes the last solve of every participant its accepted state. Fields of those which are
    /// observed are published and received. Grids that move are where they have moved to
    /// thereafter.
    pub fn accept(&mut self, step: &Step, observed: Observed) -> Result<(), RunError> {
        // Nothing else looks through what was sent last in an explicit scheme before it is kept.
        (0..self.taps.len()).try_for_each(|tap| self.check_finite(tap))?;
        self.phase = Phase::Accepting(*step);
        let (mut observing, mut answers) = (0_u64, 0_u64);
        for one in 0..self.links.len() {
            let observe = self.is_observed(one, observed);
            let answer = observe || self.has_moving_grids(one);
            observing |= u64::from(observe) << one;
            answers |= u64::from(answer) << one;
            let mut command = Command::about(CommandKind::Accept, step);
            command.flags = if observe { OBSERVE } else { 0 };
            self.post(one, command, &[], answer)?;
        }
        self.keep_geometry();
        for one in (0..self.links.len()).filter(|one| answers >> one & 1 == 1) {
            self.await_done(one, self.deadlines.solve)?;
            if observing >> one & 1 == 1 {
                self.collect(one, step, true)?;
            }
            self.receive_geometry(one, step)?;
        }
        if observing != 0 {
            (0..self.taps.len()).try_for_each(|tap| self.check_finite(tap))?;
        }
        Ok(())
    }

    fn is_observed(&self, one: usize, observed: Observed) -> bool {
        let mut own = self.taps.iter().filter(|tap| tap.producer == one).peekable();
        match observed {
            Observed::Everybody => true,
            Observed::Unconsumed => own.peek().is_some() && own.all(|tap| tap.observed_only),
            Observed::Nobody => false,
        }
    }

    /// Asks every participant for its summary and lets it go.
    pub fn finish(mut self) -> Result<Vec<Finished>, RunError> {
        self.phase = Phase::Finishing;
        if let Some(recorder) = &self.recorder {
            recorder.stop_listening()?;
        }
        self.tell_mappings();
        for one in 0..self.links.len() {
            self.post(one, Command::new(CommandKind::Finish), &[], true)?;
        }
        let mut finished = Vec::with_capacity(self.links.len());
        for one in 0..self.links.len() {
            let message = self.await_done(one, self.deadlines.solve)?;
            let said: Finished = serde_json::from_slice(message.body())
                .map_err(|e| self.misbehaved(one, format!("its summary is not valid: {e}")))?;
            let (model, processor) = (said.model_seconds, said.cpu_seconds);
            if model < 0.0 || processor < 0.0 {
                let what = format!("model_seconds is {model} s, cpu_seconds {processor} s");
                return Err(self.misbehaved(one, what));
            }
            finished.push(said);
        }
        // They end by themselves now; one that does not is ended when the session is dropped.
        self.wait_for_exits();
        Ok(finished)
    }

    pub(crate) fn post(
        &mut self,
        one: usize,
        command: Command,
        body: &[u8],
        ring: bool,
    ) -> Result<(), RunError> {
        let sent = self.links[one].post(command, body, ring);
        let command = sent.map_err(|error| self.transport_failed(one, &error))?;
        if let Some(recorder) = &self.recorder {
            recorder.command(one, &command, body);
        }
        Ok(())
    }

    /// Waits for the reply to the last command of a participant.
    pub(crate) fn await_reply(
        &mut self,
        one: usize,
        patience: Duration,
    ) -> Result<Message<Reply>, RunError> {
        let reply = self.await_news(one, patience)?.1;
        Ok(reply)
    }

    /// Waits for the reply to the last command of a participant, or for the failed reply of another
    /// one that comes before it; gives whose it is.
    fn await_news(
        &mut self,
        one: usize,
        patience: Duration,
    ) -> Result<(usize, Message<Reply>), RunError> {
        let Self { links, doorbell, supervisor, run, deadlines, phase, .. } = self;
        let context = Context { supervisor, run, phase: *phase, deadlines };
        let links = std::cell::RefCell::new(links);
        let mut waited = Patience::new();
        let news = doorbell.wait(
            || {
                let mut links = links.borrow_mut();
                if let Some(message) = links[one].receive()? {
                    return Ok(Some((one, message)));
                }
                for other in (0..links.len()).filter(|&other| other != one) {
                    if links[other].has_failed()? {
                        return Ok(links[other].receive()?.map(|message| (other, message)));
                    }
                }
                match context.look(&mut links, one, waited.waited(), patience) {
                    Ok(()) => Ok(None),
                    // What it sent just before it ended still counts.
                    Err(reason) => match links[one].receive()? {
                        Some(message) => Ok(Some((one, message))),
                        None => Err(reason),
                    },
                }
            },
            |index, beat| {
                if let Some(link) = links.borrow_mut().get_mut(index) {
                    link.beat_received(beat);
                }
            },
        );
        let (who, reply) = news.map_err(|waiting| match waiting {
            Waiting::Run(error) => error,
            Waiting::Transport(error) => self.transport_failed(one, &error),
        })?;
        if let Some(recorder) = &self.recorder {
            recorder.reply(who, reply.header(), reply.body());
        }
        Ok((who, reply))
    }

    /// Waits for the reply, and takes everything but success as an error.
    fn await_done(&mut self, one: usize, patience: Duration) -> Result<Message<Reply>, RunError> {
        let (one, message) = self.await_news(one, patience)?;
        let (reply, body) = (message.header(), message.body());
        match Status::from_number(reply.status) {
            _ if reply.protocol != proto::PROTOCOL_VERSION => {
                let theirs = reply.protocol;
                Err(self.misbehaved(one, format!("it speaks protocol {theirs}")))
            }
            _ if reply.sequence != self.links[one].sequence() => {
                let (found, expected) = (reply.sequence, self.links[one].sequence());
                Err(self
                    .misbehaved(one, format!("it answered command {found} instead of {expected}")))
            }
            Some(Status::Done) => Ok(message),
            Some(Status::Refused) => Err(self.links[one].refused(body)),
            Some(Status::Failed) => Err(self.failed(one, link::failure_text(body))),
            None => {
                let status = reply.status;
                Err(self.misbehaved(one, format!("it replied with the unknown status {status}")))
            }
        }
    }

    fn failed(&self, one: usize, what: String) -> RunError {
        RunError::Failed(Failure {
            who: self.links[one].who(),
            when: self.phase.to_string(),
            what,
            fix: "see its messages in log.jsonl".to_owned(),
        })
    }

    fn misbehaved(&self, one: usize, what: String) -> RunError {
        RunError::Failed(Failure {
            who: self.links[one].who(),
            when: self.phase.to_string(),
            what,
            fix: "the program violates the participant contract (docs/ARCHITECTURE.md)".to_owned(),
        })
    }

    fn transport_failed(&self, one: usize, error: &TransportError) -> RunError {
        // Often the cause is that the participant has just died: give its exit time to be seen.
        let context = Context {
            supervisor: &self.supervisor,
            run: &self.run,
            phase: self.phase,
            deadlines: &self.deadlines,
        };
        let until = Instant::now() + Duration::from_millis(100);
        while Instant::now() < until {
            if let Some(exit) = self.supervisor.exits().first() {
                return context.ended(&self.links, exit);
            }
            std::thread::sleep(Duration::from_millis(1));
        }
        self.failed(one, error.to_string())
    }
}

impl Drop for Session {
    fn drop(&mut self) {
        if let Some(recorder) = &self.recorder {
            // Its failure has been reported by whatever noticed it, or will be by `finish`.
            let _ = recorder.stop_listening();
        }
    }
}

/// What may end a wait.
enum Waiting {
    Run(RunError),
    Transport(TransportError),
}

impl From<TransportError> for Waiting {
    fn from(error: TransportError) -> Self {
        Self::Transport(error)
    }
}

/// What a waiting session looks at.
struct Context<'a> {
    supervisor: &'a Supervisor,
    run: &'a RunDir,
    phase: Phase,
    deadlines: &'a Deadlines,
}

impl Context<'_> {
    /// Is there a reason not to wait any longer?
    fn look(
        &self,
        links: &mut [Link],
        one: usize,
        waited: Duration,
        patience: Duration,
    ) -> Result<(), Waiting> {
        if let Some(signal) = signals::received() {
            let when = self.phase.to_string();
            return Err(Waiting::Run(RunError::Interrupted { signal, when }));
        }
        // A participant that has been asked to finish, and is not the one we wait for, may have
        // left in peace.
        let in_peace = |role: &str| self.phase == Phase::Finishing && role != links[one].role();
        let early = |exit: &&Exit| !(in_peace(&exit.role) && exit.status.success());
        if let Some(exit) = self.supervisor.exits().iter().find(early) {
            return Err(Waiting::Run(self.ended(links, exit)));
        }
        // A participant started by hand is not our child: its lock tells of its death.
        let has_left = |link: &&Link| {
            link.is_attached() && !in_peace(link.role()) && self.run.has_left(link.role())
        };
        if self.phase != Phase::Starting
            && let Some(gone) = links.iter().find(has_left)
        {
            let fix = "see what it wrote where it was started";
            return Err(Waiting::Run(self.hung(gone, "its process is gone".to_owned(), fix)));
        }
        if links[one].has_dealt_with_it() {
            return Err(Waiting::Run(self.hung(
                &links[one],
                "it has processed the last command, but its reply did not arrive".to_owned(),
                "a message was lost in shared memory: see log.jsonl, `ulimit -n` and /dev/shm",
            )));
        }
        let silence = links[one].silence();
        if silence > self.deadlines.heartbeat {
            return Err(Waiting::Run(self.hung(
                &links[one],
                format!("no heartbeat for {:.1} s", silence.as_secs_f64()),
                "it is stopped or its machine is overloaded; raise coupling.heartbeat_deadline \
                 if it may pause for so long",
            )));
        }
        if waited > patience {
            return Err(Waiting::Run(self.late(&links[one], patience)));
        }
        Ok(())
    }

    /// The error for a participant that is alive but has not answered in time.
    fn late(&self, link: &Link, patience: Duration) -> RunError {
        let seconds = patience.as_secs_f64();
        let (what, key) = match self.phase {
            Phase::Initialising => ("it is still building its model", "coupling.build_deadline"),
            _ => ("no answer", "coupling.solve_deadline"),
        };
        let what = format!("{what} after {seconds:.1} s; its heartbeat is still received");
        self.hung(link, what, &format!("raise {key} if it needs longer"))
    }

    fn hung(&self, link: &Link, what: String, fix: &str) -> RunError {
        let (who, when) = (link.who(), self.phase.to_string());
        RunError::Failed(Failure { who, when, what, fix: fix.to_owned() })
    }

    fn ended(&self, links: &[Link], exit: &Exit) -> RunError {
        let link = links.iter().find(|link| link.role() == exit.role);
        let how = match (exit.status.signal(), exit.status.code()) {
            (Some(7), _) => {
                "killed by signal 7 (/dev/shm is full, or the run's files there were truncated)"
                    .to_owned()
            }
            (Some(signal), _) => format!("killed by signal {signal}"),
            (_, Some(code)) => format!("ended with exit code {code}"),
            _ => "ended".to_owned(),
        };
        let words = exit.last_words.as_ref().map_or_else(String::new, |w| format!(", saying: {w}"));
        RunError::Failed(Failure {
            who: link.map_or_else(|| exit.role.clone(), Link::who),
            when: self.phase.to_string(),
            what: format!("its process was {how}{words}").replace("was ended", "ended"),
            fix: "see its messages in log.jsonl".to_owned(),
        })
    }
}

impl Exchange for Session {
    fn participants(&self) -> usize {
        self.links.len()
    }

    fn solve(&mut self, participants: &[usize], step: &Step) -> Result<(), RunError> {
        self.phase = Phase::Solving(*step);
        if let Some(recorder) = &self.recorder {
            recorder.wait_for_room()?;
        }
        self.send_mapped(participants)?;
        for &one in participants {
            let mut command = Command::about(CommandKind::Solve, step);
            for tap in &self.taps {
                for reader in tap.readers().iter().filter(|r| r.participant == one) {
                    command.expected[reader.slot] = tap.sequence();
                }
            }
            for feedback in &self.feedback {
                for reader in feedback.readers.iter().filter(|r| r.participant == one) {
                    command.expected[reader.slot] = feedback.sequence();
                }
            }
            for mapped in self.mapped.iter().filter(|m| m.reader.participant == one) {
                command.expected[mapped.reader.slot] = mapped.outlet().sequence();
            }
            self.post(one, command, &[], true)?;
        }
        // While they compute, what was sent before is audited, recorded and looked through.
        for &one in participants {
            let Self { taps, feedback, mapped, .. } = &*self;
            self.solved[one].heat_sent = audit::commanded(taps, feedback, mapped, one);
        }
        if let Some(recorder) = &self.recorder {
            recorder.hand_over();
        }
        (0..self.taps.len()).try_for_each(|tap| self.check_finite(tap))?;
        let mut longest = 0.0_f64;
        for &one in participants {
            let message = self.await_done(one, self.deadlines.solve)?;
            let before = self.solved[one];
            let fault = audit::report_fault(message.header(), before.heat_received);
            fault.map_or(Ok(()), |what| Err(self.misbehaved(one, what)))?;
            let heat_sent = before.heat_sent;
            self.solved[one] = SolveRecord { heat_sent, ..solve_record(message.header()) };
            longest = longest.max(self.solved[one].model_seconds);
            drop(message);
            self.collect(one, step, false)?;
        }
        self.computed_seconds += longest;
        Ok(())
    }

    fn fed_back(&self) -> &[Part] {
        &self.parts
    }

    fn send(&mut self, iterate: &[f64], step: &Step) -> Result<(), RunError> {
        self.phase = Phase::Solving(*step);
        self.send_iterate(iterate, step)
    }

    fn returned(&self, returned: &mut [f64]) {
        self.copy_returned(returned);
    }
}

fn solve_record(reply: &Reply) -> SolveRecord {
    SolveRecord {
        model_seconds: reply.model_seconds,
        work: reply.work,
        substeps: reply.substeps,
        inner_iterations: reply.inner_iterations,
        heat_sent: None,
        heat_received: Some(reply.heat_received).filter(|heat| !heat.is_nan()),
        wanted_window: Some(reply.wanted_window).filter(|w| *w > 0.0 && w.is_finite()),
    }
}
