//! A wheel on a rail, pressed and sliding at one height after another.
//!
//! Data that depend on the position of the wheelset are computed once per position: the silhouette,
//! and the rows of a displaced rail. Data that depend on the height start from the previous height,
//! and the tractions of a patch from the previous tractions of the same patch.

use super::columns::{Columns, PlacedProfile};
use super::creepage::{Rolling, rolling};
use super::error::TrackError;
use super::interface::Interface;
use super::mutual::{BlockLoads, opening};
use super::outline::Outline;
use super::patch::{Patch, SolveStats, Solved};
use super::pool::Pool;
use super::pressed::{Heights, NormalPatch};
use super::rail::{Deviation, Rail, Side};
use super::region::{Cuts, Region};
use super::rows::Rows;
use super::search::{Search, WheelView, clearance};
use super::settings::{PatchSurface, RigidSlip, Settings};
use super::silhouette::{Circles, SilhouettePoint, shadow};
use super::tractions::{TractionProblem, TractionSolution};
use super::wheelset::{Motion, Pose, Wheel, Wheelset};
use half_space::tangential::TangentialState;
use nalgebra::Vector3;

/// Largest distance along the tape at which patches of two solutions count as the same [m].
const SAME: f64 = 5e-3;

/// Most iterations of patches that displace each other, or of pressure and tractions. Each
/// iteration leaves a tenth of the last change, or less.
const MOST_TURNS: usize = 60;
/// Iterations of pressure and tractions with the whole change of the gap; later ones take half of
/// it, because an edge element may alternate between contact and no contact.
const WHOLE_TURNS: usize = 20;
/// Forces of patches have converged when they change by less than this share of the tolerance.
const MUTUAL_SHARE: f64 = 0.03;
/// Pressure and tractions on a curved surface have converged when they change by less than this
/// share of the largest pressure.
const REST: f64 = 1e-5;

/// A wheel and a rail, their solvers, and the last solution.
#[derive(Debug)]
pub(super) struct Pair {
    pub(super) settings: Settings,
    side: Side,
    wheelset: Wheelset,
    /// Rail as designed, and displaced.
    design: Rail,
    rail: Rail,
    rows: Rows,
    deviation: Deviation,
    wheel: Wheel,
    circles: Circles,
    shadow: Vec<SilhouettePoint>,
    /// Cuts across the rail, if the rail is not a prism or the wheel not round.
    columns: Option<Columns>,
    pub(super) motion: Motion,
    pose: Pose,
    search: Search,
    /// Rows at which patches are kept apart; `None` if the criterion decides.
    cuts: Option<Vec<i64>>,
    pool: Pool,
    /// Patches at the last height.
    pub(super) pressed: Vec<NormalPatch>,
    /// Tractions of patches, with their positions along the tape.
    sliding: Vec<(f64, [usize; 2], TangentialState)>,
    pub(super) work: SolveStats,
}

impl Pair {
    pub(super) fn new(
        (rail, wheel): (Rail, Wheel),
        side: Side,
        wheelset: Wheelset,
        settings: Settings,
    ) -> Self {
        let motion = Motion::default();
        let surfaces = [&rail.surface, &wheel.surface];
        let varies = surfaces.iter().any(|surface| surface.constant().is_none());
        Self {
            columns: varies.then(Columns::default),
            settings,
            side,
            wheelset,
            rows: Rows::of(&rail, settings.sides[1]),
            design: rail.clone(),
            rail,
            deviation: Deviation::default(),
            circles: Circles::of(&wheel),
            wheel,
            shadow: Vec::new(),
            pose: Pose::of(&motion, &wheelset),
            motion,
            search: Search::default(),
            cuts: None,
            pool: Pool::new(settings),
            pressed: Vec::new(),
            sliding: Vec::new(),
            work: SolveStats::default(),
        }
    }

