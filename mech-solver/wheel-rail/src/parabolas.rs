//! The undeformed distance of a patch, row by row as parabolas: h = g + A (x − x₀)².
//!
//! Along a row a wheel is almost a circle, and the parabola is off it by (x − x₀)⁴ A³: 3e-5 of h at
//! 5 mm beside a wheel of 0.46 m. Approximate theories of the normal contact use nothing but these
//! rows.

use super::local::{NOTHING, RowDistances, Window};

/// Parabola of one row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Parabola {
    /// Least distance g, negative where the undeformed bodies penetrate [m].
    pub(super) gap: f64,
    /// Position x₀ of the least distance [m].
    pub(super) place: f64,
    /// Half the curvature, A [1/m].
    pub(super) bend: f64,
}

impl Parabola {
    /// Interpolates linearly between this parabola and the next.
    fn towards(&self, next: &Self, share: f64) -> Self {
        let between = |one: f64, other: f64| one + share * (other - one);
        Self {
            gap: between(self.gap, next.gap),
            place: between(self.place, next.place),
            bend: between(self.bend, next.bend),
        }
    }
}

/// The rows of a patch, in the axes of the patch.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Parabolas {
    /// One parabola per row of the window; `None` where a body is missing.
    pub(super) rows: Vec<Option<Parabola>>,
    /// Range of rows of the patch, end exclusive. Other rows belong to other patches.
    pub(super) own: [usize; 2],
    /// Row of t = 0, and the spacing of rows [m].
    middle: usize,
    pub(super) spacing: f64,
}

/// Deepest penetration of the undeformed bodies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Deepest {
    /// Lowest row, and t of the minimum [m].
    pub(super) row: usize,
    pub(super) along: f64,
    /// Interpolated parabola at the minimum.
    pub(super) parabola: Parabola,
}

impl Parabolas {
    /// Parabolas of a window; `own` is the range of rows of the patch.
    pub(super) fn of(window: &Window, rows: &[Option<RowDistances>], own: [usize; 2]) -> Self {
        let parabola = |three: &RowDistances| {
            three.parabola().map(|[gap, place, bend]| Parabola { gap, place, bend })
        };
        let rows = rows.iter().map(|three| three.as_ref().and_then(parabola)).collect();
        Self { rows, own, middle: window.half[1], spacing: window.sides[1] }
    }

    /// Undeformed distance of the patch's elements [m].
    pub(super) fn distance(&self, window: &Window) -> Vec<f64> {
        let [nx, _] = window.counts();
        let mut distance = vec![NOTHING; window.points()];
        for (row, own) in self.of_patch() {
            for (i, height) in distance[row * nx..(row + 1) * nx].iter_mut().enumerate() {
                let off = window.along(0, i) - own.place;
                *height = own.gap + own.bend * off * off;
            }
        }
        distance
    }

    /// Opens the gap of every row by the opening of the element where the row is lowest [m].
    pub(super) fn opened(&self, window: &Window, opening: &[f64]) -> Self {
        let [nx, _] = window.counts();
        let mut opened = self.clone();
        for (own, opening) in opened.rows.iter_mut().zip(opening.chunks_exact(nx)) {
            if let Some(own) = own {
                let column = own.place / window.sides[0] + window.half[0] as f64;
                own.gap += opening[(column.round().max(0.0) as usize).min(nx - 1)];
            }
        }
        opened
    }

    /// t of a row [m].
    pub(super) fn along(&self, row: usize) -> f64 {
        (row as f64 - self.middle as f64) * self.spacing
    }

    /// Parabola of a row, if there is one.
    pub(super) fn at(&self, row: Option<usize>) -> Option<&Parabola> {
        self.rows.get(row?)?.as_ref()
    }

    /// Rows of the patch that have a parabola.
    pub(super) fn of_patch(&self) -> impl Iterator<Item = (usize, &Parabola)> {
        let [first, end] = self.own;
        let rows = self.rows.iter().enumerate().skip(first).take(end.saturating_sub(first));
        rows.filter_map(|(row, parabola)| Some((row, parabola.as_ref()?)))
    }

    /// Deepest penetration of the patch, by a parabola through three rows; `None` if the bodies do
    /// not penetrate.
    pub(super) fn deepest(&self) -> Option<Deepest> {
        let least = |a: &(usize, &Parabola), b: &(usize, &Parabola)| a.1.gap.total_cmp(&b.1.gap);
        let (row, own) = self.of_patch().min_by(least).filter(|(_, own)| own.gap < 0.0)?;
        let beside = [row.checked_sub(1), Some(row + 1)].map(|row| self.at(row));
        let [Some(before), Some(after)] = beside else {
            return Some(Deepest { row, along: self.along(row), parabola: *own });
        };
        let [slope, bend] = [before.gap - after.gap, before.gap - 2.0 * own.gap + after.gap];
        let share = if bend > 0.0 { (0.5 * slope / bend).clamp(-0.5, 0.5) } else { 0.0 };
        let next = if share < 0.0 { before } else { after };
        let gap = own.gap - 0.25 * slope * share;
        let parabola = Parabola { gap, ..own.towards(next, share.abs()) };
        Some(Deepest { row, along: self.along(row) + share * self.spacing, parabola })
    }
}
