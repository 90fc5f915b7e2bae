//! Kalker's linear theory of rolling contact over an ellipse.
//!
//! At small creepages the whole contact sticks, and the forces on the wheel are
//!
//! - F_x = −G a b C11 ξ,
//! - F_y = −G a b (C22 η + √(ab) C23 φ),
//! - M_z = −G a b (−√(ab) C23 η + a b C33 φ),
//!
//! with the semi-axes a (rolling) and b [m], the creepages ξ, η [-] and φ [rad/m] of the wheel
//! relative to the rail, and G, ν of both bodies together, 1/G = ½(1/G₁ + 1/G₂), ν/G = ½(ν₁/G₁ +
//! ν₂/G₂). A driving wheel has ξ < 0 and F_x > 0. The coefficients depend on a/b and ν; they are
//! tabulated for a/b from 0.1 to 10 and ν = 0, ¼, ½.
//!
//! Between the ratios ln C is a cubic Hermite polynomial of ln(a/b). Its slopes are those of the
//! parabolas through three neighbours, so that value and slope are continuous. Between the values
//! of ν, (1 − ν) C is the parabola through all three: for a/b → 0 it is exactly linear in ν.
//!
//! Beyond the table Kalker's asymptotes hold, with g the smaller of a/b and b/a, Λ = ln(16/g²):
//!
//! | | a/b → 0 | a/b → ∞ |
//! |---|---|---|
//! | C11 | π²/(4(1 − ν)) | 2π/(g(Λ − 2ν)) · (1 + (3 − ln 4)/(Λ − 2ν)) |
//! | C22 | π²/4 | 2π/(gD) · (1 + (1 − ν)(3 − ln 4)/D), D = (1 − ν)Λ + 2ν |
//! | C23 | π√g/(3(1 − ν)) · (1 + ν(½Λ + ln 4 − 5)) | 2π/(3g^{3/2}) / ((1 − ν)Λ − 2 + 4ν) |
//! | C33 | π²/(16(1 − ν)g) | π/4 · (1 − ν(Λ − 2)/((1 − ν)Λ − 2 + 4ν)) |
//!
//! Source: J. J. Kalker, Three-Dimensional Elastic Bodies in Rolling Contact (1990), table E.3;
//! also in his On the rolling contact of two elastic bodies in the presence of dry friction (Delft
//! 1967). Deviations: the asymptotes miss the table's end rows by up to 7 %. They are multiplied by
//! 1 + (q − 1)·10g, with q the table's end over the asymptote there, which closes the gap at
//! g = 0.1 and vanishes as g → 0. For bodies of different materials the linear theory couples the
//! normal and the tangential problem; this coupling is neglected.

use std::f64::consts::{LN_2, PI};

/// Creep coefficients [-].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CreepCoefficients {
    /// C11: longitudinal force by longitudinal creepage [-].
    pub c11: f64,
    /// C22: lateral force by lateral creepage [-].
    pub c22: f64,
    /// C23: lateral force by spin, and moment by lateral creepage [-].
    pub c23: f64,
    /// C33: moment by spin [-].
    pub c33: f64,
}

/// Forces and moment on the wheel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinearForces {
    /// Longitudinal force F_x [N].
    pub force_x: f64,
    /// Lateral force F_y [N].
    pub force_y: f64,
    /// Spin moment M_z [N m].
    pub spin_moment: f64,
}

/// Coefficients by ratio a/b and Poisson's ratio.
type Table = [[f64; 3]; 19];

/// Ratios a/b of the table's rows.
const RATIOS: [f64; 19] = [
    0.1,
    0.2,
    0.3,
    0.4,
    0.5,
    0.6,
    0.7,
    0.8,
    0.9,
    1.0,
    1.0 / 0.9,
    1.0 / 0.8,
    1.0 / 0.7,
    1.0 / 0.6,
    1.0 / 0.5,
    1.0 / 0.4,
    1.0 / 0.3,
    1.0 / 0.2,
    1.0 / 0.1,
];

