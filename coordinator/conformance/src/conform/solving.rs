//! First outputs, and solves from the accepted state.

use super::bench::Bench;
use super::check::Check;
use super::fault::{Fault, Seen, broken};
use super::life::{Life, Values, difference};
use contract::field::Mapping;
use contract::message::Status;
use contract::step::Step;

pub(super) const INITIALISE: Check = Check {
    name: "initialise",
    demand: "Initialise publishes one sample of every output, before its reply, with iteration 0 and \
             every entry of the label; all values finite; no observed field",
    fix: "the label of a sample, field by field; write every value of a loan",
    run: initialise,
};

pub(super) const SOLVE: Check = Check {
    name: "solve",
    demand: "Solve publishes one sample of every output, before its reply, labelled with window, \
             iteration, interval and the next sequence number; values and report are finite",
    fix: "take window, iteration, start and end from the command",
    run: solve,
};

pub(super) const HEAT: Check = Check {
    name: "heat-received",
    demand: "heat_received is the surface integral of the conservative inputs, to 1e-10",
    fix: "sum of value times element area, over all elements of the grid it arrives on",
    run: heat,
};

pub(super) const REPEAT: Check = Check {
    name: "repeat",
    demand: "a window solved again gives the same bits with the same inputs, also after a solve with \
             others in between: a solve starts from the accepted state",
    fix: "what a solve changes must not be read by the next one unless it was accepted",
    run: repeat,
};

pub(super) const OTHER_END: Check = Check {
    name: "other-end",
    demand: "a window may be solved again with another end, and with the first end again \
             bit-identically",
    fix: "what is kept for the length of a window has to follow it",
    run: other_end,
};

pub(super) const NO_DURATION: Check = Check {
    name: "no-duration",
    demand: "a transient window that ends where it starts is solved or fails with a reason; the next \
             one is solved to the same bits as without",
    fix: "divisions by the length of the window",
    run: no_duration,
};

/// What the heat that is received may differ from the integral, relative to the integral of the
/// magnitude: rounding of two sums of up to a million terms, in any order.
const HEAT_TOLERANCE: f64 = 1e-10;

fn initialise(bench: &Bench) -> Result<Seen, Fault> {
    bench.each(|setting| {
        let mut life = bench.joined()?;
        let (_, first) = life.prepare(setting)?;
        bench.keep(setting, life);
        Seen::kept(listed(&first))
    })
}

/// Names and numbers of values.
fn listed(fields: &Values) -> String {
    let one = |(name, values): &(String, Vec<f64>)| format!("{name} ({})", values.len());
    match fields.is_empty() {
        true => "no output in every iteration".to_owned(),
        false => fields.iter().map(one).collect::<Vec<_>>().join(", "),
    }
}

fn solve(bench: &Bench) -> Result<Seen, Fault> {
    bench.each_between(|setting, life| {
        for variation in [0, 1, 2] {
            let step = life.next(setting);
            let step = Step { iteration: step.iteration + variation, ..step };
            let solved = life.solve_with(&step, variation)?;
            if let Some(fault) = solved.reply.fault() {
                return broken(fault);
            }
            if !setting.is_transient() {
                break;
            }
            life.accept(&step, false)?;
        }
        Seen::kept(match setting.is_transient() {
            true => "three windows",
            false => "one window",
        })
    })
}

fn heat(bench: &Bench) -> Result<Seen, Fault> {
    bench.each_between(|setting, life| {
        let conservative = |life: &Life| {
            let fields =
                life.inputs.iter().filter(|f| f.given.kind.mapping == Mapping::Conservative);
            fields.map(|f| (f.grid.integrate(&f.values), f.values.clone())).collect::<Vec<_>>()
        };
        let step = life.next(setting);
        life.feed(&step, 0)?;
        if conservative(life).is_empty() {
            return Seen::inapplicable("it has no conservative input");
        }
        let solved = life.solve(&step)?;
        let received = solved.reply.heat_received;
        if received.is_nan() {
            return Seen::inapplicable("it reports no heat_received");
        }
        let sent: f64 = conservative(life).iter().map(|(heat, _)| heat).sum();
        let off = (received - sent).abs();
        if off > HEAT_TOLERANCE * sent.abs() {
            return broken(format!("heat_received is {received:e} W, the integral {sent:e} W"));
        }
        Seen::kept(format!("{sent:.4e} W, to {:.0e}", off / sent.abs()))
    })
}

