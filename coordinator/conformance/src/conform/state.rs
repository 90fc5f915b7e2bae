//! Save and Restore.

use super::bench::Bench;
use super::check::Check;
use super::fault::{Fault, Seen};
use super::life::{Life, Values};
use super::setting::Setting;
use super::solving::{compared, same};
use contract::message::{Command, CommandKind, OutputFile, StateFile, Status};
use contract::step::Step;
use std::path::{Path, PathBuf};

pub(super) const RESTORE: Check = Check {
    name: "restore",
    demand: "Save writes the accepted state to the file and changes nothing; a fresh process that \
             restores it publishes the outputs that it is given and resumes bit-identically",
    fix: "everything that the next solve reads belongs into the state",
    run: restore,
};

pub(super) const DAMAGED_STATE: Check = Check {
    name: "damaged-state",
    demand: "a state file that is truncated or missing is refused with a reason; one with a \
             changed byte ends no process (the coordinator's checkpoints have checksums); a whole \
             one is taken afterwards",
    fix: "check the length of the state against what the configuration needs, before using it",
    run: damaged,
};

/// A state saved between two windows, and how the solution continues from there.
struct Saved {
    bytes: Vec<u8>,
    /// The accepted step, and what was sent last.
    step: Step,
    outputs: Values,
    next: Step,
    continued: Values,
}

fn save(bench: &Bench, setting: &Setting) -> Result<Saved, Fault> {
    let mut life = bench.between(setting)?;
    let (mut step, mut outputs) = (setting.step(0), Values::new());
    let windows = if setting.is_transient() { 3 } else { 1 };
    for window in 0..windows {
        step = life.next(setting);
        outputs = life.solve_with(&step, window)?.outputs;
        life.accept(&step, false)?;
    }
    let path = life.folder().join("saved.state");
    life.ask(Command::about(CommandKind::Save, &step), &body(&path, Vec::new()))?.done()?;
    let bytes = std::fs::read(&path)
        .map_err(|error| Fault::Broken(format!("Save is done, but the file: {error}")))?;
    let next = setting.after(&step);
    let continued = life.published(&next, 1)?;
    bench.keep(setting, life);
    Ok(Saved { bytes, step, outputs, next, continued })
}

fn body(path: &Path, outputs: Vec<OutputFile>) -> Vec<u8> {
    let path = path.to_owned();
    serde_json::to_vec(&StateFile { path, outputs, geometry: Vec::new() })
        .expect("paths of a run are UTF-8")
}

impl Saved {
    /// Asks to restore these bytes, with what was sent last.
    fn give(&self, life: &mut Life, bytes: Option<&[u8]>) -> Result<super::life::Answer, Fault> {
        let folder = life.folder().to_owned();
        let path = folder.join("given.state");
        match bytes {
            Some(bytes) => std::fs::write(&path, bytes)?,
            None => std::fs::remove_file(&path).or_else(|error| match error.kind() {
                std::io::ErrorKind::NotFound => Ok(()),
                _ => Err(error),
            })?,
        }
        let mut files = Vec::new();
        for (name, values) in &self.outputs {
            let path: PathBuf = folder.join(format!("{name}.values"));
            let bytes: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
            std::fs::write(&path, bytes)?;
            files.push(OutputFile { field: name.clone(), path });
        }
        life.ask(Command::about(CommandKind::Restore, &self.step), &body(&path, files))
    }

    /// Restores the whole state and continues.
    fn continue_in(&self, life: &mut Life) -> Result<(), Fault> {
        self.give(life, Some(&self.bytes))?.done()?;
        life.restored(&self.step)?;
        same(&life.collect(&self.step)?, &self.outputs, "Restore publishes other values")?;
        let continued = life.published(&self.next, 1)?;
        same(&continued, &self.continued, "the restored process continues differently")
    }
}

fn restore(bench: &Bench) -> Result<Seen, Fault> {
    bench.each(|setting| {
        let saved = save(bench, setting)?;
        let mut life = bench.ready(setting)?;
        saved.continue_in(&mut life)?;
        compared(&saved.continued, &format!("{} bytes, the same bits", saved.bytes.len()))
    })
}

fn damaged(bench: &Bench) -> Result<Seen, Fault> {
    bench.each(|setting| {
        let saved = save(bench, setting)?;
        let mut life = bench.between(setting)?;
        let missing = saved.give(&mut life, None)?.not_done("a state file that is not there")?;
        life.none_of_outputs("a Restore that failed")?;
        let length = saved.bytes.len();
        if length == 0 {
            saved.continue_in(&mut life)?;
            return Seen::kept(format!("no state to truncate; a missing file: {missing}"));
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
        Seen::kept(format!(
            "truncations of {length} bytes refused; the whole state is taken afterwards"
        ))
    })
}
