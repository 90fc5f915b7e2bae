//! What earlier iterations have changed: the secant columns ΔR and ΔX̃, and the inner products of
//! ΔR. A secant column is the difference of two successive iterations of a window: Δr of the
//! residuals, Δx̃ of what was returned. The columns stand in one piece of memory that is taken once
//! and used as a ring: a new column takes the place of the oldest. Memory of columns never used is
//! never touched.
//!
//! The Gram matrix ΔRᵀΔR is kept for every field by itself. A new column costs one pass over ΔR,
//! which gives its row of the matrix and ΔRᵀr of the present residual together; that a column
//! leaves, or that the weights of the fields change, costs no pass at all. A QR factorisation
//! would take two to four passes a column, and a whole new one for every change of the weights.
//! The price is the square of the condition number, which [`super::least_squares`] keeps in bounds.

use crate::part::{Part, blocks, dot};
use crate::state::{Reader, StateMismatch, put_f64s};
use std::ops::Range;

/// Length of the blocks in which the columns are passed through \[doubles\]: two fit into a
/// second-level cache, and a column's part of one is long enough for the memory to run ahead.
const BLOCK: usize = 16 * 1024;

/// The secant columns, and what is known of them.
#[derive(Clone, Debug)]
pub(super) struct SecantColumns {
    parts: Vec<Part>,
    length: usize,
    capacity: usize,
    /// ΔR, a column after the other, by slot.
    residuals: Vec<f64>,
    /// ΔX̃, a column after the other, by slot.
    images: Vec<f64>,
    /// The window in which a column was made, by slot.
    windows: Vec<u64>,
    /// Slots in use, the newest first.
    order: Vec<usize>,
    free: Vec<usize>,
    /// ΔRᵀΔR of every field, by slots.
    gram: Vec<f64>,
    /// ΔRᵀr of every field, by slot.
    products: Vec<f64>,
    /// r and x̃ of the last iteration.
    residual: Vec<f64>,
    returned: Vec<f64>,
    /// They are of this window.
    known: bool,
    residual_squares: Vec<f64>,
    returned_squares: Vec<f64>,
    /// Δr of the block at hand.
    change: Vec<f64>,
}

impl SecantColumns {
    /// Room for `most` columns, and no more than a column has values.
    pub(super) fn new(parts: &[Part], most: usize) -> Self {
        let length = parts.last().map_or(0, |part| part.range.end);
        let capacity = most.min(length).max(1);
        Self {
            parts: parts.to_vec(),
            length,
            capacity,
            residuals: vec![0.0; capacity * length],
            images: vec![0.0; capacity * length],
            windows: vec![0; capacity],
            order: Vec::with_capacity(capacity),
            free: (0..capacity).rev().collect(),
            gram: vec![0.0; parts.len() * capacity * capacity],
            products: vec![0.0; parts.len() * capacity],
            residual: vec![0.0; length],
            returned: vec![0.0; length],
            known: false,
            residual_squares: vec![0.0; parts.len()],
            returned_squares: vec![0.0; parts.len()],
            change: vec![0.0; BLOCK.min(length)],
        }
    }

    /// Largest number of secant columns.
    pub(super) fn capacity(&self) -> usize {
        self.capacity
    }

    /// Number of columns.
    pub(super) fn count(&self) -> usize {
        self.order.len()
    }

    /// The window of a column, by age from the newest.
    pub(super) fn window(&self, age: usize) -> u64 {
        self.windows[self.order[age]]
    }

    /// rᵀr and x̃ᵀx̃ of every field in the last iteration.
    pub(super) fn squares(&self) -> (&[f64], &[f64]) {
        (&self.residual_squares, &self.returned_squares)
    }

    /// Σ_f w_f² of an inner product of two columns, by age.
    pub(super) fn inner(&self, a: usize, b: usize, weights: &[f64]) -> f64 {
        let at = self.order[a] * self.capacity + self.order[b];
        let size = self.capacity * self.capacity;
        weights.iter().enumerate().map(|(field, w)| w * self.gram[field * size + at]).sum()
    }

    /// Σ_f w_f² of the inner product of a column, by age, with the present residual.
    pub(super) fn product(&self, age: usize, weights: &[f64]) -> f64 {
        let at = self.order[age];
        let fields = weights.iter().enumerate();
        fields.map(|(field, w)| w * self.products[field * self.capacity + at]).sum()
    }

    /// The next iteration belongs to no earlier one.
    pub(super) fn interrupt(&mut self) {
        self.known = false;
    }

