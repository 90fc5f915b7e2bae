//! Normal and tangential contact on a curved surface, in steady rolling.
//!
//! The bodies approach by δ along the normal at s = 0, hence by δ cos α where the surface has the
//! direction α. With the influence numbers A of [`super::numbers`] the gap is
//!
//! e = h − δ cos α + A_nn p_n + A_nt p_t,
//!
//! and the slip of a step Δx is S = w Δx + D(A_tt p_t + A_tn p_n), with the difference D of
//! [`crate::difference`]. The rigid slip w follows from the creepages ξ, η, φ at s = 0 and from the
//! rolling curvature c = 1/R₁ + 1/R₂ about the direction of s there:
//!
//! w_x = ξ − φ y + c z,  w_s = (η + φ x) cos α + (ζ − c x) sin α,  with y(s), z(s) on the surface,
//!
//! or, in the plane at s = 0, (ξ − φ s, η + φ x).
//!
//! Pressure and tractions are solved in turn until the pressure settles, as for bodies of different
//! constants, with half steps if it does not settle soon. The tangential solver uses the operator
//! of half-spaces. The difference between A_tt and this operator acts with the tractions of the
//! previous turn. The approach under a given force along z, F_z = ∫ (p_n cos α + p_s sin α) dA, is
//! iterated in the same way.
//!
//! Sources: Z. Li, Wheel–rail rolling contact and its application to wear simulation, thesis, Delft
//! (2002), for the creepages; Vollebregt, Vehicle System Dynamics 56 (2018) 1622, where the yaw of
//! a wheel has a part ζ along the normal. ζ is zero if the origin is the place of the contact after
//! the yaw, which moves the contact.

use super::elastic::ElasticPair;
use super::numbers::{InfluenceNumbers, SurfaceGrid};
use super::section::CrossSection;
use super::shape::Arcs;
use crate::difference::Difference;
use crate::dissipation::without_negative;
use crate::grid_continuation::{Contact, History, Levels, Motion, Solution, TangentialError};
use crate::normal::{NormalError, Prescribed};
use crate::tangential::{self, Creepage, TangentialState};
use crate::viscoelastic::Bodies;
use elastic::Elasticity;
use elastic::Material;
use grids::Structured;
use std::sync::Arc;
use tables::readable::{number, quantity};

/// Change of the pressure, over the largest, at which the pressure has settled: far below the error
/// of any grid.
const REST: f64 = 1e-6;
/// Accuracy of the tractions, over the largest traction.
const TOLERANCE: f64 = 1e-4;
/// Error allowed in a given force, as a share of the force.
const FORCE_TOLERANCE: f64 = 1e-9;
/// Limit of turns between normal and tangential contact, and of steps of the approach.
const MOST_TURNS: usize = 40;
/// Turns with the whole change of the gap; later turns take half of it. Where tractions are large,
/// an edge element may alternate between contact and no contact.
const WHOLE_TURNS: usize = 10;

/// Reason why a conformal contact has no solution.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ConformalError {
    /// The normal contact has no solution.
    #[error(transparent)]
    Normal(#[from] NormalError),
    /// The tangential contact has no solution.
    #[error(transparent)]
    Tangential(#[from] TangentialError),
    /// Normal and tangential contact do not converge in turn.
    #[error(
        "normal and tangential contact did not converge in {MOST_TURNS} turns: the pressure \
         still changes by {change} of its maximum", change = number(*.change, 2))]
    Unsettled {
        /// Change of the pressure over its maximum.
        change: f64,
    },
    /// No approach carries the force.
    #[error("no approach was found under which the contact carries {force} along its normal", force = quantity(*.force, "N", 5))]
    NoApproach {
        /// Prescribed force [N].
        force: f64,
    },
    /// The bodies are apart.
    #[error("under an approach of {approach} the bodies do not touch", approach = quantity(*.approach, "m", 5))]
    Apart {
        /// Prescribed approach [m].
        approach: f64,
    },
}

/// Prescribed values of one contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Prescription {
    /// Force along the normal at s = 0, or approach there.
    pub load: Prescribed,
    /// Creepages at s = 0.
    pub creepage: Creepage,
    /// Relative velocity ζ along the normal at s = 0, over the speed.
    pub normal_creepage: f64,
    /// Takes the rigid slip of the creepages in the plane at s = 0, as half-spaces do.
    pub in_plane: bool,
    /// Friction coefficient f [-].
    pub friction: f64,
    /// Adhesion is possible; otherwise the whole contact slides.
    pub adheres: bool,
}

