//! Positions of the rails of a track.
//!
//! **Track axes**: x forward along the middle of the track, y to the left, z up. The plane z = 0
//! touches the tops of both rails as designed. Positions are those of an instant, with x = 0 under
//! the middle of the wheelset.
//!
//! A profile is inclined by the rail's cant, positive towards the middle of the track: the left one
//! turns about x by +cant, the right one by −cant. Then it is placed in one of two ways. By gauge,
//! its top is at z = 0, and the innermost point within the gauge's measuring height below the top
//! is at half the gauge. By origin, its origin is at a given point. A deviation, due to an
//! irregularity or an elastic support, turns the rail about its origin and shifts it; the track's
//! axes stay.
//!
//! The right rail is the mirror image of a left one with the same profile, to the last bit.
//!
//! CONTACT has y to the right and z down, which is this system turned by π about x: rolls have the
//! same sign, y, z, yaw and pitch the opposite one. Source for the placement: its user guide, ch. 4
//! (definitions).

use super::outline::Outline;
use super::surface::Surface;
use tables::readable::quantity;

/// Side of the track, seen along x.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// y > 0.
    Left,
    /// y < 0.
    Right,
}

impl Side {
    /// 1 on the left, −1 on the right.
    #[must_use]
    pub fn sign(self) -> f64 {
        match self {
            Self::Left => 1.0,
            Self::Right => -1.0,
        }
    }

    /// Mirrors a surface of the left side if this is the right side.
    #[must_use]
    pub(super) fn of(self, surface: Surface) -> Surface {
        match self {
            Self::Left => surface,
            Self::Right => surface.mirrored(),
        }
    }
}

/// Way of placing a rail.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Placing {
    /// By the gauge.
    Gauge {
        /// Distance of the gauge points of both rails [m].
        width: f64,
        /// Depth below the top of the rail at which the gauge is measured [m].
        height: f64,
    },
    /// By the origin of its profile.
    Origin {
        /// Distance from the middle of the track, to the field side [m].
        y: f64,
        /// Height [m].
        z: f64,
    },
}

/// A track as it is designed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Track {
    /// Placement of the rails.
    pub placing: Placing,
    /// Inclination of the rails towards the middle of the track [rad], 0.05 for 1:20; 0 if the
    /// profile was measured inclined.
    pub cant: f64,
    /// Curvature of the line [1/m], positive in a curve to the left.
    pub curvature: f64,
}

/// Displacement of a rail from its design position, in track axes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Deviation {
    /// Shift to the left [m].
    pub y: f64,
    /// Shift up [m].
    pub z: f64,
    /// Rotation about the origin of the profile, from y to z [rad].
    pub roll: f64,
    /// Rates of the three [m/s, m/s, rad/s].
    pub rates: [f64; 3],
}

/// Error: the profile has no gauge point.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error(
    "the rail's profile ends {reach} below its top on the side of the track's middle, and the gauge is \
     measured {height} below; extend the profile, or give the position of its origin", reach = quantity(*.reach, "m", 5), height = quantity(*.height, "m", 5))]
pub struct NoGauge {
    /// Depth to which the profile reaches [m].
    pub reach: f64,
    /// Measuring height [m].
    pub height: f64,
}

/// A rail at its position.
#[derive(Clone, Debug, PartialEq)]
pub struct Rail {
    /// Profile in track axes, s rising to the left. For a rail that varies, the profile where it is
    /// cut, initially under the middle of the wheelset.
    pub outline: Outline,
    /// Surface in track axes, over the distance along the track.
    pub surface: Surface,
    /// Distance of the middle of the wheelset along the track [m].
    pub way: f64,
    /// Position of the profile's origin, y and z [m].
    pub origin: [f64; 2],
    /// Rotation of the profile's axes, from y to z [rad].
    pub roll: f64,
    /// Rates of shift and turn [m/s, m/s, rad/s].
    pub rates: [f64; 3],
    /// Curvature of the line [1/m].
    pub curvature: f64,
}

impl Rail {
    /// Places a rail with this surface, its profiles in the axes of [`super::profile`], on one side
    /// of a track. The profile at distance 0, without any hollow, determines the placement.
    ///
    /// # Errors
    /// Fails if the profile does not reach down to the height of the gauge.
    pub fn placed(surface: &Surface, side: Side, track: &Track) -> Result<Self, NoGauge> {
        let inclined = surface.smooth_section(0.0).placed(track.cant, [0.0; 2]);
        let [y, z] = match track.placing {
            Placing::Origin { y, z } => [y, z],
            Placing::Gauge { width, height } => {
                let [inner, top] = gauge_point(&inclined, height)?;
                [0.5 * width - inner, -top]
            }
        };
        let sign = side.sign();
        let surface = side.of(surface.placed(track.cant, [y, z]));
        Ok(Self {
            outline: surface.section(0.0),
            surface,
            way: 0.0,
            origin: [sign * y, z],
            roll: sign * track.cant,
            rates: [0.0; 3],
            curvature: track.curvature,
        })
    }

