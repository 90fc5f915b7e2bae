//! Sums and products of long vectors, bit-identical on all machines.
//!
//! The functions are inlined at the call, so that a loop compiled for the processor's vector
//! instructions also uses them here.

/// Returns Σ x_i y_i, accumulated in eight parallel sums.
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

/// Returns √(Σ x_i²).
#[must_use]
#[inline(always)]
pub fn norm(x: &[f64]) -> f64 {
    dot(x, x).sqrt()
}

/// Replaces x_i by x_i + factor y_i.
#[inline(always)]
pub fn add_scaled(x: &mut [f64], y: &[f64], factor: f64) {
    x.iter_mut().zip(y).for_each(|(x, y)| *x += factor * y);
}

/// Returns the power of two next below the largest of these values. Divided by it, values of any
/// unit fit single precision; the quotient is exact.
#[must_use]
pub fn unit_of(values: &[f64]) -> f64 {
    const EXPONENT: u64 = 0x7ff << 52;
    let largest = values.iter().fold(0.0, |largest: f64, value| largest.max(value.abs()));
    match largest.is_normal() {
        true => f64::from_bits(largest.to_bits() & EXPONENT),
        false => 1.0,
    }
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
