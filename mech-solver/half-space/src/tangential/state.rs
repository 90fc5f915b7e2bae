//! Tractions, slips and states of the elements.

use serde::{Deserialize, Serialize};

/// State of an element.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum ElementState {
    /// No contact.
    Exterior,
    /// The surfaces stick.
    Adhesion,
    /// The surfaces slip.
    Slip,
}

/// Creepages [ξ, η, φ]: longitudinal [-], lateral [-], spin [rad/m].
pub type Creepage = [f64; 3];

/// A solution, or the start of one.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct TangentialState {
    /// Tractions on body 1, x and y [Pa].
    pub traction: [Vec<f64>; 2],
    /// Slip distance of body 1 relative to body 2 over a step, x and y [m].
    pub slip: [Vec<f64>; 2],
    /// State of each element.
    pub element: Vec<ElementState>,
    /// Creepages.
    pub creepage: Creepage,
    /// Accumulated plastic shift of a layer after the step [m]; empty without a yielding layer.
    pub plastic: Vec<f64>,
    /// Growth of the plastic shift in the step, a part of the slip [m].
    pub yielded: Vec<f64>,
}

impl TangentialState {
    /// Returns true if the state belongs to a grid of this many elements.
    #[must_use]
    pub fn fits(&self, count: usize) -> bool {
        let pairs = [&self.traction, &self.slip];
        let whole = |pair: &[Vec<f64>; 2]| pair.iter().all(|field| field.len() == count);
        let layer = [&self.plastic, &self.yielded].map(Vec::len);
        let layer = layer == [0; 2] || layer == [count; 2];
        self.element.len() == count && pairs.into_iter().all(whole) && layer
    }

    /// State in which everything adheres without traction.
    #[must_use]
    pub fn at_rest(bound: &[f64], creepage: Creepage) -> Self {
        let zeros = vec![0.0; bound.len()];
        let state = |bound: &f64| match *bound > 0.0 {
            true => ElementState::Adhesion,
            false => ElementState::Exterior,
        };
        Self {
            traction: [zeros.clone(), zeros.clone()],
            slip: [zeros.clone(), zeros],
            element: bound.iter().map(state).collect(),
            creepage,
            plastic: Vec::new(),
            yielded: Vec::new(),
        }
    }

    /// Adapts the state to another bound: elements enter and leave the contact, tractions are cut,
    /// and tractions in slip grow with the bound.
    pub fn fit(&mut self, bound: &[f64]) {
        let [px, py] = &mut self.traction;
        for (index, (element, g)) in self.element.iter_mut().zip(bound).enumerate() {
            let size = px[index].hypot(py[index]);
            *element = match *element {
                _ if *g == 0.0 => ElementState::Exterior,
                ElementState::Slip if size > 0.0 => ElementState::Slip,
                _ if size > *g => ElementState::Slip,
                _ => ElementState::Adhesion,
            };
            let factor = match *element {
                ElementState::Exterior => 0.0,
                ElementState::Adhesion => 1.0,
                ElementState::Slip => g / size,
            };
            px[index] *= factor;
            py[index] *= factor;
        }
    }
}
