//! Secant columns ΔR and ΔX̃, and the inner products of ΔR. A secant column is the difference of
//! two successive iterations of a window: Δr of the residuals, Δx̃ of the returned vectors. The
//! columns share one allocation that is used as a ring: a new column replaces the oldest. Memory of
//! unused columns is never touched.
//!
//! The Gram matrix ΔRᵀΔR is kept separately for every field. A new column costs one pass over ΔR,
//! which gives both its row of the matrix and ΔRᵀr of the present residual. Removing a column or
//! changing the weights of the fields costs no pass. A QR factorisation would take two to four
//! passes a column, and a complete recomputation for every change of the weights. The price is the
//! square of the condition number, which [`super::least_squares`] keeps in bounds.

use super::kernels;
use super::kernels::share;
use crate::vector::{Part, dot};
use crate::vector::{StateMismatch, StateReader, put_f64s};
use std::ops::Range;

/// Longest block in which the vectors are processed \[doubles\]. A block of the iterates stays in
/// the second-level cache until all columns have used it, and the matching block of a column is
/// long enough for hardware prefetching.
const BLOCK: usize = 8 * 1024;

/// A block of the vectors and its contributions to the inner products.
#[derive(Clone, Debug)]
struct Block {
    field: usize,
    range: Range<usize>,
    /// rᵀr and x̃ᵀx̃.
    squares: [f64; 2],
    /// Inner products of each column, by age, with r and with the newest column.
    columns: Vec<[f64; 2]>,
}

/// Secant columns with their Gram matrix.
#[derive(Clone, Debug)]
pub(super) struct SecantColumns {
    fields: usize,
    length: usize,
    capacity: usize,
    threads: usize,
    blocks: Vec<Block>,
    /// ΔR, one column after another, by slot.
    residuals: Vec<f64>,
    /// ΔX̃, one column after another, by slot.
    images: Vec<f64>,
    /// The window in which a column was made, by slot.
    windows: Vec<u64>,
    /// Slots in use, the newest first.
    order: Vec<usize>,
    free: Vec<usize>,
    /// Whether the newest column still lacks its row in the Gram matrix.
    pending: bool,
    /// ΔRᵀΔR of every field, by slots.
    gram: Vec<f64>,
    /// ΔRᵀr of every field, by slot.
    products: Vec<f64>,
    /// r and x̃ of the last iteration.
    residual: Vec<f64>,
    returned: Vec<f64>,
    /// Whether `residual` and `returned` belong to this window.
    known: bool,
    residual_squares: Vec<f64>,
    returned_squares: Vec<f64>,
}

impl SecantColumns {
    /// Allocates `most` columns, or fewer if a column has fewer values than that.
    pub(super) fn new(parts: &[Part], most: usize, threads: usize) -> Self {
        let length = parts.last().map_or(0, |part| part.range.end);
        let (fields, capacity) = (parts.len(), most.min(length).max(1));
        let blocks = parts.iter().enumerate().flat_map(|(field, part)| {
            let columns = vec![[0.0; 2]; capacity];
            even(&part.range).map(move |range| Block {
                field,
                range,
                squares: [0.0; 2],
                columns: columns.clone(),
            })
        });
        Self {
            fields,
            length,
            capacity,
            threads,
            blocks: blocks.collect(),
            residuals: vec![0.0; capacity * length],
            images: vec![0.0; capacity * length],
            windows: vec![0; capacity],
            order: Vec::with_capacity(capacity),
            free: (0..capacity).rev().collect(),
            pending: false,
            gram: vec![0.0; fields * capacity * capacity],
            products: vec![0.0; fields * capacity],
            residual: vec![0.0; length],
            returned: vec![0.0; length],
            known: false,
            residual_squares: vec![0.0; fields],
            returned_squares: vec![0.0; fields],
        }
    }

    /// Largest number of secant columns.
    pub(super) fn capacity(&self) -> usize {
        self.capacity
    }

    pub(super) fn count(&self) -> usize {
        self.order.len()
    }

    /// Returns the window in which a column was made; age 0 is the newest column.
    pub(super) fn window(&self, age: usize) -> u64 {
        self.windows[self.order[age]]
    }

    /// rᵀr and x̃ᵀx̃ of every field in the last iteration.
    pub(super) fn squares(&self) -> (&[f64], &[f64]) {
        (&self.residual_squares, &self.returned_squares)
    }

    /// Returns Σ_f w_f² a_fᵀb_f of two columns a and b, given by age.
    pub(super) fn inner(&self, a: usize, b: usize, weights: &[f64]) -> f64 {
        let at = self.order[a] * self.capacity + self.order[b];
        let size = self.capacity * self.capacity;
        weights.iter().enumerate().map(|(field, w)| w * self.gram[field * size + at]).sum()
    }

    /// Returns Σ_f w_f² a_fᵀr_f of a column a, given by age, with the present residual r.
    pub(super) fn product(&self, age: usize, weights: &[f64]) -> f64 {
        let at = self.order[age];
        let fields = weights.iter().enumerate();
        fields.map(|(field, w)| w * self.products[field * self.capacity + at]).sum()
    }

