//! Benchmarks of the surface under a moving flux on n × n elements: setup of a body's influence,
//! and a solve with it.

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use grids::Structured;
use heat::columns::reconstruction::Flux;
use heat::moving_source::ages::PastInterval;
use heat::moving_source::half_space::{HalfSpace, convolution};
use std::hint::black_box;

fn bench(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("moving_source");
    group.sample_size(10);
    for n in [128, 256, 512] {
        let side = 2.0 / n as f64;
        let from = -1.0 + 0.5 * side;
        let grid = Structured::contact_plane(from, from, side, side, n, n);
        let mut plan = convolution(&grid);
        for peclet in [0.0, 10.0, 1e4] {
            let name = format!("influence at Pe = {peclet}");
            group.bench_function(BenchmarkId::new(name, n), |bencher| {
                let body = HalfSpace::new(&grid, 1.0, 1.0, PastInterval::steady(2.0 * peclet));
                bencher.iter(|| body.influence(&mut plan));
            });
        }
        let body = HalfSpace::new(&grid, 1.0, 1.0, PastInterval::steady(20.0)).influence(&mut plan);
        let mut flux = Flux::zero(n, n);
        let ellipse = |at: usize| {
            let (x, y) = (grid.x(at % n), grid.y(at / n));
            (1.0 - x * x - y * y).max(0.0).sqrt()
        };
        let means: Vec<f64> = (0..n * n).map(ellipse).collect();
        let (mut fields, mut rise) = (Default::default(), vec![0.0; n * n]);
        group.bench_function(BenchmarkId::new("solve", n), |bencher| {
            bencher.iter(|| {
                flux.reconstruct(black_box(&means));
                body.add(&flux, &mut plan, &mut fields, &mut rise);
            });
        });
    }
    group.finish();
}

criterion_group!(benches, bench);
criterion_main!(benches);
