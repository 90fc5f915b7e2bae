//! Benchmark of the socket between a program and its launcher: the messages of one window, with one
//! scalar of the program and one for it at every vertex. The throughput counts the values, eight
//! bytes each.

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use precice::protocol::{Answer, Request, Window, receive, send};
use std::os::unix::net::UnixStream;

/// Answers each window with values of the same length, until the program has ended.
fn answer(mut program: UnixStream) {
    let mut buffer = Vec::new();
    while let Ok(Request::Advance { values, .. }) = receive(&mut program, &mut buffer) {
        let window = Window { length: 1.0, repeats: false, ends: values, starts: Vec::new() };
        send(&mut program, &Answer::Window(window), &mut buffer).expect("the program listens");
    }
}

fn window(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("precice/window");
    for vertices in [1_000_usize, 10_000, 100_000] {
        let (mut launcher, program) = UnixStream::pair().expect("a pair of sockets");
        let answering = std::thread::spawn(move || answer(program));
        let values: Vec<f64> = (0..vertices).map(|vertex| vertex as f64).collect();
        let request = Request::Advance { values: vec![values], steps: 1 };
        let mut buffer = Vec::new();
        group.throughput(Throughput::Bytes(2 * 8 * vertices as u64));
        group.bench_function(BenchmarkId::from_parameter(vertices), |bencher| {
            bencher.iter(|| {
                send(&mut launcher, &request, &mut buffer).expect("the launcher listens");
                receive::<Answer>(&mut launcher, &mut buffer).expect("an answer")
            });
        });
        drop(launcher);
        answering.join().expect("the launcher ends");
    }
    group.finish();
}

criterion_group!(benches, window);
criterion_main!(benches);
