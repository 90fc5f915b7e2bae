//! Weights of the conduction integral: the path of the material through elements and windows.
//!
//! Seen from a point, the flux q of age τ is in the element that lies s(τ) upstream, and in the
//! window that was active a time τ ago. [`walk`] follows this path backwards and cuts it at the
//! ends of elements and windows. On each piece the flux is one parabola and the speed is constant,
//! so that with θ = θ₁ + γ(τ − τ₁), γ = V/h, the moments of [`super::moments`] give the weights of
//! the Bernstein coefficients
//!
//! ∫ (1−θ)² K dτ,  ∫ 2θ(1−θ) K dτ,  ∫ θ² K dτ,  K = e^(−c²/τ)/√τ.
//!
//! On a uniform grid the pieces are the same for every element centre, only shifted. A [`Stencil`]
//! keeps them by window.

use super::moments::kernel_moments;

/// An interval of the past with constant speed and flux; sequences are ordered newest first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Segment {
    /// Duration [s]; may be infinite for the last segment.
    pub duration: f64,
    /// Elements passed per time [1/s]; 0 for a body at rest, in a segment of finite duration.
    pub rate: f64,
    /// Factor of the weights: share/(β√π) for a temperature rise.
    pub factor: f64,
}

/// Goes back in time from the position `theta` ∈ [0, 1] inside element 0, at the depth c = z/(2√κ)
/// [√s], until `reach` elements are passed or the past ends. Calls `visit(segment, element,
/// weights)` for every piece, with the weights of the coefficients before, inside and after the
/// element [√s times the unit of the factor].
pub fn walk(
    segments: impl Iterator<Item = Segment>,
    mut theta: f64,
    reach: usize,
    depth: f64,
    mut visit: impl FnMut(usize, usize, [f64; 3]),
) {
    let (mut element, mut age) = (0_usize, 0.0);
    for (index, Segment { duration, rate, factor }) in segments.enumerate() {
        let (element0, theta0, age0) = (element, theta, age);
        let passed = rate * duration;
        loop {
            if element >= reach {
                return;
            }
            let to_edge = (element - element0) as f64 + (1.0 - theta0);
            let ends = to_edge >= passed;
            let until = if ends { age0 + duration } else { age0 + to_edge / rate };
            if until > age {
                let moments = kernel_moments(age, until, depth);
                let weights = bernstein_weights(moments, theta, rate);
                visit(index, element, weights.map(|weight| factor * weight));
                age = until;
            }
            if ends {
                theta = (theta0 + passed - (element - element0) as f64).min(1.0);
                break;
            }
            element += 1;
            theta = 0.0;
        }
    }
}

fn bernstein_weights([m0, m1, m2]: [f64; 3], theta: f64, rate: f64) -> [f64; 3] {
    let first = theta * m0 + rate * m1;
    let second = theta * (theta * m0 + 2.0 * rate * m1) + rate * rate * m2;
    [m0 - 2.0 * first + second, 2.0 * (first - second), second]
}

/// The weights of one segment for every point of a row. The value at point i is the sum over k of
/// `middle[k] * m[first + i + k] + edge[k] * e[first + i + k]`.
#[derive(Clone, Copy, Debug)]
pub struct Part<'a> {
    /// Number of the segment.
    pub segment: usize,
    /// Offset of the first element.
    pub first: usize,
    /// Weights of the middle coefficients; the last weight is 0, so that the length equals that of
    /// `edge`.
    pub middle: &'a [f64],
    /// Weights of edge values.
    pub edge: &'a [f64],
}

/// Weights for the points of a row, by segment. Memory is reused between builds.
#[derive(Clone, Debug, Default)]
pub struct Stencil {
    parts: Vec<(usize, usize, usize)>,
    middle: Vec<f64>,
    edge: Vec<f64>,
}

impl Stencil {
    /// Builds the weights for element centres of rows with `columns` elements.
    pub fn build(&mut self, segments: impl Iterator<Item = Segment>, columns: usize, depth: f64) {
        self.parts.clear();
        self.middle.clear();
        self.edge.clear();
        walk(segments, 0.5, columns, depth, |segment, element, weights| {
            self.add(segment, element, weights);
        });
    }

