//! Friction that depends on the resulting slip.

use super::common::{
    FRICTION, NoInputs, SPEED, Store, assert_close, configuration, driven, paper, refusal, run,
    without,
};
use mech_solver::MechSolver;
use proto::configuration::{Configuration, Mode};
use proto::model::{Solver, Step};
use proto::progress::Progress;
use serde_json::{Value, json};

/// Polach's constants of a dry contact.
const RATIO: f64 = 0.4;
const DECREASE: f64 = 0.6;

fn falling(model: &str, traction: f64) -> Value {
    let mut case = driven(paper(), "traction_coefficient", traction);
    case["mech"] = json!({"model": model, "resolution": 12});
    case["effects"]["speed_friction"] = json!({"ratio": RATIO, "decrease": DECREASE});
    case
}

/// At the creepage found for a force, friction carries that force: a contact without the effect,
/// with the constant friction of that creepage, gives the same. Tolerances: closed form, and the
/// accuracy of tractions.
#[test]
fn force_and_friction_are_found_together() {
    // The elements of half-spaces follow the slip zone, as estimated from a force or a creepage.
    // From 0.58 of f N on, the zone is so long that they are the same.
    for (model, tolerance, tractions) in [
        ("hertz-carter", 1e-7, [0.1, 0.3, 0.45]),
        ("fastsim", 1e-7, [0.1, 0.3, 0.45]),
        ("half-space", 2e-4, [0.35, 0.4, 0.45]),
    ] {
        for traction in tractions {
            let found = run(&falling(model, traction));
            let creepage = found.number("creepage_xi");
            let velocity = SPEED * creepage.abs();
            let friction = FRICTION * ((1.0 - RATIO) * (-DECREASE * velocity).exp() + RATIO);
            let mut constant = driven(paper(), "creepage", creepage);
            constant["mech"] = json!({"model": model, "resolution": 12});
            constant["friction"]["coefficient"] = json!(friction);
            let expected = run(&constant);
            assert_close(expected.number("traction_coefficient"), traction, tolerance);
            assert!(friction < 0.99 * FRICTION, "the law says something: {friction}");
        }
    }
}

/// A window solved again after a rejected one reproduces the bits of a model that has solved
/// nothing else: the search for the creepage starts in the accepted state, not in the rejected
/// solution.
#[test]
fn a_repeated_window_begins_in_the_accepted_state() {
    let configuration = configuration(&falling("hertz-carter", 0.3));
    let solved = |times: usize| {
        let setup = MechSolver.configure(&configuration).unwrap();
        let mut store = Store::for_layout(setup.layout(), &configuration.outputs);
        let mut model = setup.build(&Progress::default()).unwrap();
        for _ in 0..times {
            model.solve(&Step::STEADY, &NoInputs, &mut store).expect("an answer");
        }
        (store.0, model.summary())
    };
    assert_eq!(solved(1), solved(2));
}

/// The creep curve has a maximum: a larger force has no creepage and is refused.
#[test]
fn a_force_beyond_the_maximum_is_refused() {
    for model in ["hertz-carter", "fastsim", "half-space"] {
        let configuration = configuration(&falling(model, 0.59));
        let setup = MechSolver.configure(&configuration).unwrap();
        let layout = setup.layout().clone();
        let mut model = setup.build(&Progress::default()).unwrap();
        let mut store = Store::for_layout(&layout, &configuration.outputs);
        let solved = model.solve(&Step::STEADY, &NoInputs, &mut store);
        let refused = solved.and_then(|_| model.acceptable()).unwrap_err().to_string();
        assert!(refused.contains("friction falls with"), "{refused}");
    }
}

