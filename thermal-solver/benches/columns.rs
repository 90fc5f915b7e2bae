//! Run time of model `columns`: both methods of the steady convolution over the length of a row,
//! from which `CROSSOVER` follows; complete steady solves for both bodies; windows in transient
//! motion.

#[path = "../tests/support/mod.rs"]
mod support;

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use heat::columns::convolution::Steady;
use heat::columns::reconstruction::Flux;
use proto::configuration::Mode;
use proto::grid::Structured;
use proto::model::Step;
use std::hint::black_box;
use support::Run;

fn row(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("row");
    for columns in [41, 81, 121, 161, 201, 241, 321] {
        let mut flux = Flux::zero(columns, 1);
        flux.reconstruct(&vec![1.0; columns]);
        let mut values = vec![0.0; columns];
        for (name, mut way) in
            [("direct", Steady::direct(columns)), ("fourier", Steady::over_fourier(columns))]
        {
            group.bench_function(BenchmarkId::new(name, columns), |bencher| {
                bencher.iter(|| way.apply(black_box(flux.row(0)), &mut values));
            });
        }
    }
    group.finish();
}

fn steady(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("steady");
    group.sample_size(20);
    for (columns, rows) in [(81, 61), (321, 241), (1281, 961)] {
        let h = 16e-3 / columns as f64;
        let grid = Structured::contact_plane(-8e-3, -6e-3, h, h, columns, rows);
        for model in ["ertz-knothe", "columns"] {
            let mut run = Run::steady(model, grid);
            run.given.flux = Some(vec![1e8; grid.points()]);
            let name = BenchmarkId::new(model, format!("{columns}x{rows}"));
            group.bench_function(name, |bencher| {
                bencher.iter(|| run.model.solve(&Step::STEADY, &run.given, &mut run.surfaces));
            });
        }
    }
    group.finish();
}

/// A window after the material has crossed the grid, with first iteration and acceptance.
fn transient(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("transient");
    group.sample_size(10);
    let (columns, rows) = (81, 61);
    let h = 16e-3 / f64::from(columns);
    let grid = Structured::contact_plane(-8e-3, -6e-3, h, h, columns as usize, rows);
    let passing = h / support::SPEED;
    for (name, part) in [("a tenth", 0.1), ("one", 1.0), ("ten", 10.0)] {
        let mut run = Run::transient(grid);
        run.given.flux = Some(vec![1e8; grid.points()]);
        let step = Step { end: part * passing, ..Step::STEADY };
        let mut window = || {
            let report = run.model.solve(&step, &run.given, &mut run.surfaces);
            run.model.accept();
            report
        };
        let crossing = (f64::from(columns) / part) as usize;
        (0..=crossing).for_each(|_| drop(window()));
        group.bench_function(BenchmarkId::new("passings of an element", name), |bencher| {
            bencher.iter(&mut window);
        });
    }
    group.finish();
}

/// Solves on one thread and on two, to show where a second thread pays.
fn threads(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("threads");
    group.sample_size(20);
    let sizes = [(81, 61), (161, 121), (321, 241), (641, 481), (1281, 961)];
    for (mode, sizes) in [(Mode::Steady, &sizes[..]), (Mode::Transient, &sizes[..3])] {
        for &(columns, rows) in sizes {
            let h = 16e-3 / columns as f64;
            let grid = Structured::contact_plane(-8e-3, -6e-3, h, h, columns, rows);
            let step = Step { end: h / support::SPEED, ..Step::STEADY };
            for threads in [1, 2] {
                let mut run = Run::on(threads, "columns", mode, grid, support::steel());
                run.given.flux = Some(vec![1e8; grid.points()]);
                let name = format!("{mode:?} {columns}x{rows}");
                group.bench_function(BenchmarkId::new(name, threads), |bencher| {
                    bencher.iter(|| {
                        let report = run.model.solve(&step, &run.given, &mut run.surfaces);
                        if mode == Mode::Transient {
                            run.model.accept();
                        }
                        report
                    });
                });
            }
        }
    }
    group.finish();
}

criterion_group!(benches, row, steady, transient, threads);
criterion_main!(benches);
