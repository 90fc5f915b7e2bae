//! `coordinator report`: writes the page of the run or the study in a folder.

use clap::Args;
use console::command::{Command, Context, Group};
use run::error::RunError;
use run::signals;
use std::path::PathBuf;

/// Options of `coordinator report`.
#[derive(Debug, Args)]
pub(crate) struct ReportCommand {
    /// The result directory.
    #[arg(value_name = "DIR")]
    folder: PathBuf,
}

impl Command for ReportCommand {
    const NAME: &'static str = "report";
    const GROUP: Group = Group::Look;
    const ABOUT: &'static str = "Write one page with plots of a run or a study";
    const EXAMPLES: &'static [&'static str] = &["coordinator report results/latest"];

    fn run(&self, context: &Context<'_>) -> Result<(), RunError> {
        let _reading = signals::end_at_once();
        let folder = &self.folder;
        let study = studies::KINDS.iter().find(|study| folder.join(study.file).is_file());
        let page = match study {
            Some(study) => (study.page)(folder)?,
            None => pages::of_run(folder)?,
        };
        let path = pages::write(&page, folder)?;
        context.print(&format!("{}\n", path.display()))
    }
}