/// A yielding layer limits the friction bound. In full sliding the contact carries ab π (τ(1 −
/// t²) + ⅔ f p₀ t³), t = τ/(f p₀), and no element more than τ. Tolerance: the elements on the rim,
/// which have the pressure of their middle.
#[test]
fn a_layer_that_yields_cuts_friction_off() {
    for share in [0.25, 0.6, 0.95, 1.5] {
        let free = run(&sliding(None));
        let peak = FRICTION * free.number("max_pressure_pa");
        let yields = run(&sliding(Some(share * peak)));
        let [force, whole] = [&yields, &free].map(|run| run.number("creep_force_x_n"));
        let cut = share.min(1.0);
        println!("{share}: {} of {}", force / whole, 0.5 * (3.0 * cut - cut.powi(3)));
        assert_close(force / whole, 0.5 * (3.0 * cut - cut.powi(3)), 5e-3);
        let largest = yields.number("max_traction_pa");
        assert!(largest <= cut * peak * (1.0 + 1e-12), "{share}: {largest} {peak}");
    }
    // In rolling with partial slip a force within the limit of the layer is met at a larger
    // creepage, and a larger force is refused.
    let mut rolling = driven(paper(), "traction_coefficient", 0.3);
    rolling["mech"] = json!({"model": "half-space", "resolution": 12});
    let free = run(&rolling);
    rolling["effects"]["shear_limit"] = json!({"yield_stress": 350e6});
    let yields = run(&rolling);
    assert_close(yields.number("traction_coefficient"), 0.3, 2e-4);
    assert!(yields.number("creepage_xi") < 1.05 * free.number("creepage_xi"), "more creepage");
    assert!(yields.number("max_traction_pa") <= 350e6 * (1.0 + 1e-9));
    rolling["motion"] = json!({"speed": SPEED, "traction_coefficient": 0.55});
    let configuration = configuration(&rolling);
    let setup = MechSolver.configure(&configuration).unwrap();
    let layout = setup.layout().clone();
    let mut model = setup.build(&Progress::default()).unwrap();
    let mut store = Store::for_layout(&layout, &configuration.outputs);
    let solved = model.solve(&Step::STEADY, &NoInputs, &mut store);
    let refused = solved.and_then(|_| model.acceptable()).unwrap_err().to_string();
    assert!(refused.contains("between the surfaces yields"), "{refused}");
}

/// Contact of the paper in full sliding, with a layer that yields at this stress.
fn sliding(yield_stress: Option<f64>) -> Value {
    let mut case = without(driven(paper(), "creepage", -0.05), "partial_slip");
    case["mech"] = json!({"model": "half-space", "resolution": 20});
    if let Some(yield_stress) = yield_stress {
        case["effects"]["shear_limit"] = json!({"yield_stress": yield_stress});
    }
    case
}

/// A film carries η V|ξ|/h on the whole contact, up to the friction bound. Tolerance: the elements
/// on the edge, where friction is below the film's traction.
#[test]
fn a_film_carries_its_shear() {
    let film = |creepage: f64| {
        let mut case = driven(paper(), "creepage", creepage);
        case["mech"] = json!({"model": "half-space", "resolution": 20});
        case["effects"]["viscous_layer"] = json!({"viscosity": 1000.0, "thickness": 1e-5});
        run(&case)
    };
    for creepage in [1e-4, 1e-3] {
        let found = film(-creepage);
        let shear = 1000.0 * SPEED * creepage / 1e-5 * found.number("area_m2");
        assert_close(found.number("creep_force_x_n"), shear, 0.02);
    }
    let saturated = film(-0.9);
    assert_close(saturated.number("traction_coefficient"), FRICTION, 2e-3);
    let mut driven_by_force = driven(paper(), "traction_coefficient", 0.1);
    driven_by_force["effects"]["viscous_layer"] = json!({"viscosity": 1.0, "thickness": 1e-5});
    assert_eq!(refusal(&configuration(&driven_by_force)).key, "effects.viscous_layer");
}

/// A contact in full sliding has the friction of its single slip velocity, for every law; at rest
/// all laws have the same slope. Tolerance: rounding.
#[test]
fn laws_of_falling_friction() {
    let force = |law: &str, creepage: f64| {
        let mut case = without(driven(paper(), "creepage", -creepage), "partial_slip");
        case["mech"] = json!({"model": "half-space", "resolution": 8});
        case["effects"]["speed_friction"] =
            json!({"ratio": RATIO, "decrease": DECREASE, "law": law});
        let run = run(&case);
        run.number("creep_force_x_n") / (FRICTION * run.number("normal_force_n"))
    };
    for creepage in [0.01, 0.1] {
        let u = DECREASE * SPEED * creepage;
        let expected = |left: f64| (1.0 - RATIO) * left + RATIO;
        assert_close(force("exponential", creepage), expected((-u).exp()), 1e-12);
        assert_close(force("linear", creepage), expected((1.0 - u).max(0.0)), 1e-12);
        assert_close(force("rational", creepage), expected(1.0 / (1.0 + u)), 1e-12);
    }
    let little = 1e-5;
    let slopes =
        ["exponential", "linear", "rational"].map(|law| (1.0 - force(law, little)) / little);
    assert_close(slopes[0], (1.0 - RATIO) * DECREASE * SPEED, 1e-3);
    assert!(slopes.iter().all(|slope| (slope / slopes[0] - 1.0).abs() < 1e-3), "{slopes:?}");
}

