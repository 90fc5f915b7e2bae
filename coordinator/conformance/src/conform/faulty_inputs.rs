//! Inputs that do not come, or not as they should.

use super::bench::Bench;
use super::check::Check;
use super::fault::{Fault, Seen, broken};
use super::life::{Feed, Life};
use super::solving::same;
use contract::message::{Command, CommandKind, Label};
use contract::step::Step;

pub(super) const MISSING_SAMPLE: Check = Check {
    name: "missing-sample",
    demand: "a Solve that names a sample which has not come fails, naming the field, and does not \
             wait for it; the next solve goes through",
    fix: "compare the sequence number of the newest sample with that of the command",
    run: missing,
};

pub(super) const WRONG_SAMPLE: Check = Check {
    name: "wrong-sample",
    demand: "a Solve fails, naming the field, if a sample was left out in between, has another name \
             in its label, or another number of values",
    fix: "check the label of every sample that is taken",
    run: wrong,
};

pub(super) const NOT_FINITE: Check = Check {
    name: "not-finite",
    demand: "a NaN or an infinity in an input fails the solve with an error that names the field; the \
             next solve, with good inputs, gives the same bits as before",
    fix: "look through the inputs before using them",
    run: not_finite,
};

const NO_INPUT: &str = "it has no inputs";

/// A failed solve: it names the field, and nothing has been sent.
fn fails(life: &mut Life, step: &Step, (because, field): (&str, &str)) -> Result<String, Fault> {
    let message = life.ask_solve(step)?.not_done(because)?;
    life.none_of_outputs("a solve that failed")?;
    match message.contains(field) {
        true => Ok(message),
        false => {
            broken(format!("{because} in `{field}` fails with: {message}; the field is not named"))
        }
    }
}

fn missing(bench: &Bench) -> Result<Seen, Fault> {
    let setting = bench.first()?;
    if setting.given.is_empty() {
        return Seen::inapplicable(NO_INPUT);
    }
    let mut life = bench.between(setting)?;
    let step = life.next(setting);
    life.feed(&step, 0)?;
    let mut message = String::new();
    for slot in 0..life.inputs.len() {
        let mut command = Command::about(CommandKind::Solve, &step);
        for (slot, feed) in life.inputs.iter().enumerate() {
            command.expected[slot] = feed.header.sequence;
        }
        command.expected[slot] += 1;
        let field = life.inputs[slot].given.kind.name.clone();
        message = life.ask(command, &[])?.not_done("a sample that never came")?;
        if !message.contains(&field) {
            return broken(format!("`{field}` never came, and it fails with: {message}"));
        }
    }
    life.solve(&step).map_err(|fault| fault.at("after a sample that was missing"))?;
    bench.keep(setting, life);
    Seen::kept(message)
}

/// Changes one thing about the next sample.
type Spoil = fn(&mut Feed, &Step) -> Result<(), Fault>;

/// What may be wrong with a sample.
const WRONG: [(&str, Spoil); 3] = [
    ("a gap in the sequence numbers", |feed, step| {
        feed.header.sequence += 1;
        let values = feed.given.values(&feed.grid, 0);
        Ok(feed.send(&values, step)?)
    }),
    ("another name in the label", |feed, step| {
        feed.header.name = Label::new("something_else");
        let values = feed.given.values(&feed.grid, 0);
        Ok(feed.send(&values, step)?)
    }),
    ("one value too many", |feed, step| {
        let mut values = feed.given.values(&feed.grid, 0);
        values.push(0.0);
        Ok(feed.send(&values, step)?)
    }),
];

fn wrong(bench: &Bench) -> Result<Seen, Fault> {
    let setting = bench.first()?;
    if setting.given.is_empty() {
        return Seen::inapplicable(NO_INPUT);
    }
    let mut tried = Vec::new();
    for (because, spoil) in WRONG {
        // Not kept: the samples of the spoilt input are numbered otherwise from here on.
        let mut life = bench.between(setting)?;
        let step = life.next(setting);
        life.solve_with(&step, 0)?;
        for feed in life.inputs.iter_mut().skip(1) {
            let values = feed.given.values(&feed.grid, 0);
            feed.send(&values, &step)?;
        }
        spoil(&mut life.inputs[0], &step)?;
        let field = life.inputs[0].given.kind.name.clone();
        fails(&mut life, &step, (because, &field))?;
        life.lives_on(because)?;
        tried.push(because);
    }
    Seen::kept(tried.join(", "))
}

fn not_finite(bench: &Bench) -> Result<Seen, Fault> {
    bench.each_between(|setting, life| {
        if setting.given.is_empty() {
            return Seen::inapplicable(NO_INPUT);
        }
        let step = life.next(setting);
        let solve = |life: &mut Life| life.solve_with(&step, 0).map(|solved| solved.outputs);
        let first = setting.rewinds.then(|| solve(life)).transpose()?;
        let mut message = String::new();
        for slot in 0..life.inputs.len() {
            let field = life.inputs[slot].given.kind.name.clone();
            for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
                life.feed(&step, 0)?;
                let feed = &mut life.inputs[slot];
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
        Seen::kept(message)
    })
}
