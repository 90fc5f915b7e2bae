//! `coordinator ablate`: what each effect changes, and what it costs.
//!
//! A case is run as it is, and once more without each of its effects. The difference in the answer is what
//! the effect is worth in this scene; the difference in time is its price. Effects that need another, or
//! that a model cannot do without, are reported with the reason. Which effects there are is in the
//! plan; nothing here names one.

mod cli;
mod page;
mod perform;
mod runs;
mod study;

pub(crate) use cli::{Arguments, main};
pub(crate) use study::Study;
