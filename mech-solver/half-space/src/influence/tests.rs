use super::*;

use elastic::Material;
const STEEL: Material = Material { youngs_modulus: 210e9, poisson_ratio: 0.3 };
const POLYMER: Material = Material { youngs_modulus: 3e9, poisson_ratio: 0.42 };

type Component = fn(&Influence, f64, f64) -> f64;

/// Component, its point-load kernel on the unit circle as a function of (x, y), and its mirror
/// signs.
struct Case {
    name: &'static str,
    component: Component,
    point_load: fn(&Elasticity, f64, f64) -> f64,
    signs: (f64, f64),
}

fn cases() -> [Case; 8] {
    let case = |name, component, point_load, signs| Case { name, component, point_load, signs };
    [
        case("zz", Influence::zz_at, |e, _, _| e.contact_compliance(), (1.0, 1.0)),
        case("xx", Influence::xx_at, |e, x, _| tangential(e, x), (1.0, 1.0)),
        case("yy", Influence::yy_at, |e, _, y| tangential(e, y), (1.0, 1.0)),
        case("xy", Influence::xy_at, |e, x, y| e.poisson_compliance * x * y, (-1.0, -1.0)),
        case("zx", Influence::zx_at, |e, x, _| e.coupling_compliance * x, (-1.0, 1.0)),
        case("zy", Influence::zy_at, |e, _, y| e.coupling_compliance * y, (1.0, -1.0)),
        case("xz", Influence::xz_at, |e, x, _| -e.coupling_compliance * x, (-1.0, 1.0)),
        case("yz", Influence::yz_at, |e, _, y| -e.coupling_compliance * y, (1.0, -1.0)),
    ]
}

fn tangential(e: &Elasticity, cosine: f64) -> f64 {
    e.contact_compliance() + e.poisson_compliance * cosine * cosine
}

fn influence() -> Influence {
    let elasticity = Elasticity::of_pair(&POLYMER, &STEEL);
    Influence { dx: 0.2e-3, dy: 0.15e-3, elasticity, plane_strain: false }
}

impl Case {
    /// Kernel at (x, y) [m/N]; every kernel falls like 1/R along a ray.
    fn kernel(&self, e: &Elasticity, x: f64, y: f64) -> f64 {
        let distance = x.hypot(y);
        (self.point_load)(e, x / distance, y / distance) / (PI * distance)
    }

    /// Largest value of the kernel at a distance, as the scale of errors.
    fn scale(&self, e: &Elasticity, area: f64, distance: f64) -> f64 {
        let largest = match self.name {
            "xy" => 0.5 * e.poisson_compliance,
            "zz" | "xx" | "yy" => e.contact_compliance(),
            _ => e.coupling_compliance.abs(),
        };
        area * largest / (PI * distance)
    }
}

/// Gauss's rule with halving until two levels agree.
fn adaptive(function: &dyn Fn(f64) -> f64, from: f64, to: f64, tolerance: f64) -> f64 {
    fn rule(function: &dyn Fn(f64) -> f64, from: f64, to: f64) -> f64 {
        let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
        let at = |(node, weight): &(f64, f64)| weight * function(middle + half * node);
        half * GAUSS_4.iter().map(at).sum::<f64>()
    }
    let middle = 0.5 * (from + to);
    let whole = rule(function, from, to);
    let parts = rule(function, from, middle) + rule(function, middle, to);
    if (whole - parts).abs() <= tolerance {
        return parts;
    }
    adaptive(function, from, middle, 0.5 * tolerance)
        + adaptive(function, middle, to, 0.5 * tolerance)
}

/// Integral of the kernel over an element that does not contain the target.
fn outside(case: &Case, of: &Influence, x: f64, y: f64, scale: f64) -> f64 {
    let (half_x, half_y) = (0.5 * of.dx, 0.5 * of.dy);
    let tolerance = 1e-12 * scale;
    let row = |s: f64| {
        let kernel = |t: f64| case.kernel(&of.elasticity, s, t);
        adaptive(&kernel, y - half_y, y + half_y, tolerance / of.dx)
    };
    adaptive(&row, x - half_x, x + half_x, tolerance)
}

