//! Sparse Cholesky factorisation of the matrix of a block (faer's, supernodal).
//!
//! The nodes are numbered by nested dissection of the mesh: a plane of nodes that splits the
//! longest axis comes after both its sides, recursively. The pattern is analysed once. The factor
//! is recomputed when a value has changed, and reused for any number of steps otherwise.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, LltRef, SymbolicCholesky, SymmetricOrdering,
    factorize_symbolic_cholesky,
};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMat};
use faer::{Conj, MatMut, Par, Side};
use std::ops::Range;

/// Number of nodes along an axis below which a part is not split.
const SMALL: usize = 3;

/// A factorised matrix.
pub struct Direct {
    /// Position of every node in the order of elimination.
    order: Vec<usize>,
    pattern: SymbolicSparseColMat<usize>,
    /// Positions of a node's diagonal and of its couplings to the next node along, across and in
    /// depth.
    slots: Vec<[usize; 4]>,
    symbolic: SymbolicCholesky<usize>,
    values: Vec<f64>,
    factored: Vec<f64>,
    factor: Vec<f64>,
    right: Vec<f64>,
    factor_memory: MemBuffer,
    solve_memory: MemBuffer,
}

impl Direct {
    /// Analyses the pattern of a block of nodes along, across and in depth.
    ///
    /// # Panics
    /// The pattern of the factor does not fit into memory.
    #[must_use]
    pub fn new(counts: [usize; 3]) -> Self {
        let [nx, ny, nz] = counts;
        let size = nx * ny * nz;
        let mut order = vec![0; size];
        let mut next = 0;
        dissect(counts, counts.map(|count| 0..count), &mut |node| {
            order[node] = next;
            next += 1;
        });
        let steps = [1, nx * nz, nx];
        let has = |node: usize, axis: usize| match axis {
            0 => node % nx + 1 < nx,
            1 => node / (nx * nz) + 1 < ny,
            _ => node / nx % nz + 1 < nz,
        };
        // Entries above the diagonal, column by column.
        let mut entries: Vec<[usize; 4]> = Vec::with_capacity(4 * size);
        for node in 0..size {
            entries.push([order[node], order[node], node, 0]);
            for axis in (0..3).filter(|axis| has(node, *axis)) {
                let (a, b) = (order[node], order[node + steps[axis]]);
                entries.push([a.max(b), a.min(b), node, axis + 1]);
            }
        }
        entries.sort_unstable();
        let (mut starts, mut rows) = (vec![0; size + 1], Vec::with_capacity(entries.len()));
        let mut slots = vec![[usize::MAX; 4]; size];
        for (slot, [column, row, node, kind]) in entries.into_iter().enumerate() {
            starts[column + 1] = slot + 1;
            rows.push(row);
            slots[node][kind] = slot;
        }
        let count = rows.len();
        let pattern = SymbolicSparseColMat::new_checked(size, size, starts, None, rows);
        let symbolic = factorize_symbolic_cholesky(
            pattern.as_ref(),
            Side::Upper,
            SymmetricOrdering::Identity,
            CholeskySymbolicParams::default(),
        )
        .expect("there is memory for the pattern of the factor");
        let factor_memory =
            symbolic.factorize_numeric_llt_scratch::<f64>(Par::Seq, Default::default());
        let solve_memory = symbolic.solve_in_place_scratch::<f64>(1, Par::Seq);
        Self {
            order,
            pattern,
            slots,
            values: vec![0.0; count],
            factored: Vec::new(),
            factor: vec![0.0; symbolic.len_val()],
            right: vec![0.0; size],
            factor_memory: MemBuffer::new(factor_memory),
            solve_memory: MemBuffer::new(solve_memory),
            symbolic,
        }
    }

    /// Sets a node's diagonal and its couplings to the next node of each axis.
    pub fn set(&mut self, node: usize, diagonal: f64, couplings: [f64; 3]) {
        let [own, others @ ..] = self.slots[node];
        self.values[own] = diagonal;
        for (slot, coupling) in others.into_iter().zip(couplings) {
            if slot != usize::MAX {
                self.values[slot] = -coupling;
            }
        }
    }

    /// Solves for a right-hand side.
    ///
    /// # Panics
    /// The matrix is not positive definite, because an element of the mesh has no extent.
    pub fn solve(&mut self, right: &[f64], out: &mut [f64]) {
        if self.factored != self.values {
            let matrix = SparseColMatRef::new(self.pattern.as_ref(), &self.values);
            let stack = MemStack::new(&mut self.factor_memory);
            let by = Default::default();
            self.symbolic
                .factorize_numeric_llt(
                    &mut self.factor,
                    matrix,
                    Side::Upper,
                    by,
                    Par::Seq,
                    stack,
                    Default::default(),
                )
                .expect("a matrix of conduction is positive definite");
            self.factored.clone_from(&self.values);
        }
        for (place, value) in self.order.iter().zip(right) {
            self.right[*place] = *value;
        }
        let size = self.right.len();
        let column = MatMut::from_column_major_slice_mut(&mut self.right, size, 1);
        let stack = MemStack::new(&mut self.solve_memory);
        LltRef::new(&self.symbolic, &self.factor).solve_in_place_with_conj(
            Conj::No,
            column,
            Par::Seq,
            stack,
        );
        for (place, out) in self.order.iter().zip(out) {
            *out = self.right[*place];
        }
    }
}

/// Visits the nodes of a part in the order of elimination.
fn dissect(counts: [usize; 3], part: [Range<usize>; 3], visit: &mut dyn FnMut(usize)) {
    let longest = (0..3).max_by_key(|axis| part[*axis].len()).expect("three axes");
    let range = part[longest].clone();
    if range.len() < SMALL {
        let [nx, _, nz] = counts;
        for j in part[1].clone() {
            for k in part[2].clone() {
                for i in part[0].clone() {
                    visit((j * nz + k) * nx + i);
                }
            }
        }
        return;
    }
    let middle = range.start + range.len() / 2;
    for side in [range.start..middle, middle + 1..range.end, middle..middle + 1] {
        let mut side_part = part.clone();
        side_part[longest] = side;
        dissect(counts, side_part, visit);
    }
}
