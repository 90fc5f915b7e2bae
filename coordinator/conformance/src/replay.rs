//! `coordinator replay`: drives one participant through a recording, without its partners.
//!
//! The participant receives the recorded commands in the same order, with the same inputs: every
//! iteration of every window, with all windows accepted and states saved and restored. Everything
//! that it sends is compared with the recording. The driven program may be that of the recorded
//! run, another build of it, or any other program for the role. The programs of the partners are
//! not needed.
//!
//! Samples are renumbered, so that a replay may begin in the middle ([`Request::from`]). Such a
//! replay begins at the last recorded state of the participant before that window.

mod configuration;
mod drive;
mod fields;
mod report;
#[cfg(test)]
mod tests;

use crate::recording_file::{self, unreadable};
use clap::Args;
use configuration::Request;
use console::command::{Command, Context, Group};
use console::output::print;
use contract::text::json;
use drive::Driver;
use proto::recording::{Item, Participant};
pub(crate) use report::{Comparison, difference, first_unequal, growth_lines, mislabelled};
use report::{Replay, text};
use run::deadlines::Deadlines;
use run::error::RunError;
use run::peers::{ParticipantSlot, Peers};
use run::program::Program;
use run::signals;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Options of `coordinator replay`.
#[derive(Debug, Args)]
pub struct ReplayCommand {
    /// Recording to replay, or a result directory with one.
    recording: PathBuf,
    /// Role of the participant to drive.
    #[arg(long, value_name = "ROLE")]
    only: String,
    /// Program to drive, with its arguments [default: ROLE-solver].
    #[arg(long, num_args = 1.., value_name = "COMMAND", conflicts_with = "serve")]
    command: Vec<String>,
    /// Largest difference that passes, relative to the largest value of a sample [default: none,
    /// bit-identical].
    #[arg(long, value_name = "RELATIVE")]
    tolerance: Option<f64>,
    /// Begin with this window, from a recorded state.
    #[arg(long, value_name = "WINDOW")]
    from: Option<u64>,
    /// End with this window.
    #[arg(long, value_name = "WINDOW")]
    until: Option<u64>,
    /// Change a value of the recorded configuration: dotted name and SI number, or text.
    #[arg(long, value_name = "KEY=VALUE")]
    set: Vec<String>,
    /// Ask before every command, from the first solve of WINDOW on.
    #[arg(
        long,
        value_name = "WINDOW",
        num_args = 0..=1,
        require_equals = true,
        default_missing_value = "0"
    )]
    step: Option<u64>,
    /// Wait for a solver that is started by hand, for example in a debugger; there are no
    /// deadlines.
    #[arg(long)]
    serve: bool,
    /// Print JSON.
    #[arg(long)]
    json: bool,
}

impl Command for ReplayCommand {
    const NAME: &'static str = "replay";
    const GROUP: Group = Group::Solvers;
    const ABOUT: &'static str = "Drive one participant through a recording, and compare";
    const EXAMPLES: &'static [&'static str] = &[
        "coordinator replay results/latest/recording.mcap --only thermal",
        "coordinator replay results/latest/recording.mcap --only thermal --serve",
    ];

    fn run(&self, context: &Context<'_>) -> Result<(), RunError> {
        if self.tolerance.is_some_and(|t| t.is_nan() || t < 0.0) {
            return Err(RunError::Usage("--tolerance must be a number of at least 0".to_owned()));
        }
        let words = words(&self.command)?;
        let program = (!words.is_empty()).then(|| Program::of_role(&self.only, Some(&words)));
        let request = Request {
            recording: recording_file::find(&self.recording)?,
            only: self.only.clone(),
            program,
            serve: self.serve,
            tolerance: self.tolerance,
            from: self.from,
            until: self.until,
            set: self.set.iter().map(|option| assignment(option)).collect::<Result<_, _>>()?,
            step: self.step,
        };
        let replay = replay(&request)?;
        if self.json {
            print(&json(&replay))?;
        } else if !context.quiet {
            print(&text(&replay, &request))?;
        }
        let compared = &replay.comparison;
        let first = compared.first.as_ref().map(difference);
        match (first.or_else(|| compared.other.clone()), &replay.damage) {
            (Some(difference), _) => {
                let what = format!("the replay differs from the recording: {difference}");
                Err(RunError::Differs(what))
            }
            (None, Some(damage)) => Err(unreadable(&request.recording, damage)),
            (None, None) if compared.samples == 0 => {
                Err(RunError::Usage("there was nothing to compare in these windows".to_owned()))
            }
            (None, None) => Ok(()),
        }
    }
}

/// Returns a program and its arguments. A single text with spaces is a command line, quoted as in a
/// shell.
fn words(command: &[String]) -> Result<Vec<String>, RunError> {
    let [line] = command else { return Ok(command.to_vec()) };
    let open = || RunError::Usage(format!("--command has a quote that is not closed: {line}"));
    shlex::split(line).ok_or_else(open)
}

/// Parses KEY=VALUE, where the value is a number, true or false, or a text.
fn assignment(option: &str) -> Result<(String, serde_json::Value), RunError> {
    let (key, value) = option
        .split_once('=')
        .filter(|(key, _)| !key.is_empty())
        .ok_or_else(|| RunError::Usage(format!("`--set {option}` is not KEY=VALUE")))?;
    let value = serde_json::from_str(value).unwrap_or_else(|_| value.into());
    Ok((key.to_owned(), value))
}

/// Drives the participant.
///
/// # Errors
/// The recording cannot be read or has no such role, or the participant fails where it did not fail
/// in the recording. A difference is not an error here: see [`Replay::comparison`].
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
    let mut recording = recording_file::open(path)?;
    drop(reading);
    let index = participant(path, &recording.head().participants, &request.only)?;
    let recorded = recording.head().participants[index].clone();
    let program = match &request.program {
        Some(program) => program.clone(),
        None if request.serve => Program::of_role(&request.only, None),
        None => built_in(path, &recorded)?,
    };
    let seat = ParticipantSlot { role: request.only.clone(), program, attach: request.serve };
    let deadlines = if request.serve { NO_DEADLINES } else { DEADLINES };
    let mut peers = Peers::start(&[seat], deadlines, None)?;
    peers.join()?;
    let mut driver = Driver::new(request, index, &recorded, &mut peers, from)?;
    driver.attach_files(&recording)?;
    let mut damage = None;
    loop {
        // Entries of the other participants are passed without a wait that would notice a signal.
        if let Some(signal) = signals::received() {
            return Err(RunError::Interrupted { signal, when: driver.position() });
        }
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

/// Limits of the waits of a replay.
const DEADLINES: Deadlines = Deadlines {
    start: Duration::from_secs(30),
    build: Duration::from_secs(3600),
    solve: Duration::from_secs(3600),
    heartbeat: Duration::from_secs(10),
};

/// Limits for a participant in a debugger, which may stop it for a long time.
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

/// Returns the coordinator's own solver of the role. The program named in a recording is never
/// started: the author of the file could have named any program.
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

/// Returns the number of states of the role up to the last one from which `window` can be reached.
fn last_state_before(path: &Path, role: &str, window: u64) -> Result<Option<u64>, RunError> {
    let mut recording = recording_file::open(path)?;
    let index = participant(path, &recording.head().participants, role)?;
    let (mut states, mut last, mut saving, mut end) = (0, None, None, 0);
    while let Some(entry) =
        recording.read().map_err(|error| recording_file::failed(path, &error))?
    {
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
