//! Half-space solvers on the paper's case at several resolutions: the normal contact, one creepage,
//! and the paper's five traction coefficients by prescribed force. Each starts from scratch and
//! includes the setup of operators.

#![allow(clippy::print_stdout, reason = "a bench reports its memory")]

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use elastic::Elasticity;
use elastic::Material;
use elastic::hertz;
use grids::Structured;
use half_space::difference::Difference;
use half_space::extent::sample;
use half_space::grid_continuation::{Contact, Levels, Motion};
use half_space::normal::{self, NormalSolver};
use half_space::tangential::PrescribedMotion;
use std::hint::black_box;

const FRICTION: f64 = 0.6;
const LOAD: f64 = 134e3;
const GAP: [f64; 2] = [0.5 / 0.46, 0.5 / 0.3];

struct Scene {
    contact: Contact,
    grid: Structured,
}

impl Scene {
    fn new(resolution: usize) -> Self {
        let steel = Material { youngs_modulus: 210e9, poisson_ratio: 0.3 };
        let bodies = Elasticity::of_pair(&steel, &steel).into();
        let hertz = hertz::elliptic_contact(GAP[0], GAP[1], LOAD, 2.0 * steel.compliance());
        let (a, b) = (hertz.semi_axis_a, hertz.semi_axis_b);
        let step = a / resolution as f64;
        let (half_x, half_y) = (resolution + 1, (b / step).ceil() as usize + 1);
        let (x0, y0) = (-(half_x as f64) * step, -(half_y as f64) * step);
        let (nx, ny) = (2 * half_x + 1, 2 * half_y + 1);
        let grid = Structured::contact_plane(x0, y0, step, step, nx, ny);
        let motion = Motion::SteadyRolling;
        Self {
            contact: Contact {
                bodies,
                layer: 0.0,
                yields: None,
                semi_axes: [a, b],
                motion,
                difference: Difference::Fromm,
                tolerance: 1e-4,
            },
            grid,
        }
    }

    fn pressure(&self) -> Vec<f64> {
        let grid = &self.grid;
        let sides = [grid.dx(), grid.dy()];
        let mut solver = NormalSolver::of_bodies(grid.ni, grid.nj, sides, &self.contact.bodies);
        let distance = sample(grid, &|x, y| GAP[0] * x * x + GAP[1] * y * y);
        let mut pressure = vec![0.0; grid.points()];
        let load = normal::Prescribed::Load(LOAD);
        solver.solve(&distance, load, &mut pressure).expect("it converges");
        pressure
    }

    fn rolling(&self, bound: &[f64], prescribed: &[PrescribedMotion]) -> f64 {
        let mut levels = Levels::new(&self.grid, &self.contact);
        let solve = |one: &PrescribedMotion| {
            let solution = levels.solve(bound, one).expect("it converges");
            solution.state.creepage[0]
        };
        prescribed.iter().map(solve).sum()
    }
}

fn half_space(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("half_space");
    group.sample_size(10);
    let forces =
        [0.58, 0.5, 0.4, 0.3, 0.2].map(|mu| PrescribedMotion::longitudinal_force(mu * LOAD));
    for resolution in [10, 20, 40, 80, 160] {
        let scene = Scene::new(resolution);
        let bound: Vec<f64> = scene.pressure().iter().map(|p| FRICTION * p).collect();
        group.bench_function(BenchmarkId::new("normal", resolution), |bencher| {
            bencher.iter(|| black_box(scene.pressure()));
        });
        group.bench_function(BenchmarkId::new("one_creepage", resolution), |bencher| {
            let creepage = [PrescribedMotion::creepages([-0.00863, 0.0, 0.0])];
            bencher.iter(|| black_box(scene.rolling(&bound, &creepage)));
        });
        group.bench_function(BenchmarkId::new("five_forces", resolution), |bencher| {
            bencher.iter(|| black_box(scene.rolling(&bound, &forces)));
        });
        println!("half_space/a/{resolution}: peak memory {} MiB so far", peak_memory() >> 20);
    }
    group.finish();
}

/// Peak resident memory of this process so far [byte].
fn peak_memory() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    let kibibytes = line.and_then(|line| line.split_whitespace().next()?.parse::<u64>().ok());
    kibibytes.unwrap_or(0) << 10
}

criterion_group!(benches, half_space);
criterion_main!(benches);
