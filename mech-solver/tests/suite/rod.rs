//! Rods in contact or apart.

use super::common::{Store, configuration, fitted, paper, without};
use mech_solver::MechSolver;
use proto::field::{self, FieldSpec};
use proto::grid::{Grid, Structured};
use proto::model::{InputField, Inputs, Solver, Step};
use proto::progress::Progress;
use serde_json::json;

/// Integrals of the temperature rise over the upper and the lower rod [K m].
struct Warm(Grid, [f64; 2]);

impl Inputs for Warm {
    fn get(&self, field: &FieldSpec) -> Option<InputField<'_>> {
        let fields = [field::UPPER_RISE_INTEGRAL, field::LOWER_RISE_INTEGRAL];
        let body = fields.iter().position(|known| known == field)?;
        Some(InputField { values: &self.1[body..=body], grid: &self.0 })
    }
}

/// Two rods, 0.1 and 0.3 m long, 10 µm apart: open until αW has closed the gap, then pressed by the
/// excess over Σ L/E.
#[test]
fn rods_close_a_gap_and_press() {
    let mut case = fitted(without(paper(), "partial_slip"), "rod");
    case["bodies"]["wheel"]["length"] = json!(0.3);
    case["mech"]["gap"] = json!(10e-6);
    case["materials"]["steel"]["thermal_expansion"] = json!(1e-5);
    case["effects"]["thermal_expansion"] = json!({});
    let mut configuration = configuration(&case);
    configuration.outputs = vec!["pressure".to_owned(), "normal_gap".to_owned()];
    let setup = MechSolver.configure(&configuration).unwrap();
    let mut store = Store::for_layout(setup.layout(), &configuration.outputs);
    let mut model = setup.build(&Progress::default()).unwrap();
    let end = Grid::structured("contact", Structured::contact_plane(0.0, 0.0, 0.01, 0.01, 1, 1));
    for (warm, gap, pressure) in
        [([0.2, 0.3], 5e-6, 0.0), ([0.0, 1.0], 0.0, 0.0), ([2.0, 1.0], 0.0, 20e-6 * 210e9 / 0.4)]
    {
        model.solve(&Step::STEADY, &Warm(end.clone(), warm), &mut store).unwrap();
        let [found, pressed] = ["normal_gap", "pressure"].map(|name| store.0[name][0]);
        assert!((found - gap).abs() < 1e-18, "{warm:?}: {found}");
        assert!((pressed - pressure).abs() <= 1e-12 * pressure + 1e-3, "{warm:?}: {pressed}");
    }
    assert!(model.summary()["contact"]["normal_force_n"].as_f64().unwrap() > 0.0);
}
