//! Tests of the crate from outside, as one program.

mod carried;
mod common;
mod creeping;
mod description;
mod expanding;
mod fast_models;
mod fastsim;
mod half_space;
mod half_space_model;
mod hertz_carter;
mod hot;
mod in_time;
mod lines;
mod periodic;
mod plastic_layer;
mod profiles;
mod rod;
mod rows;
mod sequences;
mod slip_friction;
mod stress_at_points;
mod varying_bodies;
mod viscoelastic;
mod wearing;
mod wheel_on_track;
mod wheelset;
