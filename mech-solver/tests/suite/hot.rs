//! Friction that falls with temperature under a prescribed force: iterates that are too hot.

use super::common::{Store, configuration, paper};
use mech_solver::MechSolver;
use proto::field::FieldSpec;
use proto::grid::{Grid, Structured};
use proto::model::{InputField, Inputs, Model, Solver, Step};
use proto::progress::Progress;
use serde_json::{Value, json};

/// Both surfaces at one uniform temperature rise.
struct Warm(Grid, f64);

impl Warm {
    fn at(rise: f64) -> Self {
        let whole = Structured::contact_plane(0.0, 0.0, 1.0, 1.0, 1, 1);
        Self(Grid::structured("contact", whole), rise)
    }
}

impl Inputs for Warm {
    fn get(&self, field: &FieldSpec) -> Option<InputField<'_>> {
        let values = std::slice::from_ref(&self.1);
        field.name.ends_with("_temperature").then_some(InputField { values, grid: &self.0 })
    }
}

struct Contact {
    model: Box<dyn Model>,
    store: Store,
}

impl Contact {
    /// Friction f(T) = 0.1 + 0.5 e^(−T/100 K), with half of the load as longitudinal force.
    fn new(name: &str, drive: &Value) -> Self {
        let mut case = paper();
        case["motion"] = drive.clone();
        case["motion"]["speed"] = json!(38.889);
        case["motion"]["creep_law"] = json!("carter-pressure");
        case["mech"] = json!({"model": name, "resolution": 8});
        case["effects"]["temperature_friction"] = json!({"limit": 0.1, "decay_temperature": 100.0});
        let configuration = configuration(&case);
        let setup = MechSolver.configure(&configuration).unwrap_or_else(|error| panic!("{error}"));
        let store = Store::for_layout(setup.layout(), &configuration.outputs);
        Self { model: setup.build(&Progress::default()).expect("a checked case builds"), store }
    }

    fn solve(&mut self, rise: f64) {
        self.model.solve(&Step::STEADY, &Warm::at(rise), &mut self.store).expect("an answer");
    }

    fn number(&self, key: &str) -> f64 {
        self.model.summary()["contact"][key].as_f64().unwrap_or_else(|| panic!("no {key}"))
    }
}

/// At a rise of 150 K friction carries 0.21 N of the prescribed 0.5 N. Regression: such an iterate
/// ended the run. Now it is answered with full slip, is not acceptable as a state, and leaves
/// nothing behind.
#[test]
fn an_iterate_beyond_friction_is_answered_and_not_accepted() {
    let hot = 0.1 + 0.5 * (-1.5_f64).exp();
    for (name, part) in [("hertz-carter", 1.0), ("half-space", 0.999)] {
        for drive in [json!({"traction_coefficient": 0.5}), json!({"tangential_force": -67e3})] {
            let mut contact = Contact::new(name, &drive);
            contact.solve(150.0);
            let carried = contact.number("traction_coefficient").abs();
            assert!((carried / (part * hot) - 1.0).abs() < 1e-4, "{name}: {carried}");
            assert!(contact.number("slip_area_ratio") > 0.9, "{name}");
            let refused = contact.model.acceptable().unwrap_err().to_string();
            let carried = format!("friction carries {:.3}", carried * 134.0);
            for part in ["the contact is too hot", "of the prescribed 67.000 kN", &carried[..21]] {
                assert!(refused.contains(part), "{name}: `{part}` is not in: {refused}");
            }
            contact.solve(10.0);
            assert_eq!(contact.model.acceptable(), Ok(()), "{name}");
            let mut fresh = Contact::new(name, &drive);
            fresh.solve(10.0);
            assert_eq!(contact.store.0, fresh.store.0, "{name}");
        }
    }
}

/// The answers on both sides of the limit agree there: the friction power does not jump.
#[test]
fn answers_beyond_the_limit_join_those_within() {
    let rise_of = |friction: f64| -100.0 * ((friction - 0.1) / 0.5).ln();
    for (name, limit) in [("hertz-carter", 0.5), ("half-space", 0.5 / 0.999)] {
        let mut contact = Contact::new(name, &json!({"traction_coefficient": 0.5}));
        let mut power = |friction: f64| {
            contact.solve(rise_of(friction));
            (contact.number("friction_power_w"), contact.model.acceptable().is_ok())
        };
        let ((within, good), (beyond, bad)) =
            (power(limit * (1.0 + 1e-6)), power(limit * (1.0 - 1e-6)));
        assert!(good && !bad, "{name}");
        assert!((beyond / within - 1.0).abs() < 5e-3, "{name}: {within} {beyond}");
    }
}
