//! Yielding layer over the elements of a problem.
//!
//! In a shift, and in a step of transient rolling, the plastic shift κ' before the step is known.
//! In steady rolling it is the shift that a particle has accumulated since the leading edge, Σ λ of
//! the elements upstream in its row. The bound of an element then also depends on the slip of the
//! elements ahead.

use super::state::{ElementState, TangentialState};
use crate::yielding::{SliderState, Yield};

/// Layer that yields.
#[derive(Clone, Copy, Debug)]
pub struct Layer<'a> {
    /// Law of the yield stress.
    pub law: Yield,
    /// Plastic shift κ' of every element before the step [m]; `None` in steady rolling.
    pub before: Option<&'a [f64]>,
}

impl Layer<'_> {
    /// Limits the tractions after a step to friction and the layer, row by row from the leading
    /// edge. Elements of adhesion beyond their bound begin to slip; on a hardening layer, by as
    /// much as their own compliance `own` [m/Pa] gives back. Returns the number of these elements.
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

/// States of the two sliders of every element.
#[derive(Debug, Default)]
pub(super) struct Sliders {
    pub(super) carried: Vec<SliderState>,
}

impl Sliders {
    /// Updates the sliders from the slips of a state, row by row from the leading edge, and sets
    /// the plastic shifts of the state.
    pub(super) fn follow(
        &mut self,
        layer: &Layer<'_>,
        nx: usize,
        friction: &[f64],
        state: &mut TangentialState,
    ) {
        let count = friction.len();
        self.carried.resize(count, SliderState::default());
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

    /// Sets the tractions of the slip area to their bounds after the slip.
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

/// Slip of an element against its traction [m]; 0 in adhesion.
fn against(state: &TangentialState, index: usize) -> f64 {
    if state.element[index] != ElementState::Slip {
        return 0.0;
    }
    let ([px, py], [sx, sy]) = (&state.traction, &state.slip);
    let size = px[index].hypot(py[index]);
    (-(px[index] * sx[index] + py[index] * sy[index]) / size).max(0.0)
}
