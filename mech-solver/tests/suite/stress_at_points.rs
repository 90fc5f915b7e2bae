//! Stresses at points named by a case.

use super::common::{NoInputs, Store, configuration, driven, paper, refusal};
use mech_solver::MechSolver;
use proto::configuration::Layout;
use proto::grid::{Points, Shape};
use proto::model::{Solver, Step};
use proto::progress::Progress;
use serde_json::{Value, json};

const FIELDS: [&str; 10] = [
    "point_von_mises_stress",
    "point_max_shear_stress",
    "point_hydrostatic_stress",
    "point_stress",
    "point_principal_stress_1",
    "point_principal_stress_2",
    "point_principal_stress_3",
    "point_principal_direction_1",
    "point_principal_direction_2",
    "point_principal_direction_3",
];

fn case(blocks: Value) -> Value {
    let mut case = driven(paper(), "creepage", -0.002);
    case["motion"]["creepage"] = json!({"xi": -0.002, "eta": 0.001});
    case["mech"] = json!({"model": "half-space", "resolution": 8});
    case["effects"]["stress_at_points"] = blocks;
    case
}

/// Layout, outputs of the contact, observed fields, and the summary.
fn observed(case: &Value) -> (Layout, Store, Store, Value) {
    let mut configuration = configuration(case);
    configuration.observed = FIELDS.map(str::to_owned).to_vec();
    let setup = MechSolver.configure(&configuration).unwrap_or_else(|error| panic!("{error}"));
    let layout = setup.layout().clone();
    let mut model = setup.build(&Progress::default()).expect("a checked case builds");
    let mut sent = Store::for_layout(&layout, &configuration.outputs);
    model.solve(&Step::STEADY, &NoInputs, &mut sent).expect("a solution");
    model.accept();
    let mut observed = Store::for_layout(&layout, &configuration.observed);
    model.observe(&mut observed);
    (layout, sent, observed, model.summary()["stress_at_points"].clone())
}

fn points(layout: &Layout) -> Points {
    match &layout.grid_of("point_stress").expect("it is asked for").shape {
        Shape::Points(points) => points.clone(),
        other => panic!("{other:?}"),
    }
}

/// The stresses on the surfaces of both bodies equal the pressure and the tractions of the contact,
/// in the axes of the project. They act on the upper body, whose outward normal points down. The
/// principal stresses and directions are those of the tensor. Tolerance: rounding.
#[test]
fn surfaces_have_what_acts_on_them() {
    let surface = |body: &str| json!({"body": body, "z": 0.0});
    let (layout, sent, observed, _) =
        observed(&case(json!({"above": surface("wheel"), "below": surface("rail")})));
    let points = points(&layout);
    let (pressure, traction) = (&sent.0["pressure"], &sent.0["traction"]);
    let largest = pressure.iter().copied().fold(0.0, f64::max);
    let elements = pressure.len();
    assert_eq!(points.count(), 2 * elements);
    let count = points.count();
    let tensor = &observed.0["point_stress"];
    let mut sheared = 0;
    for at in 0..count {
        let element = at % elements;
        let [xx, yy, zz, xy, yz, xz] = [0, 1, 2, 3, 4, 5].map(|part| tensor[part * count + at]);
        let near = |one: f64, other: f64| (one - other).abs() < 1e-9 * largest;
        assert!(near(zz, -pressure[element]), "{zz} {}", pressure[element]);
        assert!(near(xz, -traction[element]) && near(yz, -traction[elements + element]));
        sheared += usize::from(yz.abs() > 0.01 * largest && xz.abs() > 0.01 * largest);
        let rows = [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]];
        for which in 1..=3 {
            let value = observed.0[&format!("point_principal_stress_{which}")][at];
            let direction = &observed.0[&format!("point_principal_direction_{which}")];
            let n = [0, 1, 2].map(|axis| direction[axis * count + at]);
            assert!((n.iter().map(|c| c * c).sum::<f64>() - 1.0).abs() < 1e-12);
            for (row, n_row) in rows.iter().zip(n) {
                let sum: f64 = row.iter().zip(n).map(|(stress, n)| stress * n).sum();
                assert!(near(sum, value * n_row), "{sum} {value}");
            }
        }
        let of = |name: &str| observed.0[name][at];
        let ends = [of("point_principal_stress_1"), of("point_principal_stress_3")];
        assert!(near(of("point_max_shear_stress"), 0.5 * (ends[0] - ends[1])));
        assert!(near(of("point_hydrostatic_stress"), (xx + yy + zz) / 3.0));
        let mises = (0.5 * ((xx - yy).powi(2) + (yy - zz).powi(2) + (zz - xx).powi(2))
            + 3.0 * (xy * xy + yz * yz + xz * xz))
            .sqrt();
        assert!(near(of("point_von_mises_stress"), mises));
    }
    assert!(sheared > 20, "tractions along both axes are looked at: {sheared}");
}

