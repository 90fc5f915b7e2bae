//! Beyond this machine: the points go as parts to a scheduler that is there already, as one array of tasks, and
//! come back as the files of their parts.
//!
//! Every task is `tasks.sh PART` in the folder of the sweep: a plain `coordinator sweep … --part`, from the same
//! working directory and with the same options, into `parts/PART`. What scheduler it is makes no difference
//! but in how an array is submitted, looked at and cancelled ([`Scheduler`]). A part that did not come back as a
//! whole is submitted again, and goes on with what it lacks. `array.json` names the array that is under way, so
//! that a sweep whose coordinator was stopped waits for it, and submits nothing twice.

mod ask;
mod hyperqueue;
mod options;
mod perform;
mod scheduler;
mod slurm;
mod tasks;

pub(super) use options::{Asked, Name};
pub(super) use perform::{clear, fill, list, parts, parts_under_way, refuse_other};
pub(super) use tasks::Tasks;
