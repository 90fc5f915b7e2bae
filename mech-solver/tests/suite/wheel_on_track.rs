//! The model `wheel-on-track` as used by a participant: rows, invariances, sums and refusals. The
//! contact itself is tested in [`wheel_rail`].

use super::common::{
    NoInputs, Run, Store, assert_close, configuration, fitted, paper, refusal, run,
};
use mech_solver::MechSolver;
use proto::configuration::Configuration;
use proto::history::Histories;
use proto::model::{Model, Solver, Step};
use proto::progress::Progress;
use serde_json::{Value, json};

fn on_track() -> Value {
    let mut case = fitted(paper(), "wheel-on-track");
    case["mech"]["resolution"] = json!(25);
    case["wheelset"]["y"] = json!(3e-3);
    case
}

fn patches(run: &Run) -> &Vec<Value> {
    run.contact["each_patch"].as_array().expect("patches")
}

fn of(patch: &Value, key: &str) -> f64 {
    patch[key].as_f64().unwrap_or_else(|| panic!("{key}: {patch}"))
}

/// Tolerances: rounding of the sums; that of the vertical force, 1e-5.
#[test]
fn fields_are_those_of_the_patches() {
    for y in [-4e-3, 3e-3, 6.2e-3] {
        let mut case = on_track();
        case["wheelset"]["y"] = json!(y);
        let run = run(&case);
        let sum = |key: &str| patches(&run).iter().map(|patch| of(patch, key)).sum::<f64>();
        assert_close(run.integral("pressure"), sum("normal_force_n"), 1e-12);
        assert_close(run.integral("traction"), sum("creep_force_x_n"), 1e-12);
        assert_close(run.lateral_integral("traction"), sum("creep_force_y_n"), 1e-12);
        let grid = run.layout.grid_of("friction_power").expect("always there");
        assert_close(grid.integrate(&run.fields["friction_power"]), sum("friction_power_w"), 1e-12);
        let up = |patch: &Value| {
            let (sin, cos) = of(patch, "angle_rad").sin_cos();
            of(patch, "normal_force_n") * cos + of(patch, "creep_force_y_n") * sin
        };
        assert_close(patches(&run).iter().map(up).sum(), 100e3, 2e-5);
    }
}

/// A yawed wheelset without roll has its axes turned about the vertical. Tolerance: rounding.
#[test]
fn totals_are_told_in_both_axes() {
    let mut case = on_track();
    case["wheelset"]["yaw"] = json!(0.02);
    let totals = run(&case).model.summary()["wheelset"].clone();
    let (sin, cos) = 0.02_f64.sin_cos();
    for (kind, unit) in [("force", "n"), ("moment", "nm")] {
        let part = |axis: &str| format!("{kind}_{axis}_{unit}");
        let [x, y, z] = ["x", "y", "z"].map(|axis| of(&totals, &part(axis)));
        let [own_x, own_y, own_z] = ["x", "y", "z"].map(|axis| of(&totals["axes"], &part(axis)));
        assert_close(own_x, cos * x + sin * y, 1e-10);
        assert_close(own_y, cos * y - sin * x, 1e-10);
        assert_close(own_z, z, 1e-10);
    }
}

