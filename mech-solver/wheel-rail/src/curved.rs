//! A patch on a curved surface, as between the flange root of a wheel and the gauge corner of a
//! rail.
//!
//! **Surface.** Every row of the patch has its own axes. Their origin is the point of the rail at
//! the row's tape distance. Their angle α_j is the mean of the angles of both surfaces: of the rail
//! there, and of the wheel where the rail's normal meets the wheel. The undeformed distance is
//! measured along the normal of the row, pressure acts along that normal and tractions along the
//! tangent.
//!
//! **Bodies.** For their elastic displacements the bodies are prisms along x
//! ([`half_space::conformal::numbers`]). Their sections are those of rail and wheel round the
//! patch, over the same lengths from the points where the normal at the patch's reference meets
//! both. They extend as far as [`AROUND`] beyond the patch, or until they have turned by
//! [`MOST_TURN`], and are straight from there. Influence numbers are kept for the heights of one
//! position, with room for a patch that grows.
//!
//! **Rigid slip** of a row belongs to its own origin and axes. With the creepages (ξ_j, η_j, φ_j)
//! there, from [`super::creepage`] with the row's own Q, it is (ξ_j, η_j + φ_j x). [`RowSlip`]
//! holds its difference from the slip of the plane through the reference.
//!
//! Source: Vollebregt and Segal, Vehicle System Dynamics 52 (2014) suppl. 455, for contact on a
//! curved surface. They take the surface from the deformed bodies and the influence numbers from
//! finite elements; for measured profiles CONTACT takes them from rotated half-spaces.

use super::creepage::{NotRolling, Rolling, RowSlip, rolling};
use super::error::TrackError;
use super::fields::{Fields, Load};
use super::local::{Frame, NOTHING, Window, undeformed_distance, wheel_above};
use super::rail::Rail;
use super::settings::Settings;
use super::wheelset::{Motion, Pose, Wheel};
use half_space::conformal::elastic::ElasticPair;
use half_space::conformal::numbers::{InfluenceNumbers, SurfaceGrid};
use half_space::conformal::section::CrossSection;
use half_space::difference::Difference;
use half_space::normal::{NormalContact, NormalError};
use nalgebra::Vector3;
use std::f64::consts::{PI, TAU};
use std::ops::Range;
use std::sync::Arc;

/// Distance beyond a patch to which the sections of the bodies are followed [m].
const AROUND: f64 = 30e-3;
/// Largest angle by which the sections turn from the reference of the patch [rad].
const MOST_TURN: f64 = 0.45 * PI;
/// Margin for a patch that grows: share of its elements, and number of elements.
const ROOM: (f64, usize) = (0.1, 3);
/// Limit of elements times rows. Influence numbers of every pair of rows take 150 bytes each.
const MOST: f64 = 3e7;

/// Influence numbers of the patches of one position.
#[derive(Debug, Default)]
pub(super) struct KnownNumbers {
    /// Influence numbers, each with the number of its first row.
    known: Vec<(i64, Arc<InfluenceNumbers>)>,
}

/// A patch on a curved surface.
#[derive(Debug)]
pub(super) struct Curved {
    /// Axes of every row of the window.
    rows: Vec<Frame>,
    /// Range of elements in the rows that belong to the patch, in the order of the fields.
    own: Range<usize>,
    elastic: ElasticPair,
}

impl KnownNumbers {
    /// Discards all influence numbers.
    pub(super) fn clear(&mut self) {
        self.known.clear();
    }

    /// Creates a patch in the window around the origin of a frame. Its own rows are `from..end`.
    pub(super) fn patch(
        &mut self,
        frame: &Frame,
        (window, [from, end]): (&Window, [usize; 2]),
        bodies: (&Rail, &Wheel, &Pose),
        settings: &Settings,
    ) -> Result<Curved, TrackError> {
        let counts @ [nx, ny] = [window.counts()[0], end - from];
        let first = frame.element[1] - window.half[1] as i64 + from as i64;
        let holds = |(row, numbers): &&(i64, Arc<InfluenceNumbers>)| {
            let [columns, rows] = numbers.patch().counts;
            nx <= columns && *row <= first && first + ny as i64 <= row + rows as i64
        };
        let known = match self.known.iter().position(|known| holds(&known)) {
            Some(at) => at,
            None => {
                let room = |count: usize| (ROOM.0 * count as f64).ceil() as usize + ROOM.1;
                let first = first - room(ny) as i64;
                let counts = [nx + room(nx), ny + 2 * room(ny)];
                let numbers = numbers(frame, (first, counts), bodies, settings)?;
                self.known.push((first, Arc::new(numbers)));
                self.known.len() - 1
            }
        };
        let (row, numbers) = &self.known[known];
        let (numbers, skipped) = (Arc::clone(numbers), (first - row) as usize);
        let elastic = ElasticPair::new(&settings.materials, numbers, skipped, counts)
            .with_tolerance(settings.pressure_tolerance());
        Ok(Curved { rows: rows(frame, window, bodies), own: from * nx..end * nx, elastic })
    }
}

