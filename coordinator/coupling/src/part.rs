//! The coupling vector: all fields of the coupling data, one after the other.

use std::ops::Range;

/// One field of the coupling vector.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Part {
    /// Name of the field.
    pub name: String,
    /// Where its values stand.
    pub range: Range<usize>,
}

/// Puts fields, given by name and number of values, one after the other.
pub fn parts<'a>(fields: impl IntoIterator<Item = (&'a str, usize)>) -> Vec<Part> {
    let mut start = 0;
    let part = |(name, length): (&'a str, usize)| {
        let range = start..start + length;
        start = range.end;
        Part { name: name.to_owned(), range }
    };
    fields.into_iter().map(part).collect()
}

/// Values that fit into the first-level cache three times over: the length of the blocks in which
/// long vectors are passed through.
pub(crate) const BLOCK: usize = 1024;

/// The blocks of a part, of a length, in order.
pub(crate) fn blocks(
    range: &Range<usize>,
    length: usize,
) -> impl Iterator<Item = Range<usize>> + use<> {
    let end = range.end;
    range.clone().step_by(length).map(move |start| start..end.min(start + length))
}

/// aᵀb, in lanes that a compiler vectorises.
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
