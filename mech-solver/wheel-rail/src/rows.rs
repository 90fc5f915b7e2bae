//! The rail, cut across into rows, and what meets a row along its normal.
//!
//! The rail is cut at the tape distances s_j = j Δs, whole numbers j, of its profile; a rail that varies at the column
//! at which the wheel touches first.

use super::rail::Rail;

/// Gaps beyond this are not looked at [m].
const FAR: f64 = 0.02;
/// Cosine of the steepest row that a wheel stands on.
const STEEPEST: f64 = 0.02;

/// A row of the rail.
#[derive(Clone, Copy, Debug)]
pub(super) struct Row {
    pub(super) place: [f64; 2],
    /// Unit tangent.
    tangent: [f64; 2],
    pub(super) angle: f64,
}

/// The rail, cut into rows.
#[derive(Clone, Debug)]
pub struct Rows {
    pub(super) first: i64,
    pub(super) rows: Vec<Row>,
}

/// Place where a row's normal meets a curve, between its points `at` and `at + 1`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Intersection {
    pub(super) at: usize,
    /// Share of the way to the next point that is before it.
    pub(super) share: f64,
    /// Height over the row along its normal [m].
    pub(super) height: f64,
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

    /// The places of rows on which a wheel can stand, y rising.
    pub(super) fn standing(&self) -> impl Iterator<Item = [f64; 2]> + '_ {
        self.rows.iter().filter(|row| row.tangent[0] > STEEPEST).map(|row| row.place)
    }

    /// For every row where it meets a curve of `count` points, `point` gives them in track axes, s rising; `None` beyond
    /// its ends and far from it.
    pub(super) fn meet(
        &self,
        count: usize,
        point: &impl Fn(usize) -> [f64; 2],
        met: &mut Vec<Option<Intersection>>,
    ) {
        let rows = self.rows.len();
        met.clear();
        met.resize(rows, None);
        let tries = 16.min(rows);
        let start = (0..tries).find_map(|k| {
            // From the middle outwards.
            let step = (k as i64 + 1) / 2 * if k % 2 == 0 { 1 } else { -1 };
            let at = (rows as i64 / 2 + step * (rows / tries) as i64).clamp(0, rows as i64 - 1);
            self.rows[at as usize].nearest(count, point).map(|segment| (at as usize, segment))
        });
        let Some((start, segment)) = start else { return };
        let mut at = segment;
        for (row, met) in self.rows.iter().zip(met.iter_mut()).skip(start) {
            *met = row.follow(count, point, &mut at);
        }
        at = segment;
        for (row, met) in self.rows.iter().zip(met.iter_mut()).take(start).rev() {
            *met = row.follow(count, point, &mut at);
        }
    }
}

impl Row {
    /// A point of the plane y, z from the row, along its tangent and its normal [m].
    fn seen_from_here(&self, point: [f64; 2]) -> [f64; 2] {
        let [y, z] = [point[0] - self.place[0], point[1] - self.place[1]];
        let [along, up] = self.tangent;
        [y * along + z * up, z * along - y * up]
    }

    /// The segment of a curve that the row's normal meets nearest to the row.
    fn nearest(&self, count: usize, point: &impl Fn(usize) -> [f64; 2]) -> Option<usize> {
        let meets = |k: usize| {
            let [one, next] = [k, k + 1].map(|k| self.seen_from_here(point(k)));
            (one[0] <= 0.0 && next[0] > 0.0).then(|| one[1].abs().min(next[1].abs()))
        };
        let found = (0..count.saturating_sub(1)).filter_map(|k| Some((k, meets(k)?)));
        found.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(k, _)| k)
    }

    /// Place where the row's normal meets a curve near the segment `at`, which becomes the one that it meets.
    fn follow(
        &self,
        count: usize,
        point: &impl Fn(usize) -> [f64; 2],
        at: &mut usize,
    ) -> Option<Intersection> {
        let along = |k: usize| self.seen_from_here(point(k))[0];
        let mut k = *at;
        while k + 1 < count && along(k + 1) <= 0.0 {
            k += 1;
        }
        while k > 0 && along(k) > 0.0 {
            k -= 1;
        }
        *at = k;
        if k + 1 >= count {
            return None;
        }
        let [one, next] = [k, k + 1].map(|k| self.seen_from_here(point(k)));
        if one[0] > 0.0 || next[0] <= 0.0 {
            return None;
        }
        let share = -one[0] / (next[0] - one[0]);
        let height = one[1] + share * (next[1] - one[1]);
        (height <= FAR).then_some(Intersection { at: k, share, height })
    }
}

/// The least height of a curve above places, y rising in both: of a curve of `count` points; `None` where they are beside
/// each other.
pub(super) fn least_above(
    places: impl Iterator<Item = [f64; 2]>,
    count: usize,
    point: &impl Fn(usize) -> [f64; 2],
) -> Option<f64> {
    if count < 2 {
        return None;
    }
    let (mut at, mut least) = (0, f64::INFINITY);
    let across = |k: usize| point(k)[0];
    for [y, z] in places {
        while at + 2 < count && across(at + 1) < y {
            at += 1;
        }
        while at > 0 && across(at) > y {
            at -= 1;
        }
        if across(at) > y || across(at + 1) < y {
            continue;
        }
        let share = (y - across(at)) / (across(at + 1) - across(at));
        let [low, high] = [at, at + 1].map(|k| point(k)[1]);
        least = least.min(low + share * (high - low) - z);
    }
    least.is_finite().then_some(least)
}
