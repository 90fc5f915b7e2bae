//! A patch under pressure, without tractions.

use super::analyn;
use super::creepage::{Rolling, RowSlip};
use super::curved::Curved;
use super::distance::{distance_of_surfaces, on_rail};
use super::error::TrackError;
use super::fields::{Fields, Load};
use super::kpec;
use super::local::{Frame, NOTHING, Window, three_distances, undeformed_distance};
use super::parabolas::Parabolas;
use super::pool::{Pool, room};
use super::rail::Rail;
use super::region::Region;
use super::settings::{Normal, Settings};
use super::strips::{self, PressedStrip};
use super::wheelset::{Motion, Pose, Wheel};
use grids::Structured;
use half_space::area::contact_area;
use half_space::difference::Difference;
use half_space::normal::Prescribed;
use std::borrow::Cow;

/// Elements by which a contact may grow on each side from one height to the next, besides the one
/// element of margin.
const GROWTH: usize = 1;

/// Rows beside the region of penetration in which a patch on a curved surface may touch, because
/// tractions close the gap as well.
const BESIDE: i64 = 3;

/// Heights added to the undeformed distance, at x in track axes and a tape distance [m].
pub(super) type Heights<'a> = &'a dyn Fn([f64; 2]) -> f64;

/// A patch and its pressure.
///
/// Starting from a nearby pressure, the patch is solved on the part of its window around the
/// previous contact. [`NormalPatch::complete`] solves it on the whole window.
#[derive(Debug)]
pub(super) struct NormalPatch {
    pub(super) region: Region,
    pub(super) frame: Frame,
    pub(super) window: Window,
    /// Undeformed distance [m], negative where the undeformed bodies penetrate.
    pub(super) distance: Vec<f64>,
    /// Height of the rail over the plane in every row [m].
    rail_heights: Vec<f64>,
    /// Least undeformed distance of smooth bodies in every row [m].
    lowest: Vec<f64>,
    /// Pressure [Pa].
    pub(super) pressure: Vec<f64>,
    /// Normal force [N].
    pub(super) normal_force: f64,
    /// True if the pressure was solved on the whole window.
    complete: bool,
    /// Opening of the gap by other patches or by tractions [m]; empty if there is none.
    opening: Vec<f64>,
    /// Curved surface of the patch, if it is not plane.
    pub(super) curved: Option<Curved>,
    /// Parabolas and strips of an approximate theory.
    approximate: Option<(Parabolas, Vec<PressedStrip>)>,
    /// Iterations of the normal contact.
    pub(super) iterations: usize,
}