fn repeat(bench: &Bench) -> Result<Seen, Fault> {
    bench.each_rewinding_between(|setting, life| {
        let mut step = life.next(setting);
        if setting.is_transient() {
            life.solve_with(&step, 1)?;
            life.accept(&step, false)?;
            step = life.next(setting);
        }
        let next = step;
        let first = life.solve_with(&step, 0)?.outputs;
        let mut again = |life: &mut Life, why: &str| -> Result<(), Fault> {
            step.iteration += 1;
            same(&life.solve(&step)?.outputs, &first, why)
        };
        // The same sample once more, a new one of the same values, and one after others.
        again(life, "solved again with the same samples")?;
        life.feed(&next, 0)?;
        again(life, "solved again with the same values")?;
        if !life.inputs.is_empty() {
            life.solve_with(&Step { iteration: 9, ..next }, 2)?;
            life.feed(&next, 0)?;
            again(life, "solved again after a solve with other inputs")?;
        }
        // Fields that nobody consumes come with Accept alone: those of a process that has solved its first
        // window several times, and of one that has solved it once.
        let mut life = bench.ready(setting)?;
        let step = setting.step(0);
        life.solve_with(&step, 0)?;
        life.solve_with(&Step { iteration: 2, ..step }, 2)?;
        let found = life.published(&Step { iteration: 3, ..step }, 0)?;
        same(&found, &bench.reference(setting)?.first, "accepted after several solves")?;
        compared(
            &found,
            match life.inputs.is_empty() {
                true => "the same bits (it has no inputs to vary)",
                false => "the same bits, also after a solve with other inputs",
            },
        )
    })
}

/// The words for a comparison that was passed, with the number of values. A comparison of nothing shows
/// nothing.
pub(super) fn compared(values: &Values, words: &str) -> Result<Seen, Fault> {
    match values.iter().map(|(_, values)| values.len()).sum::<usize>() {
        0 => Seen::inapplicable("it publishes no field in this case: nothing was compared"),
        count => Seen::kept(format!("{words} ({count} values)")),
    }
}

/// The bits of two solves are the same.
pub(super) fn same(found: &Values, expected: &Values, why: &str) -> Result<(), Fault> {
    match difference(found, expected) {
        None => Ok(()),
        Some(difference) => broken(format!("{why}: {difference}")),
    }
}

fn other_end(bench: &Bench) -> Result<Seen, Fault> {
    bench.each_rewinding(|setting| {
        if !setting.is_transient() {
            return Seen::inapplicable("no transient setting");
        }
        let whole = setting.step(0);
        let half = Step { end: 0.5 * (whole.start + whole.end), ..whole };
        let shorter = bench.ready(setting)?.published(&half, 0)?;
        let mut life = bench.ready(setting)?;
        let first = life.solve_with(&whole, 0)?.outputs;
        life.solve_with(&half, 0)?;
        let again = life.solve_with(&whole, 0)?.outputs;
        same(&again, &first, "solved with its first end after another one")?;
        let found = life.published(&half, 0)?;
        same(&found, &shorter, "solved with its second end again")?;
        life.solve_with(&setting.after(&half), 0)?;
        bench.keep(setting, life);
        compared(
            &found,
            "half as long and back to the same bits; the next window begins at the new end",
        )
    })
}

fn no_duration(bench: &Bench) -> Result<Seen, Fault> {
    bench.each_rewinding(|setting| {
        if !setting.is_transient() {
            return Seen::inapplicable("no transient setting");
        }
        let mut life = bench.ready(setting)?;
        let step = setting.step(0);
        let empty = Step { end: step.start, ..step };
        life.feed(&empty, 0)?;
        let answer = life.ask_solve(&empty)?;
        let seen = if answer.status == Status::Done {
            life.collect(&empty)?;
            "it is solved".to_owned()
        } else {
            life.none_of_outputs("a solve that failed")?;
            answer.not_done("a window without duration")?
        };
        let found = life.published(&step, 0)?;
        bench.keep(setting, life);
        same(&found, &bench.reference(setting)?.first, "the next window")?;
        compared(&found, &seen)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A comparison of no values passed as "the same bits".
    #[test]
    fn what_compared_nothing_does_not_pass() {
        for nothing in [vec![], vec![("temperature".to_owned(), vec![])]] {
            let seen = compared(&nothing, "the same bits").unwrap();
            assert!(
                matches!(seen, Seen::Inapplicable(why) if why.contains("nothing was compared"))
            );
        }
        let one = vec![("temperature".to_owned(), vec![1.0, 2.0])];
        let kept = Seen::Kept("the same bits (2 values)".to_owned());
        assert_eq!(compared(&one, "the same bits").unwrap(), kept);
    }
}
