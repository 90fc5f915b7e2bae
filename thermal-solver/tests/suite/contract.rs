//! Behaviour through the contract: descriptions, layouts, refusals, errors, work.

use crate::support::*;
use proto::configuration::{Mode, Windows};
use proto::field;
use proto::grid::Structured;
use proto::history::Histories;
use proto::model::{Solver, StepError};
use thermal_solver::{ThermalSolver, effects, models};

#[test]
fn description_lists_what_the_registries_hold() {
    let description = ThermalSolver.description();
    assert_eq!((description.role.as_str(), description.standalone), ("thermal", false));
    let names: Vec<&str> = description.models.iter().map(|m| m.name.as_str()).collect();
    let listed: Vec<&str> = models::REGISTRY.iter().map(|entry| entry.name).collect();
    assert_eq!(names, listed);
    assert_eq!(description.effects.len(), effects::REGISTRY.len());
    for model in &description.models {
        assert!(!model.source.is_empty() && (model.steady || model.transient));
        for name in model.consumes.iter().chain(&model.provides) {
            assert!(field::find(name).is_some(), "{name}");
        }
    }
    let required = |path: &str| description.keys.iter().any(|k| k.path == path && k.required);
    for path in ["bodies.*.position", "bodies.*.material", "materials.*.density"] {
        assert!(required(path), "{path}");
    }
}

#[test]
fn layout_places_the_fields_and_sections_only_when_asked() {
    let grid = Structured::contact_plane(-4e-3, -1e-3, 2e-4, 5e-4, 40, 4);
    let mut given = configuration("columns", Mode::Steady, grid, steel());
    let layout = ThermalSolver.configure(&given).unwrap().layout().clone();
    assert_eq!(layout.grid_of("lower_temperature").unwrap().as_structured(), Some(&grid));
    for (name, sign) in [("lower_section_temperature", -1.0), ("upper_section_temperature", 1.0)] {
        let section = *layout.grid_of(name).unwrap().as_structured().unwrap();
        assert_eq!((section.ni, section.nj), (40, 33));
        assert_eq!(section.centre(7, 0), grid.centre(7, 2), "y = 0 is the third row");
        let depth = 4.0 * (2.0 * DIFFUSIVITY * 4e-3 / SPEED).sqrt();
        // Tolerance: rounding.
        assert!((sign * section.centre(0, 32)[2] / depth - 1.0).abs() < 1e-14);
    }
    given.observed.clear();
    let layout = ThermalSolver.configure(&given).unwrap().layout().clone();
    assert_eq!((layout.grids.len(), layout.fields.len()), (1, 2));
    assert!(layout.memory_bytes > 0 && layout.solve_seconds > 0.0);
}

/// Sections lie where most heat is expected, or where the case puts them.
#[test]
fn sections_go_through_the_peak_or_where_asked() {
    let grid = Structured::contact_plane(-4e-3, -1e-3, 2e-4, 5e-4, 40, 40);
    let mut given = configuration("columns", Mode::Steady, grid, steel());
    let row_of = |given: &proto::configuration::Configuration| {
        let layout = ThermalSolver.configure(given).unwrap().layout().clone();
        let section =
            *layout.grid_of("lower_section_temperature").unwrap().as_structured().unwrap();
        ((section.centre(0, 0)[1] + 1e-3) / 5e-4).round() as usize
    };
    assert_eq!(row_of(&given), 2);
    // A grid without y = 0 has its section through the middle.
    let beside = Structured::contact_plane(-4e-3, 9e-3, 2e-4, 5e-4, 40, 41);
    assert_eq!(row_of(&configuration("columns", Mode::Steady, beside, steel())), 40);
    given.inputs[0].peak = Some([0.0, 14.2e-3, 0.0]);
    assert_eq!(row_of(&given), 30);
    given.case.0["thermal"] = serde_json::json!({"section_y": 4e-3});
    assert_eq!(row_of(&given), 10);
}

