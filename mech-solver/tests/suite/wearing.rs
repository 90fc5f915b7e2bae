//! Profiles worn by the contact.

use super::common::{
    FRICTION, NoInputs, Run, SPEED, Store, assert_close, configuration, driven, paper, refusal,
    run, without,
};
use mech_solver::MechSolver;
use proto::configuration::{Configuration, Mode};
use proto::history::Histories;
use proto::model::{Model, Solver, Step, StepError};
use proto::progress::Progress;
use serde_json::{Value, json};

/// Wear volume per joule [m³/J]: the mild regime of rail steel.
const PER_JOULE: f64 = 6.75e-13;

fn case(effect: Value) -> Value {
    let mut case = paper();
    case["mech"] = json!({"model": "half-space", "resolution": 10});
    case["materials"]["steel"]["wear_per_joule"] = json!(PER_JOULE);
    case["materials"]["steel"]["wear_coefficient"] = json!(3e-4);
    case["materials"]["steel"]["hardness"] = json!(3e9);
    case["effects"]["wear"] = effect;
    case
}

fn worn(run: &Run, body: &str, figure: &str) -> f64 {
    let summary = run.model.summary();
    summary["wear"][body][figure].as_f64().unwrap_or_else(|| panic!("{summary}"))
}

/// Archard's volume of a contact in full sliding at the creep s: K N s/H per metre rolled, whatever
/// its shape; and k P/V of the energy law, with partial slip or without. A driving wheel is faster
/// by its creep, and each of its points wears less by that factor. Tolerance: rounding of sums over
/// the contact.
#[test]
fn the_worn_cross_section_is_archards_and_the_works() {
    let creep = 0.01;
    let sliding =
        driven(without(case(json!({"law": "archard"})), "partial_slip"), "creepage", -creep);
    let archard = 3e-4 / 3e9 * 134e3 * creep;
    let run_of = |case: &Value| run(case);
    let one = run_of(&sliding);
    assert_close(worn(&one, "rail", "area_per_passage_m2"), archard, 1e-12);
    assert_close(worn(&one, "wheel", "area_per_passage_m2"), archard / (1.0 + creep), 1e-12);
    // One passage by default.
    assert_close(worn(&one, "rail", "worn_area_m2"), archard, 1e-12);
    let one = run_of(&driven(case(json!({})), "creepage", -0.002));
    let energy = PER_JOULE * one.number("friction_power_w") / SPEED;
    assert_close(worn(&one, "rail", "area_per_passage_m2"), energy, 1e-12);
    let deepest = worn(&one, "rail", "depth_per_passage_m");
    let width = 2.0 * one.number("semi_axis_b_m");
    assert!(deepest > energy / width && deepest < 3.0 * energy / width, "{deepest:e}");
}

/// Rows with equal numbers of passages.
fn rows(count: usize, passes: f64) -> Configuration {
    let mut case = driven(case(json!({"passes": passes})), "traction_coefficient", 0.15);
    case["friction"]["coefficient"] = json!(FRICTION);
    let values = [("effects.wear.passes".to_owned(), vec![passes; count])];
    let times = (0..count).map(|row| row as f64).collect();
    let histories = Some(Histories { rows: true, times, values: values.into(), live: None });
    Configuration { histories, ..configuration(&case) }
}

/// Solves and accepts all rows. Returns the model, or the reason why a row is refused.
fn wear(configuration: &Configuration) -> Result<Box<dyn Model>, StepError> {
    let setup = MechSolver.configure(configuration).unwrap_or_else(|error| panic!("{error}"));
    let layout = setup.layout().clone();
    let mut model = setup.build(&Progress::default()).expect("a checked case builds");
    let rows = configuration.histories.as_ref().expect("rows").times.len() as u64;
    for window in 0..rows {
        let mut store = Store::for_layout(&layout, &configuration.outputs);
        let step = Step { window, ..Step::STEADY };
        model.solve(&step, &NoInputs, &mut store)?;
        model.acceptable()?;
        model.accept();
    }
    Ok(model)
}

