//! Where a wheel and a rail penetrate each other as they are, undeformed: the regions in which they may touch.
//!
//! The rail is cut at the tape distances s_j = j Δs, whole numbers j. There its normal meets the shadow of the
//! wheel ([`super::silhouette`]) at the gap g_j, negative where the bodies penetrate, at the place x_j along the
//! track. Rows with g_j < 0 that follow each other are a region; in each of them the wheel, of the radius of
//! curvature R_j along x, penetrates over |x − x_j| < √(2 R_j |g_j|). As elastic displacements only open the gap,
//! no place outside can be in contact.

use super::rail::Rail;
use super::region::{Cuts, Joining, Penetrated, Region, grouped};
use super::silhouette::Shadow;
use nalgebra::Vector3;

/// Gaps beyond this are not looked at [m].
const FAR: f64 = 0.02;
/// Cosine of the steepest row that a wheel stands on.
const STEEPEST: f64 = 0.02;

/// A row of the rail.
#[derive(Clone, Copy, Debug)]
struct Row {
    place: [f64; 2],
    /// Unit tangent.
    tangent: [f64; 2],
    angle: f64,
}

/// The rail, cut into rows.
#[derive(Clone, Debug)]
pub struct Rows {
    first: i64,
    rows: Vec<Row>,
}

/// What is between the bodies at a row.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Gap {
    gap: f64,
    x: f64,
    radius: f64,
}

const OPEN: Gap = Gap { gap: f64::INFINITY, x: 0.0, radius: 0.0 };

/// The gaps of a pair, and memory for them.
#[derive(Clone, Debug, Default)]
pub struct Search {
    gaps: Vec<Gap>,
}

impl Rows {
    /// The rows of a rail at whole multiples of `spacing` [m].
    #[must_use]
    pub fn of(rail: &Rail, spacing: f64) -> Self {
        let [from, to] = rail.outline.range();
        let (first, last) = ((from / spacing).ceil() as i64, (to / spacing).floor() as i64);
        let mut near = 0;
        let row = |j: i64| {
            let place = rail.outline.at_near(j as f64 * spacing, &mut near);
            let [y, z] = place.tangent;
            let length = y.hypot(z);
            Row { place: place.position, tangent: [y / length, z / length], angle: place.angle() }
        };
        Self { first, rows: (first..=last).map(row).collect() }
    }
}

/// By how much a wheel with this shadow, its middle here, has to be lowered until it touches [m], negative if
/// it penetrates already; `None` if it is beside the rail. The distance along z is least where it touches, so that
/// rows are near enough.
#[must_use]
pub fn clearance(rows: &Rows, shadow: &[Shadow], middle: Vector3<f64>) -> Option<f64> {
    let mut at = 0;
    let mut least = f64::INFINITY;
    let across = |k: usize| shadow[k].place[1] + middle.y;
    for row in rows.rows.iter().filter(|row| row.tangent[0] > STEEPEST) {
        let [y, z] = row.place;
        while at + 2 < shadow.len() && across(at + 1) < y {
            at += 1;
        }
        while at > 0 && across(at) > y {
            at -= 1;
        }
        if shadow.len() < 2 || across(at) > y || across(at + 1) < y {
            continue;
        }
        let share = (y - across(at)) / (across(at + 1) - across(at));
        let [low, high] = [at, at + 1].map(|k| shadow[k].place[2] + middle.z);
        least = least.min(low + share * (high - low) - z);
    }
    least.is_finite().then_some(least)
}

impl Search {
    /// The patches of a wheel with this shadow, its middle here, in the order of their places along the tape,
    /// whose rows are `spacing` apart [m]; they are held apart at these rows, or where the criterion says.
    pub fn patches(
        &mut self,
        rows: &Rows,
        (shadow, middle): (&[Shadow], Vector3<f64>),
        spacing: f64,
        cuts: &Cuts,
    ) -> Vec<Region> {
        self.measure(rows, shadow, [middle.y, middle.z]);
        let penetrated: Vec<Region> = self.rows(rows, spacing, middle.x).collect();
        grouped(&penetrated, cuts)
    }

    /// Where patches are apart by the criterion, at the gaps that were measured last.
    #[must_use]
    pub fn cuts(&self, rows: &Rows, spacing: f64, joining: &Joining) -> Vec<i64> {
        let runs = self.runs(rows, spacing, 0.0);
        let apart = runs.windows(2).filter(|pair| !pair[0].joins(&pair[1], spacing, joining));
        // Where they are farthest from touching.
        let widest = |pair: &[Region]| {
            let between = pair[0].rows[1] + 1..pair[1].rows[0];
            let gap = |j: &i64| self.gaps[(j - rows.first) as usize].gap;
            between.max_by(|a, b| gap(a).total_cmp(&gap(b))).unwrap_or(pair[1].rows[0])
        };
        apart.map(widest).collect()
    }

