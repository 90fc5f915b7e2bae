use super::*;
use numerics::quadrature::GAUSS_5;
use std::f64::consts::PI;

const ELEMENT: Element = Element { dx: 0.8, dy: 0.5, poisson_ratio: 0.3 };

type Kernel = fn(f64, f64, f64, f64) -> Stress;

/// Boussinesq's solution in cylindrical coordinates (Johnson, eq. 3.20), turned into x and y.
fn boussinesq(nu: f64, x: f64, y: f64, z: f64) -> Stress {
    let (r, rho) = (x.hypot(y), (x * x + y * y + z * z).sqrt());
    let (cosine, sine) = (x / r, y / r);
    let lateral = (1.0 - 2.0 * nu) / (r * r) * (1.0 - z / rho);
    let radial = lateral - 3.0 * z * r * r / rho.powi(5);
    let hoop = -lateral + (1.0 - 2.0 * nu) * z / rho.powi(3);
    let shear = -3.0 * r * z * z / rho.powi(5);
    let twice_pi = Stress {
        xx: radial * cosine * cosine + hoop * sine * sine,
        yy: radial * sine * sine + hoop * cosine * cosine,
        zz: -3.0 * z.powi(3) / rho.powi(5),
        yz: shear * sine,
        xz: shear * cosine,
        xy: (radial - hoop) * cosine * sine,
    };
    0.5 / PI * twice_pi
}

/// Cerruti's solution for a force along x (Johnson, eq. 3.76).
fn cerruti_x(nu: f64, x: f64, y: f64, z: f64) -> Stress {
    let rho = (x * x + y * y + z * z).sqrt();
    let (p3, p5) = (rho.powi(3), rho.powi(5));
    let (s2, s3) = ((rho + z).powi(2), (rho + z).powi(3));
    let term = |first: f64, factor: f64, square: f64| {
        first - factor / (rho * s2) + square / (p3 * s2) + 2.0 * square / (rho * rho * s3)
    };
    let plane = 1.0 - 2.0 * nu;
    let twice_pi = Stress {
        xx: -3.0 * x.powi(3) / p5 + plane * term(x / p3, 3.0 * x, x.powi(3)),
        yy: -3.0 * x * y * y / p5 + plane * term(x / p3, x, x * y * y),
        zz: -3.0 * x * z * z / p5,
        yz: -3.0 * x * y * z / p5,
        xz: -3.0 * x * x * z / p5,
        xy: -3.0 * x * x * y / p5 + plane * term(0.0, y, x * x * y),
    };
    0.5 / PI * twice_pi
}

/// The stress under q_y from that under q_x, by exchange of the axes.
fn exchanged(of: Stress) -> Stress {
    Stress { xx: of.yy, yy: of.xx, zz: of.zz, yz: of.xz, xz: of.yz, xy: of.xy }
}

fn cerruti_y(nu: f64, x: f64, y: f64, z: f64) -> Stress {
    exchanged(cerruti_x(nu, y, x, z))
}

fn loads(units: &UnitStresses) -> [(Stress, Kernel); 3] {
    [(units.pressure, boussinesq), (units.traction_x, cerruti_x), (units.traction_y, cerruti_y)]
}

/// Integral over the rectangle centre ± half, split in four until two levels agree.
fn adaptive(
    function: &dyn Fn(f64, f64) -> Stress,
    centre: [f64; 2],
    half: [f64; 2],
    tolerance: f64,
) -> Stress {
    let rule = |centre: [f64; 2], half: [f64; 2]| -> Stress {
        let row = |(t, weight): &(f64, f64)| -> Stress {
            let y = centre[1] + half[1] * t;
            let at = |(s, w): &(f64, f64)| *w * function(centre[0] + half[0] * s, y);
            *weight * GAUSS_5.iter().map(at).sum::<Stress>()
        };
        half[0] * half[1] * GAUSS_5.iter().map(row).sum::<Stress>()
    };
    let quarter = half.map(|side| 0.5 * side);
    let signs = [[-1.0, -1.0], [1.0, -1.0], [-1.0, 1.0], [1.0, 1.0]];
    let centres = signs.map(|s| [centre[0] + s[0] * quarter[0], centre[1] + s[1] * quarter[1]]);
    let parts: Stress = centres.iter().map(|centre| rule(*centre, quarter)).sum();
    if largest(&(parts - rule(centre, half))) <= tolerance {
        return parts;
    }
    centres.iter().map(|centre| adaptive(function, *centre, quarter, 0.25 * tolerance)).sum()
}

