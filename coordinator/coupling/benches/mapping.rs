//! Mappings between structured grids of 10⁴ and 10⁵ elements, the target 1.37 times as fine:
//! `build` makes the operator, surfaces and search trees included; `apply` maps one component.

use contract::field::Mapping;
use contract::grid::{Grid, Structured};
use coupling::map::{GridMapping, Method};
use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use std::hint::black_box;

fn square(n: usize) -> Grid {
    let step = 1.0 / n as f64;
    let shape = Structured::contact_plane(0.5 * step, 0.5 * step, step, step, n, n);
    Grid::structured("square", shape)
}

fn mapping(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("mapping");
    group.sample_size(10);
    for side in [100_usize, 316] {
        let (source, target) = (square(side), square((1.37 * side as f64) as usize));
        let field: Vec<f64> = (0..source.points()).map(|n| (n % 97) as f64).collect();
        let mut mapped = vec![0.0; target.points()];
        for method in Method::ALL {
            let kind = match method {
                Method::Intersection => Mapping::Conservative,
                _ => Mapping::Consistent,
            };
            let make = || GridMapping::between(&source, &target, method, kind).expect("grids");
            let label =
                |what: &str| BenchmarkId::new(format!("{what}/{}", method.name()), side * side);
            group.bench_function(label("build"), |bencher| bencher.iter(make));
            let ready = make();
            group.bench_function(label("apply"), |bencher| {
                bencher.iter(|| ready.apply(black_box(&field), black_box(&mut mapped)));
            });
        }
    }
    group.finish();
}

criterion_group!(benches, mapping);
criterion_main!(benches);
