//! Grids that do not match: mapping conserves heat, loops converge through mappings, and matching
//! grids are not mapped.

use crate::harness::{Place, case, completed as run, flat, number, sets};
use coupling::map::{GridMapping, Method};
use proto::field::Mapping;
use serde_json::Value;
use tests::linear::{Problem, grid};

fn planned(name: &str, settings: &[&str]) -> (Option<i32>, String) {
    let ended = Place::new().plan(&case(name), &sets(settings));
    (ended.code, ended.stdout + &ended.stderr)
}

/// Checks every iteration, not only the last one. The bound is the one of the protocol; rounding is
/// smaller.
fn assert_heat_arrives(place: &Place, summary: &Value) {
    let imbalance = number(summary, "/coupling/energy_imbalance");
    assert!(imbalance <= 1e-10, "{imbalance:e}");
    let rows = place.table("iterations.csv").columns(["heat_sent_w", "heat_received_w"]);
    assert!(!rows.is_empty());
    for [sent, received] in rows {
        assert!(sent > 0.0 && (sent - received).abs() <= 1e-10 * sent, "{sent} {received}");
    }
}

const PEAK: &str = "/temperature/rail/max_rise_k";

/// Mapping from 43 × 33 to 59 × 46 elements. The mapped flux is piecewise constant where the exact
/// one jumps between stick and slip zones. The error is of first order: 0.34 % of the peak at a/20.
#[test]
fn heat_of_half_spaces_arrives_on_a_finer_grid() {
    let (place, matching) = run("wheel-rail.toml", &["mech.resolution=20"]);
    assert_heat_arrives(&place, &matching);
    let settings = ["mech.resolution=20", "thermal.resolution=59"];
    let (place, mapped) = run("wheel-rail.toml", &settings);
    assert_heat_arrives(&place, &mapped);
    let (of, expected) = (number(&mapped, PEAK), number(&matching, PEAK));
    assert!((of - expected).abs() <= 0.006 * expected, "{of} K, {expected} K");
    assert!(of != expected, "it is another grid");
    let bytes = |summary: &Value| summary["cost"]["bytes_exchanged"].as_u64().unwrap();
    // Mapped values in the single pass; the first, the last and the section temperatures.
    let (elements, more) = (59 * 46, 59 * 46 - 43 * 33);
    let sections = 2 * 33 * (59 - 43);
    assert_eq!(bytes(&mapped) - bytes(&matching), 8 * (elements + 2 * more + sections));
    let log = place.log().iter().map(ToString::to_string).collect::<String>();
    assert!(log.contains("`friction_power` mapped for thermal: all of 1419 elements"), "{log}");
}

/// Carter's strips at a/40, a/80 and a/160, mapped to grids 1.37 times as fine. The difference from
/// the peak on matching grids is of first order and depends on the phase between the grids; two
/// halvings more than halve it.
#[test]
fn the_peak_tends_to_that_of_matching_grids() {
    let difference = |(mech, thermal): (u32, u32)| {
        let model = "mech.model=hertz-carter";
        let mech = format!("mech.resolution={mech}");
        let thermal = format!("thermal.resolution={thermal}");
        let (_, matching) = run("wheel-rail.toml", &[model, &mech]);
        let (place, mapped) = run("wheel-rail.toml", &[model, &mech, &thermal]);
        assert_heat_arrives(&place, &mapped);
        (number(&mapped, PEAK) / number(&matching, PEAK) - 1.0).abs()
    };
    let differences = [(40, 114), (80, 223), (160, 443)].map(difference);
    assert!(differences[0] <= 2e-4, "{differences:?}");
    assert!(differences.is_sorted_by(|a, b| a > b), "{differences:?}");
    assert!(differences[2] < 0.5 * differences[0], "{differences:?}");
}

/// Rolling from a cold start: heat is conserved in every window.
#[test]
fn heat_of_a_cold_start_arrives_in_every_window() {
    for method in ["auto", "radial-basis"] {
        let method = format!("mapping.fields.friction_power.method={method}");
        let settings = ["thermal.resolution=60", &method, "time.end=200 us", "output.every=1000"];
        let (place, mapped) = run("cold-start.toml", &settings);
        assert_eq!(mapped["coupling"]["windows"], 10);
        assert_heat_arrives(&place, &mapped);
    }
}

