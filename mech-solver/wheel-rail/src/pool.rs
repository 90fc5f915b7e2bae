//! Solvers of the sizes that have been needed.
//!
//! A window reaches as far to one side of its origin as to the other, so that its operators are those of its
//! size alone, wherever it is. Its counts are the largest odd ones below products of the primes that transforms
//! are fast with, so that contacts of about the same size share solvers.

use super::curved::KnownNumbers;
use super::local::Window;
use super::settings::Settings;
use grids::Structured;
use half_space::grid_continuation::{Contact, Levels, Motion};
use half_space::influence::Influence;
use half_space::normal::NormalSolver;
use numerics::convolution::smooth_size;

/// Sizes that are kept, of either kind.
const KEPT: usize = 16;

/// At least this many elements on either side of an origin: as many as a transform of the next size takes.
pub(super) fn room(half: usize) -> usize {
    let least = 2 * half.max(3) + 1;
    let size = smooth_size(least);
    if size % 2 == 1 { size / 2 } else { size / 2 - usize::from(size > least) }
}

/// The solvers.
#[derive(Debug)]
pub(super) struct Pool {
    settings: Settings,
    normal: Vec<([usize; 2], NormalSolver)>,
    tangential: Vec<([usize; 2], Levels)>,
    /// Numbers of curved surfaces, where patches are on them.
    pub(super) curved: Option<KnownNumbers>,
}

impl Pool {
    pub(super) fn new(settings: Settings) -> Self {
        Self { settings, normal: Vec::new(), tangential: Vec::new(), curved: None }
    }

    /// The solver of normal contacts on a window.
    pub(super) fn normal(&mut self, window: &Window) -> &mut NormalSolver {
        let Settings { sides: [dx, dy], bodies, .. } = self.settings;
        let tolerance = self.settings.pressure_tolerance();
        kept(&mut self.normal, window.half, || {
            let [nx, ny] = window.counts();
            let mut solver = NormalSolver::new(
                nx,
                ny,
                &Influence { dx, dy, elasticity: bodies, plane_strain: false },
            );
            solver.tolerance = tolerance;
            solver
        })
    }

    /// The solver of steady rolling on a window, which is about as large as its contact: what it answers depends
    /// on the window alone, and not on the contact that it was made for.
    pub(super) fn tangential(&mut self, window: &Window) -> &mut Levels {
        let Settings { sides: [dx, dy], bodies, layer, difference, tolerance, .. } = self.settings;
        kept(&mut self.tangential, window.half, || {
            let [nx, ny] = window.counts();
            let [x0, y0] = [window.along(0, 0), window.along(1, 0)];
            let grid = Structured::contact_plane(x0, y0, dx, dy, nx, ny);
            let semi_axes = [0, 1].map(|k| window.half[k] as f64 * window.sides[k]);
            let motion = Motion::SteadyRolling;
            Levels::new(
                &grid,
                &Contact {
                    bodies: bodies.into(),
                    layer,
                    yields: None,
                    semi_axes,
                    motion,
                    difference,
                    tolerance,
                },
            )
        })
    }
}

/// The entry of a size, made if there is none; the one that was not used for longest makes room.
fn kept<T>(
    entries: &mut Vec<([usize; 2], T)>,
    size: [usize; 2],
    make: impl FnOnce() -> T,
) -> &mut T {
    match entries.iter().position(|(known, _)| *known == size) {
        Some(at) => entries[..=at].rotate_right(1),
        None => {
            entries.truncate(KEPT - 1);
            entries.insert(0, (size, make()));
        }
    }
    &mut entries[0].1
}
