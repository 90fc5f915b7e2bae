//! The linear system of a Newton step, bordered by the unknown creepages.
//!
//! Unknown are the steps dp of the tractions, both components in the adhesion area and across the
//! traction in the slip area, and the steps dc of the creepages whose forces F* are prescribed:
//!
//! K dp + W dc = −S,  G dp = F* − F,
//!
//! with K the linearised slip, W the rigid slip of unit creepages and G the sums from tractions to
//! forces. With P an approximate inverse of K (that of [`SlipOperator`] in the adhesion area, the
//! diagonal in the slip area) the constraint preconditioner
//!
//! dc = (G P W)⁻¹ (G P r − f),  dp = P r − P W dc
//!
//! meets G dp = f exactly for any P. GMRES therefore searches among steps that do not change the
//! forces, starting from a step that meets the forces.
//!
//! On a yielding layer the size of a traction in the slip area is unknown too, dp·n along the
//! traction. With the bound g(λ) after the slip λ = −n·S and the plastic shift κ' before,
//!
//! dn − g' (dκ' + dλ) = g − |p|,  dλ = −n·(B dp + W dc),
//!
//! where in steady rolling κ' is accumulated over the elements ahead, dκ = dκ' + dλ in elements
//! that flow. The row is scaled by A/(1 + |g'| A), with A the slip of an element by its own
//! traction.
//!
//! Source: Keller, Gould and Wathen, SIAM J. Matrix Anal. Appl. 21 (2000) 1300, for the
//! preconditioner.

use super::bounds::Bounds;
use super::problem::Problem;
use super::state::{ElementState, TangentialState};
use crate::slip_operator::SlipOperator;
use crate::yielding::SliderState;
use nalgebra::{Matrix3, Vector3};
use numerics::gmres::Preconditioned;
use numerics::vector::unit_of;

/// Smallest diagonal in the preconditioner for bounds that fall with the slip.
const LEAST_DIAGONAL: f64 = 0.1;

/// An element of the slip area.
#[derive(Clone, Copy, Debug)]
pub(super) struct SlipDirectionUnknown {
    pub(super) index: usize,
    /// Unit vector across the traction.
    pub(super) across: [f64; 2],
    /// |S|/g [m/Pa].
    stiffness: f64,
}

/// Size of a traction in the slip area, if it changes with the slip.
#[derive(Clone, Copy, Debug)]
pub(super) struct SlipMagnitudeUnknown {
    pub(super) index: usize,
    /// Unit vector along the traction.
    pub(super) direction: [f64; 2],
    carried: SliderState,
    /// g − |p| [Pa].
    pub(super) lack: f64,
}

/// Unknown tractions: in the adhesion area along x, then along y; in the slip area across the
/// traction, and along it if sizes change.
#[derive(Debug, Default)]
pub(super) struct Unknowns {
    pub(super) sticking: Vec<usize>,
    pub(super) slipping: Vec<SlipDirectionUnknown>,
    pub(super) yielding: Vec<SlipMagnitudeUnknown>,
    /// Number of elements in a row, if plastic shifts accumulate along rows.
    pub(super) gathers: Option<usize>,
}

impl Unknowns {
    pub(super) fn len(&self) -> usize {
        2 * self.sticking.len() + self.slipping.len() + self.yielding.len()
    }

    /// Chooses the unknowns from the states of the elements under their bounds.
    pub(super) fn choose(&mut self, state: &TangentialState, bounds: &Bounds) {
        self.sticking.clear();
        self.slipping.clear();
        self.yielding.clear();
        let ([px, py], [sx, sy]) = (&state.traction, &state.slip);
        for (index, element) in state.element.iter().enumerate() {
            match element {
                ElementState::Exterior => {}
                ElementState::Adhesion => self.sticking.push(index),
                ElementState::Slip => {
                    let mut g = bounds.friction[index];
                    if let Some(carried) = bounds.sliders.get(index).copied() {
                        g = px[index].hypot(py[index]);
                        let direction = [px[index] / g, py[index] / g];
                        let lack = carried.bound - g;
                        self.yielding.push(SlipMagnitudeUnknown {
                            index,
                            direction,
                            carried,
                            lack,
                        });
                    }
                    let across = [-py[index] / g, px[index] / g];
                    let stiffness = sx[index].hypot(sy[index]) / g;
                    self.slipping.push(SlipDirectionUnknown { index, across, stiffness });
                }
            }
        }
    }