    /// Marks the next iteration as the first of a series: no column is made from it.
    pub(super) fn interrupt(&mut self) {
        self.known = false;
    }

    /// Returns whether the next iteration follows another one of its window.
    pub(super) fn continues(&self) -> bool {
        self.known
    }

    /// Removes the columns for which `keep(age, window)` returns false.
    pub(super) fn retain(&mut self, mut keep: impl FnMut(usize, u64) -> bool) {
        let (free, windows, pending) = (&mut self.free, &self.windows, &mut self.pending);
        let mut age = 0;
        self.order.retain(|&slot| {
            let kept = keep(age, windows[slot]);
            if !kept {
                free.push(slot);
                *pending &= age > 0;
            }
            age += 1;
            kept
        });
    }

    /// Takes in an iteration: adds a column, except in the first iteration of a window, and
    /// computes the inner products of all columns with the residual.
    pub(super) fn learn(&mut self, sent: &[f64], returned: &[f64], window: u64) {
        let new = self.known;
        if new {
            self.take_slot(window);
        }
        self.pass(sent, returned, new);
        self.add_up();
        self.known = true;
    }

    /// Takes in the last iteration of a window. The next pass over the columns computes the new
    /// column's row of the Gram matrix.
    pub(super) fn learn_last(&mut self, sent: &[f64], returned: &[f64], window: u64) {
        if !std::mem::take(&mut self.known) {
            return;
        }
        self.take_slot(window);
        let at = self.order[0] * self.length;
        let column = &mut self.residuals[at..at + self.length];
        let image = &mut self.images[at..at + self.length];
        for i in 0..self.length {
            column[i] = returned[i] - sent[i] - self.residual[i];
            image[i] = returned[i] - self.returned[i];
        }
    }

    /// Assigns a slot to the newest column.
    fn take_slot(&mut self, window: u64) {
        let oldest = if self.free.is_empty() { self.order.pop() } else { None };
        let slot = oldest.or_else(|| self.free.pop()).expect("there is room for a column");
        self.order.insert(0, slot);
        self.windows[slot] = window;
        self.pending = true;
    }

    /// Reads all columns once. Stores r and x̃, writes their changes to the newest column if `new`,
    /// and computes the contribution of each block to the inner products.
    fn pass(&mut self, sent: &[f64], returned: &[f64], new: bool) {
        let Self { blocks, residuals, images, residual, returned: last, order, length, .. } = self;
        let (length, count) = (*length, order.len());
        let newest = self.pending.then(|| order[0]);
        let (others, mut column) = Others::apart(residuals, newest, length);
        let mut image = newest.map_or(&mut [][..], |slot| &mut images[slot * length..][..length]);
        let (mut residual, mut last) = (&mut residual[..], &mut last[..]);
        let pieces = blocks.iter_mut().map(|block| {
            let range = block.range.clone();
            Piece {
                sent: &sent[range.clone()],
                returned: &returned[range.clone()],
                residual: front(&mut residual, range.len()),
                last: front(&mut last, range.len()),
                column: front(&mut column, range.len()),
                image: front(&mut image, range.len()),
                block,
            }
        });
        share(self.threads, 2 * length * count, pieces, |piece| piece.meet(&others, order, new));
    }

    /// Sums the contributions of the blocks in a fixed order.
    fn add_up(&mut self) {
        self.residual_squares.fill(0.0);
        self.returned_squares.fill(0.0);
        self.products.fill(0.0);
        for block in &self.blocks {
            self.residual_squares[block.field] += block.squares[0];
            self.returned_squares[block.field] += block.squares[1];
            let products = &mut self.products[block.field * self.capacity..][..self.capacity];
            for (slot, sums) in self.order.iter().zip(&block.columns) {
                products[*slot] += sums[0];
            }
        }
        self.add_row();
    }

    /// Sums the newest column's row of the Gram matrix, unless that row is known.
    fn add_row(&mut self) {
        if !std::mem::take(&mut self.pending) {
            return;
        }
        let (newest, capacity) = (self.order[0], self.capacity);
        for (field, matrix) in self.gram.chunks_exact_mut(capacity * capacity).enumerate() {
            let row = &mut matrix[newest * capacity..][..capacity];
            row.fill(0.0);
            for block in self.blocks.iter().filter(|block| block.field == field) {
                for (slot, sums) in self.order.iter().zip(&block.columns) {
                    row[*slot] += sums[1];
                }
            }
            for slot in &self.order {
                matrix[slot * capacity + newest] = matrix[newest * capacity + slot];
            }
        }
    }

    /// Computes the newest column's row of the Gram matrix if it is missing, bit-identical to the
    /// result of the next pass.
    fn complete(&mut self) {
        let Self { blocks, residuals, order, length, .. } = self;
        if self.pending {
            let column =
                |slot: usize, range: &Range<usize>| &residuals[slot * *length..][range.clone()];
            for Block { range, columns, .. } in blocks {
                let newest = column(order[0], range);
                kernels::products([newest; 2], order, |slot| column(slot, range), columns);
            }
        }
        self.add_row();
    }

