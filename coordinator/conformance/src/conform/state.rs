//! Checks of `Save` and `Restore`.

use super::bench::TestBench;
use super::check::Check;
use super::fault::{CheckFailure, Finding};
use super::life::{Answer, TestProcess, Values};
use super::setting::Setting;
use super::solve::{compared, same};
use contract::message::{Command, CommandKind, OutputFile, StateFile, Status};
use contract::step::Step;
use std::path::PathBuf;

pub(super) const RESTORE: Check = Check {
    name: "restore",
    demand: "Save writes the accepted state to the file and changes nothing; a fresh process that \
             restores it publishes the given outputs and resumes bit-identically",
    fix: "everything that the next solve reads belongs in the state",
    run: restore,
};

pub(super) const DAMAGED_STATE: Check = Check {
    name: "damaged-state",
    demand: "a state file that is truncated or missing is refused with a reason; one with a \
             changed byte ends no process (the coordinator's checkpoints have checksums); a complete \
             one is accepted afterwards",
    fix: "check the length of the state against what the configuration needs, before using it",
    run: damaged,
};

/// A state saved between two windows, and the continuation of the solution.
struct SavedState {
    bytes: Vec<u8>,
    /// Last accepted step. Its outputs are below.
    step: Step,
    outputs: Values,
    next: Step,
    continued: Values,
}

fn save(bench: &TestBench, setting: &Setting) -> Result<SavedState, CheckFailure> {
    let mut life = bench.between(setting)?;
    let (mut step, mut outputs) = (setting.step(0), Values::new());
    let windows = if setting.is_transient() { 3 } else { 1 };
    for window in 0..windows {
        step = life.next(setting);
        outputs = life.solve_with(&step, window)?.outputs;
        life.accept(&step, false)?;
    }
    let path = life.folder().join("saved.state");
    let file = StateFile { path: path.clone(), outputs: Vec::new(), geometry: Vec::new() };
    life.ask_with(Command::about(CommandKind::Save, &step), &file)?.done()?;
    let bytes = std::fs::read(&path)
        .map_err(|error| CheckFailure::Broken(format!("cannot read the file of Save: {error}")))?;
    let next = setting.after(&step);
    let continued = life.published(&next, 1)?;
    bench.keep(setting, life);
    Ok(SavedState { bytes, step, outputs, next, continued })
}

impl SavedState {
    /// Asks the participant to restore these bytes, with the last outputs.
    fn give(&self, life: &mut TestProcess, bytes: Option<&[u8]>) -> Result<Answer, CheckFailure> {
        let folder = life.folder().to_owned();
        let path = folder.join("given.state");
        match bytes {
            Some(bytes) => std::fs::write(&path, bytes)?,
            None => std::fs::remove_file(&path).or_else(|error| match error.kind() {
                std::io::ErrorKind::NotFound => Ok(()),
                _ => Err(error),
            })?,
        }
        let mut outputs = Vec::new();
        for (name, values) in &self.outputs {
            let path: PathBuf = folder.join(format!("{name}.values"));
            let bytes: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
            std::fs::write(&path, bytes)?;
            outputs.push(OutputFile { field: name.clone(), path });
        }
        let file = StateFile { path, outputs, geometry: Vec::new() };
        life.ask_with(Command::about(CommandKind::Restore, &self.step), &file)
    }

    /// Restores the complete state and continues.
    fn continue_in(&self, life: &mut TestProcess) -> Result<(), CheckFailure> {
        self.give(life, Some(&self.bytes))?.done()?;
        life.restored(&self.step)?;
        same(&life.collect(&self.step)?, &self.outputs, "Restore publishes other values")?;
        let continued = life.published(&self.next, 1)?;
        same(&continued, &self.continued, "the restored process continues differently")
    }
}

fn restore(bench: &TestBench) -> Result<Finding, CheckFailure> {
    bench.each(|setting| {
        let saved = save(bench, setting)?;
        let mut life = bench.ready(setting)?;
        saved.continue_in(&mut life)?;
        compared(&saved.continued, &format!("{} bytes, the same bits", saved.bytes.len()))
    })
}

fn damaged(bench: &TestBench) -> Result<Finding, CheckFailure> {
    bench.each(|setting| {
        let saved = save(bench, setting)?;
        let mut life = bench.between(setting)?;
        let missing = saved.give(&mut life, None)?.not_done("a state file that does not exist")?;
        life.none_of_outputs("a Restore that failed")?;
        let length = saved.bytes.len();
        if length == 0 {
            saved.continue_in(&mut life)?;
            return Finding::kept(format!("no state to truncate; a missing file: {missing}"));
        }
        for cut in [0, 1, length / 2, length - 1] {
            let what = format!("a state truncated to {cut} of {length} bytes");
            saved.give(&mut life, Some(&saved.bytes[..cut]))?.not_done(&what)?;
            life.none_of_outputs("a Restore that failed")?;
        }
        for at in [0, length / 2, length - 1] {
            let mut bytes = saved.bytes.clone();
            bytes[at] ^= 0x55;
            let answer = saved.give(&mut life, Some(&bytes))?;
            if answer.status == Status::Done {
                life.collect(&saved.step)?;
            } else {
                answer.not_done("a changed byte")?;
                life.none_of_outputs("a Restore that failed")?;
            }
        }
        saved.continue_in(&mut life)?;
        bench.keep(setting, life);
        Finding::kept(format!(
            "truncations of {length} bytes refused; the complete state is accepted afterwards"
        ))
    })
}
