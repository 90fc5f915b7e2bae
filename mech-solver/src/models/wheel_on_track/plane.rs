//! The grid over the rail's surface that holds the patches of all rows.

use super::case::{Case, Position};
use crate::terms::Place;
use crate::track::developed::Developed;
use crate::track::patch::Patch;
use crate::track::settings::Normal;
use proto::configuration::{Configuration, Refusal};
use proto::grid::Structured;
use proto::model::StepError;

/// How much larger elements are by which the patches of a history are looked for.
const COARSER: f64 = 3.0;
/// Free elements round the patches, of those that they were looked for with.
const MARGIN: usize = 2;
/// The same where a patch may jump from element to element, and with it the force.
const MARGIN_OF_JUMPS: usize = 5;

/// Elements by their numbers along x and along the tape; element (0, 0) is at the origin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Plane {
    /// First element.
    first: [i64; 2],
    /// Behind the last element.
    end: [i64; 2],
    sides: [f64; 2],
    /// Elements of the patches of a position, at most and about.
    pub(super) elements: f64,
    /// Half length and half width of the patch that carries most [m], and y of the highest pressure of all.
    semi_axes: [f64; 2],
    peak: Peak,
}

/// The highest pressure [Pa], and where it is along the tape [m].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Peak {
    pressure: f64,
    y: f64,
}

impl Peak {
    fn higher(self, other: Self) -> Self {
        if other.pressure > self.pressure { other } else { self }
    }

    fn of(patch: &Patch) -> Self {
        let fields = &patch.fields;
        let highest = fields.pressure.iter().enumerate().max_by(|a, b| a.1.total_cmp(b.1));
        highest.map_or_else(Self::default, |(at, pressure)| {
            let row = fields.first[1] + (at / fields.counts[0]) as i64;
            Self { pressure: *pressure, y: row as f64 * fields.sides[1] }
        })
    }
}

/// Half length and half width of what is in contact [m].
fn half_sizes(patch: &Patch) -> [f64; 2] {
    let fields = &patch.fields;
    let mut ranges = [[usize::MAX, 0]; 2];
    for (at, _) in fields.pressure.iter().enumerate().filter(|(_, p)| **p > 0.0) {
        for (range, place) in ranges.iter_mut().zip([at % fields.counts[0], at / fields.counts[0]])
        {
            *range = [range[0].min(place), range[1].max(place)];
        }
    }
    [0, 1].map(|k| {
        let [first, last] = ranges[k];
        0.5 * (last + 1).saturating_sub(first) as f64 * fields.sides[k]
    })
}

impl Plane {
    /// That of a configuration: of its position, or of all rows.
    ///
    /// # Errors
    /// No position has a contact.
    pub(super) fn of(configuration: &Configuration, case: &Case) -> Result<Self, Refusal> {
        let rows = configuration.histories.as_ref().map_or(1, |histories| histories.times.len());
        let coarser = if rows > 1 { COARSER } else { 1.0 };
        let margin = match case.settings.normal {
            Normal::HalfSpace => MARGIN,
            Normal::Kpec | Normal::Analyn => MARGIN_OF_JUMPS,
        };
        let mut wheel = case.wheel_on_rail(coarser)?;
        let mut params = configuration.case.clone();
        let (mut found, mut failed): (Option<Self>, _) = (None, None);
        for row in 0..rows {
            if let Some(histories) = &configuration.histories {
                histories.put_row(&mut params, row);
            }
            let Position { motion, deviation, vertical, friction } = case.position(&params)?;
            match wheel.solve(&motion, &deviation, vertical, &|_| friction) {
                Ok(solved) if solved.patches.is_empty() => {}
                Ok(solved) => {
                    let own = Self::around(&solved.patches, coarser, margin);
                    found = Some(found.map_or(own, |other| other.and(&own)));
                }
                Err(error) => failed = Some(error),
            }
        }
        let plane = found.ok_or_else(|| {
            let apart = || "the bodies do not touch".to_owned();
            let reason = failed.map_or_else(apart, |error| error.to_string());
            let fix = "check the dimensions of track and wheelset, and the load";
            Refusal::new("wheelset", reason, fix)
        })?;
        Ok(Self { sides: case.settings.sides, ..plane })
    }

    /// Round patches of elements so many times larger.
    fn around(patches: &[Patch], coarser: f64, margin: usize) -> Self {
        let Developed { first, counts, .. } = Developed::of(patches, margin);
        let finer = |at: i64| (coarser * at as f64).round() as i64;
        let end = [0, 1].map(|k| finer(first[k] + counts[k] as i64));
        let of = |patch: &Patch| (patch.fields.counts[0] * patch.fields.counts[1]) as f64;
        let elements = coarser * coarser * patches.iter().map(of).sum::<f64>();
        let load = |patch: &&Patch| patch.load.force[2];
        let most = patches.iter().max_by(|a, b| load(a).total_cmp(&load(b)));
        Self {
            first: first.map(finer),
            end,
            sides: [0.0; 2],
            elements,
            semi_axes: most.map_or([0.0; 2], half_sizes),
            peak: patches.iter().map(Peak::of).fold(Peak::default(), Peak::higher),
        }
    }

    fn and(&self, other: &Self) -> Self {
        Self {
            first: [0, 1].map(|k| self.first[k].min(other.first[k])),
            end: [0, 1].map(|k| self.end[k].max(other.end[k])),
            sides: self.sides,
            elements: self.elements.max(other.elements),
            semi_axes: [0, 1].map(|k| self.semi_axes[k].max(other.semi_axes[k])),
            peak: self.peak.higher(other.peak),
        }
    }

    /// Where stresses are looked for.
    pub(super) fn place(&self) -> Place {
        Place { grid: self.grid(), semi_axes: self.semi_axes, peak_y: self.peak.y }
    }

    fn counts(&self) -> [usize; 2] {
        [0, 1].map(|k| usize::try_from(self.end[k] - self.first[k]).unwrap_or(0))
    }

    /// The grid of the fields.
    pub(super) fn grid(&self) -> Structured {
        let ([dx, dy], [ni, nj]) = (self.sides, self.counts());
        let [x0, y0] = [0, 1].map(|k| self.first[k] as f64 * self.sides[k]);
        Structured::contact_plane(x0, y0, dx, dy, ni, nj)
    }

    /// The fields of patches on it.
    ///
    /// # Errors
    /// A patch reaches beyond it.
    pub(super) fn fields(&self, patches: &[Patch]) -> Result<Developed, StepError> {
        let own = Developed::of(patches, 0);
        let end = |k: usize| own.first[k] + own.counts[k] as i64;
        let inside = |k: usize| own.first[k] >= self.first[k] && end(k) <= self.end[k];
        match patches.is_empty() || (inside(0) && inside(1)) {
            true => Ok(Developed::on(patches, self.first, self.counts())),
            false => {
                let reason =
                    "a patch reaches beyond the grid that was laid for the rows of the history";
                Err(StepError::NoSolution(reason.to_owned()))
            }
        }
    }
}
