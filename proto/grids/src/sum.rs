//! Sums whose rounding errors grow like the logarithm of the length.

/// Sums a term over a range by recursive halving. The rounding error grows like the logarithm of
/// the length.
pub fn pairwise_sum(range: std::ops::Range<usize>, term: &impl Fn(usize) -> f64) -> f64 {
    if range.len() <= 32 {
        return range.map(term).sum();
    }
    let middle = range.start.midpoint(range.end);
    pairwise_sum(range.start..middle, term) + pairwise_sum(middle..range.end, term)
}

/// Sums values in independent lanes and blocks: fast, and with a rounding error that grows like the
/// logarithm of the length. Two sums of the same field agree to a few units in the last place.
#[must_use]
pub fn blocked_sum(values: &[f64]) -> f64 {
    const BLOCK: usize = 1024;
    if values.len() > BLOCK {
        let half = (values.len() / 2).next_multiple_of(BLOCK);
        let (left, right) = values.split_at(half.min(values.len() - 1));
        return blocked_sum(left) + blocked_sum(right);
    }
    let mut lanes = [0.0; 8];
    let chunks = values.chunks_exact(8);
    let tail: f64 = chunks.remainder().iter().sum();
    for chunk in chunks {
        for (lane, value) in lanes.iter_mut().zip(chunk) {
            *lane += value;
        }
    }
    lanes.iter().sum::<f64>() + tail
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocked_sum_equals_exact_sum_of_integers() {
        for n in [0, 1, 7, 8, 1024, 1025, 2048, 100_001] {
            let values: Vec<f64> = (0..n).map(f64::from).collect();
            let n = f64::from(n);
            assert_eq!(blocked_sum(&values), n * (n - 1.0) / 2.0);
        }
    }
}
