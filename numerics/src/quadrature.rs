//! Integrals over an interval: Gauss–Legendre quadrature, and Simpson's rule for comparison.
//!
//! The rule of N points integrates polynomials of degree 2N − 1 exactly. For a function that is
//! analytic inside an ellipse, the error falls like ϱ^(−2N); with the interval as [−1, 1], the foci
//! are its ends and ϱ is the sum of the semi-axes. Nodes and weights come from Newton's iteration
//! on the Legendre polynomials (Davis & Rabinowitz, Methods of Numerical Integration, 2.7).

use std::f64::consts::PI;
use std::sync::LazyLock;

// Tables of increasing nodes and weights on [−1, 1], rounded to the nearest doubles, for loops that
// evaluate a rule millions of times.

/// Rule of 3 points.
pub const GAUSS_3: [(f64, f64); 3] = [
    (-0.774_596_669_241_483_4, 0.555_555_555_555_555_6),
    (0.0, 0.888_888_888_888_888_8),
    (0.774_596_669_241_483_4, 0.555_555_555_555_555_6),
];

/// Rule of 4 points.
pub const GAUSS_4: [(f64, f64); 4] = [
    (-0.861_136_311_594_052_6, 0.347_854_845_137_453_85),
    (-0.339_981_043_584_856_26, 0.652_145_154_862_546_1),
    (0.339_981_043_584_856_26, 0.652_145_154_862_546_1),
    (0.861_136_311_594_052_6, 0.347_854_845_137_453_85),
];

/// Rule of 5 points.
pub const GAUSS_5: [(f64, f64); 5] = [
    (-0.906_179_845_938_664, 0.236_926_885_056_189_08),
    (-0.538_469_310_105_683_1, 0.478_628_670_499_366_47),
    (0.0, 0.568_888_888_888_888_9),
    (0.538_469_310_105_683_1, 0.478_628_670_499_366_47),
    (0.906_179_845_938_664, 0.236_926_885_056_189_08),
];

/// Rule of 7 points.
pub const GAUSS_7: [(f64, f64); 7] = [
    (-0.949_107_912_342_758_5, 0.129_484_966_168_869_7),
    (-0.741_531_185_599_394_5, 0.279_705_391_489_276_64),
    (-0.405_845_151_377_397_2, 0.381_830_050_505_118_9),
    (0.0, 0.417_959_183_673_469_4),
    (0.405_845_151_377_397_2, 0.381_830_050_505_118_9),
    (0.741_531_185_599_394_5, 0.279_705_391_489_276_64),
    (0.949_107_912_342_758_5, 0.129_484_966_168_869_7),
];

/// Rule of 8 points.
pub const GAUSS_8: [(f64, f64); 8] = [
    (-0.960_289_856_497_536_3, 0.101_228_536_290_376_26),
    (-0.796_666_477_413_626_7, 0.222_381_034_453_374_48),
    (-0.525_532_409_916_329, 0.313_706_645_877_887_27),
    (-0.183_434_642_495_649_8, 0.362_683_783_378_362),
    (0.183_434_642_495_649_8, 0.362_683_783_378_362),
    (0.525_532_409_916_329, 0.313_706_645_877_887_27),
    (0.796_666_477_413_626_7, 0.222_381_034_453_374_48),
    (0.960_289_856_497_536_3, 0.101_228_536_290_376_26),
];

/// Rule of 10 points.
pub const GAUSS_10: [(f64, f64); 10] = [
    (-0.973_906_528_517_171_7, 0.066_671_344_308_688_14),
    (-0.865_063_366_688_984_5, 0.149_451_349_150_580_6),
    (-0.679_409_568_299_024_4, 0.219_086_362_515_982_04),
    (-0.433_395_394_129_247_2, 0.269_266_719_309_996_35),
    (-0.148_874_338_981_631_22, 0.295_524_224_714_752_87),
    (0.148_874_338_981_631_22, 0.295_524_224_714_752_87),
    (0.433_395_394_129_247_2, 0.269_266_719_309_996_35),
    (0.679_409_568_299_024_4, 0.219_086_362_515_982_04),
    (0.865_063_366_688_984_5, 0.149_451_349_150_580_6),
    (0.973_906_528_517_171_7, 0.066_671_344_308_688_14),
];

