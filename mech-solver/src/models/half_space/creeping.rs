//! Bodies whose compliance grows, pressed and shifted without rolling ([`half_space::retarded`]).

use super::case::Case;
use elastic::Elasticity;
use half_space::retarded::{Delay, Field3, RetardedOperators, within_step};
use serde::{Deserialize, Serialize};

/// Creeping bodies, with the data of the current step.
#[derive(Debug)]
pub(super) struct CreepingBodies {
    operators: RetardedOperators,
    delays: Vec<Delay>,
    at_once: Elasticity,
    /// Duration of the step [s].
    duration: f64,
    /// Displacements at the end of the step caused by earlier loads: along the normal, x and y [m].
    displaced: Field3,
}

/// Creep state passed from one step to the next.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(super) struct CreepState {
    retarded: Vec<Field3>,
    /// Normal displacement [m].
    normal: Vec<f64>,
    /// Stored energy divided by the area of an element: along the normal and along the plane [Pa
    /// m].
    stored: [f64; 2],
}

impl CreepState {
    /// Returns whether both states belong to the same grid and the same number of bodies.
    pub(super) fn is_like(&self, other: &Self) -> bool {
        let lengths = |crept: &Self| -> Vec<usize> {
            crept.retarded.iter().flatten().chain([&crept.normal]).map(Vec::len).collect()
        };
        lengths(self) == lengths(other)
    }
}

/// Loads of an instant, with the displacements they cause.
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

/// Energies of a step divided by the area of an element [Pa m].
#[derive(Clone, Copy, Debug)]
pub(super) struct StepEnergies {
    /// Stored energy of the tangential displacements, before and after the step.
    pub(super) stored: [f64; 2],
    /// Energy dissipated along the plane.
    pub(super) along_plane: f64,
    /// Total dissipated energy.
    pub(super) dissipated: f64,
}

impl CreepingBodies {
    /// Creates the bodies of a case and their initial state under a pressure that causes the normal
    /// displacement `normal` [m].
    pub(super) fn new(case: &Case, pressure: &[f64], normal: Vec<f64>) -> (Self, CreepState) {
        let delays = case.delays.clone();
        let operators = RetardedOperators::new(&case.footprint.grid, &delays);
        let retarded = operators.fresh();
        let stored = 0.5 * pressure.iter().zip(&normal).map(|(p, u)| p * u).sum::<f64>();
        let at_once = case.bodies.instantaneous;
        let displaced = [0, 1, 2].map(|_| vec![0.0; pressure.len()]);
        let creeping = Self { operators, delays, at_once, duration: f64::NAN, displaced };
        (creeping, CreepState { retarded, normal, stored: [stored, 0.0] })
    }

    /// Sets the duration of a step [s]. Returns the elastic constants effective within the step, if
    /// they change.
    pub(super) fn take(&mut self, duration: f64) -> Option<Elasticity> {
        let changes = duration != self.duration;
        self.duration = duration;
        changes.then(|| within_step(self.at_once, &self.delays, duration))
    }

    /// Computes the displacements that the loads up to now leave at the end of the step.
    pub(super) fn recall(&mut self, crept: &CreepState, now: Instant<'_>) {
        let Self { operators, duration, displaced, .. } = self;
        operators.recall(&crept.retarded, now.load(), *duration, displaced);
    }

    /// Normal displacement left by earlier loads [m].
    pub(super) fn normal(&self) -> &[f64] {
        &self.displaced[0]
    }

    /// Adds the displacements along x and y left by earlier loads [m].
    pub(super) fn add_to(&self, displacement: &mut [Vec<f64>; 2]) {
        for (sum, more) in displacement.iter_mut().zip(&self.displaced[1..]) {
            sum.iter_mut().zip(more).for_each(|(sum, more)| *sum += more);
        }
    }

    /// Ends the step; `normal` is the normal displacement caused by the loads at its end, without
    /// that of earlier loads [m].
    pub(super) fn end(
        &mut self,
        crept: &mut CreepState,
        before: Instant<'_>,
        after: Instant<'_>,
        mut normal: Vec<f64>,
    ) -> StepEnergies {
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
        StepEnergies {
            stored: [from[1], stored[1]],
            along_plane,
            dissipated: along_plane + on_normal - (stored[0] - from[0]),
        }
    }
}
