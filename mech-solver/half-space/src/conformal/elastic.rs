//! Displacements of two prismatic bodies under pressure and tractions on a part of their common
//! surface.
//!
//! The normal contact uses the products with A_nn of [`super::numbers`]. Pressure and tractions are
//! coupled: tractions displace the surfaces along the normal by A_nt p_t, and pressure displaces
//! them along the surface by A_tn p_n. The tangential solver uses the operator of half-spaces. The
//! difference between A_tt and this operator acts with the tractions of the previous iteration. The
//! slip of a step Δx is the displacement of an element less that of the element ahead.

use super::numbers::InfluenceNumbers;
use crate::difference::Difference;
use crate::influence::Influence;
use crate::normal::{NormalContact, NormalError, NormalSolver, Prescribed};
use elastic::Elasticity;
use elastic::Material;
use numerics::rows::{Kernel, Rows};
use std::sync::Arc;

/// Two elastic bodies on a grid of nx × ny elements.
#[derive(Debug)]
pub struct ElasticPair {
    numbers: Arc<InfluenceNumbers>,
    first: usize,
    influence: Influence,
    rows: Rows,
    normal: NormalSolver,
    by_tractions: Option<ByTractions>,
}

/// Operators of the tractions, created on first use.
#[derive(Debug)]
struct ByTractions {
    /// A_nx, A_ns.
    distance: [Kernel; 2],
    /// A_xn, A_sn.
    displacement_by_pressure: [Kernel; 2],
    /// A_tt less the A_tt of half-spaces: xx, xs, sx, ss.
    change: [[Kernel; 2]; 2],
}

impl ElasticPair {
    /// Creates the operators of body 1 (upper) and body 2 on a part of the grid of `numbers`:
    /// `counts` elements along x and s, starting at the row `first`.
    ///
    /// # Panics
    /// If the grid of the numbers is smaller.
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

    /// Sets the tolerance of the pressure.
    #[must_use]
    pub fn with_tolerance(mut self, tolerance: f64) -> Self {
        self.normal.tolerance = tolerance;
        self
    }

    /// Finds the pressure that closes the gap [Pa], starting from `pressure`. `distance` is the
    /// distance of the undeformed bodies at their approach [m]; negative values are penetration.
    ///
    /// # Errors
    /// The distances are not finite, or the pressure does not converge.
    pub fn press(
        &mut self,
        distance: &[f64],
        pressure: &mut [f64],
    ) -> Result<NormalContact, NormalError> {
        self.normal.solve(distance, Prescribed::Approach(0.0), pressure)
    }

    /// Returns the approach under which the pressure has this force [m], if the approach is uniform
    /// over the surface as for half-spaces.
    ///
    /// # Errors
    /// The force is negative or not finite, or the pressure does not converge.
    pub fn approach(
        &mut self,
        distance: &[f64],
        force: f64,
        pressure: &mut [f64],
    ) -> Result<f64, NormalError> {
        Ok(self.normal.solve(distance, Prescribed::Load(force), pressure)?.approach)
    }

    /// Displacement A_nn p_n of the latest pressure [m].
    #[must_use]
    pub fn displacement(&self) -> &[f64] {
        self.normal.displacement()
    }

    /// Opening of the gap by tractions [m].
    pub fn opening(&mut self, [x, s]: [&[f64]; 2], opening: &mut [f64]) {
        let (ByTractions { distance: [by_x, by_s], .. }, rows) = self.by_tractions();
        rows.apply(&[(by_x, x), (by_s, s)], opening);
    }

    /// Slip of a step by these tractions and this pressure, less the slip of half-spaces [m].
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
