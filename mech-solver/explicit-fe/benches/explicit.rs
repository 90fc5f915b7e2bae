//! Benchmark of steps of explicit elements: element updates per second of a straight body and of
//! one about an axis, by size; of both on one and two threads; and of both with their contact.

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use explicit_fe::block::{Block, Solid, Support};
use explicit_fe::contact::Law;
use explicit_fe::plane::Plane;
use explicit_fe::rolling::{Options, RISE, Rolling};
use explicit_fe::section::{Section, Sizes, circle};
use grids::Structured;

fn block(element: f64, radius: f64) -> Block {
    let (e, nu) = (210e9, 0.3);
    let lame = [e * nu / ((1.0 + nu) * (1.0 - 2.0 * nu)), 0.5 * e / (1.0 + nu)];
    let sizes = Sizes { element, fine: [10e-3, 6e-3], whole: [48e-3; 2], middle: 0.0 };
    let columns = (96e-3 / element).ceil() as usize;
    let solid = Solid { lame, density: 7850.0, flow: None, radius };
    let crown = if radius.is_finite() { f64::INFINITY } else { 0.3 };
    let section = Section::new(&sizes, circle(crown));
    let mut block = Block::new(columns, element, section, solid, Support::Faces);
    // Nonzero values, so that nothing becomes denormal.
    let values = block.damped.iter_mut().flatten().enumerate();
    values.for_each(|(n, u)| *u = 1e-9 * ((n % 17) as f64 - 8.0));
    block
}

fn steps(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("explicit/step");
    group.sample_size(10);
    for element in [1.2e-3, 0.6e-3] {
        for (name, radius) in [("straight", f64::INFINITY), ("about an axis", 0.46)] {
            let mut block = block(element, radius);
            let step = 1.8 / block.highest_frequency();
            group.throughput(Throughput::Elements(block.elements() as u64));
            let id = BenchmarkId::new(name, block.elements());
            group.bench_function(id, |bencher| bencher.iter(|| block.step(step)));
        }
    }
    group.finish();
}

/// Steps of two bodies without contact, and of two bodies that roll on each other.
fn pairs(criterion: &mut Criterion) {
    let (element, speed) = (0.6e-3, 40.0);
    let mut group = criterion.benchmark_group("explicit/pair");
    group.sample_size(10);
    for threads in [1, 2] {
        let bodies = [block(element, 0.46), block(element, f64::INFINITY)];
        let elements: usize = bodies.iter().map(Block::elements).sum();
        let (rows, half) = (14, 18);
        let section = &bodies[1].section;
        let row =
            (0..=section.counts[0]).find(|j| section.nodes[*j][0] > -f64::from(rows) * element);
        let row = row.unwrap_or_default();
        let (x0, y0) = (-f64::from(half) * element, section.nodes[row][0]);
        let grid = Structured::contact_plane(x0, y0, element, element, 37, 28);
        let asked = Options {
            speed,
            load: 100e3,
            law: Law { coefficient: 0.6, sticks: true, flexibility: [0.0; 2] },
            creepage: -3e-3,
            force: None,
            half_length: 7e-3,
            stiffness: 1.6e9,
            threads,
        };
        let mut rolling = Rolling::new(bodies, Plane::new(grid, row), asked);
        rolling.roll(RISE + 0.5, &mut |_| ());
        let steps = (element / (speed * rolling.step)).round() as u64;
        group.throughput(Throughput::Elements(steps * elements as u64));
        group.bench_function(BenchmarkId::new("apart", threads), |bencher| {
            bencher.iter(|| (0..steps).for_each(|_| rolling.step_bodies(rolling.step)));
        });
        group.bench_function(BenchmarkId::new("rolling", threads), |bencher| {
            bencher.iter(|| rolling.roll(1e-6, &mut |_| ()));
        });
    }
    group.finish();
}

criterion_group!(benches, steps, pairs);
criterion_main!(benches);
