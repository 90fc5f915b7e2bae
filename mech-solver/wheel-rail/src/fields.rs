//! The fields of a patch, on its part of the grid over x and the tape distance, and their sums.
//!
//! **Friction power** of an element is −p·S_I V/Δx plus the numerical dissipation of the difference
//! ([`half_space::dissipation`]), where p is the traction that works on the slip
//! ([`half_space::difference`]). The sum over a patch is −V(ξF_x + ηF_y + φM_z), with M_z about
//! the *pivot*: the origin for Fromm's difference, Δx/3 ahead of the origin for the upwind
//! difference. If rigid slip is taken on the surfaces, the part off the plane adds its own power.

use super::local::Window;
use grids::Structured;
use half_space::difference::Difference;
use half_space::dissipation::without_negative;
use half_space::friction::ElementFriction;
use half_space::tangential::{ElementState, TangentialState};

/// Fields of a patch. Element (i, j) has the index j·nx + i.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Fields {
    /// First element, as numbers (i, j) on the grid over x and the tape distance. Its middle is at
    /// (i Δx, j Δs), x in track axes.
    pub first: [i64; 2],
    /// Elements along x and along the tape.
    pub counts: [usize; 2],
    /// Sides of an element [m].
    pub sides: [f64; 2],
    /// Column and row of the origin of the patch's axes.
    pub origin: [usize; 2],
    /// Difference scheme along x, which sets the positions of slip and friction power.
    pub difference: Difference,
    /// Undeformed distance [m], [`super::local::NOTHING`] beyond the rows of the patch.
    pub distance: Vec<f64>,
    /// Pressure [Pa].
    pub pressure: Vec<f64>,
    /// Tractions on the wheel, along x and along the tangent [Pa].
    pub traction: [Vec<f64>; 2],
    /// Velocity of the wheel's surface relative to the rail's, along x and along the tangent [m/s];
    /// zero outside the contact.
    pub slip_velocity: [Vec<f64>; 2],
    /// Friction power [W/m²].
    pub friction_power: Vec<f64>,
    /// State of every element; exterior where there are no tractions.
    pub element: Vec<ElementState>,
}

/// Forces and moments on the wheel about the origin of a patch, in the axes of the patch.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Load {
    /// Force along x, along the tangent and along the normal [N].
    pub force: [f64; 3],
    /// Moment about the same axes [N m].
    pub moment: [f64; 3],
}

impl Fields {
    /// Creates the fields on a window whose origin is this element, still without tractions.
    #[must_use]
    pub fn pressed(
        window: &Window,
        difference: Difference,
        element: [i64; 2],
        distance: &[f64],
        pressure: &[f64],
    ) -> Self {
        let count = window.points();
        let zeros = || vec![0.0; count];
        Self {
            first: [0, 1].map(|k| element[k] - window.half[k] as i64),
            counts: window.counts(),
            sides: window.sides,
            origin: window.half,
            difference,
            distance: distance.to_vec(),
            pressure: pressure.to_vec(),
            traction: [zeros(), zeros()],
            slip_velocity: [zeros(), zeros()],
            friction_power: zeros(),
            element: vec![ElementState::Exterior; count],
        }
    }

    /// Traction bound [Pa] from the friction of the elements, on a window around the same origin
    /// that lies within these fields.
    #[must_use]
    pub fn bound(&self, window: &Window, friction: &ElementFriction) -> Vec<f64> {
        let narrow = window.counts();
        let shift = [0, 1].map(|k| self.origin[k] - window.half[k]);
        let of = |at: usize| {
            let [i, j] = [at % narrow[0] + shift[0], at / narrow[0] + shift[1]];
            let at = j * self.counts[0] + i;
            let p = self.pressure[at];
            if p > 0.0 { friction.bound(at, p) } else { 0.0 }
        };
        (0..narrow[0] * narrow[1]).map(of).collect()
    }