/// Points from a file have the values of a lattice, in any order of the blocks; the summary has the
/// largest value of each block and its position. Tolerance: rounding.
#[test]
fn points_of_a_file_are_those_of_a_lattice() {
    let file = std::env::temp_dir().join(format!("points-{}.csv", std::process::id()));
    std::fs::write(&file, "x, y, z\n-2e-3, 1e-3, -4e-3\n1e-3, 1e-3, -1e-3\n0, 0, 0\n").unwrap();
    let lattice =
        json!({"body": "rail", "x": [-2e-3, 1e-3], "points_x": 4, "y": 1e-3, "z": [-1e-3, -4e-3]});
    let (layout, _, observed, summary) =
        observed(&case(json!({"file": {"body": "rail", "file": file}, "plane": lattice})));
    std::fs::remove_file(&file).unwrap();
    let points = points(&layout);
    assert_eq!((points.count(), points.point(3 + 4)), (11, [-2e-3, 1e-3, -1e-3]));
    let stress = &observed.0["point_stress"];
    // z rises: the lower layer comes first.
    for (of_file, of_lattice) in [(0, 3), (1, 3 + 4 + 3)] {
        assert_eq!(points.point(of_file), points.point(of_lattice));
        for part in 0..6 {
            let [one, other] = [of_file, of_lattice].map(|at| stress[part * 11 + at]);
            assert!((one - other).abs() < 1e-3, "{one} {other} Pa");
        }
    }
    let plane = &summary["each_block"][1];
    let mises = &observed.0["point_von_mises_stress"][3..];
    let most = mises.iter().copied().fold(0.0, f64::max);
    assert_eq!(
        (plane["block"].as_str(), plane["max_von_mises_pa"].as_f64()),
        (Some("plane"), Some(most))
    );
    let at = mises.iter().position(|value| *value == most).unwrap();
    assert_eq!(plane["z_m"].as_f64(), Some(points.point(3 + at)[2]));
}

/// Missing or superfluous values of a block are refused by their keys.
#[test]
fn blocks_without_sense_are_refused() {
    let key = |blocks: Value| refusal(&configuration(&case(blocks))).key;
    let under = |name: &str| format!("effects.stress_at_points{name}");
    assert_eq!(key(json!({})), under(""));
    assert_eq!(key(json!({"a": {"z": -1e-3}})), under(".a.body"));
    assert_eq!(key(json!({"a": {"body": "axle", "z": -1e-3}})), under(".a.body"));
    assert_eq!(key(json!({"a": {"body": "rail"}})), under(".a.z"));
    assert_eq!(key(json!({"a": {"body": "rail", "z": 1e-3}})), under(".a.z"));
    assert_eq!(key(json!({"a": {"body": "wheel", "z": -1e-3}})), under(".a.z"));
    assert_eq!(key(json!({"a": {"body": "rail", "z": [-1e-3, -1e-3]}})), under(".a.z"));
    assert_eq!(key(json!({"a": {"body": "rail", "z": -1e-3, "points_z": 5}})), under(".a.z"));
    assert_eq!(key(json!({"a": {"body": "rail", "z": -1e-3, "points_x": 5}})), under(".a.x"));
    assert_eq!(key(json!({"a": {"body": "rail", "file": "x", "z": -1e-3}})), under(".a.z"));
    assert_eq!(key(json!({"a": {"body": "rail", "file": "none"}})), under(".a.file"));
    assert_eq!(key(json!({"a b": {"body": "rail", "z": -1e-3}})), under(".a b"));
    let many = json!({"body": "rail", "x": [0.0, 1e-3], "points_x": 100_000, "y": [0.0, 1e-3], "points_y": 100_000, "z": 0.0});
    assert_eq!(key(json!({"a": many})), under(""));
}
