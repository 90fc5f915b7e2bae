//! A checked case, and the passage of particles through its contact.

use super::drive::Driven;
use super::geometry::Footprint;
use super::spacing::Patch;
use crate::case::ellipse::Ellipse;
use crate::case::scene::{GivenPatch, Scene};
use crate::models::varying::refuse_change_of_rolling;
use crate::terms::surface::KeptSurface;
use crate::terms::{Kind, Terms};
use half_space::aligned::AlignedGrid;
use half_space::difference::Difference;
use half_space::extent::{elliptic, sample};
use half_space::retarded::Delay;
use half_space::viscoelastic::Bodies;
use proto::configuration::{Configuration, Refusal};
use proto::grid::Structured;

/// A checked case.
#[derive(Debug)]
pub(super) struct Case {
    pub(super) scene: Scene,
    pub(super) bodies: Bodies,
    /// Delayed compliances of the bodies; for bodies that do not roll.
    pub(super) delays: Vec<Delay>,
    pub(super) driven: Driven,
    /// Terms of the active effects.
    pub(super) terms: Terms,
    pub(super) footprint: Footprint,
    /// Thermal rise of both surfaces together at the element centres [m]; empty without thermal
    /// expansion.
    pub(super) rises: Vec<f64>,
    /// Inputs of both bodies for the thermal rise, kept if they are observed.
    pub(super) heated: Option<[KeptSurface; 2]>,
    /// True if the tractions of one step affect the next.
    pub(super) memory: bool,
    /// Finite difference of the displacements along x.
    pub(super) difference: Difference,
    /// True if a transient contact starts from steady rolling.
    pub(super) begins_steady: bool,
    /// Duration of a shift, set to that of the window [s].
    pub(super) shift_duration: f64,
    /// True if the step in progress is the first in time.
    pub(super) first_step: bool,
}

impl Case {
    /// Applies the values of another row; grid and materials stay.
    ///
    /// # Errors
    /// Values that are missing or out of range; a contact without solution.
    pub(super) fn follow(
        &mut self,
        row: &Configuration,
        patch: Option<GivenPatch>,
    ) -> Result<(), Refusal> {
        let scene = Scene::read(&row.case)?;
        refuse_change_of_rolling(&self.scene, &scene)?;
        let given = patch.map(|patch| Ellipse::solve(&scene, Some(patch))).transpose()?;
        let ellipse = given.map_or_else(|| Ellipse::solve(&scene, None), Ok)?;
        self.driven =
            Driven::read(row, &scene, given.as_ref(), Some(&ellipse), self.terms.adhesion)?;
        self.footprint.semi_axes = [ellipse.semi_axis_a, ellipse.semi_axis_b];
        self.footprint.ellipse = Some(ellipse);
        if let Some(gap) = &mut self.footprint.gap {
            gap.follow(&scene);
        }
        self.scene = scene;
        Ok(())
    }

    /// Releases the prescribed force if the contact is smaller than an element, which cannot carry
    /// it. Returns whether it was released.
    pub(super) fn rest_if_lost(&mut self) -> bool {
        let [a, _] = self.footprint.semi_axes;
        let lost = a < 0.5 * self.footprint.grid.dx() && self.driven.may_lose();
        if lost {
            self.driven = Driven::AT_REST;
        }
        lost
    }

    /// Returns whether Hertz's solution holds: smooth second-order surfaces, and neither terms nor
    /// tractions that change the pressure.
    pub(super) fn is_hertzian(&self) -> bool {
        let elastic =
            !self.bodies.are_coupled() && !self.bodies.remember() && self.delays.is_empty();
        self.terms.leave_hertz() && elastic
    }

    /// Returns whether rows that roll begin at the leading edge of the contact.
    pub(super) fn displaces_rows(&self) -> bool {
        displaces_rows(&self.terms, &self.bodies, self.difference)
    }

    /// Length of the slip zone [m] under this normal force [N] and largest pressure [Pa], estimated
    /// by strips. `None` without rolling, and for a contact that counts as stuck.
    pub(super) fn estimated_slip_zone(&self, normal_force: f64, max_pressure: f64) -> Option<f64> {
        let Scene { width, friction_coefficient, speeds, .. } = self.scene;
        let semi_axes = self.footprint.semi_axes;
        let (line, bodies) = (width.is_some(), &self.bodies);
        let patch =
            Patch { semi_axes, line, normal_force, max_pressure, friction_coefficient, bodies };
        let zone = patch.slip_zone(&self.driven).filter(|_| speeds.rolling > 0.0);
        zone.map(|zone| zone.length * semi_axes[0])
    }