/// The relay has 137 points for 100 unknowns, so that M acts between two mappings. The accepted
/// values solve this problem, whose operators are rebuilt here from the same grids. One more pass
/// changes the values by at most the tolerance 1e-6 times the norms of M and of the mappings, about
/// one each, for every fed-back field.
#[test]
fn a_loop_converges_through_mappings_both_ways() {
    for (scheme, acceleration, fed_back) in [
        ("serial-implicit", "iqn-ils", 1.0),
        ("serial-implicit", "aitken", 1.0),
        ("parallel-implicit", "iqn-ils", 2.0),
    ] {
        let scheme = format!("coupling.scheme={scheme}");
        let acceleration = format!("coupling.acceleration={acceleration}");
        let settings =
            [&scheme, &acceleration, "linear.problem=P4", "relay.points=137", "output.fields=all"];
        let (place, summary) = run("linear.toml", &settings);
        assert_eq!(summary["status"], "converged");
        let file = "fields/operator_unknowns_000009.csv";
        let found = place.table(file).numbers("operator_value [1]");
        let change = distance(&passed(&found, 137), &found);
        assert!(change <= 2.0 * fed_back * 1e-6, "{settings:?}: {change:e}");
        let unmapped = number(&summary, "/linear/true_error");
        assert!(unmapped > 0.01, "{settings:?}: mapping makes it another problem: {unmapped:e}");
    }
}

/// One pass from the operator's grid to the relay's and back, and through the operator.
fn passed(values: &[f64], points: usize) -> Vec<f64> {
    let size = values.len();
    let (operator, relay) = (grid(size, size, 0.0), grid(size, points, 0.0));
    let map = |from, to, values: &[f64], count: usize| {
        let method = Method::NearestProjection;
        let mapping = GridMapping::between(from, to, method, Mapping::Consistent).unwrap();
        let mut target = vec![f64::NAN; count];
        mapping.apply(values, &mut target);
        target
    };
    let there = map(&operator, &relay, values, points);
    let back = map(&relay, &operator, &there, size);
    let mut answer = vec![0.0; size];
    Problem::new("P4", 42, size).unwrap().apply(9, &back, &mut answer);
    answer
}

fn distance(a: &[f64], b: &[f64]) -> f64 {
    let norm = |values: &mut dyn Iterator<Item = f64>| values.map(|v| v * v).sum::<f64>().sqrt();
    norm(&mut a.iter().zip(b).map(|(a, b)| a - b)) / norm(&mut b.iter().copied())
}

/// A flux that is both fed back and mapped: the participants solve in parallel, and the body has
/// seven elements where the source has four. The body uses only the integral of the flux, so that
/// the result equals the one without mapping, to the tolerance 1e-10 of 400 windows.
#[test]
fn heat_that_is_fed_back_arrives_through_a_mapping() {
    let settings = ["coupling.scheme=parallel-implicit", "time.window=0.1"];
    let (_, matching) = run("lumped.toml", &settings);
    let (place, mapped) = run("lumped.toml", &[&settings[..], &["body.points=7"]].concat());
    assert!(number(&mapped, "/coupling/energy_imbalance") <= 1e-10);
    let heads = ["iteration", "heat_sent_w", "heat_received_w"];
    let rows = place.table("iterations.csv").columns(heads);
    // The first iterate is the initial output of the source.
    assert_eq!(rows[0], [1.0, 0.5, 0.5]);
    for [_, sent, received] in &rows[1..] {
        assert!(*sent > 0.0 && (sent - received).abs() <= 1e-10 * sent, "{sent} {received}");
    }
    assert!(rows.iter().any(|[iteration, ..]| *iteration > 1.0), "it is a loop");
    for figure in ["/body/temperature_k", "/body/received_j"] {
        let (of, expected) = (number(&mapped, figure), number(&matching, figure));
        assert!((of / expected - 1.0).abs() <= 400.0 * 1e-10, "{figure}: {of} {expected}");
    }
    let log = place.log().iter().map(ToString::to_string).collect::<String>();
    assert!(log.contains("`source_flux` mapped for body"), "{log}");
}

/// Mappings do not increase the number of iterations; counted over ten windows.
#[test]
fn work_of_loops_with_mappings() {
    let iterations = |settings: &[&str]| {
        let (_, summary) = run("linear.toml", settings);
        summary["coupling"]["iterations"].as_u64().unwrap()
    };
    let counts = ["relay.points=73", "relay.points=100", "relay.points=137"]
        .map(|points| iterations(&["linear.problem=P4", points]));
    assert_eq!(counts, [31, 34, 33]);
}

