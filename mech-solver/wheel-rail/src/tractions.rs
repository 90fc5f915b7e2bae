//! Tractions of a patch under its pressure, with its friction.

use super::creepage::{Rolling, RowSlip};
use super::error::TrackError;
use super::fields::Fields;
use super::interface::{Elements, Interface};
use super::local::Window;
use super::patch::SolveStats;
use super::pool::Pool;
use super::pressed::{NormalPatch, copy_centred};
use super::rail::Side;
use super::settings::Settings;
use super::sliding::everywhere;
use super::springs;
use half_space::difference::Difference;
use half_space::friction::ElementFriction;
use half_space::grid_continuation::{Friction, History, Levels, Solution, TangentialError};
use half_space::slip_velocity::first_velocities;
use half_space::tangential::{Arguments, BoundLaw, Creepage, PrescribedMotion, TangentialState};

/// Input for the tractions of a patch.
pub(super) struct TractionProblem<'a> {
    pub(super) side: Side,
    pub(super) settings: &'a Settings,
    pub(super) pressed: &'a NormalPatch,
    pub(super) rolling: &'a Rolling,
    /// Part of the patch's window that holds the contact.
    pub(super) part: Window,
    /// Rigid slip of the rows of the window in addition to that of the creepages, if any.
    pub(super) besides: Option<Vec<RowSlip>>,
    /// Slip per step on the window in excess of that of elastic half-spaces [m], if any.
    pub(super) elastic: Option<[Vec<f64>; 2]>,
}

/// Tractions of a patch.
pub(super) struct TractionSolution {
    /// Part of the window on which the tractions were solved.
    pub(super) part: Window,
    pub(super) fields: Fields,
    /// Part of the friction power that is due to rigid slip off the plane [W].
    pub(super) off_plane: f64,
    /// Tractions on the part, if half-spaces were used.
    pub(super) state: Option<TangentialState>,
    /// Result of the springs, if these were used.
    pub(super) by_springs: Option<springs::TractionSolution>,
}

impl TractionProblem<'_> {
    /// Solves the tractions, starting from `near` if given.
    pub(super) fn solve(
        &self,
        law: &dyn Interface,
        near: Option<TangentialState>,
        pool: &mut Pool,
        work: &mut SolveStats,
    ) -> Result<TractionSolution, TrackError> {
        let Self { settings, pressed, rolling, part, besides, elastic, .. } = self;
        let NormalPatch { frame, window, .. } = pressed;
        let mut fields = Fields::pressed(
            window,
            settings.difference,
            frame.element,
            &pressed.distance,
            &pressed.pressure,
        );
        let rubs = PatchFriction { about: self, law };
        work.tangential_contacts += 1;
        if let Some(springs) = settings.springs() {
            let friction = rubs.friction(&fields, None)?;
            let given = (&friction, besides.as_deref());
            let with = (*settings, springs);
            let slid = springs::slide(pressed, rolling, with, given, &mut fields);
            let off_plane = slid.off_plane;
            return Ok(TractionSolution {
                part: *part,
                fields,
                off_plane,
                state: None,
                by_springs: Some(slid),
            });
        }
        let rigid =
            besides.as_deref().map(|rows| slip_of_a_step(rows, window, part, settings.difference));
        let all = with_elastic(rigid.as_ref(), elastic.as_ref(), (window, part));
        let [rigid, all] = [&rigid, &all].map(|slip| slip.as_ref().map(|[x, t]| [&x[..], &t[..]]));
        let start = law.follows_elements();
        let velocity = start.map(|start| {
            let scale = (part.points(), rubs.duration(), rolling.speed);
            first_velocities(start, near.as_ref(), scale)
        });
        let bound = fields.bound(part, &rubs.friction(&fields, velocity.as_deref())?);
        let state = if settings.adhesion {
            let follows = PatchBounds { friction: &rubs, fields: &fields };
            let law = start.map(|_| &follows as &dyn BoundLaw);
            let friction = Friction { bound: &bound, law };
            let solution = rolls(pool.tangential(part), friction, rolling.creepage, all, near)?;
            work.newton_steps += solution.newton_steps;
            solution.state
        } else {
            everywhere(&bound, part, settings.difference, rolling.creepage, rigid)
        };
        let [x, y] = &state.traction;
        let dissipation = match settings.adhesion {
            true => {
                let mut pressure = vec![0.0; part.points()];
                copy_centred((window, &fields.pressure), (part, &mut pressure));
                pool.tangential(part).dissipation([x, y], &pressure, rolling.speed)
            }
            false => None,
        };
        fields.take(part, &state, rolling.speed, dissipation.as_deref());
        let off_plane = rigid
            .map_or(0.0, |slip| fields.power_of_slip(part, slip, &state.traction, rolling.speed));
        Ok(TractionSolution {
            part: *part,
            fields,
            off_plane,
            state: Some(state),
            by_springs: None,
        })
    }
}

