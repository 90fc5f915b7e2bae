//! A layer that yields, over the elements of a problem.
//!
//! In a shift, and in a step of transient rolling, the plastic shift κ' before the step is known. In steady rolling it is what a particle has
//! gathered on its way from the front, Σ λ of the elements upstream in its row, so that the bound of an element changes with the slip of
//! those ahead of it too.

use super::state::{ElementState, TangentialState};
use crate::yielding::{Carried, Yield};

/// A layer that yields.
#[derive(Clone, Copy, Debug)]
pub struct Layer<'a> {
    /// Its law.
    pub law: Yield,
    /// Plastic shift κ' of every element before the step [m]; `None` in steady rolling.
    pub before: Option<&'a [f64]>,
}

impl Layer<'_> {
    /// Takes tractions that a step has changed to what friction and the layer let them be, row by row from the front. What adhered and
    /// is beyond its bound slips from now on: of a layer that hardens by as much as its own compliance `own` [m/Pa] gives back. How many
    /// elements that are.
    pub(super) fn yield_to(
        &self,
        nx: usize,
        friction: &[f64],
        own: f64,
        state: &mut TangentialState,
    ) -> usize {
        let [px, py] = &mut state.traction;
        let mut released = 0;
        let mut upstream = 0.0;
        for index in (0..friction.len()).rev() {
            if (index + 1).is_multiple_of(nx) {
                upstream = 0.0;
            }
            let before = self.before.map_or(upstream, |before| before[index]);
            upstream = before;
            let (size, g) = (px[index].hypot(py[index]), friction[index]);
            let limit = self.law.limit(g, before);
            let (bound, shift) = match state.element[index] {
                ElementState::Exterior => continue,
                ElementState::Adhesion if size <= limit => continue,
                ElementState::Adhesion => {
                    released += 1;
                    state.element[index] = ElementState::Slip;
                    let stiffness = own.recip() + self.law.hardening;
                    let slip =
                        if self.law.hardening > 0.0 { (size - limit) / stiffness } else { 0.0 };
                    let carried = self.law.carried(g, before, slip);
                    (carried.bound, carried.shift)
                }
                ElementState::Slip => {
                    let [least, most] = self.law.range(g, before);
                    let bound = size.clamp(least, most);
                    (bound, self.law.shift_to(bound, before))
                }
            };
            upstream += shift;
            px[index] *= bound / size;
            py[index] *= bound / size;
        }
        released
    }
}

/// States of both sliders of every element.
#[derive(Debug, Default)]
pub(super) struct Sliders {
    pub(super) carried: Vec<Carried>,
}

impl Sliders {
    /// Follows the slips of a state, row by row from the front; its plastic shifts become those that belong to them.
    pub(super) fn follow(
        &mut self,
        layer: &Layer<'_>,
        nx: usize,
        friction: &[f64],
        state: &mut TangentialState,
    ) {
        let count = friction.len();
        self.carried.resize(count, Carried::default());
        for values in [&mut state.plastic, &mut state.yielded] {
            values.resize(count, 0.0);
        }
        let mut upstream = 0.0;
        for index in (0..count).rev() {
            if (index + 1).is_multiple_of(nx) {
                upstream = 0.0;
            }
            let before = layer.before.map_or(upstream, |before| before[index]);
            let slip = against(state, index);
            let carried = layer.law.carried(friction[index], before, slip);
            upstream = before + carried.shift;
            self.carried[index] = carried;
            state.plastic[index] = upstream;
            state.yielded[index] = carried.shift;
        }
    }

    /// Makes the tractions of the slip area those that its slip leaves.
    pub(super) fn begin(&self, state: &mut TangentialState) {
        let [px, py] = &mut state.traction;
        for (index, element) in state.element.iter().enumerate() {
            if *element == ElementState::Slip {
                let factor = self.carried[index].bound / px[index].hypot(py[index]);
                px[index] *= factor;
                py[index] *= factor;
            }
        }
    }
}

/// The slip of an element against its traction [m]; 0 where it adheres.
fn against(state: &TangentialState, index: usize) -> f64 {
    if state.element[index] != ElementState::Slip {
        return 0.0;
    }
    let ([px, py], [sx, sy]) = (&state.traction, &state.slip);
    let size = px[index].hypot(py[index]);
    (-(px[index] * sx[index] + py[index] * sy[index]) / size).max(0.0)
}
