//! Surfaces raised by heat.

use super::common::{HEAVY, SPEED, Store, configuration, driven, paper, refusal};
use mech_solver::MechSolver;
use proto::field::{self, FieldSpec};
use proto::grid::{Grid, Structured};
use proto::model::{InputField, Inputs, Solver, Step, StepError};
use proto::progress::Progress;
use serde_json::{Value, json};
use std::f64::consts::PI;

/// Integrals of the rise with the shape of paraboloids, on a grid wider and finer than that of the
/// contact.
struct Raised {
    grid: Grid,
    values: [Vec<f64>; 2],
}

impl Raised {
    /// Raises both surfaces by a bell of this height and width [m].
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

    /// Raises the surface of the upper body by ½ c x² and that of the lower body by ½ c y², with
    /// these curvatures c [1/m].
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

/// Finite elements with an expanding first layer change like raised half-spaces, for a bell of 10
/// µm on each body: smaller approach, higher pressure, narrower contact. A layer expands in its
/// middle, half an element deep, and raises its surface by less. Tolerances: the deficit of four
/// elements per semi-axis; with two elements it is larger for approach and pressure.
#[test]
fn elements_that_expand_change_as_half_spaces_that_are_raised() {
    let bell = Raised::bell(10e-6, 8e-3, 1.2e-5);
    let flat = Raised::new([0.0; 2], 1.0);
    let changes =
        [("explicit-fe", 2), ("explicit-fe", 4), ("half-space", 20)].map(|(model, resolution)| {
            let mut case = case(1.2e-5);
            case["materials"]["steel"]["density"] = json!(HEAVY);
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

/// Summary of a case with these inputs.
fn contact(case: &Value, inputs: &dyn Inputs) -> Result<Value, StepError> {
    let configuration = configuration(case);
    let setup = MechSolver.configure(&configuration).unwrap_or_else(|error| panic!("{error}"));
    let mut store = Store::for_layout(setup.layout(), &configuration.outputs);
    let mut model = setup.build(&Progress::default()).expect("a checked case builds");
    model.solve(&Step::STEADY, inputs, &mut store)?;
    Ok(model.summary()["contact"].clone())
}

/// Surfaces flattened by heat touch like bodies with larger radii. Tolerance: interpolation between
/// element centres, and a different grid of the contact.
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

/// A window solved again after a rejected one reproduces the bits of a model that has solved
/// nothing else: the search for the creepage of a force starts in the accepted state, not in the
/// rejected solution.
#[test]
fn a_repeated_window_of_elements_begins_in_the_accepted_state() {
    let mut case = case(1.2e-5);
    case["materials"]["steel"]["density"] = json!(HEAVY);
    case["motion"] = json!({"speed": 38.889, "traction_coefficient": 0.3});
    case["mech"] = json!({"model": "explicit-fe", "resolution": 2});
    let configuration = configuration(&case);
    let solved = |inputs: &[Raised]| {
        let setup = MechSolver.configure(&configuration).unwrap_or_else(|error| panic!("{error}"));
        let mut store = Store::for_layout(setup.layout(), &configuration.outputs);
        let mut model = setup.build(&Progress::default()).expect("a checked case builds");
        for inputs in inputs {
            model.solve(&Step::STEADY, inputs, &mut store).expect("an answer");
        }
        (store.0, model.summary())
    };
    let bell = || Raised::bell(10e-6, 8e-3, 1.2e-5);
    let fresh = solved(&[bell()]);
    let repeated = solved(&[Raised::bell(4e-6, 12e-3, 1.2e-5), bell()]);
    assert_eq!(fresh, repeated);
}

/// An invalid integral is refused by its name.
#[test]
fn an_integral_that_is_no_number_is_refused() {
    let mut raised = Raised::new([0.0; 2], 1.0);
    raised.values[1][17] = f64::NAN;
    let error = contact(&case(1.2e-5), &raised).unwrap_err().to_string();
    assert!(error.contains("lower_rise_integral"), "{error}");
}

/// Uniform flux that begins ahead of a small contact, on both bodies.
struct Heated(Raised);

/// Flux over conductivity [K/m], start position of the flux [m], and diffusivity of the steel
/// [m²/s].
const GRADIENT: f64 = 6e6;
const SETS_IN: f64 = 14e-3;
const DIFFUSIVITY: f64 = 50.0 / (7850.0 * 419.5);

impl Heated {
    fn new() -> Self {
        let plane = Structured::contact_plane(-15e-3, -15e-3, 2e-4, 2e-4, 151, 151);
        let at = |index: usize| {
            DIFFUSIVITY / SPEED * GRADIENT * (SETS_IN - plane.x(index % plane.ni)).max(0.0)
        };
        let values: Vec<f64> = (0..plane.points()).map(at).collect();
        let grid = Grid::structured("contact", plane);
        Self(Raised { grid, values: [values.clone(), values] })
    }

    /// Temperature rise of a column at a position and depth (Carslaw & Jaeger, 2.9), by Duhamel's
    /// integral in √t [K].
    fn rise(x: f64, depth: f64) -> f64 {
        let root = ((SETS_IN - x) / SPEED).sqrt();
        let parts = 4000;
        let step = root / f64::from(parts);
        let part = |n: i32| {
            let root = (f64::from(n) + 0.5) * step;
            (-(depth / root).powi(2) / (4.0 * DIFFUSIVITY)).exp() * step
        };
        2.0 * GRADIENT * (DIFFUSIVITY / PI).sqrt() * (0..parts).map(part).sum::<f64>()
    }
}

fn in_section() -> Value {
    let mut case = driven(case(1.2e-5), "creepage", -1e-6);
    let more = [("density", 7850.0), ("specific_heat", 419.5), ("conductivity", 50.0)];
    for (name, value) in more {
        case["materials"]["steel"][name] = json!(value);
    }
    case["load"]["normal_force"] = json!(1e3);
    case["effects"]["subsurface_stress"] = json!({"depth": 1e-4, "layers": 5});
    case
}

/// Away from a small contact, warm material has the in-plane compressive stress Eαϑ/(1 − ν), which
/// equals the von Mises stress and twice the largest shear stress. Tolerance: one hundredth of the
/// surface value for the contact and the edges of the heat.
#[test]
fn the_section_has_the_thermal_stress() {
    let names = ["upper_section", "lower_section"];
    let mut configuration = configuration(&in_section());
    configuration.observed = names
        .iter()
        .flat_map(|name| ["von_mises_stress", "max_shear_stress"].map(|of| format!("{name}_{of}")))
        .collect();
    let setup = MechSolver.configure(&configuration).unwrap_or_else(|error| panic!("{error}"));
    let layout = setup.layout().clone();
    let mut model = setup.build(&Progress::default()).expect("a checked case builds");
    let mut store = Store::for_layout(&layout, &configuration.outputs);
    model.solve(&Step::STEADY, &Heated::new().0, &mut store).expect("a solution");
    model.accept();
    let mut sections = Store::for_layout(&layout, &configuration.observed);
    model.observe(&mut sections);
    let stress = 210e9 * 1.2e-5 / 0.7;
    for name in names {
        let grid = layout.grid_of(&format!("{name}_von_mises_stress")).expect("it is asked for");
        let grid = grid.as_structured().expect("a plane");
        for (column, level) in [(0, 0), (0, 4), (grid.ni - 1, 0), (grid.ni - 1, 2)] {
            let [x, _, z] = grid.centre(column, level);
            let expected = stress * Heated::rise(x, z.abs());
            let at = level * grid.ni + column;
            let of = |which: &str| sections.0[&format!("{name}_{which}")][at];
            let (found, shear) = (of("von_mises_stress"), of("max_shear_stress"));
            println!("{name} {x:e} {z:e}: {found:e} {expected:e} {shear:e}");
            let tolerance = 0.01 * stress * Heated::rise(x, 0.0);
            assert!((found - expected).abs() < tolerance, "{found} {expected}");
            assert!((2.0 * shear - expected).abs() < tolerance, "{shear} {expected}");
        }
    }
}

/// A plane of points has the stresses of the section at the same positions, from contact and heat.
/// Tolerance: rounding.
#[test]
fn points_have_the_stress_of_the_section() {
    let mut case = in_section();
    case["effects"]["stress_at_points"] = json!({
        "below": {"body": "rail", "y": 0.0, "z": [-1e-5, -9e-5], "points_z": 5},
    });
    let mut configuration = configuration(&case);
    let names = ["lower_section_von_mises_stress", "point_von_mises_stress"];
    configuration.observed = names.map(str::to_owned).to_vec();
    let setup = MechSolver.configure(&configuration).unwrap_or_else(|error| panic!("{error}"));
    let layout = setup.layout().clone();
    let mut model = setup.build(&Progress::default()).expect("a checked case builds");
    let mut store = Store::for_layout(&layout, &configuration.outputs);
    model.solve(&Step::STEADY, &Heated::new().0, &mut store).expect("a solution");
    model.accept();
    let mut observed = Store::for_layout(&layout, &configuration.observed);
    model.observe(&mut observed);
    let grids = names.map(|name| layout.grid_of(name).expect("it is asked for"));
    let columns = grids[0].as_structured().expect("a plane").ni;
    let [section, points] = names.map(|name| &observed.0[name]);
    assert_eq!(section.len(), points.len());
    let largest = section.iter().copied().fold(0.0, f64::max);
    for (at, stress) in section.iter().enumerate() {
        // Points are in ascending order of z, the section in descending order.
        let mirrored = (4 - at / columns) * columns + at % columns;
        let [one, other] = [grids[0].centre(at), grids[1].centre(mirrored)];
        assert!((0..3).all(|axis| (one[axis] - other[axis]).abs() < 1e-15), "{one:?} {other:?}");
        assert!(
            (stress - points[mirrored]).abs() < 1e-9 * largest,
            "{stress} {}",
            points[mirrored]
        );
    }
}

/// The section needs the diffusivity and moving material.
#[test]
fn a_section_without_a_rise_at_depth_is_refused() {
    let key = |case: &Value| refusal(&configuration(case)).key;
    let mut lacking = in_section();
    lacking["materials"]["steel"].as_object_mut().expect("a table").remove("density");
    assert_eq!(key(&lacking), "materials.steel.density");
    lacking["effects"].as_object_mut().expect("a table").remove("subsurface_stress");
    assert!(MechSolver.configure(&configuration(&lacking)).is_ok(), "needed by the section alone");
    let mut locked = in_section();
    locked["bodies"]["wheel"]["surface_speed"] = json!(0.0);
    locked["motion"] = json!({"speed": SPEED});
    assert_eq!(key(&locked), "bodies.wheel.surface_speed");
}
