//! A layer that yields, over the elements of a problem.
//!
//! In a shift, and in a step of transient rolling, the plastic shift κ' before the step is known. In steady rolling it is what a particle has
//! gathered on its way from the front, Σ λ of the elements upstream in its row, so that the bound of an element changes with the slip of
//! those ahead of it too.

use super::state::{ElementState, TangentialState};
use crate::half_space::yielding::{Carried, Yield};

/// A layer that yields.
#[derive(Clone, Copy, Debug)]
pub struct Layer<'a> {
    /// Its law.
    pub law: Yield,
    /// Plastic shift κ' of every element before the step [m]; `None` in steady rolling.
    pub before: Option<&'a [f64]>,
}

/// What both sliders of every element do.
#[derive(Debug, Default)]
pub(super) struct Sliders {
    pub(super) carried: Vec<Carried>,
    /// Plastic shift κ' before the step [m].
    before: Vec<f64>,
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
        for values in [&mut self.before, &mut state.plastic, &mut state.yielded] {
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
            self.before[index] = before;
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

    /// The traction bounds that a slip of an element may leave [Pa].
    pub(super) fn range(&self, law: &Yield, friction: f64, index: usize) -> [f64; 2] {
        law.range(friction, self.before[index])
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
