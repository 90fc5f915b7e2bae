//! Descriptions of the installed programs.

use contract::description::Description;
use run::error::RunError;
use run::programs;
use run::signals;
use std::time::Duration;

/// Asks the installed programs to describe themselves.
pub(crate) fn installed() -> Result<Vec<Description>, RunError> {
    let _asking = signals::end_at_once();
    programs::wait_for(async {
        let mut described = Vec::new();
        for (role, program) in programs::installed() {
            let description = program.describe(&role, Duration::from_secs(30)).await?;
            description.check().map_err(|fault| program.misled(&role, fault))?;
            described.push(description);
        }
        Ok(described)
    })
}
