//! `coordinator compare`: what differs between two results.

use crate::harness::{Place, case};
use serde_json::Value;

/// A run of the main case with more options, in a place of its own.
fn result(more: &[&str]) -> Place {
    let place = Place::new();
    let more: Vec<&str> = ["--set", "mech.resolution=8"].iter().chain(more).copied().collect();
    place.summary(&case("wheel-rail.toml"), &more);
    place
}

fn compared(a: &Place, b: &Place, more: &[&str]) -> String {
    let folders = [a, b].map(|place| place.out().display().to_string());
    let ended = a.start(&[&["compare", &folders[0], &folders[1]], more].concat()).wait();
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    ended.stdout
}

#[test]
fn the_same_case_gives_the_same_bits() {
    let [a, b] = [result(&[]), result(&[])];
    let text = compared(&a, &b, &[]);
    assert!(text.contains("fields the same to the bit"), "{text}");
    // Nothing but times has changed.
    let changed = text.lines().take_while(|line| !line.starts_with("  time"));
    assert!(
        changed.clone().count() == 3 && changed.clone().all(|line| !line.contains('→')),
        "{text}"
    );
}

#[test]
fn what_differs_is_told_with_its_size_and_place() {
    let [a, b] = [result(&[]), result(&["--set", "motion.speed=20 m/s"])];
    let told: Value = serde_json::from_str(&compared(&a, &b, &["--json"])).unwrap();
    let of = |list: &str, name: &str, value: &str| -> Value {
        let all = told[list].as_array().unwrap().iter();
        all.clone().find(|one| one[name] == value).unwrap_or_else(|| panic!("{value}")).clone()
    };
    assert_eq!(of("case", "key", "motion.speed")["b"], "20 m/s");
    let rise = of("figures", "key", "temperature.rail.max_rise_k");
    let [hot, cold] = ["a", "b"].map(|of| rise[of].as_f64().unwrap());
    assert!((rise["relative"].as_f64().unwrap() - (cold - hot) / hot).abs() < 1e-12);
    let field = &of("fields", "field", "rail_temperature");
    // Heat goes with V, and what it raises with its root: one field is the other times a factor, to
    // rounding, and so is every norm of their difference.
    let ratio = 1.0 - cold / hot;
    let l2 = field["difference"]["l2"].as_f64().unwrap();
    assert!((l2 / ratio - 1.0).abs() < 1e-9, "{l2} {ratio}");
    // Nothing mechanical depends on the speed.
    assert!(told["same_fields"].as_u64().unwrap() >= 2, "{told}");
    let text = compared(&a, &b, &[]);
    assert!(text.contains("motion.speed"), "{text}");
    // The names of the folders stand alone on their lines.
    assert!(text.lines().skip(2).all(|line| line.chars().count() <= 80), "{text}");
}

#[test]
fn fields_on_other_grids_are_interpolated() {
    let [a, b] = [result(&[]), result(&["--set", "mech.resolution=16"])];
    let text = compared(&a, &b, &[]);
    assert!(text.contains("mech.resolution  8 → 16") && text.contains("interpolated"), "{text}");
    let ended = a.start(&["compare", "no-such-folder", &a.out().display().to_string()]).wait();
    assert_eq!(ended.code, Some(2), "{}", ended.stderr);
    assert!(ended.stderr.contains("holds no results"), "{}", ended.stderr);
}
