//! The matrix of a mapping.

use super::nodes::Target;
use super::patch::Row;

/// Matrix in compressed rows.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct SparseOperator {
    /// Row r has the entries `starts[r]..starts[r + 1]`.
    starts: Vec<usize>,
    columns: Vec<u32>,
    weights: Vec<f64>,
}

impl SparseOperator {
    /// Creates an empty matrix with room for `rows` rows.
    pub(super) fn with_rows(rows: usize) -> Self {
        let mut starts = Vec::with_capacity(rows + 1);
        starts.push(0);
        Self { starts, columns: Vec::new(), weights: Vec::new() }
    }

    /// Creates the matrix that copies `rows` values.
    pub(super) fn identity(rows: usize) -> Self {
        let mut operator = Self::with_rows(rows);
        let mut row = Row::new();
        for column in 0..rows as u32 {
            row.clear();
            row.push((column, 1.0));
            operator.push(&mut row);
        }
        operator
    }

    /// Adds the row of a target; an empty row copies the value of the node at its foot.
    pub(super) fn push_or_copy(&mut self, row: &mut Row, target: &Target) {
        if row.is_empty() {
            row.push((target.foot.node as u32, 1.0));
        }
        self.push(row);
    }

    /// Adds a row, scaled so that it sums to one, and sorts its columns.
    pub(super) fn push(&mut self, row: &mut Row) {
        row.sort_unstable_by_key(|(column, _)| *column);
        let sum: f64 = row.iter().map(|(_, weight)| weight).sum();
        let start = self.columns.len();
        for &(column, weight) in row.iter() {
            if self.columns.len() > start && self.columns.last() == Some(&column) {
                *self.weights.last_mut().expect("a weight for every column") += weight / sum;
            } else {
                self.columns.push(column);
                self.weights.push(weight / sum);
            }
        }
        self.starts.push(self.columns.len());
    }

    /// Number of entries.
    pub(super) fn len(&self) -> usize {
        self.weights.len()
    }

    /// Iterates over the rows as slices of columns and weights.
    pub(super) fn rows(&self) -> impl Iterator<Item = (&[u32], &[f64])> {
        self.starts.windows(2).map(|ends| {
            let range = ends[0]..ends[1];
            (&self.columns[range.clone()], &self.weights[range])
        })
    }

    /// target = W source.
    pub(super) fn apply(&self, source: &[f64], target: &mut [f64]) {
        for ((columns, weights), value) in self.rows().zip(target) {
            let terms = columns.iter().zip(weights).map(|(c, weight)| weight * source[*c as usize]);
            *value = terms.sum();
        }
    }

    /// Returns W_ts = A_s C_st / A_t of this matrix C, with the areas of its rows (s) and columns
    /// (t).
    pub(super) fn transposed(&self, row_areas: &[f64], column_areas: &[f64]) -> Self {
        let mut starts = vec![0; column_areas.len() + 1];
        for column in &self.columns {
            starts[*column as usize + 1] += 1;
        }
        for column in 0..column_areas.len() {
            starts[column + 1] += starts[column];
        }
        let mut next = starts.clone();
        let (mut columns, mut weights) = (vec![0; self.len()], vec![0.0; self.len()]);
        for (row, (old_columns, old_weights)) in self.rows().enumerate() {
            for (column, weight) in old_columns.iter().map(|c| *c as usize).zip(old_weights) {
                columns[next[column]] = row as u32;
                weights[next[column]] = weight * (row_areas[row] / column_areas[column]);
                next[column] += 1;
            }
        }
        Self { starts, columns, weights }
    }
}