    /// Keeps the columns, given by age and window, that `keep` wants.
    pub(super) fn retain(&mut self, mut keep: impl FnMut(usize, u64) -> bool) {
        let (free, windows, mut age) = (&mut self.free, &self.windows, 0);
        self.order.retain(|&slot| {
            let kept = keep(age, windows[slot]);
            age += 1;
            if !kept {
                free.push(slot);
            }
            kept
        });
    }

    /// Takes in an iteration: a new column, if it is not the first of its window, and the inner
    /// products of all columns with its residual.
    pub(super) fn learn(&mut self, sent: &[f64], returned: &[f64], window: u64) {
        let new = self.known.then(|| self.take_slot(window));
        self.residual_squares.fill(0.0);
        self.returned_squares.fill(0.0);
        self.products.fill(0.0);
        if let Some(slot) = new {
            self.clear_gram(slot);
        }
        for field in 0..self.parts.len() {
            for block in blocks(&self.parts[field].range, BLOCK) {
                self.difference(&block, sent, returned, new);
                self.multiply(field, block, new);
            }
        }
        if let Some(slot) = new {
            self.mirror_gram(slot);
        }
        self.known = true;
    }

    fn take_slot(&mut self, window: u64) -> usize {
        let oldest = if self.free.is_empty() { self.order.pop() } else { None };
        let slot = oldest.or_else(|| self.free.pop()).expect("there is room for a column");
        self.order.insert(0, slot);
        self.windows[slot] = window;
        slot
    }

    fn clear_gram(&mut self, slot: usize) {
        for matrix in self.gram.chunks_exact_mut(self.capacity * self.capacity) {
            matrix[slot * self.capacity..][..self.capacity].fill(0.0);
        }
    }

    fn mirror_gram(&mut self, slot: usize) {
        let capacity = self.capacity;
        for matrix in self.gram.chunks_exact_mut(capacity * capacity) {
            for other in 0..capacity {
                matrix[other * capacity + slot] = matrix[slot * capacity + other];
            }
        }
    }

    /// In a block: r and x̃ take the place of the last ones, the differences go into the new column.
    fn difference(
        &mut self,
        block: &Range<usize>,
        sent: &[f64],
        returned: &[f64],
        new: Option<usize>,
    ) {
        let (sent, returned) = (&sent[block.clone()], &returned[block.clone()]);
        let residual = &mut self.residual[block.clone()];
        let last = &mut self.returned[block.clone()];
        let Some(slot) = new else {
            subtract(residual, returned, sent);
            last.copy_from_slice(returned);
            return;
        };
        let at = slot * self.length + block.start;
        let column = &mut self.residuals[at..at + block.len()];
        let image = &mut self.images[at..at + block.len()];
        let change = &mut self.change[..block.len()];
        for i in 0..block.len() {
            let now = returned[i] - sent[i];
            change[i] = now - residual[i];
            column[i] = change[i];
            residual[i] = now;
            image[i] = returned[i] - last[i];
            last[i] = returned[i];
        }
    }

    /// Adds a block's part of the inner products.
    fn multiply(&mut self, field: usize, block: Range<usize>, new: Option<usize>) {
        let (residual, change) = (&self.residual[block.clone()], &self.change[..block.len()]);
        let returned = &self.returned[block.clone()];
        self.residual_squares[field] += dot(residual, residual);
        self.returned_squares[field] += dot(returned, returned);
        let products = &mut self.products[field * self.capacity..][..self.capacity];
        let column = |slot: usize| {
            let at = slot * self.length;
            &self.residuals[at + block.start..at + block.end]
        };
        let Some(new) = new else {
            for &slot in &self.order {
                products[slot] += dot(residual, column(slot));
            }
            return;
        };
        let row = (field * self.capacity + new) * self.capacity;
        let row = &mut self.gram[row..row + self.capacity];
        let (pairs, last) = self.order.as_chunks::<2>();
        for &[a, b] in pairs {
            let sums = inner([residual, change], [column(a), column(b)]);
            (products[a], products[b]) = (products[a] + sums[0][0], products[b] + sums[0][1]);
            (row[a], row[b]) = (row[a] + sums[1][0], row[b] + sums[1][1]);
        }
        for &slot in last {
            let sums = inner([residual, change], [column(slot)]);
            products[slot] += sums[0][0];
            row[slot] += sums[1][0];
        }
    }