/// A solved contact.
#[derive(Clone, Debug, Default)]
pub struct Conformal {
    /// Approach δ [m].
    pub approach: f64,
    /// Pressure p_n [Pa].
    pub pressure: Vec<f64>,
    /// Tractions, slip of a step and states.
    pub state: TangentialState,
    /// Force on body 1 along x, y and z at s = 0 [N].
    pub force: [f64; 3],
    /// Iterations of the normal contact.
    pub normal_iterations: usize,
    /// Newton steps.
    pub newton_steps: usize,
}

/// Solver of conformal contacts on one grid.
#[derive(Debug)]
pub struct ConformalSolver {
    grid: Structured,
    arcs: Arcs,
    elastic: ElasticPair,
    levels: Levels,
    difference: Difference,
}

impl ConformalSolver {
    /// Creates the solver for body 1 (upper) and body 2, on a grid along x and s. The surfaces turn
    /// by `turn` [rad] in all and are straight beyond. `semi_axes` are approximate, along x and
    /// along s [m].
    #[must_use]
    pub fn new(
        materials: &[Material; 2],
        (arcs, turn): (Arcs, f64),
        grid: &Structured,
        semi_axes: [f64; 2],
        difference: Difference,
    ) -> Self {
        let patch = SurfaceGrid {
            counts: [grid.ni, grid.nj],
            sides: [grid.dx(), grid.dy()],
            first: grid.y(0) - 0.5 * grid.dy(),
        };
        let sections = arcs.curvatures.map(|curvature| match curvature {
            0.0 => CrossSection::straight(),
            _ => CrossSection::arc(curvature, 0.5 * turn / curvature.abs()),
        });
        let numbers = Arc::new(InfluenceNumbers::new(materials, &sections, &patch));
        let elastic = ElasticPair::new(materials, numbers, 0, patch.counts);
        let bodies = Bodies::from(Elasticity::of_pair(&materials[0], &materials[1]));
        let (layer, motion) = (0.0, Motion::SteadyRolling);
        let contact = Contact {
            bodies,
            layer,
            yields: None,
            semi_axes,
            motion,
            difference,
            tolerance: TOLERANCE,
        };
        let levels = Levels::new(grid, &contact);
        Self { grid: *grid, arcs, elastic, levels, difference }
    }

    /// Solves one contact from scratch.
    ///
    /// # Errors
    /// The normal or tangential contact has no solution, the bodies do not touch, or no approach
    /// carries the force.
    pub fn solve(&mut self, prescription: &Prescription) -> Result<Conformal, ConformalError> {
        let points = self.grid.points();
        let mut found = Conformal { pressure: vec![0.0; points], ..Conformal::default() };
        let mut closer = vec![0.0; points];
        found.state = TangentialState::at_rest(&found.pressure, prescription.creepage);
        self.press(prescription, &closer, &mut found)?;
        let mut solution: Option<Solution> = None;
        let mut change = f64::INFINITY;
        let mut opened = closer.clone();
        for turn in 0..MOST_TURNS {
            let bound: Vec<f64> =
                found.pressure.iter().map(|p| prescription.friction * p).collect();
            self.slide(prescription, &bound, &mut solution, &mut found)?;
            if change <= REST {
                found.force = self.force(&found);
                return Ok(found);
            }
            let [x, s] = &found.state.traction;
            self.elastic.opening([x, s], &mut opened);
            let share = if turn < WHOLE_TURNS { 1.0 } else { 0.5 };
            for (closer, opened) in closer.iter_mut().zip(&opened) {
                *closer = share * opened + (1.0 - share) * *closer;
            }
            let before = found.pressure.clone();
            self.press(prescription, &closer, &mut found)?;
            let largest = found.pressure.iter().copied().fold(0.0, f64::max);
            let changes = found.pressure.iter().zip(&before).map(|(p, q)| (p - q).abs());
            change = changes.fold(0.0, f64::max) / (share * largest);
        }
        Err(ConformalError::Unsettled { change })
    }

