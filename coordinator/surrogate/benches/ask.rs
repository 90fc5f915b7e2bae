//! Benchmarks a surrogate of four keys, with a single figure and with thirty figures that share
//! terms.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use std::hint::black_box;
use surrogate::{
    Coordinate, Document, FittedFigure, HeldOutError, Key, Measure, Origin, SCHEMA, Scale,
    Surrogate,
};

/// Products whose weighted sum of degrees is at most 7, where the first coordinate has weight 1 and
/// the others weight 3.
fn degrees() -> Vec<Vec<u8>> {
    let all = (0..4096u32).map(|n| (0..4).map(|i| (n >> (3 * i) & 7) as u8).collect::<Vec<u8>>());
    let weight = |term: &Vec<u8>| {
        u32::from(term[0]) + 3 * term[1..].iter().map(|d| u32::from(*d)).sum::<u32>()
    };
    all.filter(|term| weight(term) <= 7).collect()
}

fn document(figures: usize) -> Document {
    let keys = ["a", "b", "c", "d"];
    let key = |key: &str| Key { key: key.to_owned(), unit: "1".to_owned(), from: 1.0, to: 2.0 };
    let coordinate = |key: &str| Coordinate { key: key.to_owned(), per: None, from: 1.0, to: 2.0 };
    let figure = |n: usize| FittedFigure {
        key: format!("figure.{n}"),
        words: "a figure".to_owned(),
        held: HeldOutError { measure: Measure::Relative, largest: 0.01, rms: 0.002 },
        scale: Scale::Log,
        negative: false,
        scales: vec![Scale::Linear, Scale::Log, Scale::Log, Scale::Log],
        coefficients: degrees().iter().enumerate().map(|(j, _)| 1.0 / (1 + j + n) as f64).collect(),
        degrees: degrees(),
    };
    Document {
        schema: SCHEMA,
        origin: Origin::default(),
        keys: keys.map(key).to_vec(),
        coordinates: keys.map(coordinate).to_vec(),
        figures: (0..figures).map(figure).collect(),
    }
}

fn ask(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("ask");
    group.throughput(Throughput::Elements(1));
    for figures in [1, 30] {
        let surrogate = Surrogate::new(&document(figures)).expect("a good document");
        let (mut room, mut n) = (surrogate.room(), 0u32);
        let name = format!("{figures} figures of {} terms", degrees().len());
        group.bench_function(name, |bencher| {
            bencher.iter(|| {
                n = n.wrapping_add(0x9e37_79b9);
                let at = [0, 8, 16, 24].map(|bit| 1.0 + f64::from(n >> bit & 255) / 255.0);
                black_box(surrogate.ask(black_box(&at), &mut room).map(|found| found[0]).ok())
            });
        });
    }
    group.finish();
}

criterion_group!(benches, ask);
criterion_main!(benches);
