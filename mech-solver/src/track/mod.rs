//! A wheel on the rail of a track: where they touch, how they move there, and the contact of all patches.
pub mod contact;
pub mod creepage;
pub mod error;
pub mod fields;
pub mod local;
pub mod outline;
mod pair;
pub mod patch;
mod pool;
mod pressed;
pub mod profile;
pub mod rail;
pub mod region;
pub mod search;
pub mod settings;
pub mod silhouette;
pub mod standard;
pub mod wheelset;

#[cfg(test)]
mod tests;
