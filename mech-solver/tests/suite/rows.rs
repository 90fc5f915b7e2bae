//! Cases with varying values: rows of a sequence, solved again, from a saved state, or without a
//! solution.

use crate::common::{NoInputs, Store, assert_close, configuration, driven, fitted, paper, run};
use mech_solver::MechSolver;
use proto::configuration::{Configuration, Layout, Mode};
use proto::history::Histories;
use proto::model::{Model, Solver, Step, StepError, StepReport};
use proto::progress::Progress;
use serde_json::json;

/// Traction coefficients and loads of four rows; friction cannot carry the third.
fn rows(model: &str) -> Configuration {
    let mut case = driven(paper(), "traction_coefficient", 0.2);
    case["mech"] = json!({"model": model, "resolution": 8});
    let values = [
        ("motion.traction_coefficient".to_owned(), vec![0.2, 0.35, 0.9, 0.3]),
        ("load.normal_force".to_owned(), vec![134e3, 120e3, 120e3, 150e3]),
    ];
    let times = vec![0.0, 1.0, 2.0, 3.0];
    let histories = Some(Histories { rows: true, times, values: values.into(), live: None });
    Configuration { histories, ..configuration(&case) }
}

struct Sequence {
    model: Box<dyn Model>,
    layout: Layout,
    outputs: Vec<String>,
}

impl Sequence {
    fn new(model: &str) -> Self {
        Self::of(&rows(model))
    }

    fn of(configuration: &Configuration) -> Self {
        let setup = MechSolver.configure(configuration).unwrap_or_else(|error| panic!("{error}"));
        let layout = setup.layout().clone();
        let model = setup.build(&Progress::default()).expect("a checked case builds");
        Self { model, layout, outputs: configuration.outputs.clone() }
    }

    fn row(&mut self, window: u64) -> Result<(Store, StepReport), StepError> {
        let mut store = Store::for_layout(&self.layout, &self.outputs);
        let step = Step { window, ..Step::STEADY };
        let report = self.model.solve(&step, &NoInputs, &mut store)?;
        Ok((store, report))
    }
}

/// A row solved again, or from a saved state, is the same to the bit. A row without a solution does
/// not affect the next one.
#[test]
fn rows_depend_on_what_was_accepted_alone() {
    for model in ["hertz-carter", "fastsim", "half-space"] {
        let mut one = Sequence::new(model);
        one.row(0).unwrap();
        one.model.accept();
        let (first, _) = one.row(1).unwrap();
        let (again, _) = one.row(1).unwrap();
        assert!(first.0 == again.0, "{model}");
        one.model.accept();
        let mut state = Vec::new();
        one.model.save(&mut state).unwrap();
        let refused = one.row(2).err().expect("a force beyond friction has no answer");
        assert!(matches!(refused, StepError::NoSolution(_)), "{model}: {refused}");
        let (last, _) = one.row(3).unwrap();
        let mut other = Sequence::new(model);
        other.model.restore(&mut state.as_slice()).unwrap();
        let (restored, _) = other.row(3).unwrap();
        assert!(last.0 == restored.0, "{model}");
        if model == "half-space" {
            assert!(other.model.restore(&mut &state[..state.len() / 2]).is_err());
        }
    }
}

/// Rows with friction that falls with slip have the figures of cases with their values. Tolerances:
/// rounding in closed form; the strips of the simplified theory depend on the grid shared by all
/// rows.
#[test]
fn friction_follows_the_slip_of_every_row() {
    for (model, tolerance) in [("hertz-carter", 1e-9), ("fastsim", 1e-5)] {
        let falls = json!({"ratio": 0.4, "decrease": 0.6});
        let mut configuration = rows(model);
        configuration.case.0["effects"]["speed_friction"] = falls.clone();
        let mut rows = Sequence::of(&configuration);
        for (window, (ratio, load)) in [(0.2, 134e3), (0.35, 120e3)].into_iter().enumerate() {
            let (fields, _) = rows.row(window as u64).unwrap();
            rows.model.accept();
            let mut case = driven(paper(), "traction_coefficient", ratio);
            case["load"]["normal_force"] = json!(load);
            case["mech"] = json!({"model": model, "resolution": 8});
            case["effects"]["speed_friction"] = falls.clone();
            let own = run(&case);
            for figure in ["creepage_xi", "normal_force_n", "friction_power_w", "max_pressure_pa"] {
                let of_row = rows.model.summary()["contact"][figure].as_f64().unwrap();
                assert_close(of_row, own.number(figure), tolerance);
            }
            assert!(fields.0["pressure"].iter().any(|pressure| *pressure > 0.0));
        }
    }
}

/// A row at standstill among rolling rows is refused before the run, by every model that rolls. A
/// speed that touches zero between two rows is none; a stretch at zero is.
#[test]
fn a_standstill_in_a_history_is_refused() {
    let over = |model: &str, rows: bool, speeds: &[f64]| {
        let case = fitted(driven(paper(), "creepage", -2e-3), model);
        let times = (0..speeds.len()).map(|row| row as f64).collect();
        let values = [("motion.speed".to_owned(), speeds.to_vec())].into();
        let histories = Some(Histories { rows, times, values, live: None });
        let mode = if rows { Mode::Steady } else { Mode::Transient };
        MechSolver.configure(&Configuration { histories, mode, ..configuration(&case) }).err()
    };
    for model in ["hertz-carter", "fastsim", "half-space", "conformal", "wheel-on-track"] {
        let refused = over(model, true, &[30.0, 0.0, 20.0]).expect("a refusal");
        assert_eq!(refused.key, "motion.speed", "{model}: {refused}");
        assert!(refused.reason.contains("row 2"), "{model}: {refused}");
        assert!(refused.fix.contains("0.001 m/s"), "{model}: {refused}");
        let refused = over(model, false, &[30.0, 0.0, 0.0, 20.0]).expect("a refusal");
        assert!(refused.reason.contains("row 2"), "{model}: {refused}");
    }
    assert_eq!(over("half-space", false, &[30.0, 0.0, 20.0]), None);
    assert_eq!(over("half-space", true, &[30.0, 0.001, 20.0]), None);
}
