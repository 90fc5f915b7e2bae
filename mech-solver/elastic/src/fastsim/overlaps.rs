//! Overlaps of an interval with the elements of a grid.

/// Visits the unit intervals [i, i + 1), i < count, that overlap an interval, with the length of
/// the overlap. Parts outside by rounding are assigned to the first or last interval.
pub fn overlaps([from, to]: [f64; 2], count: usize, mut visit: impl FnMut(usize, f64)) {
    let last = count - 1;
    let index = |place: f64| (place.max(0.0) as usize).min(last);
    let (first, end) = (index(from), index(to));
    let mut start = from;
    for interval in first..end {
        let edge = (interval + 1) as f64;
        visit(interval, edge - start);
        start = edge;
    }
    visit(end, to - start);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn overlaps_add_up() {
        for interval in [[0.25, 0.5], [0.0, 3.0], [-1e-17, 2.5], [1.75, 4.0 + 1e-15], [2.0, 3.0]] {
            let mut shares = [0.0; 4];
            overlaps(interval, 4, |index, share| shares[index] += share);
            let sum: f64 = shares.iter().sum();
            assert!((sum - (interval[1] - interval[0])).abs() < 1e-15, "{shares:?}");
            assert!(shares.iter().all(|share| (0.0..=1.0 + 1e-14).contains(share)), "{shares:?}");
        }
    }
}