/// Coefficient C11 (longitudinal), one row per ratio a/b, for ν = 0, ¼, ½.
#[rustfmt::skip]
const C11: Table = [
    [2.51, 3.31, 4.85], [2.59, 3.37, 4.81], [2.68, 3.44, 4.80],
    [2.78, 3.53, 4.82], [2.88, 3.62, 4.83], [2.98, 3.72, 4.91],
    [3.09, 3.81, 4.97], [3.19, 3.91, 5.05], [3.29, 4.01, 5.12],
    [3.40, 4.12, 5.20], [3.51, 4.22, 5.30], [3.65, 4.36, 5.42],
    [3.82, 4.54, 5.58], [4.06, 4.78, 5.80], [4.37, 5.10, 6.11],
    [4.84, 5.57, 6.57], [5.57, 6.34, 7.34], [6.96, 7.78, 8.82],
    [10.7, 11.7, 12.9],
];

/// Coefficient C22 (lateral), one row per ratio a/b, for ν = 0, ¼, ½.
#[rustfmt::skip]
#[expect(clippy::approx_constant, reason = "an entry happens to be close to π")]
const C22: Table = [
    [2.51, 2.52, 2.53], [2.59, 2.63, 2.66], [2.68, 2.75, 2.81],
    [2.78, 2.88, 2.98], [2.88, 3.01, 3.14], [2.98, 3.14, 3.31],
    [3.09, 3.28, 3.48], [3.19, 3.41, 3.65], [3.29, 3.54, 3.82],
    [3.40, 3.67, 3.98], [3.51, 3.81, 4.16], [3.65, 3.99, 4.39],
    [3.82, 4.21, 4.67], [4.06, 4.50, 5.04], [4.37, 4.90, 5.56],
    [4.84, 5.48, 6.31], [5.57, 6.40, 7.51], [6.96, 8.14, 9.79],
    [10.7, 12.8, 16.0],
];

/// Coefficient C23 (lateral force by spin), one row per ratio a/b, for ν = 0, ¼, ½.
#[rustfmt::skip]
const C23: Table = [
    [0.334, 0.473, 0.731], [0.483, 0.603, 0.809], [0.607, 0.715, 0.889],
    [0.720, 0.823, 0.977], [0.827, 0.929, 1.07], [0.930, 1.03, 1.18],
    [1.03, 1.14, 1.29], [1.13, 1.25, 1.40], [1.23, 1.36, 1.51],
    [1.33, 1.47, 1.63], [1.44, 1.59, 1.77], [1.58, 1.75, 1.94],
    [1.76, 1.95, 2.18], [2.01, 2.23, 2.50], [2.35, 2.62, 2.96],
    [2.88, 3.24, 3.70], [3.79, 4.32, 5.01], [5.72, 6.63, 7.89],
    [12.2, 14.6, 18.0],
];

/// Coefficient C33 (moment by spin), one row per ratio a/b, for ν = 0, ¼, ½.
#[rustfmt::skip]
const C33: Table = [
    [6.42, 8.28, 11.7], [3.46, 4.27, 5.66], [2.49, 2.96, 3.72],
    [2.02, 2.32, 2.77], [1.74, 1.93, 2.22], [1.56, 1.68, 1.86],
    [1.43, 1.50, 1.60], [1.34, 1.37, 1.42], [1.27, 1.27, 1.27],
    [1.21, 1.19, 1.16], [1.16, 1.11, 1.06], [1.10, 1.04, 0.954],
    [1.05, 0.965, 0.852], [1.01, 0.892, 0.751], [0.958, 0.819, 0.650],
    [0.912, 0.747, 0.549], [0.868, 0.674, 0.446], [0.828, 0.601, 0.341],
    [0.795, 0.526, 0.228],
];

const TABLES: [&Table; 4] = [&C11, &C22, &C23, &C33];