/// Influence numbers for these counts of elements along x and of rows, beginning with row `first`.
fn numbers(
    frame: &Frame,
    (first, counts): (i64, [usize; 2]),
    (rail, wheel, pose): (&Rail, &Wheel, &Pose),
    settings: &Settings,
) -> Result<InfluenceNumbers, TrackError> {
    let [nx, ny] = counts;
    if nx as f64 * (ny * ny) as f64 > MOST {
        return Err(TrackError::Rows { elements: nx, rows: ny });
    }
    let spacing = settings.sides[1];
    let s = frame.element[1] as f64 * spacing;
    let around = (AROUND / spacing).ceil() as i64;
    let edge = |row: i64| (row as f64 - 0.5) * spacing;
    let at: Vec<f64> = (first - around..=first + ny as i64 + around).map(edge).collect();
    let of_rail = |s: f64| rail.outline.at(s).angle();
    let own = Frame { angle: of_rail(s), ..on_rail(frame, rail, s) };
    let met = wheel_above(&own, (wheel, pose), settings.sides);
    let of_wheel = |s: f64| met.map_or(0.0, |met| met.angle_at(s, wheel, pose));
    let ranges = [rail.outline.range(), wheel.outline.range()];
    let sections = [
        section(
            &at,
            s,
            met.map_or(ranges[1], |met| ranges[1].map(|end| end - met.s + s)),
            &of_wheel,
        ),
        section(&at, s, ranges[0], &of_rail),
    ];
    let patch = SurfaceGrid { counts, sides: settings.sides, first: edge(first) };
    Ok(InfluenceNumbers::new(&settings.materials, &sections, &patch))
}

/// Section of a body round `middle`, from its directions at these lengths. Ends where the body ends
/// or has turned too far.
fn section(
    at: &[f64],
    middle: f64,
    [from, to]: [f64; 2],
    direction: &impl Fn(f64) -> f64,
) -> CrossSection {
    let centre = at.partition_point(|s| *s < middle).min(at.len() - 1);
    let own = direction(at[centre]);
    let reach = |indices: &mut dyn Iterator<Item = usize>| -> Vec<(f64, f64)> {
        let mut last = own;
        let follow = indices.map_while(|index| {
            let s = at[index];
            let found = direction(s);
            let found = found - TAU * ((found - last) / TAU).round();
            last = found;
            ((from..=to).contains(&s) && (found - own).abs() <= MOST_TURN).then_some((s, found))
        });
        follow.collect()
    };
    let mut known = reach(&mut (0..centre).rev());
    known.reverse();
    known.push((at[centre], own));
    known.extend(reach(&mut (centre + 1..at.len())));
    let (at, directions) = known.into_iter().unzip();
    CrossSection::new(at, directions)
}

/// Frame whose origin is the point of the rail at a tape distance [m].
fn on_rail(frame: &Frame, rail: &Rail, s: f64) -> Frame {
    let [y, z] = rail.outline.at(s).position;
    let origin = Vector3::new(frame.origin.x, y, z);
    Frame { origin, reference: origin, ..*frame }
}

/// Axes of every row of a window around the origin of a frame.
fn rows(frame: &Frame, window: &Window, (rail, wheel, pose): (&Rail, &Wheel, &Pose)) -> Vec<Frame> {
    let first = frame.element[1] - window.half[1] as i64;
    let row = |j: usize| {
        let row = first + j as i64;
        let s = row as f64 * window.sides[1];
        let angle = rail.outline.at(s).angle();
        let own = Frame { angle, element: [frame.element[0], row], ..on_rail(frame, rail, s) };
        let angle = match wheel_above(&own, (wheel, pose), window.sides) {
            Some(met) => 0.5 * (angle + met.angle),
            None => angle,
        };
        Frame { angle, ..own }
    };
    (0..window.counts()[1]).map(row).collect()
}

