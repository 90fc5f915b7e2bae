//! The participants of one or several runs.
//!
//! Planning asks the programs of a case for their descriptions and estimates. Depending on its
//! [`Lifetime`], a fleet starts the participants for these questions already, and a run uses the
//! same processes. In a fleet of a study, the participants of a successful run stay for the next
//! one, if all of them are reusable ([`contract::description::Description::reusable`]). Any failure
//! ends the processes, and the next run starts new ones.

use crate::deadlines::Deadlines;
use crate::error::RunError;
use crate::linked::LinkedSolvers;
use crate::peers::{ParticipantSlot, Peers, Phase};
use crate::programs::Program;
use crate::session::open_files;
use contract::configuration::{Configuration, Estimate};
use contract::description::Description;
use std::time::Duration;

/// Number of topics of a participant, assumed when the limit of open files is checked before
/// planning.
const TOPICS: usize = 4;

/// Lifetime of participants.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Lifetime {
    /// Planning starts a process for each question, and every run its own participants.
    #[default]
    Run,
    /// Participants live from the planning of a run to its end.
    PlanAndRun,
    /// Participants stay from run to run.
    Study,
}

/// The participants that wait for a run, and what is known of their programs. Dropping a fleet
/// dismisses the participants.
#[derive(Debug, Default)]
pub struct Fleet {
    lifetime: Lifetime,
    solvers: LinkedSolvers,
    descriptions: Vec<(Program, Description)>,
    peers: Option<Peers>,
}

impl Fleet {
    /// Returns a fleet without participants.
    #[must_use]
    pub fn new(lifetime: Lifetime) -> Self {
        let (solvers, descriptions) = (LinkedSolvers::default(), Vec::new());
        Self { lifetime, solvers, descriptions, peers: None }
    }

    /// Returns a fleet with solvers that are linked into this program.
    #[must_use]
    pub fn with(mut self, solvers: LinkedSolvers) -> Self {
        self.solvers = solvers;
        self
    }

    /// Returns the program of a role: the command of the case, or `ROLE-solver`. A linked solver
    /// replaces it.
    pub(crate) fn program(&self, role: &str, command: Option<&[String]>) -> Program {
        Program::of_role_or_linked(role, command, &self.solvers)
    }

    /// Returns the description of a program that has been asked before.
    pub(crate) fn description(&self, program: &Program) -> Option<&Description> {
        self.descriptions.iter().find(|(known, _)| known == program).map(|(_, known)| known)
    }

    /// Checks and keeps the description of a program. A description of another contract version is
    /// not checked.
    pub(crate) fn learn(
        &mut self,
        role: &str,
        program: &Program,
        description: Description,
    ) -> Result<(), RunError> {
        if description.protocol == contract::PROTOCOL_VERSION {
            description.check().map_err(|fault| program.misled(role, fault))?;
        }
        self.descriptions.retain(|(known, _)| known != program);
        self.descriptions.push((program.clone(), description));
        Ok(())
    }

    /// Starts participants and asks for their descriptions, unless some wait already or planning is
    /// to ask programs. If that fails, planning asks programs, and reports the error. `joining` is
    /// the time to join, `patience` that of an answer.
    pub(crate) fn start(
        &mut self,
        seats: &[ParticipantSlot],
        patience: Duration,
        joining: impl FnOnce() -> Duration,
    ) {
        let waiting = self.lifetime == Lifetime::Run || self.peers.is_some();
        if waiting || seats.is_empty() || seats.iter().any(|seat| seat.attach) {
            return;
        }
        match self.described(seats, joining(), patience) {
            Ok(peers) => self.peers = Some(peers),
            Err(error) => tracing::debug!("participants are not started for planning: {error}"),
        }
    }

    /// Starts participants, waits until they have joined, and keeps their descriptions.
    fn described(
        &mut self,
        seats: &[ParticipantSlot],
        joining: Duration,
        patience: Duration,
    ) -> Result<Peers, RunError> {
        open_files::provide(seats.len(), TOPICS * seats.len(), false)?;
        let deadlines =
            Deadlines { start: joining, build: patience, solve: patience, heartbeat: patience };
        let mut peers = Peers::start(seats, deadlines, None)?;
        peers.join()?;
        peers.phase = Phase::Configuring;
        for (one, seat) in peers.all().keys().zip(seats) {
            let description = peers.describe(one, patience)?;
            self.learn(&seat.role, &seat.program, description)?;
        }
        Ok(peers)
    }

    /// Asks a waiting participant for its estimate. Returns `None` if no participant runs this
    /// program, or if it fails or answers with a faulty layout. Planning then asks a new process.
    pub(crate) fn estimate(
        &mut self,
        program: &Program,
        configuration: &Configuration,
        patience: Duration,
    ) -> Option<Estimate> {
        let peers = self.peers.as_mut()?;
        let is_it =
            |seat: &ParticipantSlot| seat.role == configuration.role && seat.program == *program;
        let one = peers.seats().iter().position(is_it)?.into();
        peers.phase = Phase::Configuring;
        let estimate = match peers.configure(one, configuration, patience) {
            Ok(layout) => Some(Estimate::Layout(layout)),
            Err(RunError::Refused { refusal, .. }) => Some(Estimate::Refused(refusal)),
            Err(_) => None,
        };
        if estimate.is_none() {
            self.peers = None;
        }
        estimate
    }

    /// Returns the shared memory of the waiting participants [byte].
    pub(crate) fn held_memory(&self) -> u64 {
        self.peers.as_ref().map_or(0, Peers::held_memory)
    }

    /// Takes the waiting participants, if they hold all these seats and are alive. Otherwise
    /// dismisses them.
    pub(crate) fn take(&mut self, seats: &[ParticipantSlot]) -> Option<Peers> {
        match self.peers.take()?.seated(seats) {
            Ok(peers) => Some(peers),
            Err(others) => {
                others.dismiss();
                None
            }
        }
    }

    /// Returns whether participants stay after a run.
    pub(crate) fn stays(&self) -> bool {
        self.lifetime == Lifetime::Study
    }

    /// Keeps the participants of a run that has ended.
    pub(crate) fn stay(&mut self, peers: Peers) {
        self.dismiss();
        self.peers = Some(peers);
    }

    /// Dismisses the waiting participants.
    pub(crate) fn dismiss(&mut self) {
        self.peers.take().into_iter().for_each(Peers::dismiss);
    }
}

impl Drop for Fleet {
    fn drop(&mut self) {
        self.dismiss();
    }
}