    /// Values of a vector field at the unknowns.
    pub(super) fn restrict(&self, field: impl Fn(usize) -> [f64; 2], out: &mut Vec<f64>) {
        out.clear();
        out.extend(self.sticking.iter().map(|at| field(*at)[0]));
        out.extend(self.sticking.iter().map(|at| field(*at)[1]));
        let across = |SlipDirectionUnknown { index, across, .. }: &SlipDirectionUnknown| {
            let [x, y] = field(*index);
            across[0] * x + across[1] * y
        };
        out.extend(self.slipping.iter().map(across));
        let along = |SlipMagnitudeUnknown { index, direction, .. }: &SlipMagnitudeUnknown| {
            let [x, y] = field(*index);
            direction[0] * x + direction[1] * y
        };
        out.extend(self.yielding.iter().map(along));
    }

    /// Changes of the bounds by slips along the tractions, n·(B dp + W dc), scaled.
    fn follow_slip(&self, own: f64, slips: &mut [f64]) {
        let mut gathered = 0.0;
        let mut row = None;
        for (SlipMagnitudeUnknown { index, carried, .. }, slip) in
            self.yielding.iter().zip(slips).rev()
        {
            let SliderState { slope, passes, grows, friction_slope, .. } = *carried;
            let this = self.gathers.map(|columns| index / columns);
            if this.is_none() || this != row {
                gathered = 0.0;
                row = this;
            }
            let change = slope * (gathered + *slip) + friction_slope * *slip;
            gathered = passes * gathered + grows * *slip;
            *slip = scale(own, carried.own_slope()) * change;
        }
    }

    /// Right side of the rows for the sizes.
    pub(super) fn lacks(&self, own: f64, out: &mut [f64]) {
        for (SlipMagnitudeUnknown { carried, lack, .. }, out) in self.yielding.iter().zip(out) {
            *out = scale(own, carried.own_slope()) * lack;
        }
    }

    /// Writes values of the adhesion area, divided by `unit`, into a vector field that is zero
    /// elsewhere.
    fn spread_sticking(&self, x: &[f64], unit: f64, field: &mut [Vec<f32>; 2]) {
        let count = self.sticking.len();
        for (component, values) in field.iter_mut().zip([&x[..count], &x[count..]]) {
            component.fill(0.0);
            for (at, value) in self.sticking.iter().zip(values) {
                component[*at] = (value / unit) as f32;
            }
        }
    }

    /// Writes values of the slip area, divided by `unit`, into a vector field.
    fn spread_slipping(&self, x: &[f64], unit: f64, [along_x, along_y]: &mut [Vec<f32>; 2]) {
        let sizes = &x[self.slipping.len()..];
        for (SlipDirectionUnknown { index, across, .. }, value) in self.slipping.iter().zip(x) {
            along_x[*index] = (across[0] * value / unit) as f32;
            along_y[*index] = (across[1] * value / unit) as f32;
        }
        for (SlipMagnitudeUnknown { index, direction, .. }, value) in
            self.yielding.iter().zip(sizes)
        {
            along_x[*index] += (direction[0] * value / unit) as f32;
            along_y[*index] += (direction[1] * value / unit) as f32;
        }
    }

    /// Reads the values of a vector field in the adhesion area, times a factor.
    fn gather_sticking(&self, field: &[Vec<f32>; 2], factor: f64, out: &mut [f64]) {
        let (x, y) = out.split_at_mut(self.sticking.len());
        for (component, out) in field.iter().zip([x, y]) {
            self.sticking
                .iter()
                .zip(out)
                .for_each(|(at, value)| *value = factor * f64::from(component[*at]));
        }
    }
}

/// Scale of the row for a size [m/Pa].
fn scale(own: f64, slope: f64) -> f64 {
    own / (1.0 + slope.abs() * own)
}

/// Unknown creepages and the forces prescribed for them.
#[derive(Debug, Default)]
pub(super) struct Border {
    /// Unknown components of the creepage; the fields below follow their order.
    pub(super) components: Vec<usize>,
    /// W, G and P W at the unknown tractions.
    rigid_slip: [Vec<f64>; 3],
    force: [Vec<f64>; 3],
    answer: [Vec<f64>; 3],
    /// Derivative of the bounds with respect to a creepage [Pa per unit].
    derivative: Vec<f64>,
    /// (G P W − D)⁻¹; `None` if tractions do not change the forces, as when everything slips alike.
    inverse: Option<Matrix3<f64>>,
}

