//! Stresses on the section y = 0 below the paper's sliding ellipse at 40 depths: pressure alone,
//! with traction along x, and with traction along both axes. Further cases: a section off the
//! middle of the rows, where rows share no kernels, and direct summation for a tenth of the points.

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use grids::Structured;
use half_space::subsurface::{Section, SurfaceLoad};
use std::hint::black_box;

const NU: f64 = 0.3;

struct Scene {
    grid: Structured,
    pressure: Vec<f64>,
    traction: Vec<f64>,
    depths: Vec<f64>,
}

impl Scene {
    /// Ellipse that fills a grid of nx × ny elements.
    fn new(nx: usize, ny: usize) -> Self {
        let (dx, dy) = (2.0 / nx as f64, 1.5 / ny as f64);
        let grid = Structured::contact_plane(-1.0 + 0.5 * dx, -0.75 + 0.5 * dy, dx, dy, nx, ny);
        let at = |index: usize| {
            let [x, y, _] = grid.centre(index % nx, index / nx);
            (1.0 - x * x - (y / 0.75).powi(2)).max(0.0).sqrt()
        };
        let pressure: Vec<f64> = (0..grid.points()).map(at).collect();
        let traction = [0.3, 0.1].iter().flat_map(|f| pressure.iter().map(move |p| f * p));
        let depths = (1..=40).map(|k| 0.05 * f64::from(k)).collect();
        Self { grid, traction: traction.collect(), pressure, depths }
    }

    fn section(&self, y: f64) -> Section {
        Section::new(&self.grid, NU, y, &self.depths)
    }
}

fn subsurface(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("subsurface");
    group.sample_size(10);
    for (nx, ny) in [(50, 40), (100, 80), (200, 160)] {
        let scene = Scene::new(nx, ny);
        let mut along_x = scene.traction.clone();
        along_x[scene.pressure.len()..].fill(0.0);
        let cases: [(&str, f64, &[f64]); 4] = [
            ("pressure", 0.0, &[]),
            ("along_x", 0.0, &along_x),
            ("all_loads", 0.0, &scene.traction),
            ("all_loads_unsymmetric", 0.3 * scene.grid.dy(), &scene.traction),
        ];
        for (name, y, traction) in cases {
            let mut section = scene.section(y);
            let mut values = [vec![0.0; section.points()], vec![0.0; section.points()]];
            group.bench_function(BenchmarkId::new(name, nx), |bencher| {
                let load = SurfaceLoad::new(&scene.grid, &scene.pressure, traction);
                let [mises, shear] = &mut values;
                bencher.iter(|| black_box(section.equivalents(&load, None, mises, shear)));
            });
        }
    }
    let scene = Scene::new(100, 80);
    let load = SurfaceLoad::new(&scene.grid, &scene.pressure, &scene.traction);
    let row = |depth: &f64| (0..100).step_by(10).map(|i| (i, *depth)).collect::<Vec<_>>();
    let points = scene.depths.iter().flat_map(row).map(|(i, z)| [scene.grid.x(i), 0.0, z]);
    let points: Vec<_> = points.collect();
    group.bench_function("direct_tenth/100", |bencher| {
        bencher.iter(|| black_box(load.stresses_at(NU, &points)));
    });
    group.finish();
}

criterion_group!(benches, subsurface);
criterion_main!(benches);
