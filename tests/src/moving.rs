//! Two participants, one with a moving grid: `mover` sends a heat flux from its `patch`; `plate`,
//! whose grid is fixed, answers with its temperature, which the mover receives on the patch.
//!
//! After m accepted windows the patch has made s = ⌊m/every⌋ steps of one of these motions:
//!
//! | motion | patch after s steps |
//! |---|---|
//! | `none` | 24 × 16 elements of side d = 0.05 m, from x₀ = 0.3 m, y₀ = 0.4 m |
//! | `translate` | moved by 0.03 s along x and 0.01 s along y |
//! | `grow` | s more columns of elements |
//! | `stretch` | vertices at x₀ + (x − x₀)(1 + 0.05 s), y + 0.02 s sin 3x; unstructured |
//!
//! The fields depend on the received power P [kW] and the gain g, 0 by default:
//!
//! q(x, y) = 1000 (1 + x + y/2)(1 − gT) W/m²,   T(x, y) = (2 + sin 1.3x cos 0.9y)(1 + gP) K.
//!
//! If the gain is zero, each participant compares its input with these laws at the elements of the
//! given grid. The summary contains the largest error of an accepted window. The mover requires
//! that its input is on the current patch.

mod participant;

pub use participant::{MOVING_FLUX, Moving};

use proto::grid::{Grid, Quadrilaterals, Structured};

/// Name of the moving grid.
pub const PATCH: &str = "patch";
/// Motions, as values of `mover.motion`.
pub const MOTIONS: &[&str] = &["none", "translate", "grow", "stretch"];

/// Side of an element of the patch at rest \[m\].
const SIDE: f64 = 0.05;
/// Lower corner of the patch at rest \[m\].
const CORNER: [f64; 2] = [0.3, 0.4];
/// Numbers of elements of the patch at rest.
const COUNTS: [usize; 2] = [24, 16];
/// Dimensions of the plate \[m\].
const PLATE: [f64; 2] = [4.0, 2.0];

/// Patch after a number of steps of a motion; its revision is one more than `steps`.
#[must_use]
pub fn patch(motion: &str, steps: u64) -> Grid {
    let s = steps as f64;
    let [x, y] = CORNER.map(|at| at + 0.5 * SIDE);
    let [ni, nj] = COUNTS;
    let rest = Structured::contact_plane(x, y, SIDE, SIDE, ni, nj);
    let grid = match motion {
        "translate" => {
            let [x, y] = [x + 0.03 * s, y + 0.01 * s];
            Grid::structured(PATCH, Structured::contact_plane(x, y, SIDE, SIDE, ni, nj))
        }
        "grow" => Grid::structured(PATCH, Structured { ni: ni + steps as usize, ..rest }),
        "stretch" => {
            let mut shape = Quadrilaterals::from(&rest);
            for [x, y, _] in &mut shape.points {
                (*x, *y) = (
                    CORNER[0] + (*x - CORNER[0]) * (1.0 + 0.05 * s),
                    *y + 0.02 * s * (3.0 * *x).sin(),
                );
            }
            Grid::quadrilaterals(PATCH, shape)
        }
        _ => Grid::structured(PATCH, rest),
    };
    Grid { revision: if motion == "none" { 1 } else { 1 + steps }, ..grid }
}

/// Grid of the plate with `resolution` elements along x; the elements are as square as possible.
#[must_use]
pub fn plate(resolution: usize) -> Grid {
    let h = PLATE[0] / resolution as f64;
    let rows = (PLATE[1] / h).round().max(1.0);
    let dy = PLATE[1] / rows;
    let shape = Structured::contact_plane(0.5 * h, 0.5 * dy, h, dy, resolution, rows as usize);
    Grid::structured("plate", shape)
}

/// Heat flux q without gain \[W/m²\].
#[must_use]
pub fn flux([x, y, _]: [f64; 3]) -> f64 {
    1000.0 * (1.0 + x + 0.5 * y)
}

/// Temperature T without gain \[K\].
#[must_use]
pub fn temperature([x, y, _]: [f64; 3]) -> f64 {
    2.0 + (1.3 * x).sin() * (0.9 * y).cos()
}