/// Coefficients for an ellipse of any ratio a/b > 0 and a Poisson's ratio ν in [0, ½].
#[must_use]
pub fn creep_coefficients(aspect: f64, poisson_ratio: f64) -> CreepCoefficients {
    let (first, last) = (0, RATIOS.len() - 1);
    let [c11, c22, c23, c33] = if aspect < RATIOS[first] {
        beyond(aspect, first, poisson_ratio, asymptote_short)
    } else if aspect > RATIOS[last] {
        beyond(aspect.recip(), last, poisson_ratio, asymptote_long)
    } else {
        TABLES.map(|table| interpolated(table, aspect, poisson_ratio))
    };
    CreepCoefficients { c11, c22, c23, c33 }
}

impl CreepCoefficients {
    /// Forces of the linear theory for semi-axes [m], a shear modulus [Pa] and the creepages ξ, η
    /// [-] and φ [rad/m].
    #[must_use]
    pub fn forces(
        &self,
        semi_axes: [f64; 2],
        shear_modulus: f64,
        [xi, eta, phi]: [f64; 3],
    ) -> LinearForces {
        let area = semi_axes[0] * semi_axes[1];
        let (length, scale) = (area.sqrt(), shear_modulus * area);
        LinearForces {
            force_x: -scale * self.c11 * xi,
            force_y: -scale * (self.c22 * eta + length * self.c23 * phi),
            spin_moment: -scale * (area * self.c33 * phi - length * self.c23 * eta),
        }
    }
}

/// Asymptote at g < 0.1, scaled to join the table's row at g = 0.1.
fn beyond(g: f64, row: usize, nu: f64, asymptote: fn(f64, f64) -> [f64; 4]) -> [f64; 4] {
    const END: f64 = RATIOS[0];
    let (here, there) = (asymptote(g, nu), asymptote(END, nu));
    std::array::from_fn(|i| {
        let gap = by_poisson_ratio(TABLES[i][row], nu) / there[i] - 1.0;
        here[i] * (1.0 + gap * g / END)
    })
}

/// Asymptotes for a/b = g → 0.
fn asymptote_short(g: f64, nu: f64) -> [f64; 4] {
    let half_logarithm = 0.5 * (16.0 / (g * g)).ln();
    let c22 = PI * PI / 4.0;
    let spin = 1.0 + nu * (half_logarithm + 2.0 * LN_2 - 5.0);
    let c23 = PI * g.sqrt() / (3.0 * (1.0 - nu)) * spin;
    [c22 / (1.0 - nu), c22, c23, c22 / (4.0 * (1.0 - nu) * g)]
}

/// Asymptotes for b/a = g → 0.
fn asymptote_long(g: f64, nu: f64) -> [f64; 4] {
    let logarithm = (16.0 / (g * g)).ln();
    let (next, rest) = (3.0 - 2.0 * LN_2, 1.0 - nu);
    let longitudinal = logarithm - 2.0 * nu;
    let lateral = rest * logarithm + 2.0 * nu;
    let spin = rest * logarithm - 2.0 + 4.0 * nu;
    [
        2.0 * PI / (g * longitudinal) * (1.0 + next / longitudinal),
        2.0 * PI / (g * lateral) * (1.0 + rest * next / lateral),
        2.0 * PI / (3.0 * g.powf(1.5) * spin),
        0.25 * PI * (1.0 - nu * (logarithm - 2.0) / spin),
    ]
}

/// Parabola of (1 − ν) C through ν = 0, ¼, ½.
fn by_poisson_ratio([zero, quarter, half]: [f64; 3], nu: f64) -> f64 {
    let to_zero = (1.0 - 4.0 * nu) * (1.0 - 2.0 * nu);
    let to_quarter = 8.0 * nu * (1.0 - 2.0 * nu);
    let to_half = 2.0 * nu * (4.0 * nu - 1.0);
    (to_zero * zero + 0.75 * to_quarter * quarter + 0.5 * to_half * half) / (1.0 - nu)
}