/// Tolerance: the target of the quadrature, and the rounding of the corner sum and of Boussinesq's
/// solution near the axis.
#[test]
fn closed_forms_equal_quadrature_of_point_loads() {
    let places = [
        [0.011, 0.007, 0.3],
        [0.1, -0.2, 0.05],
        [0.37, 0.21, 0.8],
        [-0.4, 0.25, 0.2],
        [0.9, 0.05, 0.0],
        [-1.1, 2.3, 1.7],
        [5.2, -3.1, 0.4],
        [0.013, 0.031, 7.0],
        [11.0, 4.0, 2.0],
    ];
    for nu in [0.0, 0.3, 0.5] {
        let element = Element { poisson_ratio: nu, ..ELEMENT };
        for [x, y, z] in places {
            let distance = x * x + y * y + z * z;
            let scale = (element.dx * element.dy / distance).min(1.0);
            for (closed, kernel) in loads(&element.at(x, y, z)) {
                let at = |s: f64, t: f64| kernel(nu, x - s, y - t, z);
                let half = [0.5 * element.dx, 0.5 * element.dy];
                let expected = adaptive(&at, [0.0; 2], half, 1e-12 * scale);
                let error = largest(&(closed - expected));
                assert!(error < 1e-11 * scale, "{x} {y} {z}: {:e}", error / scale);
            }
        }
    }
}

fn derivatives(of: &dyn Fn([f64; 3]) -> Stress, at: [f64; 3], step: f64) -> [Stress; 3] {
    [0, 1, 2].map(|axis| {
        let moved = |by: f64| {
            let mut place = at;
            place[axis] += by * step;
            of(place)
        };
        let near = moved(1.0) - moved(-1.0);
        1.0 / (12.0 * step) * (8.0 * near - (moved(2.0) - moved(-2.0)))
    })
}

const KINDS: [fn(&UnitStresses) -> Stress; 3] =
    [|units| units.pressure, |units| units.traction_x, |units| units.traction_y];

/// Forces on a small box are in equilibrium: ∂σ_ij/∂x_j = 0. Tolerance: differences of fourth order
/// with a step of 1e-3, and rounding over the step.
#[test]
fn stresses_are_in_equilibrium() {
    for kind in KINDS {
        for at in [[0.1, 0.2, 0.4], [0.5, -0.3, 0.3], [-0.9, 0.6, 1.2], [20.0, 3.0, 5.0]] {
            let stress = |[x, y, z]: [f64; 3]| kind(&ELEMENT.at(x, y, z));
            let [dx, dy, dz] = derivatives(&stress, at, 1e-3);
            for force in [dx.xx + dy.xy + dz.xz, dx.xy + dy.yy + dz.yz, dx.xz + dy.yz + dz.zz] {
                assert!(force.abs() < 1e-9, "{at:?}: {force:e}");
            }
        }
    }
}

/// Strains are compatible, (1 + ν) ∇²σ_ij + ∂²σ_kk/∂x_i∂x_j = 0 (Beltrami and Michell). Unlike
/// equilibrium, this detects a wrong Poisson's ratio. Tolerance: second differences of fourth order
/// with a step of 1e-2, taken twice; the terms are of order 1.
#[test]
fn strains_are_compatible() {
    for kind in KINDS {
        for at in [[0.1, 0.2, 0.5], [0.6, -0.4, 0.6], [-0.9, 0.6, 1.2]] {
            let stress = |[x, y, z]: [f64; 3]| kind(&ELEMENT.at(x, y, z));
            let second = |axis: usize| {
                let first = |place: [f64; 3]| derivatives(&stress, place, 1e-2)[axis];
                derivatives(&first, at, 1e-2)
            };
            let [by_x, by_y, by_z] = [second(0), second(1), second(2)];
            let laplacian = by_x[0] + by_y[1] + by_z[2];
            let trace = |stress: Stress| 3.0 * stress.mean();
            let hessian = Stress {
                xx: trace(by_x[0]),
                yy: trace(by_y[1]),
                zz: trace(by_z[2]),
                yz: trace(by_y[2]),
                xz: trace(by_x[2]),
                xy: trace(by_x[1]),
            };
            let rest = (1.0 + ELEMENT.poisson_ratio) * laplacian + hessian;
            assert!(largest(&rest) < 2e-5, "{at:?}: {rest:?}");
            assert!(largest(&hessian) > 1e-2, "the test has something to balance");
        }
    }
}

/// The stresses at the surface equal the tractions, and zero outside. Tolerance: the depth.
#[test]
fn tractions_at_the_surface() {
    for depth in [0.0, 1e-9] {
        for ([x, y], load) in [([0.2, -0.1], 1.0), ([0.39, 0.24], 1.0), ([0.5, 0.1], 0.0)] {
            let UnitStresses { pressure, traction_x, traction_y } = ELEMENT.at(x, y, depth);
            let found = [
                [pressure.xz, pressure.yz, pressure.zz],
                [traction_x.xz, traction_x.yz, traction_x.zz],
                [traction_y.xz, traction_y.yz, traction_y.zz],
            ];
            let expected = [[0.0, 0.0, -load], [-load, 0.0, 0.0], [0.0, -load, 0.0]];
            for (found, expected) in found.as_flattened().iter().zip(expected.as_flattened()) {
                assert!((found - expected).abs() < 1e2 * depth + 1e-15, "{found} {expected}");
            }
        }
    }
}

