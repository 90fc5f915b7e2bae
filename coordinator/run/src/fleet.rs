//! The participants of one or several runs.
//!
//! A fleet starts the programs of a case, and asks them for their descriptions, their layouts and
//! their advice. A run takes over the same processes. In a fleet of a study, the participants of a
//! successful run stay for the next one, if all of them are reusable
//! ([`contract::description::Description::reusable`]). Any failure ends the processes, and the next
//! question starts new ones.

use crate::deadlines::Deadlines;
use crate::error::RunError;
use crate::linked::LinkedSolvers;
use crate::peers::{ParticipantSlot, Peers, Phase};
use crate::program::Program;
use crate::session::open_files::OpenFiles;
use contract::advice::{Opinion, Scene};
use contract::configuration::{Configuration, Layout};
use contract::description::Description;
use coupling::ParticipantIndex;
use std::slice;
use std::sync::Arc;
use std::time::Duration;

/// Longest time that a program may take to join or to answer a question.
const ANSWER: Duration = Duration::from_secs(30);

/// Deadlines of questions that belong to no valid case.
pub(crate) const QUESTIONS: Deadlines =
    Deadlines { start: ANSWER, build: ANSWER, solve: ANSWER, heartbeat: ANSWER };

/// Number of topics of a participant, assumed when the limit of open files is checked before
/// planning.
const TOPICS: usize = 4;

/// The participants that wait for a run, and what is known of their programs. Dropping a fleet
/// dismisses the participants.
#[derive(Debug)]
pub struct Fleet {
    /// Whether participants stay after a run.
    stays: bool,
    solvers: LinkedSolvers,
    descriptions: Vec<(Program, Arc<Description>)>,
    /// Groups of participants that were started together.
    waiting: Vec<Peers>,
    /// Longest waits for the answers to the questions of a plan.
    deadlines: Deadlines,
    pub(crate) open_files: OpenFiles,
}

impl Fleet {
    fn new(stays: bool) -> Self {
        let (solvers, open_files) = (LinkedSolvers::default(), OpenFiles::default());
        let (descriptions, waiting) = (Vec::new(), Vec::new());
        Self { stays, solvers, descriptions, waiting, deadlines: QUESTIONS, open_files }
    }

    /// Returns a fleet of one run, or of several that each start their participants.
    #[must_use]
    pub fn for_one_run() -> Self {
        Self::new(false)
    }

