//! Where a wheel and a rail penetrate each other as they are, undeformed: the regions in which they may touch.
//!
//! The rail is cut into rows ([`super::rows`]). There its normal meets the shadow of the
//! wheel ([`super::silhouette`]) at the gap g_j, negative where the bodies penetrate, at the place x_j along the
//! track; where there is no prism or no round wheel the least gap over x takes its place ([`super::columns`]). Rows with g_j < 0 that follow each other are a region; in each of them the wheel, of the radius of
//! curvature R_j along x, penetrates over |x − x_j| < √(2 R_j |g_j|). As elastic displacements only open the gap,
//! no place outside can be in contact.

use super::columns::Columns;
use super::gap::{Gap, OPEN};
use super::region::{Cuts, Joining, Penetrated, Region, grouped};
use super::rows::{Intersection, Rows, least_above};
use super::silhouette::Shadow;
use nalgebra::Vector3;

/// The wheel as it is seen from the rail, from the middle of the wheelset.
#[derive(Debug)]
pub enum Seen<'a> {
    /// As its shadow: a round wheel on a prism.
    Shadow(&'a [Shadow]),
    /// Cut across the rail.
    Columns(&'a mut Columns),
}

/// The gaps of a pair, and memory for them.
#[derive(Clone, Debug, Default)]
pub struct Search {
    gaps: Vec<Gap>,
    met: Vec<Option<Intersection>>,
}

/// By how much a wheel with this shadow, its middle here, has to be lowered until it touches [m], negative if
/// it penetrates already; `None` if it is beside the rail. The distance along z is least where it touches, so that
/// rows are near enough.
#[must_use]
pub fn clearance(rows: &Rows, shadow: &[Shadow], middle: Vector3<f64>) -> Option<f64> {
    let point = |k: usize| {
        let [_, y, z] = shadow[k].place;
        [y + middle.y, z + middle.z]
    };
    least_above(rows.standing(), shadow.len(), &point)
}

impl Search {
    /// The patches of a wheel that is seen so, its middle here, in the order of their places along the tape,
    /// whose rows are `spacing` apart [m]; they are held apart at these rows, or where the criterion says.
    pub fn patches(
        &mut self,
        rows: &Rows,
        (wheel, middle): (Seen<'_>, Vector3<f64>),
        spacing: f64,
        cuts: &Cuts,
    ) -> Vec<Region> {
        match wheel {
            Seen::Shadow(shadow) => self.measure(rows, shadow, [middle.y, middle.z]),
            Seen::Columns(columns) => {
                columns.gaps(rows, [middle.y, middle.z], &mut self.gaps);
            }
        }
        let penetrated: Vec<Region> = self.rows(rows, spacing, middle.x).collect();
        grouped(&penetrated, cuts)
    }

    /// Cuts between patches by the criterion, at the gaps that were measured last.
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

    /// The gaps of all rows to a shadow.
    fn measure(&mut self, rows: &Rows, shadow: &[Shadow], middle: [f64; 2]) {
        let point = |k: usize| {
            let [_, y, z] = shadow[k].place;
            [y + middle[0], z + middle[1]]
        };
        rows.meet(shadow.len(), &point, &mut self.met);
        let gap = |met: &Option<Intersection>| {
            let Some(Intersection { at, share, height }) = *met else { return OPEN };
            let [from, to] = [&shadow[at], &shadow[at + 1]];
            let between = |one: f64, next: f64| one + share * (next - one);
            let x = between(from.place[0], to.place[0]);
            Gap::round(height, x, between(from.radius, to.radius))
        };
        self.gaps.clear();
        self.gaps.extend(self.met.iter().map(gap));
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
                gap: gap.from(middle),
                at_end: ends(index.checked_sub(1)) || ends(Some(index + 1)),
            })
        })
    }
}