/// Two heated strips with a cold gap have a hottest place each; a single strip is not listed.
#[test]
fn every_heated_strip_has_its_hottest_place() {
    let grid = Structured::contact_plane(-4e-3, -1e-3, 2e-4, 5e-4, 40, 9);
    for model in ["columns", "ertz-knothe"] {
        let mut run = Run::new(model, Mode::Steady, grid, steel());
        let heated = |row: usize| match row {
            1 | 2 => 1e8,
            6 => 3e8,
            _ => 0.0,
        };
        let inside = |i: usize| (10..30).contains(&i);
        let flux = |at: usize| if inside(at % 40) { heated(at / 40) } else { 0.0 };
        run.advance(&(0..grid.points()).map(flux).collect::<Vec<_>>(), 0.0);
        let rail = run.model.summary()["temperature"]["rail"].clone();
        let strips = rail["each_strip"].as_array().expect("two strips").clone();
        let of = |n: usize, key: &str| strips[n][key].as_f64().unwrap();
        assert_eq!(strips.len(), 2, "{model}");
        assert_eq!(of(1, "max_rise_k"), rail["max_rise_k"].as_f64().unwrap());
        assert!((of(1, "max_rise_k") / of(0, "max_rise_k") - 3.0).abs() < 1e-9, "{strips:?}");
        let ends = [of(0, "y_from_m"), of(0, "y_to_m"), of(1, "y_m")];
        for (end, expected) in ends.into_iter().zip([-0.75e-3, 0.25e-3, 2e-3]) {
            assert!((end - expected).abs() < 1e-12, "{model}: {ends:?}");
        }
    }
}

/// The patch of the heat flux, divided into the requested number of elements.
#[test]
fn resolution_gives_a_grid_of_its_own() {
    let arriving = Structured::contact_plane(-4e-3, -1e-3, 2e-4, 5e-4, 40, 4);
    let asked = |model: &str, elements: usize| {
        let mut case = steel();
        case["thermal"] = serde_json::json!({ "resolution": elements });
        let given = configuration(model, Mode::Steady, arriving, case);
        ThermalSolver.configure(&given).unwrap().layout().clone()
    };
    let layout = asked("columns", 55);
    assert_eq!(layout.check(), Ok(()));
    let grid = layout.input_grid("friction_power").unwrap();
    assert_eq!(layout.grid_of("upper_temperature"), Some(grid));
    let shape = *grid.as_structured().unwrap();
    assert_eq!((shape.ni, shape.nj), (55, 14), "8 mm by 2 mm");
    let edges = |s: &Structured| {
        let (low, high) = (s.centre(0, 0), s.centre(s.ni - 1, s.nj - 1));
        let half = [0.5 * s.dx(), 0.5 * s.dy()];
        [low[0] - half[0], low[1] - half[1], high[0] + half[0], high[1] + half[1]]
    };
    for (edge, expected) in edges(&shape).iter().zip(edges(&arriving)) {
        assert!((edge - expected).abs() <= 1e-17, "rounding: {edge} {expected}");
    }
    let section = layout.grid_of("lower_section_temperature").unwrap().points();
    assert_eq!(section, 55 * 33);
    // Elements are square, so the same number along x gives another grid.
    assert!(asked("columns", 40).input_grid("friction_power").is_some());
    let square = Structured { step_j: [0.0, 2e-4, 0.0], nj: 10, ..arriving };
    let mut case = steel();
    case["thermal"] = serde_json::json!({ "resolution": 40 });
    let given = configuration("columns", Mode::Steady, square, case);
    let layout = ThermalSolver.configure(&given).unwrap().layout().clone();
    assert_eq!((layout.inputs.len(), layout.grids[0].as_structured()), (0, Some(&square)));
}

/// Heat is conducted on a fixed grid. If the grid of the flux moves, its first position is used.
#[test]
fn the_first_grid_is_kept_of_one_that_moves() {
    let arriving = Structured::contact_plane(-4e-3, -1e-3, 2e-4, 5e-4, 40, 4);
    for (model, mode) in [("columns", Mode::Transient), ("ertz-knothe", Mode::Steady)] {
        let mut given = configuration(model, mode, arriving, steel());
        let stays = ThermalSolver.configure(&given).unwrap().layout().clone();
        assert_eq!(stays.input_grid("friction_power"), None);
        given.inputs[0].moves = true;
        let layout = ThermalSolver.configure(&given).unwrap().layout().clone();
        assert_eq!(layout.check(), Ok(()));
        let wanted = layout.input_grid("friction_power").unwrap().as_structured();
        assert_eq!((wanted, layout.moving.len()), (Some(&arriving), 0));
        assert!(layout.remarks.iter().any(|remark| remark.contains("first grid")));
    }
}

