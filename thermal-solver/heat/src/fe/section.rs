//! Temperatures below a row of a surface, and interpolation between nodes.

/// Columns on either side of a position that interpolation uses.
pub const BESIDE: usize = 2;

/// Rises below a row: node after node in depth, column after column.
#[derive(Clone, Debug)]
pub struct Below {
    /// Rises [K].
    pub rises: Vec<f64>,
    /// Number of columns.
    pub columns: usize,
    /// Position of the first column [m].
    pub first: f64,
    /// Distance from one column to the next [m].
    pub spacing: f64,
    /// Depths of the nodes [m].
    pub depths: Vec<f64>,
}

impl Below {
    /// Writes the rises [K] at a depth [m], at positions from `first` [m] on with the spacing `h`
    /// [m].
    pub fn level(&self, depth: f64, h: f64, first: f64, rise: &mut [f64]) {
        let at_node = |k: usize, column: usize| self.rises[k * self.columns + column];
        let column = |column: usize| interpolate(&self.depths, depth, |k| at_node(k, column));
        let values: Vec<f64> = (0..self.columns).map(column).collect();
        for (i, rise) in rise.iter_mut().enumerate() {
            *rise = Interpolation::Bounded
                .value(&values, (first + i as f64 * h - self.first) / self.spacing);
        }
    }

    /// Returns the rise [K] at a position [m] and a depth [m].
    #[must_use]
    pub fn at(&self, place: f64, depth: f64) -> f64 {
        let at = (place - self.first) / self.spacing;
        let from = (at.floor() as isize - 1).clamp(0, self.columns as isize - 1) as usize;
        let to = (from + 4).min(self.columns);
        let column = |column: usize| {
            interpolate(&self.depths, depth, |k| self.rises[k * self.columns + column])
        };
        let values: Vec<f64> = (from..to).map(column).collect();
        Interpolation::Bounded.value(&values, at - from as f64)
    }
}

/// Writes the rises at the middles of elements, from those of columns that are `front` of an
/// element in front of them. The first column is [`BESIDE`] behind the first element.
pub fn place(columns: &[f64], front: f64, between: Interpolation, rise: &mut [f64]) {
    if front == 0.0 {
        let count = rise.len();
        rise.copy_from_slice(&columns[BESIDE..BESIDE + count]);
        return;
    }
    for (i, rise) in rise.iter_mut().enumerate() {
        *rise = between.value(columns, (i + BESIDE) as f64 - front);
    }
}

/// Interpolation between equally spaced values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Interpolation {
    /// The cubic through the four surrounding values: linear in the values.
    Cubic,
    /// The cubic with limited slopes, which keep it between the two adjacent values where the
    /// four values are monotonic (Fritsch & Carlson, SIAM J. Numer. Anal. 17 (1980) 238-246).
    Bounded,
}

impl Interpolation {
    /// Returns the value at a position, in spacings from the first value; beyond the ends the end
    /// value.
    fn value(self, values: &[f64], at: f64) -> f64 {
        let last = values.len() - 1;
        let at = at.clamp(0.0, last as f64);
        let low = at.floor();
        let theta = at - low;
        let four: [f64; 4] =
            std::array::from_fn(|k| values[(low as usize + k).saturating_sub(1).min(last)]);
        if theta == 0.0 {
            return four[1];
        }
        let [a, b, c, d] = four;
        let rising = [b - a, c - b, d - c];
        let first = (6.0 * c - 2.0 * a - 3.0 * b - d) / 6.0;
        let mut slopes = [first, (a - 6.0 * b + 3.0 * c + 2.0 * d) / 6.0];
        let same = rising.iter().all(|rise| *rise >= 0.0) || rising.iter().all(|rise| *rise <= 0.0);
        if self == Self::Bounded && same {
            for (slope, beside) in slopes.iter_mut().zip(rising.windows(2)) {
                let flatter = if beside[0].abs() < beside[1].abs() { beside[0] } else { beside[1] };
                *slope = slope.clamp((3.0 * flatter).min(0.0), (3.0 * flatter).max(0.0));
            }
        }
        let [from, to] = slopes;
        let [curved, twisted] = [3.0 * rising[1] - 2.0 * from - to, from + to - 2.0 * rising[1]];
        b + theta * (from + theta * (curved + theta * twisted))
    }
}

/// Interpolates unequally spaced values by the cubic through the four surrounding values, limited
/// to the range of the two adjacent ones.
fn interpolate(places: &[f64], at: f64, value: impl Fn(usize) -> f64) -> f64 {
    let last = places.len() - 1;
    if at >= places[last] {
        return value(last);
    }
    let next = places.partition_point(|place| *place <= at).clamp(1, last);
    let first = next.saturating_sub(2).min(last.saturating_sub(3));
    let nodes = first..=(first + 3).min(last);
    let lagrange = |k: usize| {
        let others = nodes.clone().filter(|other| *other != k);
        others.map(|other| (at - places[other]) / (places[k] - places[other])).product::<f64>()
    };
    let cubic: f64 = nodes.clone().map(|k| lagrange(k) * value(k)).sum();
    let (above, below) = (value(next - 1), value(next));
    // `clamp` would panic if both limits are NaN.
    cubic.max(above.min(below)).min(above.max(below))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Cubics are reproduced between equal and unequal spacings. Tolerance: rounding.
    #[test]
    fn cubics_are_interpolated_exactly() {
        let cubic = |x: f64| x * (1.0 + x * (0.2 + 0.1 * x));
        let even: Vec<f64> = (0..9).map(|i| cubic(f64::from(i))).collect();
        let places = [0.0, 0.5, 1.5, 4.0, 7.0, 8.0];
        for at in [1.25, 2.0, 3.9, 5.5, 6.999] {
            assert!(
                (Interpolation::Bounded.value(&even, at) - cubic(at)).abs() < 1e-12 * cubic(8.0)
            );
            let uneven = interpolate(&places, at, |k| cubic(places[k]));
            assert!((uneven - cubic(at)).abs() < 1e-12 * cubic(8.0), "{at}");
        }
    }
}
