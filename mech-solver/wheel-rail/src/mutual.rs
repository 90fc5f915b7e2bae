//! What patches in planes of their own do to each other: the pressure of one displaces the surfaces under the others.
//!
//! At the distance r a load P displaces the surfaces of two half-spaces apart by E* P/(π r) along its normal, with the
//! compliance E* = (1 − ν₁²)/E₁ + (1 − ν₂²)/E₂; along the normal of another patch, whose plane is turned by β, by cos β of that.
//! What bodies of the same material are displaced by along the surface is the same for both, and opens nothing. Distances are straight.
//!
//! A patch acts as the loads of blocks of [`BLOCK`] × [`BLOCK`] elements, in their centres: off by
//! the square of a block over r.
//!
//! Left out: the tractions of other patches, which have a part sin β in the normal, and shapes of wheel and rail that are no half-space
//! over the distance of patches.

use super::pressed::Pressed;
use nalgebra::Vector3;
use std::f64::consts::PI;

/// Elements of a block along either axis.
const BLOCK: usize = 4;

/// A patch, as others feel it.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Acting {
    angle: f64,
    /// Places in track axes [m], and loads [N].
    loads: Vec<(Vector3<f64>, f64)>,
}

impl Acting {
    /// A patch under its pressure.
    pub(super) fn of(pressed: &Pressed) -> Self {
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

/// By how much others open the gap of a patch, on the elements of its window [m].
pub(super) fn opening<'a>(
    pressed: &Pressed,
    others: impl Iterator<Item = &'a Acting> + Clone,
    compliance: f64,
) -> Vec<f64> {
    let window = &pressed.window;
    let [nx, _] = window.counts();
    let at = |index: usize| {
        let here = [window.along(0, index % nx), window.along(1, index / nx)];
        let here = in_track(pressed, here);
        let by = |other: &Acting| {
            let turned = (other.angle - pressed.frame.angle).cos();
            let near = other.loads.iter().map(|(place, load)| load / (here - place).norm());
            turned * near.sum::<f64>()
        };
        compliance / PI * others.clone().map(by).sum::<f64>()
    };
    (0..window.points()).map(at).collect()
}

/// A place of the plane of a patch in track axes [m].
fn in_track(pressed: &Pressed, [x, along]: [f64; 2]) -> Vector3<f64> {
    pressed.frame.origin + pressed.frame.track_axes([x, along, 0.0])
}
