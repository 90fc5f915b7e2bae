//! `coordinator watch`: a page in the browser about a run, while it runs and afterwards, and about
//! a recording.
//!
//! The program serves the page on this machine ([`server`]), or writes it as one file
//! (`offline.rs`). What is drawn comes from the crate `pages`, as in a report: lines, maps and
//! tables are drawn here, with no more detail than a screen shows, and the script of the page puts
//! them in place. A recording is indexed once (`index.rs`), so that each view takes milliseconds.
//!
//! A run writes more only while somebody looks ([`run::watching`]).

#![forbid(unsafe_code)]

mod index;
mod offline;
mod recording;
mod server;
mod steps;
#[cfg(test)]
mod tests;
mod view;
mod watched;

use clap::Args;
use console::command::{Command, Context, Group};
use run::error::RunError;
use run::signals;
use server::Server;
use std::path::PathBuf;
use watched::Watched;

/// Options of `coordinator watch`.
#[derive(Debug, Args)]
pub struct WatchCommand {
    /// Result directory, or a recording.
    #[arg(value_name = "DIR|RECORDING", default_value = "results/latest")]
    path: PathBuf,
    /// Another recording, or a result directory with one, to compare with.
    #[arg(long, value_name = "RECORDING")]
    against: Option<PathBuf>,
    /// Port to listen on [default: any free one].
    #[arg(long, value_name = "NUMBER", default_value = "0", hide_default_value = true)]
    port: u16,
    /// Write the page as one file, without a server.
    #[arg(long, value_name = "FILE", conflicts_with = "port")]
    page: Option<PathBuf>,
    /// Replace an existing file.
    #[arg(long, requires = "page")]
    replace: bool,
}

impl Command for WatchCommand {
    const NAME: &'static str = "watch";
    const GROUP: Group = Group::Look;
    const ABOUT: &'static str = "Show a run or a recording in the browser, step by step";
    const EXAMPLES: &'static [&'static str] = &[
        "coordinator watch results/latest",
        "coordinator watch new.mcap --against old.mcap",
        "coordinator watch results/latest --page run.html",
    ];

    fn run(&self, context: &Context<'_>) -> Result<(), RunError> {
        let _reading = signals::end_at_once();
        let watched = Watched::open(&self.path, self.against.as_deref())?;
        if let Some(file) = &self.page {
            let written = offline::write(watched, file, self.replace)?;
            return context.print(&format!("{written}\n"));
        }
        let failed = |error: std::io::Error| RunError::Usage(format!("no server: {error}"));
        let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build();
        let runtime = runtime.map_err(failed)?;
        tokio::task::LocalSet::new().block_on(&runtime, async {
            let server = Server::listen(self.port).await?;
            context.print(&format!("{}\n", server.address()))?;
            server.serve(watched).await;
            Ok(())
        })
    }
}
