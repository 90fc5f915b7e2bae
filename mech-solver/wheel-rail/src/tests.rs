//! Tests of a wheel on a rail against closed forms and invariances.

mod approximate;
mod curved;
mod energy;
mod hertz;
mod invariance;
mod patches;
mod theories;
mod varying;

use super::contact::WheelOnRail;
use super::interface::Constant;
use super::outline::Outline;
use super::patch::Solved;
use super::rail::{Deviation, Placing, Side, Track};
use super::settings::{Settings, Vertical};
use super::standard::{rail_60e1, wheel_s1002};
use super::wheelset::{Motion, Wheelset};
use elastic::Elasticity;
use elastic::Material;

const STEEL: Material = Material { youngs_modulus: 210e9, poisson_ratio: 0.28 };

/// Steel on steel.
fn steel() -> Elasticity {
    Elasticity::of_pair(&STEEL, &STEEL)
}

/// A wheel above a rail, both with their profile's origin at the origin of the track.
fn single([wheel, rail]: [&Outline; 2], radius: f64, settings: Settings) -> WheelOnRail {
    let track = Track { placing: Placing::Origin { y: 0.0, z: 0.0 }, cant: 0.0, curvature: 0.0 };
    let wheelset =
        Wheelset { flange_back_distance: 0.0, flange_back_position: 0.0, nominal_radius: radius };
    WheelOnRail::new([wheel, rail], Side::Left, &track, &wheelset, settings).unwrap()
}

/// Settings with square elements of this side [m] on steel.
fn elements(side: f64) -> Settings {
    Settings::new([side, side], [STEEL; 2])
}

/// S1002 on 60E1 at 1:40.
fn standard(side: Side, settings: Settings) -> WheelOnRail {
    let gauge = Placing::Gauge { width: 1.435, height: 14e-3 };
    let track = Track { placing: gauge, cant: 0.025, curvature: 0.0 };
    let wheelset =
        Wheelset { flange_back_distance: 1.36, flange_back_position: -0.07, nominal_radius: 0.46 };
    let (wheel, rail) = (wheel_s1002().unwrap(), rail_60e1().unwrap());
    WheelOnRail::new([&wheel, &rail], side, &track, &wheelset, settings).unwrap()
}

/// Rolling forward at 2 m/s.
fn rolling(y: f64, roll: f64, yaw: f64) -> Motion {
    let velocity = [2.0, 0.0, 0.0];
    Motion { y, roll, yaw, velocity, angular_velocity: 2.0 / 0.46, ..Motion::default() }
}

fn solve(pair: &mut WheelOnRail, motion: &Motion, vertical: Vertical) -> Solved {
    pair.solve(motion, &Deviation::default(), vertical, &Constant(0.3)).unwrap()
}

/// Arc with its top at (y, 0), turning by ±angle.
fn arc(y: f64, radius: f64, angle: f64, count: i32) -> Vec<[f64; 2]> {
    let at = |k: i32| angle * f64::from(k) / f64::from(count);
    (-count..=count).map(at).map(|a| [y + radius * a.sin(), radius * (a.cos() - 1.0)]).collect()
}

/// Straight line from −width to width.
fn line(width: f64) -> Outline {
    let points: Vec<[f64; 2]> = (-20..=20).map(|k| [width * f64::from(k) / 20.0, 0.0]).collect();
    Outline::new(&points, 0.0).unwrap().starting_at(width)
}
