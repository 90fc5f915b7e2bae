//! Surfaces that heat raises.

use super::common::{Store, configuration, paper};
use mech_solver::MechSolver;
use proto::field::{self, FieldSpec};
use proto::grid::{Grid, Structured};
use proto::model::{InputField, Inputs, Solver, Step, StepError};
use proto::progress::Progress;
use serde_json::{Value, json};

/// Integrals of the rise that are paraboloids, on a grid wider and finer than the contact's.
struct Raised {
    grid: Grid,
    values: [Vec<f64>; 2],
}

impl Raised {
    /// Both surfaces are raised by a bell of this height and width [m].
    fn bell(height: f64, width: f64, coefficient: f64) -> Self {
        let mut raised = Self::new([0.0; 2], 1.0);
        let plane = *raised.grid.as_structured().expect("a plane");
        for (index, value) in raised.values[0].iter_mut().enumerate() {
            let (x, y) = (plane.x(index % plane.ni), plane.y(index / plane.ni));
            *value = height / (2.6 * coefficient) * (-(x * x + y * y) / (width * width)).exp();
        }
        raised.values[1] = raised.values[0].clone();
        raised
    }

    /// The upper body's surface is raised by ½ c x², the lower one's by ½ c y², with these curvatures c [1/m].
    fn new(curvatures: [f64; 2], coefficient: f64) -> Self {
        let plane = Structured::contact_plane(-15e-3, -15e-3, 5e-5, 5e-5, 601, 601);
        let of = |height: &dyn Fn(f64, f64) -> f64| -> Vec<f64> {
            let at = |index: usize| height(plane.x(index % plane.ni), plane.y(index / plane.ni));
            (0..plane.points()).map(|index| at(index) / (2.6 * coefficient)).collect()
        };
        let [along, across] = curvatures;
        let values = [of(&|x, _| 0.5 * along * x * x), of(&|_, y| 0.5 * across * y * y)];
        Self { grid: Grid::structured("contact", plane), values }
    }
}

impl Inputs for Raised {
    fn get(&self, field: &FieldSpec) -> Option<InputField<'_>> {
        let fields = [field::UPPER_RISE_INTEGRAL, field::LOWER_RISE_INTEGRAL];
        let body = fields.iter().position(|known| known == field)?;
        Some(InputField { values: &self.values[body], grid: &self.grid })
    }
}

/// Finite elements whose first layer expands change as half-spaces do that are raised, by a bell of 10 µm on each body: the approach
/// less by most of both, the pressure higher, the contact narrower. A layer expands in its middle, half an element deep, and raises
/// its surface by less: tolerances are the shares that four elements to a semi-axis miss, and two miss more of the approach and
/// the pressure.
#[test]
fn elements_that_expand_change_as_half_spaces_that_are_raised() {
    let bell = Raised::bell(10e-6, 8e-3, 1.2e-5);
    let flat = Raised::new([0.0; 2], 1.0);
    let changes =
        [("explicit-fe", 2), ("explicit-fe", 4), ("half-space", 20)].map(|(model, resolution)| {
            let mut case = case(1.2e-5);
            case["materials"]["steel"]["density"] = json!(7850.0);
            case["motion"] = json!({"speed": 38.889, "creepage": {"xi": -0.002}});
            case["mech"] = json!({"model": model, "resolution": resolution});
            let [warm, cold] = [&bell, &flat].map(|inputs| contact(&case, inputs).unwrap());
            let of = |key: &str| warm[key].as_f64().unwrap() / cold[key].as_f64().unwrap() - 1.0;
            ["approach_m", "max_pressure_pa", "semi_axis_b_m", "creep_force_x_n"].map(of)
        });
    println!("{changes:.4?}");
    let [coarse, fine, exact] = &changes;
    let missed = |of: &[f64; 4]| -> Vec<f64> {
        of.iter().zip(exact).map(|(one, exact)| (one / exact - 1.0).abs()).collect()
    };
    let [coarse, fine] = [coarse, fine].map(missed);
    for (missed, tolerance) in fine.iter().zip([0.1, 0.3, 0.2, 0.5]) {
        assert!(*missed < tolerance, "{fine:.3?}");
    }
    assert!(coarse[0] > fine[0] && coarse[1] > fine[1], "{coarse:.3?} {fine:.3?}");
}

fn case(coefficient: f64) -> Value {
    let mut case = paper();
    case["mech"] = json!({"model": "half-space", "resolution": 20});
    case["materials"]["steel"]["thermal_expansion"] = json!(coefficient);
    case["effects"]["thermal_expansion"] = json!({});
    case
}

/// The summary of a case, with these inputs.
fn contact(case: &Value, inputs: &dyn Inputs) -> Result<Value, StepError> {
    let configuration = configuration(case);
    let setup = MechSolver.configure(&configuration).unwrap_or_else(|error| panic!("{error}"));
    let mut store = Store::for_layout(setup.layout(), &configuration.outputs);
    let mut model = setup.build(&Progress::default()).expect("a checked case builds");
    model.solve(&Step::STEADY, inputs, &mut store)?;
    Ok(model.summary()["contact"].clone())
}

/// Surfaces that heat makes flatter touch as bodies of larger radii do. Tolerance: integrals between the centres of elements, and another grid of the contact.
#[test]
fn paraboloids_of_heat_change_the_radii() {
    let (along, across) = (1.0 / 0.46 - 1.0 / 0.6, 1.0 / 0.3 - 1.0 / 0.4);
    let warm = contact(&case(1.2e-5), &Raised::new([along, across], 1.2e-5)).unwrap();
    let mut flatter = paper();
    flatter["mech"] = json!({"model": "half-space", "resolution": 20});
    flatter["bodies"]["wheel"]["radius_x"] = json!(0.6);
    flatter["bodies"]["rail"]["radius_y"] = json!(0.4);
    let cold = contact(&flatter, &Raised::new([0.0; 2], 1.0)).unwrap();
    for key in ["semi_axis_a_m", "semi_axis_b_m", "max_pressure_pa", "approach_m", "creepage_xi"] {
        let [one, other] = [&warm, &cold].map(|of| of[key].as_f64().unwrap());
        let tolerance = if key == "creepage_xi" { 5e-3 } else { 1e-3 };
        assert!((one / other - 1.0).abs() < tolerance, "{key}: {one} {other}");
    }
}

/// What is wrong with an integral is said by name.
#[test]
fn an_integral_that_is_no_number_is_refused() {
    let mut raised = Raised::new([0.0; 2], 1.0);
    raised.values[1][17] = f64::NAN;
    let error = contact(&case(1.2e-5), &raised).unwrap_err().to_string();
    assert!(error.contains("lower_rise_integral"), "{error}");
}