    /// The gaps of all rows: from one row that the shadow is above, along both.
    fn measure(&mut self, rows: &Rows, shadow: &[Shadow], middle: [f64; 2]) {
        self.gaps.clear();
        self.gaps.resize(rows.rows.len(), OPEN);
        let count = rows.rows.len();
        let tries = 16.min(count);
        let start = (0..tries).find_map(|k| {
            // From the middle outwards.
            let step = (k as i64 + 1) / 2 * if k % 2 == 0 { 1 } else { -1 };
            let at = (count as i64 / 2 + step * (count / tries) as i64).clamp(0, count as i64 - 1);
            let row = &rows.rows[at as usize];
            nearest(row, shadow, middle).map(|segment| (at as usize, segment))
        });
        let Some((start, segment)) = start else { return };
        let mut at = segment;
        for j in start..count {
            self.gaps[j] = follow(&rows.rows[j], shadow, middle, &mut at);
        }
        at = segment;
        for j in (0..start).rev() {
            self.gaps[j] = follow(&rows.rows[j], shadow, middle, &mut at);
        }
    }

    /// Rows that penetrate, those that follow each other as one.
    fn runs(&self, rows: &Rows, spacing: f64, middle: f64) -> Vec<Region> {
        let mut found: Vec<Region> = Vec::new();
        for region in self.rows(rows, spacing, middle) {
            match found.last_mut() {
                Some(last) if last.rows[1] + 1 == region.rows[0] => last.join(&region),
                _ => found.push(region),
            }
        }
        found
    }

    /// The rows that penetrate.
    fn rows<'a>(
        &'a self,
        rows: &'a Rows,
        spacing: f64,
        middle: f64,
    ) -> impl Iterator<Item = Region> + 'a {
        let ends = |at: Option<usize>| {
            at.and_then(|at| self.gaps.get(at)).is_none_or(|gap| gap.gap == f64::INFINITY)
        };
        let all = self.gaps.iter().zip(&rows.rows).enumerate();
        all.filter(|(_, (gap, _))| gap.gap < 0.0).map(move |(index, (gap, row))| {
            let j = rows.first + index as i64;
            Region::of(&Penetrated {
                row: j,
                s: j as f64 * spacing,
                angle: row.angle,
                x: middle + gap.x,
                penetration: -gap.gap,
                radius: gap.radius,
                at_end: ends(index.checked_sub(1)) || ends(Some(index + 1)),
            })
        })
    }
}

/// A point of the shadow from a row, along its tangent and its normal [m].
fn from_row(row: &Row, point: &Shadow, middle: [f64; 2]) -> [f64; 2] {
    let [y, z] =
        [point.place[1] + middle[0] - row.place[0], point.place[2] + middle[1] - row.place[1]];
    let [along, up] = row.tangent;
    [y * along + z * up, z * along - y * up]
}

/// The segment of the shadow that the row's normal meets nearest to the row.
fn nearest(row: &Row, shadow: &[Shadow], middle: [f64; 2]) -> Option<usize> {
    let meets = |pair: &[Shadow]| {
        let [one, next] = [0, 1].map(|k| from_row(row, &pair[k], middle));
        (one[0] <= 0.0 && next[0] > 0.0).then(|| one[1].abs().min(next[1].abs()))
    };
    let found = shadow.windows(2).enumerate().filter_map(|(k, pair)| Some((k, meets(pair)?)));
    found.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(k, _)| k)
}

/// The gap of a row whose normal meets the shadow near the segment `at`, which becomes the one that it meets.
fn follow(row: &Row, shadow: &[Shadow], middle: [f64; 2], at: &mut usize) -> Gap {
    let along = |k: usize| from_row(row, &shadow[k], middle)[0];
    let mut k = *at;
    while k + 1 < shadow.len() && along(k + 1) <= 0.0 {
        k += 1;
    }
    while k > 0 && along(k) > 0.0 {
        k -= 1;
    }
    *at = k;
    if k + 1 >= shadow.len() {
        return OPEN;
    }
    let [one, next] = [k, k + 1].map(|k| from_row(row, &shadow[k], middle));
    if one[0] > 0.0 || next[0] <= 0.0 {
        return OPEN;
    }
    let share = -one[0] / (next[0] - one[0]);
    let between = |one: f64, next: f64| one + share * (next - one);
    let gap = between(one[1], next[1]);
    if gap > FAR {
        return OPEN;
    }
    let [from, to] = [&shadow[k], &shadow[k + 1]];
    let x = between(from.place[0], to.place[0]);
    Gap { gap, x, radius: between(from.radius, to.radius) }
}
