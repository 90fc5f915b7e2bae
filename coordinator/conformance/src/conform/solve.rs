//! Checks of first outputs, of solves from the accepted state on grids of any size, and of the
//! effects of `Accept`.

use super::bench::TestBench;
use super::check::Check;
use super::fault::{CheckFailure, Finding, broken};
use super::life::{TestProcess, Values, difference};
use contract::field::FieldKind;
use contract::grid::Grid;
use contract::message::Status;
use contract::step::Step;
use run::format::{number, quantity};

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

pub(super) const RECEIVED_POWER: Check = Check {
    name: "received-power",
    demand: "received_power is the surface integral of the conservative inputs of one component \
             (powers, not forces), to 1e-10 of the integral of their magnitudes",
    fix: "sum of value times element area, over all elements of the grid it arrives on",
    run: received_power,
};

pub(super) const REPEAT: Check = Check {
    name: "repeat",
    demand: "a window solved again gives the same bits with the same inputs, even after a solve with \
             others in between: a solve starts from the accepted state",
    fix: "a solve must not read data of an earlier solve that was not accepted",
    run: repeat,
};

pub(super) const OTHER_END: Check = Check {
    name: "other-end",
    demand: "a window may be solved again with another end, and with the first end again \
             bit-identically",
    fix: "data that depend on the length of a window must follow it",
    run: other_end,
};

pub(super) const NO_DURATION: Check = Check {
    name: "no-duration",
    demand: "a transient window that ends where it starts is solved, or fails with a reason; the next \
             window has the same bits as without it",
    fix: "divisions by the length of the window",
    run: no_duration,
};

/// Largest difference between the received power and the integral, relative to the integral of the
/// magnitudes. Covers rounding of two sums of up to a million terms, in any order.
const POWER_TOLERANCE: f64 = 1e-10;

fn initialise(bench: &TestBench) -> Result<Finding, CheckFailure> {
    bench.each(|setting| {
        let mut life = bench.joined()?;
        let (_, first) = life.prepare(setting)?;
        bench.keep(setting, life);
        Finding::kept(listed(&first))
    })
}

/// Returns the names of the fields with their numbers of values.
fn listed(fields: &Values) -> String {
    let one = |(name, values): &(String, Vec<f64>)| format!("{name} ({})", values.len());
    match fields.is_empty() {
        true => "no output in every iteration".to_owned(),
        false => fields.iter().map(one).collect::<Vec<_>>().join(", "),
    }
}

fn solve(bench: &TestBench) -> Result<Finding, CheckFailure> {
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
        Finding::kept(match setting.is_transient() {
            true => "three windows",
            false => "one window",
        })
    })
}

fn received_power(bench: &TestBench) -> Result<Finding, CheckFailure> {
    bench.each_between(|setting, life| {
        let step = life.next(setting);
        life.feed(&step, 0)?;
        if !life.ports.inputs.iter().any(|input| input.source.kind.is_power()) {
            return Finding::inapplicable("it has no conservative input of one component");
        }
        let solved = life.solve(&step)?;
        let Some(received) = solved.reply.received_power() else {
            return Finding::inapplicable("it reports no received_power");
        };
        let inputs = &life.ports.inputs;
        let [sent, magnitude] =
            power(inputs.iter().map(|input| (&input.source.kind, &input.grid, &*input.values)));
        let off = (received - sent).abs();
        if off > POWER_TOLERANCE * magnitude {
            return broken(format!("received_power is {received:e} W, the integral {sent:e} W"));
        }
        let relative = if off == 0.0 { 0.0 } else { off / magnitude };
        Finding::kept(format!(
            "{sent}, to {relative}",
            sent = quantity(sent, "W", 5),
            relative = number(relative, 1)
        ))
    })
}

/// Returns the surface integral of all powers, and that of their magnitudes [W].
fn power<'a>(inputs: impl Iterator<Item = (&'a FieldKind, &'a Grid, &'a [f64])>) -> [f64; 2] {
    inputs.filter(|(kind, ..)| kind.is_power()).fold([0.0; 2], |[sum, sizes], (_, grid, values)| {
        let magnitudes: Vec<f64> = values.iter().map(|value| value.abs()).collect();
        [sum + grid.integrate(values), sizes + grid.integrate(&magnitudes)]
    })
}

