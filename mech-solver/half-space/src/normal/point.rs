//! State of the interior-point method ([`super::interior_point`]).

use numerics::gmres::Gmres;

/// Working memory of the method; the solver owns the fields of convolutions.
#[derive(Debug)]
pub(super) struct InteriorPoint {
    pub(super) gmres: Gmres,
    /// Influence number K₀ of an element on itself [m/Pa].
    pub(super) own: f64,
    /// e [m].
    pub(super) gap: Vec<f64>,
    /// e/p [m/Pa].
    pub(super) stiffness: Vec<f64>,
    /// Weighted right side, then de [m].
    pub(super) right: Vec<f64>,
    /// Response of the preconditioner to a unit of approach [Pa/m].
    pub(super) punch: Vec<f64>,
    /// dp [Pa], and dδ [m] under a given load.
    pub(super) step: Vec<f64>,
}

impl InteriorPoint {
    /// Memory for a grid of `len` elements with the own influence number K₀ = `own`.
    pub(super) fn new(own: f64, len: usize) -> Self {
        let zeros = vec![0.0; len];
        let [gap, stiffness, right, punch] = [zeros.clone(), zeros.clone(), zeros.clone(), zeros];
        Self { gmres: Gmres::default(), own, gap, stiffness, right, punch, step: Vec::new() }
    }
}
