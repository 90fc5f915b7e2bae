//! A grid that moves during the run: mapped heat is conserved, and values arrive at the right
//! positions.

use crate::harness::{Ended, Place, case, completed, number, sets};
use proto::grid::{Grid, Quadrilaterals, Shape};
use run::plan::{sample_bytes, topic_bytes};
use serde_json::Value;
use tests::moving::{flux, patch, plate};

fn run(settings: &[&str]) -> (Place, Value) {
    completed("moving.toml", settings)
}

fn failed(settings: &[&str]) -> Ended {
    let place = Place::new();
    let ended = place.run(&case("moving.toml"), &sets(settings));
    assert_eq!(ended.code, Some(1), "{}", ended.stderr);
    ended
}

/// Heat of the flux law on a plane grid, by the shoelace formula for each element \[W\].
fn heat(grid: &Grid) -> f64 {
    let surface = match &grid.shape {
        Shape::Structured(s) => Quadrilaterals::from(s),
        Shape::Quadrilaterals(q) => q.clone(),
        Shape::Vertices(_) | Shape::Volume(_) | Shape::Points(_) => {
            unreachable!("the patch is a surface")
        }
    };
    let of = |vertices: &[u32; 4]| {
        let corners = vertices.map(|v| surface.points[v as usize]);
        let shoelace = (0..4).map(|k| {
            let ([x0, y0, _], [x1, y1, _]) = (corners[k], corners[(k + 1) % 4]);
            0.5 * (x0 * y1 - x1 * y0)
        });
        let centre = [0, 1, 2].map(|k| 0.25 * corners.iter().map(|c| c[k]).sum::<f64>());
        shoelace.sum::<f64>() * flux(centre)
    };
    surface.elements.iter().map(of).sum()
}

const SCHEMES: [&str; 3] = ["serial-explicit", "serial-implicit", "parallel-implicit"];
/// Motions, and whether the grid grows: a field on a growing grid cannot be fed back.
const MOTIONS: [(&str, bool); 3] = [("translate", false), ("grow", true), ("stretch", false)];

/// Every motion with every scheme that supports it.
fn all() -> impl Iterator<Item = (&'static str, &'static str)> {
    let fits = |(motion, grows): (&'static str, bool)| {
        let schemes = SCHEMES.into_iter().filter(move |s| !grows || *s != "parallel-implicit");
        schemes.map(move |scheme| (motion, scheme))
    };
    MOTIONS.into_iter().flat_map(fits)
}

/// The heat sent arrives in every iteration; the bound 1e-10 is the one of the protocol. It equals
/// the flux on the moved grid, to rounding, in the last iteration of a window.
#[test]
fn heat_arrives_whole_in_every_window() {
    for (motion, scheme) in all() {
        for direct in ["plate.direct=false", "plate.direct=true"] {
            let set = [&format!("mover.motion={motion}"), direct];
            let scheme = format!("coupling.scheme={scheme}");
            let (place, summary) = run(&[set[0], set[1], &scheme]);
            assert!(number(&summary, "/coupling/energy_imbalance") <= 1e-10, "{set:?}");
            let heads = ["window", "heat_sent_w", "heat_received_w"];
            let rows = place.table("iterations.csv").columns(heads);
            for (row, next) in rows.iter().zip(rows.iter().skip(1).chain([&[f64::NAN; 3]])) {
                let [window, sent, received] = *row;
                assert!((sent - received).abs() <= 1e-10 * sent, "{set:?}: {row:?}");
                let expected = heat(&patch(motion, window as u64));
                let last = next[0] != window;
                // Iterates are within the tolerance 1e-9 of the values sent by the mover.
                let exact = (sent - expected).abs() <= 2e-9 * expected;
                assert!(exact || !last, "{set:?}, {scheme}: {sent} {expected}");
            }
            assert_eq!(number(&summary, "/plate/windows"), 10.0);
        }
    }
}