/// Friction power in the plane of a patch: −V(ξ F_x + η F_y + φ M_z), with a stick zone and
/// without. With the upwind difference the moment is about a point a third of an element ahead.
/// Tolerance: rounding.
#[test]
fn friction_power_is_that_of_the_creepages() {
    for (partial, difference) in
        [(true, "fromm"), (false, "fromm"), (true, "upwind"), (false, "upwind")]
    {
        let mut case = on_track();
        case["mech"]["difference"] = json!(difference);
        case["mech"]["rigid_slip"] = json!("plane");
        if !partial {
            case["effects"] = json!({"friction_heat": {}});
        }
        let run = run(&case);
        let speed = run.fields["surface_speed"][1];
        let arm = if difference == "upwind" { 4e-4 / 3.0 } else { 0.0 };
        let power: f64 = patches(&run)
            .iter()
            .map(|patch| {
                let [x, y] = ["creep_force_x_n", "creep_force_y_n"].map(|key| of(patch, key));
                let moment = of(patch, "spin_moment_nm") - arm * y;
                let [xi, eta, phi] =
                    ["creepage_xi", "creepage_eta", "creepage_phi_per_m"].map(|key| of(patch, key));
                -speed * (xi * x + eta * y + phi * moment)
            })
            .sum();
        assert_eq!(patches(&run).len(), 1);
        assert_close(run.number("friction_power_w"), power, 1e-10);
        let slips = run.number("slip_area_ratio");
        assert!(if partial { slips < 1.0 } else { slips == 1.0 }, "{slips}");
    }
}

/// The left and the right wheel are mirror images of each other. Tolerance: rounding of the
/// profiles, which the pressure magnifies.
#[test]
fn left_and_right_are_mirror_images() {
    let left = run(&on_track());
    let mut case = on_track();
    case["wheelset"] = json!({"side": "right", "nominal_radius": 0.46, "y": -3e-3, "yaw": -2e-3});
    let right = run(&case);
    for key in ["max_pressure_pa", "normal_force_n", "creep_force_x_n", "friction_power_w"] {
        assert_close(right.number(key), left.number(key), 1e-7);
    }
    for key in ["y_m", "angle_rad", "track_y_m", "creep_force_y_n", "creepage_eta"] {
        assert_close(of(&patches(&right)[0], key), -of(&patches(&left)[0], key), 1e-7);
    }
}

struct Sequence {
    model: Box<dyn Model>,
    configuration: Configuration,
    store: Store,
}

impl Sequence {
    fn new(values: Vec<f64>) -> Self {
        let times = (0..values.len()).map(|row| row as f64).collect();
        let values = [("wheelset.y".to_owned(), values)].into();
        let histories = Some(Histories { rows: true, times, values, live: None });
        let configuration = Configuration { histories, ..configuration(&on_track()) };
        let setup = MechSolver.configure(&configuration).unwrap_or_else(|error| panic!("{error}"));
        let store = Store::for_layout(setup.layout(), &configuration.outputs);
        let model = setup.build(&Progress::default()).expect("a checked case builds");
        Self { model, configuration, store }
    }

    fn row(&mut self, window: u64) -> Value {
        let step = Step { window, ..Step::STEADY };
        self.model.solve(&step, &NoInputs, &mut self.store).expect("a solution");
        self.model.accept();
        self.model.summary()
    }
}

/// A row gives the same bits whatever came before. If only the grid differs, its fields are a part
/// of the others. The steady case of its values has the same figures.
#[test]
fn a_row_depends_on_its_own_values_alone() {
    let values = vec![-3e-3, 0.0, 3e-3, 6e-3];
    let mut one = Sequence::new(values.clone());
    let all: Vec<Value> = (0..4).map(|row| one.row(row)).collect();
    let fields = one.store.0.clone();
    let mut other = Sequence::new(values);
    assert_eq!(other.row(3), all[3]);
    assert!(other.store.0 == fields);
    assert_eq!(other.configuration.case.0["wheelset"]["y"], json!(3e-3));
    assert_eq!(run(&on_track()).contact, all[2]["contact"]);
}

