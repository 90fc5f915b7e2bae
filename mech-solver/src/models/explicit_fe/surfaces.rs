//! Undeformed surfaces and an estimate of their contact: Hertz's ellipse of two radii, or the
//! contact of measured profiles, computed with half-spaces on a coarse grid.

use crate::case::ellipse::Ellipse;
use crate::case::scene::{GivenPatch, Load, Scene};
use crate::models::half_space::gap::Gap;
use crate::models::half_space::geometry::{self, Footprint, Shapes};
use crate::terms::Terms;
use elastic::Elasticity;
use explicit_fe::section::circle;
use proto::configuration::{Configuration, Refusal};
use std::f64::consts::PI;

/// Size of the region searched for contact, relative to Hertz's contact under the load.
const BEYOND_HERTZ: f64 = 1.4;

/// Undeformed surfaces, in the frame of the contact.
pub(super) struct Surfaces {
    /// Ellipse of the contact, or an equivalent ellipse for profiles.
    pub(super) ellipse: Ellipse,
    /// Contact stiffness, dN/dδ [N/m].
    pub(super) stiffness: f64,
    /// Rolling radii at the origin [m].
    pub(super) radii: [f64; 2],
    /// Half the length and half the width of the region searched for contact [m].
    pub(super) watched: [f64; 2],
    /// Lateral position of the middle of this region [m].
    pub(super) middle: f64,
    /// Remarks on modifications of the shapes.
    pub(super) remarks: Vec<String>,
    gap: Option<Gap>,
    lateral: [f64; 2],
}

impl Surfaces {
    /// Reads the surfaces of a case, with `resolution` elements per semi-axis for profiles.
    ///
    /// # Errors
    /// Shapes that do not touch, or touch too steeply.
    pub(super) fn read(
        configuration: &Configuration,
        scene: &Scene,
        resolution: usize,
    ) -> Result<Self, Refusal> {
        let [upper, lower] = scene.materials();
        let bodies = Elasticity::of_pair(&upper, &lower).into();
        // Effects that change the gap are not supported by this model.
        let terms = Terms::default();
        let shapes = Shapes {
            scene,
            given: None,
            extent: None,
            bodies: &bodies,
            delays: &[],
            terms: &terms,
            resolution,
            follows_slip: false,
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

    /// Depth of a body's surface, positive into the body, over the lateral coordinate [m]; measured
    /// from the plane through the lower surface at the origin.
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

/// Contact stiffness dN/dδ [N/m]: Hertz's if the approach is known, otherwise that of a circular
/// contact of the same area, 2 E* √(ab).
fn stiffness(scene: &Scene, ellipse: &Ellipse) -> f64 {
    let Ellipse { semi_axis_a, semi_axis_b, approach, normal_force, .. } = ellipse;
    match approach {
        Some(approach) => 1.5 * normal_force / approach,
        None => 2.0 / scene.contact_compliance() * (semi_axis_a * semi_axis_b).sqrt(),
    }
}
