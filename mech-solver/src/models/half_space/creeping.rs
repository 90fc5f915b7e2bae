//! Bodies whose compliance grows and that are pressed and shifted in place ([`half_space::retarded`]).

use super::case::Case;
use elastic::Elasticity;
use half_space::retarded::{Delay, Field3, Retarded, within_step};
use serde::{Deserialize, Serialize};

/// Bodies that creep, and what is known of the step in hand.
#[derive(Debug)]
pub(super) struct Creeping {
    operators: Retarded,
    delays: Vec<Delay>,
    at_once: Elasticity,
    /// Duration of the step [s].
    duration: f64,
    /// What earlier loads displace at its end: along the normal, x and y [m].
    displaced: Field3,
}

/// What a step leaves for the next one.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(super) struct Crept {
    retarded: Vec<Field3>,
    /// Normal displacement [m].
    normal: Vec<f64>,
    /// Energy over the area of an element: along the normal and along the plane [Pa m].
    stored: [f64; 2],
}

impl Crept {
    /// It belongs to a grid of so many elements, and to as many bodies as another.
    pub(super) fn is_like(&self, other: &Self) -> bool {
        let lengths = |crept: &Self| -> Vec<usize> {
            crept.retarded.iter().flatten().chain([&crept.normal]).map(Vec::len).collect()
        };
        lengths(self) == lengths(other)
    }
}

/// An instant: loads and the displacements by them.
#[derive(Clone, Copy)]
pub(super) struct Instant<'a> {
    pub(super) pressure: &'a [f64],
    pub(super) traction: &'a [Vec<f64>; 2],
    pub(super) displacement: &'a [Vec<f64>; 2],
}

impl<'a> Instant<'a> {
    fn load(&self) -> [&'a [f64]; 3] {
        [self.pressure, &self.traction[0], &self.traction[1]]
    }
}

/// What a step left in the bodies, over the area of an element [Pa m].
#[derive(Clone, Copy, Debug)]
pub(super) struct Kept {
    /// Energy of displacements along the plane before and after.
    pub(super) stored: [f64; 2],
    /// Dissipated along the plane.
    pub(super) along_plane: f64,
    /// Dissipated in all.
    pub(super) dissipated: f64,
}

impl Creeping {
    /// The bodies of a case, and what there is in the beginning, under a pressure that displaces `normal` [m].
    pub(super) fn new(case: &Case, pressure: &[f64], normal: Vec<f64>) -> (Self, Crept) {
        let delays = case.delays.clone();
        let operators = Retarded::new(&case.footprint.grid, &delays);
        let retarded = operators.fresh();
        let stored = 0.5 * pressure.iter().zip(&normal).map(|(p, u)| p * u).sum::<f64>();
        let at_once = case.bodies.instantaneous;
        let displaced = [0, 1, 2].map(|_| vec![0.0; pressure.len()]);
        let creeping = Self { operators, delays, at_once, duration: f64::NAN, displaced };
        (creeping, Crept { retarded, normal, stored: [stored, 0.0] })
    }

    /// Takes the duration of a step [s]; the constants by which the bodies respond in it, where these change.
    pub(super) fn take(&mut self, duration: f64) -> Option<Elasticity> {
        let changes = duration != self.duration;
        self.duration = duration;
        changes.then(|| within_step(self.at_once, &self.delays, duration))
    }

    /// Finds what the loads up to now displace at the end of the step.
    pub(super) fn recall(&mut self, crept: &Crept, now: Instant<'_>) {
        let Self { operators, duration, displaced, .. } = self;
        operators.recall(&crept.retarded, now.load(), *duration, displaced);
    }

    /// That along the normal [m].
    pub(super) fn normal(&self) -> &[f64] {
        &self.displaced[0]
    }

    /// Adds that along x and y [m].
    pub(super) fn add_to(&self, displacement: &mut [Vec<f64>; 2]) {
        for (sum, more) in displacement.iter_mut().zip(&self.displaced[1..]) {
            sum.iter_mut().zip(more).for_each(|(sum, more)| *sum += more);
        }
    }

    /// Ends the step; `normal` is the normal displacement by the loads of its end, without those before [m].
    pub(super) fn end(
        &mut self,
        crept: &mut Crept,
        before: Instant<'_>,
        after: Instant<'_>,
        mut normal: Vec<f64>,
    ) -> Kept {
        normal.iter_mut().zip(&self.displaced[0]).for_each(|(sum, more)| *sum += more);
        let work = |k: usize, from: &[f64], to: &[f64]| -> f64 {
            let [start, end] = [before.load()[k], after.load()[k]];
            let loads = start.iter().zip(end).map(|(p, q)| 0.5 * (p + q));
            loads.zip(from.iter().zip(to)).map(|(load, (from, to))| load * (to - from)).sum()
        };
        let [[bx, by], [ax, ay]] = [before.displacement, after.displacement];
        let on_normal = work(0, &crept.normal, &normal);
        let on_plane = work(1, bx, ax) + work(2, by, ay);
        self.operators.follow(&mut crept.retarded, before.load(), after.load(), self.duration);
        let displacement: [&[f64]; 3] = [&normal, ax, ay];
        let stored = self.operators.stored(&crept.retarded, after.load(), displacement);
        let from = std::mem::replace(&mut crept.stored, stored);
        crept.normal = normal;
        let along_plane = on_plane - (stored[1] - from[1]);
        Kept {
            stored: [from[1], stored[1]],
            along_plane,
            dissipated: along_plane + on_normal - (stored[0] - from[0]),
        }
    }
}