/// Integral over an element that contains the target. Polar coordinates remove the kernel's 1/R and
/// leave the length of the ray to the element's edge.
fn inside(case: &Case, of: &Influence, x: f64, y: f64, scale: f64) -> f64 {
    let (half_x, half_y) = (0.5 * of.dx, 0.5 * of.dy);
    let ray = |angle: f64| {
        let (sine, cosine) = angle.sin_cos();
        let to_x = (x + half_x.copysign(cosine)) / cosine;
        let to_y = (y + half_y.copysign(sine)) / sine;
        (case.point_load)(&of.elasticity, cosine, sine) / PI * to_x.min(to_y)
    };
    let corner = |sx: f64, sy: f64| (y + sy * half_y).atan2(x + sx * half_x);
    let mut breaks = vec![corner(-1.0, -1.0), corner(1.0, -1.0), 0.0, corner(1.0, 1.0)];
    breaks.extend([PI / 2.0, corner(-1.0, 1.0), PI, -PI / 2.0, -PI]);
    breaks.sort_by(f64::total_cmp);
    breaks.windows(2).map(|pair| adaptive(&ray, pair[0], pair[1], 1e-13 * scale)).sum()
}

/// Tolerance: the target of the quadrature, and the rounding of the corner sum.
#[test]
fn closed_forms_equal_quadrature() {
    let of = influence();
    let area = of.dx * of.dy;
    let targets = [(1.0, 0.0), (0.0, 1.0), (-1.0, 2.0), (0.3, -1.4), (7.5, 3.25), (16.5, 1.0)];
    for case in cases() {
        for (i, j) in targets {
            let (x, y) = (i * of.dx, j * of.dy);
            let scale = case.scale(&of.elasticity, area, x.hypot(y));
            let error = (case.component)(&of, x, y) - outside(&case, &of, x, y, scale);
            assert!(error.abs() < 1e-11 * scale, "{} at ({i}, {j}): {}", case.name, error / scale);
        }
        for (i, j) in [(0.0, 0.0), (0.3, -0.2), (-0.45, 0.1)] {
            let (x, y) = (i * of.dx, j * of.dy);
            let scale = case.scale(&of.elasticity, area, 0.5 * of.dx);
            let error = (case.component)(&of, x, y) - inside(&case, &of, x, y, scale);
            assert!(error.abs() < 1e-11 * scale, "{} at ({i}, {j}): {}", case.name, error / scale);
        }
    }
}

/// The corner sum and the far rule meet. Tolerance: the errors of Gauss's rule and of the corner
/// sum's rounding there.
#[test]
fn no_jump_where_the_far_rule_takes_over() {
    let of = influence();
    for case in cases() {
        for angle in [0.1, 0.7, 1.3_f64] {
            let (x, y) = (FAR * of.dx * angle.cos(), FAR * of.dx * angle.sin());
            let near = (case.component)(&of, x * (1.0 - 1e-14), y * (1.0 - 1e-14));
            let far = (case.component)(&of, x * (1.0 + 1e-14), y * (1.0 + 1e-14));
            assert!((near / far - 1.0).abs() < 3e-12, "{}: {near} {far}", case.name);
        }
    }
}

/// Tolerance: the next term, of the order of the element's size over the distance squared.
#[test]
fn far_elements_act_like_point_loads() {
    let of = influence();
    let area = of.dx * of.dy;
    for case in cases() {
        for distance in [1e2, 1e3, 1e4] {
            let (x, y) = (0.6 * distance * of.dx, -0.8 * distance * of.dx);
            let expected = area * case.kernel(&of.elasticity, x, y);
            let error = (case.component)(&of, x, y) / expected - 1.0;
            assert!(error.abs() < distance.powi(-2), "{}: {error}", case.name);
        }
    }
}

