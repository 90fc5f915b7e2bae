use super::*;
use numerics::convolution::Complex64;
use std::f64::consts::PI;

/// Steel, in units of the thermal stress per kelvin.
const BODY: WarmBody = WarmBody {
    youngs_modulus: 0.7,
    poisson_ratio: 0.3,
    expansion: 1.0,
    diffusivity: 1.5e-5,
    speed: 2.0,
};

/// Components xx, yy, zz, yz, xz, xy and the temperature rise of a wave at a depth.
fn components(body: &WarmBody, k: [f64; 2], z: f64) -> ([Complex64; 6], Complex64) {
    let (length, gamma) = body.decay(k);
    let wave = body.wave((length, gamma), z, ((-length * z).exp(), (-gamma * z).exp()));
    let size = k[0].hypot(k[1]);
    let (cx, cy) = (k[0] / size, k[1] / size);
    let [along, across] = [wave.along, wave.across];
    let stresses = [
        along * (cx * cx) + across * (cy * cy),
        along * (cy * cy) + across * (cx * cx),
        wave.down,
        wave.shear * cy,
        wave.shear * cx,
        (along - across) * (cx * cy),
    ];
    (stresses, (gamma + size) * (-gamma * z).exp())
}

/// A wave is in equilibrium, leaves the surface free, and its strains derive from displacements,
/// checked by differences over the depth. These conditions make the stresses by this rise unique.
/// Waves are short and long against the skin; along, across and oblique; moving and at rest.
/// Tolerance: differences of second order over a thousandth of the shorter depth, against the
/// largest of the terms.
#[test]
fn a_wave_is_a_solution() {
    let resting = WarmBody { speed: 0.0, ..BODY };
    let waves: [[f64; 2]; 5] =
        [[300.0, 0.0], [5.0, 300.0], [300.0, 400.0], [2e4, -1e4], [1e5, 2e5]];
    for (body, k) in [BODY, resting].iter().flat_map(|body| waves.map(|k| (body, k))) {
        let size = k[0].hypot(k[1]);
        let gamma = Complex64::new(size * size, -k[0] * body.speed / body.diffusivity).sqrt();
        let i = Complex64::i();
        let (skin, at) = (gamma.norm().recip(), |z: f64| components(body, k, z));
        let (surface, rise) = at(0.0);
        for stress in [surface[2], surface[3], surface[4]] {
            assert!(stress.norm() < 1e-13 * rise.norm(), "{k:?}: {stress}");
        }
        for z in [0.3 * skin, skin, 0.5 / size, 2.0 / size] {
            let step = 1e-3 * skin;
            let around = [at(z - step), at(z), at(z + step)];
            let slope = |c: usize| (around[2].0[c] - around[0].0[c]) / (2.0 * step);
            let ([xx, yy, zz, yz, xz, xy], theta) = around[1];
            let largest = [xx, yy, zz, theta].iter().map(|s| s.norm()).fold(0.0, f64::max);
            let balance = [
                i * k[0] * xx + i * k[1] * xy + slope(4),
                i * k[0] * xy + i * k[1] * yy + slope(3),
                i * k[0] * xz + i * k[1] * yz + slope(2),
            ];
            for residual in balance {
                assert!(residual.norm() < 1e-5 * largest * size, "{k:?} at {z}: {residual}");
            }
            if k[1] == 0.0 {
                // Plane strain along the y axis.
                let free = yy - body.poisson_ratio * (xx + zz) + 0.7 * theta;
                assert!(free.norm() < 1e-12 * largest, "{free}");
                continue;
            }
            // Strains times E, with E α = 0.7 for the stress of a kelvin; displacements follow from
            // the strains along x and y.
            let strains = |at: &([Complex64; 6], Complex64)| {
                let ([xx, yy, zz, yz, xz, xy], theta) = *at;
                let nu = body.poisson_ratio;
                let trace = xx + yy + zz;
                let normal = |s: Complex64| (1.0 + nu) * s - nu * trace + 0.7 * theta;
                let twice = |s: Complex64| 2.0 * (1.0 + nu) * s;
                ([normal(xx), normal(yy), normal(zz)], [twice(yz), twice(xz), twice(xy)])
            };
            let of = around.map(|at| strains(&at));
            let across = of.map(|(normal, _)| [normal[0] / (i * k[0]), normal[1] / (i * k[1])]);
            let (normal, shear) = of[1];
            let turn = i * k[1] * across[1][0] + i * k[0] * across[1][1];
            let scale = normal.iter().chain(&shear).map(|e| e.norm()).fold(0.0, f64::max);
            // Error of the differences for a term that varies over the skin.
            let rough = 1e-5 * scale * (1.0 + gamma.norm() / k[0].abs().min(k[1].abs()));
            assert!((turn - shear[2]).norm() < rough, "{k:?} at {z}: {turn} {}", shear[2]);
            let derivative = |c: usize| (across[2][c] - across[0][c]) / (2.0 * step);
            let down =
                [(shear[1] - derivative(0)) / (i * k[0]), (shear[0] - derivative(1)) / (i * k[1])];
            let size_of_down = derivative(0).norm() / k[0].abs();
            assert!(
                (down[0] - down[1]).norm()
                    < 1e-5 * (size_of_down + derivative(1).norm() / k[1].abs()),
                "{k:?} at {z}: {down:?}"
            );
            let second =
                |c: usize| (across[2][c] - 2.0 * across[1][c] + across[0][c]) / (step * step);
            let middle = (strains(&around[2]).1[1] - strains(&around[0]).1[1]) / (2.0 * step);
            let stretch = (middle - second(0)) / (i * k[0]);
            assert!(
                (stretch - normal[2]).norm() < 1e-4 * (scale + second(0).norm() / k[0].abs()),
                "{k:?} at {z}: {stretch} {}",
                normal[2]
            );
        }
    }
}

