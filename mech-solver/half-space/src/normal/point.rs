//! What the interior-point method ([`super::interior_point`]) works on from step to step.

use numerics::gmres::Gmres;

/// Memory of the method; the fields of convolutions are the solver's.
#[derive(Debug)]
pub(super) struct InteriorPoint {
    pub(super) gmres: Gmres,
    /// Number of an element on itself K₀ [m/Pa].
    pub(super) own: f64,
    /// e [m].
    pub(super) gap: Vec<f64>,
    /// e/p [m/Pa].
    pub(super) stiffness: Vec<f64>,
    /// The weighted right side, then de [m].
    pub(super) right: Vec<f64>,
    /// Answer of the preconditioner to a unit of approach [Pa/m].
    pub(super) punch: Vec<f64>,
    /// dp [Pa], and dδ [m] under a given load.
    pub(super) step: Vec<f64>,
}

impl InteriorPoint {
    /// For a grid of so many elements, whose number on themselves is this.
    pub(super) fn new(own: f64, len: usize) -> Self {
        let zeros = vec![0.0; len];
        let [gap, stiffness, right, punch] = [zeros.clone(), zeros.clone(), zeros.clone(), zeros];
        Self { gmres: Gmres::default(), own, gap, stiffness, right, punch, step: Vec::new() }
    }
}
