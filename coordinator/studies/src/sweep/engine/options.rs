//! The options.

use clap::{Args, ValueEnum};

/// What runs the points.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(in super::super) enum Name {
    /// This machine.
    Local,
    /// An array of jobs of Slurm, by `sbatch`.
    Slurm,
    /// An array of tasks of HyperQueue, by `hq`.
    Hyperqueue,
    /// Nothing: the commands are printed, one part a line, for any other tool.
    List,
}

/// The options.
#[derive(Debug, Args)]
pub(in super::super) struct Asked {
    /// What runs the points: this machine, a scheduler, or whatever takes a list of commands.
    #[arg(long, value_name = "ENGINE", value_enum, default_value = "local")]
    #[arg(conflicts_with = "part")]
    pub engine: Name,
    /// Parts, each a task [default: tasks of a minute, 1000 at most].
    #[arg(long, value_name = "COUNT", value_parser = clap::value_parser!(u32).range(1..))]
    pub parts: Option<u32>,
    /// Options for sbatch or hq submit, in one text.
    #[arg(long, value_name = "OPTIONS", allow_hyphen_values = true)]
    pub engine_options: Option<String>,
    /// How often parts that did not come back are submitted again.
    #[arg(long, value_name = "TIMES", default_value_t = 1)]
    pub retries: u32,
    /// Give up after so many hours, in the queue and running.
    #[arg(long, value_name = "HOURS", default_value_t = 168.0)]
    pub deadline: f64,
}