    fn add(&mut self, segment: usize, element: usize, [before, inside, after]: [f64; 3]) {
        if self.parts.last().is_none_or(|(last, ..)| *last != segment) {
            self.parts.push((segment, element, self.edge.len()));
        }
        let (_, first, start) = *self.parts.last().expect("a part was just pushed");
        let slot = start + element - first;
        if self.edge.len() < slot + 2 {
            self.edge.resize(slot + 2, 0.0);
            self.middle.resize(slot + 2, 0.0);
        }
        self.middle[slot] += inside;
        self.edge[slot] += before;
        self.edge[slot + 1] += after;
    }

    /// Iterates over the parts, newest segment first.
    pub fn parts(&self) -> impl Iterator<Item = Part<'_>> {
        let ends = self.parts.iter().skip(1).map(|part| part.2).chain([self.edge.len()]);
        self.parts.iter().zip(ends).map(|(&(segment, first, start), end)| Part {
            segment,
            first,
            middle: &self.middle[start..end],
            edge: &self.edge[start..end],
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn total(segments: &[Segment], theta: f64, reach: usize) -> f64 {
        let mut sum = 0.0;
        walk(segments.iter().copied(), theta, reach, 0.0, |_, _, weights| {
            sum += weights.iter().sum::<f64>();
        });
        sum
    }

    #[test]
    fn weights_sum_to_the_kernels_integral() {
        let steady = [Segment { duration: f64::INFINITY, rate: 4.0, factor: 1.0 }];
        // Ten elements less half the first, at four a second; tolerance: rounding.
        assert!((total(&steady, 0.5, 10) - 2.0 * (9.5_f64 / 4.0).sqrt()).abs() < 1e-14);
        let cut =
            [0.3, 1e-9, 0.125, 7.0].map(|duration| Segment { duration, rate: 4.0, factor: 1.0 });
        assert!((total(&cut, 0.5, 10) - 2.0 * (9.5_f64 / 4.0).sqrt()).abs() < 1e-14);
        let short = [0.3, 0.2].map(|duration| Segment { duration, rate: 4.0, factor: 1.0 });
        assert!((total(&short, 0.0, 10) - 2.0 * 0.5_f64.sqrt()).abs() < 1e-14);
    }

    #[test]
    fn cuts_do_not_change_the_weights_of_an_element() {
        let mut whole = [[0.0; 3]; 4];
        let steady = [Segment { duration: f64::INFINITY, rate: 3.0, factor: 1.0 }];
        walk(steady.into_iter(), 0.25, 4, 0.2, |_, k, w| whole[k] = w);
        let mut sums = [[0.0; 3]; 4];
        let cut = [0.1, 0.3, 1e-6, 0.02, 9.0].map(|duration| Segment {
            duration,
            rate: 3.0,
            factor: 1.0,
        });
        walk(cut.into_iter(), 0.25, 4, 0.2, |_, k, w| {
            sums[k] = std::array::from_fn(|p| sums[k][p] + w[p]);
        });
        for (a, b) in whole.iter().flatten().zip(sums.iter().flatten()) {
            // Tolerance: rounding of closed forms and quadrature.
            assert!((a - b).abs() < 1e-14, "{whole:?} {sums:?}");
        }
    }

    #[test]
    fn parts_follow_the_segments() {
        let segments =
            [0.5, 0.25, f64::INFINITY].map(|duration| Segment { duration, rate: 2.0, factor: 1.0 });
        let mut stencil = Stencil::default();
        stencil.build(segments.into_iter(), 4, 0.0);
        let shape: Vec<_> =
            stencil.parts().map(|p| (p.segment, p.first, p.edge.len(), p.middle.len())).collect();
        // Half an element to the first edge, one element in total, then half of the second.
        assert_eq!(shape, [(0, 0, 3, 3), (1, 1, 2, 2), (2, 2, 3, 3)]);
        assert!(stencil.parts().all(|part| part.middle.last() == Some(&0.0)));
    }
}
