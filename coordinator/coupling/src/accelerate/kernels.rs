//! Inner products with columns, and linear combinations of columns. Each column is read once,
//! several columns at a time, in the widest registers of the processor. Sums always run over
//! [`LANES`] lanes and nothing is contracted, so every processor gives the same bits.
//!
//! [`share`] distributes pieces of a long vector over threads. Pieces are independent, so results
//! are bit-identical for any number of threads and any assignment. Threads live for one pass only,
//! so a pass starts no more threads than it has [`WORTH`] operations for each. On one thread
//! nothing is allocated.

use pulp::{Arch, NullaryFnOnce};
use std::sync::{Mutex, PoisonError};
use std::thread;

/// Partial sums of an inner product.
const LANES: usize = 4;
/// Number of columns read at a time.
const GROUP: usize = 4;

type Lanes = [f64; LANES];

/// Computes the inner products of two vectors with each of the columns in these slots.
pub(super) fn products<'a>(
    vectors: [&[f64]; 2],
    slots: &[usize],
    column: impl Fn(usize) -> &'a [f64],
    sums: &mut [[f64; 2]],
) {
    let sums = &mut sums[..slots.len()];
    Arch::new().dispatch(Products { vectors, slots, column, sums });
}

struct Products<'s, C> {
    vectors: [&'s [f64]; 2],
    slots: &'s [usize],
    column: C,
    sums: &'s mut [[f64; 2]],
}

impl<'a, C: Fn(usize) -> &'a [f64]> NullaryFnOnce for Products<'_, C> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Self { vectors, slots, column, sums } = self;
        let (groups, rest) = slots.as_chunks::<GROUP>();
        let (group_sums, rest_sums) = sums.as_chunks_mut::<GROUP>();
        for (&[a, b, c, d], sums) in groups.iter().zip(group_sums) {
            *sums = with_four(vectors, [column(a), column(b), column(c), column(d)]);
        }
        for (&slot, sum) in rest.iter().zip(rest_sums) {
            *sum = with_one(vectors, column(slot));
        }
    }
}

#[inline(always)]
fn with_four([r, d]: [&[f64]; 2], [w, x, y, z]: [&[f64]; GROUP]) -> [[f64; 2]; GROUP] {
    let mut sums = [[[0.0; LANES]; 2]; GROUP];
    let vectors = lanes(r).iter().zip(lanes(d));
    let columns = lanes(w).iter().zip(lanes(x)).zip(lanes(y).iter().zip(lanes(z)));
    for ((r, d), ((w, x), (y, z))) in vectors.zip(columns) {
        let [of_w, of_x, of_y, of_z] = &mut sums;
        multiply(of_w, [r, d], w);
        multiply(of_x, [r, d], x);
        multiply(of_y, [r, d], y);
        multiply(of_z, [r, d], z);
    }
    let [of_w, of_x, of_y, of_z] = sums;
    [
        add_up(of_w, [r, d], w),
        add_up(of_x, [r, d], x),
        add_up(of_y, [r, d], y),
        add_up(of_z, [r, d], z),
    ]
}

#[inline(always)]
fn with_one([r, d]: [&[f64]; 2], w: &[f64]) -> [f64; 2] {
    let mut sums = [[0.0; LANES]; 2];
    for ((r, d), w) in lanes(r).iter().zip(lanes(d)).zip(lanes(w)) {
        multiply(&mut sums, [r, d], w);
    }
    add_up(sums, [r, d], w)
}

#[inline(always)]
fn lanes(values: &[f64]) -> &[Lanes] {
    values.as_chunks().0
}

#[inline(always)]
fn multiply(sums: &mut [Lanes; 2], [r, d]: [&Lanes; 2], column: &Lanes) {
    for lane in 0..LANES {
        sums[0][lane] += r[lane] * column[lane];
        sums[1][lane] += d[lane] * column[lane];
    }
}

/// Sums the lanes and adds the remainder at the end.
#[inline(always)]
fn add_up(sums: [Lanes; 2], [r, d]: [&[f64]; 2], column: &[f64]) -> [f64; 2] {
    let end = column.as_chunks::<LANES>().1;
    let over = |vector: &[f64]| {
        let pairs = vector.as_chunks::<LANES>().1.iter().zip(end);
        pairs.map(|(v, c)| v * c).sum::<f64>()
    };
    let [[a, b, c, d0], [e, f, g, h]] = sums;
    [(a + b) + (c + d0) + over(r), (e + f) + (g + h) + over(d)]
}

/// Adds the columns in these slots, each times its coefficient and the common factor.
pub(super) fn combine<'a>(
    into: &mut [f64],
    slots: &[usize],
    coefficients: &[f64],
    factor: f64,
    column: impl Fn(usize) -> &'a [f64],
) {
    Arch::new().dispatch(Combine { into, slots, coefficients, factor, column });
}

struct Combine<'s, C> {
    into: &'s mut [f64],
    slots: &'s [usize],
    coefficients: &'s [f64],
    factor: f64,
    column: C,
}

impl<'a, C: Fn(usize) -> &'a [f64]> NullaryFnOnce for Combine<'_, C> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Self { into, slots, coefficients, factor, column } = self;
        let (groups, rest) = slots.as_chunks::<GROUP>();
        let (factors, rest_factors) = coefficients.as_chunks::<GROUP>();
        for (&[w, x, y, z], &[a, b, c, d]) in groups.iter().zip(factors) {
            let (a, b, c, d) = (factor * a, factor * b, factor * c, factor * d);
            let pairs = column(w).iter().zip(column(x)).zip(column(y).iter().zip(column(z)));
            for (into, ((w, x), (y, z))) in into.iter_mut().zip(pairs) {
                *into += (a * w + b * x) + (c * y + d * z);
            }
        }
        for (&slot, coefficient) in rest.iter().zip(rest_factors) {
            let a = factor * coefficient;
            into.iter_mut().zip(column(slot)).for_each(|(into, w)| *into += a * w);
        }
    }
}

/// Multiply-adds that justify another thread: more than 1 ms of reading memory, so that a thread
/// that starts late on a busy machine loses less than it gains. Data that fit into caches are
/// processed before a second thread has started.
const WORTH: usize = 4_000_000;

/// Processes all pieces, about `operations` multiply-adds in total, on at most `threads` threads.
pub(super) fn share<T: Send>(
    threads: usize,
    operations: usize,
    pieces: impl Iterator<Item = T> + Send,
    work: impl Fn(T) + Sync,
) {
    let threads = threads.min(operations / WORTH);
    if threads < 2 {
        return pieces.for_each(work);
    }
    let pieces = Mutex::new(pieces);
    let next = || pieces.lock().unwrap_or_else(PoisonError::into_inner).next();
    let take = || {
        while let Some(piece) = next() {
            work(piece);
        }
    };
    thread::scope(|scope| {
        for _ in 1..threads {
            scope.spawn(take);
        }
        take();
    });
}