    /// Moves to a position.
    pub(super) fn go_to(&mut self, motion: &Motion, deviation: &Deviation) {
        let goes_on = self.rail.surface.constant().is_none() && self.rail.way != motion.way;
        if self.deviation != *deviation || goes_on {
            self.deviation = *deviation;
            self.rail = self.design.deviated(deviation, motion.way);
            self.rows = Rows::of(&self.rail, self.settings.sides[1]);
        }
        self.motion = *motion;
        self.cuts = None;
        self.pose = Pose::of(motion, &self.wheelset);
        match self.columns.take() {
            None => shadow(&self.circles, &self.pose, &mut self.shadow),
            Some(mut columns) => {
                columns.go_to(&self.standing());
                if self.rail.surface.constant().is_none() {
                    self.rail.cut_at(columns.first_touch());
                    self.rows = Rows::of(&self.rail, self.settings.sides[1]);
                }
                self.columns = Some(columns);
            }
        }
        self.work = SolveStats::default();
        if self.is_curved() {
            self.turn();
        }
    }

    /// Returns the profiles of rail and wheel in a position, independent of the last solved one, as
    /// `count` points y and z in track axes \[m\]. The rail is cut at the first touch, the wheel
    /// through its axle.
    pub(super) fn outlines(
        &self,
        motion: &Motion,
        deviation: &Deviation,
        count: usize,
    ) -> [Vec<[f64; 2]>; 2] {
        let pose = Pose::of(motion, &self.wheelset);
        let mut rail = self.design.deviated(deviation, motion.way);
        if rail.surface.constant().is_none() {
            let rows = Rows::of(&rail, self.settings.sides[1]);
            let mut columns = Columns::default();
            let Self { wheel, .. } = self;
            columns.go_to(&PlacedProfile { rail: &rail, rows: &rows, wheel, pose: &pose, motion });
            rail.cut_at(columns.first_touch());
        }
        let along = |outline: &Outline| -> Vec<[f64; 2]> {
            let [from, to] = outline.range();
            let step = (to - from) / (count - 1) as f64;
            (0..count).map(|k| outline.at(from + k as f64 * step).position).collect()
        };
        let placed = |[y, z]: [f64; 2]| {
            let place = pose.rotation * Vector3::new(0.0, y, z) + pose.middle;
            [place.y, place.z]
        };
        let wheel = along(&self.wheel.outline).into_iter().map(placed).collect();
        [along(&rail.outline), wheel]
    }

    /// Returns true if patches are on curved surfaces.
    pub(super) fn is_curved(&self) -> bool {
        self.settings.patch_surface == PatchSurface::Curved
    }

    /// Puts patches on curved surfaces from now on, and discards earlier influence numbers.
    pub(super) fn turn(&mut self) {
        self.pool.curved.get_or_insert_default().clear();
    }

    /// Puts patches in planes until [`Pair::turn`].
    pub(super) fn stay_plane(&mut self) {
        self.pool.curved = None;
    }

