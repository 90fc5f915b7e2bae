//! Checks of heartbeats, figures, reuse of the process, and the end.

use super::bench::TestBench;
use super::check::Check;
use super::fault::{CheckFailure, Finding, broken, late};
use super::life::TestProcess;
use super::setting::Setting;
use super::solve::{largest, same};
use contract::figure::value;
use contract::message::{Command, CommandKind, Finished, read_figures};
use serde_json::Value;
use std::time::{Duration, Instant};

pub(super) const HEART: Check = Check {
    name: "heart",
    demand: "from joining on there is a heartbeat on bell/coordinator, every few hundred milliseconds, \
             in mid-solve too",
    fix: "beat from a thread or process of its own that no solve holds up",
    run: heart,
};

pub(super) const COORDINATOR_DIES: Check = Check {
    name: "coordinator-dies",
    demand: "when coordinator.lock is free the participant ends within 2 s, in mid-solve too, and \
             the last one removes the run's folder and its shared memory",
    fix: "try the lock wherever the heartbeat comes from; clean up when members.lock is free",
    run: coordinator_dies,
};

pub(super) const FINISH: Check = Check {
    name: "finish",
    demand: "Finish is answered with {summary, model_seconds}, the summary an object \
             with finite numbers; the process ends with exit code 0 within 2 s and leaves nothing",
    fix: "numbers that are not finite become null in JSON: leave them out",
    run: finish,
};

pub(super) const REUSE: Check = Check {
    name: "reuse",
    demand: "after Finish with STAY the process takes part in another run, on other grids and in other \
             settings: a window has the bits of a new process, whatever the run before",
    fix: "begin anew with every Configure, close the ports of the run with Finish; or describe \
          `\"reusable\": false`",
    run: reuse,
};

/// Duration of listening for heartbeats of an idle participant.
const IDLE: Duration = Duration::from_millis(1500);
/// Numbers of elements of a small grid.
const SMALL: [usize; 2] = [8, 6];
/// Longest silence that is no fault: a few hundred milliseconds, and a margin for a busy machine.
const SILENCE: Duration = Duration::from_secs(1);

/// Returns the longest time between two heartbeats from `since` on.
fn silence(life: &mut TestProcess, since: Instant) -> Duration {
    let beats = std::mem::take(&mut life.beats);
    let (mut last, mut longest) = (since, Duration::ZERO);
    for beat in beats.into_iter().chain([Instant::now()]).filter(|beat| *beat >= since) {
        longest = longest.max(beat - last);
        last = beat;
    }
    longest
}

fn quick_enough(silence: Duration, place: &str) -> Result<(), CheckFailure> {
    match silence > SILENCE {
        true => late(format!("no heartbeat for {:.2} s {place}", silence.as_secs_f64())),
        false => Ok(()),
    }
}

fn heart(bench: &TestBench) -> Result<Finding, CheckFailure> {
    let mut life = bench.joined()?;
    let since = Instant::now();
    life.listen(IDLE)?;
    let idle = silence(&mut life, since);
    bench.keep_joined(life);
    quick_enough(idle, "while idle")?;
    let mut longest = (Duration::ZERO, Duration::ZERO);
    for setting in &bench.settings {
        let setting = setting.resized(largest(bench)).unwrap_or_else(|| setting.clone());
        let mut life = bench.ready(&setting)?;
        let step = setting.step(0);
        life.feed(&step, 0)?;
        let since = Instant::now();
        life.solve(&step)?;
        let (took, silent) = (since.elapsed(), silence(&mut life, since));
        quick_enough(silent, &format!("in a solve of {}", setting.label()))?;
        longest = longest.max((took, silent));
    }
    let ms = |time: Duration| 1e3 * time.as_secs_f64();
    Finding::kept(format!(
        "silent for {:.0} ms at most while idle, {:.0} ms in a solve of {:.0} ms",
        ms(idle),
        ms(longest.1),
        ms(longest.0)
    ))
}

fn reuse(bench: &TestBench) -> Result<Finding, CheckFailure> {
    if !bench.subject.description.reusable {
        return Finding::inapplicable("it describes itself as not reusable");
    }
    let smaller = bench.settings.iter().take(1).filter_map(|setting| setting.resized(SMALL));
    let settings: Vec<Setting> = bench.settings.iter().cloned().chain(smaller).collect();
    let mut life = bench.joined()?;
    // Every setting runs once after each of its neighbours, and the last one after itself.
    for setting in settings.iter().chain(settings.iter().rev()) {
        life.prepare(setting)?;
        let found = life.published(&setting.step(0), 0)?;
        let why = || format!("{}, after another run of the process", setting.label());
        same(&found, &bench.reference(setting)?.first, &why())?;
        life.rest()?;
    }
    bench.keep_joined(life);
    Finding::kept(format!("{} runs of one process", 2 * settings.len()))
}

