//! Rows of the rail, and the intersections of their normals with a curve.
//!
//! Rows are cuts of the rail at the tape distances s_j = j Δs of its profile, with whole numbers j.
//! For a rail that varies this is the profile of the column where the wheel touches first.

use super::rail::Rail;

/// Gaps larger than this are ignored [m].
const FAR: f64 = 0.02;
/// Cosine of the steepest row on which a wheel can stand.
const STEEPEST: f64 = 0.02;

/// A row of the rail.
#[derive(Clone, Copy, Debug)]
pub(super) struct Row {
    pub(super) place: [f64; 2],
    /// Unit tangent.
    tangent: [f64; 2],
    pub(super) angle: f64,
}

/// Rail cut into rows.
#[derive(Clone, Debug)]
pub struct Rows {
    pub(super) first: i64,
    pub(super) rows: Vec<Row>,
}

/// Intersection of a row's normal with a curve, between the curve's points `at` and `at + 1`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Intersection {
    pub(super) at: usize,
    /// Position between the two points, as a share of their distance.
    pub(super) share: f64,
    /// Height above the row along its normal [m].
    pub(super) height: f64,
}

impl Rows {
    /// Cuts a rail into rows at whole multiples of `spacing` [m].
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

    /// Positions of the rows on which a wheel can stand, with y rising.
    pub(super) fn standing(&self) -> impl Iterator<Item = [f64; 2]> + '_ {
        self.rows.iter().filter(|row| row.tangent[0] > STEEPEST).map(|row| row.place)
    }

    /// Intersects every row's normal with a curve of `count` points; `point` returns them in track
    /// axes, s rising. `None` beyond the ends of the curve and far from it.
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
    /// Converts a point y, z to coordinates along the tangent and the normal of the row [m].
    fn seen_from_here(&self, point: [f64; 2]) -> [f64; 2] {
        let [y, z] = [point[0] - self.place[0], point[1] - self.place[1]];
        let [along, up] = self.tangent;
        [y * along + z * up, z * along - y * up]
    }

    /// Segment of a curve that the row's normal meets nearest to the row.
    fn nearest(&self, count: usize, point: &impl Fn(usize) -> [f64; 2]) -> Option<usize> {
        let meets = |k: usize| {
            let [one, next] = [k, k + 1].map(|k| self.seen_from_here(point(k)));
            (one[0] <= 0.0 && next[0] > 0.0).then(|| one[1].abs().min(next[1].abs()))
        };
        let found = (0..count.saturating_sub(1)).filter_map(|k| Some((k, meets(k)?)));
        found.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(k, _)| k)
    }

    /// Intersection of the row's normal with a curve near the segment `at`, which receives the
    /// segment found.
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

/// Least height above these positions of a curve with `count` points, y rising in both; `None` if
/// they do not overlap in y.
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
