//! Energy audit: every consumer is checked against the heat sent to it.

use crate::harness::{Ended, Place, case, number, sets};
use serde_json::Value;

const SCHEMES: [&str; 4] =
    ["serial-explicit", "parallel-explicit", "serial-implicit", "parallel-implicit"];

/// Runs twenty windows of the lumped pair, including the load step. Returns the place and the
/// outcome.
fn lumped(settings: &[String]) -> (Place, Ended) {
    let place = Place::new();
    let short = ["time.end=0.2", "lumped.step_at=0.105"].map(str::to_owned);
    let more: Vec<&str> =
        short.iter().chain(settings).flat_map(|set| ["--set", set.as_str()]).collect();
    let ended = place.run(&case("lumped.toml"), &more);
    (place, ended)
}

/// The heat sent equals the heat received, to rounding (1e-12), under every scheme: with one
/// conservative field or two, on the producer's grid or mapped, with or without subcycling, fed
/// back or not. An earlier version compared with the newest sample, and parallel-explicit reported
/// "1e0 W sent, 0e0 W received".
fn is_audited_by_what_it_commands(scheme: &str) {
    for model in ["lumped", "split"] {
        for points in [None, Some(7)] {
            for substeps in [1, 3] {
                let mut settings = vec![
                    format!("coupling.scheme={scheme}"),
                    format!("source.model={model}"),
                    format!("body.model={model}"),
                    format!("body.substeps={substeps}"),
                ];
                settings.extend(points.map(|n| format!("body.points={n}")));
                let (place, ended) = lumped(&settings);
                assert_eq!(ended.code, Some(0), "{settings:?}: {}", ended.stderr);
                let table = place.table("iterations.csv");
                let rows = table.columns(["heat_sent_w", "heat_received_w"]);
                let off = |[sent, received]: &[f64; 2]| (sent - received).abs() / sent.abs();
                assert!(rows.iter().all(|row| off(row) <= 1e-12), "{settings:?}: {rows:?}");
                // A consumer in a parallel scheme receives the first flux of the source.
                let fields = if model == "split" { 2.0 } else { 1.0 };
                let first = scheme.starts_with("parallel").then_some(0.5 * fields);
                let told = |first: f64| (rows[0][0] - first).abs() <= 1e-12;
                assert!(first.is_none_or(told), "{settings:?}: {rows:?}");
                assert!(rows.iter().any(|[sent, _]| (sent - 0.5 * fields).abs() > 0.1));
            }
        }
    }
}

table_of_tests! { is_audited_by_what_it_commands:
    a_serial_explicit_scheme_is_audited_by_what_it_commands(SCHEMES[0]);
    a_parallel_explicit_scheme_is_audited_by_what_it_commands(SCHEMES[1]);
    a_serial_implicit_scheme_is_audited_by_what_it_commands(SCHEMES[2]);
    a_parallel_implicit_scheme_is_audited_by_what_it_commands(SCHEMES[3]);
}

/// A loss of heat in a consumer is detected under every scheme, and the message names the consumer.
#[test]
fn a_consumer_that_loses_heat_is_named_under_every_scheme() {
    for scheme in SCHEMES {
        let (_, ended) = lumped(&[format!("coupling.scheme={scheme}"), "body.hides=1e-5".into()]);
        assert_eq!(ended.code, Some(1), "{scheme}: {}", ended.stderr);
        let told = "the energy audit failed in window 0: ";
        assert!(ended.stderr.contains(told), "{scheme}: {}", ended.stderr);
        assert!(ended.stderr.contains("W sent to body, which reports "), "{}", ended.stderr);
    }
}

#[test]
fn a_consumer_that_reports_no_heat_is_left_out_by_name() {
    let (place, ended) = lumped(&["body.reports=false".into()]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    let told = "body: does not report the power it receives, and is excluded from the energy audit";
    assert_eq!(ended.stderr.matches(told).count(), 1, "{}", ended.stderr);
    let summary = place.read_summary();
    assert_eq!(summary["warnings"][0]["key"], "body", "{}", summary["warnings"]);
    assert_eq!(summary["coupling"]["heat_not_reported_by"], serde_json::json!(["body"]));
    assert_eq!(summary["coupling"].get("energy_imbalance"), None::<&Value>);
}

/// Rolling bodies of different temperature exchange kilowatts: an additional friction power of 1 nW
/// is audited correctly, and the flow without friction is the limit of the flow with friction.
/// Tolerance: convergence of the flow, and the friction at the larger creepage.
#[test]
fn heat_between_bodies_is_the_same_without_friction() {
    for law in [
        "effects.friction_heat.partition=continuity",
        "effects.contact_conductance.conductance=1e5 W/(m2 K)",
    ] {
        let rises = ["0", "-1e-9", "-1e-6"].map(|creepage| {
            let creepage = format!("motion.creepage.xi={creepage}");
            let summary = Place::new().summary(
                &case("wheel-rail.toml"),
                &sets(&[
                    law,
                    &creepage,
                    "bodies.wheel.initial_temperature=400 K",
                    "mech.model=hertz-carter",
                    "mech.resolution=8",
                    "thermal.model=moving-source",
                ]),
            );
            assert!(number(&summary, "/coupling/energy_imbalance") <= 1e-9, "{law} {creepage}");
            number(&summary, "/temperature/rail/max_rise_k")
        });
        println!("{law}: {rises:?} K");
        assert!(rises[0] > 10.0 || law.contains("conductance"), "{rises:?}");
        assert!((rises[1] / rises[0] - 1.0).abs() < 1e-6, "{law} {rises:?}");
        assert!((rises[2] / rises[0] - 1.0).abs() < 1e-2, "{law} {rises:?}");
    }
}
