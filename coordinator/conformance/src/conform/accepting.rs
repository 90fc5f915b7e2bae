//! What Accept does, and what it publishes.

use super::bench::Bench;
use super::check::Check;
use super::fault::{Fault, Seen};
use super::solving::{compared, same};

pub(super) const ACCEPT: Check = Check {
    name: "accept",
    demand: "Accept without a flag has no reply, unless the geometry of a grid travels, and publishes \
             no field; the next window starts from what was solved last, and from nothing else",
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

fn accept(bench: &Bench) -> Result<Seen, Fault> {
    bench.each_rewinding(|setting| {
        let expected = bench.reference(setting)?;
        let mut life = bench.ready(setting)?;
        let step = setting.step(0);
        // It has solved the window with other inputs before.
        life.solve_with(&step, 2)?;
        life.solve_with(&step, 0)?;
        life.accept(&step, false)?;
        let found = life.published(&life.next(setting), 1)?;
        same(&found, &expected.second, "after an iteration that was not the last")?;
        compared(&found, "nothing published; the next solve starts from it")
    })
}

fn observe(bench: &Bench) -> Result<Seen, Fault> {
    bench.each(|setting| {
        let names = &setting.configuration.observed;
        let mut life = bench.ready(setting)?;
        let step = setting.step(0);
        life.solve_with(&step, 0)?;
        let seen = life.accept(&step, true)?;
        let next = setting.after(&step);
        let found = life.published(&next, 1)?;
        // To observe must not change what is solved.
        let unobserved = bench.reference(setting)?;
        same(&found, &unobserved.second, "observing changes the next solve")?;
        match seen.is_empty() {
            true => Seen::inapplicable("it has no field that nobody consumes"),
            false => Seen::kept(names.join(", ")),
        }
    })
}
