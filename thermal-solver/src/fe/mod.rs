//! Finite elements of both bodies.
pub mod basis;
pub mod block;
pub mod body;
pub mod conductor;
pub mod creep;
pub mod direct;
pub mod law;
pub mod mesh;
pub mod modes;
pub mod scheme;
pub mod steady;
pub mod transient;
pub mod varying;
