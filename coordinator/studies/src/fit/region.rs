//! The box of a surrogate where some points have no answer: it has none of them.

/// Which points lie in a box, over what is bounded, that no point without an answer lies in. It begins with the box
/// of all that have one, and is cut at each point that has none, on the side where the fewest are lost.
#[must_use]
pub(super) fn within(bounded: &[&[f64]], answered: &[bool]) -> Vec<bool> {
    let mut kept = answered.to_vec();
    let failed: Vec<usize> = (0..answered.len()).filter(|n| !answered[*n]).collect();
    loop {
        let ends: Vec<[f64; 2]> = bounded.iter().map(|values| ends(values, &kept)).collect();
        let inside = |n: &&usize| {
            bounded
                .iter()
                .zip(&ends)
                .all(|(values, [from, to])| (from..=to).contains(&&values[**n]))
        };
        let Some(failed) = failed.iter().find(inside) else { return kept };
        let cuts = bounded.iter().flat_map(|values| {
            let at = values[*failed];
            [Cut { values, at, above: true }, Cut { values, at, above: false }]
        });
        let Some(cut) = cuts.min_by_key(|cut| cut.lost(&kept)) else { return kept };
        kept.iter_mut().enumerate().for_each(|(n, kept)| *kept &= !cut.takes(n));
    }
}

/// What lies at a value or beyond it.
struct Cut<'a> {
    values: &'a [f64],
    at: f64,
    above: bool,
}

impl Cut<'_> {
    fn takes(&self, n: usize) -> bool {
        if self.above { self.values[n] >= self.at } else { self.values[n] <= self.at }
    }

    fn lost(&self, kept: &[bool]) -> usize {
        kept.iter().enumerate().filter(|(n, kept)| **kept && self.takes(*n)).count()
    }
}

fn ends(values: &[f64], kept: &[bool]) -> [f64; 2] {
    let kept = values.iter().zip(kept).filter(|(_, kept)| **kept).map(|(value, _)| *value);
    kept.fold([f64::INFINITY, f64::NEG_INFINITY], |[from, to], value| {
        [from.min(value), to.max(value)]
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A grid of 4 × 3, in which the largest two values of the first have no answer with the least of the second.
    #[test]
    fn the_box_is_cut_where_the_fewest_are_lost() {
        let points: Vec<[f64; 2]> = (0..12).map(|n| [f64::from(n % 4), f64::from(n / 4)]).collect();
        let [x, y] = [0, 1].map(|i| points.iter().map(|point| point[i]).collect::<Vec<_>>());
        let answered: Vec<bool> = points.iter().map(|[x, y]| !(*x >= 2.0 && *y == 0.0)).collect();
        let kept = within(&[&x, &y], &answered);
        let left: Vec<_> = points.iter().zip(&kept).filter(|(_, kept)| **kept).collect();
        assert_eq!(left.len(), 8, "the least value of the second has gone: {left:?}");
        assert!(left.iter().all(|([_, y], _)| *y >= 1.0));
        // With what bounds the answers as a coordinate, nothing is lost.
        let sum: Vec<f64> = points.iter().map(|[x, y]| x - 9.0 * y).collect();
        let kept = within(&[&x, &y, &sum], &answered);
        assert_eq!(kept, answered);
    }
}