/// Worn profiles become flatter: the contact is wider, its pressure lower. Wear accumulates, and
/// hardly depends on the division of passages into rows: with half as many passages in twice the
/// rows the change of the depth is of first order in the step, and halves again.
#[test]
fn a_worn_contact_flattens_and_steps_converge() {
    let figures = |rows_of: usize| {
        let model = wear(&rows(rows_of, 4800.0 / rows_of as f64)).unwrap();
        let summary = model.summary();
        let number = |pointer: &str| summary.pointer(pointer).unwrap().as_f64().unwrap();
        ["/wear/rail/max_depth_m", "/contact/max_pressure_pa", "/contact/semi_axis_b_m"].map(number)
    };
    let [coarse, middle, fine] = [12, 24, 48].map(figures);
    let fresh = run(&driven(case(json!({})), "traction_coefficient", 0.15));
    println!("{coarse:?} {middle:?} {fine:?}");
    assert!(fine[1] < 0.97 * fresh.number("max_pressure_pa"), "{fine:?}");
    assert!(fine[2] > 1.03 * fresh.number("semi_axis_b_m"), "{fine:?}");
    let [first, second] = [coarse[0] / middle[0] - 1.0, middle[0] / fine[0] - 1.0];
    assert!(first.abs() < 0.03 && (0.35..0.65).contains(&(second / first)), "{first} {second}");
}

/// Too many passages in a row are refused with the possible number; nine tenths of that number are
/// accepted.
#[test]
fn a_row_that_wears_too_much_is_refused() {
    let refused = wear(&rows(2, 1e6)).err().expect("a million passages").to_string();
    let (_, after) = refused.split_once("write at most ").expect("what to write");
    let most: f64 = after.split_whitespace().next().unwrap().parse().unwrap();
    assert!((100.0..1e6).contains(&most), "{refused}");
    wear(&rows(3, 0.9 * most)).unwrap();
}

/// A resumed sequence continues with the worn profile, to the bit.
#[test]
fn worn_profiles_are_saved() {
    let configuration = rows(4, 500.0);
    let setup = || MechSolver.configure(&configuration).unwrap();
    let layout = setup().layout().clone();
    let mut one = setup().build(&Progress::default()).unwrap();
    let solve = |model: &mut Box<dyn Model>, window: u64| {
        let mut store = Store::for_layout(&layout, &configuration.outputs);
        let step = Step { window, ..Step::STEADY };
        model.solve(&step, &NoInputs, &mut store).unwrap();
        store.0
    };
    for window in 0..2 {
        solve(&mut one, window);
        one.accept();
    }
    let mut state = Vec::new();
    one.save(&mut state).unwrap();
    let mut other = setup().build(&Progress::default()).unwrap();
    other.restore(&mut state.as_slice()).unwrap();
    // The summary shows the last accepted row before the next one is solved.
    assert_eq!(one.summary(), other.summary());
    assert!(solve(&mut one, 2) == solve(&mut other, 2));
    assert_eq!(one.summary(), other.summary());
    one.accept();
    assert_ne!(one.summary(), other.summary());
    other.accept();
    assert_eq!(one.summary(), other.summary());
}

#[test]
fn what_is_no_passage_is_refused() {
    let transient = Configuration { mode: Mode::Transient, ..configuration(&case(json!({}))) };
    assert_eq!(refusal(&transient).key, "effects.wear");
    let mut locked = case(json!({}));
    locked["bodies"]["wheel"]["surface_speed"] = json!(0.0);
    locked["motion"].as_object_mut().unwrap().remove("traction_coefficient");
    locked["effects"].as_object_mut().unwrap().remove("partial_slip");
    assert_eq!(refusal(&configuration(&locked)).key, "bodies.wheel.surface_speed");
    let mut soft = case(json!({"law": "archard"}));
    soft["materials"]["steel"].as_object_mut().unwrap().remove("hardness");
    assert_eq!(refusal(&configuration(&soft)).key, "materials.steel.hardness");
}