    /// Undeformed distance at the element centres [m]; `None` if the pressure is given.
    pub(super) fn distance(&self) -> Option<Vec<f64>> {
        let gap = self.footprint.gap.as_ref()?;
        let mut distance =
            sample(&self.footprint.grid, &|x, y| gap.distance(x, y) + self.terms.height(x, y));
        distance.iter_mut().zip(&self.rises).for_each(|(distance, rise)| *distance -= rise);
        Some(distance)
    }

    /// Motion of a particle during a step.
    pub(super) fn passage(&self) -> Passage {
        let (dx, speed) = (self.footprint.grid.dx(), self.scene.speeds.rolling);
        let begins = match self.difference {
            _ if speed == 0.0 => Begin::Here,
            Difference::Fromm if !self.first_step => Begin::AtItsEnd,
            _ => Begin::Upstream,
        };
        match speed > 0.0 {
            true => Passage {
                distance: dx,
                ahead: self.difference.rigid_slip_ahead() * dx,
                middle: self.difference.middle() * dx,
                duration: dx / speed,
                begins,
            },
            false => {
                let duration = self.shift_duration;
                Passage { distance: 1.0, ahead: 0.0, middle: 0.0, duration, begins }
            }
        }
    }

    /// Pressure of the ellipse that the case gives, scaled to carry the ellipse's load; zero if the
    /// pressure is to be solved for. The values are means over the elements or, with the upwind
    /// difference, values at their centres as in CONTACT.
    pub(super) fn given_pressure(&self) -> Vec<f64> {
        let grid = &self.footprint.grid;
        let (None, Some(ellipse)) = (&self.footprint.gap, &self.footprint.ellipse) else {
            return vec![0.0; grid.points()];
        };
        let [a, b] = self.footprint.semi_axes;
        let at = |x: f64, y: f64| (1.0 - (x / a).powi(2) - (y / b).powi(2)).max(0.0).sqrt();
        let mut pressure = match self.difference {
            Difference::Fromm => elliptic(&AlignedGrid::regular(*grid), [a, b]),
            Difference::Upwind => sample(grid, &at),
        };
        let sum = pressure.iter().sum::<f64>() * grid.element_area();
        pressure.iter_mut().for_each(|value| *value *= ellipse.normal_force / sum);
        pressure
    }
}

/// Returns whether the rows of a rolling contact begin at its leading edge: those of elastic bodies
/// of the same constants with a difference of second order, on smooth surfaces. Other contacts keep
/// a regular grid.
pub(super) fn displaces_rows(terms: &Terms, bodies: &Bodies, difference: Difference) -> bool {
    let smooth = [Kind::Gap, Kind::PressureBound].map(|kind| terms.effect_of(kind).is_none());
    terms.adhesion
        && difference == Difference::Fromm
        && !bodies.are_coupled()
        && !bodies.remember()
        && smooth == [true; 2]
}

/// A step of the surface particles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Passage {
    /// Distance to which creepages refer: Δx rolled, or 1 in a shift [m].
    pub(super) distance: f64,
    /// Position at which the rigid slip is taken, ahead of an element's centre [m].
    pub(super) ahead: f64,
    /// Position of an element's slip and friction power, upstream of its centre [m].
    pub(super) middle: f64,
    /// Duration of the step [s].
    pub(super) duration: f64,
    /// Traction at the start of the step; its mean with the traction at the end does the work.
    pub(super) begins: Begin,
}

/// Traction at the start of a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Begin {
    /// Traction of the element from which the particle comes.
    Upstream,
    /// Traction of the same element.
    Here,
    /// Traction at the end of the step.
    AtItsEnd,
}

impl Passage {
    /// Mean of the tractions at the start and at the end of the step of an element, in rows of nx
    /// [Pa].
    pub(super) fn mean(&self, nx: usize, start: &[f64], end: &[f64], index: usize) -> f64 {
        let start = match self.begins {
            Begin::Upstream if (index + 1).is_multiple_of(nx) => 0.0,
            Begin::Upstream => start[index + 1],
            Begin::Here => start[index],
            Begin::AtItsEnd => end[index],
        };
        0.5 * (start + end[index])
    }

    /// Power −p̄·S/Δt of every element, with the mean traction p̄ [W/m²]. Adding zero turns −0 into
    /// 0.
    pub(super) fn power(
        &self,
        grid: &Structured,
        start: &[f64],
        end: &[f64],
        slip: &[f64],
    ) -> Vec<f64> {
        let (nx, count) = (grid.ni, grid.points());
        let power = |index: usize| {
            let of = |component: usize| {
                let field = component * count..(component + 1) * count;
                let (start, end) = (&start[field.clone()], &end[field]);
                self.mean(nx, start, end, index) * slip[component * count + index]
            };
            -1.0 / self.duration * (of(0) + of(1)) + 0.0
        };
        (0..count).map(power).collect()
    }
}
