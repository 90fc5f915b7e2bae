//! `coordinator replay`: one participant, driven through exactly what was recorded, without the
//! others.
//!
//! The participant is asked what it was asked, in the same order, with the same inputs: every
//! iteration of every window, what was accepted, saved and restored. Everything it sends is compared
//! with what was sent then. It may be the program of the recorded run, another build of it, or any
//! other that plays the role; its partners need not be on the machine.
//!
//! Samples are renumbered, so that a replay may begin in the middle ([`Request::from`]): at the
//! last state of the participant that the recording holds before.

mod cli;
mod compare;
mod drive;
mod feed;
mod request;
mod show;
#[cfg(test)]
mod tests;
mod told;
mod walk;

pub(crate) use cli::{Arguments, main};
pub(crate) use compare::Difference;
pub(crate) use request::{Replay, Request};
pub(crate) use show::{difference, text};

use crate::inspect;
use drive::Driver;
use proto::recording::{Item, Participant};
use run::deadlines::Deadlines;
use run::error::RunError;
use run::peers::{Peers, Seat};
use run::programs::Program;
use run::signals;
use std::path::Path;
use std::time::{Duration, Instant};

/// Drives the participant.
///
/// # Errors
/// The recording cannot be read, has no such role, or the participant fails otherwise than it did
/// then. A difference is no error here: see [`Replay::comparison`].
pub(crate) fn replay(request: &Request) -> Result<Replay, RunError> {
    let begun = Instant::now();
    let path = &request.recording;
    if let (Some(from), Some(until)) = (request.from, request.until)
        && from > until
    {
        return Err(RunError::Usage(format!("--from {from} comes after --until {until}")));
    }
    let reading = signals::end_at_once();
    let from = match request.from {
        Some(window) if window > 0 => last_state_before(path, &request.only, window)?,
        _ => None,
    };
    let mut recording = inspect::open(path)?;
    drop(reading);
    let index = participant(path, &recording.head().participants, &request.only)?;
    let recorded = recording.head().participants[index].clone();
    let program = match &request.program {
        Some(program) => program.clone(),
        None if request.serve => Program::of_role(&request.only, None),
        None => built_in(path, &recorded)?,
    };
    let seat = Seat { role: request.only.clone(), program, attach: request.serve };
    let deadlines = if request.serve { NO_DEADLINES } else { DEADLINES };
    let mut peers = Peers::start(&[seat], deadlines, None)?;
    peers.join()?;
    let mut driver = Driver::new(request, index, &recorded, &mut peers, from)?;
    driver.attach_files(&recording)?;
    let mut damage = None;
    loop {
        match recording.read() {
            Ok(Some(entry)) => {
                if !driver.entry(entry.item)? {
                    break;
                }
            }
            Ok(None) => break,
            Err(error) => {
                damage = Some(error.to_string());
                break;
            }
        }
    }
    let cut = matches!(recording.end(), proto::recording::End::Cut(_));
    let mut replay = driver.finish(cut || damage.is_some())?;
    (replay.damage, replay.cut) = (damage, cut);
    replay.wall_s = begun.elapsed().as_secs_f64();
    Ok(replay)
}

/// Waits of a replay.
const DEADLINES: Deadlines = Deadlines {
    start: Duration::from_secs(30),
    build: Duration::from_secs(3600),
    solve: Duration::from_secs(3600),
    heartbeat: Duration::from_secs(10),
};

/// A debugger may hold the participant for as long as it likes.
const NO_DEADLINES: Deadlines = Deadlines {
    start: Duration::from_secs(365 * 86_400),
    build: Duration::from_secs(365 * 86_400),
    solve: Duration::from_secs(365 * 86_400),
    heartbeat: Duration::from_secs(365 * 86_400),
};

fn participant(path: &Path, all: &[Participant], role: &str) -> Result<usize, RunError> {
    all.iter().position(|p| p.role == role).ok_or_else(|| {
        let roles: Vec<&str> = all.iter().map(|p| p.role.as_str()).collect();
        RunError::Usage(format!(
            "no participant in {} plays `{role}`; give --only one of: {}",
            path.display(),
            roles.join(", ")
        ))
    })
}

/// Our own solver of the role. The program that a recording names is never started: whoever made the
/// file may have written anything there.
fn built_in(path: &Path, recorded: &Participant) -> Result<Program, RunError> {
    let own = Program::of_role(&recorded.role, None);
    if own.path.is_file() {
        return Ok(own);
    }
    let (role, name, shown) = (&recorded.role, &recorded.program, path.display());
    Err(RunError::Usage(format!(
        "there is no {role}-solver beside the coordinator; give the program that plays `{role}`: \
         --command PROGRAM ({shown} was made with one called `{name}`)"
    )))
}

/// How many states of the role come up to the last one with which `window` can still be solved.
fn last_state_before(path: &Path, role: &str, window: u64) -> Result<Option<u64>, RunError> {
    let mut recording = inspect::open(path)?;
    let index = participant(path, &recording.head().participants, role)?;
    let (mut states, mut last, mut saving, mut end) = (0, None, None, 0);
    while let Some(entry) = recording.read().map_err(|error| inspect::failed(path, &error))? {
        match entry.item {
            Item::State { role: whose, .. } if whose == role => {
                states += 1;
                if saving.is_some_and(|after: u64| after < window) {
                    last = Some(states);
                }
            }
            Item::Event(proto::recording::Event::Command { participant, command, .. })
                if usize::from(participant) == index =>
            {
                end = end.max(command.window);
                let saves = command.kind == contract::message::CommandKind::Save as u32;
                saving = saves.then_some(command.window);
            }
            _ => {}
        }
    }
    if window > end {
        let shown = path.display();
        return Err(RunError::Usage(format!(
            "{shown} ends with window {end}; give an earlier --from"
        )));
    }
    Ok(last)
}
