//! Steps of a body of explicit elements: element updates a second, straight and about an axis, by size.

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use mech_solver::explicit::block::{Block, Held, Solid};
use mech_solver::explicit::section::{Section, Sizes, circle};

fn block(element: f64, radius: f64) -> Block {
    let (e, nu) = (210e9, 0.3);
    let lame = [e * nu / ((1.0 + nu) * (1.0 - 2.0 * nu)), 0.5 * e / (1.0 + nu)];
    let sizes = Sizes { element, fine: [10e-3, 6e-3], whole: [48e-3; 2], middle: 0.0 };
    let columns = (96e-3 / element).ceil() as usize;
    let solid = Solid { lame, density: 7850.0, flow: None, radius };
    let mut block = Block::new(
        columns,
        element,
        Section::new(&sizes, circle(f64::INFINITY)),
        solid,
        Held::Faces,
    );
    // Numbers that move, so that nothing is denormal.
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

criterion_group!(benches, steps);
criterion_main!(benches);