    /// Solves for the pressure, with the opening of the gap by the tractions `closer` [m].
    fn press(
        &mut self,
        prescription: &Prescription,
        closer: &[f64],
        found: &mut Conformal,
    ) -> Result<(), ConformalError> {
        match prescription.load {
            Prescribed::Approach(approach) => self.press_by(approach, closer, found),
            Prescribed::Load(force) => {
                // The force grows with about the power 3/2 of the approach.
                let mut approach = match found.approach {
                    0.0 => self.first_approach(force, found)?,
                    last => last,
                };
                let mut last: Option<[f64; 2]> = None;
                for _ in 0..MOST_TURNS {
                    self.press_by(approach, closer, found)?;
                    let carried = self.force(found)[2];
                    let lack = force - carried;
                    if lack.abs() <= FORCE_TOLERANCE * force {
                        return Ok(());
                    }
                    let stiffness = match last {
                        Some([at, before]) if at != approach => {
                            (carried - before) / (approach - at)
                        }
                        _ => 1.5 * carried / approach,
                    };
                    last = Some([approach, carried]);
                    let next = approach + lack / stiffness;
                    approach = if next > 0.5 * approach { next } else { 0.5 * approach };
                }
                Err(ConformalError::NoApproach { force })
            }
        }
    }

    /// First estimate of the approach under this force: the one that applies if it is uniform over
    /// the surface.
    fn first_approach(&mut self, force: f64, found: &mut Conformal) -> Result<f64, ConformalError> {
        let undeformed = self.undeformed(0.0, &[]);
        Ok(self.elastic.approach(&undeformed, force, &mut found.pressure)?)
    }

    fn undeformed(&self, approach: f64, closer: &[f64]) -> Vec<f64> {
        let Self { grid, arcs, .. } = self;
        let at = |index: usize| {
            let (x, s) = (grid.x(index % grid.ni), grid.y(index / grid.ni));
            let more = closer.get(index).copied().unwrap_or(0.0);
            arcs.distance(x, s) - approach * arcs.direction(s).cos() + more
        };
        (0..grid.points()).map(at).collect()
    }

    fn press_by(
        &mut self,
        approach: f64,
        closer: &[f64],
        found: &mut Conformal,
    ) -> Result<(), ConformalError> {
        let distance = self.undeformed(approach, closer);
        let solved = self.elastic.press(&distance, &mut found.pressure)?;
        if solved.touches_edge {
            let (nx, ny) = (self.grid.ni, self.grid.nj);
            return Err(NormalError::Edge { nx, ny }.into());
        }
        if solved.contact_elements == 0 {
            return Err(ConformalError::Apart { approach });
        }
        found.normal_iterations += solved.iterations;
        found.approach = approach;
        Ok(())
    }

    /// Solves for the tractions under this bound.
    fn slide(
        &mut self,
        prescription: &Prescription,
        bound: &[f64],
        solution: &mut Option<Solution>,
        found: &mut Conformal,
    ) -> Result<(), ConformalError> {
        if !prescription.adheres {
            self.slide_everywhere(prescription, bound, found);
            return Ok(());
        }
        let slip = self.slip_besides(prescription, found);
        let prescribed = tangential::PrescribedMotion::creepages(prescription.creepage);
        let mut solved = match solution.take() {
            Some(near) => near,
            None => self.levels.solve(bound, &prescribed)?,
        };
        let [x, s] = &slip;
        self.levels.improve(bound, &prescribed, Some(History::of_slip([x, s])), &mut solved)?;
        found.state.clone_from(&solved.state);
        found.newton_steps = solved.newton_steps;
        *solution = Some(solved);
        Ok(())
    }

    /// Slip of a step that is missing in the model of plane half-spaces [m]: by the pressure, by
    /// the change of A_tt with the latest tractions, and by the turn of the surface.
    fn slip_besides(&mut self, prescription: &Prescription, found: &Conformal) -> [Vec<f64>; 2] {
        let [x, s] = &found.state.traction;
        let mut slip = [0, 1].map(|_| vec![0.0; found.pressure.len()]);
        let [slip_x, slip_s] = &mut slip;
        let difference = self.difference;
        self.elastic.slip_besides(difference, [x, s], &found.pressure, [slip_x, slip_s]);
        for (component, slip) in slip.iter_mut().enumerate() {
            for (index, slip) in slip.iter_mut().enumerate() {
                let [curved, plane] = self.rigid_slips(prescription, index);
                *slip += self.grid.dx() * (curved[component] - plane[component]);
            }
        }
        slip
    }

