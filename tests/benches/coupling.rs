//! Cost of the coupling: coordinator and two toy participants, three processes, one field each way.
//!
//! `columns/m/n` is the table over field size n and number of secant columns m. Without columns it
//! times a window of an explicit scheme: two solves, four control messages, two fields of n
//! doubles, the check of both for finite values, and the acceptance. With columns it times one of
//! ten iterations of `iqn-ils`, including the iterate and the residual, after m columns have been
//! filled. `columns/fresh` discards the columns after each window, which ends with nine. The time
//! of the participants is included; they copy the field once and multiply it once. `accelerator`
//! times the computation of the iterate alone, with the same columns.

use case::RawCase;
use coupling::settings::{Acceleration, Implicit};
use coupling::{Coupling, accelerate, parts};
use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use faer::linalg::solvers::SolveLstsq;
use proto::model::Step;
use run::fleet::Fleet;
use run::plan::{Planned, plan};
use run::progress::silent;
use run::record::{Compression, Recorder};
use run::session::{Observed, Session};
use std::sync::Arc;
use std::time::{Duration, Instant};

const SIZES: [usize; 4] = [1_000, 10_000, 100_000, 1_000_000];
/// Iterations per window.
const ITERATIONS: u32 = 10;

/// Cargo puts executables one folder above the one of the bench.
fn toy(name: &str) -> [String; 2] {
    let bench = std::env::current_exe().expect("a running program has a path");
    let folder = bench.parent().and_then(|deps| deps.parent()).expect("target/PROFILE/deps");
    let path = folder.join("toy");
    assert!(path.is_file(), "{} is missing: run `cargo build --release`", path.display());
    [path.display().to_string(), name.to_owned()]
}

fn planned(case: &str) -> Planned {
    let raw = RawCase::parse("bench", case).expect("the case is TOML");
    plan(raw, &mut Fleet::for_one_run()).expect("the case is valid")
}

const TIME: &str = "[time]\nmode = \"transient\"\nwindow = 1\nend = 1e9\n\
                    [output]\nfields = \"none\"\n";

fn explicit(points: usize) -> Planned {
    let (left, right) = (toy("left"), toy("right"));
    planned(&format!(
        "[case]\nname = \"exchange\"\n\
         [left]\nmodel = \"increment\"\ncommand = {left:?}\npoints = {points}\n\
         [right]\nmodel = \"increment\"\ncommand = {right:?}\npoints = {points}\n\
         {TIME}[coupling]\nscheme = \"serial-explicit\"\n"
    ))
}

/// Ten iterations per window, regardless of the residual. Columns of enough earlier windows are
/// reused to fill `columns`; if zero, each window starts without columns.
fn implicit(points: usize, columns: u32) -> Planned {
    let (relay, operator) = (toy("relay"), toy("operator"));
    let (reuse, most) = (columns.div_ceil(ITERATIONS - 1), columns.max(ITERATIONS));
    planned(&format!(
        "[case]\nname = \"linear\"\n\
         [linear]\nproblem = \"diagonal\"\nsize = {points}\n\
         [relay]\nmodel = \"identity\"\ncommand = {relay:?}\n\
         [operator]\nmodel = \"affine\"\ncommand = {operator:?}\n\
         {TIME}[coupling]\nacceleration = \"iqn-ils\"\nreuse_windows = {reuse}\n\
         max_columns = {most}\nmin_iterations = {ITERATIONS}\nmax_iterations = {ITERATIONS}\n"
    ))
}

fn step(window: u64) -> Step {
    Step { window, iteration: 1, start: window as f64, end: window as f64 + 1.0 }
}

/// Solves and accepts windows.
fn windows(session: &mut Session, coupling: &mut Coupling, from: &mut u64, count: u64) {
    for _ in 0..count {
        coupling.solve_window(session, &step(*from)).expect("the window is solved");
        session.accept(&step(*from), Observed::Nobody).expect("the window is accepted");
        *from += 1;
    }
}

/// Table of n × columns.
fn columns(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("columns");
    group.measurement_time(Duration::from_secs(2)).sample_size(10);
    group.warm_up_time(Duration::from_millis(500));
    for points in SIZES {
        group.throughput(Throughput::Elements(points as u64));
        for (name, columns) in
            [("0", None), ("fresh", Some(0)), ("10", Some(10)), ("100", Some(100))]
        {
            let plan = columns.map_or_else(|| explicit(points), |m| implicit(points, m)).plan;
            let mut session = Session::start(&plan, &mut Fleet::for_one_run(), None, &silent())
                .expect("the participants start");
            let (mut coupling, solves) = match columns {
                None => (Coupling::explicit(), 1),
                Some(_) => (Coupling::implicit(&plan.implicit, false, &session), ITERATIONS),
            };
            let mut window = 0;
            // Runs until the number of columns no longer grows.
            let before = columns.map_or(1, |m| u64::from(m / (ITERATIONS - 1)) + 2);
            windows(&mut session, &mut coupling, &mut window, before);
            group.bench_function(BenchmarkId::new(name, points), |bencher| {
                bencher.iter_custom(|count| {
                    let start = Instant::now();
                    windows(&mut session, &mut coupling, &mut window, count);
                    start.elapsed() / solves
                });
            });
            session.finish(&mut Fleet::for_one_run()).expect("the participants leave");
        }
    }
    group.finish();
}