/// Cubic Hermite interpolation of ln C over ln(a/b).
fn interpolated(table: &Table, aspect: f64, nu: f64) -> f64 {
    let last = RATIOS.len() - 2;
    let row = RATIOS.iter().rposition(|ratio| *ratio <= aspect).unwrap_or(0).min(last);
    let place = |row: usize| RATIOS[row].ln();
    let value = |row: usize| by_poisson_ratio(table[row], nu).ln();
    let (width, rise) = (place(row + 1) - place(row), value(row + 1) - value(row));
    let t = (aspect.ln() - place(row)) / width;
    let [start, end] = [row, row + 1].map(|row| width * slope(row, place, value));
    let bend = t * (1.0 - t) * ((1.0 - t) * (start - rise) - t * (end - rise));
    (value(row) + t * rise + bend).exp()
}

/// Slope at a row of the parabola through the row and its neighbours; at an end, through the first
/// or last three rows.
fn slope(row: usize, place: impl Fn(usize) -> f64, value: impl Fn(usize) -> f64) -> f64 {
    let middle = row.clamp(1, RATIOS.len() - 2);
    let chord = |row: usize| (value(row + 1) - value(row)) / (place(row + 1) - place(row));
    let (before, after) = (chord(middle - 1), chord(middle));
    let bend = (after - before) / (place(middle + 1) - place(middle - 1));
    before + bend * (2.0 * place(row) - place(middle - 1) - place(middle))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Values of the printed table at nodes, without interpolation. Tolerance: rounding.
    #[test]
    fn entries_of_the_table() {
        for (aspect, nu, expected) in [
            (1.0, 0.25, [4.12, 3.67, 1.47, 1.19]),
            (0.1, 0.0, [2.51, 2.51, 0.334, 6.42]),
            (0.6, 0.5, [4.91, 3.31, 1.18, 1.86]),
            (2.0, 0.25, [5.10, 4.90, 2.62, 0.819]),
            (10.0, 0.5, [12.9, 16.0, 18.0, 0.228]),
        ] {
            let c = creep_coefficients(aspect, nu);
            for (value, expected) in [c.c11, c.c22, c.c23, c.c33].into_iter().zip(expected) {
                assert!((value / expected - 1.0).abs() < 1e-13, "{aspect} {nu}: {c:?}");
            }
        }
    }

    /// The linear theory solved on an elastic half-space by collocation (steady rolling, adhesion
    /// everywhere, no traction ahead), extrapolated from 20 and 40 elements across to zero size.
    /// Tolerance: that extrapolation, whose error is smallest for the forces.
    #[test]
    fn entries_against_an_independent_solution() {
        for (aspect, nu, expected) in [
            (1.0, 0.25, [4.140, 3.692, 1.478, 1.206]),
            (0.2, 0.25, [3.397, 2.651, 0.608, 4.361]),
            (5.0, 0.25, [7.852, 8.222, 6.665, 0.619]),
            (1.0, 0.0, [3.417, 3.417, 1.344, 1.230]),
            (1.0, 0.5, [5.240, 4.006, 1.644, 1.180]),
            (0.5, 0.5, [4.903, 3.165, 1.082, 2.269]),
            (2.0, 0.5, [6.142, 5.610, 2.987, 0.665]),
            (0.1, 0.0, [2.528, 2.528, 0.338, 6.547]),
            (10.0, 0.0, [10.834, 10.834, 12.272, 0.819]),
        ] {
            let c = creep_coefficients(aspect, nu);
            for (value, expected) in [c.c11, c.c22, c.c23, c.c33].into_iter().zip(expected) {
                assert!((value / expected - 1.0).abs() < 0.032, "{aspect} {nu}: {c:?}");
            }
            assert!((c.c11 / expected[0] - 1.0).abs() < 0.017, "{aspect} {nu}: {c:?}");
        }
    }

    /// At ν = 0 both directions are equivalent.
    #[test]
    fn no_direction_is_special_without_lateral_contraction() {
        for aspect in [1e-4, 0.05, 0.1, 0.37, 1.0, 2.9, 10.0, 30.0, 1e4] {
            let c = creep_coefficients(aspect, 0.0);
            assert!((c.c11 / c.c22 - 1.0).abs() < 1e-14, "{aspect}: {c:?}");
        }
    }

    /// The coefficients are continuous at the ends of the table, and close to the bare asymptotes
    /// far beyond. Tolerance: the step, and the remainder at g = 1e-4 of the 7 % gap at g = 0.1.
    #[test]
    fn table_and_asymptotes_join() {
        for nu in [0.0, 0.1, 0.25, 0.3, 0.5] {
            for end in [0.1, 10.0] {
                let near = |factor: f64| {
                    let c = creep_coefficients(end * factor, nu);
                    [c.c11, c.c22, c.c23, c.c33]
                };
                for (below, above) in near(1.0 - 1e-9).into_iter().zip(near(1.0 + 1e-9)) {
                    assert!((below / above - 1.0).abs() < 1e-8, "{nu} {end}");
                }
            }
            for (aspect, bare) in
                [(1e-4, asymptote_short(1e-4, nu)), (1e4, asymptote_long(1e-4, nu))]
            {
                let c = creep_coefficients(aspect, nu);
                for (value, bare) in [c.c11, c.c22, c.c23, c.c33].into_iter().zip(bare) {
                    assert!((value / bare - 1.0).abs() < 1e-4, "{nu} {aspect}: {c:?}");
                }
            }
        }
    }

    /// A misprint would show as a kink: compares every entry with the cubic through its four
    /// neighbours. Tolerance: the table's three digits, and the cubic.
    #[test]
    fn entries_lie_on_a_smooth_curve() {
        let place = |row: usize| RATIOS[row].ln();
        for (name, table) in ["C11", "C22", "C23", "C33"].into_iter().zip(TABLES) {
            for (row, nu) in (2..17).flat_map(|row| (0..3).map(move |nu| (row, nu))) {
                let others = [row - 2, row - 1, row + 1, row + 2];
                let weight = |at: usize| {
                    let factor = |o: &usize| (place(row) - place(*o)) / (place(at) - place(*o));
                    others.iter().filter(|o| **o != at).map(factor).product::<f64>()
                };
                let cubic = others.iter().map(|at| weight(*at) * table[*at][nu].ln()).sum::<f64>();
                let error = (cubic - table[row][nu].ln()).abs();
                assert!(error < 0.012, "{name} row {row} column {nu}: {error}");
            }
        }
    }

    /// Power is always dissipated: C11, C22 and C33 are positive.
    #[test]
    fn signs_of_the_forces() {
        let c = creep_coefficients(1.0, 0.25);
        let forces = c.forces([2e-3, 2e-3], 80e9, [-1e-4, 2e-4, 0.03]);
        let scale = 80e9 * 4e-6;
        assert!((forces.force_x / (scale * 4.12e-4) - 1.0).abs() < 1e-12);
        let lateral = 3.67 * 2e-4 + 2e-3 * 1.47 * 0.03;
        assert!((forces.force_y / (-scale * lateral) - 1.0).abs() < 1e-12);
        let moment = 4e-6 * 1.19 * 0.03 - 2e-3 * 1.47 * 2e-4;
        assert!((forces.spin_moment / (-scale * moment) - 1.0).abs() < 1e-12);
    }

    proptest! {
        /// Values lie between neighbouring entries, up to the overshoot of a curve that turns
        /// there.
        #[test]
        fn between_the_entries(aspect in 0.1..10.0f64, nu in 0.0..0.5f64) {
            let row = RATIOS.iter().rposition(|r| *r <= aspect).unwrap_or(0).min(17);
            let c = creep_coefficients(aspect, nu);
            for (value, table) in [c.c11, c.c22, c.c23, c.c33].into_iter().zip(TABLES) {
                let corners = [row, row + 1].map(|row| table[row]).concat();
                let least = corners.iter().copied().fold(f64::MAX, f64::min);
                let most = corners.iter().copied().fold(0.0, f64::max);
                prop_assert!(value > 0.998 * least && value < 1.002 * most, "{}", value);
            }
        }
    }
}