    /// Displaces the rail, with the wheelset at `way` along the track [m].
    #[must_use]
    pub fn deviated(&self, by: &Deviation, way: f64) -> Self {
        let (sin, cos) = by.roll.sin_cos();
        let [y, z] = self.origin;
        let origin = [y + by.y, z + by.z];
        let shift = [origin[0] - (cos * y - sin * z), origin[1] - (sin * y + cos * z)];
        let roll = self.roll + by.roll;
        let surface = self.surface.placed(by.roll, shift);
        let outline = surface.section(way);
        Self { outline, surface, way, origin, roll, rates: by.rates, curvature: self.curvature }
    }

    /// Cuts a rail that varies at x [m].
    pub fn cut_at(&mut self, x: f64) {
        self.outline = self.surface.section(self.way + x);
    }

    /// Converts a point y, z [m] from track axes to the axes of the profile, y to the left.
    #[must_use]
    pub fn profile_axes(&self, [y, z]: [f64; 2]) -> [f64; 2] {
        let (sin, cos) = self.roll.sin_cos();
        let [y, z] = [y - self.origin[0], z - self.origin[1]];
        [cos * y + sin * z, cos * z - sin * y]
    }
}

/// y of the innermost point within `height` below the top, and z of the top [m].
fn gauge_point(rail: &Outline, height: f64) -> Result<[f64; 2], NoGauge> {
    let [first, last] = rail.range();
    let crown = rail.largest([first, last], |place| place.position[1]);
    let top = rail.at(crown).position[1];
    let depth = |s: f64| top - rail.at(s).position[1];
    // From the crown inwards to the first place that is deep enough.
    const PLACES: usize = 2000;
    let place = |k: usize| crown + (first - crown) * k as f64 / PLACES as f64;
    let Some(beyond) = (1..=PLACES).find(|k| depth(place(*k)) >= height) else {
        let reach = depth(first);
        return Err(NoGauge { reach, height });
    };
    let (mut above, mut below) = (place(beyond - 1), place(beyond));
    for _ in 0..60 {
        let middle = 0.5 * (above + below);
        *(if depth(middle) < height { &mut above } else { &mut below }) = middle;
    }
    let end = 0.5 * (above + below);
    let inner = rail.largest([end, crown], |place| -place.position[0]);
    let inner =
        [inner, end].map(|s| rail.at(s).position[0]).into_iter().fold(f64::INFINITY, f64::min);
    Ok([inner, top])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::standard::rail_60e1;

    fn track(cant: f64) -> Track {
        let placing = Placing::Gauge { width: 1.435, height: 14e-3 };
        Track { placing, cant, curvature: 0.0 }
    }

    #[test]
    fn the_gauge_point_is_at_half_the_gauge() {
        let profile = Surface::from(rail_60e1().unwrap());
        for (cant, side) in [(0.0, Side::Left), (0.05, Side::Left), (0.025, Side::Right)] {
            let rail = Rail::placed(&profile, side, &track(cant)).unwrap();
            let [from, to] = rail.outline.range();
            let places = (0..=20_000)
                .map(|k| rail.outline.at(from + (to - from) * f64::from(k) / 20_000.0).position);
            let places: Vec<[f64; 2]> = places.collect();
            let top = places.iter().map(|[_, z]| *z).fold(-1.0, f64::max);
            assert!(top.abs() < 1e-10, "{top:e}");
            let inner = places.iter().filter(|[_, z]| *z > -14e-3).map(|[y, _]| side.sign() * y);
            let inner = inner.fold(f64::INFINITY, f64::min);
            assert!((inner - 0.7175).abs() < 2e-6, "{inner}");
            let [y, z] = rail.outline.at(0.0).position;
            assert!((y - rail.origin[0]).hypot(z - rail.origin[1]) < 1e-12);
            // An inclined rail leans to the middle: the tangent at its origin turns by the cant,
            // with the sign of the side.
            assert!((rail.outline.at(0.0).angle() - side.sign() * cant).abs() < 1e-4);
        }
        let short = Surface::from(rail_60e1().unwrap());
        let deep = Track { placing: Placing::Gauge { width: 1.435, height: 0.1 }, ..track(0.0) };
        assert!(Rail::placed(&short, Side::Left, &deep).is_err());
    }

    #[test]
    fn a_deviation_turns_about_the_origin_and_shifts() {
        let rail = Rail::placed(&rail_60e1().unwrap().into(), Side::Left, &track(0.025)).unwrap();
        let by = Deviation { y: 1e-3, z: -2e-3, roll: 0.01, rates: [0.0; 3] };
        let off = rail.deviated(&by, 0.0);
        assert!((off.origin[0] - rail.origin[0] - 1e-3).abs() < 1e-15);
        for s in [-30e-3, 0.0, 12e-3] {
            let (a, b) = (rail.outline.at(s), off.outline.at(s));
            assert!((b.angle() - a.angle() - 0.01).abs() < 1e-12);
            let (before, behind) = (rail.profile_axes(a.position), off.profile_axes(b.position));
            assert!((before[0] - behind[0]).hypot(before[1] - behind[1]) < 1e-15);
        }
        assert!((off.outline.at(0.0).position[0] - off.origin[0]).abs() < 1e-12);
    }
}
