//! What two prismatic bodies displace each other under pressure and tractions on a part of the surface between them.
//!
//! The normal contact has the products with A_nn of [`super::numbers`]. Pressure and tractions act on each other:
//! tractions displace the surfaces along the normal by A_nt p_t, pressure along the surface by A_tn p_n; and of
//! A_tt what it differs by from that of half-spaces, whose operator the tangential solver has, is given with the tractions before.
//! Slip of a step Δx is the displacement of an element less that of the one ahead.

use super::numbers::InfluenceNumbers;
use crate::difference::Difference;
use crate::influence::Influence;
use crate::normal::{NormalContact, NormalError, NormalSolver, Prescribed};
use elastic::Elasticity;
use elastic::Material;
use numerics::rows::{Kernel, Rows};
use std::sync::Arc;

/// The bodies on a grid of nx × ny elements.
#[derive(Debug)]
pub struct ElasticPair {
    numbers: Arc<InfluenceNumbers>,
    first: usize,
    influence: Influence,
    rows: Rows,
    normal: NormalSolver,
    by_tractions: Option<ByTractions>,
}

/// Operators of the tractions, made when there are some.
#[derive(Debug)]
struct ByTractions {
    /// A_nx, A_ns.
    distance: [Kernel; 2],
    /// A_xn, A_sn.
    displacement_by_pressure: [Kernel; 2],
    /// A_tt less that of half-spaces: xx, xs, sx, ss.
    change: [[Kernel; 2]; 2],
}

impl ElasticPair {
    /// Body 1 (upper) and body 2, with these numbers on a part of their grid: `counts` elements along x and s, from the row `first` on.
    ///
    /// # Panics
    /// If the numbers are those of a smaller grid.
    #[must_use]
    pub fn new(
        materials: &[Material; 2],
        numbers: Arc<InfluenceNumbers>,
        first: usize,
        [nx, ny]: [usize; 2],
    ) -> Self {
        let patch = numbers.patch();
        let [most, rows] = patch.counts;
        assert!(nx <= most && first + ny <= rows, "numbers of {most} x {rows} elements");
        let mut rows = Rows::new(nx, ny);
        let influence =
            Influence::of_elements(patch.sides, Elasticity::of_pair(&materials[0], &materials[1]));
        let nn = numbers.kernel(&mut rows, first, [2, 2]);
        let normal = NormalSolver::curved(Rows::new(nx, ny), nn, &influence);
        Self { numbers, first, influence, rows, normal, by_tractions: None }
    }

    fn by_tractions(&mut self) -> (&ByTractions, &mut Rows) {
        let Self { numbers, first, influence, rows, by_tractions, .. } = self;
        let by_tractions = by_tractions.get_or_insert_with(|| ByTractions {
            distance: [0, 1].map(|t| numbers.kernel(rows, *first, [2, t])),
            displacement_by_pressure: [0, 1].map(|t| numbers.kernel(rows, *first, [t, 2])),
            change: [0, 1].map(|a| [0, 1].map(|b| numbers.change(rows, *first, influence, [a, b]))),
        });
        (by_tractions, rows)
    }

    /// The tolerance of the pressure.
    #[must_use]
    pub fn with_tolerance(mut self, tolerance: f64) -> Self {
        self.normal.tolerance = tolerance;
        self
    }

    /// The pressure under which the gap closes [Pa], looked for from the one that is there; `distance` is that of the bodies in their places, of which
    /// the negative is penetration [m].
    ///
    /// # Errors
    /// There is none.
    pub fn press(
        &mut self,
        distance: &[f64],
        pressure: &mut [f64],
    ) -> Result<NormalContact, NormalError> {
        self.normal.solve(distance, Prescribed::Approach(0.0), pressure)
    }

    /// The approach under which the pressure has this force as half-spaces of the same numbers in one direction have it [m].
    ///
    /// # Errors
    /// There is none.
    pub fn approach(
        &mut self,
        distance: &[f64],
        force: f64,
        pressure: &mut [f64],
    ) -> Result<f64, NormalError> {
        Ok(self.normal.solve(distance, Prescribed::Load(force), pressure)?.approach)
    }

    /// A_nn p_n of the pressure that was found last [m].
    #[must_use]
    pub fn displacement(&self) -> &[f64] {
        self.normal.displacement()
    }

    /// By how much tractions open the gap [m].
    pub fn opening(&mut self, [x, s]: [&[f64]; 2], opening: &mut [f64]) {
        let (ByTractions { distance: [by_x, by_s], .. }, rows) = self.by_tractions();
        rows.apply(&[(by_x, x), (by_s, s)], opening);
    }

    /// Slip of a step that half-spaces do not have under these tractions and this pressure [m].
    pub fn slip_besides(
        &mut self,
        difference: Difference,
        [x, s]: [&[f64]; 2],
        pressure: &[f64],
        slip: [&mut [f64]; 2],
    ) {
        let (nx, _) = self.normal.shape();
        let mut displacement = vec![0.0; pressure.len()];
        let (ByTractions { displacement_by_pressure, change, .. }, rows) = self.by_tractions();
        let kernels = change.iter().zip(displacement_by_pressure);
        for (([by_x, by_s], by_pressure), slip) in kernels.zip(slip) {
            let terms = [(by_x, x), (by_s, s), (by_pressure, pressure)];
            rows.apply(&terms, &mut displacement);
            for (at, slip) in slip.iter_mut().enumerate() {
                // Elements at the ends of a row are not in contact.
                *slip = difference.along(&displacement, nx, at);
            }
        }
    }
}
