//! Coupling round trip: coordinator and two trivial participants, three real processes, one scalar
//! field each way, serial and explicit. The time is that of one window: two solves, four control
//! messages, two fields of n doubles, the finiteness check of both, and the acceptance.

use coordinator::case::RawCase;
use coordinator::couple::Coupling;
use coordinator::plan::plan;
use coordinator::session::Session;
use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use proto::model::Step;
use std::time::{Duration, Instant};

/// The participants lie where cargo puts executables, one folder above the bench's own.
fn program(name: &str) -> String {
    let bench = std::env::current_exe().expect("a running program has a path");
    let folder = bench.parent().and_then(|deps| deps.parent()).expect("target/PROFILE/deps");
    let path = folder.join(name);
    assert!(path.is_file(), "{} is missing: run `cargo build --release`", path.display());
    path.display().to_string()
}

fn case(points: usize) -> String {
    let (left, right) = (program("toy-left"), program("toy-right"));
    format!(
        "[case]\nname = \"exchange\"\n\
         [left]\nmodel = \"increment\"\ncommand = [{left:?}]\npoints = {points}\n\
         [right]\nmodel = \"increment\"\ncommand = [{right:?}]\npoints = {points}\n\
         [time]\nmode = \"transient\"\nwindow = 1\nend = 1e9\n\
         [coupling]\nscheme = \"serial-explicit\"\n[output]\nfields = \"none\"\n"
    )
}

fn round_trip(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("coupling");
    group.measurement_time(Duration::from_secs(5));
    for points in [1_000, 10_000, 100_000, 1_000_000] {
        let raw = RawCase::parse("bench", &case(points)).expect("the case is valid");
        let planned = plan(raw).expect("the case is valid");
        let mut session = Session::start(&planned.plan).expect("the participants start");
        let mut coupling = Coupling::explicit();
        let mut window = 0;
        group.throughput(Throughput::Elements(points as u64));
        group.bench_function(BenchmarkId::new("round_trip", points), |bencher| {
            bencher.iter_custom(|count| {
                let start = Instant::now();
                for _ in 0..count {
                    let (from, to) = (window as f64, window as f64 + 1.0);
                    let step = Step { window, iteration: 1, start: from, end: to };
                    coupling.solve_window(&mut session, &step).expect("the window is solved");
                    session.accept(&step, false).expect("the window is accepted");
                    window += 1;
                }
                start.elapsed()
            });
        });
        session.finish().expect("the participants leave");
    }
    group.finish();
}

criterion_group!(benches, round_trip);
criterion_main!(benches);