/// Bilinear interpolation between the plate's centres: |error| ≤ h²/8 (max |T_xx| + max |T_yy|),
/// and T ≥ 1 K. Mapping to the patch of the previous window would be wrong by some 0.03 K.
#[test]
fn temperatures_arrive_where_the_grid_has_moved_to() {
    for (motion, _) in MOTIONS {
        let errors = [26, 52, 104].map(|resolution| {
            let set = [format!("mover.motion={motion}"), format!("plate.resolution={resolution}")];
            let (_, summary) = run(&[&set[0], &set[1]]);
            assert_eq!(number(&summary, "/mover/grid_revision"), 10.0, "{motion}");
            let (h, error) =
                (4.0 / f64::from(resolution), number(&summary, "/mover/largest_error"));
            assert!(error <= h * h / 8.0 * (1.3 * 1.3 + 0.9 * 0.9), "{motion}: {error:e}");
            error
        });
        let order = (errors[0] / errors[2]).log2() / 2.0;
        println!("{motion}: {errors:?}, order {order:.2}");
        assert!(order > 1.8, "{motion}: {errors:?}");
    }
}

/// A consumer that receives the producer's field, or the iterates, on the moving grid finds every
/// value at its position: exactly, or within the tolerance 1e-9 of the norm of 384 values for a
/// single value.
#[test]
fn who_hears_it_directly_sees_the_grid_move() {
    for (motion, scheme) in all() {
        let motion = format!("mover.motion={motion}");
        let set = format!("coupling.scheme={scheme}");
        let (_, summary) = run(&[&motion, &set, "plate.direct=true"]);
        let error = number(&summary, "/plate/largest_error");
        let bound = if scheme == "parallel-implicit" { 1e-9 * 384_f64.sqrt() } else { 0.0 };
        assert!(error <= bound, "{motion}, {scheme}: {error:e}");
        assert_eq!(number(&summary, "/plate/grid_revision"), 10.0, "{motion}, {scheme}");
    }
}

/// Number of times each mapping was computed, from the log at the end of a run.
fn made(place: &Place) -> Vec<u64> {
    let is = |event: &&Value| event["fields"]["message"] == "mapping made";
    place.log().iter().filter(is).map(|e| e["fields"]["times"].as_u64().unwrap()).collect()
}

/// A mapping is computed at the start and after each move that is followed by a window, regardless
/// of the number of iterations.
#[test]
fn mappings_are_made_as_often_as_the_grid_moves() {
    for (every, times) in [(1, 10), (3, 4), (9, 2)] {
        let every = format!("mover.every={every}");
        for scheme in SCHEMES {
            let scheme = format!("coupling.scheme={scheme}");
            let set = ["mover.motion=stretch", &every, &scheme, "moving.gain=0.1"];
            let (place, _) = run(&set);
            assert_eq!(made(&place), [times, times], "{set:?}");
        }
    }
    let (place, _) = run(&["mover.motion=none", "moving.gain=0.1"]);
    assert!(made(&place).is_empty(), "what stays is mapped by the one mapping");
    assert!(place.log().iter().all(|event| !event.to_string().contains("grid moved")));
}

#[test]
fn files_are_on_the_grid_of_their_window() {
    for (motion, kind) in [("translate", "vti"), ("grow", "vti"), ("stretch", "vtu")] {
        let motion_set = format!("mover.motion={motion}");
        let set = [&motion_set, "output.fields=all", "output.every=1"];
        let (place, _) = run(&set);
        for window in 0..10 {
            let file = format!("fields/mover_patch_{window:06}");
            assert!(place.out().join(format!("{file}.{kind}")).exists(), "{file}.{kind}");
            let grid = patch(motion, window);
            let Some(shape) = grid.as_structured() else { continue };
            let heads = ["x [m]", "moving_place_x [m]", "moving_flux [W/m2]", "y [m]"];
            let rows = place.table(&format!("{file}.csv")).columns(heads);
            assert_eq!(rows.len(), shape.ni, "{file}");
            for (i, [x, place, q, y]) in rows.into_iter().enumerate() {
                assert_eq!((x, place), (shape.x(i), shape.x(i)), "{file}");
                assert_eq!(q, flux([x, y, 0.0]), "{file}");
            }
        }
    }
}

#[test]
fn what_is_fed_back_does_not_grow() {
    let ended = failed(&["mover.motion=grow", "coupling.scheme=parallel-implicit"]);
    for part in [
        "mover (toy) failed while accepting window 0",
        "grid `patch` has changed from 384 to 400 elements, but `moving_flux` on it is compared",
        "keep the number of its elements",
    ] {
        assert!(ended.stderr.contains(part), "{part}: {}", ended.stderr);
    }
}