fn coordinator_dies(bench: &TestBench) -> Result<Finding, CheckFailure> {
    let idle = bench.joined()?.abandon().ends().map_err(|fault| fault.at("while idle"))?;
    let setting = bench.first()?;
    let setting = setting.resized(largest(bench)).unwrap_or_else(|| setting.clone());
    let mut life = bench.ready(&setting)?;
    life.feed(&setting.step(0), 0)?;
    life.post_solve(&setting.step(0))?;
    let solving = life.abandon().ends().map_err(|fault| fault.at("in a solve"))?;
    let ms = |time: Duration| 1e3 * time.as_secs_f64();
    Finding::kept(format!("it ends in {:.0} ms, {:.0} ms in a solve", ms(idle), ms(solving)))
}

pub(super) const FIGURES: Check = Check {
    name: "figures",
    demand: "Accept with FIGURES is answered with a byte and a double for every key of `figures` \
             in Connect, in their order: 1 and the value in the summary at that time, or 0 and 0",
    fix: "flag bit 1 of the command; whether the figure exists, and its value in the summary",
    run: figures,
};

fn figures(bench: &TestBench) -> Result<Finding, CheckFailure> {
    bench.each(|setting| {
        let keys = &setting.figures;
        if keys.is_empty() {
            return Finding::inapplicable("it describes no figures");
        }
        let mut life = bench.between(setting)?;
        let step = life.next(setting);
        life.solve_with(&step, 0)?;
        let body = life.accept_with_figures(&step)?;
        let summary = end(life, true)?;
        let mut given = vec![None; keys.len()];
        read_figures(&body, &mut given).or_else(broken)?;
        for (key, given) in keys.iter().zip(given) {
            let expected = value(&summary, key);
            if expected.map(f64::to_bits) != given.map(f64::to_bits) {
                let text = |value: Option<f64>| value.map_or("absent".into(), |v| format!("{v:e}"));
                let (given, expected) = (text(given), text(expected));
                return broken(format!("`{key}` is {given} instead of {expected}"));
            }
        }
        Finding::kept(format!("{} figures", keys.len() - 1))
    })
}

fn finish(bench: &TestBench) -> Result<Finding, CheckFailure> {
    let mut before = bench.fresh()?;
    before.lives_on("joining")?;
    end(before, false).map_err(|fault| fault.at("before it is configured"))?;
    bench.each(|setting| {
        let mut life = bench.between(setting)?;
        let step = life.next(setting);
        life.solve_with(&step, 0)?;
        life.accept(&step, false)?;
        let summary = end(life, true)?;
        let sections = summary.as_object().into_iter().flatten().map(|(key, _)| key.as_str());
        Finding::kept(match sections.collect::<Vec<_>>().join(", ") {
            none if none.is_empty() => "an empty summary, exit code 0".to_owned(),
            sections => format!("summary of {sections}; exit code 0"),
        })
    })
}

/// Ends the process and returns its summary.
fn end(mut life: TestProcess, ran: bool) -> Result<Value, CheckFailure> {
    let answer = life.ask(Command::new(CommandKind::Finish), &[])?.done()?;
    let finished: Finished = answer.json("a summary")?;
    if ran && !finished.summary.is_object() {
        return broken(format!("its summary is not an object: {}", finished.summary));
    }
    if let Some(key) = null_in(&finished.summary, String::new()).filter(|_| ran) {
        return broken(format!("`{key}` of its summary is null: a number that is not finite"));
    }
    if !(finished.model_seconds.is_finite() && finished.model_seconds >= 0.0) {
        return broken(format!("model_seconds is {}", finished.model_seconds));
    }
    let exit = life.leave("Finish")?;
    match exit.is_success() {
        true => Ok(finished.summary),
        false => broken(format!("after Finish its process {}", exit)),
    }
}

/// Returns the key of the first null, which stands for a number that is not finite in JSON.
fn null_in(value: &Value, key: String) -> Option<String> {
    let under = |name: &str| if key.is_empty() { name.to_owned() } else { format!("{key}.{name}") };
    match value {
        Value::Null => Some(key),
        Value::Object(table) => table.iter().find_map(|(name, value)| null_in(value, under(name))),
        Value::Array(list) => {
            list.iter().enumerate().find_map(|(at, value)| null_in(value, under(&at.to_string())))
        }
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_that_is_not_finite_is_found() {
        let summary = serde_json::json!({"a": {"b": [1.0, null]}, "c": 2.0});
        assert_eq!(null_in(&summary, String::new()), Some("a.b.1".to_owned()));
        assert_eq!(null_in(&serde_json::json!({"a": [1.0]}), String::new()), None);
    }
}
