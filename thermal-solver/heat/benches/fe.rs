//! Benchmarks of a finite-element body under the moving ellipse of the paper. Measured are one step
//! of an element's passage with each solver, and the steady state; also with 2³ and 4³ times as
//! many unknowns. The heat of every other step is a tenth larger, so that each step has a change to
//! solve for.
//!
//! The first mesh has the size of the mesh in `thermal_kernel.c`, which runs beside it for
//! comparison.

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use grids::Structured;
use heat::Material;
use heat::fe::block::{Block, Elements, Solver};
use heat::fe::body::Body;
use heat::fe::body_properties::BodyProperties;
use heat::fe::conductor::Surroundings;
use heat::fe::law::Point;
use heat::fe::section::Interpolation;

const SEMI_AXES: [f64; 2] = [7.98e-3, 6.01e-3];
const SPEED: f64 = 38.889;
const STEEL: Material = Material { density: 7850.0, specific_heat: 419.5, conductivity: 50.0 };

/// A grid of 110 × 36 elements with heat, refined `times` along and across.
fn grid(times: usize) -> Structured {
    let (h, width) = (0.4e-3 / times as f64, 2.5 * SEMI_AXES[1] / (36 * times) as f64);
    let (columns, rows) = (110 * times, 36 * times);
    let from = 1.25 * SEMI_AXES[0] - columns as f64 * h;
    let side = -0.5 * (rows - 1) as f64 * width;
    Structured::contact_plane(from, side, h, width, columns, rows)
}

fn heat(grid: &Structured) -> Vec<f64> {
    let value = |at: usize| {
        let (x, y) = (grid.x(at % grid.ni), grid.y(at / grid.ni));
        let rest = 1.0 - (x / SEMI_AXES[0]).powi(2) - (y / SEMI_AXES[1]).powi(2);
        1.9e8 * rest.max(0.0).sqrt()
    };
    (0..grid.points()).map(value).collect()
}

/// Elements with 34 layers from 4 µm on, refined `times`.
fn elements(times: usize, solver: Solver) -> Elements {
    let root = 1.107_f64.powf(1.0 / times as f64);
    let first = 4e-6 * (root - 1.0) / 0.107;
    let (depth, wake) = (Some(1.1e-3), Some(1e-3));
    Elements { first_layer: Some(first), ratio: root, depth, wake, solver, ..Elements::default() }
}

fn nature(varies: bool) -> BodyProperties {
    let point = |rise: f64| {
        let part = 1.0 - 5e-4 * rise;
        Point {
            temperature: 293.15 + rise,
            conductivity: part * STEEL.conductivity,
            capacity: part * STEEL.density * STEEL.specific_heat,
        }
    };
    let points = if varies { vec![point(-100.0), point(600.0)] } else { Vec::new() };
    let surroundings = Surroundings::default();
    BodyProperties { material: STEEL, points, initial: 293.15, clamps: false, surroundings }
}

/// Returns a body and its number of unknowns.
fn body(times: usize, solver: Solver, varies: bool, steady: bool) -> (Body, usize) {
    let (grid, elements) = (grid(times), elements(times, solver));
    let block = Block::new(&grid, &STEEL, SPEED, &elements);
    let mut body = Body::new(&grid, &nature(varies), SPEED, &elements, steady);
    body.means.copy_from_slice(&heat(&grid));
    (body, if steady { grid.ni * block.across.len() * block.depth.len() } else { block.nodes() })
}

fn go(body: &mut Body, duration: f64, rise: &mut [f64], more: &mut bool) {
    let factor = if *more { 1.1 } else { 1.0 / 1.1 };
    *more = !*more;
    body.means.iter_mut().for_each(|mean| *mean *= factor);
    body.motion.pass(duration, SPEED).expect("the solver supports the speed");
    body.motion.flux().reconstruct(&body.means);
    body.motion.warm().expect("there is a solution");
    body.motion.show(Interpolation::Bounded, rise);
    body.motion.accept();
}

fn bench(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("fe");
    group.sample_size(10);
    let mut more = true;
    for times in [1, 2, 4] {
        let passing = 0.4e-3 / times as f64 / SPEED;
        let mut rise = vec![0.0; grid(times).points()];
        let kinds = [
            ("a step in modes", Solver::Auto, false),
            ("a step by iterations", Solver::Iterative, false),
            ("a step by iterations, properties over temperature", Solver::Auto, true),
        ];
        for (name, solver, varies) in kinds {
            let (mut body, unknowns) = body(times, solver, varies, false);
            (0..8).for_each(|_| go(&mut body, passing, &mut rise, &mut more));
            group.bench_function(BenchmarkId::new(name, unknowns), |bencher| {
                bencher.iter(|| go(&mut body, passing, &mut rise, &mut more));
            });
        }
        for (name, solver) in
            [("steady in modes", Solver::Auto), ("steady by a march", Solver::Iterative)]
        {
            let (mut body, unknowns) = body(times, solver, false, true);
            go(&mut body, f64::INFINITY, &mut rise, &mut more);
            group.bench_function(BenchmarkId::new(name, unknowns), |bencher| {
                bencher.iter(|| go(&mut body, f64::INFINITY, &mut rise, &mut more));
            });
        }
    }
    // A thin mesh with one matrix for all steps, factorised once.
    let grid = Structured::contact_plane(-8e-3, -1e-3, 4e-4, 4e-4, 41, 6);
    let mut rise = vec![0.0; grid.points()];
    for (name, solver) in [
        ("thin, in modes", Solver::Auto),
        ("thin, by iterations", Solver::Iterative),
        ("thin, eliminated", Solver::Direct),
    ] {
        let elements = Elements { wake: Some(8e-3), solver, ..Elements::default() };
        let mut body = Body::new(&grid, &nature(false), SPEED, &elements, false);
        body.means.copy_from_slice(&heat(&grid));
        (0..8).for_each(|_| go(&mut body, 4e-4 / SPEED, &mut rise, &mut more));
        let nodes = Block::new(&grid, &STEEL, SPEED, &elements).nodes();
        group.bench_function(BenchmarkId::new(name, nodes), |bencher| {
            bencher.iter(|| go(&mut body, 4e-4 / SPEED, &mut rise, &mut more));
        });
    }
    group.finish();
}

criterion_group!(benches, bench);
criterion_main!(benches);
