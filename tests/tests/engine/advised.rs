//! Advice of `plan --advise` in scenes over time, against runs with and without each effect: a pin,
//! a disc of 47 mm and a wheel, in which either body is the hot one.

use crate::harness::{Place, case, fleet, planned, sets};
use contract::advice::{Advice, Change, SIGNIFICANT_CHANGE};
use run::advice::ask;
use serde_json::Value;

/// Factor within which estimates of first order agree with a run, as in `coordinator ablate`.
const FACTOR: f64 = 3.0;

/// A slow disc at a creepage of 1 %, and a locked one.
const ROLLS: &[&str] =
    &["time.mode=transient", "time.window=1e-3", "time.end=10e-3", "thermal.model=moving-source"];
const SLIDES: &[&str] = &[
    "time.mode=transient",
    "time.window=1e-4",
    "time.end=2e-3",
    "thermal.model=moving-source",
    "bodies.driver.surface_speed=0",
    "bodies.follower.surface_speed=1",
    "effects.friction_heat.partition=continuity",
];
const ELEMENTS: &[&str] =
    &["thermal.model=fe", "mech.model=hertz-carter", "mech.resolution=5", "time.end=6e-5"];
const EQUAL: &[&str] = &["effects.friction_heat.partition=equal"];
const FAST: &[&str] =
    &["bodies.disc.surface_speed=5", "load.normal_force=30", "time.window=4e-5", "time.end=8e-4"];
const BRAKED: &[&str] = &["friction.coefficient=0.3", "time.end=1e-3"];

table_of_tests! { advice_is_true:
    a_pin("pin-on-disc.toml", &[], 9, &[]);
    a_pin_in_elements("pin-on-disc.toml", ELEMENTS, 9, &["thermal_expansion"]);
    a_hot_pin("pin-on-disc.toml", FAST, 8, &["thermal_expansion"]);
    a_disc_that_rolls("twin-disc.toml", ROLLS, 12, &["plasticity"]);
    a_disc_that_slides("twin-disc.toml", SLIDES, 10, &["thermal_expansion"]);
    a_wheel_that_is_hotter("locked-wheel.toml", EQUAL, 10, &[]);
    a_wheel_as_hot_as_the_rail("locked-wheel.toml", BRAKED, 8, &["thermal_expansion"]);
}

/// Every effect that could be added to a scene, or is in it, changes the figure of its advice as
/// the advice says, in sign and within a factor of three, or by less than a per cent. Effects that
/// the models of the scene do not support are left out, as those are whose run does not converge
/// (`beyond`); at least `least` are compared.
fn advice_is_true(name: &str, settings: &[&str], least: usize, beyond: &[&str]) {
    let coarse = ["mech.model=half-space", "mech.resolution=6"];
    let (file, changes) = (case(name), sets(&[&coarse, settings].concat()));
    let mut fleet = fleet();
    let standing = planned(&file, &changes, &mut fleet).unwrap_or_else(|error| panic!("{error}"));
    let advice: Vec<Advice> = ask(&standing, &mut fleet).unwrap_or_else(|error| panic!("{error}"));
    let whole = Place::new().summary(&file, &changes);
    let mut compared = 0;
    for one in advice.iter().filter(|one| !beyond.contains(&&*one.effect)) {
        let active = standing.case.effects.contains(&one.effect);
        let (Some(change), Some(other)) = (&one.change, toggled(one, active)) else { continue };
        let other: Vec<&str> =
            changes.iter().copied().chain(other.iter().map(String::as_str)).collect();
        if planned(&file, &other, &mut fleet).is_err() {
            continue;
        }
        let other = Place::new().summary(&file, &other);
        let (with, without) = if active { (&whole, &other) } else { (&other, &whole) };
        let [with, without] = [with, without].map(|summary| figure(summary, &change.figure));
        println!("{}: {change:?}, {with:?} from {without:?}; {}", one.effect, one.why);
        assert!(agree(change, with, without), "{} {change:?} {with:?} {without:?}", one.effect);
        compared += 1;
    }
    println!("{name}: {compared} effects");
    assert!(compared >= least, "{compared}");
}

/// Options that remove an effect from a case, or add it; `None` if values are missing.
fn toggled(advice: &Advice, active: bool) -> Option<Vec<String>> {
    if active {
        return Some(vec!["--unset".to_owned(), format!("effects.{}", advice.effect)]);
    }
    let set = |set: &String| ["--set".to_owned(), set.clone()];
    (!advice.set.is_empty()).then(|| advice.set.iter().flat_map(set).collect())
}

/// Value of a figure, by its key.
fn figure(summary: &Value, key: &str) -> Option<f64> {
    summary.pointer(&format!("/{}", key.replace('.', "/"))).and_then(Value::as_f64)
}

/// Whether an estimated change agrees with the figure with and without an effect. A figure that
/// exists only with the effect is above zero where it should, and zero elsewhere.
fn agree(change: &Change, with: Option<f64>, without: Option<f64>) -> bool {
    let said = change.relative;
    let Some(without) = without else {
        return (said == f64::INFINITY) == with.is_some_and(|with| with > 0.0);
    };
    let Some(found) = with.map(|with| with.abs() / without.abs() - 1.0) else { return false };
    let little = [said, found].iter().all(|change| change.abs() < SIGNIFICANT_CHANGE);
    little || (1.0 / FACTOR..=FACTOR).contains(&(said / found))
}