fn repeat(bench: &TestBench) -> Result<Finding, CheckFailure> {
    bench.each_rewinding_between(|setting, life| {
        let mut step = life.next(setting);
        if setting.is_transient() {
            life.solve_with(&step, 1)?;
            life.accept(&step, false)?;
            step = life.next(setting);
        }
        let next = step;
        let first = life.solve_with(&step, 0)?.outputs;
        let mut again = |life: &mut TestProcess, why: &str| -> Result<(), CheckFailure> {
            step.iteration += 1;
            same(&life.solve(&step)?.outputs, &first, why)
        };
        // Solves with the same samples, with new samples of the same values, and after a solve with
        // others.
        again(life, "solved again with the same samples")?;
        life.feed(&next, 0)?;
        again(life, "solved again with the same values")?;
        if !life.ports.inputs.is_empty() {
            life.solve_with(&Step { iteration: 9, ..next }, 2)?;
            life.feed(&next, 0)?;
            again(life, "solved again after a solve with other inputs")?;
        }
        // Fields without a consumer are sent only at Accept. Compares a process that has solved its
        // first window several times with one that has solved it once.
        let mut life = bench.ready(setting)?;
        let step = setting.step(0);
        life.solve_with(&step, 0)?;
        life.solve_with(&Step { iteration: 2, ..step }, 2)?;
        let found = life.published(&Step { iteration: 3, ..step }, 0)?;
        same(&found, &bench.reference(setting)?.first, "accepted after several solves")?;
        compared(
            &found,
            match life.ports.inputs.is_empty() {
                true => "the same bits (it has no inputs to vary)",
                false => "the same bits, also after a solve with other inputs",
            },
        )
    })
}

/// Returns the finding of a successful comparison, with the number of values. A comparison of no
/// values is inapplicable.
pub(super) fn compared(values: &Values, words: &str) -> Result<Finding, CheckFailure> {
    match values.iter().map(|(_, values)| values.len()).sum::<usize>() {
        0 => Finding::inapplicable("it publishes no field in this case: nothing was compared"),
        count => Finding::kept(format!("{words} ({count} values)")),
    }
}

/// Requires that two solves are bit-identical.
pub(super) fn same(found: &Values, expected: &Values, why: &str) -> Result<(), CheckFailure> {
    match difference(found, expected) {
        None => Ok(()),
        Some(difference) => broken(format!("{why}: {difference}")),
    }
}