/// Steady heat at rest: W = c/(r² + c²)^1.5 has the stresses σ_xx = 2(1 − ν)S(3y²/R⁵ − 1/R³),
/// σ_xy = −6(1 − ν)S xy/R⁵ with R² = r² + (c + z)², and zero σ_zz, σ_yz, σ_xz: derivatives of the
/// harmonic function 1/R. Tolerance: the part cut off at the grid's edges, (c/edge)³, and its
/// repetitions across.
#[test]
fn a_warm_place_at_rest() {
    let (c, step, half) = (1e-3, 1e-4, 80_i32);
    let first = -f64::from(half) * step;
    let count = (2 * half + 1) as usize;
    let grid = Structured::contact_plane(first, first, step, step, count, count);
    let of = |x: f64, y: f64| c / (x * x + y * y + c * c).powf(1.5);
    let values: Vec<f64> =
        (0..grid.points()).map(|at| of(grid.x(at % count), grid.y(at / count))).collect();
    let body = WarmBody { speed: 0.0, ..BODY };
    let (xs, y, depths) = ([-1.5e-3, 0.0, 0.7e-3], 0.6e-3, [0.2e-3, 0.8e-3]);
    let heat = RiseIntegral { grid: &grid, values: &values };
    let found = body.stresses(&heat, &xs, y, &depths);
    let scale = 2.0 * 0.7 / c.powi(3);
    for (at, stress) in found.iter().enumerate() {
        let (x, z) = (xs[at % 3], depths[at / 3]);
        let square = x * x + y * y + (c + z) * (c + z);
        let (cube, fifth) = (square.powf(1.5), square.powf(2.5));
        let normal = |t: f64| 1.4 * (3.0 * t * t / fifth - 1.0 / cube);
        let expected =
            Stress { xx: normal(y), yy: normal(x), xy: -4.2 * x * y / fifth, ..Stress::default() };
        let error = largest(&(*stress - expected)) / scale;
        println!("{x} {z}: {error:e}");
        assert!(error < 2e-4, "{x} {z}: {stress:?} {expected:?}");
    }
}

/// Temperature rise of a column at a depth, a time after the start of a uniform flux (Carslaw &
/// Jaeger, 2.9), for a unit of flux over the conductivity.
fn column(depth: f64, time: f64) -> f64 {
    if time <= 0.0 {
        return 0.0;
    }
    let spread = (BODY.diffusivity * time).sqrt();
    let x = depth / (2.0 * spread);
    2.0 * spread * ((-x * x).exp() / PI.sqrt() - x * erfc(x))
}

/// erfc by its integral, 2/√π ∫ e^{−t²} dt.
fn erfc(x: f64) -> f64 {
    2.0 / PI.sqrt() * numerics::quadrature::simpson(x, x + 8.0, |t| (-t * t).exp())
}