impl Curved {
    /// Solves the pressure under which the gap closes [Pa], starting from the present pressure.
    pub(super) fn press(
        &mut self,
        gap: &[f64],
        pressure: &mut [f64],
    ) -> Result<NormalContact, NormalError> {
        self.elastic.press(&gap[self.own.clone()], &mut pressure[self.own.clone()])
    }

    /// Gap opening by the tractions [m].
    pub(super) fn opening(&mut self, [x, s]: &[Vec<f64>; 2], opening: &mut [f64]) {
        let own = || self.own.clone();
        self.elastic.opening([&x[own()], &s[own()]], &mut opening[own()]);
    }

    /// Slip of a step under these tractions and this pressure, in excess of that of half-spaces
    /// [m].
    pub(super) fn elastic_slip(
        &mut self,
        [x, s]: &[Vec<f64>; 2],
        pressure: &[f64],
        difference: Difference,
    ) -> [Vec<f64>; 2] {
        let mut slip = [0, 1].map(|_| vec![0.0; pressure.len()]);
        let own = || self.own.clone();
        let [slip_x, slip_s] = &mut slip;
        let slips = [&mut slip_x[own()], &mut slip_s[own()]];
        self.elastic.slip_besides(difference, [&x[own()], &s[own()]], &pressure[own()], slips);
        slip
    }

    /// Undeformed distance of the elements of a window along the normals of its rows [m].
    pub(super) fn distance(&self, window: &Window, bodies: (&Rail, &Wheel, &Pose)) -> Vec<f64> {
        let row = Window { half: [window.half[0], 0], ..*window };
        let of = |frame: &Frame| {
            let [distance, _] = undeformed_distance(frame, &row, bodies);
            distance
        };
        self.rows.iter().flat_map(of).collect()
    }

    /// Sum over the elements of the vertical components of a field along the normals [Pa] and of
    /// one along the tangents.
    pub(super) fn vertical(&self, normal: &[f64], tangent: Option<&[f64]>) -> f64 {
        let count = normal.len() / self.rows.len();
        let sum = |field: &[f64], row: usize| -> f64 {
            field[row * count..(row + 1) * count].iter().sum()
        };
        let of = |(row, frame): (usize, &Frame)| {
            let (sin, cos) = frame.angle.sin_cos();
            sum(normal, row) * cos + tangent.map_or(0.0, |field| sum(field, row) * sin)
        };
        self.rows.iter().enumerate().map(of).sum()
    }

    /// Rigid slip of the rows in excess of that of the plane patch; `lowest` are the least
    /// distances of the rows [m].
    pub(super) fn rigid_slip(
        &self,
        plane: (&Window, &Rolling),
        lowest: &[f64],
        (rail, pose, motion): (&Rail, &Pose, &Motion),
    ) -> Result<Vec<RowSlip>, NotRolling> {
        let (window, Rolling { creepage: [xi, eta, phi], speed, .. }) = plane;
        let row = |(j, (frame, lowest)): (usize, (&Frame, &f64))| {
            let approach = if *lowest < NOTHING { -lowest } else { 0.0 };
            let own = rolling(frame, approach, rail, pose, motion)?;
            let [x, s, spin] = own.creepage.map(|part| part * own.speed / speed);
            let along = window.along(1, j);
            Ok(RowSlip { slip: [x - (xi - phi * along), s - eta], spin: spin - phi })
        };
        self.rows.iter().zip(lowest).enumerate().map(row).collect()
    }

    /// Forces and moments on the wheel about the origin of the patch's axes, in these axes.
    pub(super) fn load(&self, frame: &Frame, fields: &Fields) -> Load {
        let grid = fields.grid();
        let [_, tangent, normal] = frame.axes();
        let mut load = Load::default();
        for (at, p) in fields.pressure.iter().enumerate().filter(|(_, p)| **p > 0.0) {
            let row = &self.rows[at / grid.ni];
            let (sin, cos) = (row.angle - frame.angle).sin_cos();
            let [px, ps] = [fields.traction[0][at], fields.traction[1][at]];
            let force = Vector3::new(px, ps * cos - p * sin, ps * sin + p * cos);
            let off = row.origin - frame.origin;
            let place = Vector3::new(grid.x(at % grid.ni), off.dot(&tangent), off.dot(&normal));
            let moment = place.cross(&force);
            for k in 0..3 {
                load.force[k] += force[k];
                load.moment[k] += moment[k];
            }
        }
        let area = grid.element_area();
        load.force.iter_mut().chain(&mut load.moment).for_each(|sum| *sum *= area);
        load
    }
}