fn other_end(bench: &TestBench) -> Result<Finding, CheckFailure> {
    bench.each_rewinding(|setting| {
        if !setting.is_transient() {
            return Finding::inapplicable("no transient setting");
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

fn no_duration(bench: &TestBench) -> Result<Finding, CheckFailure> {
    bench.each_rewinding(|setting| {
        if !setting.is_transient() {
            return Finding::inapplicable("no transient setting");
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

pub(super) const ACCEPT: Check = Check {
    name: "accept",
    demand: "Accept is answered; without a flag it publishes no field; the next window starts from \
             the last solve only",
    fix: "the flags of the command; a second state beside the accepted one",
    run: accept,
};

pub(super) const OBSERVE: Check = Check {
    name: "observe",
    demand: "Accept with OBSERVE publishes one sample of every observed field, labelled with the \
             accepted step, before its reply; they come at no other time",
    fix: "observed fields of the accepted state",
    run: observe,
};

fn accept(bench: &TestBench) -> Result<Finding, CheckFailure> {
    bench.each_rewinding(|setting| {
        let expected = bench.reference(setting)?;
        let mut life = bench.ready(setting)?;
        let step = setting.step(0);
        // The process has solved the window with other inputs before.
        life.solve_with(&step, 2)?;
        life.solve_with(&step, 0)?;
        life.accept(&step, false)?;
        let found = life.published(&life.next(setting), 1)?;
        same(&found, &expected.second, "after an iteration that was not the last")?;
        compared(&found, "nothing published; the next solve starts from it")
    })
}

fn observe(bench: &TestBench) -> Result<Finding, CheckFailure> {
    bench.each(|setting| {
        let names = &setting.configuration.observed;
        let mut life = bench.ready(setting)?;
        let step = setting.step(0);
        life.solve_with(&step, 0)?;
        let seen = life.accept(&step, true)?;
        let next = setting.after(&step);
        let found = life.published(&next, 1)?;
        // Observing must not change the next solve.
        let unobserved = bench.reference(setting)?;
        same(&found, &unobserved.second, "observing changes the next solve")?;
        match seen.is_empty() {
            true => Finding::inapplicable("it has no field without a consumer"),
            false => Finding::kept(names.join(", ")),
        }
    })
}

pub(super) const GROWING_GRIDS: Check = Check {
    name: "growing-grids",
    demand: "inputs on grids from 8 x 6 to 512 x 384 elements all work; outputs have the sizes of the \
             layout",
    fix: "sizes come from the configuration; nothing has a fixed length",
    run: growing,
};

/// Numbers of elements of the grids over the patch of the case.
const SIZES: [[usize; 2]; 4] = [[8, 6], [32, 24], [128, 96], [512, 384]];

/// Returns the sizes that this bench checks.
fn sizes(bench: &TestBench) -> &'static [[usize; 2]] {
    if bench.quick { &SIZES[..2] } else { &SIZES }
}

/// Returns the largest size that this bench checks.
pub(super) fn largest(bench: &TestBench) -> [usize; 2] {
    sizes(bench)[sizes(bench).len() - 1]
}

// Missing here: a check of a grid that moves during a run, with the same numbers of elements and a
// new geometry for every window.

fn growing(bench: &TestBench) -> Result<Finding, CheckFailure> {
    bench.each(|setting| {
        let mut points = Vec::new();
        for &size in sizes(bench) {
            let Some(setting) = setting.resized(size) else {
                return Finding::inapplicable("no input has a grid that can be refined");
            };
            let place = format!("{} x {} elements", size[0], size[1]);
            let mut life = bench.joined()?;
            // The sizes of outputs are compared with the layout whenever a sample is received.
            let (layout, _) = life.prepare(&setting).map_err(|fault| fault.at(&place))?;
            let step = setting.step(0);
            let mut solve = || life.solve_with(&step, 0).map_err(|fault| fault.at(&place));
            let first = solve()?.outputs;
            if setting.rewinds && size == largest(bench) {
                same(&solve()?.outputs, &first, &place)?;
            }
            points.push(layout.grids.iter().map(contract::grid::Grid::points).sum::<usize>());
        }
        let points: Vec<String> = points.iter().map(usize::to_string).collect();
        Finding::kept(format!("own grids of {} points", points.join(", ")))
    })
}

pub(super) const VOLUMES: Check = Check {
    name: "volumes",
    demand: "Initialise publishes the geometry of every volume that a field of the run is on, before \
             its reply: rising axes or vertices that exist, elements with a positive volume; fields \
             on it name its revision",
    fix: "the layout of the geometry, component by component; corners in VTK's order",
    run: volumes,
};

fn volumes(bench: &TestBench) -> Result<Finding, CheckFailure> {
    bench.each(|setting| {
        let mut life = bench.ready(setting)?;
        let step = life.next(setting);
        life.solve_with(&step, 0)?;
        life.accept(&step, true)?;
        let seen: Vec<String> = life
            .volumes()
            .map(|grid| format!("{} ({} elements)", grid.name, grid.points()))
            .collect();
        bench.keep(setting, life);
        match seen.is_empty() {
            true => Finding::inapplicable("it has no field on a volume"),
            false => Finding::kept(seen.join(", ")),
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use contract::field::Mapping;
    use contract::grid::Structured;

    /// A comparison of no values must not pass as "the same bits".
    #[test]
    fn what_compared_nothing_does_not_pass() {
        for nothing in [vec![], vec![("temperature".to_owned(), vec![])]] {
            let seen = compared(&nothing, "the same bits").unwrap();
            assert!(
                matches!(seen, Finding::Inapplicable(why) if why.contains("nothing was compared"))
            );
        }
        let one = vec![("temperature".to_owned(), vec![1.0, 2.0])];
        let kept = Finding::Kept("the same bits (2 values)".to_owned());
        assert_eq!(compared(&one, "the same bits").unwrap(), kept);
    }

    /// A force is no power, and powers of both signs are compared with their magnitudes: the sum
    /// may be zero.
    #[test]
    fn only_powers_are_counted() {
        let grid = Grid::structured("g", Structured::contact_plane(0.0, 0.0, 0.5, 1.0, 2, 1));
        let kind = |components, mapping| FieldKind {
            components,
            mapping,
            ..contract::field::TABLE[0].kind()
        };
        let power_kind = kind(1, Mapping::Conservative);
        let [force, temperature] = [kind(2, Mapping::Conservative), kind(1, Mapping::Consistent)];
        let inputs: [(&FieldKind, &Grid, &[f64]); 3] = [
            (&power_kind, &grid, &[3.0, -3.0]),
            (&force, &grid, &[1e6, 1e6, 0.0, 0.0]),
            (&temperature, &grid, &[300.0, 300.0]),
        ];
        assert_eq!(power(inputs.into_iter()), [0.0, 3.0]);
    }
}
