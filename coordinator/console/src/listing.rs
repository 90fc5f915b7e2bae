//! How a list of what there is is asked for: all of it or what is like a pattern, for people, as JSON or as a page.

use clap::Args;
use run::error::RunError;

/// What of a list is asked for.
#[derive(Debug, Args)]
pub struct Listing {
    /// Show those alone whose name or meaning holds this.
    pattern: Option<String>,
    /// Print JSON.
    #[arg(long, conflicts_with = "markdown")]
    pub json: bool,
    /// Print them as the page in docs has them.
    #[arg(long)]
    pub markdown: bool,
}

impl Listing {
    /// Those one of whose texts holds the pattern, in whatever case.
    ///
    /// # Errors
    /// There are none.
    pub fn pick<T>(
        &self,
        mut all: Vec<T>,
        texts: impl Fn(&T) -> [&String; 2],
    ) -> Result<Vec<T>, RunError> {
        let Some(pattern) = &self.pattern else { return Ok(all) };
        let wanted = pattern.to_lowercase();
        all.retain(|one| texts(one).iter().any(|text| text.to_lowercase().contains(&wanted)));
        if all.is_empty() {
            let fix = "leave the pattern out to see all";
            return Err(RunError::Usage(format!("nothing is like `{pattern}`; {fix}")));
        }
        Ok(all)
    }
}
