//! Commands that make no sense.

use super::bench::Bench;
use super::check::Check;
use super::fault::{Fault, Seen, broken};
use contract::message::{Command, CommandKind, OBSERVE};

pub(super) const UNKNOWN_COMMAND: Check = Check {
    name: "unknown-command",
    demand: "a command with an unknown number, or of another version of the contract, fails with a \
             reason, the latter naming both versions; the participant lives on",
    fix: "status 1 and {error} for what is not known",
    run: unknown,
};

pub(super) const MALFORMED: Check = Check {
    name: "malformed",
    demand: "a body that is not JSON, or not of the expected form, fails with a reason; the \
             participant lives on and takes a good one",
    fix: "parse the bodies of commands before anything changes",
    run: malformed,
};

pub(super) const OUT_OF_ORDER: Check = Check {
    name: "out-of-order",
    demand: "Connect and Initialise before Configure, and Solve, Accept with OBSERVE, Save and \
             Restore before Initialise, fail with a reason; the participant lives on and can be configured",
    fix: "remember how far the conversation has come",
    run: out_of_order,
};

fn unknown(bench: &Bench) -> Result<Seen, Fault> {
    let mut life = bench.joined()?;
    let mut message = String::new();
    for kind in [0, 10, u32::MAX] {
        let command = Command { kind, ..Command::new(CommandKind::Describe) };
        message = life.ask(command, &[])?.not_done("its number")?;
        life.lives_on("an unknown command")?;
    }
    let command = Command { protocol: 999, ..Command::new(CommandKind::Describe) };
    let other = life.ask(command, &[])?.not_done("its version")?;
    let ours = contract::PROTOCOL_VERSION.to_string();
    if !other.contains("999") || !other.contains(&ours) {
        return broken(format!("version 999 is answered with `{other}`, not naming both"));
    }
    life.lives_on("a command of another version")?;
    bench.keep_joined(life);
    Seen::kept(message)
}

/// Bodies that are no configuration, no topics and no state file.
const BODIES: [&[u8]; 6] = [b"", b"{", b"[]", b"null", b"{\"role\": 7}", b"\xff\xfe\x00"];

fn malformed(bench: &Bench) -> Result<Seen, Fault> {
    let setting = bench.first()?;
    let mut life = bench.joined()?;
    let mut message = String::new();
    for body in BODIES {
        let shown = format!("the body {:?}", String::from_utf8_lossy(body));
        message = life.ask(Command::new(CommandKind::Configure), body)?.not_done(&shown)?;
    }
    life.lives_on("bodies that are not a configuration")?;
    life.prepare(setting).map_err(|fault| fault.at("after bodies that are not a configuration"))?;
    for kind in [CommandKind::Save, CommandKind::Restore] {
        for body in BODIES {
            let shown = format!("the body {:?}", String::from_utf8_lossy(body));
            life.ask(Command::about(kind, &setting.step(0)), body)?.not_done(&shown)?;
        }
    }
    life.solve_with(&setting.step(0), 0).map_err(|fault| fault.at("after bodies of no sense"))?;
    bench.keep(setting, life);
    // Connect takes what was configured with it, so that a fresh process is asked.
    for body in if bench.quick { &BODIES[..2] } else { &BODIES[..] } {
        let mut life = bench.joined()?;
        life.configure(&setting.configuration)?;
        let shown = format!("the body {:?}", String::from_utf8_lossy(body));
        life.ask(Command::new(CommandKind::Connect), body)?.not_done(&shown)?;
        life.lives_on("a body that is not a list of topics")?;
    }
    Seen::kept(message)
}

fn out_of_order(bench: &Bench) -> Result<Seen, Fault> {
    let setting = bench.first()?;
    let mut life = bench.fresh()?;
    let mut message = String::new();
    let topics = br#"{"inputs": [], "outputs": [], "deadline": 1}"#;
    let state = br#"{"path": "/nonexistent/state"}"#;
    for configured in [false, true] {
        let early: [(CommandKind, &[u8], u32); 4] = [
            (CommandKind::Solve, b"", 0),
            (CommandKind::Accept, b"", OBSERVE),
            (CommandKind::Save, state, 0),
            (CommandKind::Restore, state, 0),
        ];
        for (kind, body, flags) in early {
            let command = Command { flags, ..Command::about(kind, &setting.step(0)) };
            message = life.ask(command, body)?.not_done("its coming too early")?;
        }
        if !configured {
            for kind in [CommandKind::Connect, CommandKind::Initialise] {
                let early = life.ask(Command::new(kind), topics)?;
                early.not_done("its coming before Configure")?;
            }
            life.configure(&setting.configuration)?;
        }
    }
    life.prepare(setting).map_err(|fault| fault.at("after commands out of order"))?;
    life.solve_with(&setting.step(0), 0)?;
    bench.keep(setting, life);
    Seen::kept(message)
}
