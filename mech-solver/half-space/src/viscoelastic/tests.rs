use super::*;
use elastic::Material;

const BODY: Material = Material { youngs_modulus: 3.0, poisson_ratio: 0.3 };

fn bodies(factor: f64, length: f64) -> Bodies {
    let rigid = Material { youngs_modulus: f64::INFINITY, poisson_ratio: 0.0 };
    let [own, other] = Elasticity::of_bodies(&[BODY, rigid]);
    assert_eq!(other, Elasticity::default());
    let delayed = [Delayed { elasticity: own.scaled(factor), length }, Delayed::default()];
    Bodies { instantaneous: own, delayed }
}

fn tangential(influence: &Influence, x: f64, y: f64) -> [f64; 4] {
    [influence.zz_at(x, y), influence.xx_at(x, y), influence.yy_at(x, y), influence.xy_at(x, y)]
}

/// ∫₀^∞ A(x + s) e^{−s/l} ds/l by Simpson's rule, between the edges of the element and beyond. A
/// substitution that is flat at both ends of a part turns branch points there into smooth
/// functions.
fn memory(length: f64, dx: f64, from: f64, kernel: impl Fn(f64) -> f64) -> f64 {
    let part = |low: f64, high: f64| -> f64 {
        let steps = 4000;
        let term = |k: i32| {
            let t = f64::from(k) / f64::from(steps);
            let smooth = t * t * t * (10.0 - 15.0 * t + 6.0 * t * t);
            let slope = 30.0 * t * t * (1.0 - t) * (1.0 - t);
            let s = low + (high - low) * smooth;
            let weight = if k % 2 == 1 { 4.0 } else { 2.0 };
            weight * slope * kernel(from + s) * (-s / length).exp() / length
        };
        (high - low) / (3.0 * f64::from(steps)) * (1..steps).map(term).sum::<f64>()
    };
    let mut ends = vec![0.0];
    ends.extend([-0.5 * dx - from, 0.5 * dx - from].into_iter().filter(|s| *s > 0.0));
    let last = ends.last().copied().unwrap_or(0.0);
    let far = (last + length).max(dx);
    ends.extend([1.0, 3.0, 10.0, 40.0].map(|factor| last + factor * length.min(far)));
    ends.windows(2).map(|pair| part(pair[0], pair[1])).sum()
}

/// Errors are relative to the largest number at the offset. Tolerance: the reference quadrature,
/// for memories of a thousandth of an element.
#[test]
fn numbers_against_quadrature() {
    let mut worst = 0.0_f64;
    for [dx, dy] in [[1.0, 1.0], [1.0, 0.1], [0.2, 1.0], [1.0, 1e4]] {
        for length in [1e-3, 0.1, 1.0, 30.0, 1e3] {
            let bodies = bodies(4.0, length * dx);
            let numbers = RollingInfluenceNumbers::new([5, 4], [dx, dy], &bodies, tangential);
            let own = Influence { dx, dy, elasticity: bodies.instantaneous, plane_strain: false };
            for (i, j) in [(-4, 0), (-1, 0), (0, 0), (1, 0), (5, 0), (-2, 1), (0, 1), (3, 3)] {
                let (x, y) = (f64::from(i) * dx, f64::from(j) * dy);
                for (k, found) in numbers.value(i, j).into_iter().enumerate() {
                    let at = |x: f64| tangential(&own, x, y)[k];
                    let expected = at(x) + 4.0 * memory(length * dx, dx, x, at);
                    let scale = tangential(&own, x, y)[..3].iter().copied().fold(0.0, f64::max);
                    let error = (found - expected).abs() / scale;
                    worst = worst.max(error);
                }
            }
        }
    }
    println!("largest error {worst:.1e}");
    assert!(worst < 1e-9, "{worst:e}");
}

/// Limits of very short and very long memory.
#[test]
fn fast_and_slow_limits() {
    for (length, factor) in [(1e-7, 5.0), (1e9, 1.0)] {
        let numbers =
            RollingInfluenceNumbers::new([4, 3], [1.0, 0.7], &bodies(4.0, length), tangential);
        let elasticity = bodies(4.0, length).instantaneous.scaled(factor);
        let elastic = Influence { dx: 1.0, dy: 0.7, elasticity, plane_strain: false };
        for (i, j) in [(-3, 0), (0, 0), (4, 2), (1, 1)] {
            let expected = tangential(&elastic, f64::from(i), 0.7 * f64::from(j));
            for (found, expected) in numbers.value(i, j).into_iter().zip(expected) {
                assert!(
                    (found - expected).abs() < 1e-6 * expected.abs().max(0.1),
                    "{found} {expected}"
                );
            }
        }
    }
}
