use super::*;

mod element;
mod load;
mod peak;
mod points;
mod section;
mod tensor;
mod thermal;

/// Largest absolute value of the components.
fn largest(stress: &Stress) -> f64 {
    stress.components().into_iter().fold(0.0, |max, value| value.abs().max(max))
}

/// Reproducible pseudo-random values in (−1, 1).
fn noise(len: usize, seed: u64) -> Vec<f64> {
    let mut state = seed;
    let mut next = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963);
        (state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    };
    (0..len).map(|_| next()).collect()
}
