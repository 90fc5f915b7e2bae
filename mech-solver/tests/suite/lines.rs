//! Line contacts in plane strain: one row, against closed forms.

use super::common::{Run, assert_close, configuration, refusal, run};
use elastic::Elasticity;
use elastic::Material;
use elastic::{carter, dissimilar, hertz};
use serde_json::{Value, json};

const WIDTH: f64 = 0.2;
/// G = 82 GPa, ν = 0.28.
const STEEL: Material = Material { youngs_modulus: 209.92e9, poisson_ratio: 0.28 };
/// G = 23 GPa, ν = 0.31.
const ALUMINIUM: Material = Material { youngs_modulus: 60.26e9, poisson_ratio: 0.31 };

fn of(material: Material) -> Value {
    json!({"youngs_modulus": material.youngs_modulus, "poisson_ratio": material.poisson_ratio})
}

/// Carter's problem of CONTACT's user guide: a = 1 mm, stick over 0.6 of the length, F = 0.64 f N.
fn carter_case(resolution: usize) -> Value {
    json!({
        "bodies": {"wheel": {"position": "upper", "radius_x": 0.5, "material": "steel"},
            "rail": {"position": "lower", "material": "steel"}},
        "materials": {"steel": of(STEEL)},
        "motion": {"speed": 30.0, "creepage": {"xi": -2.4e-4}},
        "contact": {"width": WIDTH},
        "load": {"normal_force": 35780.0},
        "friction": {"coefficient": 0.3},
        "mech": {"model": "half-space", "resolution": resolution},
        "effects": {"friction_heat": {}, "partial_slip": {}},
    })
}

/// Bentall and Johnson's rollers: aluminium on steel, free rolling.
fn unlike_case(friction: f64, resolution: usize) -> Value {
    let mut case = carter_case(resolution);
    case["bodies"] = json!({"a": {"position": "upper", "radius_x": 0.05, "material": "aluminium"},
        "b": {"position": "lower", "radius_x": 0.05, "material": "steel"}});
    case["materials"]["aluminium"] = of(ALUMINIUM);
    case["motion"] = json!({"speed": 1.0, "traction_coefficient": 0.0});
    case["contact"]["width"] = json!(1.0);
    case["load"]["normal_force"] = json!(16201.9);
    case["friction"]["coefficient"] = json!(friction);
    case
}

fn ratio(run: &Run) -> f64 {
    run.number("creep_force_x_n") / (0.3 * run.number("normal_force_n"))
}

/// Half length, pressure, approach and area of Hertz's line contact, for a force and for its
/// approach. Tolerances: the elements at the edge, of first order in the moments and of second
/// order in the largest pressure; the area ends between elements.
#[test]
fn hertz_along_a_line() {
    let compliance = 2.0 * STEEL.compliance();
    let exact = hertz::line_contact(1.0, WIDTH, 35780.0, compliance);
    let pressed = run(&carter_case(50));
    let mut case = carter_case(50);
    case["load"] = json!({"approach": exact.approach});
    let approached = run(&case);
    for run in [pressed, approached] {
        assert_close(run.number("semi_axis_a_m"), exact.semi_axis_a, 1e-4);
        assert_close(run.number("max_pressure_pa"), exact.max_pressure, 1e-4);
        assert_close(run.number("approach_m"), exact.approach, 1e-5);
        assert_close(run.number("area_m2"), 2.0 * exact.semi_axis_a * WIDTH, 1e-3);
        assert_close(run.number("normal_force_n"), 35780.0, 1e-5);
        assert_eq!(run.grid().as_structured().map(|grid| [grid.nj, grid.ni]), Some([1, 103]));
    }
}

/// F/fN = 0.64: within 0.1 % on one row of 25 elements per semi-axis, and 0.01 % on 100. With the
/// upwind difference errors halve with the element size, and on 25 elements the result is that of
/// CONTACT on the same elements, 0.6480.
#[test]
fn carter_on_one_row() {
    let on = |difference: &str, n: usize| {
        let mut case = carter_case(n);
        case["mech"]["difference"] = json!(difference);
        ratio(&run(&case))
    };
    for (n, most) in [(25, 1e-3), (100, 1e-4)] {
        assert_close(on("fromm", n), 0.64, most);
    }
    let [as_contact, coarse, fine, finest] = [25, 100, 200, 400].map(|n| on("upwind", n));
    assert_close(as_contact, 0.6480, 1e-3);
    assert_close(finest, 0.64, 3e-3);
    let halving = (coarse - fine) / (fine - finest);
    assert!((halving - 2.0).abs() < 0.1, "{halving}");
    assert_close(2.0 * finest - fine, 0.64, 1e-4);
}

