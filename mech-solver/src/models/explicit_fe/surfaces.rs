//! What touches, and about where: Hertz's ellipse of two radii, or the contact of measured profiles on a coarse grid of
//! half-spaces.

use crate::case::ellipse::Ellipse;
use crate::case::scene::{GivenPatch, Load, Scene};
use crate::models::half_space::gap::Gap;
use crate::models::half_space::geometry::{self, Footprint, Shapes};
use crate::terms::Terms;
use elastic::Elasticity;
use explicit_fe::section::circle;
use proto::configuration::{Configuration, Refusal};
use std::f64::consts::PI;

/// How far round Hertz's contact of the load another one of it may reach, in semi-axes.
const BEYOND_HERTZ: f64 = 1.4;

/// The undeformed surfaces, in the frame of the contact.
pub(super) struct Surfaces {
    /// The contact, or what of an ellipse comes near it.
    pub(super) ellipse: Ellipse,
    /// Its stiffness, dN/dδ [N/m].
    pub(super) stiffness: f64,
    /// Radii of rolling at the origin [m].
    pub(super) radii: [f64; 2],
    /// Half the length, and half the width, in which contact is looked for [m].
    pub(super) watched: [f64; 2],
    /// Lateral place of the middle of that [m].
    pub(super) middle: f64,
    /// What was done to the shapes.
    pub(super) remarks: Vec<String>,
    gap: Option<Gap>,
    lateral: [f64; 2],
}

impl Surfaces {
    /// Of a case, with so many elements to a semi-axis.
    ///
    /// # Errors
    /// Shapes that do not touch, or too steeply.
    pub(super) fn read(
        configuration: &Configuration,
        scene: &Scene,
        resolution: usize,
    ) -> Result<Self, Refusal> {
        let [upper, lower] = scene.materials();
        let bodies = Elasticity::of_pair(&upper, &lower).into();
        // Effects that change the gap are none of this model.
        let terms = Terms::default();
        let shapes = Shapes {
            scene,
            given: None,
            extent: None,
            bodies: &bodies,
            delays: &[],
            terms: &terms,
            resolution,
        };
        let Footprint { gap, ellipse, semi_axes, grid, remarks, .. } =
            geometry::footprint(configuration, &shapes)?;
        let lateral = [scene.bodies[0].radius_y, scene.bodies[1].radius_y];
        let radii = [scene.bodies[0].radius_x, scene.bodies[1].radius_x];
        if let Some(ellipse) = ellipse {
            let watched =
                [ellipse.semi_axis_a, ellipse.semi_axis_b].map(|half| BEYOND_HERTZ * half);
            let (stiffness, middle, gap) = (stiffness(scene, &ellipse), 0.0, None);
            return Ok(Self { ellipse, stiffness, radii, watched, middle, remarks, gap, lateral });
        }
        let Load::NormalForce(force) = scene.load else { unreachable!("checked before") };
        let [a, b] = semi_axes;
        let patch =
            GivenPatch { semi_axis_a: a, semi_axis_b: b, max_pressure: 1.5 * force / (PI * a * b) };
        let ellipse = Ellipse::solve(scene, Some(patch))?;
        let ends = [grid.y(0), grid.y(grid.nj - 1)];
        let reach = grid.x(grid.ni - 1).max(-grid.x(0));
        let radius = |body: usize| {
            let at_origin = gap.as_ref().map(|gap| gap.radius(body));
            at_origin.filter(|_| radii[body].is_finite()).unwrap_or(radii[body])
        };
        Ok(Self {
            stiffness: stiffness(scene, &ellipse),
            ellipse,
            radii: [radius(0), radius(1)],
            watched: [reach.max(BEYOND_HERTZ * a), 0.5 * (ends[1] - ends[0])],
            middle: 0.5 * (ends[0] + ends[1]),
            remarks,
            gap,
            lateral,
        })
    }

    /// How far the surface of a body is within it [m] over the lateral coordinate [m], from the plane through the lower surface at
    /// the origin.
    pub(super) fn drop(&self, body: usize, y: f64) -> f64 {
        match &self.gap {
            Some(gap) if !gap.is_parabola(body) => gap.drop(body, y),
            Some(gap) => {
                let circle = circle(self.lateral[body]);
                gap.drop(body, 0.0) + circle(y + gap.origin) - circle(gap.origin)
            }
            None => circle(self.lateral[body])(y),
        }
    }
}

/// dN/dδ of a contact [N/m]: of Hertz's where the approach is known, else that of a circular one of the same area, 2 E* √(ab).
fn stiffness(scene: &Scene, ellipse: &Ellipse) -> f64 {
    let Ellipse { semi_axis_a, semi_axis_b, approach, normal_force, .. } = ellipse;
    match approach {
        Some(approach) => 1.5 * normal_force / approach,
        None => 2.0 / scene.contact_compliance() * (semi_axis_a * semi_axis_b).sqrt(),
    }
}
