//! `coordinator compare`: differences between two results.

use crate::harness::{Place, case};
use serde_json::Value;

/// Runs the main case with more options, in a place of its own.
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
    // Only times differ.
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
    assert!((rise["change"].as_f64().unwrap() - (cold / hot - 1.0)).abs() < 1e-12);
    // The opposite order gives the change relative to the other value, as in `ablate`.
    let back: Value = serde_json::from_str(&compared(&b, &a, &["--json"])).unwrap();
    let figures = back["figures"].as_array().unwrap();
    let rise = figures.iter().find(|one| one["key"] == "temperature.rail.max_rise_k").unwrap();
    assert!((rise["change"].as_f64().unwrap() - (hot / cold - 1.0)).abs() < 1e-12);
    let field = &of("fields", "field", "rail_temperature");
    // Heat is proportional to V, and its temperature rise to 1/√V. The fields differ by a constant
    // factor, to rounding, and so does every norm of their difference.
    let ratio = 1.0 - cold / hot;
    let l2 = field["difference"]["l2"].as_f64().unwrap();
    assert!((l2 / ratio - 1.0).abs() < 1e-9, "{l2} {ratio}");
    // The mechanical fields do not depend on the speed.
    assert!(told["same_fields"].as_u64().unwrap() >= 2, "{told}");
    let text = compared(&a, &b, &[]);
    assert!(text.contains("motion.speed"), "{text}");
    // No line shows a difference caused by rounding alone.
    assert!(!text.contains("10⁻") && !text.contains("e−"), "{text}");
    // The names of the folders have lines of their own.
    assert!(text.lines().skip(2).all(|line| line.chars().count() <= 80), "{text}");
}

/// Two thermal models have grids with different names: their fields of the same name are compared.
/// A field that is zero in A has no ratio.
#[test]
fn fields_of_other_solvers_are_compared() {
    let strips = ["--set", "mech.model=hertz-carter", "--set", "thermal.model=ertz-knothe"];
    let [a, b] = [result(&[]), result(&strips)];
    let text = compared(&a, &b, &[]);
    for field in ["rail temperature", "slip velocity", "friction power"] {
        // The figure `rail temperature rise` contains the same words.
        let mut fields = text.lines().skip_while(|line| !line.starts_with("  fields "));
        let line = fields.find(|line| line.contains(&format!(" {field} ")));
        assert!(line.is_some_and(|line| line.contains("%, at most")), "{field}: {text}");
    }
    let still = result(&["--set", "motion.creepage.xi=0"]);
    for text in [compared(&still, &a, &[]), compared(&a, &still, &[])] {
        assert!(!text.contains("not finite"), "{text}");
    }
    assert!(compared(&still, &a, &[]).contains("zero in A, at most"));
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
