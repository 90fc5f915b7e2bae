//! A patch under its pressure, about to slide: friction, and the tractions that it allows.

use super::creepage::Rolling;
use super::error::TrackError;
use super::fields::Fields;
use super::interface::{Elements, Interface};
use super::local::Window;
use super::patch::Work;
use super::pool::Pool;
use super::pressed::{Pressed, copy_centred};
use super::rail::Side;
use super::settings::{RigidSlip, Settings};
use super::sliding::everywhere;
use super::springs;
use crate::half_space::levels::{History, Levels, Solution, TangentialError};
use crate::half_space::settling::{Settling, first_velocities, slip_velocities};
use crate::half_space::tangential::{Creepage, Prescribed, TangentialState};
use crate::slip::SlipStart;

/// A patch that is about to slide.
pub(super) struct Sliding<'a> {
    pub(super) side: Side,
    pub(super) settings: &'a Settings,
    pub(super) pressed: &'a Pressed,
    pub(super) rolling: &'a Rolling,
    /// The part of its window that holds the contact.
    pub(super) part: Window,
}

/// A patch that slides.
pub(super) struct Slid {
    pub(super) fields: Fields,
    /// Part of the friction power that rigid slip off the plane gives [W].
    pub(super) off_plane: f64,
    /// Its tractions on the part, if half-spaces gave them.
    pub(super) state: Option<TangentialState>,
    /// What springs gave.
    pub(super) by_springs: Option<springs::Slid>,
}

impl Sliding<'_> {
    /// The tractions, from a state that is near if there is one.
    pub(super) fn solve(
        &self,
        law: &dyn Interface,
        near: Option<TangentialState>,
        pool: &mut Pool,
        work: &mut Work,
    ) -> Result<Slid, TrackError> {
        let Self { settings, pressed, rolling, part, .. } = self;
        let Pressed { frame, window, .. } = pressed;
        let mut fields =
            Fields::pressed(window, frame.element, &pressed.distance, &pressed.pressure);
        let rows = match settings.rigid_slip {
            RigidSlip::Plane => None,
            RigidSlip::Surfaces => Some(off_plane(pressed, rolling)),
        };
        let rubs = Rubs { about: self, law, off_plane: rows.as_deref() };
        work.tangential_contacts += 1;
        if let Some(springs) = settings.springs() {
            let given = (&rubs.friction(&fields, None)?[..], rows.as_deref());
            let with = (*settings, springs);
            let slid = springs::slide(pressed, rolling, with, given, &mut fields);
            let off_plane = slid.off_plane;
            return Ok(Slid { fields, off_plane, state: None, by_springs: Some(slid) });
        }
        let more = rows.as_deref().map(|rows| slip_of_a_step(rows, window, part));
        let more = more.as_ref().map(|[x, t]| [x.as_slice(), t.as_slice()]);
        let mut tractions = |bound: &[f64], near: Option<TangentialState>| {
            if !settings.adhesion {
                return Ok(everywhere(bound, part, rolling.creepage, more));
            }
            let solution = rolls(pool.tangential(part), bound, rolling.creepage, more, near)?;
            work.newton_steps += solution.newton_steps;
            Ok::<_, TangentialError>(solution.state)
        };
        let state = match law.follows_elements() {
            None => tractions(&fields.bound(part, &rubs.friction(&fields, None)?), near)?,
            Some(start) => rubs.settle(start, near, &fields, tractions)?,
        };
        fields.take(part, &state, rolling.speed);
        let off_plane = more
            .map_or(0.0, |slip| fields.power_of_slip(part, slip, &state.traction, rolling.speed));
        Ok(Slid { fields, off_plane, state: Some(state), by_springs: None })
    }
}

/// A patch and its law of friction.
struct Rubs<'a> {
    about: &'a Sliding<'a>,
    law: &'a dyn Interface,
    /// Rigid slip over V off the plane, of every row of the window, if there is [-].
    off_plane: Option<&'a [[f64; 2]]>,
}