    /// Returns a fleet whose participants stay from run to run.
    #[must_use]
    pub fn for_study() -> Self {
        Self::new(true)
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
    pub(crate) fn description(&self, program: &Program) -> Option<&Arc<Description>> {
        self.descriptions.iter().find(|(known, _)| known == program).map(|(_, known)| known)
    }

    /// Asks the programs of a case for their descriptions, all at the same time. `own` wait for a
    /// run together. `others` may fail, and leave after the answer. The deadlines hold for these
    /// and all later questions; joining and each answer may take `start`, 30 s at most.
    ///
    /// # Errors
    /// One of `own` does not start, join or describe itself.
    pub(crate) fn describe(
        &mut self,
        own: &[ParticipantSlot],
        others: &[ParticipantSlot],
        deadlines: Deadlines,
    ) -> Result<(), RunError> {
        self.deadlines = Deadlines { start: deadlines.start.min(ANSWER), ..deadlines };
        let is_new = |seat: &&ParticipantSlot| self.description(&seat.program).is_none();
        let asked: Vec<_> = others.iter().filter(is_new).map(slice::from_ref).collect();
        let mut group = None;
        if !own.is_empty() && (self.waiting.is_empty() || own.iter().any(|seat| is_new(&seat))) {
            self.dismiss();
            group = Some(self.start(own)?);
        }
        let asked: Vec<_> = asked.into_iter().map(|seat| self.start(seat)).collect();
        if let Some(peers) = group {
            let peers = self.joined(peers)?;
            self.waiting.push(peers);
        }
        for peers in asked {
            match peers.and_then(|peers| self.joined(peers)) {
                Ok(peers) => peers.dismiss(),
                Err(error) => tracing::debug!("a program does not describe itself: {error}"),
            }
        }
        Ok(())
    }

    /// Starts participants.
    fn start(&mut self, seats: &[ParticipantSlot]) -> Result<Peers, RunError> {
        self.open_files.provide(seats.len(), TOPICS * seats.len(), false)?;
        Peers::start(seats, self.deadlines, None)
    }

    /// Waits until participants have joined, and keeps their descriptions. The description of
    /// another contract version is not checked.
    fn joined(&mut self, mut peers: Peers) -> Result<Peers, RunError> {
        peers.join()?;
        peers.phase = Phase::Configuring;
        for participant in peers.all().keys() {
            let program = peers.seats()[usize::from(participant)].program.clone();
            if self.description(&program).is_some() {
                continue;
            }
            let description = peers.describe(participant, peers.deadlines().start)?;
            if description.protocol == contract::PROTOCOL_VERSION {
                description.check().map_err(|fault| peers.misbehaved(participant, fault))?;
            }
            self.descriptions.push((program, Arc::new(description)));
        }
        Ok(peers)
    }

    /// Asks a program for its layout of a configuration.
    ///
    /// # Errors
    /// The program refuses the configuration or fails, or its layout does not fit.
    pub(crate) fn layout(
        &mut self,
        program: &Program,
        configuration: &Configuration,
    ) -> Result<Layout, RunError> {
        self.ask(&configuration.role, program, |peers, participant| {
            peers.configure(participant, configuration, peers.deadlines().start)
        })
    }

    /// Asks a program for its opinion on effects in a scene.
    ///
    /// # Errors
    /// The program fails, or its answer is not valid.
    pub(crate) fn advise(
        &mut self,
        role: &str,
        program: &Program,
        scene: &Scene,
    ) -> Result<Opinion, RunError> {
        self.ask(role, program, |peers, participant| {
            peers.advise(participant, scene, peers.deadlines().start)
        })
    }

    /// Asks the participant that waits in this role, or starts it. A failure ends all that wait; a
    /// refusal does not.
    fn ask<T>(
        &mut self,
        role: &str,
        program: &Program,
        question: impl FnOnce(&mut Peers, ParticipantIndex) -> Result<T, RunError>,
    ) -> Result<T, RunError> {
        let place = |peers: &Peers| {
            peers.seats().iter().position(|seat| seat.role == role && seat.program == *program)
        };
        if !self.waiting.iter().any(|peers| place(peers).is_some()) {
            let seat =
                ParticipantSlot { role: role.to_owned(), program: program.clone(), attach: false };
            let peers = self.start(slice::from_ref(&seat))?;
            let peers = self.joined(peers)?;
            self.waiting.push(peers);
        }
        let found = self.waiting.iter_mut().find_map(|peers| place(peers).map(|at| (peers, at)));
        let (peers, at) = found.expect("started above");
        peers.set_deadlines(self.deadlines);
        peers.phase = Phase::Configuring;
        let answer = question(peers, at.into());
        if !matches!(answer, Ok(_) | Err(RunError::Refused { .. })) {
            self.waiting.clear();
        }
        answer
    }

    /// Returns the shared memory of the waiting participants [byte].
    pub(crate) fn held_memory(&self) -> u64 {
        self.waiting.iter().map(Peers::held_memory).sum()
    }

    /// Takes the waiting participants, if they hold all these seats and are alive. Dismisses all
    /// others.
    pub(crate) fn take(&mut self, seats: &[ParticipantSlot]) -> Option<Peers> {
        let mut taken = None;
        for peers in std::mem::take(&mut self.waiting) {
            match peers.seated(seats) {
                Ok(peers) => taken = Some(peers),
                Err(others) => others.dismiss(),
            }
        }
        taken
    }

    /// Returns whether participants stay after a run.
    pub(crate) fn stays(&self) -> bool {
        self.stays
    }

    /// Keeps the participants of a run that has ended.
    pub(crate) fn stay(&mut self, peers: Peers) {
        self.dismiss();
        self.waiting.push(peers);
    }

    /// Dismisses the waiting participants.
    pub fn dismiss(&mut self) {
        self.waiting.drain(..).for_each(Peers::dismiss);
    }
}

impl Drop for Fleet {
    fn drop(&mut self) {
        self.dismiss();
    }
}

/// Returns the descriptions of programs, in their order.
///
/// # Errors
/// A program fails, or its description is not valid.
pub fn described(seats: &[ParticipantSlot]) -> Result<Vec<Description>, RunError> {
    if let Some(ParticipantSlot { role, program, .. }) =
        seats.iter().find(|seat| !seat.program.exists())
    {
        let (role, program) = (role.clone(), program.clone());
        return Err(RunError::NoProgram { role, program });
    }
    let mut fleet = Fleet::for_one_run();
    fleet.describe(seats, &[], QUESTIONS)?;
    let found = seats.iter().filter_map(|seat| fleet.description(&seat.program));
    Ok(found.map(|found| Description::clone(found)).collect())
}

/// Returns the descriptions of the programs beside the coordinator that look like participants, by
/// role.
///
/// # Errors
/// A program fails, or its description is not valid.
pub fn installed() -> Result<Vec<Description>, RunError> {
    let seat =
        |(role, program): (String, Program)| ParticipantSlot { role, program, attach: false };
    described(&Program::installed().into_iter().map(seat).collect::<Vec<_>>())
}