#[test]
fn mirror_images_are_equal_bit_for_bit() {
    let of = influence();
    for case in cases() {
        for (i, j) in [(0.0, 0.0), (1.0, 0.0), (0.0, 3.0), (2.5, 1.0), (40.0, 17.0)] {
            let at = |sx: f64, sy: f64| (case.component)(&of, sx * i * of.dx, sy * j * of.dy);
            assert_eq!(at(-1.0, 1.0), case.signs.0 * at(1.0, 1.0), "{}", case.name);
            assert_eq!(at(1.0, -1.0), case.signs.1 * at(1.0, 1.0), "{}", case.name);
        }
    }
}

/// Square of side c: u_z at the centre is E* c (4/π) ln(1 + √2) (Johnson, eq. 3.27), and by
/// symmetry xx is the mean of the directions. Tolerance: rounding.
#[test]
fn self_terms() {
    let elasticity = Elasticity::of_pair(&STEEL, &STEEL);
    let of = Influence { dx: 1e-3, dy: 1e-3, elasticity, plane_strain: false };
    let form = 4.0 / PI * (1.0 + 2.0_f64.sqrt()).ln() * 1e-3;
    let tangential = elasticity.shear_compliance - 0.5 * elasticity.poisson_compliance;
    assert!((of.zz(0, 0) / (form * 2.0 * STEEL.compliance()) - 1.0).abs() < 1e-14);
    assert!((of.xx(0, 0) / (form * tangential) - 1.0).abs() < 1e-14);
    assert_eq!(of.xx(0, 0), of.yy(0, 0));
    assert_eq!([of.xy(0, 0), of.xz(0, 0), of.yz(3, 1)], [0.0; 3]);
}

/// A slender element follows the logarithm of its slenderness: ∫∫ 1/R → 2 dx (ln(2 dy/dx) + 1).
/// Tolerance: the next term, (dx/dy)².
#[test]
fn slender_elements() {
    let elasticity = Elasticity { shear_compliance: PI, ..Default::default() };
    for slenderness in [1e2, 1e4, 1e6_f64] {
        let of = Influence { dx: 1.0, dy: slenderness, elasticity, plane_strain: false };
        let expected = 2.0 * ((2.0 * slenderness).ln() + 1.0);
        assert!((of.zz(0, 0) / expected - 1.0).abs() < slenderness.powi(-2) + 1e-14);
    }
}

/// The halves of an element add up to the whole. Tolerance: rounding.
#[test]
fn additive_in_the_element() {
    let of = influence();
    let half = Influence { dx: 0.5 * of.dx, ..of };
    for case in cases() {
        for (x, y) in [(0.1, 0.2), (1.3, -0.4), (4.0, 0.7)].map(|(i, j)| (i * of.dx, j * of.dy)) {
            let quarter = 0.25 * of.dx;
            let sum =
                (case.component)(&half, x - quarter, y) + (case.component)(&half, x + quarter, y);
            let whole = (case.component)(&of, x, y);
            let scale = case.scale(&of.elasticity, of.dx * of.dy, x.hypot(y));
            assert!(
                (sum - whole).abs() < 1e-13 * scale,
                "{}: {}",
                case.name,
                (sum - whole) / scale
            );
        }
    }
}

#[test]
fn constants_of_a_pair() {
    let pair = Elasticity::of_pair(&POLYMER, &STEEL);
    let swapped = Elasticity::of_pair(&STEEL, &POLYMER);
    assert!(
        (pair.contact_compliance() / (POLYMER.compliance() + STEEL.compliance()) - 1.0).abs()
            < 1e-14
    );
    assert_eq!(pair.coupling_compliance, -swapped.coupling_compliance);
    assert!(pair.coupling_compliance > 0.0 && pair.is_coupled());
    assert!(!Elasticity::of_pair(&STEEL, &STEEL).is_coupled());
}

/// Signs: a soft body 1 under pressure draws its surface towards the load, so the difference u_x
/// points to the source. A traction along +x raises the difference ahead of it.
#[test]
fn signs_of_the_coupling() {
    let of = influence();
    assert!(of.xz(2, 0) < 0.0 && of.yz(0, 2) < 0.0);
    assert!(of.zx(2, 0) > 0.0 && of.zy(0, 2) > 0.0);
    assert!(of.xy(2, 2) > 0.0 && of.zz(2, 2) > 0.0 && of.xx(2, 0) > of.yy(2, 0));
}