/// Bodies of different initial temperatures exchange heat. The model neglects this heat and says
/// so.
#[test]
fn different_initial_temperatures_are_remarked_on() {
    let remarks = |wheel: f64| {
        let mut case = steel();
        case["bodies"]["wheel"]["initial_temperature"] = serde_json::json!(wheel);
        let given = configuration("columns", Mode::Steady, row(10, -1.0, 1.0), case);
        ThermalSolver.configure(&given).unwrap().layout().remarks.join("\n")
    };
    assert!(remarks(350.0).contains("begin at 350 K and 293.15 K"), "{}", remarks(350.0));
    assert!(!remarks(293.15).contains("begin at"));
}

/// A body that is at rest in any row of a table is refused before the run, if the partition or the
/// model has no answer for that row. A body that only stops at the end of the run is not at rest.
#[test]
fn a_row_at_rest_is_refused_before_the_run() {
    let grid = row(10, -1.0, 1.0);
    let refused = |model: &str, partition: &str, rows: bool, speeds: &[f64], end: f64| {
        let mut case = steel();
        case["bodies"]["wheel"]["surface_speed"] = serde_json::json!(speeds[0]);
        case["effects"]["friction_heat"]["partition"] = serde_json::json!(partition);
        let mode = if rows { Mode::Steady } else { Mode::Transient };
        let mut given = configuration(model, mode, grid, case);
        let values = [("bodies.wheel.surface_speed".to_owned(), speeds.to_vec())].into();
        let times = (0..speeds.len()).map(|row| row as f64).collect();
        given.histories = Some(Histories { rows, times, values, live: None });
        given.windows = (!rows).then_some(Windows { shortest: 1e-3, usual: 1e-3, end: Some(end) });
        ThermalSolver.configure(&given).err().map(|refusal| refusal.to_string())
    };
    let partition = "effects.friction_heat.partition";
    for (rows, speeds, row) in [(true, [3.0, 0.0, 1.0], 2), (false, [3.0, 0.0, 0.0], 2)] {
        let text = refused("moving-source", "effusivity", rows, &speeds, 2.0).unwrap();
        for part in [partition, &format!("at rest in row {row}"), "write \"continuity\""] {
            assert!(text.contains(part), "{text}");
        }
        assert_eq!(refused("moving-source", "continuity", rows, &speeds, 2.0), None);
    }
    assert_eq!(refused("moving-source", "effusivity", false, &[3.0, 0.0], 1.0), None);
    assert!(refused("moving-source", "effusivity", false, &[3.0, 0.0], 1.5).is_some());
    let text = refused("columns", "equal", true, &[3.0, 1.0, 0.0], 0.0).unwrap();
    for part in ["surface_speed", "at rest in row 3", "model = \"moving-source\""] {
        assert!(text.contains(part), "{text}");
    }
}

/// A wheel that a creepage of 1 locks is at rest, in a table as well, and one beyond runs
/// backwards. Both are refused before the run.
#[test]
fn a_wheel_locked_by_its_creepage_is_refused_before_the_run() {
    let refused = |mode: Mode, creepages: &[f64]| {
        let mut case = steel();
        case["motion"]["creepage"] = serde_json::json!({ "xi": creepages[0] });
        let mut given = configuration("columns", mode, row(10, -1.0, 1.0), case);
        let values = [("motion.creepage.xi".to_owned(), creepages.to_vec())].into();
        let times = (0..creepages.len()).map(|row| row as f64).collect();
        let rows = Histories { rows: true, times, values, live: None };
        given.histories = (creepages.len() > 1).then_some(rows);
        ThermalSolver.configure(&given).err().map(|refusal| refusal.to_string())
    };
    let sentence = "`wheel` is at rest: one place of it is heated without end, and conduction \
                    normal to the surface then has no steady state; write [thermal] model = \
                    \"moving-source\", or a speed above 0 m/s";
    let text = refused(Mode::Steady, &[1.0]).unwrap();
    assert!(text.contains("motion.creepage.xi") && text.contains(sentence), "{text}");
    assert!(refused(Mode::Steady, &[0.0, 1.0]).unwrap().contains("at rest in row 2"));
    assert_eq!(refused(Mode::Steady, &[0.99]), None);
    assert_eq!(refused(Mode::Transient, &[1.0]), None);
    let text = refused(Mode::Steady, &[0.5, 1.5]).unwrap();
    assert!(text.contains("the surface of `wheel` passes at -19.4"), "{text}");
}