/// Linear interpolation within a window requires the same number of values at start and end.
#[test]
fn what_varies_within_a_window_does_not_grow() {
    let ended = failed(&["mover.motion=grow", "coupling.interpolation=linear"]);
    for part in ["mover (toy) failed in window 1", "from 384 values to 400", "constant"] {
        assert!(ended.stderr.contains(part), "{part}: {}", ended.stderr);
    }
    run(&["mover.motion=translate", "coupling.interpolation=linear"]);
}

/// The shared memory suffices for the initial grids, but not for a growing one.
#[test]
fn shared_memory_is_checked_again_when_a_grid_grows() {
    let bytes = |points: usize, components| topic_bytes(sample_bytes(points, components));
    let (patch, plate) = (patch("grow", 0).points(), plate(53).points());
    // The two fields and their mapped values, and the geometry of four vectors.
    let needed = (1 << 20) + 2 * (bytes(patch, 1) + bytes(plate, 1)) + bytes(4, 3);
    let limit = |bytes: u64| format!("limits.shared_memory={bytes}");
    run(&["mover.motion=translate", &limit(needed)]);
    let ended = failed(&["mover.motion=grow", &limit(needed)]);
    let what =
        "shared memory failed while accepting window 0: the fields need 0.2 MiB, but only 0.0 MiB";
    assert!(ended.stderr.contains(what), "{}", ended.stderr);
    let ended = failed(&["mover.motion=translate", &limit(needed - 1)]);
    assert!(ended.stderr.contains("before the fields were created"), "{}", ended.stderr);
}

/// 384 elements grow to 3568, nine times the capacity of the first segments.
#[test]
fn a_grid_may_grow_far() {
    let (place, summary) = run(&["mover.motion=grow", "time.end=200", "plate.direct=true"]);
    assert_eq!(number(&summary, "/plate/largest_error"), 0.0);
    assert_eq!(patch("grow", 199).points(), 3568);
    let rows = place.table("iterations.csv").columns(["window", "heat_sent_w"]);
    let [window, sent] = rows[rows.len() - 1];
    assert_eq!(window, 199.0);
    assert!((sent / heat(&patch("grow", 199)) - 1.0).abs() < 1e-12, "rounding");
}

/// 384 elements grow to 5168 while every segment is doubled only four times. iceoryx2 has 254
/// segments per topic, which no field may exhaust.
#[test]
fn a_grid_may_grow_in_every_window() {
    let (place, summary) = run(&["mover.motion=grow", "time.end=300", "output.fields=none"]);
    assert_eq!(number(&summary, "/mover/windows"), 300.0);
    let rows = place.table("iterations.csv").columns(["heat_sent_w"]);
    let sent = rows[rows.len() - 1][0];
    assert!((sent / heat(&patch("grow", 299)) - 1.0).abs() < 1e-12, "rounding");
}

/// A repeated window starts from the same grid.
#[test]
fn adaptive_windows_keep_to_the_accepted_grid() {
    for (motion, _) in MOTIONS {
        let motion = format!("mover.motion={motion}");
        let set = [
            &motion,
            "time.control=adaptive",
            "time.tolerance=1e-2",
            "plate.direct=true",
            "plate.resolution=19",
        ];
        let (_, summary) = run(&set);
        assert_eq!(number(&summary, "/plate/largest_error"), 0.0, "{motion}");
        let windows = number(&summary, "/coupling/windows");
        assert_eq!(number(&summary, "/mover/windows"), windows, "{motion}");
        assert_eq!(number(&summary, "/plate/grid_revision"), windows, "{motion}");
    }
}

#[test]
fn the_plan_tells_what_may_move() {
    let plan = |settings: &[&str]| Place::new().plan(&case("moving.toml"), &sets(settings)).stdout;
    let told = "grid `patch` of mover may move between windows";
    assert!(plan(&[]).contains(told), "{}", plan(&[]));
    assert!(!plan(&["mover.motion=none"]).contains("may move"));
    // The 53 × 27 elements of the plate are fed back.
    let history = "keeps up to 100 secant columns of 1431 values: 2.29 MB";
    assert!(plan(&[]).contains(history), "{}", plan(&[]));
    let constant = plan(&["coupling.acceleration=constant"]);
    assert!(!constant.contains("keeps up to"), "{constant}");
}
