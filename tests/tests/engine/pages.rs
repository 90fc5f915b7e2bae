//! Figures that pages state in prose. Blocks of commands are tested with what they print
//! (`system/snippets.rs`); these sentences have no block.

use crate::harness::{Place, case, flat, root};
use serde_json::Value;

/// Runs a shipped case.
fn run(name: &str, options: &[&str]) -> Value {
    Place::new().summary(&case(name), options)
}

/// A figure of the summary by its path, such as `/contact/creepage_xi`.
fn figure(summary: &Value, path: &str) -> f64 {
    summary.pointer(path).and_then(Value::as_f64).unwrap_or_else(|| panic!("{path}: {summary}"))
}

/// Fails if a page has none of these texts, which contain the figures of runs.
fn states(page: &str, texts: &[String]) {
    let text = flat(&std::fs::read_to_string(root().join(page)).unwrap());
    for wanted in texts {
        assert!(text.contains(wanted), "{page} does not have: {wanted}");
    }
}

#[test]
fn shares_of_heat_of_a_locked_wheel() {
    let rises = |settings: &[&str]| {
        let steady = ["--set", "time.mode=steady", "--unset", "time.window", "--unset", "time.end"];
        let options = [&steady, settings].concat();
        let summary = run("locked-wheel.toml", &options);
        ["wheel", "rail"].map(|body| figure(&summary, &format!("/temperature/{body}/max_rise_k")))
    };
    let [both, _] = rises(&[]);
    let equal = ["--set", "effects.friction_heat.partition=equal"];
    let [wheel, rail] = rises(&equal);
    let thousands = format!("{} {:03.0}", (wheel / 1e3).floor(), wheel % 1e3);
    let conducts = ["--set", "effects.contact_conductance.conductance=1e5"];
    let conducting = rises(&[equal, conducts].concat());
    let page = "docs/theory/moving-source.md";
    states(
        page,
        &[
            format!("`continuity` makes both surfaces {both:.0} K warm"),
            format!("the wheel is {thousands} K and the rail {rail:.0} K warm"),
            format!("in addition {:.0} and {:.0} K", conducting[0], conducting[1]),
        ],
    );
}

#[test]
fn expansion_of_a_sliding_wheel() {
    let [with, without] = [&[][..], &["--unset", "effects.thermal_expansion"]]
        .map(|options| run("wheel-spin.toml", options));
    let higher = |path: &str| 1e2 * (figure(&with, path) / figure(&without, path) - 1.0);
    let pressure = higher("/contact/max_pressure_pa");
    let rise = higher("/temperature/rail/max_rise_k");
    let text =
        format!("{pressure:.1} % higher than without expansion, the rail's rise {rise:.1} %");
    states("docs/theory/half-space.md", &[text]);
}

#[test]
fn the_inputs_of_the_paper() {
    let [[first, warm], [second, cool]] = ["0.4", "0.2"].map(|traction| {
        let traction = format!("motion.traction_coefficient={traction}");
        let options = ["--set", "mech.resolution=80", "--set", &traction];
        let summary = run("wheel-rail.toml", &options);
        let creepage = figure(&summary, "/contact/creepage_xi").abs();
        [1e2 * creepage, figure(&summary, "/temperature/rail/max_rise_k")]
    });
    let creepages = format!("{first:.2} and {second:.2} % and rail temperatures");
    let rises = format!("{warm:.1} and {cool:.1} K at μ = 0.58, 0.5, 0.4 and 0.2");
    states("docs/theory/half-space.md", &[creepages, rises]);
}

#[test]
fn the_first_run() {
    let summary = run("wheel-rail.toml", &[]);
    let length = 2e3 * figure(&summary, "/contact/semi_axis_a_m");
    let rise = figure(&summary, "/temperature/rail/max_rise_k");
    let length = format!("The contact is {length:.1} mm long");
    let rise = format!("largest rise of the rail's surface is {rise:.0} K");
    states("docs/tutorial.md", &[length, rise]);
}
