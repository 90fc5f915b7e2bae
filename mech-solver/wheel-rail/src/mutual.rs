//! Mutual influence of patches in different planes: the pressure of one patch displaces the
//! surfaces under the others.
//!
//! At the distance r a load P moves the surfaces of two half-spaces apart by E* P/(π r) along its
//! normal, with the compliance E* = (1 − ν₁²)/E₁ + (1 − ν₂²)/E₂. Along the normal of another patch,
//! whose plane is turned by β, this is multiplied by cos β. The displacements along the surface are
//! the same for bodies of the same material, and open no gap. Distances r are straight.
//!
//! A patch acts as the point loads of blocks of [`BLOCK`] × [`BLOCK`] elements at their centres of
//! load. The error is of the order of the square of a block's size over r.
//!
//! Neglected: the tractions of other patches, which have a part sin β along the normal, and the
//! true shape of wheel and rail, which are no half-space over the distance of patches.

use super::pressed::NormalPatch;
use nalgebra::Vector3;
use std::f64::consts::PI;

/// Elements of a block along each axis.
const BLOCK: usize = 4;

/// Loads of a patch that act on other patches.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct BlockLoads {
    angle: f64,
    /// Positions in track axes [m], and loads [N].
    loads: Vec<(Vector3<f64>, f64)>,
}

impl BlockLoads {
    /// Combines the pressure of a patch to loads of blocks.
    pub(super) fn of(pressed: &NormalPatch) -> Self {
        let [nx, ny] = pressed.window.counts();
        let [dx, dy] = pressed.window.sides;
        let blocks = [nx, ny].map(|count| count.div_ceil(BLOCK));
        let block = |at: usize| {
            let [i, j] = [at % blocks[0] * BLOCK, at / blocks[0] * BLOCK];
            let (mut place, mut load) = ([0.0; 2], 0.0);
            for row in j..(j + BLOCK).min(ny) {
                for column in i..(i + BLOCK).min(nx) {
                    let p = pressed.pressure[row * nx + column];
                    load += p;
                    for (sum, (axis, at)) in place.iter_mut().zip([(0, column), (1, row)]) {
                        *sum += p * pressed.window.along(axis, at);
                    }
                }
            }
            let middle = place.map(|sum| sum / load);
            (load > 0.0).then(|| (in_track(pressed, middle), load * dx * dy))
        };
        let loads = (0..blocks[0] * blocks[1]).filter_map(block).collect();
        Self { angle: pressed.frame.angle, loads }
    }
}

/// Opening of the gap of a patch by other patches, on the elements of its window [m].
pub(super) fn opening<'a>(
    pressed: &NormalPatch,
    others: impl Iterator<Item = &'a BlockLoads> + Clone,
    compliance: f64,
) -> Vec<f64> {
    let window = &pressed.window;
    let [nx, _] = window.counts();
    let at = |index: usize| {
        let here = [window.along(0, index % nx), window.along(1, index / nx)];
        let here = in_track(pressed, here);
        let by = |other: &BlockLoads| {
            let turned = (other.angle - pressed.frame.angle).cos();
            let near = other.loads.iter().map(|(place, load)| load / (here - place).norm());
            turned * near.sum::<f64>()
        };
        compliance / PI * others.clone().map(by).sum::<f64>()
    };
    (0..window.points()).map(at).collect()
}

/// Converts a point in the plane of a patch to track axes [m].
fn in_track(pressed: &NormalPatch, [x, along]: [f64; 2]) -> Vector3<f64> {
    pressed.frame.origin + pressed.frame.track_axes([x, along, 0.0])
}
