//! Bounds of the tractions at the latest iterate: friction, which may follow the creepages and the
//! slip, and a yielding layer.
//!
//! Friction that follows the slip of an element makes the size of its traction an unknown, like a
//! yielding layer does. The derivatives of a law of friction are finite differences.
//!
//! *Layer.* In a shift, and in a step of transient rolling, the plastic shift κ' before the step is
//! known. In steady rolling it is the shift that a particle has accumulated since the leading edge,
//! Σ λ of the elements upstream in its row. The bound of an element then also depends on the slip
//! of the elements ahead.

use super::problem::Problem;
use super::state::{ElementState, TangentialState};
use crate::yielding::SliderState;

/// Limits the tractions after a step to friction and the layer, row by row from the leading edge,
/// where sizes of tractions follow the slip. Elements of adhesion beyond their bound begin to slip;
/// on a hardening layer, by as much as their own compliance `own` [m/Pa] gives back. Returns the
/// number of these elements.
pub(super) fn limit(
    problem: &Problem,
    friction: &[f64],
    own: f64,
    state: &mut TangentialState,
) -> usize {
    let [px, py] = &mut state.traction;
    let mut released = 0;
    let mut upstream = 0.0;
    for index in (0..friction.len()).rev() {
        if (index + 1).is_multiple_of(problem.nx) {
            upstream = 0.0;
        }
        let (size, g) = (px[index].hypot(py[index]), friction[index]);
        let slider = problem.layer.map(|layer| {
            let before = layer.before.map_or(upstream, |before| before[index]);
            upstream = before;
            (layer.law, before)
        });
        let limit = slider.map_or(g, |(law, before)| law.limit(g, before));
        let (bound, shift) = match state.element[index] {
            ElementState::Exterior => continue,
            ElementState::Adhesion if size <= limit => continue,
            ElementState::Adhesion => {
                released += 1;
                state.element[index] = ElementState::Slip;
                slider.map_or((g, 0.0), |(law, before)| {
                    let stiffness = own.recip() + law.hardening;
                    let slip = if law.hardening > 0.0 { (size - limit) / stiffness } else { 0.0 };
                    let carried = law.carried(g, before, slip);
                    (carried.bound, carried.shift)
                })
            }
            ElementState::Slip => slider.map_or((size, 0.0), |(law, before)| {
                let [least, most] = law.range(g, before);
                let bound = size.clamp(least, most);
                (bound, law.shift_to(bound, before))
            }),
        };
        upstream += shift;
        px[index] *= bound / size;
        py[index] *= bound / size;
    }
    released
}

/// Step of a creepage, over the creepage at which a good part of the contact slips, and of a slip,
/// over the distance rolled, in the differences of a law of friction.
const DIFFERENCE: f64 = 1e-6;

/// Bounds of every element at the latest iterate, with their derivatives.
#[derive(Debug, Default)]
pub(super) struct Bounds {
    /// Bound of friction f p [Pa].
    pub(super) friction: Vec<f64>,
    /// Derivative of the bound of friction with respect to the slip [Pa/m]; empty if there is none.
    slope: Vec<f64>,
    /// States of friction and layer in series; empty unless sizes of tractions follow the slip.
    pub(super) sliders: Vec<SliderState>,
    slip: Vec<f64>,
    further: Vec<f64>,
}

impl Bounds {
    /// Updates the bounds from the creepages and slips of a state, row by row from the leading
    /// edge, and sets the plastic shifts of the state.
    pub(super) fn follow(&mut self, problem: &Problem, state: &mut TangentialState) {
        self.follow_friction(problem, state);
        self.sliders.clear();
        if problem.sizes_follow_slip() {
            self.follow_sliders(problem, state);
        }
    }

