//! Descriptions of the installed programs.

use contract::description::Description;
use run::error::{RunError, file_failure};
use run::programs;
use run::signals;
use std::time::Duration;

/// Asks the installed programs to describe themselves.
pub(crate) fn installed() -> Result<Vec<Description>, RunError> {
    let _asking = signals::end_at_once();
    let runtime = tokio::runtime::Builder::new_current_thread()
        .enable_all()
        .build()
        .map_err(|error| file_failure(std::path::Path::new("tokio"), &error))?;
    let described = programs::installed().into_iter().map(|(role, program)| {
        let described = runtime.block_on(program.describe(&role, Duration::from_secs(30)))?;
        described.check().map_err(|fault| program.misled(&role, fault))?;
        Ok(described)
    });
    described.collect()
}