#[test]
fn the_plan_tells_what_is_mapped_and_how_well() {
    let told = |name: &str, settings: &[&str]| flat(&planned(name, settings).1);
    let settings = ["mech.resolution=20", "thermal.resolution=59"];
    let plan = told("wheel-rail.toml", &settings);
    for told in [
        "mech -> thermal intersection, conservative",
        "1419 to 2714 elements; \
                  all of",
    ] {
        assert!(plan.contains(told), "{told}: {plan}");
    }
    assert!(!plan.contains("warning"), "{plan}");
    let nearest = [&settings[..], &["mapping.method=nearest-neighbour"]].concat();
    let plan = told("wheel-rail.toml", &nearest);
    assert!(plan.contains("nearest-neighbour, conservative"), "{plan}");
    assert!(
        plan.contains(
            "nearest-neighbour, which conserves the integral but does not bound the density"
        ),
        "{plan}"
    );
    let aside = ["relay.offset=20", "mapping.fields.relay_value.method=radial-basis"];
    let plan = told("linear.toml", &aside);
    assert!(plan.contains("radial-basis, consistent"), "{plan}");
    assert!(plan.contains("nearest-projection, consistent"), "{plan}");
    let told = "20 of 100 elements lie beyond the other grid's border, up to 19500.000 mm";
    assert_eq!(plan.matches(told).count(), 4, "both ways, as a warning and in its place: {plan}");
    assert_eq!(plan.matches("warning mapping.method: ").count(), 2, "{plan}");
}

#[test]
fn methods_that_make_no_sense_are_refused() {
    for (set, told) in [
        ("mapping.method=linear", "unknown method `linear`"),
        ("mapping.fields.heat.method=auto", "unknown field `heat`"),
        (
            "mapping.fields.slip_velocity.method=intersection",
            "no participant consumes `slip_velocity`: it is never mapped",
        ),
    ] {
        let (code, text) = planned("wheel-rail.toml", &[set]);
        assert_eq!(code, Some(2), "{text}");
        assert!(text.contains(told) && text.contains("fix"), "{text}");
    }
    let (code, text) = planned("wheel-rail.toml", &["thermal.resolution=1"]);
    assert_eq!(code, Some(2), "{text}");
}

/// A requested grid that matches causes no mapping: same files, same bytes.
#[test]
fn matching_grids_are_not_mapped() {
    let files = |place: &Place| {
        let entries = std::fs::read_dir(place.out().join("fields")).unwrap().flatten();
        let mut files: Vec<_> =
            entries.map(|e| (e.file_name(), std::fs::read(e.path()).unwrap())).collect();
        files.sort();
        files
    };
    let (never, plain) = run("wheel-rail.toml", &[]);
    let settings = ["thermal.resolution=83", "mapping.method=radial-basis"];
    let (asked, summary) = run("wheel-rail.toml", &settings);
    assert_eq!(files(&never), files(&asked));
    for key in ["temperature", "contact"] {
        assert_eq!(plain[key], summary[key]);
    }
    assert_eq!(plain["cost"]["bytes_exchanged"], summary["cost"]["bytes_exchanged"]);
    assert!(asked.log().iter().all(|event| !event.to_string().contains("mapped")));
    let (_, plan) = planned("wheel-rail.toml", &settings);
    assert!(!plan.contains("mapping"), "{plan}");
}

/// Heat is conserved in every window of a transient run with seven substeps of the mechanics per
/// window and one of the thermal solver, on a different grid.
#[test]
fn seven_steps_a_window_between_grids_keep_the_heat() {
    // Seven elements of a/10 at 38.889 m/s.
    let (place, summary) = run(
        "cold-start.toml",
        &[
            "mech.model=half-space",
            "mech.rolling=transient",
            "mech.resolution=10",
            "thermal.resolution=31",
            "time.window=1.4212e-4",
            "time.end=1.4212e-3",
        ],
    );
    assert_heat_arrives(&place, &summary);
    let steps = place.table("iterations.csv").columns(["mech_substeps"]).concat();
    // Rounding of the window length may move a step into the next window.
    assert!(steps.iter().all(|steps| (6.0..=8.0).contains(steps)), "{steps:?}");
    assert!((steps.iter().sum::<f64>() - 70.0).abs() <= 1.0, "{steps:?}");
}