    /// x̃ + ΔX̃c of the last iteration, with the coefficients c by age. With `mixing` β the part of
    /// the residual that the columns cannot explain enters by β: x̃ + ΔX̃c − (1 − β)(r + ΔRc).
    pub(super) fn combine(&mut self, coefficients: &[f64], mixing: f64, next: &mut [f64]) {
        let rest = 1.0 - mixing;
        for block in blocks(&(0..self.length), BLOCK) {
            let next = &mut next[block.clone()];
            next.copy_from_slice(&self.returned[block.clone()]);
            let at = |slot: usize| slot * self.length + block.start..slot * self.length + block.end;
            add(next, &self.order, coefficients, |slot| &self.images[at(slot)]);
            if rest != 0.0 {
                let unexplained = &mut self.change[..block.len()];
                unexplained.copy_from_slice(&self.residual[block.clone()]);
                add(unexplained, &self.order, coefficients, |slot| &self.residuals[at(slot)]);
                next.iter_mut().zip(&*unexplained).for_each(|(next, r)| *next -= rest * r);
            }
        }
    }

    pub(super) fn save(&self, into: &mut Vec<u8>) {
        put_f64s(into, &[self.parts.len() as f64, self.length as f64, self.capacity as f64]);
        into.extend((self.order.len() as u64).to_le_bytes());
        for &slot in &self.order {
            into.extend(self.windows[slot].to_le_bytes());
            for columns in [&self.residuals, &self.images] {
                put_f64s(into, &columns[slot * self.length..][..self.length]);
            }
            for matrix in self.gram.chunks_exact(self.capacity * self.capacity) {
                let row = self.order.iter().map(|other| matrix[slot * self.capacity + other]);
                into.extend(row.flat_map(f64::to_le_bytes));
            }
        }
    }

    pub(super) fn restore(&mut self, from: &mut Reader<'_>) -> Result<(), StateMismatch> {
        let mut sizes = [0.0; 3];
        from.f64s(&mut sizes)?;
        if sizes != [self.parts.len() as f64, self.length as f64, self.capacity as f64] {
            return Err(StateMismatch("fields or secant columns have another size"));
        }
        let count = usize::try_from(from.u64()?).unwrap_or(usize::MAX);
        if count > self.capacity {
            return Err(StateMismatch("there are more secant columns than fit"));
        }
        self.order = (0..count).collect();
        self.free = (count..self.capacity).rev().collect();
        for slot in 0..count {
            self.windows[slot] = from.u64()?;
            for columns in [&mut self.residuals, &mut self.images] {
                from.f64s(&mut columns[slot * self.length..][..self.length])?;
            }
            for matrix in self.gram.chunks_exact_mut(self.capacity * self.capacity) {
                for entry in &mut matrix[slot * self.capacity..][..count] {
                    *entry = from.f64()?;
                }
            }
        }
        self.known = false;
        Ok(())
    }
}

fn subtract(into: &mut [f64], a: &[f64], b: &[f64]) {
    for (into, (a, b)) in into.iter_mut().zip(a.iter().zip(b)) {
        *into = a - b;
    }
}

/// Inner products of each of some vectors with each of some columns; everything is read once.
fn inner<const M: usize, const N: usize>(
    vectors: [&[f64]; M],
    columns: [&[f64]; N],
) -> [[f64; N]; M] {
    const LANES: usize = 4;
    let length = vectors[0].len();
    let whole = length / LANES * LANES;
    let mut lanes = [[[0.0; LANES]; N]; M];
    for start in (0..whole).step_by(LANES) {
        let columns = columns.map(|column| &column[start..start + LANES]);
        for (lanes, vector) in lanes.iter_mut().zip(vectors) {
            let vector = &vector[start..start + LANES];
            for (lanes, column) in lanes.iter_mut().zip(columns) {
                for lane in 0..LANES {
                    lanes[lane] += vector[lane] * column[lane];
                }
            }
        }
    }
    std::array::from_fn(|m| {
        std::array::from_fn(|n| {
            let tail = (whole..length).map(|i| vectors[m][i] * columns[n][i]);
            lanes[m][n].iter().sum::<f64>() + tail.sum::<f64>()
        })
    })
}

/// Adds a combination of columns, four at a time.
fn add<'a>(
    into: &mut [f64],
    order: &[usize],
    coefficients: &[f64],
    column: impl Fn(usize) -> &'a [f64],
) {
    let (slots, rest) = order.as_chunks::<4>();
    let (factors, rest_factors) = coefficients.as_chunks::<4>();
    for (slots, [a, b, c, d]) in slots.iter().zip(factors) {
        let [w, x, y, z] = slots.map(&column);
        let pairs = w.iter().zip(x).zip(y.iter().zip(z));
        for (into, ((w, x), (y, z))) in into.iter_mut().zip(pairs) {
            *into += (a * w + b * x) + (c * y + d * z);
        }
    }
    for (slot, factor) in rest.iter().zip(rest_factors) {
        for (into, value) in into.iter_mut().zip(column(*slot)) {
            *into += factor * value;
        }
    }
}
