use super::*;

const STEEL: Material = Material { youngs_modulus: 209.92e9, poisson_ratio: 0.28 };

/// A wave along x on flat bodies, summed over x, gives half-spaces with all signs; one body is
/// rigid.
#[test]
fn flat_bodies_are_half_spaces() {
    let patch = SurfaceGrid { counts: [24, 7], sides: [1e-3, 1e-3], first: -3.5e-3 };
    let outline = Outline::open(&CrossSection::straight(), [patch.first, 1e-3], 7, 1000.0);
    let waves: Vec<f64> = (0..45).map(|n| 0.05 * 1.33_f64.powi(n)).collect();
    let [even, odd] = weights(&waves, patch);
    for (outward, elasticity) in [-1.0, 1.0].into_iter().zip(Elasticity::of_bodies(&[STEEL, STEEL]))
    {
        let influence = Influence::of_elements([1e-3; 2], elasticity);
        let body =
            Body { material: ElasticConstants::of(&STEEL), outline: outline.clone(), outward };
        let flexibilities: Vec<_> = waves.iter().map(|k| body.flexibility(*k)).collect();
        for (a, b) in [(0, 0), (1, 1), (2, 2), (0, 1), (1, 0), (0, 2), (2, 0), (1, 2), (2, 1)] {
            let (weights, sign) = match (a, b) {
                (0, 1 | 2) => (&odd, -1.0),
                (1 | 2, 0) => (&odd, 1.0),
                _ => (&even, 1.0),
            };
            let (t, q, i) = (4, 1, 3);
            let exact = of_half_spaces(&influence, 3 * a + b, i as i32, 3);
            let own = of_half_spaces(&influence, 8, 0, 0);
            let row = &weights[i * waves.len()..(i + 1) * waves.len()];
            let value: f64 = row
                .iter()
                .zip(&flexibilities)
                .map(|(w, m)| w * sign * m[(3 * t + a, 3 * q + b)])
                .sum();
            // Tolerance: constant tractions on elements, three elements away.
            assert!((value - exact).abs() < 0.01 * own, "{a}{b}: {value:e} instead of {exact:e}");
        }
    }
}

/// Betti's reciprocity, which boundary elements meet only approximately. Tolerance: the error of
/// constant tractions.
#[test]
fn curved_bodies_are_reciprocal() {
    let patch = SurfaceGrid { counts: [9, 13], sides: [0.8e-3; 2], first: -5.2e-3 };
    let quarter = std::f64::consts::FRAC_PI_4;
    let sections = [98.0, 100.0].map(|c| CrossSection::arc(-c, quarter / c));
    let numbers = InfluenceNumbers::new(&[STEEL, STEEL], &sections, &patch);
    let own = numbers.value([2, 2], 0, [6, 6]);
    for i in [0, 2, 8] {
        for (t, q) in [(6, 6), (7, 6), (10, 3), (12, 0)] {
            for (a, b) in [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)] {
                let sign = if (a == 0) == (b == 0) { 1.0 } else { -1.0 };
                let [one, other] =
                    [numbers.value([a, b], i, [t, q]), sign * numbers.value([b, a], i, [q, t])];
                assert!((one - other).abs() < 1e-3 * own, "{a}{b} {i} {t}{q}: {one:e} {other:e}");
            }
        }
    }
}

/// Boundary elements of three rows, which turn by less than 0.01, err by less than that share of an
/// element's own number. The change by curvature is less smooth next to an element than elsewhere.
#[test]
fn boundary_elements_may_be_longer_than_rows() {
    let patch = SurfaceGrid { counts: [9, 48], sides: [0.2e-3; 2], first: -4.8e-3 };
    let sections = [12.0, 12.5].map(|c| CrossSection::arc(-c, 0.1 / c));
    assert_eq!(joined(&sections, &patch), 3);
    let flat = [CrossSection::straight(), CrossSection::straight()];
    let numbers = |sections: &[CrossSection; 2], joined: Option<usize>| {
        let mut numbers = InfluenceNumbers::new(&[STEEL, STEEL], &flat, &patch);
        joined.iter().for_each(|joined| numbers.add(&[STEEL, STEEL], sections, *joined));
        numbers
    };
    let [none, one, three] = [None, Some(1), Some(3)].map(|joined| numbers(&sections, joined));
    let own = none.value([2, 2], 0, [24, 24]);
    for pair in [[0, 0], [1, 1], [2, 2], [2, 1], [0, 2]] {
        let (mut most, mut off) = (0.0_f64, 0.0_f64);
        for i in [0, 3, 8] {
            for (t, q) in [(24, 24), (25, 24), (30, 22), (5, 5), (40, 8)] {
                let of = |numbers: &InfluenceNumbers| numbers.value(pair, i, [t, q]);
                most = most.max((of(&one) - of(&none)).abs());
                off = off.max((of(&one) - of(&three)).abs());
            }
        }
        assert!(off < 2e-3 * own, "{pair:?}: {off:e} of {most:e}, {own:e}");
    }
}