impl Border {
    /// Returns true if tractions do not determine the unknown creepages.
    pub(super) fn is_singular(&self) -> bool {
        self.inverse.is_none()
    }

    /// G dp.
    fn force_of(&self, step: &[f64]) -> Vector3<f64> {
        let mut sum = Vector3::zeros();
        for (sum, force) in sum.iter_mut().zip(&self.force).take(self.components.len()) {
            *sum = force.iter().zip(step).map(|(force, step)| force * step).sum();
        }
        sum
    }

    /// Creepages (G P W − D)⁻¹ f of forces f [N].
    fn creepages(&self, force: Vector3<f64>, out: &mut [f64]) {
        let found = self.inverse.unwrap_or_else(Matrix3::zeros) * force;
        out.copy_from_slice(&found.as_slice()[..out.len()]);
    }
}

/// Adds a combination of columns.
fn add(columns: &[Vec<f64>; 3], factors: &[f64], sign: f64, out: &mut [f64]) {
    for (column, factor) in columns.iter().zip(factors) {
        out.iter_mut().zip(column).for_each(|(out, value)| *out += sign * factor * value);
    }
}

/// Linear system of a Newton step.
pub(super) struct System<'a> {
    pub(super) operator: &'a mut SlipOperator,
    pub(super) field: &'a mut [Vec<f32>; 2],
    pub(super) image: &'a mut [Vec<f32>; 2],
    pub(super) unknowns: &'a Unknowns,
    pub(super) border: &'a mut Border,
}

impl System<'_> {
    /// Builds the border for the unknown creepages of a problem.
    pub(super) fn make_border(
        &mut self,
        problem: &Problem,
        state: &TangentialState,
        bounds: &mut Bounds,
    ) {
        self.border.components.clear();
        let Some(wanted) = &problem.wanted else { return };
        self.border.components.extend((0..3).filter(|k| wanted.force[*k].is_some()));
        let count = self.border.components.len();
        let mut product = Matrix3::identity();
        let mut direct = Matrix3::zeros();
        for at in 0..count {
            let component = self.border.components[at];
            let slip = |index| problem.rigid_slip(component, index);
            self.unknowns.restrict(slip, &mut self.border.rigid_slip[at]);
            let sizes = self.unknowns.len() - self.unknowns.yielding.len();
            let own = self.operator.self_influence();
            self.unknowns.follow_slip(own, &mut self.border.rigid_slip[at][sizes..]);
            let mut derivative = std::mem::take(&mut self.border.derivative);
            if bounds.by_creepage(problem, state, component, &mut derivative) {
                direct.set_column(at, &self.follow_bounds(problem, &derivative, at));
            }
            self.border.derivative = derivative;
            let force = |index| problem.force_of(component, index);
            self.unknowns.restrict(force, &mut self.border.force[at]);
            let mut answer = std::mem::take(&mut self.border.answer[at]);
            answer.resize(self.unknowns.len(), 0.0);
            let slip = std::mem::take(&mut self.border.rigid_slip[at]);
            self.approximate(&slip, &mut answer);
            (self.border.rigid_slip[at], self.border.answer[at]) = (slip, answer);
        }
        for at in 0..count {
            product.set_column(at, &self.border.force_of(&self.border.answer[at]));
        }
        product -= direct;
        self.border.inverse =
            product.try_inverse().filter(|inverse| inverse.iter().all(|value| value.is_finite()));
    }

    /// Adds the change of the bounds in the slip area, with this derivative to the creepage in
    /// place `at`, to the column W. Returns the change of the forces D by it.
    fn follow_bounds(&mut self, problem: &Problem, derivative: &[f64], at: usize) -> Vector3<f64> {
        let unknowns = self.unknowns;
        let own = self.operator.self_influence();
        let column = &mut self.border.rigid_slip[at];
        if !unknowns.yielding.is_empty() {
            let sizes = column.len() - unknowns.yielding.len();
            for (one, value) in unknowns.yielding.iter().zip(&mut column[sizes..]) {
                *value -= scale(own, one.carried.own_slope()) * derivative[one.index];
            }
            return Vector3::zeros();
        }
        let unit = unit_of(derivative);
        let mut direct = Vector3::zeros();
        self.field.iter_mut().for_each(|component| component.fill(0.0));
        for SlipDirectionUnknown { index, across: [tx, ty], .. } in &unknowns.slipping {
            let change = [ty * derivative[*index], -tx * derivative[*index]];
            for (component, change) in self.field.iter_mut().zip(change) {
                component[*index] = (change / unit) as f32;
            }
            for (sum, k) in direct.iter_mut().zip(&self.border.components) {
                let [fx, fy] = problem.force_of(*k, *index);
                *sum += fx * change[0] + fy * change[1];
            }
        }
        let ([fx, fy], [ix, iy]) = (&*self.field, &mut *self.image);
        self.operator.apply_single([fx, fy], [ix, iy]);
        let mut slip = Vec::new();
        let by_unit = own * unit;
        let at = |index: usize| [by_unit * f64::from(ix[index]), by_unit * f64::from(iy[index])];
        unknowns.restrict(at, &mut slip);
        column.iter_mut().zip(slip).for_each(|(value, more)| *value += more);
        direct
    }

    /// Step that makes up for the missing forces, as far as P determines it.
    pub(super) fn towards(&self, lack: [f64; 3], out: &mut [f64]) {
        let components = &self.border.components;
        let lack = Vector3::from_fn(|at, _| components.get(at).map_or(0.0, |k| -lack[*k]));
        let (step, creepage) = out.split_at_mut(self.unknowns.len());
        self.border.creepages(lack, creepage);
        step.fill(0.0);
        add(&self.border.answer, creepage, -1.0, step);
    }

    /// Sets out = P x.
    fn approximate(&mut self, x: &[f64], out: &mut [f64]) {
        let unknowns = self.unknowns;
        let count = 2 * unknowns.sticking.len();
        let unit = unit_of(&x[..count]);
        unknowns.spread_sticking(&x[..count], unit, self.field);
        let ([fx, fy], [ix, iy]) = (&*self.field, &mut *self.image);
        self.operator.apply_inverse([fx, fy], [ix, iy]);
        let own = self.operator.self_influence();
        unknowns.gather_sticking(self.image, own.recip() * unit, &mut out[..count]);
        for ((turn, out), x) in unknowns.slipping.iter().zip(&mut out[count..]).zip(&x[count..]) {
            *out = x / (own + turn.stiffness);
        }
        let sizes = count + unknowns.slipping.len();
        for ((one, out), x) in unknowns.yielding.iter().zip(&mut out[sizes..]).zip(&x[sizes..]) {
            let slope = one.carried.own_slope();
            *out = x / (scale(own, slope) * (1.0 + slope * own).max(LEAST_DIAGONAL));
        }
    }
}

