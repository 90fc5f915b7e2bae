//! Checks of faulty inputs and commands: they must fail with a reason, and the participant must
//! survive.

use super::bench::TestBench;
use super::check::Check;
use super::fault::{CheckFailure, Finding, broken};
use super::life::{Feed, TestProcess};
use super::solve::same;
use contract::message::{Command, CommandKind, Label, OBSERVE};
use contract::step::Step;

pub(super) const MISSING_SAMPLE: Check = Check {
    name: "missing-sample",
    demand: "a Solve that names a sample that has not arrived fails, naming the field, and does not \
             wait for it; the next solve succeeds",
    fix: "compare the sequence number of the newest sample with that of the command",
    run: missing,
};

pub(super) const WRONG_SAMPLE: Check = Check {
    name: "wrong-sample",
    demand: "a Solve fails, naming the field, if a sample is missing in the sequence, has another name \
             in its label, or another number of values",
    fix: "check the label of every sample",
    run: wrong,
};

pub(super) const NOT_FINITE: Check = Check {
    name: "not-finite",
    demand: "a NaN or an infinity in an input fails the solve with an error that names the field; the \
             next solve, with good inputs, gives the same bits as before",
    fix: "check all inputs before using them",
    run: not_finite,
};

const NO_INPUT: &str = "it has no inputs";

/// Requires that a solve fails, names the field, and sends nothing.
fn fails(
    life: &mut TestProcess,
    step: &Step,
    (because, field): (&str, &str),
) -> Result<String, CheckFailure> {
    let message = life.ask_solve(step)?.not_done(because)?;
    life.none_of_outputs("a solve that failed")?;
    match message.contains(field) {
        true => Ok(message),
        false => {
            broken(format!("{because} in `{field}` fails with: {message}; the field is not named"))
        }
    }
}

fn missing(bench: &TestBench) -> Result<Finding, CheckFailure> {
    let setting = bench.first()?;
    if setting.sources.is_empty() {
        return Finding::inapplicable(NO_INPUT);
    }
    let mut life = bench.between(setting)?;
    let step = life.next(setting);
    life.feed(&step, 0)?;
    let mut message = String::new();
    for slot in 0..life.ports.inputs.len() {
        let mut command = life.solve_command(&step);
        command.expected[slot] += 1;
        let field = life.ports.inputs[slot].source.kind.name.clone();
        message = life.ask(command, &[])?.not_done("a sample that never arrived")?;
        if !message.contains(&field) {
            return broken(format!("`{field}` never arrived, and it fails with: {message}"));
        }
    }
    life.solve(&step).map_err(|fault| fault.at("after a sample that was missing"))?;
    bench.keep(setting, life);
    Finding::kept(message)
}

/// Spoils the next sample.
type Spoil = fn(&mut Feed, &Step) -> Result<(), CheckFailure>;

/// Faults of a sample.
const WRONG: [(&str, Spoil); 3] = [
    ("a gap in the sequence numbers", |feed, step| {
        feed.header.sequence += 1;
        let values = feed.source.values(&feed.grid, 0);
        Ok(feed.send(&values, step)?)
    }),
    ("another name in the label", |feed, step| {
        feed.header.name = Label::new("something_else");
        let values = feed.source.values(&feed.grid, 0);
        Ok(feed.send(&values, step)?)
    }),
    ("one value too many", |feed, step| {
        let mut values = feed.source.values(&feed.grid, 0);
        values.push(0.0);
        Ok(feed.send(&values, step)?)
    }),
];

fn wrong(bench: &TestBench) -> Result<Finding, CheckFailure> {
    let setting = bench.first()?;
    if setting.sources.is_empty() {
        return Finding::inapplicable(NO_INPUT);
    }
    let mut tried = Vec::new();
    for (because, spoil) in WRONG {
        // The process is not kept, because the samples of the spoilt input are numbered differently
        // from now on.
        let mut life = bench.between(setting)?;
        let step = life.next(setting);
        life.solve_with(&step, 0)?;
        for feed in life.ports.inputs.iter_mut().skip(1) {
            let values = feed.source.values(&feed.grid, 0);
            feed.send(&values, &step)?;
        }
        spoil(&mut life.ports.inputs[0], &step)?;
        let field = life.ports.inputs[0].source.kind.name.clone();
        fails(&mut life, &step, (because, &field))?;
        life.lives_on(because)?;
        tried.push(because);
    }
    Finding::kept(tried.join(", "))
}

