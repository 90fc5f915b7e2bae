//! The coupling vector, all fields of the coupling data one after another; passes through it in
//! blocks; and the binary state of the coupling. A state is a sequence of little-endian numbers,
//! and of vectors with their length before them.

use std::ops::Range;

/// One field of the coupling vector.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Part {
    /// Name of the field.
    pub name: String,
    /// Range of its values.
    pub range: Range<usize>,
}

/// Lays out fields, given by name and number of values, one after another.
pub fn parts<'a>(fields: impl IntoIterator<Item = (&'a str, usize)>) -> Vec<Part> {
    let mut start = 0;
    let part = |(name, length): (&'a str, usize)| {
        let range = start..start + length;
        start = range.end;
        Part { name: name.to_owned(), range }
    };
    fields.into_iter().map(part).collect()
}

/// Length of the blocks in which long vectors are processed: three blocks fit into the first-level
/// cache.
pub(crate) const BLOCK: usize = 1024;

/// Iterates over the blocks of a part, at most `length` values long, in order.
pub(crate) fn blocks(
    range: &Range<usize>,
    length: usize,
) -> impl Iterator<Item = Range<usize>> + use<> {
    let end = range.end;
    range.clone().step_by(length).map(move |start| start..end.min(start + length))
}

/// Returns aᵀb, summed in lanes that the compiler vectorises.
pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    const LANES: usize = 8;
    let mut lanes = [0.0; LANES];
    let (left, right) = (a.chunks_exact(LANES), b.chunks_exact(LANES));
    let tail: f64 = left.remainder().iter().zip(right.remainder()).map(|(a, b)| a * b).sum();
    for (a, b) in left.zip(right) {
        for lane in 0..LANES {
            lanes[lane] += a[lane] * b[lane];
        }
    }
    lanes.iter().sum::<f64>() + tail
}

/// A saved state that does not match the coupling.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the coupling state does not fit: {0}")]
pub struct StateMismatch(pub &'static str);

/// Reads a state in the order in which it was written.
#[derive(Clone, Copy, Debug)]
pub struct StateReader<'a>(pub &'a [u8]);

impl StateReader<'_> {
    /// Reads the next whole number.
    ///
    /// # Errors
    /// The state has no more bytes.
    pub fn u64(&mut self) -> Result<u64, StateMismatch> {
        let (head, rest) =
            self.0.split_first_chunk().ok_or(StateMismatch("the state ends too early"))?;
        self.0 = rest;
        Ok(u64::from_le_bytes(*head))
    }

    /// Reads the next number.
    ///
    /// # Errors
    /// The state has no more bytes.
    pub fn f64(&mut self) -> Result<f64, StateMismatch> {
        self.u64().map(f64::from_bits)
    }

    /// Reads the next vector, which must have the length of `values`.
    ///
    /// # Errors
    /// The stored vector has another length, or the state has no more bytes.
    pub fn f64s(&mut self, values: &mut [f64]) -> Result<(), StateMismatch> {
        if self.u64()? != values.len() as u64 {
            return Err(StateMismatch("the length of a vector differs"));
        }
        values.iter_mut().try_for_each(|value| {
            *value = self.f64()?;
            Ok(())
        })
    }
}

/// Writes a vector with its length before it.
pub(crate) fn put_f64s(into: &mut Vec<u8>, values: &[f64]) {
    into.extend((values.len() as u64).to_le_bytes());
    into.extend(values.iter().flat_map(|value| value.to_le_bytes()));
}
