//! Configurations, from text to case.

mod importing;
mod mutations;
mod reading;
mod texts;
