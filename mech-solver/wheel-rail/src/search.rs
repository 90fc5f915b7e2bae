//! Search for the regions in which a wheel and a rail penetrate each other undeformed, and may
//! therefore touch.
//!
//! The rail is cut into rows ([`super::rows`]). The normal of row j meets the silhouette of the
//! wheel ([`super::silhouette`]) at the gap g_j, negative where the bodies penetrate, and at the
//! position x_j along the track. If the rail is no prism or the wheel not round, the least gap over
//! x is used instead ([`super::columns`]). Consecutive rows with g_j < 0 form a region. In each of
//! them the wheel, with the radius of curvature R_j along x, penetrates over |x − x_j| < √(2
//! R_j |g_j|). Elastic displacements only open the gap, so that no point outside can be in contact.

use super::columns::Columns;
use super::gap::{Gap, OPEN};
use super::region::{Cuts, Joining, Penetrated, Region, grouped};
use super::rows::{Intersection, Rows, least_above};
use super::silhouette::SilhouettePoint;
use nalgebra::Vector3;

/// Representation of the wheel for the search, relative to the middle of the wheelset.
#[derive(Debug)]
pub enum WheelView<'a> {
    /// Silhouette: a round wheel on a prism.
    SilhouettePoint(&'a [SilhouettePoint]),
    /// Cuts across the rail.
    Columns(&'a mut Columns),
}

/// Gaps of all rows, with scratch buffers.
#[derive(Clone, Debug, Default)]
pub struct Search {
    gaps: Vec<Gap>,
    met: Vec<Option<Intersection>>,
}

/// Distance by which a wheel with this silhouette and its middle here must be lowered until it
/// touches [m]. Negative if it penetrates already; `None` if it is beside the rail. The distance
/// along z is stationary at the touching point, so that the spacing of rows suffices.
#[must_use]
pub fn clearance(rows: &Rows, shadow: &[SilhouettePoint], middle: Vector3<f64>) -> Option<f64> {
    let point = |k: usize| {
        let [_, y, z] = shadow[k].place;
        [y + middle.y, z + middle.z]
    };
    least_above(rows.standing(), shadow.len(), &point)
}

impl Search {
    /// Patches of a wheel with its middle here, in the order of their tape distances, on rows
    /// `spacing` apart [m]. They are separated at the given rows, or by the criterion.
    pub fn patches(
        &mut self,
        rows: &Rows,
        (wheel, middle): (WheelView<'_>, Vector3<f64>),
        spacing: f64,
        cuts: &Cuts,
    ) -> Vec<Region> {
        match wheel {
            WheelView::SilhouettePoint(shadow) => self.measure(rows, shadow, [middle.y, middle.z]),
            WheelView::Columns(columns) => {
                columns.gaps(rows, [middle.y, middle.z], &mut self.gaps);
            }
        }
        let penetrated: Vec<Region> = self.rows(rows, spacing, middle.x).collect();
        grouped(&penetrated, cuts)
    }

    /// Cuts between patches by the criterion, from the gaps measured last.
    #[must_use]
    pub fn cuts(&self, rows: &Rows, spacing: f64, joining: &Joining) -> Vec<i64> {
        let runs = self.runs(rows, spacing, 0.0);
        let apart = runs.windows(2).filter(|pair| !pair[0].joins(&pair[1], spacing, joining));
        // Cut where the gap is largest.
        let widest = |pair: &[Region]| {
            let between = pair[0].rows[1] + 1..pair[1].rows[0];
            let gap = |j: &i64| self.gaps[(j - rows.first) as usize].gap;
            between.max_by(|a, b| gap(a).total_cmp(&gap(b))).unwrap_or(pair[1].rows[0])
        };
        apart.map(widest).collect()
    }

    /// Measures the gaps of all rows to a silhouette.
    fn measure(&mut self, rows: &Rows, shadow: &[SilhouettePoint], middle: [f64; 2]) {
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

    /// Penetrated rows, with consecutive ones joined.
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

    /// Penetrated rows.
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
