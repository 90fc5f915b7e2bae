//! Hexahedron: the trilinear map of a cube to eight corners.
//!
//! The corners are in VTK's order: 0 to 3 round one face, 4 to 7 opposite them. Seen from corner 0
//! of a right-handed hexahedron, corners 1, 3 and 4 lie along x, y and z, and the volume is
//! positive.
//!
//! The volume is exact for every position of the corners: J. Grandy, *Efficient computation of
//! volume of hexahedral cells*, LLNL report UCRL-ID-128886 (1997).

use super::vector::{cross, difference};

/// Signed volume \[m³\] of the hexahedron with these corners \[m\].
pub(super) fn volume(corners: &[[f64; 3]; 8]) -> f64 {
    let [p0, p1, p2, p3, p4, p5, p6, p7] = *corners;
    let sum = |a: [f64; 3], b: [f64; 3]| -> [f64; 3] { std::array::from_fn(|k| a[k] + b[k]) };
    let triple = |a: [f64; 3], b, c| -> f64 {
        let normal = cross(b, c);
        a[0] * normal[0] + a[1] * normal[1] + a[2] * normal[2]
    };
    let [from_1, from_3, from_4] = [p1, p3, p4].map(|p| difference(p6, p));
    let [to_2, to_5, to_7] = [p2, p5, p7].map(|p| difference(p, p0));
    let twelve = triple(sum(from_1, to_7), from_3, to_2)
        + triple(to_7, sum(from_3, to_5), from_4)
        + triple(from_1, to_5, sum(from_4, to_2));
    twelve / 12.0
}

#[cfg(test)]
mod tests {
    use super::*;

    const CUBE: [[f64; 3]; 8] = [
        [0.0, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        [1.0, 1.0, 0.0],
        [0.0, 1.0, 0.0],
        [0.0, 0.0, 1.0],
        [1.0, 0.0, 1.0],
        [1.0, 1.0, 1.0],
        [0.0, 1.0, 1.0],
    ];

    #[test]
    fn a_right_handed_cube_is_positive_and_its_mirror_is_not() {
        assert_eq!(volume(&CUBE), 1.0);
        assert_eq!(volume(&CUBE.map(|[x, y, z]| [x, y, -z])), -1.0);
        assert_eq!(volume(&CUBE.map(|[x, y, z]| [2.0 * x + 5.0, y, 3.0 * z - 1.0])), 6.0);
        assert_eq!(volume(&CUBE.map(|[x, y, _]| [x, y, 0.0])), 0.0);
    }

    /// With the height 1 + xy over the unit square: ∫ (1 + xy) dx dy = 5/4.
    #[test]
    fn a_face_that_is_not_plane_is_exact() {
        let warped = CUBE.map(|[x, y, z]| [x, y, z * (1.0 + x * y)]);
        assert!((volume(&warped) - 1.25).abs() < 1e-15, "rounding: {}", volume(&warped));
    }
}
