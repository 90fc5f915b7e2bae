//! Fourier transforms of one length, without a factor: f̂(k) = Σ f(i) e^{∓2πi ik/n}.
//!
//! The transforms are generic functions of a library, large and slow to compile. They are compiled
//! here, once for each precision, and not in every crate that uses them.

use realfft::RealFftPlanner;
pub use realfft::{ComplexToReal, RealToComplex};
use rustfft::FftPlanner;
pub use rustfft::{Fft, num_complex::Complex};
use std::sync::Arc;

/// Number whose fields are transformed: `f64`, or `f32` where seven digits suffice.
pub trait Real: rustfft::FftNum {
    /// Returns the transforms of `length` complex values: forward, and back.
    fn complex(length: usize) -> [Arc<dyn Fft<Self>>; 2];

    /// Returns the transforms of `length` real values to `length / 2 + 1` complex ones, and back.
    fn real(length: usize) -> (Arc<dyn RealToComplex<Self>>, Arc<dyn ComplexToReal<Self>>);
}

macro_rules! precision {
    ($($number:ty)+) => {$(
        impl Real for $number {
            #[inline(never)]
            fn complex(length: usize) -> [Arc<dyn Fft<Self>>; 2] {
                let mut planner = FftPlanner::new();
                [planner.plan_fft_forward(length), planner.plan_fft_inverse(length)]
            }

            #[inline(never)]
            fn real(length: usize) -> (Arc<dyn RealToComplex<Self>>, Arc<dyn ComplexToReal<Self>>) {
                let mut planner = RealFftPlanner::new();
                (planner.plan_fft_forward(length), planner.plan_fft_inverse(length))
            }
        }
    )+};
}

precision!(f32 f64);