/// A model without heat exchange between the surfaces advises the one that has it, and for a body
/// at rest nothing else.
#[test]
fn a_body_at_rest_is_guided_to_equal_temperatures() {
    let fix = |speed: Option<f64>| {
        let mut case = steel();
        case["effects"]["friction_heat"]["partition"] = serde_json::json!("continuity");
        if let Some(speed) = speed {
            case["bodies"]["wheel"]["surface_speed"] = serde_json::json!(speed);
        }
        let given = configuration("columns", Mode::Transient, row(10, -1.0, 1.0), case);
        ThermalSolver.configure(&given).err().unwrap().fix
    };
    assert_eq!(fix(Some(0.0)), "write [thermal] model = \"moving-source\"");
    assert!(fix(None).ends_with("or \"effusivity\", which is the same at high speed"));
}

#[test]
fn a_grid_not_yet_known_can_be_planned_but_not_built() {
    let grid = row(10, -1.0, 1.0);
    let mut given = configuration("columns", Mode::Steady, grid, steel());
    given.inputs[0].grid = None;
    let setup = ThermalSolver.configure(&given).unwrap();
    assert!(setup.layout().grids.is_empty() && !setup.layout().remarks.is_empty());
    assert!(setup.build(&proto::progress::Progress::default()).is_err());
}

#[test]
fn refusals_name_key_and_fix() {
    let grid = row(10, -1.0, 1.0);
    let refused = |model: &str, mode, grid, case| {
        ThermalSolver.configure(&configuration(model, mode, grid, case)).err().unwrap()
    };
    assert_eq!(refused("spectral", Mode::Steady, grid, steel()).key, "thermal.model");
    assert_eq!(refused("ertz-knothe", Mode::Transient, grid, steel()).key, "time.mode");
    let mut case = steel();
    case["effects"] = serde_json::json!({});
    assert_eq!(refused("columns", Mode::Steady, grid, case).key, "effects.friction_heat");
    let mut turned = grid;
    turned.step_i = [0.0, 1e-3, 0.0];
    assert_eq!(refused("columns", Mode::Steady, turned, steel()).key, "mech.model");
}

#[test]
fn faulty_inputs_are_named_and_change_nothing() {
    let grid = row(10, -1.0, 1.0);
    for model in ["ertz-knothe", "columns"] {
        let mut run = Run::steady(model, grid);
        run.advance(&ellipse_means(&grid), 0.0);
        let before = run.model.summary();
        let mut flux = ellipse_means(&grid);
        flux[13] = f64::NAN;
        let error = run.try_solve(&flux, 0.0).unwrap_err();
        assert!(matches!(&error, StepError::NonFiniteInput { field, index: 13, .. }
            if field == "friction_power"));
        for speed in [0.0, -1.0] {
            run.given.speeds = vec![1.0, speed];
            let error = run.try_solve(&[1.0; 21], 0.0).unwrap_err().to_string();
            let why = if speed < 0.0 { "passes at -1 m/s" } else { "is at rest" };
            assert!(error.contains("`rail`") && error.contains(why), "{error}");
        }
        run.given.speeds = vec![1.0, f64::INFINITY];
        let error = run.try_solve(&[1.0; 21], 0.0).unwrap_err();
        assert!(matches!(error, StepError::NonFiniteInput { index: 1, .. }));
        run.given.speeds = vec![1.0, 1.0];
        let error = run.try_solve(&[1.0; 20], 0.0).unwrap_err().to_string();
        assert!(error.contains("20 values, not 21"), "{error}");
        run.given.flux = None;
        let step = proto::model::Step::STEADY;
        let error = run.model.solve(&step, &run.given, &mut run.surfaces).unwrap_err();
        assert_eq!(error, StepError::MissingInput { field: "friction_power".to_owned() });
        run.model.accept();
        assert_eq!(run.model.summary(), before);
    }
    let mut run = Run::transient(grid);
    assert!(run.try_solve(&[1.0; 21], 0.0).unwrap_err().to_string().contains("lasts 0 s"));
}

