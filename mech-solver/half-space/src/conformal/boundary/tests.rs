use super::*;

const STEEL: ElasticConstants = ElasticConstants { shear_modulus: 2.0, poisson_ratio: 0.28 };

/// I₀ and I₁ by their series.
fn i0_i1(x: f64) -> [f64; 2] {
    let (mut term, mut sums) = (1.0, [0.0, 0.0]);
    for m in 0..40 {
        let m = f64::from(m);
        if m > 0.0 {
            term *= 0.25 * x * x / (m * m);
        }
        sums[0] += term;
        sums[1] += term * 0.5 * x / (m + 1.0);
    }
    sums
}

/// Radial displacement and amplitude of the axial displacement of a solid cylinder, or of a bore,
/// of unit radius. Its surface is pulled outwards by cos kx. Papkovich–Neuber solution with the
/// potentials I₀(kr) and r I₁(kr), or K₀ and −r K₁.
fn pulled(k: f64, [f0, f1]: [f64; 2]) -> [f64; 2] {
    let ElasticConstants { shear_modulus: g, poisson_ratio: nu } = STEEL;
    let radial = [k * f1, 4.0 * (1.0 - nu) * f1 - k * f0];
    let axial = [-k * f0, k * f1];
    let pull = [
        k * k * (f0 - f1 / k),
        4.0 * (1.0 - nu) * k * (f0 - f1 / k) - k * f0 - k * k * f1 + 2.0 * nu * k * f0,
    ];
    let shear = [-k * k * f1, k * (k * f0 - 2.0 * (1.0 - nu) * f1)];
    // Combines both potentials to zero shear and unit pull.
    let one = 1.0 / (pull[0] - pull[1] * shear[0] / shear[1]);
    let other = -one * shear[0] / shear[1];
    [radial, axial].map(|[a, b]| (one * a + other * b) / (2.0 * g))
}

/// A wave of pressure round a cylinder and round a bore, with both displacements.
#[test]
fn cylinders_and_bores_under_waves() {
    for (inside, k) in [(true, 0.4), (true, 2.0), (false, 0.4), (false, 2.0)] {
        let functions = match inside {
            true => i0_i1(k),
            false => {
                let [k0, k1] = numerics::bessel::k0_k1(k);
                [k0, -k1]
            }
        };
        let [radial, axial] = pulled(k, functions);
        // Seen from below, the surface of a cylinder bends down and the surface of a bore up.
        let curvature = if inside { -1.0 } else { 1.0 };
        let outline = Outline::circle(curvature, 40, 40);
        let body = Body { material: STEEL, outline, outward: 1.0 };
        let flexibility = body.flexibility(k);
        let all = |component: usize| -> f64 {
            (0..40).map(|q| flexibility[(component, 3 * q + 2)]).sum()
        };
        let outwards = if inside { radial } else { -radial };
        // Everything is constant on each element, so only the error of the quadrature remains.
        let errors = [all(2) - outwards, all(0) + axial].map(|error| (error / outwards).abs());
        assert!(errors[0] < 1e-7 && errors[1] < 1e-7, "{inside} {k}: {errors:?}");
    }
}