    /// Stores the tractions of a solution on a window around the same origin that lies within these
    /// fields. `speed` is V [m/s]; the numerical dissipation belongs to the difference along x
    /// [W/m²].
    pub fn take(
        &mut self,
        window: &Window,
        state: &TangentialState,
        speed: f64,
        dissipation: Option<&[f64]>,
    ) {
        let (wide, narrow) = (self.counts[0], window.counts());
        let [left, low] = [0, 1].map(|k| self.origin[k] - window.half[k]);
        let rate = speed / self.sides[0];
        for j in 0..narrow[1] {
            for i in 0..narrow[0] {
                let from = j * narrow[0] + i;
                let to = (low + j) * wide + left + i;
                let mut power = dissipation.map_or(0.0, |dissipation| dissipation[from]);
                for component in 0..2 {
                    let traction = &state.traction[component];
                    let velocity = state.slip[component][from] * rate;
                    power -= self.difference.working(traction, narrow[0], from) * velocity;
                    self.traction[component][to] = traction[from];
                    let touches = self.pressure[to] > 0.0;
                    self.slip_velocity[component][to] = if touches { velocity } else { 0.0 };
                }
                self.friction_power[to] = power;
                self.element[to] = state.element[from];
            }
        }
        without_negative(&mut self.friction_power);
    }

    /// Power [W] of the tractions on a window around the same origin against a slip per step [m].
    #[must_use]
    pub fn power_of_slip(
        &self,
        window: &Window,
        slip: [&[f64]; 2],
        traction: &[Vec<f64>; 2],
        speed: f64,
    ) -> f64 {
        let nx = window.counts()[0];
        let of = |at: usize| {
            let parts = slip.iter().zip(traction);
            parts.map(|(slip, p)| -self.difference.working(p, nx, at) * slip[at]).sum::<f64>()
        };
        (0..window.points()).map(of).sum::<f64>() * speed * self.sides[1]
    }

    /// Grid over x in track axes and the tape distance.
    #[must_use]
    pub fn developed_grid(&self) -> Structured {
        let [dx, dy] = self.sides;
        let [x0, y0] = [0, 1].map(|k| self.first[k] as f64 * self.sides[k]);
        Structured::contact_plane(x0, y0, dx, dy, self.counts[0], self.counts[1])
    }

    /// Grid in the axes of the patch.
    #[must_use]
    pub fn grid(&self) -> Structured {
        let [dx, dy] = self.sides;
        let [x0, y0] = [0, 1].map(|k| -(self.origin[k] as f64) * self.sides[k]);
        Structured::contact_plane(x0, y0, dx, dy, self.counts[0], self.counts[1])
    }

    /// Force and moment of pressure and tractions.
    #[must_use]
    pub fn load(&self) -> Load {
        let grid = self.grid();
        let mut load = Load::default();
        for (at, p) in self.pressure.iter().enumerate() {
            if *p <= 0.0 {
                continue;
            }
            let (x, y) = (grid.x(at % grid.ni), grid.y(at / grid.ni));
            let [px, py] = [self.traction[0][at], self.traction[1][at]];
            let sums = load.force.iter_mut().chain(&mut load.moment);
            let parts = [px, py, *p, y * p, -x * p, x * py - y * px];
            sums.zip(parts).for_each(|(sum, part)| *sum += part);
        }
        let area = grid.element_area();
        load.force.iter_mut().chain(&mut load.moment).for_each(|sum| *sum *= area);
        load
    }

    /// Sum of the tractions along the tangent over the sum of the pressures, of the elements in
    /// contact [-].
    #[must_use]
    pub fn leaning(&self) -> f64 {
        let pressed = self.pressure.iter().zip(&self.traction[1]).filter(|(p, _)| **p > 0.0);
        let [sum, across] =
            pressed.fold([0.0; 2], |[sum, across], (p, traction)| [sum + p, across + traction]);
        across / sum
    }

    /// Friction power of the patch [W].
    #[must_use]
    pub fn total_power(&self) -> f64 {
        self.friction_power.iter().sum::<f64>() * self.sides[0] * self.sides[1]
    }

    /// Distance along x ahead of the origin at which the moment works on the spin [m].
    #[must_use]
    pub fn pivot(&self) -> f64 {
        (self.difference.middle() - self.difference.rigid_slip_ahead()) * self.sides[0]
    }

    /// Area of the slipping elements over that of all elements in contact [-].
    #[must_use]
    pub fn slip_area_ratio(&self) -> f64 {
        let count = |state| self.element.iter().filter(|element| **element == state).count() as f64;
        let (slip, stick) = (count(ElementState::Slip), count(ElementState::Adhesion));
        if slip > 0.0 { slip / (slip + stick) } else { 0.0 }
    }
}