/// Along a line in full sliding, friction changes from its value at rest to that of the slip
/// velocity over the memory distance: exponentially in the distance from the front, evaluated in
/// the middle of every element. Tolerance: rounding.
#[test]
fn friction_remembers_a_distance() {
    let (creepage, memory) = (0.2, 4e-4);
    let mut case = without(driven(paper(), "creepage", -creepage), "partial_slip");
    case["mech"] = json!({"model": "half-space", "resolution": 30});
    case["bodies"]["rail"].as_object_mut().expect("a table").remove("radius_y");
    case["contact"] = json!({"width": 0.1});
    case["effects"]["speed_friction"] =
        json!({"ratio": RATIO, "decrease": DECREASE, "law": "rational", "memory_distance": memory});
    let run = run(&case);
    let grid = run.grid().as_structured().expect("a plane");
    let (pressure, traction) = (run.longitudinal("pressure"), run.longitudinal("traction"));
    let settled = (1.0 - RATIO) / (1.0 + DECREASE * SPEED * creepage) + RATIO;
    let last = (0..grid.ni).rev().find(|i| pressure[*i] > 0.0).expect("a contact");
    let front = grid.x(last) + 0.5 * grid.dx();
    for i in (0..grid.ni).filter(|i| pressure[*i] > 0.0) {
        let slid = creepage * (front - grid.x(i));
        let expected = FRICTION * (settled + (1.0 - settled) * (-slid / memory).exp());
        assert_close(traction[i] / pressure[i], expected, 1e-12);
    }
    assert!(traction[last] / pressure[last] > 0.9 * FRICTION);
}

