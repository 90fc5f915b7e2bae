//! Mapping by a chosen radial basis function.
//!
//! Up to [`GLOBAL`] points and [`WEIGHTS`] weights one interpolant has all points of the source:
//! each target then has a weight for every point. Larger sources have overlapping interpolants, see
//! `partition`.

use super::error::MapError;
use super::interpolant::Source;
use super::nodes::{Nodes, Target};
use super::operator::SparseOperator;
use super::partition::Partition;
use super::patch::Vector;
use crate::settings::Kernel;

/// Largest number of points of one interpolant for the whole source.
const GLOBAL: usize = 2000;

/// Largest number of weights of one interpolant for all targets.
const WEIGHTS: usize = 20_000_000;

/// Number of targets solved at a time for one interpolant of the whole source.
const BATCH: usize = 512;

/// Builds the matrix of a source grid of this name for all targets.
pub(super) fn operator(
    nodes: &dyn Nodes,
    targets: &[Target],
    kernel: Kernel,
    grid: &str,
) -> Result<SparseOperator, MapError> {
    let source = Source::new(nodes, kernel, grid)?;
    source.check_radius(targets)?;
    let points = source.places.len();
    let mut operator = SparseOperator::with_rows(targets.len());
    if points <= GLOBAL && points * targets.len() <= WEIGHTS {
        let whole = source.interpolant((0..points as u32).collect())?;
        for batch in targets.chunks(BATCH) {
            let free: Vec<&Target> = batch.iter().filter(|target| !target.at_node).collect();
            let feet: Vec<Vector> = free.iter().map(|target| target.foot.point).collect();
            let mut rows = whole.rows(&feet).ok_or_else(|| source.singular())?;
            for target in batch {
                let mut row = if target.at_node { None } else { rows.next() }.unwrap_or_default();
                operator.push_or_copy(&mut row, target);
            }
        }
    } else {
        Partition::new(&source).push_rows(targets, &mut operator)?;
    }
    Ok(operator)
}
