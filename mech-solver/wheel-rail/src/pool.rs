//! Cache of solvers, by the size of their window.
//!
//! A window extends equally to both sides of its origin, so that its operators depend on its size
//! alone and not on its position. Its counts are the largest odd numbers below products of the
//! small primes for which transforms are fast. Contacts of about the same size therefore share
//! solvers.

use super::curved::KnownNumbers;
use super::local::Window;
use super::settings::Settings;
use grids::Structured;
use half_space::grid_continuation::{Contact, Levels, Motion};
use half_space::influence::Influence;
use half_space::normal::NormalSolver;
use numerics::convolution::smooth_size;

/// Most sizes kept, per kind of solver.
const KEPT: usize = 16;

/// Half size of a window of at least this half size, enlarged to fill the next fast transform.
pub(super) fn room(half: usize) -> usize {
    let least = 2 * half.max(3) + 1;
    let size = smooth_size(least);
    if size % 2 == 1 { size / 2 } else { size / 2 - usize::from(size > least) }
}

/// Solvers by window size.
#[derive(Debug)]
pub(super) struct Pool {
    settings: Settings,
    normal: Vec<([usize; 2], NormalSolver)>,
    tangential: Vec<([usize; 2], Levels)>,
    /// Influence numbers of curved surfaces, if patches lie on such surfaces.
    pub(super) curved: Option<KnownNumbers>,
}

impl Pool {
    pub(super) fn new(settings: Settings) -> Self {
        Self { settings, normal: Vec::new(), tangential: Vec::new(), curved: None }
    }

    /// Solver of the normal contact on a window.
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

    /// Solver of steady rolling on a window about as large as its contact. Its result depends on
    /// the window alone, not on the contact for which the solver was created.
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

/// Entry of a size, created if missing. The least recently used entry is evicted.
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