/// A patch and its friction law.
struct PatchFriction<'a> {
    about: &'a TractionProblem<'a>,
    law: &'a dyn Interface,
}

impl PatchFriction<'_> {
    /// Duration of the step in which a particle passes an element [s].
    fn duration(&self) -> f64 {
        self.about.part.sides[0] / self.about.rolling.speed
    }

    /// Friction on the window, with slip velocities on the part [m/s] if friction depends on them.
    fn friction(
        &self,
        fields: &Fields,
        slip: Option<&[f64]>,
    ) -> Result<ElementFriction, TrackError> {
        let TractionProblem { side, pressed, rolling, part, .. } = self.about;
        let NormalPatch { frame, window, region, .. } = pressed;
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
        self.law.friction(&elements).map_err(TrackError::Friction)
    }

    /// Slip velocity of rigid bodies in the middle of an element of the window [m/s].
    fn rigid_slip(&self, index: usize) -> f64 {
        let TractionProblem { pressed: NormalPatch { window, .. }, rolling, besides, .. } =
            self.about;
        let [xi, eta, phi] = rolling.creepage;
        let nx = window.counts()[0];
        let (x, t) = (window.along(0, index % nx), window.along(1, index / nx));
        let RowSlip { slip: [more_x, more_t], spin } =
            besides.as_ref().map_or_else(RowSlip::default, |rows| rows[index / nx]);
        rolling.speed * (xi - phi * t + more_x).hypot(eta + phi * x + more_t + spin * x)
    }
}

/// Traction bounds of a patch as a function of the slips.
struct PatchBounds<'a> {
    friction: &'a PatchFriction<'a>,
    fields: &'a Fields,
}

impl BoundLaw for PatchBounds<'_> {
    fn arguments(&self) -> Arguments {
        Arguments { creepage: false, slip: true }
    }

    fn evaluate(&self, _: Creepage, slip: &[f64], bound: &mut [f64]) {
        let Self { friction, fields } = self;
        let duration = friction.duration();
        let velocity: Vec<f64> = slip.iter().map(|slip| slip / duration).collect();
        // Inputs that friction cannot use were refused before, with the friction at the start.
        if let Ok(found) = friction.friction(fields, Some(&velocity)) {
            bound.copy_from_slice(&fields.bound(&friction.about.part, &found));
        }
    }
}

/// Tractions of rolling contact with an additional slip [m], starting from a nearby solution if
/// given.
fn rolls(
    levels: &mut Levels,
    friction: Friction<'_>,
    creepage: Creepage,
    more: Option<[&[f64]; 2]>,
    near: Option<TangentialState>,
) -> Result<Solution, TangentialError> {
    let given = PrescribedMotion::creepages(creepage);
    let improved = near.and_then(|state| {
        let mut solution = Solution::new(state);
        levels
            .improve(friction, &given, more.map(History::of_slip), &mut solution)
            .is_ok()
            .then_some(solution)
    });
    // If the last solution is too far away, solve without it.
    if let Some(solution) = improved {
        return Ok(solution);
    }
    let mut solution = levels.solve(friction, &given)?;
    if more.is_some() {
        levels.improve(friction, &given, more.map(History::of_slip), &mut solution)?;
    }
    Ok(solution)
}

/// Rigid slip of rows as the slip per step on the elements of a part [m].
fn slip_of_a_step(
    rows: &[RowSlip],
    window: &Window,
    part: &Window,
    difference: Difference,
) -> [Vec<f64>; 2] {
    let first = window.half[1] - part.half[1];
    let [nx, ny] = part.counts();
    let dx = part.sides[0];
    [0, 1].map(|k| {
        let row = |row: &RowSlip| {
            let (slip, spin) = (row.slip[k], if k == 0 { 0.0 } else { row.spin });
            (0..nx).map(move |i| {
                dx * (slip + spin * (part.along(0, i) + difference.rigid_slip_ahead() * dx))
            })
        };
        rows[first..first + ny].iter().flat_map(row).collect()
    })
}

/// Sum of the rigid slip on a part and the elastic slip on the window, each optional [m].
fn with_elastic(
    rigid: Option<&[Vec<f64>; 2]>,
    elastic: Option<&[Vec<f64>; 2]>,
    (window, part): (&Window, &Window),
) -> Option<[Vec<f64>; 2]> {
    let Some(elastic) = elastic else { return rigid.cloned() };
    let mut all = [0, 1].map(|_| vec![0.0; part.points()]);
    for (k, all) in all.iter_mut().enumerate() {
        copy_centred((window, &elastic[k]), (part, all));
        let rigid = rigid.iter().flat_map(|rigid| &rigid[k]);
        all.iter_mut().zip(rigid).for_each(|(all, rigid)| *all += rigid);
    }
    Some(all)
}
