use super::*;
use proptest::prelude::*;

fn diagonal(values: [f64; 3]) -> Stress {
    Stress { xx: values[0], yy: values[1], zz: values[2], ..Stress::default() }
}

/// Tensor with these principal stresses along axes turned by Euler's angles.
fn turned(values: [f64; 3], [a, b, c]: [f64; 3]) -> Stress {
    let (sa, ca, sb, cb, sc, cc) = (a.sin(), a.cos(), b.sin(), b.cos(), c.sin(), c.cos());
    let axes = [
        [ca * cc - sa * cb * sc, sa * cc + ca * cb * sc, sb * sc],
        [-ca * sc - sa * cb * cc, -sa * sc + ca * cb * cc, sb * cc],
        [sa * sb, -ca * sb, cb],
    ];
    let at = |i: usize, j: usize| (0..3).map(|k| values[k] * axes[k][i] * axes[k][j]).sum();
    Stress { xx: at(0, 0), yy: at(1, 1), zz: at(2, 2), yz: at(1, 2), xz: at(0, 2), xy: at(0, 1) }
}

#[test]
fn simple_states() {
    let tension = diagonal([0.0, 3.0, 0.0]);
    assert_eq!((tension.von_mises(), tension.max_shear()), (3.0, 1.5));
    let shear = Stress { yz: -2.0, ..Stress::default() };
    assert_eq!(shear.max_shear(), 2.0);
    assert!((shear.von_mises() - 12.0_f64.sqrt()).abs() < 1e-15);
    let hydrostatic = diagonal([-7.0; 3]);
    assert_eq!((hydrostatic.von_mises(), hydrostatic.max_shear()), (0.0, 0.0));
    assert_eq!(Stress::default().principal(), [0.0; 3]);
}

/// Two equal principal stresses, or three nearly equal ones with a large mean, where a formula by a
/// cosine near 1 would lose half of the digits. Tolerance: rounding of the components of the
/// tensor.
#[test]
fn equal_principal_stresses_keep_their_digits() {
    for angles in [[0.3, 1.1, -0.7], [2.0, 0.2, 0.1], [0.0, 1e-9, 0.0]] {
        for values in [[1.0, 1.0, -2.0], [3.0, -1.0, -1.0], [5.0, 5.0, 5.0]] {
            let principal = turned(values, angles).principal();
            for (value, expected) in principal.iter().zip(values) {
                assert!((value - expected).abs() < 4e-15, "{principal:?} {values:?}");
            }
        }
    }
    let tiny = diagonal([1.0 + 1e-12, 1.0, 1.0]).max_shear();
    assert!((tiny - 0.5e-12).abs() < 2e-16, "{tiny}: rounding of 1 + 1e-12");
}

proptest! {
    /// Tolerance: rounding of the turned tensor.
    #[test]
    fn principal_stresses_of_turned_axes(
        values in [-1.0..1.0f64, -1.0..1.0, -1.0..1.0],
        angles in [-3.0..3.0f64, -3.0..3.0, -3.0..3.0],
    ) {
        let mut sorted = values;
        sorted.sort_by(|one, other| other.total_cmp(one));
        let tensor = turned(values, angles);
        for (value, expected) in tensor.principal().iter().zip(sorted) {
            prop_assert!((value - expected).abs() < 4e-15);
        }
        let straight = diagonal(values);
        prop_assert!((tensor.von_mises() - straight.von_mises()).abs() < 4e-15);
        // Von Mises' stress lies between √3 and 2 times the largest shear stress.
        let ratio = tensor.von_mises() / tensor.max_shear();
        prop_assert!((3.0_f64.sqrt() - 1e-12..=2.0 + 1e-12).contains(&ratio), "{ratio}");
    }
}