impl Rubs<'_> {
    /// The tractions with the friction of the slip that they leave, looked for from a start.
    fn settle(
        &self,
        start: SlipStart,
        mut near: Option<TangentialState>,
        fields: &Fields,
        mut tractions: impl FnMut(
            &[f64],
            Option<TangentialState>,
        ) -> Result<TangentialState, TangentialError>,
    ) -> Result<TangentialState, TrackError> {
        let Sliding { rolling, part, .. } = self.about;
        let duration = part.sides[0] / rolling.speed;
        let scale = (part.points(), duration, rolling.speed);
        let mut settling = Settling::from(first_velocities(start, near.as_ref(), scale));
        let bound_by = |velocity: &[f64]| {
            Ok::<_, TrackError>(fields.bound(part, &self.friction(fields, Some(velocity))?))
        };
        let mut bound = bound_by(settling.velocity())?;
        loop {
            let state = tractions(&bound, near.take())?;
            let share = settling.follow(&slip_velocities(&state, duration));
            let before = std::mem::replace(&mut bound, bound_by(settling.velocity())?);
            if settling.has_settled(share, &before, &bound)? {
                return Ok(state);
            }
            near = Some(state);
        }
    }

    /// The coefficients of friction on the window, with slip velocities on the part [m/s] if they follow those.
    fn friction(&self, fields: &Fields, slip: Option<&[f64]>) -> Result<Vec<f64>, TrackError> {
        let Sliding { side, pressed, rolling, part, .. } = self.about;
        let Pressed { frame, window, region, .. } = pressed;
        let slip = slip.map(|slip| {
            let mut wide = vec![0.0; window.points()];
            copy_centred((part, slip), (window, &mut wide));
            wide
        });
        let elements = Elements {
            side: *side,
            grid: fields.developed_grid(),
            pressure: &fields.pressure,
            reference: [frame.reference.x, region.s],
            angle: frame.angle,
            speed: rolling.speed,
            rigid_slip: &|index| self.rigid_slip(index),
            slip: slip.as_deref(),
        };
        let mut friction = vec![0.0; window.points()];
        self.law.coefficients(&elements, &mut friction).map_err(TrackError::Friction)?;
        Ok(friction)
    }

    /// Slip velocity of rigid bodies, in the middle of an element of the window [m/s].
    fn rigid_slip(&self, index: usize) -> f64 {
        let Sliding { pressed: Pressed { window, .. }, rolling, .. } = self.about;
        let [xi, eta, phi] = rolling.creepage;
        let nx = window.counts()[0];
        let (x, t) = (window.along(0, index % nx), window.along(1, index / nx));
        let [off_x, off_t] = self.off_plane.map_or([0.0; 2], |rows| rows[index / nx]);
        rolling.speed * (xi - phi * t + off_x).hypot(eta + phi * x + off_t)
    }
}

/// The tractions of rolling contact, with a slip that is there besides [m], from a solution that is near if there is one.
fn rolls(
    levels: &mut Levels,
    bound: &[f64],
    creepage: Creepage,
    more: Option<[&[f64]; 2]>,
    near: Option<TangentialState>,
) -> Result<Solution, TangentialError> {
    let given = Prescribed::creepages(creepage);
    let improved = near.and_then(|state| {
        let mut solution = Solution::new(state);
        levels
            .improve(bound, &given, more.map(History::of_slip), &mut solution)
            .is_ok()
            .then_some(solution)
    });
    // What is too far from the last solution is solved without it.
    if let Some(solution) = improved {
        return Ok(solution);
    }
    let mut solution = levels.solve(bound, &given)?;
    if more.is_some() {
        levels.improve(bound, &given, more.map(History::of_slip), &mut solution)?;
    }
    Ok(solution)
}

/// Rigid slip over V off the plane, of every row of the window [-].
fn off_plane(pressed: &Pressed, rolling: &Rolling) -> Vec<[f64; 2]> {
    let [rail, wheel] = pressed.heights(&pressed.window);
    let [by_wheel, by_rail] = rolling.by_height;
    let rows = wheel.iter().zip(&rail);
    rows.map(|(wheel, rail)| [0, 1].map(|k| by_wheel[k] * wheel + by_rail[k] * rail)).collect()
}

/// The same as the slip of a step on the elements of a part [m].
fn slip_of_a_step(rows: &[[f64; 2]], window: &Window, part: &Window) -> [Vec<f64>; 2] {
    let first = window.half[1] - part.half[1];
    let [nx, ny] = part.counts();
    [0, 1].map(|k| {
        let own = rows[first..first + ny].iter();
        own.flat_map(|slip| std::iter::repeat_n(part.sides[0] * slip[k], nx)).collect()
    })
}
