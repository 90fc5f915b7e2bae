//! Benchmarks of mappings between grids of 10⁴ and 10⁵ values, with a target 1.37 times as fine as
//! the source: structured grids, vertices with triangles, and vertices alone. A chosen radial basis
//! function in addition with 44 x 44 values, which have one interpolant. `build` sets up the
//! operator, surfaces and search trees included; `apply` maps one component.

use contract::field::Mapping;
use contract::grid::{Grid, Measure, Structured, Vertices};
use coupling::map::{Basis, GridMapping, Kernel, Method};
use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use std::hint::black_box;

fn square(n: usize) -> Grid {
    let step = 1.0 / n as f64;
    let shape = Structured::contact_plane(0.5 * step, 0.5 * step, step, step, n, n);
    Grid::structured("square", shape)
}

/// Returns vertices at the centres of `n` x `n` elements, with triangles if `connected`.
fn vertices(n: usize, connected: bool) -> Grid {
    let places = square(n);
    let points = (0..places.points()).map(|place| places.centre(place)).collect();
    let cells = (0..n - 1).flat_map(|j| (0..n - 1).map(move |i| (j * n + i) as u32));
    let row = n as u32;
    let halves = |a: u32| [[a, a + 1, a + row], [a + 1, a + row + 1, a + row]];
    let triangles = if connected { cells.flat_map(halves).collect() } else { Vec::new() };
    let shape = Vertices { points, edges: Vec::new(), triangles, measure: Measure::PerPoint };
    Grid::vertices("vertices", shape)
}

fn mapping(criterion: &mut Criterion) {
    mapping_between(criterion, "mapping", square);
    mapping_between(criterion, "mapping of triangles", |n| vertices(n, true));
    mapping_between(criterion, "mapping of points", |n| vertices(n, false));
    mapping_by_kernel(criterion);
}

/// Measures Wendland's C2 function with a radius of ten elements.
fn mapping_by_kernel(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("mapping by a kernel");
    group.sample_size(10);
    for side in [44_usize, 100, 316] {
        let radius = Some(10.0 / side as f64);
        let method = Method::Kernel(Kernel { basis: Basis::WendlandC2, radius });
        let (source, target) = (square(side), square((1.37 * side as f64) as usize));
        let field: Vec<f64> = (0..source.points()).map(|n| (n % 97) as f64).collect();
        let mut mapped = vec![0.0; target.points()];
        let make =
            || GridMapping::between(&source, &target, method, Mapping::Consistent).expect("grids");
        let label = |what| BenchmarkId::new(what, side * side);
        group.bench_function(label("build"), |bencher| bencher.iter(make));
        let ready = make();
        group.bench_function(label("apply"), |bencher| {
            bencher.iter(|| ready.apply(black_box(&field), black_box(&mut mapped)));
        });
    }
    group.finish();
}

fn mapping_between(criterion: &mut Criterion, name: &str, grid: fn(usize) -> Grid) {
    let mut group = criterion.benchmark_group(name);
    group.sample_size(10);
    for side in [100_usize, 316] {
        let (source, target) = (grid(side), grid((1.37 * side as f64) as usize));
        let has_elements = source.as_structured().is_some();
        let field: Vec<f64> = (0..source.points()).map(|n| (n % 97) as f64).collect();
        let mut mapped = vec![0.0; target.points()];
        for method in Method::ALL {
            if method == Method::Intersection && !has_elements {
                continue;
            }
            let kind = match method {
                Method::Intersection => Mapping::Conservative,
                _ => Mapping::Consistent,
            };
            let make = || GridMapping::between(&source, &target, method, kind).expect("grids");
            let label =
                |what: &str| BenchmarkId::new(format!("{what}/{}", method.word()), side * side);
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