/// A parabolic flux, wide across, on fast material heats a thin skin with
/// σ_xx = σ_yy = −Eαϑ/(1 − ν). ϑ follows from Duhamel's integral over columns within, behind and
/// ahead of the heated zone; the surface is free. Tolerance: the depth of the skin is a share
/// √(κ/(Va)) of the length a, and stretches by at most half as much again; 2e-4 for the elements.
#[test]
fn a_skin_is_pressed_in_its_plane() {
    for speed in [40.0, 4000.0] {
        skin_at(speed);
    }
}

fn skin_at(speed: f64) {
    let a = 5e-3;
    let body = WarmBody { speed, ..BODY };
    let skin = (body.diffusivity * a / body.speed).sqrt();
    // W of a unit of flux over the conductivity: κ/V times the heat that has entered.
    let integral = |x: f64| {
        let xi = (-x / a).clamp(-1.0, 1.0);
        body.diffusivity / body.speed * a * (xi - xi.powi(3) / 3.0 + 2.0 / 3.0)
    };
    let grid = Structured::contact_plane(-1.5 * a, 0.0, a / 60.0, 1.0, 166, 1);
    let values: Vec<f64> = (0..grid.ni).map(|i| integral(grid.x(i))).collect();
    let heat = RiseIntegral { grid: &grid, values: &values };
    let rise = |x: f64, depth: f64| {
        // Integrates the derivative of the flux along x times the step response.
        let way = (a - x).max(0.0);
        let inside = way.min(2.0 * a);
        numerics::quadrature::simpson(0.0, inside, |s| {
            2.0 * (1.0 - s / a) / a * column(depth, (way - s) / body.speed)
        })
    };
    let xs = [-1.3 * a, -0.7 * a, 0.0, 0.6 * a, 1.1 * a];
    let depths = [0.05 * skin, 0.5 * skin, skin, 3.0 * skin];
    let found = body.stresses(&heat, &xs, 0.0, &depths);
    let hottest = rise(-0.3 * a, 0.0);
    let tolerance = 1.5 * skin / a + 2e-4;
    let mut worst = 0.0_f64;
    for (at, stress) in found.iter().enumerate() {
        let (x, z) = (xs[at % 5], depths[at / 5]);
        let expected = -rise(x, z) / hottest;
        let [xx, yy, zz, xz] = [stress.xx, stress.yy, stress.zz, stress.xz].map(|s| s / hottest);
        worst = worst.max((xx - expected).abs()).max((yy - expected).abs());
        assert!(worst < tolerance, "{} {}: {xx} {yy} {expected}", x / a, z / skin);
        assert!(zz.abs() < (skin / a).powi(2) * 5.0, "{zz}");
        assert!(xz.abs() < 2.0 * skin / a * z / skin, "{xz} at {}", z / skin);
        assert_eq!((stress.xy, stress.yz), (0.0, 0.0));
    }
    println!("skin {:.1e} of the length: {worst:.1e}", skin / a);
}

/// A grid that ends a tenth of the length behind the section, as in a contact, or far behind it.
/// Tolerance: a twentieth of the skin's depth over the length, since the modelled wake decays where
/// it should stay.
#[test]
fn the_end_of_the_grid_hardly_matters() {
    let a = 5e-3;
    let body = WarmBody { speed: 40.0, ..BODY };
    let skin = (body.diffusivity * a / body.speed).sqrt();
    let integral = |x: f64| {
        let xi = (-x / a).clamp(-1.0, 1.0);
        body.diffusivity / body.speed * a * (xi - xi.powi(3) / 3.0 + 2.0 / 3.0)
    };
    let xs: Vec<f64> = (0..25).map(|n| a * (-1.2 + 0.1 * f64::from(n))).collect();
    let depths = [0.1 * skin, skin, 0.1 * a];
    let of = |end: f64| {
        let columns = ((end + 1.25) * 60.0) as usize;
        let first = 1.25 * a - columns as f64 * a / 60.0;
        let grid = Structured::contact_plane(first, 0.0, a / 60.0, 1.0, columns, 1);
        let values: Vec<f64> = (0..columns).map(|i| integral(grid.x(i))).collect();
        body.stresses(&RiseIntegral { grid: &grid, values: &values }, &xs, 0.0, &depths)
    };
    let (near, far) = (of(1.3), of(12.0));
    let hottest = far.iter().map(largest).fold(0.0, f64::max);
    let apart = near.iter().zip(&far).map(|(one, other)| largest(&(*one - *other)));
    let worst = apart.fold(0.0, f64::max) / hottest;
    println!("{worst:.1e} of the largest stress, skin {:.1e}", skin / a);
    assert!(worst < 0.05 * skin / a, "{worst}");
}