#[test]
fn what_cannot_be_placed_is_refused() {
    let refused = |change: &dyn Fn(&mut Value), key: &str, words: &str| {
        let mut case = on_track();
        change(&mut case);
        let refusal = refusal(&configuration(&case));
        assert!(refusal.key == key && refusal.to_string().contains(words), "{refusal}");
    };
    refused(
        &|case| {
            case["mech"]["tangential"] = json!("fastsim");
            case["effects"]["third_body_layer"] = json!({"flexibility": 1e-13});
        },
        "mech.tangential",
        "needs half-spaces",
    );
    refused(
        &|case| {
            case["mech"]["normal"] = json!("analyn");
            case["bodies"]["wheel"]["irregularity"] =
                json!({"form": "flat", "depth": 1e-4, "length": 40e-3, "at": 0.0});
        },
        "mech.normal",
        "vary along the rolling direction",
    );
    refused(
        &|case| {
            case["effects"]["subsurface_stress"] = json!({});
            case["wheelset"]["side"] = json!("both");
            case["load"] = json!({"axle_load": 100e3});
        },
        "effects.subsurface_stress",
        "one wheel at a time",
    );
    refused(&|case| case["load"] = json!({}), "load.vertical_force", "a force or a height");
    refused(&|case| case["wheelset"]["y"] = json!(0.5), "wheelset", "beside the rail");
    refused(
        &|case| case["bodies"]["rail"]["profile"] = json!("nowhere.prr"),
        "bodies.rail.profile",
        "No such file",
    );
    refused(
        &|case| case["bodies"]["rail"]["radius_y"] = json!(0.3),
        "bodies.rail.radius_y",
        "nominal radius",
    );
    refused(
        &|case| {
            case["materials"]["other"] = json!({"youngs_modulus": 100e9, "poisson_ratio": 0.3});
            case["bodies"]["rail"]["material"] = json!("other");
        },
        "bodies.wheel.material",
        "the same material",
    );
    refused(&|case| case["track"]["gauge_height"] = json!(0.2), "bodies.rail.profile", "gauge");
}

/// Files of a test, in a folder that is removed on drop.
struct Files(std::path::PathBuf);

impl Files {
    fn new(test: &str) -> Self {
        let folder = std::env::temp_dir().join(format!("cosim-{test}-{}", std::process::id()));
        std::fs::create_dir_all(&folder).expect("a folder");
        Self(folder)
    }

    fn with(&self, name: &str, text: &str) -> Value {
        let path = self.0.join(name);
        std::fs::write(&path, text).expect("a file");
        json!(path.to_str().expect("a name"))
    }
}