fn not_finite(bench: &TestBench) -> Result<Finding, CheckFailure> {
    bench.each_between(|setting, life| {
        if setting.sources.is_empty() {
            return Finding::inapplicable(NO_INPUT);
        }
        let step = life.next(setting);
        let solve = |life: &mut TestProcess| life.solve_with(&step, 0).map(|solved| solved.outputs);
        let first = setting.rewinds.then(|| solve(life)).transpose()?;
        let mut message = String::new();
        for slot in 0..life.ports.inputs.len() {
            let field = life.ports.inputs[slot].source.kind.name.clone();
            for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
                life.feed(&step, 0)?;
                let feed = &mut life.ports.inputs[slot];
                let mut values = feed.values.clone();
                let middle = values.len() / 2;
                values[middle] = value;
                feed.send(&values, &step)?;
                message = fails(life, &step, (&format!("{value}"), &field))?;
            }
            if let Some(first) = &first {
                let after = format!("after NaN and infinities in `{field}`");
                same(&solve(life)?, first, &after)?;
            }
        }
        Finding::kept(message)
    })
}

pub(super) const UNKNOWN_COMMAND: Check = Check {
    name: "unknown-command",
    demand: "a command with an unknown number, or of another version of the contract, fails with a \
             reason, the latter naming both versions; the participant survives",
    fix: "reply to an unknown command with status 1 and {error}",
    run: unknown,
};

pub(super) const MALFORMED: Check = Check {
    name: "malformed",
    demand: "a body that is not JSON, or not of the expected form, fails with a reason; the \
             participant survives and accepts a valid one",
    fix: "parse the bodies of commands before anything changes",
    run: malformed,
};

pub(super) const OUT_OF_ORDER: Check = Check {
    name: "out-of-order",
    demand: "Connect and Initialise before Configure, and Solve, Accept with OBSERVE, Save and \
             Restore before Initialise, fail with a reason; the participant survives and can be configured",
    fix: "keep track of the commands received",
    run: out_of_order,
};

fn unknown(bench: &TestBench) -> Result<Finding, CheckFailure> {
    let mut life = bench.joined()?;
    let mut message = String::new();
    for kind in [0, CommandKind::ALL.len() as u32 + 1, u32::MAX] {
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
    Finding::kept(message)
}

/// Bodies that are neither a configuration, nor topics, nor a state file.
const BODIES: [&[u8]; 6] = [b"", b"{", b"[]", b"null", b"{\"role\": 7}", b"\xff\xfe\x00"];

fn malformed(bench: &TestBench) -> Result<Finding, CheckFailure> {
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
    life.solve_with(&setting.step(0), 0).map_err(|fault| fault.at("after malformed bodies"))?;
    bench.keep(setting, life);
    // Connect uses up the configuration before it, so each body needs a fresh process.
    for body in if bench.quick { &BODIES[..2] } else { &BODIES[..] } {
        let mut life = bench.joined()?;
        life.configure(&setting.configuration)?;
        let shown = format!("the body {:?}", String::from_utf8_lossy(body));
        life.ask(Command::new(CommandKind::Connect), body)?.not_done(&shown)?;
        life.lives_on("a body that is not a list of topics")?;
    }
    Finding::kept(message)
}

fn out_of_order(bench: &TestBench) -> Result<Finding, CheckFailure> {
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
            message = life.ask(command, body)?.not_done("being sent too early")?;
        }
        if !configured {
            for kind in [CommandKind::Connect, CommandKind::Initialise] {
                let early = life.ask(Command::new(kind), topics)?;
                early.not_done("being sent before Configure")?;
            }
            life.configure(&setting.configuration)?;
        }
    }
    life.prepare(setting).map_err(|fault| fault.at("after commands out of order"))?;
    life.solve_with(&setting.step(0), 0)?;
    bench.keep(setting, life);
    Finding::kept(message)
}