    /// Computes x̃ + ΔX̃c of the last iteration, with the coefficients c by age. `mixing` is the
    /// factor β of the residual that the columns cannot explain: x̃ + ΔX̃c − (1 − β)(r + ΔRc).
    pub(super) fn combine(&self, coefficients: &[f64], mixing: f64, mut next: &mut [f64]) {
        let Self { order, residual, returned, length, .. } = self;
        let rest = 1.0 - mixing;
        let pieces =
            self.blocks.iter().map(|block| (&block.range, front(&mut next, block.range.len())));
        share(self.threads, length * order.len(), pieces, |(range, next)| {
            next.copy_from_slice(&returned[range.clone()]);
            let image = |slot| &self.images[slot * length..][range.clone()];
            kernels::combine(next, order, coefficients, 1.0, image);
            if rest != 0.0 {
                let unexplained = &residual[range.clone()];
                next.iter_mut().zip(unexplained).for_each(|(next, r)| *next -= rest * r);
                let change = |slot| &self.residuals[slot * length..][range.clone()];
                kernels::combine(next, order, coefficients, -rest, change);
            }
        });
    }

    pub(super) fn save(&mut self, into: &mut Vec<u8>) {
        self.complete();
        put_f64s(into, &[self.fields as f64, self.length as f64, self.capacity as f64]);
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

    pub(super) fn restore(&mut self, from: &mut StateReader<'_>) -> Result<(), StateMismatch> {
        let mut sizes = [0.0; 3];
        from.f64s(&mut sizes)?;
        if sizes != [self.fields as f64, self.length as f64, self.capacity as f64] {
            return Err(StateMismatch("the sizes of fields or secant columns differ"));
        }
        let count = usize::try_from(from.u64()?).unwrap_or(usize::MAX);
        if count > self.capacity {
            return Err(StateMismatch(
                "the state has more secant columns than `max_columns` allows",
            ));
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
        (self.known, self.pending) = (false, false);
        Ok(())
    }
}

/// A block of the vectors as a pass processes it.
struct Piece<'a> {
    sent: &'a [f64],
    returned: &'a [f64],
    residual: &'a mut [f64],
    last: &'a mut [f64],
    /// The newest column and its image; empty if its row of the Gram matrix is known.
    column: &'a mut [f64],
    image: &'a mut [f64],
    block: &'a mut Block,
}

impl Piece<'_> {
    /// Computes the inner products of this block with the columns in `slots`.
    fn meet(self, others: &Others<'_>, slots: &[usize], new: bool) {
        let Self { sent, returned, residual, last, column, image, block } = self;
        for i in 0..if new { sent.len() } else { 0 } {
            column[i] = returned[i] - sent[i] - residual[i];
            image[i] = returned[i] - last[i];
        }
        for (residual, (returned, sent)) in residual.iter_mut().zip(returned.iter().zip(sent)) {
            *residual = returned - sent;
        }
        last.copy_from_slice(returned);
        let Block { range, squares, columns, .. } = block;
        *squares = [dot(residual, residual), dot(last, last)];
        let (residual, column) = (&*residual, &*column);
        if column.is_empty() {
            kernels::products([residual; 2], slots, |slot| others.piece(slot, range), columns);
        } else {
            let any = |slot| if slot == slots[0] { column } else { others.piece(slot, range) };
            kernels::products([residual, column], slots, any, columns);
        }
    }
}

/// All columns except the newest.
struct Others<'a> {
    before: &'a [f64],
    after: &'a [f64],
    length: usize,
}

impl<'a> Others<'a> {
    /// Splits the columns into the one in this slot and all others.
    fn apart(all: &'a mut [f64], slot: Option<usize>, length: usize) -> (Self, &'a mut [f64]) {
        let at = slot.map_or(all.len(), |slot| slot * length);
        let (before, rest) = all.split_at_mut(at);
        let (one, after) = rest.split_at_mut(rest.len().min(length));
        (Self { before, after, length }, one)
    }

    /// Returns a block of the column in a slot.
    fn piece(&self, slot: usize, range: &Range<usize>) -> &'a [f64] {
        let at = slot * self.length;
        let column = match at.checked_sub(self.before.len() + self.length) {
            Some(at) => &self.after[at..],
            None => &self.before[at..],
        };
        &column[range.clone()]
    }
}

/// Splits a range into blocks of nearly equal length.
fn even(range: &Range<usize>) -> impl Iterator<Item = Range<usize>> + use<> {
    let (start, length) = (range.start, range.len());
    let count = length.div_ceil(BLOCK);
    (0..count).map(move |i| start + i * length / count..start + (i + 1) * length / count)
}

/// Takes the first `count` values off a slice; returns an empty slice if there are fewer.
fn front<'a>(rest: &mut &'a mut [f64], count: usize) -> &'a mut [f64] {
    let (first, others) = std::mem::take(rest).split_at_mut_checked(count).unwrap_or_default();
    *rest = others;
    first
}