    /// Updates the bounds of friction from the creepages and slips of a state.
    pub(super) fn follow_friction(&mut self, problem: &Problem, state: &TangentialState) {
        let count = problem.bound.len();
        self.friction.clear();
        self.friction.extend_from_slice(problem.bound);
        self.slope.clear();
        if let Some(law) = problem.law {
            self.slip.clear();
            self.slip.extend((0..count).map(|index| against(state, index)));
            law.evaluate(state.creepage, &self.slip, &mut self.friction);
            if law.arguments().slip {
                let step = DIFFERENCE * problem.distance;
                self.slip.iter_mut().for_each(|slip| *slip += step);
                self.slope.resize(count, 0.0);
                law.evaluate(state.creepage, &self.slip, &mut self.slope);
                for (slope, here) in self.slope.iter_mut().zip(&self.friction) {
                    *slope = (*slope - here) / step;
                }
            }
        }
    }

    fn follow_sliders(&mut self, problem: &Problem, state: &mut TangentialState) {
        let count = self.friction.len();
        if problem.layer.is_some() {
            for values in [&mut state.plastic, &mut state.yielded] {
                values.resize(count, 0.0);
            }
        }
        self.sliders.resize(count, SliderState::default());
        let mut upstream = 0.0;
        for index in (0..count).rev() {
            let friction = self.friction[index];
            let mut slider = SliderState::of_friction(friction);
            if let Some(layer) = &problem.layer {
                if (index + 1).is_multiple_of(problem.nx) {
                    upstream = 0.0;
                }
                let before = layer.before.map_or(upstream, |before| before[index]);
                slider = layer.law.carried(friction, before, against(state, index));
                upstream = before + slider.shift;
                state.plastic[index] = upstream;
                state.yielded[index] = slider.shift;
            }
            if slider.governed_by_friction() {
                slider.friction_slope = self.slope.get(index).copied().unwrap_or(0.0);
            }
            self.sliders[index] = slider;
        }
    }

    /// Bound of an element after its slip [Pa].
    pub(super) fn at(&self, index: usize) -> f64 {
        self.sliders.get(index).map_or(self.friction[index], |slider| slider.bound)
    }

    /// Sets the tractions of the slip area to their bounds.
    pub(super) fn begin(&self, state: &mut TangentialState) {
        let [px, py] = &mut state.traction;
        for (index, element) in state.element.iter().enumerate() {
            if *element == ElementState::Slip {
                let factor = self.at(index) / px[index].hypot(py[index]);
                px[index] *= factor;
                py[index] *= factor;
            }
        }
    }

    /// Writes the derivative of the bounds of friction with respect to one component of the
    /// creepages [Pa per unit]. Returns false if they do not depend on it.
    pub(super) fn by_creepage(
        &mut self,
        problem: &Problem,
        state: &TangentialState,
        component: usize,
        derivative: &mut Vec<f64>,
    ) -> bool {
        let Some(law) = problem.law.filter(|law| law.arguments().creepage) else { return false };
        let Some(wanted) = &problem.wanted else { return false };
        let unit = if component == 2 { wanted.length.recip() } else { 1.0 };
        let size = wanted.creepage.max(wanted.size(state.creepage));
        let mut creepage = state.creepage;
        // Away from zero: the slip of rigid bodies has a kink there.
        creepage[component] += (DIFFERENCE * size * unit).copysign(creepage[component]);
        let step = creepage[component] - state.creepage[component];
        self.slip.clear();
        self.slip.extend((0..self.friction.len()).map(|index| against(state, index)));
        self.further.resize(self.friction.len(), 0.0);
        law.evaluate(creepage, &self.slip, &mut self.further);
        derivative.clear();
        let pairs = self.further.iter().zip(&self.friction);
        derivative.extend(pairs.map(|(further, here)| (further - here) / step));
        for (value, slider) in derivative.iter_mut().zip(&self.sliders) {
            // Where the layer gives way, friction does not act.
            *value *= f64::from(u8::from(slider.governed_by_friction()));
        }
        true
    }
}

/// Slip of an element against its traction [m]; 0 in adhesion.
pub(super) fn against(state: &TangentialState, index: usize) -> f64 {
    if state.element[index] != ElementState::Slip {
        return 0.0;
    }
    let ([px, py], [sx, sy]) = (&state.traction, &state.slip);
    let size = px[index].hypot(py[index]);
    (-(px[index] * sx[index] + py[index] * sy[index]) / size).max(0.0)
}