impl Drop for Files {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

/// |p_t|/p of the elements in contact, with their positions x and y [m].
fn ratios(run: &Run) -> Vec<(f64, [f64; 2])> {
    let grid = run.grid().as_structured().expect("a plane");
    let (along, across) = run.fields["traction"].split_at(grid.points());
    let pressure = run.longitudinal("pressure");
    (0..grid.points())
        .filter(|at| pressure[*at] > 0.0)
        .map(|at| {
            let place = [grid.x(at % grid.ni), grid.y(at / grid.ni)];
            (along[at].hypot(across[at]) / pressure[at], place)
        })
        .collect()
}

/// A round rail of 60 mm under the left and the right wheel. Sliding elements have the friction of
/// their own inclination, −s/R on the left; those of a patch that of its angle; along the track
/// that of their position. Tolerances: chords instead of the arc; rounding.
#[test]
fn friction_follows_inclination_and_track() {
    let files = Files::new("inclination");
    let radius = 60e-3;
    let arc = (-80..=80).map(|k| f64::from(k) * 5e-3).map(|turn: f64| {
        let (y, z) = (radius * turn.sin(), radius * (turn.cos() - 1.0));
        format!("{:.9},{:.9}\n", 1e3 * y, 1e3 * z)
    });
    let rail = files.with("rail.csv", &arc.collect::<String>());
    let slopes = files.with("slopes.csv", "-0.02, 0.5\n0.1, 1.1\n");
    let miles = files.with("miles.csv", "9.99, 0.4\n10.01, 0.8\n");
    let factor = |slope: f64| 0.5 + 0.6 * ((slope + 0.02) / 0.12).clamp(0.0, 1.0);
    for (side, sign) in [("left", 1.0), ("right", -1.0)] {
        let mut case = on_track();
        case["effects"] = json!({"friction_bands": {"table": slopes, "over": "inclination"}});
        case["bodies"]["rail"]["profile"] = rail.clone();
        case["track"] = json!({"cant": 0.03, "gauge": 1.47, "gauge_height": 2e-3});
        case["wheelset"]["side"] = json!(side);
        case["wheelset"]["y"] = json!(0.0);
        let own = run(&case);
        let found = ratios(&own);
        let factors = found.iter().map(|(ratio, [_, y])| {
            assert_close(*ratio, 0.6 * factor(-sign * y / radius), 1e-6);
            *ratio
        });
        let (least, most) =
            factors.fold((1.0, 0.0), |(least, most): (f64, f64), f| (least.min(f), most.max(f)));
        assert!(most > 1.1 * least, "{least} {most}");

        case["effects"]["friction_bands"]["at"] = json!("patches");
        case["track"]["deviation"] = json!({"roll": 2e-3});
        let of_patch = run(&case);
        let slope = sign * (of(&patches(&of_patch)[0], "angle_rad") - 2e-3) - 0.03;
        let found = ratios(&of_patch);
        found.iter().for_each(|(ratio, _)| assert_close(*ratio, 0.6 * factor(slope), 1e-12));

        case["effects"]["friction_bands"] = json!({"table": miles, "over": "track"});
        case["wheelset"]["way"] = json!(10.0);
        for (ratio, [x, _]) in ratios(&run(&case)) {
            let factor = 0.6 + 20.0 * x;
            assert_close(ratio, 0.6 * factor, 1e-12);
        }
    }
    let mut case = on_track();
    case["mech"]["model"] = json!("half-space");
    case["effects"]["friction_bands"] = json!({"table": slopes, "over": "inclination"});
    let refusal = refusal(&configuration(&case));
    assert_eq!(refusal.key, "effects.friction_bands.over");
}

/// Stresses below a patch are those of a half-space: for ellipses the largest von Mises stress
/// below the surface is 0.55 to 0.65 of the largest pressure (Johnson, table 4.1), and lies below
/// the patch.
#[test]
fn stresses_are_below_the_patches() {
    let mut case = on_track();
    case["effects"]["subsurface_stress"] = json!({});
    // With more friction the largest stress is at the surface.
    case["friction"]["coefficient"] = json!(0.05);
    let mut run = run(&case);
    run.model.observe(&mut Store::for_layout(&run.layout, &[]));
    let stress = run.model.summary()["stress"].clone();
    let [patch] = patches(&run).as_slice() else { panic!("{}", patches(&run).len()) };
    let peak = &stress["rail"]["volume"];
    let share = of(peak, "max_von_mises_pa") / of(patch, "max_pressure_pa");
    assert!((0.5..0.7).contains(&share), "{peak} {patch}");
    assert!((of(peak, "y_m") - of(patch, "y_m")).abs() < 3e-3, "{peak} {patch}");
    assert!(of(peak, "depth_m") > 1e-3, "{peak}");
}

/// Waves along the track much longer than the contact curve the rail under it. With the height h
/// and the wave number k they subtract h k² from the curvature of the wheel on a crest, and add it
/// in a trough, half a wave farther. Tolerance relative to this change: the fourth order of the
/// cosine, (k a)²/12, and the error of differences on elements of a/18.
#[test]
fn long_waves_are_a_radius() {
    let mut case = super::common::without(on_track(), "partial_slip");
    case["wheelset"]["yaw"] = json!(0.0);
    let (length, share) = (60e-3, 0.06);
    let number = std::f64::consts::TAU / length;
    let radius = case["wheelset"]["nominal_radius"].as_f64().expect("a radius");
    let of = |case: &Value| run(case).number("max_pressure_pa");
    let plain = of(&case);
    for sign in [1.0, -1.0] {
        let mut wavy = case.clone();
        wavy["effects"]["roughness"] =
            json!({"amplitude": share / radius / (number * number), "wavelength_x": length});
        wavy["wheelset"]["way"] = json!(if sign > 0.0 { 0.0 } else { 0.5 * length });
        let mut other = case.clone();
        other["wheelset"]["nominal_radius"] = json!(radius / (1.0 - sign * share));
        let [wavy, other] = [&wavy, &other].map(|case| of(case) / plain - 1.0);
        println!("{sign}: {wavy} {other}");
        assert!(sign * wavy < -5e-3, "{wavy}");
        assert!((wavy / other - 1.0).abs() < 0.25, "{sign}: {wavy} {other}");
    }
    // Theories of smooth strips refuse roughness.
    let mut fast = on_track();
    fast["effects"]["roughness"] = json!({"amplitude": 1e-6, "wavelength_x": length});
    fast["mech"]["normal"] = json!("analyn");
    assert_eq!(refusal(&configuration(&fast)).key, "mech.normal");
}

/// On a curved surface the pressure and tractions of a patch follow the normals of its rows: the
/// force is at most their integral, and its vertical part is the prescribed one to 1e-5. The grid
/// laid out for planes holds the patch. Both wheels are mirror images, to the tolerance of the
/// forces.
#[test]
fn patches_on_curved_surfaces_are_on_the_grid() {
    let mut case = on_track();
    case["mech"]["patch_surface"] = json!("curved");
    case["wheelset"]["y"] = json!(5e-3);
    let run = run(&case);
    let [patch] = &patches(&run)[..] else { panic!("{:?}", patches(&run)) };
    let (pressed, normal) = (run.integral("pressure"), of(patch, "normal_force_n"));
    assert!(normal < pressed && normal > 0.97 * pressed, "{normal} of {pressed}");
    assert_close(run.integral("traction"), of(patch, "creep_force_x_n"), 1e-12);
    let (sin, cos) = of(patch, "angle_rad").sin_cos();
    assert_close(normal * cos + of(patch, "creep_force_y_n") * sin, 100e3, 1e-5);
    case["wheelset"]["side"] = json!("both");
    case["wheelset"]["y"] = json!(0.0);
    case["wheelset"]["yaw"] = json!(0.0);
    case["load"] = json!({"axle_load": 200e3});
    let both = super::common::run(&case);
    let [right, left] = &patches(&both)[..] else { panic!("{:?}", patches(&both)) };
    assert_close(of(right, "normal_force_n"), of(left, "normal_force_n"), 3e-5);
    assert_close(of(right, "creep_force_y_n"), -of(left, "creep_force_y_n"), 3e-5);
}

#[test]
fn what_curved_surfaces_do_not_have_is_refused() {
    let refused = |change: &dyn Fn(&mut Value), key: &str, words: &str| {
        let mut case = on_track();
        case["mech"]["patch_surface"] = json!("curved");
        change(&mut case);
        let refusal = refusal(&configuration(&case));
        assert!(refusal.key == key && refusal.to_string().contains(words), "{refusal}");
    };
    refused(&|case| case["mech"]["normal"] = json!("kpec"), "mech.normal", "strips in a plane");
    refused(&|case| case["mech"]["tangential"] = json!("fastsim"), "mech.tangential", "strips");
    refused(
        &|case| case["mech"]["patch_influence"] = json!("elastic"),
        "mech.patch_influence",
        "regions of the same patch",
    );
    refused(
        &|case| {
            let dip = json!({"form": "dip", "depth": 1e-4, "length": 0.1, "at": 0.0});
            case["bodies"]["rail"]["irregularity"] = dip;
        },
        "mech.patch_surface",
        "vary along the rolling direction",
    );
    refused(
        &|case| {
            let effects = case["effects"].as_object_mut().expect("effects");
            effects.insert("subsurface_stress".to_owned(), json!({}));
        },
        "effects.subsurface_stress",
        "below a plane",
    );
}