/// Across a line a traction deforms 1/(1 − ν) times as much as along it: the same law at a creepage
/// larger by this factor. Tolerance: that of the tractions.
#[test]
fn lateral_creepage_of_a_line() {
    let mut case = carter_case(60);
    let along = run(&case).number("creep_force_x_n");
    case["motion"]["creepage"] = json!({"xi": 0.0, "eta": -2.4e-4 / (1.0 - STEEL.poisson_ratio)});
    let across = run(&case);
    assert_close(across.number("creep_force_y_n"), along, 1e-4);
    assert_close(across.number("creep_force_x_n"), 0.0, 1e-9);
}

/// Carter's strips on a line reproduce his closed form, to which the boundary elements converge.
#[test]
fn closed_form_of_a_line() {
    let mut case = carter_case(40);
    case["mech"]["model"] = json!("hertz-carter");
    let run = run(&case);
    let exact = hertz::line_contact(1.0, WIDTH, 35780.0, 2.0 * STEEL.compliance());
    let prefactor =
        carter::prefactor_by_pressure(0.3, exact.max_pressure, 2.0 * STEEL.compliance());
    assert_close(carter::creep(prefactor, ratio(&run)), 2.4e-4, 1e-10);
    assert_close(run.integral("pressure"), 35780.0, 1e-12);
    assert_close(run.integral("traction"), run.number("creep_force_x_n"), 1e-12);
    assert_close(
        run.grid().integrate(&run.fields["friction_power"]),
        run.number("friction_power_w"),
        1e-12,
    );
}

/// Different rollers in free rolling. Without slip the creepage is Bufler's. Its pressure and
/// traction oscillate at the ends, so that on a grid one element more or less at the edge changes
/// it by 1.5 %, and by 0.3 % with 800 elements per half length. Under almost no friction it is the
/// creepage at which half of the load slips either way, which Newton's method alone would not find.
/// Tolerance: the first order at a/100.
#[test]
fn different_rollers() {
    let bodies = Elasticity::of_pair(&ALUMINIUM, &STEEL);
    let line = hertz::line_contact(20.0, 1.0, 16201.9, bodies.contact_compliance());
    let bufler = {
        let a = dissimilar::half_length_without_slip(&bodies, line.semi_axis_a);
        dissimilar::creepage_without_slip(&bodies, a, 0.025)
    };
    let creepage = |friction, n| run(&unlike_case(friction, n)).number("creepage_xi");
    for (n, most) in [(100, 1.6e-2), (150, 3e-3), (400, 3e-3), (800, 3e-3)] {
        println!("{n}: {}", creepage(3.0, n) / bufler);
        assert_close(creepage(3.0, n), bufler, most);
    }
    let frictionless = dissimilar::creepage_without_friction(&bodies, line.max_pressure);
    for friction in [1e-5, 1e-4, 3e-4, 1e-3] {
        assert_close(creepage(friction, 100), frictionless, 3e-3);
    }
    // CONTACT, with the friction of Bentall and Johnson's figures.
    assert_close(creepage(0.05, 100), -4.294e-4, 1e-3);
}

/// The number of operator products hardly grows with the resolution of a line: less than threefold
/// for sixteen times the elements.
#[test]
fn fine_lines_are_cheap() {
    let work = |n| run(&carter_case(n)).report.work;
    let [coarse, fine] = [100, 1600].map(work);
    assert!(fine < 3 * coarse, "{coarse} {fine}");
}

#[test]
fn what_varies_across_a_line_is_refused() {
    let refused = |change: &dyn Fn(&mut Value)| {
        let mut case = carter_case(10);
        change(&mut case);
        refusal(&configuration(&case))
    };
    let radius = refused(&|case| case["bodies"]["rail"]["radius_y"] = json!(0.3));
    assert!(radius.key == "contact.width" && radius.reason.contains("bodies.rail.radius_y"));
    let narrow = refused(&|case| case["contact"]["width"] = json!(1e-3));
    assert!(narrow.reason.contains("not large compared"), "{}", narrow.reason);
    let spin = refused(&|case| case["motion"]["creepage"]["phi"] = json!(0.1));
    assert!(spin.reason.contains("spin"), "{}", spin.reason);
    let rows = refused(&|case| case["mech"]["lateral_resolution"] = json!(5));
    assert_eq!(rows.key, "mech.lateral_resolution");
    let given = refused(&|case| {
        case["contact"] =
            json!({"width": 0.1, "semi_axis_a": 1e-3, "semi_axis_b": 1e-3, "max_pressure": 1e8});
    });
    assert_eq!(given.key, "contact.width");
}

/// The error for a case without width explains how to write a line contact.
#[test]
fn a_line_is_offered() {
    let mut case = carter_case(10);
    case.as_object_mut().expect("a table").remove("contact");
    let refusal = refusal(&configuration(&case));
    assert!(refusal.fix.contains("contact.width"), "{}", refusal.fix);
}