impl Preconditioned for System<'_> {
    fn operate(&mut self, x: &[f64], out: &mut [f64]) {
        let unknowns = self.unknowns;
        let count = 2 * unknowns.sticking.len();
        let (step, creepage) = x.split_at(unknowns.len());
        let unit = unit_of(step);
        unknowns.spread_sticking(&step[..count], unit, self.field);
        unknowns.spread_slipping(&step[count..], unit, self.field);
        let ([fx, fy], [ix, iy]) = (&*self.field, &mut *self.image);
        self.operator.apply_single([fx, fy], [ix, iy]);
        let own = self.operator.self_influence();
        let by_unit = own * unit;
        unknowns.gather_sticking(self.image, by_unit, &mut out[..count]);
        let [ix, iy] = &*self.image;
        for ((turn, out), x) in unknowns.slipping.iter().zip(&mut out[count..]).zip(&step[count..])
        {
            let SlipDirectionUnknown { index, across, stiffness } = turn;
            let along = across[0] * f64::from(ix[*index]) + across[1] * f64::from(iy[*index]);
            *out = by_unit * along + stiffness * x;
        }
        let sizes = count + unknowns.slipping.len();
        let end = unknowns.len();
        for (one, out) in unknowns.yielding.iter().zip(&mut out[sizes..end]) {
            let [nx, ny] = one.direction;
            *out = by_unit * (nx * f64::from(ix[one.index]) + ny * f64::from(iy[one.index]));
        }
        unknowns.follow_slip(own, &mut out[sizes..end]);
        for ((one, out), x) in
            unknowns.yielding.iter().zip(&mut out[sizes..end]).zip(&step[sizes..])
        {
            *out += scale(own, one.carried.own_slope()) * x;
        }
        add(&self.border.rigid_slip, creepage, 1.0, out);
    }

    fn precondition(&mut self, x: &[f64], out: &mut [f64]) {
        let (step, creepage) = out.split_at_mut(self.unknowns.len());
        self.approximate(x, step);
        if !creepage.is_empty() {
            self.border.creepages(self.border.force_of(step), creepage);
            add(&self.border.answer, creepage, -1.0, step);
        }
    }
}
