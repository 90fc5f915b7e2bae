//! Sums and products of long vectors, the same to the bit on any machine.
//!
//! They are inlined where they are called, so that a loop with the vector instructions of the processor
//! has them, too.

/// Σ x_i y_i, in eight sums side by side.
#[must_use]
#[inline(always)]
pub fn dot(x: &[f64], y: &[f64]) -> f64 {
    let mut lanes = [0.0; 8];
    let (xs, ys) = (x.chunks_exact(8), y.chunks_exact(8));
    let tail: f64 = xs.remainder().iter().zip(ys.remainder()).map(|(a, b)| a * b).sum();
    for (a, b) in xs.zip(ys) {
        for lane in 0..8 {
            lanes[lane] += a[lane] * b[lane];
        }
    }
    lanes.iter().sum::<f64>() + tail
}

/// √(Σ x_i²).
#[must_use]
#[inline(always)]
pub fn norm(x: &[f64]) -> f64 {
    dot(x, x).sqrt()
}

/// x_i + factor y_i in the place of x_i.
#[inline(always)]
pub fn add_scaled(x: &mut [f64], y: &[f64], factor: f64) {
    x.iter_mut().zip(y).for_each(|(x, y)| *x += factor * y);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn products_of_all_lengths() {
        for count in [0, 1, 7, 8, 9, 100] {
            let x: Vec<f64> = (0..count).map(f64::from).collect();
            let square = f64::from(count * (count - 1).max(0) * (2 * count - 1).max(0)) / 6.0;
            assert_eq!(dot(&x, &x), square);
            assert_eq!(norm(&x), square.sqrt());
            let mut sum = x.clone();
            add_scaled(&mut sum, &x, 2.0);
            assert!(sum.iter().zip(&x).all(|(sum, x)| *sum == 3.0 * x));
        }
    }
}