#[test]
fn a_flux_of_both_signs_is_like_no_ellipse() {
    let grid = row(10, -1.0, 1.0);
    let mut run = Run::steady("ertz-knothe", grid);
    let mut flux = vec![0.0; grid.ni];
    (flux[2], flux[10], flux[18]) = (-1.0, 3.0, -1.0);
    assert!(run.try_solve(&flux, 0.0).unwrap_err().to_string().contains("row 0"));
}

#[test]
fn no_heat_no_rise_and_no_place_of_it() {
    let grid = Structured::contact_plane(-4e-3, -1e-3, 2e-4, 5e-4, 40, 4);
    for model in ["ertz-knothe", "columns"] {
        let mut run = Run::steady(model, grid);
        run.model.first_outputs(&mut run.surfaces);
        assert!(run.rail().iter().chain(run.wheel()).all(|rise| *rise == 0.0));
        let cold = serde_json::json!({"max_rise_k": 0.0});
        assert_eq!(run.model.summary()["temperature"]["rail"], cold);
        let report = run.advance(&vec![0.0; grid.points()], 0.0);
        assert_eq!((report.work, report.received_power), (0, Some(0.0)));
        assert!(run.rail().iter().all(|rise| *rise == 0.0));
        assert_eq!(run.model.summary()["temperature"]["wheel"], cold);
    }
}

#[test]
fn cooling_mirrors_heating() {
    let grid = row(10, -1.0, 1.0);
    let flux = ellipse_means(&grid);
    let cooling: Vec<f64> = flux.iter().map(|q| -q).collect();
    for model in ["ertz-knothe", "columns"] {
        let (mut warm, mut cold) = (Run::steady(model, grid), Run::steady(model, grid));
        warm.advance(&flux, 0.0);
        cold.advance(&cooling, 0.0);
        assert!(warm.rail().iter().zip(cold.rail()).all(|(a, b)| *a == -*b));
        assert_eq!(cold.summary("rail", "max_rise_k"), Some(0.0));
    }
}

#[test]
fn summary_names_the_hottest_row() {
    let grid = Structured::contact_plane(-1.2 * SEMI_AXIS, -3e-3, SEMI_AXIS / 20.0, 1e-3, 48, 8);
    let line = ellipse_means(&grid);
    let strength = |row: usize| 1e9 / (1.0 + (row as f64 - 5.0).powi(2));
    let flux: Vec<f64> =
        (0..8).flat_map(|row| line.iter().map(move |q| q * strength(row))).collect();
    for model in ["ertz-knothe", "columns"] {
        let mut run = Run::steady(model, grid);
        run.advance(&flux, 0.0);
        for body in ["rail", "wheel"] {
            // Tolerance: rounding of the row's position.
            assert!((run.summary(body, "y_m").unwrap() - 2e-3).abs() < 1e-15);
            let place = run.summary(body, "x_m").unwrap() / SEMI_AXIS;
            assert!((place + 0.65).abs() < 0.01, "{place}");
        }
    }
}

#[test]
fn work_is_counted_exactly() {
    let grid = Structured::contact_plane(0.0, 0.0, 1e-4, 1e-4, 24, 3);
    let mut flux = vec![1.0; 72];
    flux[24..48].fill(0.0);
    // Two warm rows; three blocks of eight use 25, 17 and 9 pairs of weights.
    let mut run = Run::steady("columns", grid);
    assert_eq!(run.solve(&flux, 0.0).work, 2 * (25 + 17 + 9) * 16);
    // One value of the closed form at every point of a warm row, for both bodies.
    let mut run = Run::steady("ertz-knothe", grid);
    assert_eq!(run.solve(&flux, 0.0).work, 2 * 24);
    // By Fourier transforms: three of length 486, and four products for each coefficient.
    let grid = Structured::contact_plane(0.0, 0.0, 1e-4, 1e-4, 241, 1);
    let mut run = Run::steady("columns", grid);
    assert_eq!(run.solve(&[1.0; 241], 0.0).work, 3 * 486 * 9 + 8 * 244);
}