    /// The bodies at their present positions.
    fn standing(&self) -> PlacedProfile<'_> {
        let Self { rail, rows, wheel, pose, motion, .. } = self;
        PlacedProfile { rail, rows, wheel, pose, motion }
    }

    /// Moves to a height.
    pub(super) fn lift_to(&mut self, z: f64) {
        self.motion.z = z;
        self.pose.middle.z = self.wheelset.nominal_radius + z;
    }

    /// Height at which the wheelset would touch [m]; `None` beside the rail.
    pub(super) fn touching_height(&self) -> Option<f64> {
        let middle = self.pose.middle;
        let clear = match &self.columns {
            None => clearance(&self.rows, &self.shadow, middle),
            Some(columns) => columns.clearance(middle.z),
        };
        Some(self.motion.z - clear?)
    }

    /// Presses the bodies together at this height.
    pub(super) fn press(&mut self, interface: &dyn Interface) -> Result<(), TrackError> {
        let spacing = self.settings.sides[1];
        if let Some(mut columns) = self.columns.take() {
            columns.deepen(&self.standing(), self.pose.middle.z);
            self.columns = Some(columns);
        }
        if self.cuts.is_none() {
            self.regions(&[]);
        }
        let cuts = match self.cuts.take() {
            Some(cuts) => cuts,
            None => self.search.cuts(&self.rows, spacing, &self.settings.joining),
        };
        let regions = self.regions(&cuts);
        self.cuts = Some(cuts);
        let bodies = ((&self.rail, &self.wheel, &self.pose), self.motion.pitch);
        let height = |place: [f64; 2]| interface.height(self.side, place);
        let heights: Option<Heights<'_>> = if interface.is_rough() { Some(&height) } else { None };
        let mut pressed = Vec::with_capacity(regions.len());
        for region in &regions {
            let near = nearest(&self.pressed, region.s, |near| near.region.s);
            let rest = (near, heights);
            let found = NormalPatch::of(region, bodies, &self.settings, &mut self.pool, rest)?;
            self.work.normal_contacts += 1;
            self.work.normal_iterations += found.iterations;
            pressed.push(found);
        }
        if self.settings.mutual {
            self.press_together(&mut pressed, MOST_TURNS)?;
        }
        pressed.retain(|patch| patch.normal_force > 0.0);
        self.pressed = pressed;
        Ok(())
    }

    /// Presses patches in turn, until their mutual displacements have converged, at most `turns`
    /// times.
    pub(super) fn press_together(
        &mut self,
        pressed: &mut [NormalPatch],
        turns: usize,
    ) -> Result<(), TrackError> {
        if pressed.len() < 2 {
            return Ok(());
        }
        let compliance = self.settings.bodies.contact_compliance();
        let mut acting: Vec<BlockLoads> = pressed.iter().map(BlockLoads::of).collect();
        let (mut change, mut force) = (0.0_f64, 0.0);
        for _ in 0..turns {
            (change, force) = (0.0, 0.0);
            for at in 0..pressed.len() {
                let others = acting.iter().enumerate().filter(|(k, _)| *k != at).map(|(_, o)| o);
                let patch = &mut pressed[at];
                let (before, iterations) = (patch.normal_force, patch.iterations);
                let opening = opening(patch, others, compliance);
                patch.press_again(opening, &self.settings, &mut self.pool)?;
                acting[at] = BlockLoads::of(patch);
                change = change.max((patch.normal_force - before).abs());
                force += patch.normal_force;
                self.work.normal_contacts += 1;
                self.work.normal_iterations += patch.iterations - iterations;
            }
            if change <= MUTUAL_SHARE * self.settings.tolerance * force {
                return Ok(());
            }
        }
        Err(TrackError::Patches { change: change / force })
    }

    /// Separates patches by the criterion at this height; returns true if the separation is
    /// unchanged.
    pub(super) fn part(&mut self) -> bool {
        let spacing = self.settings.sides[1];
        let found = self.search.cuts(&self.rows, spacing, &self.settings.joining);
        let parted = |regions: Vec<Region>| -> Vec<[i64; 2]> {
            regions.into_iter().map(|region| region.rows).collect()
        };
        let anew = parted(self.regions(&found));
        let held = self.cuts.replace(found).unwrap_or_default();
        anew == parted(self.regions(&held))
    }

    /// Regions of penetration at this height, separated at these rows.
    fn regions(&mut self, cuts: &Cuts) -> Vec<Region> {
        let seen = match &mut self.columns {
            Some(columns) => WheelView::Columns(columns),
            None => WheelView::SilhouettePoint(&self.shadow),
        };
        self.search.patches(&self.rows, (seen, self.pose.middle), self.settings.sides[1], cuts)
    }

    /// Solves every patch on its whole window.
    pub(super) fn complete(&mut self) -> Result<(), TrackError> {
        for patch in &mut self.pressed {
            let before = patch.iterations;
            patch.complete(&mut self.pool)?;
            self.work.normal_iterations += patch.iterations - before;
        }
        Ok(())
    }

    /// Solves the tractions of the patches at this height.
    pub(super) fn slide(&mut self, interface: &dyn Interface) -> Result<Solved, TrackError> {
        let Self { settings, side, rail, wheel, pose, motion, pool, work, .. } = self;
        let mut patches = Vec::with_capacity(self.pressed.len());
        let mut sliding = Vec::with_capacity(self.pressed.len());
        let about = (&*settings, *side, (&*rail, &*pose, &*motion));
        for pressed in &mut self.pressed {
            let near = nearest(&self.sliding, pressed.region.s, |(s, ..)| *s);
            let near = near.map(|(_, half, state)| (*half, state.clone()));
            let (rolling, slid) = slide(pressed, about, near, interface, (pool, work))?;
            let patch =
                Patch::of(pressed, slid.fields, rolling, slid.off_plane, (rail, wheel, pose));
            patches.push(match &slid.by_springs {
                Some(springs) => patch.sliding(springs),
                None => patch,
            });
            let half = slid.part.half;
            sliding.extend(slid.state.map(|state| (pressed.region.s, half, state)));
        }
        self.sliding = sliding;
        Ok(Solved::of(self.motion.z, patches, &self.pose, self.work))
    }

    /// Discards earlier results: the next position is solved as if it were the first.
    pub(super) fn forget(&mut self) {
        self.pressed.clear();
        self.sliding.clear();
    }
}