/// Bands of friction: elements carry the value of the table at their position, with linear
/// interpolation, and no more with partial slip. Tolerance: rounding.
#[test]
fn friction_in_bands() {
    let folder = std::env::temp_dir().join(format!("cosim-bands-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder");
    let path = folder.join("bands.csv");
    std::fs::write(&path, "# y [m], factor\n-1e-3, 0.4\n1e-3, 1.0\n").expect("a file");
    let mut case = driven(paper(), "creepage", -0.05);
    case["mech"] = json!({"model": "half-space", "resolution": 12});
    case["effects"]["friction_bands"] = json!({"table": path.to_str().expect("a name")});
    let factor = |y: f64| (0.7 + 0.3 * y / 1e-3).clamp(0.4, 1.0);
    for sticks in [true, false] {
        let case = if sticks { case.clone() } else { without(case.clone(), "partial_slip") };
        let run = run(&case);
        let grid = run.grid().as_structured().expect("a plane");
        let (pressure, traction) = (run.longitudinal("pressure"), run.longitudinal("traction"));
        for index in (0..grid.points()).filter(|index| pressure[*index] > 0.0) {
            let most = FRICTION * factor(grid.y(index / grid.ni)) * pressure[index];
            assert!(traction[index] <= most * (1.0 + 1e-9));
            assert!(sticks || (traction[index] / most - 1.0).abs() < 1e-12);
        }
    }
    std::fs::write(&path, "0.0, -1.0\n").expect("a file");
    let refusal = refusal(&configuration(&case));
    assert_eq!(refusal.key, "effects.friction_bands.table");
    std::fs::remove_dir_all(&folder).expect("its own folder");
}

/// CONTACT's veldep_fric: a cylinder at 45 m/s with friction that falls with the slip velocity of
/// every element.
fn falling_line(slip: &str, start: &str) -> Value {
    json!({
        "bodies": {"cylinder": {"position": "upper", "radius_x": 0.46, "material": "steel"},
            "plane": {"position": "lower", "material": "steel"}},
        "materials": {"steel": {"youngs_modulus": 209.92e9, "poisson_ratio": 0.28}},
        "motion": {"speed": 45.0, "creepage": {"xi": -0.0009999}},
        "load": {"normal_force": 622_216.0},
        "friction": {"coefficient": 0.3},
        "contact": {"width": 0.2},
        "mech": {"model": "half-space", "resolution": 40},
        "effects": {"partial_slip": {}, "speed_friction":
            {"ratio": 0.6, "decrease": std::f64::consts::LN_2 / 0.1, "slip": slip, "start": start}},
    })
}

/// Slipping elements have the friction of their own slip velocity. From all starts the steady state
/// is the same, and agrees with CONTACT; it differs from that of the rigid slip. Tolerances:
/// convergence of friction, with a memory of one element; four printed digits.
#[test]
fn friction_of_every_element_is_that_of_its_slip() {
    for memory in [0.0, 2e-6] {
        let mut forces = Vec::new();
        for start in ["below", "above"] {
            let mut case = falling_line("local", start);
            case["effects"]["speed_friction"]["memory_distance"] = json!(memory);
            case["mech"]["difference"] = json!("upwind");
            let run = run(&case);
            let (pressure, traction) = (run.longitudinal("pressure"), run.longitudinal("traction"));
            let slip = run.longitudinal("slip_velocity");
            let mut slips = 0;
            for i in (0..pressure.len()).filter(|i| pressure[*i] > 0.0 && slip[*i].abs() > 1e-3) {
                let law = 0.18 + 0.12 * 0.5_f64.powf(slip[i].abs() / 0.1);
                if memory == 0.0 {
                    assert_close(traction[i] / pressure[i], law, 1e-6);
                }
                slips += 1;
            }
            assert!(slips > 20, "{slips}");
            forces.push(run.number("creep_force_x_n"));
        }
        println!("{memory:e}: {forces:?}");
        if memory == 0.0 {
            assert_close(forces[0], 1.109e5, 5e-4);
        }
        assert_close(forces[1], forces[0], 1e-6);
    }
    let rigid = run(&falling_line("rigid", "before")).number("creep_force_x_n");
    assert!((rigid / 1.109e5 - 1.0).abs() > 0.01, "{rigid}");
}

#[test]
fn local_slip_is_refused_where_it_is_not_solved_for() {
    let sliding = without(falling_line("local", "below"), "partial_slip");
    assert_eq!(refusal(&configuration(&sliding)).key, "effects.partial_slip");
    let mut strips = falling_line("local", "below");
    strips["mech"]["model"] = json!("hertz-carter");
    assert_eq!(refusal(&configuration(&strips)).key, "effects.speed_friction.slip");
    let mut begins = falling_line("local", "below");
    begins["mech"]["begin"] = json!("steady");
    assert_eq!(refusal(&configuration(&begins)).key, "mech.begin");
    let mut remembers = falling_line("local", "below");
    remembers["mech"]["rolling"] = json!("transient");
    remembers["effects"]["speed_friction"]["memory_distance"] = json!(1e-6);
    let remembers = Configuration { mode: Mode::Transient, ..configuration(&remembers) };
    assert_eq!(refusal(&remembers).key, "effects.speed_friction.memory_distance");
}

/// Friction that falls with the slip of rigid bodies follows the creepage of a force that is
/// prescribed in transient rolling: a contact that begins steady keeps its creepage over two of its
/// lengths. Tolerances: differences in time in place of those of steady rolling; the Newton steps
/// of a window that starts from the last one.
#[test]
fn friction_follows_the_creepage_of_a_force_in_time() {
    let mut case = falling_line("rigid", "before");
    case["motion"] = json!({"speed": 45.0, "traction_coefficient": 0.2});
    case["mech"]["resolution"] = json!(20);
    case["effects"]["speed_friction"]["decrease"] = json!(2.0);
    let steady = run(&case);
    case["mech"]["rolling"] = json!("transient");
    case["mech"]["begin"] = json!("steady");
    let configuration = Configuration { mode: Mode::Transient, ..configuration(&case) };
    let setup = MechSolver.configure(&configuration).expect("a checked case");
    let layout = setup.layout().clone();
    let mut model = setup.build(&Progress::default()).expect("a checked case builds");
    model.first_outputs(&mut Store::for_layout(&layout, &configuration.outputs));
    let grid = layout.grid_of("pressure").and_then(|grid| grid.as_structured()).expect("a plane");
    let window = 4.0 * grid.dx() / 45.0;
    for index in 0..24 {
        let mut store = Store::for_layout(&layout, &configuration.outputs);
        let start = window * f64::from(index as u32);
        let step = Step { window: index, iteration: 1, start, end: start + window };
        let report = model.solve(&step, &NoInputs, &mut store).expect("a solution");
        assert!(report.inner_iterations < 9, "four elements: {}", report.inner_iterations);
        model.accept();
    }
    let summary = model.summary();
    let number = |key: &str| summary["contact"][key].as_f64().expect("a number");
    assert_close(number("traction_coefficient"), 0.2, 1e-4);
    assert_close(number("creepage_xi"), steady.number("creepage_xi"), 1e-5);
    let rest = steady.number("creepage_xi").abs() * 45.0 * 2.0;
    assert!(rest > 0.01, "friction has fallen by {rest}");
}
