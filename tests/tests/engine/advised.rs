//! Advice of `plan --advise` in scenes over time, against runs with and without each effect.

use crate::harness::{Place, case, planned, sets, solvers};
use contract::advice::Advice;
use run::advice::ask;
use serde_json::Value;

/// Value of a figure in a summary.
fn figure(summary: &Value, key: &str) -> Option<f64> {
    summary.pointer(&format!("/{}", key.replace('.', "/"))).and_then(Value::as_f64)
}

/// Runs a case, unless it is refused.
fn summary(file: &str, changes: &[&str]) -> Option<Value> {
    let place = Place::new();
    let ended = place.run(file, changes);
    match ended.code {
        Some(0) => Some(place.read_summary()),
        _ => {
            println!("      refused: {}", ended.stderr.lines().next().unwrap_or_default());
            None
        }
    }
}

fn explore(name: &str, settings: &[&str]) {
    let file = case(name);
    let changes = sets(settings);
    let standing = planned(&file, &changes, &solvers()).unwrap_or_else(|e| panic!("{e}"));
    let advice: Vec<Advice> = ask(&standing).unwrap_or_else(|e| panic!("{e}"));
    println!("== {name} {settings:?}");
    let whole = summary(&file, &changes).unwrap();
    for one in advice {
        let active = standing.case.effects.contains(&one.effect);
        let mut other = changes.clone();
        let unset = format!("effects.{}", one.effect);
        if active {
            other.extend(["--unset", &unset]);
        } else {
            if one.set.is_empty() {
                continue;
            }
            for set in &one.set {
                other.extend(["--set", set]);
            }
        }
        let Some(change) = &one.change else { continue };
        let Some(toggled) = summary(&file, &other) else {
            println!("   {:22} {:?} {:.4} refused", one.effect, change.figure, change.relative);
            continue;
        };
        let (with, without) = if active { (&whole, &toggled) } else { (&toggled, &whole) };
        let found = match (figure(with, &change.figure), figure(without, &change.figure)) {
            (Some(a), Some(b)) => (a.abs() / b.abs()) - 1.0,
            _ => f64::NAN,
        };
        println!(
            "   {:22} {} {:.4} said {found:.4} found; {}",
            one.effect, change.figure, change.relative, one.why
        );
    }
}

const HALF: &[&str] = &["mech.model=half-space", "mech.resolution=8"];

#[test]
fn explore_all() {
    let disc: &[&str] = &[
        "time.mode=transient",
        "time.window=\"1 ms\"",
        "time.end=\"10 ms\"",
        "thermal.model=moving-source",
    ];
    let locked: &[&str] = &[
        "bodies.driver.surface_speed=0",
        "bodies.follower.surface_speed=1",
        "effects.friction_heat.partition=continuity",
    ];
    for (name, more) in [
        ("pin-on-disc.toml", vec![]),
        ("pin-on-disc.toml", vec!["effects.friction_heat.partition=equal"]),
        ("pin-on-disc.toml", vec!["thermal.model=fe"]),
        ("pin-on-disc.toml", vec!["thermal.model=fe", "effects.friction_heat.partition=equal"]),
        (
            "pin-on-disc.toml",
            vec![
                "bodies.disc.surface_speed=5",
                "load.normal_force=30",
                "time.window=\"40 us\"",
                "time.end=\"800 us\"",
            ],
        ),
        ("locked-wheel.toml", vec![]),
        ("locked-wheel.toml", vec!["effects.friction_heat.partition=equal"]),
        ("locked-wheel.toml", vec!["thermal.model=fe"]),
        ("locked-wheel.toml", vec!["friction.coefficient=0.3"]),
        ("twin-disc.toml", disc.to_vec()),
        ("twin-disc.toml", [disc, locked].concat()),
    ] {
        explore(name, &[HALF, &more].concat());
    }
}