impl NormalPatch {
    /// Solves the patch of a region, with the wheel turned by `pitch` [rad]. Starts from the
    /// pressure of `near`, and adds heights if surfaces are rough.
    pub(super) fn of(
        region: &Region,
        (bodies, pitch): ((&Rail, &Wheel, &Pose), f64),
        settings: &Settings,
        pool: &mut Pool,
        (near, heights): (Option<&Self>, Option<Heights<'_>>),
    ) -> Result<Self, TrackError> {
        let (rail, wheel, _) = bodies;
        let mut frame = Frame::at(region, rail, settings.sides);
        if rail.surface.constant().is_none() {
            frame = on_rail(&frame, rail);
        }
        let rows = match pool.curved {
            Some(_) => [region.rows[0] - BESIDE, region.rows[1] + BESIDE],
            None => region.rows,
        };
        let window = window((region, rows), &frame, settings)?;
        let constant = rail.surface.constant().is_some() && wheel.surface.constant().is_some();
        let own = own_rows(rows, &frame, &window);
        let known = pool.curved.as_mut();
        let curved =
            known.map(|known| known.patch(&frame, (&window, own), bodies, settings)).transpose()?;
        let (mut distance, rail_heights, approximate) = match settings.normal {
            Normal::HalfSpace => {
                let [mut distance, heights] = match &curved {
                    Some(curved) => {
                        [curved.distance(&window, bodies), vec![0.0; window.counts()[1]]]
                    }
                    None if constant => undeformed_distance(&frame, &window, bodies),
                    None => distance_of_surfaces(&frame, &window, bodies, pitch),
                };
                leave_to_others(&window, own, &mut distance);
                (distance, heights, None)
            }
            Normal::Kpec | Normal::Analyn => {
                let (rows, heights) = three_distances(&frame, &window, bodies);
                let parabolas = Parabolas::of(&window, &rows, own);
                (parabolas.distance(&window), heights, Some((parabolas, Vec::new())))
            }
        };
        let lowest = lowest_of_rows(&window, &distance);
        if let Some(heights) = heights {
            roughen(&mut distance, &frame, &window, heights);
        }
        let mut pressure = vec![0.0; window.points()];
        let (normal_force, iterations) = (0.0, 0);
        let (mut part, mut opening) = (window, Vec::new());
        if let Some(near) = near.filter(|_| approximate.is_none()) {
            copy_centred((&near.window, &near.pressure), (&window, &mut pressure));
            if curved.is_some() && !near.opening.is_empty() {
                opening = near.opening_of((&frame, &window));
            }
            // Varying or rough bodies may touch where they did not at the last height.
            if constant && heights.is_none() && curved.is_none() {
                let half = near.contact_window().half;
                part.half = [0, 1].map(|k| room(half[k] + GROWTH).min(window.half[k]));
            }
        }
        let complete = part == window;
        let region = *region;
        let mut pressed = Self {
            region,
            frame,
            window,
            distance,
            rail_heights,
            lowest,
            pressure,
            normal_force,
            complete,
            opening,
            curved,
            approximate,
            iterations,
        };
        pressed.press(&part, settings, pool)?;
        Ok(pressed)
    }

    /// Solves the pressure again with this opening of the gap, starting from the present pressure.
    pub(super) fn press_again(
        &mut self,
        opening: Vec<f64>,
        settings: &Settings,
        pool: &mut Pool,
    ) -> Result<(), TrackError> {
        self.opening = opening;
        let half = self.contact_window().half;
        let half = [0, 1].map(|k| room(half[k] + GROWTH).min(self.window.half[k]));
        let part = Window { half, ..self.window };
        self.complete = part == self.window;
        self.press(&part, settings, pool)
    }

    fn press(
        &mut self,
        part: &Window,
        settings: &Settings,
        pool: &mut Pool,
    ) -> Result<(), TrackError> {
        let Some((parabolas, strips)) = &mut self.approximate else {
            return self.solve(part, pool);
        };
        let own = match self.opening.is_empty() {
            true => parabolas.clone(),
            false => parabolas.opened(&self.window, &self.opening),
        };
        *strips = match settings.normal {
            Normal::Analyn => analyn::strips(&own, settings.bodies.contact_compliance()),
            _ => kpec::strips(&own, &self.window, settings.bodies),
        };
        strips::write_pressure(strips, &self.window, 1.0, &mut self.pressure);
        let [dx, dy] = self.window.sides;
        self.normal_force = self.pressure.iter().sum::<f64>() * dx * dy;
        self.complete = true;
        Ok(())
    }

    /// Contact as strips along x.
    pub(super) fn strips(&self) -> Vec<PressedStrip> {
        match &self.approximate {
            Some((_, strips)) => strips.clone(),
            None => strips::of_pressure(&self.window, &self.pressure),
        }
    }

    /// Area of the contact [m²].
    pub(super) fn area(&self, grid: &Structured) -> f64 {
        match &self.approximate {
            Some((_, strips)) => strips::area(strips, self.window.sides[1]),
            None => contact_area(grid, &self.pressure),
        }
    }

    /// Solves on the whole window, because elements outside a part of it may touch too.
    pub(super) fn complete(&mut self, pool: &mut Pool) -> Result<(), TrackError> {
        if self.complete {
            return Ok(());
        }
        self.complete = true;
        self.solve(&self.window.clone(), pool)
    }

    /// Solves on a part of the window, starting from the present pressure.
    fn solve(&mut self, part: &Window, pool: &mut Pool) -> Result<(), TrackError> {
        let approach = Prescribed::Approach(0.0);
        let gap = gap(&self.distance, &self.opening);
        let contact = if let Some(curved) = &mut self.curved {
            curved.press(&gap, &mut self.pressure)?
        } else if *part == self.window {
            pool.normal(part).solve(&gap, approach, &mut self.pressure)?
        } else {
            let (mut distance, mut pressure) = (vec![0.0; part.points()], vec![0.0; part.points()]);
            copy_centred((&self.window, &gap), (part, &mut distance));
            copy_centred((&self.window, &self.pressure), (part, &mut pressure));
            let contact = pool.normal(part).solve(&distance, approach, &mut pressure)?;
            self.pressure.fill(0.0);
            copy_centred((part, &pressure), (&self.window, &mut self.pressure));
            contact
        };
        self.normal_force = contact.normal_force;
        self.iterations += contact.iterations;
        match contact.touches_edge && !self.complete {
            true => self.complete(pool),
            false => Ok(()),
        }
    }

    /// Opening of the gap on the elements of another window, zero beyond this window [m].
    fn opening_of(&self, (frame, window): (&Frame, &Window)) -> Vec<f64> {
        let [nx, ny] = self.window.counts();
        let shift = [0, 1].map(|k| {
            let [there, here] = [(frame, window), (&self.frame, &self.window)]
                .map(|(frame, window)| frame.element[k] - window.half[k] as i64);
            there - here
        });
        let width = window.counts()[0];
        let at = |index: usize| {
            let [i, j] = [(0, index % width), (1, index / width)]
                .map(|(k, at)| usize::try_from(at as i64 + shift[k]).ok());
            match (i?, j?) {
                (i, j) if i < nx && j < ny => Some(self.opening[j * nx + i]),
                _ => None,
            }
        };
        (0..window.points()).map(|index| at(index).unwrap_or(0.0)).collect()
    }

    /// Opens the gap of a patch on a curved surface by `share` of the change towards its opening by
    /// the tractions, and solves the pressure again. Returns the change of pressure relative to the
    /// largest.
    pub(super) fn yield_to(
        &mut self,
        traction: &[Vec<f64>; 2],
        share: f64,
        pool: &mut Pool,
    ) -> Result<f64, TrackError> {
        let Some(curved) = &mut self.curved else { return Ok(0.0) };
        self.opening.resize(self.distance.len(), 0.0);
        let before = self.opening.clone();
        curved.opening(traction, &mut self.opening);
        for (opening, before) in self.opening.iter_mut().zip(&before) {
            *opening = share * *opening + (1.0 - share) * before;
        }
        let before = self.pressure.clone();
        self.solve(&self.window.clone(), pool)?;
        let changes = self.pressure.iter().zip(&before).map(|(p, q)| (p - q).abs());
        let largest = self.pressure.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
        Ok(changes.fold(0.0, f64::max) / largest)
    }

    /// Slip of a step under these tractions in excess of that of elastic half-spaces [m], on a
    /// curved surface.
    pub(super) fn elastic_slip(
        &mut self,
        traction: &[Vec<f64>; 2],
        difference: Difference,
    ) -> Option<[Vec<f64>; 2]> {
        Some(self.curved.as_mut()?.elastic_slip(traction, &self.pressure, difference))
    }

    /// Ratio of tangential to normal force [-]. In a plane, the force along the tangent per force
    /// along the normal; on a curved surface, the vertical part of the tractions per sum of the
    /// pressure.
    pub(super) fn leaning(&self, fields: &Fields) -> f64 {
        match &self.curved {
            Some(curved) => {
                let all = curved.vertical(&fields.pressure, Some(&fields.traction[1]));
                let sum: f64 = fields.pressure.iter().sum();
                (all - curved.vertical(&fields.pressure, None)) / sum
            }
            None => fields.leaning(),
        }
    }

    /// Vertical force of the pressure, and of tractions with this ratio to it [N].
    pub(super) fn vertical(&self, leaning: f64) -> f64 {
        match &self.curved {
            Some(curved) => {
                let [dx, dy] = self.window.sides;
                curved.vertical(&self.pressure, None) * dx * dy + leaning * self.normal_force
            }
            None => {
                let (sin, cos) = self.frame.angle.sin_cos();
                self.normal_force * (cos + leaning * sin)
            }
        }
    }

    /// Rigid slip of the rows of the window in excess of that of the creepages in its plane, if
    /// rigid slip is taken on the surfaces.
    pub(super) fn rigid_slip(
        &self,
        rolling: &Rolling,
        bodies: (&Rail, &Pose, &Motion),
    ) -> Result<Vec<RowSlip>, TrackError> {
        if let Some(curved) = &self.curved {
            return Ok(curved.rigid_slip((&self.window, rolling), &self.lowest, bodies)?);
        }
        let [rail, wheel] = self.heights(&self.window);
        let [by_wheel, by_rail] = rolling.by_height;
        let rows = wheel.iter().zip(&rail);
        let off_plane =
            |(wheel, rail): (&f64, &f64)| [0, 1].map(|k| by_wheel[k] * wheel + by_rail[k] * rail);
        Ok(rows.map(off_plane).map(|slip| RowSlip { slip, spin: 0.0 }).collect())
    }

    /// Forces and moments on the wheel about the origin of the patch's axes, in these axes.
    pub(super) fn load(&self, fields: &Fields) -> Load {
        match &self.curved {
            Some(curved) => curved.load(&self.frame, fields),
            None => fields.load(),
        }
    }

    /// Penetration of the undeformed bodies along the normal of the patch [m].
    pub(super) fn approach(&self) -> f64 {
        -self.distance.iter().copied().fold(0.0, f64::min)
    }

    /// Height of the rail over the plane, and height of the wheel over its point Q, both at the
    /// lowest point of every row in a part of the window [m].
    pub(super) fn heights(&self, part: &Window) -> [Vec<f64>; 2] {
        let approach = self.approach();
        let first = self.window.half[1] - part.half[1];
        let rows = first..first + part.counts()[1];
        let rail = self.rail_heights[rows.clone()].to_vec();
        let height = |j: usize| match self.lowest[j] {
            NOTHING => 0.0,
            lowest => self.rail_heights[j] + lowest + approach,
        };
        let wheel = rows.map(height).collect();
        [rail, wheel]
    }

    /// Part of the window that holds the contact and one element of margin.
    pub(super) fn contact_window(&self) -> Window {
        let [nx, _] = self.window.counts();
        let mut most = [0; 2];
        for (at, p) in self.pressure.iter().enumerate() {
            if *p > 0.0 {
                for (k, place) in [at % nx, at / nx].into_iter().enumerate() {
                    most[k] = most[k].max(place.abs_diff(self.window.half[k]));
                }
            }
        }
        let half = [0, 1].map(|k| room(most[k] + 1).min(self.window.half[k]));
        Window { half, ..self.window }
    }
}

/// Least distance of every row [m].
fn lowest_of_rows(window: &Window, distance: &[f64]) -> Vec<f64> {
    let rows = distance.chunks_exact(window.counts()[0]);
    rows.map(|row| row.iter().copied().fold(NOTHING, f64::min)).collect()
}

/// Adds heights wherever both bodies exist.
fn roughen(distance: &mut [f64], frame: &Frame, window: &Window, heights: Heights<'_>) {
    let nx = window.counts()[0];
    let [first_x, first_tape] = [0, 1].map(|k| frame.element[k] - window.half[k] as i64);
    let [dx, ds] = window.sides;
    for (at, distance) in distance.iter_mut().enumerate().filter(|(_, h)| **h < NOTHING) {
        let (i, j) = ((at % nx) as i64, (at / nx) as i64);
        *distance += heights([(first_x + i) as f64 * dx, (first_tape + j) as f64 * ds]);
    }
}

/// Undeformed distance plus opening [m].
fn gap<'a>(distance: &'a [f64], opening: &[f64]) -> Cow<'a, [f64]> {
    match opening {
        [] => distance.into(),
        _ => distance.iter().zip(opening).map(|(distance, more)| distance + more).collect(),
    }
}

