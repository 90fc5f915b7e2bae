//! Closed forms: one truth for models, tests, documentation and reports.

pub mod carter;
pub mod cattaneo;
pub mod cut_off;
pub mod different_bodies;
pub mod elliptic_integrals;
pub mod hertz;
pub mod hunter;
pub mod kalker;
pub mod shakedown;
pub mod simplified;
pub mod subsurface;
