//! Options of the engine.

use clap::{Args, ValueEnum};

/// Engine that runs the points.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(in super::super) enum Name {
    /// This machine.
    Local,
    /// Slurm job array, submitted with `sbatch`.
    Slurm,
    /// HyperQueue task array, submitted with `hq`.
    Hyperqueue,
    /// Print the commands, one part per line, for any other tool.
    List,
}

/// Options of the engine.
#[derive(Debug, Args)]
pub(in super::super) struct EngineArguments {
    /// Engine that runs the points: this machine, a scheduler, or any tool that takes a list of
    /// commands.
    #[arg(long, value_name = "ENGINE", value_enum, default_value = "local")]
    #[arg(conflicts_with = "part")]
    pub engine: Name,
    /// Number of parts, one task each [default: tasks of about a minute, at most 1000].
    #[arg(long, value_name = "COUNT", value_parser = clap::value_parser!(u32).range(1..))]
    pub parts: Option<u32>,
    /// Options for sbatch or hq submit, as one string.
    #[arg(long, value_name = "OPTIONS", allow_hyphen_values = true)]
    pub engine_options: Option<String>,
    /// Number of times to resubmit parts that return incomplete.
    #[arg(long, value_name = "TIMES", default_value_t = 1)]
    pub retries: u32,
    /// Give up after this many hours, including time in the queue.
    #[arg(long, value_name = "HOURS", default_value_t = 168.0)]
    pub deadline: f64,
}