/// At the centre of a loaded square's surface σ_xx = σ_yy = −p(½ + ν): lateral expansion is half
/// prevented (Love). Tolerance: rounding.
#[test]
fn surface_stress_at_the_centre_of_a_square() {
    let square = Element { dx: 0.3, dy: 0.3, poisson_ratio: 0.3 };
    let Stress { xx, yy, .. } = square.at(0.0, 0.0, 0.0).pressure;
    assert!((xx + 0.8).abs() < 1e-15 && (yy + 0.8).abs() < 1e-15, "{xx} {yy}");
}

/// The corner sum and the far rule meet. Tolerance: the errors of Gauss's rule and of the corner
/// sum's rounding there.
#[test]
fn no_jump_where_the_far_rule_takes_over() {
    let far = 16.0 * ELEMENT.dx;
    for direction in noise(60, 3).chunks_exact(3) {
        let [x, y, z] = [direction[0], direction[1], direction[2].abs()];
        let unit = far / (x * x + y * y + z * z).sqrt();
        let at = |by: f64| ELEMENT.at(by * unit * x, by * unit * y, by * unit * z);
        let (near, beyond) = (at(1.0 - 1e-14), at(1.0 + 1e-14));
        for kind in KINDS {
            let (near, beyond) = (kind(&near), kind(&beyond));
            let error = largest(&(near - beyond)) / largest(&near);
            assert!(error < 3e-12, "{x} {y} {z}: {error:e}");
        }
    }
}

/// Tolerance: the next term, of the order of the element's size over the distance squared.
#[test]
fn far_elements_act_like_point_loads() {
    let area = ELEMENT.dx * ELEMENT.dy;
    for distance in [1e2, 1e3, 1e4] {
        let [x, y, z] = [0.48, -0.64, 0.6].map(|direction| direction * distance);
        for (stress, kernel) in loads(&ELEMENT.at(x, y, z)) {
            let expected = area * kernel(ELEMENT.poisson_ratio, x, y, z);
            let error = largest(&(stress - expected)) / largest(&expected);
            assert!(error < 3.0 * distance.powi(-2), "{distance}: {error:e}");
        }
    }
}

/// Mirror images in x and in y agree, bit for bit where corner sums are used.
#[test]
fn mirror_images() {
    let (x, y, z) = (1.3, 0.7, 0.6);
    let of = |sx: f64, sy: f64| {
        let units = ELEMENT.at(sx * x, sy * y, z);
        // Mirrors the traction along the mirrored axis, and mirrors the stress back.
        let back = |s: Stress| Stress { yz: sy * s.yz, xz: sx * s.xz, xy: sx * sy * s.xy, ..s };
        UnitStresses {
            pressure: back(units.pressure),
            traction_x: sx * back(units.traction_x),
            traction_y: sy * back(units.traction_y),
        }
    };
    assert_eq!(of(-1.0, 1.0), of(1.0, 1.0));
    assert_eq!(of(1.0, -1.0), of(1.0, 1.0));
    let turned = Element { dx: ELEMENT.dy, dy: ELEMENT.dx, ..ELEMENT }.at(y, x, z);
    let difference = exchanged(turned.traction_y) - ELEMENT.at(x, y, z).traction_x;
    assert!(largest(&difference) < 1e-15, "rounding");
}

/// Quarters of an element add up to it. Tolerance: rounding.
#[test]
fn additive_in_the_element() {
    let half = Element { dx: 0.5 * ELEMENT.dx, dy: 0.5 * ELEMENT.dy, ..ELEMENT };
    for [x, y, z] in [[0.1, 0.2, 0.3], [1.3, -0.4, 0.0], [0.0, 0.0, 2.0], [0.0, 0.0, 0.1]] {
        let (quarter_x, quarter_y) = (0.5 * half.dx, 0.5 * half.dy);
        for kind in KINDS {
            let signs = [[-1.0, -1.0], [1.0, -1.0], [-1.0, 1.0], [1.0, 1.0]];
            let part = |s: &[f64; 2]| kind(&half.at(x + s[0] * quarter_x, y + s[1] * quarter_y, z));
            let sum: Stress = signs.iter().map(part).sum();
            let error = largest(&(sum - kind(&ELEMENT.at(x, y, z))));
            assert!(error < 2e-15, "{x} {y} {z}: {error:e}");
        }
    }
}

/// Stresses stay of the order of the load at corners on the surface, and the edge between equal
/// elements leaves no trace. Tolerance: rounding.
#[test]
fn edges_between_equal_elements_cannot_be_seen() {
    let wide = Element { dx: 2.0 * ELEMENT.dx, ..ELEMENT };
    let half = 0.5 * ELEMENT.dx;
    for depth in [0.0, 1e-3] {
        for kind in KINDS {
            let sum = kind(&ELEMENT.at(half, 0.1, depth)) + kind(&ELEMENT.at(-half, 0.1, depth));
            let error = largest(&(sum - kind(&wide.at(0.0, 0.1, depth))));
            assert!(error < 1e-14, "{depth}: {error:e}");
            let corner = kind(&ELEMENT.at(half, 0.5 * ELEMENT.dy, depth));
            assert!(largest(&corner) < 2.0, "of the order of the load: {corner:?}");
        }
    }
}
