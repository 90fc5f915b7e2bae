//! Accuracy of fast theories relative to half-spaces: the positions of the Manchester benchmark,
//! case, both wheels.

use super::{STEEL, standard};
use crate::interface::Constant;
use crate::patch::Solved;
use crate::rail::{Deviation, Side};
use crate::settings::{Normal, Settings, Tangential, Vertical};
use crate::wheelset::Motion;
use elastic::fastsim::flexibility::Kind;
use std::time::Instant;

const FORCE: f64 = 10e3;
const FRICTION: f64 = 0.3;

/// Positions of the left and the right wheel, S1002 on 60E1.
fn positions() -> impl Iterator<Item = (Side, Motion)> {
    let rows = include_str!("../../../../cases/contact/histories/manchester.csv").lines().skip(2);
    let motion = |line: &str| {
        let values: Vec<f64> = line.split(',').map(|word| word.trim().parse().unwrap()).collect();
        let [_, y, roll, yaw, angular_velocity] = values[..] else { panic!("{line}") };
        Motion {
            y: 1e-3 * y,
            roll: 1e-3 * roll,
            yaw: 1e-3 * yaw,
            velocity: [2.0, 0.0, 0.0],
            angular_velocity,
            ..Motion::default()
        }
    };
    rows.flat_map(move |line| [Side::Left, Side::Right].map(|side| (side, motion(line))))
}

/// Solutions, and the run time of each [s].
fn solved(normal: Normal, tangential: Tangential) -> Vec<(Solved, f64)> {
    let settings = Settings { normal, tangential, ..Settings::new([2e-4, 2e-4], [STEEL; 2]) };
    let mut wheels = [Side::Left, Side::Right].map(|side| standard(side, settings));
    let of = |(side, motion): (Side, Motion)| {
        let wheel = &mut wheels[usize::from(side == Side::Right)];
        wheel.forget();
        let start = Instant::now();
        let vertical = Vertical::Force(FORCE);
        let solved =
            wheel.solve(&motion, &Deviation::default(), vertical, &Constant(FRICTION)).unwrap();
        (solved, start.elapsed().as_secs_f64())
    };
    positions().map(of).collect()
}

/// Errors of largest pressure, area, approach and lateral force; tangential forces are relative to
/// f N.
fn errors(one: &Solved, exact: &Solved) -> [f64; 4] {
    let most = |solved: &Solved| {
        let load = |patch: &&crate::patch::Patch| patch.load.force[2];
        solved.patches.iter().max_by(|a, b| load(a).total_cmp(&load(b))).unwrap().clone()
    };
    let area = |solved: &Solved| solved.patches.iter().map(|patch| patch.area).sum::<f64>();
    let (a, b) = (most(one), most(exact));
    let force = [0, 1].map(|k| one.force[k] - exact.force[k]);
    let normal: f64 = exact.patches.iter().map(|patch| patch.load.force[2]).sum();
    [
        (a.max_pressure / b.max_pressure - 1.0).abs(),
        (area(one) / area(exact) - 1.0).abs(),
        (a.approach / b.approach - 1.0).abs(),
        force[0].hypot(force[1]) / (FRICTION * normal),
    ]
}

fn median(mut values: Vec<f64>) -> [f64; 2] {
    values.sort_by(f64::total_cmp);
    [values[values.len() / 2], values[values.len() - 1]]
}

/// Prints the table of docs/theory/wheel-on-track.md. Tolerances: observed errors of the theories,
/// median and largest.
#[test]
fn fast_theories_are_near_half_spaces() {
    use Tangential::{Fastrip, Fastsim, HalfSpace};
    let exact = solved(Normal::HalfSpace, HalfSpace);
    for (name, normal, tangential) in [
        ("half-space, half-space", Normal::HalfSpace, HalfSpace),
        ("half-space, FASTSIM", Normal::HalfSpace, Fastsim(Kind::Blended)),
        ("half-space, FASTRIP", Normal::HalfSpace, Fastrip(Kind::Blended)),
        ("KPEC, half-space", Normal::Kpec, HalfSpace),
        ("KPEC, FASTSIM", Normal::Kpec, Fastsim(Kind::Blended)),
        ("KPEC, FASTRIP", Normal::Kpec, Fastrip(Kind::Blended)),
        ("ANALYN, FASTSIM", Normal::Analyn, Fastsim(Kind::Blended)),
        ("ANALYN, FASTRIP", Normal::Analyn, Fastrip(Kind::Blended)),
    ] {
        let fast = solved(normal, tangential);
        let pairs = fast.iter().zip(&exact);
        let all: Vec<[f64; 4]> = pairs.map(|((one, _), (exact, _))| errors(one, exact)).collect();
        let figures = [0, 1, 2, 3].map(|k| median(all.iter().map(|errors| errors[k]).collect()));
        let time = median(fast.iter().map(|(_, time)| *time).collect())[0];
        let shown = figures.map(|[middle, most]| format!("{:.2}, {:.1}", 1e2 * middle, 1e2 * most));
        eprintln!("| {name} | {} | {:.2} |", shown.join(" | "), 1e3 * time);
        assert!(figures.iter().all(|[middle, _]| *middle < 0.02), "{name} {figures:?}");
    }
}