    /// Rigid slip at an element over the distance rolled: as prescribed, and in the plane at s = 0
    /// [-].
    fn rigid_slips(&self, prescription: &Prescription, index: usize) -> [[f64; 2]; 2] {
        let Prescription { creepage: [xi, eta, phi], normal_creepage: zeta, .. } = *prescription;
        let (grid, arcs) = (&self.grid, &self.arcs);
        let (x, s) = (
            grid.x(index % grid.ni) + self.difference.rigid_slip_ahead() * grid.dx(),
            grid.y(index / grid.ni),
        );
        let ([y, z], (sin, cos)) = (arcs.place(s), arcs.direction(s).sin_cos());
        let rolling = arcs.rolling_curvature;
        let plane = [xi - phi * s, eta + phi * x];
        let curved =
            [xi - phi * y + rolling * z, (eta + phi * x) * cos + (zeta - rolling * x) * sin];
        [if prescription.in_plane { plane } else { curved }, plane]
    }

    /// Sets the traction to f p against the rigid slip, which is the whole slip.
    fn slide_everywhere(&self, prescription: &Prescription, bound: &[f64], found: &mut Conformal) {
        let mut state = TangentialState::at_rest(bound, prescription.creepage);
        for (index, bound) in bound.iter().enumerate() {
            let [slip, _] = self.rigid_slips(prescription, index);
            let size = slip[0].hypot(slip[1]);
            for (component, slip) in slip.into_iter().enumerate() {
                state.slip[component][index] = self.grid.dx() * slip;
                if size > 0.0 {
                    state.traction[component][index] = -bound * slip / size;
                }
            }
            if *bound > 0.0 && size > 0.0 {
                state.element[index] = tangential::ElementState::Slip;
            }
        }
        found.state = state;
    }

    /// Friction power of every element [W/m²]: −p·S_I V/Δx plus the numerical dissipation, which is
    /// taken from half-spaces. p is the traction that does work on the slip of the difference.
    #[must_use]
    pub fn friction_power(&mut self, found: &Conformal, speed: f64) -> Vec<f64> {
        let (nx, rate) = (self.grid.ni, speed / self.grid.dx());
        let [x, s] = &found.state.traction;
        let dissipation = self.levels.dissipation([x, s], &found.pressure, speed);
        let power = |index: usize| {
            let of = |component: usize| {
                let traction = self.difference.working(&found.state.traction[component], nx, index);
                traction * found.state.slip[component][index]
            };
            let more = dissipation.as_ref().map_or(0.0, |dissipation| dissipation[index]);
            more - rate * (of(0) + of(1))
        };
        let mut power: Vec<f64> = (0..self.grid.points()).map(power).collect();
        without_negative(&mut power);
        power
    }

    /// Slip velocity of every element; zero outside the contact [m/s].
    #[must_use]
    pub fn slip_velocity(&self, found: &Conformal, speed: f64) -> [Vec<f64>; 2] {
        let rate = speed / self.grid.dx();
        let velocity = |(slip, p): (&f64, &f64)| if *p > 0.0 { rate * slip } else { 0.0 };
        [0, 1].map(|k| found.state.slip[k].iter().zip(&found.pressure).map(velocity).collect())
    }

    /// Force on body 1 [N].
    fn force(&self, found: &Conformal) -> [f64; 3] {
        let mut sum = [0.0; 3];
        let [px, ps] = &found.state.traction;
        for (row, pressure) in found.pressure.chunks_exact(self.grid.ni).enumerate() {
            let (sin, cos) = self.arcs.direction(self.grid.y(row)).sin_cos();
            let range = row * self.grid.ni..(row + 1) * self.grid.ni;
            let along: f64 = pressure.iter().sum();
            let across: f64 = ps[range.clone()].iter().sum();
            sum[0] += px[range].iter().sum::<f64>();
            sum[1] += across * cos - along * sin;
            sum[2] += across * sin + along * cos;
        }
        sum.map(|value| value * self.grid.element_area())
    }
}

#[cfg(test)]
mod tests;