/// Window of the explicit scheme with a recording; the file is on the disk of the target folder.
/// Few windows a measurement, to limit the disk space; the time is that of a window.
fn recording(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("recording");
    group.measurement_time(Duration::from_secs(2)).sample_size(10);
    // The processes restart for each measurement, which takes longer than a window.
    group.warm_up_time(Duration::from_millis(100));
    let folder = std::env::current_exe().expect("a running program has a path");
    let path = folder.with_file_name("bench-recording.mcap");
    for (name, compression) in
        [("off", None), ("on", Some(Compression::None)), ("lz4", Some(Compression::Lz4))]
    {
        for points in SIZES {
            let plan = explicit(points).plan;
            let most = (200_000_000 / points as u64).clamp(20, 20_000) / 8;
            // Two fields of `points` doubles per window.
            group.throughput(Throughput::Bytes(16 * points as u64));
            group.bench_function(BenchmarkId::new(name, points), |bencher| {
                bencher.iter_custom(|count| {
                    let start =
                        |c| Recorder::start(&path, c, &plan, "").expect("the disk has room");
                    let recorder = compression.map(start).map(Arc::new);
                    let mut session = Session::start(
                        &plan,
                        &mut Fleet::for_one_run(),
                        recorder.clone(),
                        &silent(),
                    )
                    .expect("the participants start");
                    let (mut coupling, mut window) = (Coupling::explicit(), 0);
                    windows(&mut session, &mut coupling, &mut window, 3);
                    let (begun, done) = (Instant::now(), count.min(most));
                    windows(&mut session, &mut coupling, &mut window, done);
                    recorder.as_ref().map(|r| r.wait_for_room()).transpose().expect("it writes");
                    let spent = begun.elapsed();
                    session.finish(&mut Fleet::for_one_run()).expect("the participants leave");
                    if let Some(recorder) = recorder {
                        recorder.finish(None).expect("the disk has room");
                    }
                    spent.mul_f64(count as f64 / done as f64)
                });
            });
        }
    }
    group.finish();
    let _ = std::fs::remove_file(&path);
}

/// Accelerator without processes, on x ↦ Λx + b. The vector b changes in every window, so that
/// columns of earlier windows stay independent.
struct Alone {
    accelerator: Box<dyn accelerate::Accelerator>,
    sent: Vec<f64>,
    returned: Vec<f64>,
    right: Vec<f64>,
}

impl Alone {
    fn new(settings: &Implicit, points: usize) -> Self {
        // Pseudo-random numbers by two rounds of multiplication and shift.
        let mix = |x: u64| (x ^ (x >> 29)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let number = |i: usize| mix(mix(i as u64 + 1)) as f64 / u64::MAX as f64;
        Self {
            accelerator: accelerate::build(settings, &parts([("x", points)])),
            sent: vec![0.0; points],
            returned: vec![0.0; points],
            right: (0..points).map(number).collect(),
        }
    }

    /// Performs a window of ten iterations.
    fn window(&mut self) {
        let Self { accelerator, sent, returned, right } = self;
        let size = sent.len() as f64;
        right.rotate_left(1);
        accelerator.begin_window();
        for iteration in 1..=ITERATIONS {
            for (index, (out, sent)) in returned.iter_mut().zip(&*sent).enumerate() {
                *out = 0.95 * (2.0 * index as f64 / size - 1.0) * sent + right[index];
            }
            match iteration {
                ITERATIONS => accelerator.accept_window(sent, returned),
                _ => _ = accelerator.next(sent, returned),
            }
        }
    }
}

fn accelerator(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("accelerator");
    group.measurement_time(Duration::from_secs(2)).sample_size(10);
    group.warm_up_time(Duration::from_millis(500));
    let kinds = [
        (Acceleration::Aitken, 0),
        (Acceleration::Anderson, 0),
        (Acceleration::IqnIls, 0),
        (Acceleration::IqnIls, 100),
    ];
    for (kind, columns) in kinds {
        let name = if columns > 0 { "iqn-ils-100" } else { kind.word() };
        for points in [1_000, 100_000] {
            let settings = implicit(points, columns).plan.implicit;
            let settings = Implicit { acceleration: kind, ..settings };
            let mut alone = Alone::new(&settings, points);
            (0..=columns / (ITERATIONS - 1)).for_each(|_| alone.window());
            group.throughput(Throughput::Elements(points as u64));
            group.bench_function(BenchmarkId::new(name, points), |bencher| {
                bencher.iter_custom(|count| {
                    let start = Instant::now();
                    for _ in 0..count {
                        alone.window();
                    }
                    start.elapsed() / ITERATIONS
                });
            });
        }
    }
    group.finish();
}

/// Least-squares solution by faer's QR factorisation of all columns, computed anew as in every
/// iteration. Reference for the Gram matrix of the accelerators (`accelerator/iqn-ils`, whose time
/// also contains the update of the iterate).
fn factorisation(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("faer_qr");
    group.measurement_time(Duration::from_secs(3)).sample_size(10);
    faer::set_global_parallelism(faer::Par::Seq);
    for (points, columns) in [(1_000, 10), (100_000, 10), (100_000, 100)] {
        let entry = |row: usize, column: usize| ((row * 31 + column * 17) as f64).sin();
        let matrix = faer::Mat::from_fn(points, columns, entry);
        let right = faer::Mat::from_fn(points, 1, |row, _| (row as f64).cos());
        group.throughput(Throughput::Elements(points as u64));
        group.bench_function(BenchmarkId::new(columns.to_string(), points), |bencher| {
            bencher.iter(|| matrix.qr().solve_lstsq(&right));
        });
    }
    group.finish();
}

criterion_group!(benches, columns, recording, accelerator, factorisation);
criterion_main!(benches);