/// Solves the tractions of a patch, starting from `near` if given. On a curved surface pressure and
/// tractions alternate until both have converged.
fn slide(
    pressed: &mut NormalPatch,
    (settings, side, bodies): (&Settings, Side, (&Rail, &Pose, &Motion)),
    mut near: Option<([usize; 2], TangentialState)>,
    interface: &dyn Interface,
    (pool, work): (&mut Pool, &mut SolveStats),
) -> Result<(Rolling, TractionSolution), TrackError> {
    let (rail, pose, motion) = bodies;
    let mut traction = [0, 1].map(|_| vec![0.0; pressed.window.points()]);
    let mut change = f64::INFINITY;
    for turn in 0..MOST_TURNS {
        let rolling = rolling(&pressed.frame, pressed.approach(), rail, pose, motion)?;
        let part = pressed.contact_window();
        let besides = match settings.rigid_slip {
            RigidSlip::Plane => None,
            RigidSlip::Surfaces => Some(pressed.rigid_slip(&rolling, bodies)?),
        };
        let elastic = pressed.elastic_slip(&traction, settings.difference);
        let near_here = near.take().filter(|(half, _)| *half == part.half);
        let about =
            TractionProblem { side, settings, pressed, rolling: &rolling, part, besides, elastic };
        let slid = about.solve(interface, near_here.map(|(_, state)| state), pool, work)?;
        if pressed.curved.is_none() || change <= REST {
            return Ok((rolling, slid));
        }
        let before = std::mem::replace(&mut traction, slid.fields.traction);
        let iterations = pressed.iterations;
        let share = if turn < WHOLE_TURNS { 1.0 } else { 0.5 };
        let yielded = pressed.yield_to(&traction, share, pool)? / share;
        change = yielded.max(change_of(&traction, &before, pressed));
        work.normal_iterations += pressed.iterations - iterations;
        near = slid.state.map(|state| (part.half, state));
    }
    Err(TrackError::Turns { change })
}

/// Largest difference of two tractions, relative to the largest pressure.
fn change_of(traction: &[Vec<f64>; 2], before: &[Vec<f64>; 2], pressed: &NormalPatch) -> f64 {
    let largest = pressed.pressure.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
    let pairs = traction.iter().flatten().zip(before.iter().flatten());
    pairs.map(|(one, other)| (one - other).abs()).fold(0.0, f64::max) / largest
}

/// Entry with the nearest position, if it is within [`SAME`].
pub(super) fn nearest<T>(entries: &[T], s: f64, place: impl Fn(&T) -> f64) -> Option<&T> {
    let off = |entry: &&T| (place(entry) - s).abs();
    let found = entries.iter().min_by(|a, b| off(a).total_cmp(&off(b)))?;
    (off(&found) < SAME).then_some(found)
}
