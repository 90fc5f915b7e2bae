//! A wheel on the rail of a track.
pub mod outline;
pub mod profile;
pub mod standard;
