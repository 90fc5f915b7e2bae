//! The mapping of one field through time.

use super::{Coverage, GridMapping, MapError, Method};
use contract::field::Mapping;
use contract::grid::Grid;

/// A mapping that follows its grids: rebuilt only when one of them has another revision.
#[derive(Clone, Debug)]
pub struct CurrentMapping {
    method: Method,
    preserves: Mapping,
    /// Revisions of source and target, and the mapping between them.
    made: Option<([u64; 2], GridMapping)>,
    builds: u64,
}

impl CurrentMapping {
    /// Nothing is made before it is asked for.
    #[must_use]
    pub fn new(method: Method, preserves: Mapping) -> Self {
        Self { method, preserves, made: None, builds: 0 }
    }

    /// The mapping between the grids as they are now. Always to be asked with the same two grids;
    /// their revisions alone tell whether they have changed.
    ///
    /// # Errors
    /// As [`GridMapping::between`]; the old mapping is kept, and not returned for the new grids.
    pub fn between(&mut self, source: &Grid, target: &Grid) -> Result<&GridMapping, MapError> {
        let revisions = [source.revision, target.revision];
        if self.made.as_ref().is_none_or(|(made_for, _)| *made_for != revisions) {
            let mapping = GridMapping::between(source, target, self.method, self.preserves)?;
            self.made = Some((revisions, mapping));
            self.builds += 1;
        }
        Ok(&self.made.as_ref().expect("it was there or has just been made").1)
    }

    /// What the mapping at hand covers; `None` before it was made.
    #[must_use]
    pub fn coverage(&self) -> Option<Coverage> {
        self.made.as_ref().map(|(_, mapping)| mapping.coverage())
    }

    /// How many times the mapping was made.
    #[must_use]
    pub fn builds(&self) -> u64 {
        self.builds
    }
}