/// Rule of 16 points.
pub const GAUSS_16: [(f64, f64); 16] = [
    (-0.989_400_934_991_649_9, 0.027_152_459_411_754_096),
    (-0.944_575_023_073_232_6, 0.062_253_523_938_647_894),
    (-0.865_631_202_387_831_8, 0.095_158_511_682_492_79),
    (-0.755_404_408_355_003, 0.124_628_971_255_533_88),
    (-0.617_876_244_402_643_8, 0.149_595_988_816_576_74),
    (-0.458_016_777_657_227_37, 0.169_156_519_395_002_54),
    (-0.281_603_550_779_258_9, 0.182_603_415_044_923_58),
    (-0.095_012_509_837_637_44, 0.189_450_610_455_068_5),
    (0.095_012_509_837_637_44, 0.189_450_610_455_068_5),
    (0.281_603_550_779_258_9, 0.182_603_415_044_923_58),
    (0.458_016_777_657_227_37, 0.169_156_519_395_002_54),
    (0.617_876_244_402_643_8, 0.149_595_988_816_576_74),
    (0.755_404_408_355_003, 0.124_628_971_255_533_88),
    (0.865_631_202_387_831_8, 0.095_158_511_682_492_79),
    (0.944_575_023_073_232_6, 0.062_253_523_938_647_894),
    (0.989_400_934_991_649_9, 0.027_152_459_411_754_096),
];

/// Number of points of the longest rule.
pub const POINTS: usize = 12;

/// Rules of 0 to [`POINTS`] points.
static RULES: LazyLock<Vec<Vec<(f64, f64)>>> =
    LazyLock::new(|| (0..=POINTS).map(|n| (0..n).map(|i| node(i, n)).collect()).collect());

/// Node and weight number `i` of the rule of `points` points on [−1, 1].
fn node(i: usize, points: usize) -> (f64, f64) {
    let n = points as f64;
    let mut x = (PI * (i as f64 + 0.75) / (n + 0.5)).cos();
    for _ in 0..8 {
        let (p, dp) = legendre(x, points);
        x -= p / dp;
    }
    let (_, dp) = legendre(x, points);
    (x, 2.0 / ((1.0 - x * x) * dp * dp))
}

/// Legendre polynomial of a degree, and its derivative.
fn legendre(x: f64, degree: usize) -> (f64, f64) {
    let (mut before, mut p) = (1.0, x);
    for k in 1..degree {
        let k = k as f64;
        (before, p) = (p, ((2.0 * k + 1.0) * x * p - k * before) / (k + 1.0));
    }
    (p, degree as f64 * (x * p - before) / (x * x - 1.0))
}

/// Returns points and weights of the longest rule on [from, to].
pub fn points(from: f64, to: f64) -> impl Iterator<Item = (f64, f64)> {
    points_of(POINTS, from, to)
}

/// Returns points and weights of the rule of `count` points on [from, to]; at most [`POINTS`].
pub fn points_of(count: usize, from: f64, to: f64) -> impl Iterator<Item = (f64, f64)> {
    let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
    RULES[count].iter().map(move |(x, weight)| (middle + half * x, half * weight))
}

/// Returns the integral of `f` over [from, to], by the longest rule.
pub fn integrate(from: f64, to: f64, f: impl Fn(f64) -> f64) -> f64 {
    points(from, to).map(|(x, weight)| weight * f(x)).sum()
}

/// Returns the integral over [from, to] by Simpson's rule after the substitution s(3 − s²)/2. The
/// substitution flattens both ends, so that square roots there become smooth. The relative error is
/// below 1e-10 for such functions.
#[must_use]
pub fn simpson(from: f64, to: f64, function: impl Fn(f64) -> f64) -> f64 {
    let (middle, half, intervals) = (0.5 * (from + to), 0.5 * (to - from), 4000);
    let step = 2.0 / f64::from(intervals);
    let term = |i: i32| {
        let s = -1.0 + step * f64::from(i);
        let simpson = if i % 2 == 1 { 4.0 } else { 2.0 };
        simpson * function(middle + half * 0.5 * s * (3.0 - s * s)) * 1.5 * (1.0 - s * s)
    };
    half * step / 3.0 * (1..intervals).map(term).sum::<f64>()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Tolerance: rounding of Newton's iteration.
    #[test]
    fn tables_are_the_rules() {
        let tables: [&[(f64, f64)]; 6] =
            [&GAUSS_3, &GAUSS_4, &GAUSS_5, &GAUSS_7, &GAUSS_8, &GAUSS_10];
        for table in tables {
            let rule = RULES[table.len()].iter().rev();
            for ((x, weight), (node, of_node)) in table.iter().zip(rule) {
                assert!((x - node).abs() < 1e-15 && (weight - of_node).abs() < 1e-15);
            }
        }
        let degree = |n: i32| GAUSS_16.iter().map(|(x, weight)| weight * x.powi(n)).sum::<f64>();
        assert!((0..16).all(|n| (degree(2 * n) - 2.0 / f64::from(2 * n + 1)).abs() < 1e-14));
    }

    #[test]
    fn exact_for_polynomials_up_to_its_degree() {
        for degree in 0..2 * POINTS as i32 {
            let exact = (3_f64.powi(degree + 1) - 1.0) / f64::from(degree + 1);
            let got = integrate(1.0, 3.0, |x| x.powi(degree));
            // Rounding of a dozen terms.
            assert!((got / exact - 1.0).abs() < 1e-14, "degree {degree}: {got} {exact}");
        }
    }
}