/// Range of rows in a window, end exclusive, from the first and last row of a region.
fn own_rows(rows: [i64; 2], frame: &Frame, window: &Window) -> [usize; 2] {
    let [first, last] = rows.map(|row| row - frame.element[1] + window.half[1] as i64);
    [first, last + 1].map(|row| row.clamp(0, window.counts()[1] as i64) as usize)
}

/// Removes rows beyond the region, which belong to other patches or to none.
fn leave_to_others(window: &Window, [first, end]: [usize; 2], distance: &mut [f64]) {
    let [nx, _] = window.counts();
    distance[..first * nx].fill(NOTHING);
    distance[end * nx..].fill(NOTHING);
}

/// Window around a region with these rows, plus one element of margin.
fn window(
    (region, rows): (&Region, [i64; 2]),
    frame: &Frame,
    settings: &Settings,
) -> Result<Window, TrackError> {
    let [dx, _] = settings.sides;
    let along = region.x_range.map(|x| (x - frame.origin.x).abs() / dx);
    let along = along[0].max(along[1]).ceil() as usize;
    let across = rows.map(|row| row.abs_diff(frame.element[1]) as usize);
    let half = [room(along + 1), room(across[0].max(across[1]) + 1)];
    let window = Window { half, sides: settings.sides };
    match window.points() {
        elements if elements > settings.limit => {
            let (penetration, limit) = (region.penetration, settings.limit);
            Err(TrackError::Elements { penetration, elements, limit })
        }
        _ => Ok(window),
    }
}

/// Copies a field from one window to another with the same origin, where they overlap.
pub(super) fn copy_centred((from, source): (&Window, &[f64]), (to, target): (&Window, &mut [f64])) {
    let half = [0, 1].map(|k| from.half[k].min(to.half[k]));
    let width = 2 * half[0] + 1;
    let start = |window: &Window, j: usize| {
        let row = window.half[1] - half[1] + j;
        row * (2 * window.half[0] + 1) + window.half[0] - half[0]
    };
    for j in 0..=2 * half[1] {
        let (source_at, target_at) = (start(from, j), start(to, j));
        target[target_at..target_at + width].copy_from_slice(&source[source_at..source_at + width]);
    }
}
