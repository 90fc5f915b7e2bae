//! Runs a sweep on other machines. The points are divided into parts, submitted to an existing
//! scheduler as one array of tasks, and collected from the files of the parts.
//!
//! Every task runs `tasks.sh PART` in the folder of the sweep. The script is an ordinary
//! `coordinator sweep … --part` with the same working directory and options, which writes to
//! `parts/PART`. Schedulers differ only in the commands that submit, query and cancel an array
//! ([`scheduler::Scheduler`]). A part that returns incomplete is submitted again and resumes with
//! its missing points. `array.json` names the current array. If the coordinator is interrupted, the
//! resumed sweep waits for that array and submits nothing twice.

mod ask;
mod hyperqueue;
mod options;
mod perform;
mod scheduler;
mod slurm;
mod tasks;

pub(super) use options::{EngineArguments, Name};
pub(super) use perform::{clear, fill, list, parts, parts_under_way, refuse_other};
pub(super) use tasks::Tasks;
